//! Turns action types, and the links that assign them to steps, into actions.

use std::collections::{HashMap, HashSet};

use g7_model::{
    Action, ActionKind, Expr, ExprKind, Literal, Name, Nanos, Order, Path, Qualifier, Said, Situation, Span,
    Stmt, StmtKind, Target, Work, codes, say,
};

use super::naming::Names;
use super::read::{Plan, Thing, VarSort, kind};
use super::refs::Xml;
use super::terms::{Delay, Terms, bad, literal};
use g7_iec::report::{Report, shown};
use g7_iec::xml::attr;

/// The actions of each step, by chart and number.
pub(super) type OfSteps = HashMap<(usize, usize), Vec<Action>>;

/// The actions of all steps, in the order of their links.
pub(super) fn of_steps(plan: &Plan, names: &Names, left: &mut usize, report: &mut Report) -> OfSteps {
    let mut actions: OfSteps = HashMap::new();
    let mut used = HashSet::new();
    for link in plan.sheets.iter().flat_map(|s| &s.links) {
        let Some((step, action)) = ends(plan, *link, report) else { continue };
        used.insert(action);
        let Some(xml) = plan.actions.get(action) else { continue };
        let terms = Terms { plan, names, report, left, sheet: step.0 };
        if let Some(action) = (Reader { terms, step }).action(*xml) {
            actions.entry(step).or_default().push(action);
        }
    }
    for (number, xml) in plan.actions.iter().enumerate() {
        if !used.contains(&number) {
            let what = say!("an action that no step has; it is left out");
            report.element(&codes::LEFT_OUT, "actionTypes", &attr::head(*xml), what);
        }
    }
    actions
}

/// The step and the action that a link connects.
fn ends(plan: &Plan, link: Xml, report: &mut Report) -> Option<((usize, usize), usize)> {
    for name in ["step", "actionType"] {
        if link.attribute(name).is_none() {
            let what = say!("a link of an action without its `{name}`; it is left out");
            report.say(&codes::OPEN_LINK, &attr::head(link), what);
            return None;
        }
    }
    let (step, at) = plan.thing(link, "step", report)?;
    let Thing::Step(sheet, step) = step else {
        report.say(&codes::UNKNOWN_OBJECT, &at, say!("the `step` of this link is no step"));
        return None;
    };
    let (action, at) = plan.thing(link, "actionType", report)?;
    let Thing::Action(action) = action else {
        report.say(&codes::UNKNOWN_OBJECT, &at, say!("the `actionType` of this link is no action"));
        return None;
    };
    Some(((sheet, step), action))
}

struct Reader<'p, 'a> {
    terms: Terms<'p, 'a>,
    step: (usize, usize),
}

