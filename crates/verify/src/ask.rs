//! The questions of a document: those that are asked of every chart, and its author's. Those
//! `with` a plant are in `closed.rs`.

use g7_compile::Compiled;
use g7_compile::ir::VarClass;
use g7_engine::StepId;
use g7_model::{Document, Expr, Problem, ProfileName, Property, PropertyKind, Span};

use crate::question::{Claim, Query, Question};

/// A chart with all that is asked of it.
pub struct Asked {
    /// The chart, compiled with the conditions of questions and assumptions.
    pub compiled: Compiled,
    /// The questions, the author's last, in the order of the text.
    pub questions: Vec<Question>,
    /// The conditions that the environment keeps.
    pub assume: Vec<Query>,
}

/// Compiles a document with its questions; gives nothing if a problem is an error.
pub fn ask(document: &Document, profile: Option<ProfileName>) -> (Option<Asked>, Vec<Problem>) {
    let open = || document.properties().filter(|p| p.plant.is_none());
    let conditions: Vec<Expr> = open().flat_map(|p| p.kind.claims()).cloned().collect();
    let (compiled, mut problems) = g7_compile::compile_with(document, profile, &conditions);
    problems.dedup();
    let Some(compiled) = compiled else { return (None, problems) };
    // A part of others runs nothing: they are asked about it.
    let mut questions =
        if g7_compile::is_part(document) { Vec::new() } else { of_every_chart(document, &compiled) };
    let assume = of_the_author(open(), &mut questions);
    (Some(Asked { compiled, questions, assume }), problems)
}

/// Adds the questions of properties, whose conditions are numbered in their order; gives the assumptions.
pub(crate) fn of_the_author<'d>(
    properties: impl Iterator<Item = &'d Property>,
    questions: &mut Vec<Question>,
) -> Vec<Query> {
    let (mut assume, mut next) = (Vec::new(), 0u32);
    for property in properties {
        let first = next;
        next += property.kind.claims().count() as u32;
        match claim(property, first) {
            Some(claim) => questions.push(Question { claim, at: property.at.0 }),
            None => assume.push(Query(first)),
        }
    }
    assume
}

/// The claim of a property whose conditions begin at this query; `None` for an assumption.
fn claim(property: &Property, first: u32) -> Option<Claim> {
    let [a, b, c] = [first, first + 1, first + 2].map(Query);
    Some(match &property.kind {
        PropertyKind::Always(_) => Claim::Always(a),
        PropertyKind::Never(_) => Claim::Never(a),
        PropertyKind::Reachable(_) => Claim::Reachable(a),
        PropertyKind::After(_, time, _) => Claim::Within { cause: a, within: time.count(), effect: b },
        PropertyKind::Until(..) => Claim::Until { from: a, to: b, holds: c },
        PropertyKind::Between(..) => Claim::Between { from: a, to: b, never: c },
        PropertyKind::LeadsTo(..) => Claim::LeadsTo { cause: a, effect: b },
        PropertyKind::AtMost(most, list) => {
            Claim::AtMost(*most, (first..).take(list.len()).map(Query).collect())
        }
        PropertyKind::Assume(_) => return None,
    })
}

/// The questions that are asked of every chart.
pub(crate) fn of_every_chart(document: &Document, compiled: &Compiled) -> Vec<Question> {
    let (t, symbols) = (compiled.program.tables(), &compiled.symbols);
    let mut questions = Vec::new();
    let mut add = |claim, at: Span| questions.push(Question { claim, at });
    for step in (0..symbols.steps()).map(StepId).filter(|s| symbols.is_listed(*s)) {
        add(Claim::Active(step), symbols.step_place(step));
    }
    for rank in (0..symbols.transitions()).filter(|r| symbols.is_written(*r)) {
        add(Claim::Clears(rank), symbols.transition_place(rank));
    }
    for (rank, action) in (0u32..).zip(&symbols.actions).filter(|(_, a)| !a.hidden) {
        add(Claim::Runs(rank), action.at);
    }
    let one_word = |v: &&g7_compile::symbols::Variable| v.words() == 1;
    for v in symbols.variables.iter().filter(one_word) {
        match v.class {
            VarClass::Output => add(Claim::On(v.addr), v.at),
            VarClass::Input => add(Claim::Asked(v.addr), v.at),
            _ => {}
        }
    }
    let at = document.charts().next().map_or(Span::default(), |c| c.name.at.0);
    add(Claim::NoDeadlock, at);
    if t.transitions.iter().any(|t| t.shares) {
        add(Claim::NoConflict, at);
    }
    add(Claim::NoUnsafe, at);
    if t.rules.stable {
        add(Claim::NoInstability, at);
    }
    if t.rules.parallel_actions && (!t.action_lists.is_empty() || !t.events.is_empty()) {
        add(Claim::NoOpposedWrites, at);
    }
    if !t.orders.is_empty() {
        add(Claim::NoOpposedOrders, at);
    }
    add(Claim::NoFault, at);
    questions
}
