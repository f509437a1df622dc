//! Writes actions as action types with links to their steps.

use g7_model::{
    Action, ActionKind, Expr, ExprKind, Literal, Name, Order, Place, Qualifier, Situation, Step, Stmt,
    StmtKind, Target, Type, Work, say,
};

use super::lookup::{Meaning, Node};
use super::{Web, Writer};
use g7_iec::xml::element::Element;

impl<'d> Writer<'d> {
    /// Writes the actions of a step. The enclosed charts were written with the step.
    pub(super) fn actions(&mut self, step: &'d Step, node: Node, web: &mut Web) {
        for action in &step.actions {
            let without =
                matches!(action.kind, ActionKind::Order(Order::Enclose(_)) | ActionKind::Comment(_));
            if !without && !self.look.takes_actions(node) {
                self.cannot(
                    action.at,
                    say!("an action of an enclosing step, macro-step, entry or exit step"),
                );
                continue;
            }
            let place = format!("//@partialGrafcets.{}/@actionTypes.{}", self.sheet, web.actions.len());
            let Some(element) = self.action(action, &place) else { continue };
            web.actions.push(element);
            let mut link = Element::new("actionLinks");
            link.set("step", &self.look.place(node));
            link.set("actionType", &place);
            web.links.push(link);
        }
    }

    fn action(&mut self, action: &'d Action, place: &str) -> Option<Element> {
        let at = action.at;
        match &action.kind {
            ActionKind::Qualified { qualifier, time, target, condition } => {
                self.qualified(at, (*qualifier, time.as_ref()), target, condition.as_ref(), place)
            }
            ActionKind::OnEvent { event, work } => {
                let mut element = self.stored(at, work, Some("event"), place)?;
                let term = self.condition(event, "term", &format!("{place}/@term"))?;
                element.push(term);
                Some(element)
            }
            ActionKind::EachScan { .. } => {
                self.cannot(at, say!("an action in each scan"));
                None
            }
            ActionKind::Order(Order::Force(chart, situation)) => self.forcing(at, chart, situation),
            ActionKind::Order(Order::Enclose(_)) => None,
            ActionKind::Order(Order::Enable(_)) => {
                self.cannot(at, say!("an order that enables a chart"));
                None
            }
            ActionKind::Order(Order::Mask(_)) => {
                self.cannot(at, say!("an order that masks"));
                None
            }
            ActionKind::Order(Order::Call(_)) => {
                self.cannot(at, say!("the call of a task"));
                None
            }
            ActionKind::Comment(_) => {
                self.leave_out(at, say!("a comment among the actions"));
                None
            }
        }
    }

    fn qualified(
        &mut self,
        at: Place,
        (qualifier, time): (Qualifier, Option<&Expr>),
        target: &'d Target,
        condition: Option<&Expr>,
        place: &str,
    ) -> Option<Element> {
        let variable = match target {
            Target::Work(work) => {
                let when = match qualifier {
                    Qualifier::P1 => None,
                    Qualifier::P0 => Some("deactivation"),
                    _ => {
                        self.cannot(at, say!("statements with the qualifier {}", qualifier));
                        return None;
                    }
                };
                let mut element = self.stored(at, work, when, place)?;
                if let Some(condition) = condition {
                    let term = self.condition(condition, "term", &format!("{place}/@term"))?;
                    element.push(term);
                }
                return Some(element);
            }
            Target::Path(path) => Expr { kind: ExprKind::Path(path.clone()), at },
            Target::Element(element) => (**element).clone(),
            Target::Direct(address, at) => Expr { kind: ExprKind::Direct(address.clone()), at: *at },
        };
        match qualifier {
            Qualifier::N | Qualifier::D | Qualifier::L => {
                self.continuous(at, &variable, (qualifier, time), condition, place)
            }
            Qualifier::S | Qualifier::R => {
                // `S V` is the assignment of TRUE on activation.
                let value = ExprKind::Literal(Literal::Bool(qualifier == Qualifier::S));
                let value = Expr { kind: value, at };
                let mut element = self.assignment(at, &variable, &value, None, place)?;
                if let Some(condition) = condition {
                    let term = self.condition(condition, "term", &format!("{place}/@term"))?;
                    element.push(term);
                }
                Some(element)
            }
            other => {
                self.cannot(at, say!("the qualifier {}", other));
                None
            }
        }
    }