impl<'a> Reader<'_, 'a> {
    fn action(&mut self, xml: Xml<'a>) -> Option<Action> {
        let at = attr::head(xml);
        let kind = match kind(xml) {
            Some("ContinuousAction") => self.continuous(xml),
            Some("StoredAction") => self.stored(xml),
            Some("ForcingOrder") => self.forcing(xml)?,
            other => {
                let class = shown(other.unwrap_or(""));
                let what = say!("an action of the class `{class}`, which the meta-model does not have");
                self.terms.report.say(&codes::NOT_CARRIED, &at, what);
                return None;
            }
        };
        Some(Action { kind, at: self.terms.report.span(&at).into() })
    }

    fn continuous(&mut self, xml: Xml<'a>) -> ActionKind {
        let at = attr::head(xml);
        let span = self.terms.report.span(&at);
        let term = self.terms.of(xml, "term");
        let condition = match xml.attribute("continuousActionType").unwrap_or("continuousAction") {
            "continuousAction" => {
                if term.is_some() {
                    let what = say!("the term has no effect: `continuousActionType` is continuousAction");
                    self.terms.report.say(&codes::LEFT_OUT, &at, what);
                }
                None
            }
            "assignationCondition" => {
                if term.is_none() {
                    let what = say!("an action with an assignation condition that is not there; it has none");
                    self.terms.report.say(&codes::DIFFERENT, &at, what);
                }
                term
            }
            other => {
                let what =
                    say!("`continuousActionType` is `{}`, which the meta-model does not have", shown(other));
                self.terms.report.say(&codes::BAD_VALUE, &at, what);
                None
            }
        };
        let delay = self.terms.delay(xml);
        let timed = |time: Nanos| Some(literal(Literal::Time(time), span));
        let (qualifier, time, condition) = match (condition, delay) {
            (None, Delay::None) => (Qualifier::N, None, None),
            // The term of an action without a condition is the activity of its step.
            (None, Delay::Delayed(t)) => (Qualifier::D, timed(t), None),
            (None, Delay::Limited(t)) => (Qualifier::L, timed(t), None),
            (None, delay) => {
                let activity = self.terms.names.activity(self.step, self.step.0, span);
                (Qualifier::N, None, Some(delay.around(activity, span)))
            }
            (Some(e), delay) => (Qualifier::N, None, Some(delay.around(e, span))),
        };
        let target = match self.variable(xml).kind {
            ExprKind::Path(path) => path,
            _ => Path { names: vec![Name::new("", span)] },
        };
        ActionKind::Qualified { qualifier, time, target: Target::Path(target), condition }
    }

    fn stored(&mut self, xml: Xml<'a>) -> ActionKind {
        let at = attr::head(xml);
        let span = self.terms.report.span(&at);
        let target = self.variable(xml);
        let value = self.terms.of(xml, "value").unwrap_or_else(|| {
            self.terms.report.say(&codes::BAD_TEXT, &at, say!("a stored action without a value"));
            bad(span)
        });
        let statement = Stmt { kind: StmtKind::Assign { target, value }, at: span.into() };
        let work = Work::Single(Box::new(statement));
        let condition = self.terms.of(xml, "term");
        let qualifier = match xml.attribute("storedActionType").unwrap_or("activation") {
            "activation" => Qualifier::P1,
            "deactivation" => Qualifier::P0,
            "event" => {
                let event = condition.unwrap_or_else(|| {
                    self.terms.report.say(
                        &codes::BAD_TEXT,
                        &at,
                        say!("a stored action on an event that is not there"),
                    );
                    bad(span)
                });
                return ActionKind::OnEvent { event, work };
            }
            other => {
                let what =
                    say!("`storedActionType` is `{}`, which the meta-model does not have", shown(other));
                self.terms.report.say(&codes::BAD_VALUE, &at, what);
                Qualifier::P1
            }
        };
        ActionKind::Qualified { qualifier, time: None, target: Target::Work(work), condition }
    }

    /// The variable that an action writes.
    fn variable(&mut self, xml: Xml<'a>) -> Expr {
        let at = attr::head(xml);
        let span = self.terms.report.span(&at);
        let Some(variable) = xml.children().find(|c| c.has_tag_name("variable")) else {
            self.terms.report.say(&codes::BAD_TEXT, &at, say!("an action without a variable"));
            return bad(span);
        };
        if let Some((Thing::Var(number), place)) = self.declared(variable)
            && self.terms.plan.vars.get(number).is_some_and(|v| v.sort == VarSort::Step)
        {
            let what = say!("an action writes the activity of a step; only a forcing order does");
            self.terms.report.say(&codes::NOT_CARRIED, &place, what);
            return bad(span);
        }
        self.terms.read(variable)
    }

    /// The meaning of an action's variable; reports nothing if there is none.
    fn declared(&self, xml: Xml<'a>) -> Option<(Thing, std::ops::Range<usize>)> {
        let text = attr::text(xml, "variableDeclaration")?;
        let target = self.terms.plan.refs.resolve(text.text.trim()).ok()?;
        self.terms.plan.things.get(&target.id()).map(|thing| (*thing, text.at))
    }

    fn forcing(&mut self, xml: Xml<'a>) -> Option<ActionKind> {
        let at = attr::head(xml);
        let span = self.terms.report.span(&at);
        let Some((chart, place)) = self.terms.plan.thing(xml, "partialGrafcet", self.terms.report) else {
            if xml.attribute("partialGrafcet").is_none() {
                self.terms.report.say(&codes::BAD_TEXT, &at, say!("a forcing order without a chart"));
            }
            return None;
        };
        let Thing::Sheet(chart) = chart else {
            self.terms.report.say(&codes::UNKNOWN_OBJECT, &place, say!("what is forced is no chart"));
            return None;
        };
        let explicit = || xml.attribute("forcedSteps").is_some_and(|s| !s.trim().is_empty());
        let sort = xml.attribute("forcingOrderType").unwrap_or("currentSituation");
        let situation = match sort {
            "currentSituation" => Situation::Current,
            "emptySituation" => Situation::Steps(Vec::new()),
            "initialSituation" => Situation::Init,
            "explicitSituation" => Situation::Steps(self.forced_steps(xml, chart, span)),
            other => {
                let what =
                    say!("`forcingOrderType` is `{}`, which the meta-model does not have", shown(other));
                self.terms.report.say(&codes::BAD_VALUE, &at, what);
                return None;
            }
        };
        if sort != "explicitSituation" && explicit() {
            let what = say!("the forced steps have no effect: `forcingOrderType` is {}", Said::foreign(sort));
            self.terms.report.say(&codes::LEFT_OUT, &at, what);
        }
        let name = Name::new(self.terms.names.chart(chart), span);
        Some(ActionKind::Order(Order::Force(name, situation)))
    }

    fn forced_steps(&mut self, xml: Xml<'a>, chart: usize, span: Span) -> Vec<Name> {
        let mut steps = Vec::new();
        for (thing, place) in self.terms.plan.things(xml, "forcedSteps", self.terms.report) {
            match thing {
                Thing::Step(sheet, step) if sheet == chart => {
                    steps.push(Name::new(self.terms.names.step(sheet, step), span));
                }
                _ => {
                    let name = shown(self.terms.names.chart(chart));
                    let what = say!("a forced step that is no step of the chart `{name}`");
                    self.terms.report.say(&codes::UNKNOWN_OBJECT, &place, what);
                }
            }
        }
        steps
    }
}
