//! Writes the actions of steps, and the sections of actions and transitions.

use g7_iec::nodes;
use g7_iec::scopes::{Ref, StepKey};
use g7_iec::xml::element::Element;
use g7_model::{
    Action, ActionKind, Block, Expr, ExprKind, Literal, NamedAction, Order, Qualifier, Section, Stmt, Target,
    Transition, Type, UnaryOp, VarKind, Work, say,
};

use super::Writer;
use super::text::constant;

/// The name that an action of a step drives, with its element.
type Named = (&'static str, String);

impl Writer<'_> {
    /// The actions of a step.
    pub(super) fn actions(&mut self, key: StepKey, actions: &[Action]) -> Vec<Element> {
        let numbered = (1..).zip(actions);
        numbered.filter_map(|(number, action)| self.action(key, number, action)).collect()
    }

    fn action(&mut self, key: StepKey, number: usize, action: &Action) -> Option<Element> {
        let (qualifier, time, target, condition) = match &action.kind {
            ActionKind::Qualified { qualifier, time, target, condition } => {
                (*qualifier, time.as_ref(), target, condition.as_ref())
            }
            // A body with N runs in each scan as well.
            ActionKind::EachScan { work, condition } => {
                let name = self.body(key, number, Qualifier::N, work, condition.as_ref(), action);
                return Some(element(Qualifier::N, "sectionName", &name, ""));
            }
            ActionKind::OnEvent { .. } => {
                self.speech.cannot(action.at, say!("an action on event"));
                return None;
            }
            ActionKind::Order(order) => {
                let what = match order {
                    Order::Force(..) => say!("a forcing order"),
                    Order::Enable(_) => say!("an order that enables a chart"),
                    Order::Mask(_) => say!("an order that masks"),
                    Order::Call(_) => say!("a call of a task"),
                    Order::Enclose(_) => say!("an enclosed chart"),
                };
                self.speech.cannot(action.at, what);
                return None;
            }
            ActionKind::Comment(_) => {
                self.speech.leave_out(action.at, say!("a comment"));
                return None;
            }
        };
        if matches!(qualifier, Qualifier::SD | Qualifier::SL) {
            self.speech.cannot(action.at, say!("the qualifier `{}`", qualifier.name()));
        }
        let literal = match time {
            Some(time) if !matches!(time.kind, ExprKind::Literal(Literal::Time(_))) => {
                self.speech.cannot(time.at, say!("a time of an action that is worked out"));
                String::new()
            }
            Some(time) => self.speech.value(time, Type::Time),
            None => String::new(),
        };
        let (tag, name) = self.target(key, number, qualifier, target, condition, action)?;
        Some(element(qualifier, tag, &name, &literal))
    }

    /// A body that stands in its step, as a section of its own. Returns its name.
    fn body(
        &mut self,
        key: StepKey,
        number: usize,
        qualifier: Qualifier,
        work: &Work,
        condition: Option<&Expr>,
        action: &Action,
    ) -> String {
        let list = self.speech.stmts(work.statements(), Some(key.0));
        if let Work::Block(block) = work {
            self.locals(block);
        }
        let list = match condition {
            Some(condition) => vec![self.guarded(key, qualifier, condition, list)],
            None => list,
        };
        let wish = format!("{}_{number}", self.speech.names.step(key));
        let name = self.speech.names.free(&wish);
        let text = self.speech.print(&list, action.at);
        self.action_sections.push(section("actionSource", &name, &text));
        name
    }

    fn target(
        &mut self,
        key: StepKey,
        number: usize,
        qualifier: Qualifier,
        target: &Target,
        condition: Option<&Expr>,
        action: &Action,
    ) -> Option<Named> {
        let home = Some(key.0);
        if let Target::Work(work) = target {
            let name = self.body(key, number, qualifier, work, condition, action);
            return Some(("sectionName", name));
        }
        if let Some(condition) = condition {
            self.speech.cannot(condition.at, say!("a condition of an action"));
        }
        match target {
            Target::Direct(text, at) => {
                let own = self.speech.expr(&nodes::expr(ExprKind::Direct(text.clone()), at.0), home);
                let name = match own.kind {
                    ExprKind::Direct(text) => format!("%{text}"),
                    ExprKind::Path(path) => path.text(),
                    _ => String::new(),
                };
                Some(("variableName", name))
            }
            Target::Path(path) => match self.speech.scopes.refer(home, &path.names) {
                Some(Ref::Var(var)) => Some(("variableName", self.speech.names.var(var).to_string())),
                Some(Ref::Action(own, named)) => {
                    Some(("sectionName", self.speech.names.part(own, &named.name.text).to_string()))
                }
                _ => {
                    self.speech.cannot(action.at, say!("an action that is no variable"));
                    None
                }
            },
            Target::Element(element) => {
                self.speech.cannot(element.at, say!("an element of an array"));
                None
            }
            Target::Work(_) => None,
        }
    }

    /// A body with a condition becomes an IF. It is evaluated later there than here, so that the condition may
    /// only read what does not change in between: inputs and steps.
    fn guarded(&mut self, key: StepKey, qualifier: Qualifier, condition: &Expr, list: Vec<Stmt>) -> Stmt {
        // A pulse is one of the step and the condition together.
        if qualifier != Qualifier::N || !self.is_steady(key.0, condition) {
            self.speech.cannot(condition.at, say!("such a condition of an action"));
        }
        let condition = self.speech.expr(condition, Some(key.0));
        let at = condition.at.0;
        nodes::when(condition, list, Vec::new(), at)
    }

    /// True if the actions of a scan cannot change a condition.
    fn is_steady(&self, chart: usize, e: &Expr) -> bool {
        match &e.kind {
            ExprKind::Literal(_) => true,
            ExprKind::Path(path) => match self.speech.scopes.refer(Some(chart), &path.names) {
                Some(Ref::Active(_) | Ref::Time(_)) => true,
                Some(Ref::Var(key)) => {
                    let kind = self.speech.scopes.decl(key).map(|d| d.kind);
                    matches!(kind, Some(VarKind::Input | VarKind::Const))
                }
                _ => false,
            },
            ExprKind::Unary(UnaryOp::Not | UnaryOp::Neg, inner) => self.is_steady(chart, inner),
            ExprKind::Binary(_, a, b) => self.is_steady(chart, a) && self.is_steady(chart, b),
            ExprKind::Unary(..)
            | ExprKind::Element(..)
            | ExprKind::List(_)
            | ExprKind::Direct(_)
            | ExprKind::Timer { .. }
            | ExprKind::Call(..)
            | ExprKind::Bad => false,
        }
    }

    fn locals(&mut self, block: &Block) {
        if !block.locals.is_empty() {
            self.speech.cannot(block.at, say!("variables of a body"));
        }
    }

    /// A named action of a chart, or of the file.
    pub(super) fn named(&mut self, home: Option<usize>, action: &NamedAction) {
        let block = action.body.block();
        self.locals(block);
        if action.comment.is_some() {
            self.speech.leave_out(action.at, say!("a comment"));
        }
        let text = self.speech.body(&block.statements, home, action.at);
        let name = self.speech.names.part(home, &action.name.text).to_string();
        self.action_sections.push(section("actionSource", &name, &text));
    }

    /// A transition section of a chart, or of the file.
    pub(super) fn section(&mut self, home: Option<usize>, of: &Section) {
        self.locals(&of.body);
        let name = self.speech.names.part(home, &of.name.text).to_string();
        let text = match of.body.statements.as_slice() {
            [Stmt { kind: g7_model::StmtKind::Assign { value, .. }, .. }] if of.short => {
                let text = self.speech.condition(value, home);
                alone(&name, text)
            }
            list => {
                self.speech.output = Some((of.name.text.clone(), name.clone()));
                let text = self.speech.body(list, home, of.at);
                self.speech.output = None;
                text
            }
        };
        self.transition_sections.push(section("transitionSource", &name, &text));
    }

    /// The condition of a transition: a name, or a section of its own for anything longer.
    pub(super) fn receptivity(&mut self, chart: usize, t: &Transition) -> Element {
        let (inverted, inner) = match &t.receptivity.kind {
            ExprKind::Unary(UnaryOp::Not, inner) => (true, &**inner),
            _ => (false, &t.receptivity),
        };
        let short = self.short(chart, inner);
        let inverted = inverted && short.is_some();
        let (tag, name) = short.unwrap_or_else(|| {
            self.conditions += 1;
            let wish = t.label.as_ref().map_or(format!("T{}", self.conditions), |l| l.text.to_string());
            let name = self.speech.names.free(&wish);
            let text = self.speech.condition(&t.receptivity, Some(chart));
            self.transition_sections.push(section("transitionSource", &name, &alone(&name, text)));
            ("sectionName", name)
        });
        Element::new("transitionCondition")
            .with("invertLogic", inverted)
            .child(Element::with_text(tag, &name))
    }

    /// A condition that is a name or a constant.
    fn short(&mut self, chart: usize, e: &Expr) -> Option<Named> {
        match &e.kind {
            ExprKind::Path(path) => match self.speech.scopes.refer(Some(chart), &path.names) {
                Some(Ref::Section(home, section)) => {
                    Some(("sectionName", self.speech.names.part(home, &section.name.text).to_string()))
                }
                Some(Ref::Var(_) | Ref::Member(..) | Ref::Active(_)) => {
                    Some(("variableName", self.speech.condition(e, Some(chart))))
                }
                _ => None,
            },
            ExprKind::Direct(_) => Some(("variableName", self.speech.condition(e, Some(chart)))),
            _ if constant(e) => Some(("variableName", self.speech.condition(e, Some(chart)))),
            _ => None,
        }
    }
}

fn element(qualifier: Qualifier, tag: &str, name: &str, time: &str) -> Element {
    Element::new("action")
        .with("qualifier", qualifier.name())
        .child(Element::new("actionName").child(Element::with_text(tag, name)))
        .child(Element::new("tValue").child(Element::with_text("tLiteral", time)))
}

/// A section of only an expression. One with `:=` in it would be read as statements.
fn alone(name: &str, text: String) -> String {
    if text.contains(":=") { format!("{name} := {text};") } else { text }
}

fn section(tag: &str, name: &str, text: &str) -> Element {
    Element::new(tag).with("name", name).child(Element::with_text("STSource", text))
}