    fn continuous(
        &mut self,
        at: Place,
        variable: &Expr,
        (qualifier, time): (Qualifier, Option<&Expr>),
        condition: Option<&Expr>,
        place: &str,
    ) -> Option<Element> {
        let mut element = self.new_action("grafcet:ContinuousAction");
        if condition.is_some() {
            element.set("continuousActionType", "assignationCondition");
        }
        if let Some(time) = time {
            if condition.is_some() {
                self.cannot(at, say!("a delay or limit with a condition beside it"));
                return None;
            }
            let sort = if qualifier == Qualifier::D { "timeDelayed" } else { "timeLimited" };
            self.times(&mut element, sort, time, None);
        }
        element.push(self.target(variable)?);
        if let Some(condition) = condition {
            let term = self.timed(condition, &format!("{place}/@term"), &mut element)?;
            element.push(term);
        }
        Some(element)
    }

    /// A stored action: one assignment.
    fn stored(&mut self, at: Place, work: &'d Work, when: Option<&str>, place: &str) -> Option<Element> {
        let locals = matches!(work, Work::Block(b) if !b.locals.is_empty());
        match work.statements() {
            [Stmt { kind: StmtKind::Assign { target, value }, .. }] if !locals => {
                self.assignment(at, target, value, when, place)
            }
            _ => {
                self.cannot(at, say!("a stored action that is not one assignment"));
                None
            }
        }
    }

    fn assignment(
        &mut self,
        at: Place,
        target: &Expr,
        value: &Expr,
        when: Option<&str>,
        place: &str,
    ) -> Option<Element> {
        let mut element = self.new_action("grafcet:StoredAction");
        if let Some(when) = when {
            element.set("storedActionType", when);
        }
        let variable = self.target(target)?;
        let value = self.term(value, "value", &format!("{place}/@value"), 0)?;
        if value.ty == Type::Bool && matches!(target.kind, ExprKind::Path(_)) && self.is_integer(target) {
            self.cannot(at, say!("a Boolean value for a number"));
            return None;
        }
        element.push(variable);
        element.push(value.element);
        Some(element)
    }

    fn is_integer(&self, target: &Expr) -> bool {
        let ExprKind::Path(path) = &target.kind else { return false };
        matches!(self.look.path(self.sheet, path), Some(Meaning::Var(_, ty)) if ty != Type::Bool)
    }

    fn new_action(&mut self, class: &'static str) -> Element {
        let mut element = Element::new("actionTypes");
        element.set("xsi:type", class);
        element.set("id", &self.id());
        element
    }

    /// The variable that an action writes.
    fn target(&mut self, e: &Expr) -> Option<Element> {
        let meaning = match &e.kind {
            ExprKind::Path(path) => self.look.path(self.sheet, path),
            ExprKind::Direct(address) => self.look.direct(address),
            _ => None,
        };
        match meaning {
            Some(Meaning::Var(reference, ty)) => Some(self.variable_term(&reference, ty, "variable").element),
            _ => {
                self.cannot(e.at, say!("an action on what is no variable"));
                None
            }
        }
    }

    fn forcing(&mut self, at: Place, chart: &Name, situation: &Situation) -> Option<Element> {
        let Some(index) = self.look.chart(&chart.text) else {
            self.cannot(at, say!("a forcing order for a chart that is not there"));
            return None;
        };
        let mut element = self.new_action("grafcet:ForcingOrder");
        element.set("partialGrafcet", &format!("//@partialGrafcets.{index}"));
        match situation {
            Situation::Current => {}
            Situation::Init => element.set("forcingOrderType", "initialSituation"),
            Situation::Steps(steps) if steps.is_empty() => element.set("forcingOrderType", "emptySituation"),
            Situation::Steps(steps) => {
                let nodes: Vec<Node> =
                    steps.iter().filter_map(|s| self.look.step_node(index, &s.text)).collect();
                if nodes.len() < steps.len() {
                    self.cannot(at, say!("a forced step that is not there"));
                }
                if nodes.iter().any(|n| !self.look.is_initialisable(*n)) {
                    self.cannot(at, say!("a forced macro-step, entry or exit step"));
                    return None;
                }
                let places: Vec<String> = nodes.into_iter().map(|n| self.look.place(n)).collect();
                element.set("forcedSteps", &places.join(" "));
                element.set("forcingOrderType", "explicitSituation");
            }
        }
        Some(element)
    }
}
