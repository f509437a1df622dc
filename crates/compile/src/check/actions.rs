//! What actions may be, and what they do to each other.

use std::collections::HashMap;

use g7_model::{Problem, Qualifier, Span, codes};

use super::tree::{has_edge, key};
use crate::ir::{Action, ActionKind, Step, StepSort, Stmt, StmtKind, Target, Unit, VarId};

pub(super) fn check(unit: &Unit, problems: &mut Vec<Problem>) {
    let grafcet = unit.rules.stable && unit.rules.parallel_actions;
    for step in &unit.steps {
        for action in &step.actions {
            one(unit, step, action, grafcet, problems);
        }
        two_times(unit, step, problems);
        if grafcet {
            disagree(unit, step, problems);
        }
    }
    classes(unit, grafcet, problems);
}

/// Rules for one action by itself.
fn one(unit: &Unit, step: &Step, action: &Action, grafcet: bool, problems: &mut Vec<Problem>) {
    if grafcet && matches!(step.sort, StepSort::Macro(_)) {
        let what = format!("macro-step `{}` has an action of its own", step.name);
        problems.push(Problem::new(&codes::MACRO_ACTS, action.at, what).help(
            "put it into the steps of the expansion; it runs here as long as the macro-step is active",
        ));
    }
    match &action.kind {
        ActionKind::OnEvent { event, .. } if grafcet && !has_edge(event) => {
            problems.push(
                Problem::new(
                    &codes::EVENT_WITHOUT_EDGE,
                    event.at,
                    "the event of a stored action needs an edge",
                )
                .help("write `↑` or `↓` before what makes the event, for example `on ↑a: …`"),
            );
        }
        ActionKind::Variable { qualifier, condition: Some(c), .. }
            if grafcet && !stored(*qualifier) && has_edge(c) =>
        {
            problems.push(
                Problem::new(
                    &codes::EDGE_IN_CONDITION,
                    c.at,
                    "the condition of a continuous action has an edge",
                )
                .help("an edge lasts no time: use a stored action, `on ↑a: V := TRUE`"),
            );
        }
        ActionKind::Named { qualifier: Qualifier::P, .. }
        | ActionKind::Work { qualifier: Qualifier::P, .. }
            if unit.rules.final_scan =>
        {
            problems.push(
                Problem::new(
                    &codes::PULSE_TWICE,
                    action.at,
                    "under `P` this body runs twice: in the pulse and in the final scan",
                )
                .help("write `P1`, which runs once, or set `no-final-scan`"),
            );
        }
        _ => {}
    }
}

fn stored(q: Qualifier) -> bool {
    matches!(q, Qualifier::S | Qualifier::R | Qualifier::P0 | Qualifier::P1 | Qualifier::P)
}

/// One action with two times in one step.
fn two_times(unit: &Unit, step: &Step, problems: &mut Vec<Problem>) {
    let mut seen: HashMap<(u8, u32), Span> = HashMap::new();
    for action in &step.actions {
        let (qualifier, target) = match &action.kind {
            ActionKind::Variable { qualifier, var, .. } => (qualifier, (0u8, var.0)),
            ActionKind::Named { qualifier, body, .. } => (qualifier, (1, body.0)),
            _ => continue,
        };
        if !qualifier.timed() {
            continue;
        }
        if let Some(first) = seen.insert(target, action.at) {
            let name = match target {
                (0, v) => unit.vars.get(v as usize).map(|v| &*v.name),
                (_, b) => unit.bodies.get(b as usize).map(|b| &*b.name),
            };
            let what = format!("`{}` has two timed qualifiers in one step", name.unwrap_or(""));
            problems.push(Problem::new(&codes::TWO_TIMES, action.at, what).related(first, "and this one"));
        }
    }
}

/// Stored actions of one moment that give one variable two values.
fn disagree(unit: &Unit, step: &Step, problems: &mut Vec<Problem>) {
    let mut seen: HashMap<(Qualifier, VarId), (String, Span)> = HashMap::new();
    for action in &step.actions {
        let writes = match &action.kind {
            ActionKind::Work {
                qualifier: q @ (Qualifier::P0 | Qualifier::P1),
                work,
                condition: None,
                ..
            } => work
                .iter()
                .filter_map(|s| plain_write(s))
                .map(|(v, e, at)| (*q, v, e, at))
                .collect::<Vec<_>>(),
            ActionKind::Variable {
                qualifier: q @ (Qualifier::S | Qualifier::R),
                var,
                condition: None,
                ..
            } => {
                let value = if *q == Qualifier::S { "Bool(true)" } else { "Bool(false)" };
                vec![(Qualifier::P1, *var, value.to_owned(), action.at)]
            }
            _ => continue,
        };
        // Within one action the later statement is simply the later one.
        for (q, v, value, at) in writes {
            match seen.get(&(q, v)) {
                Some((other, first)) if *other != value && !action.at_contains(*first) => {
                    let name = unit.vars.get(v.index()).map_or("", |v| &*v.name);
                    let what = format!("`{name}` gets two values at one moment");
                    problems.push(
                        Problem::new(&codes::TWO_VALUES, at, what)
                            .related(*first, "another value here")
                            .help("both are written when the step changes; keep one of them"),
                    );
                }
                _ => {
                    seen.insert((q, v), (value, at));
                }
            }
        }
    }
}

impl Action {
    fn at_contains(&self, span: Span) -> bool {
        self.at.start <= span.start && span.end <= self.at.end
    }
}

/// A variable written by a plain assignment of a constant.
fn plain_write(s: &Stmt) -> Option<(VarId, String, Span)> {
    match &s.kind {
        StmtKind::Assign(Target::Var(v), e) if matches!(e.kind, crate::ir::ExprKind::Const(_)) => {
            Some((*v, key(e), s.at))
        }
        _ => None,
    }
}

/// A variable that continuous actions drive and something else writes.
fn classes(unit: &Unit, grafcet: bool, problems: &mut Vec<Problem>) {
    let mut driven: HashMap<VarId, Span> = HashMap::new();
    let mut written: HashMap<VarId, Span> = HashMap::new();
    let mut blocked: Vec<VarId> = Vec::new();
    let bodies = unit.pre.iter().chain(&unit.post).chain(&unit.bodies);
    let mut stmts: Vec<&Stmt> = bodies.flat_map(|b| &b.statements).collect();
    stmts.extend(unit.transitions.iter().flat_map(|t| &t.on_clearing));
    let mut set_reset: Vec<(VarId, Span)> = Vec::new();
    for action in unit.steps.iter().flat_map(|s| &s.actions) {
        match &action.kind {
            ActionKind::Variable { qualifier: Qualifier::S | Qualifier::R, var, .. }
                if unit.rules.stored_set_reset =>
            {
                set_reset.push((*var, action.at));
            }
            ActionKind::Variable { qualifier, var, .. } => {
                driven.entry(*var).or_insert(action.at);
                if !matches!(qualifier, Qualifier::N | Qualifier::D | Qualifier::L) {
                    blocked.push(*var);
                }
            }
            ActionKind::Work { work, .. }
            | ActionKind::OnEvent { work, .. }
            | ActionKind::EachScan { work, .. } => {
                stmts.extend(work);
            }
            _ => {}
        }
    }
    // With a control block of its own, S and R of the variable are inputs of that.
    for (var, at) in set_reset.into_iter().filter(|(v, _)| !blocked.contains(v)) {
        written.entry(var).or_insert(at);
    }
    while let Some(s) = stmts.pop() {
        match &s.kind {
            StmtKind::Assign(Target::Var(v), _) => {
                written.entry(*v).or_insert(s.at);
            }
            StmtKind::Fb { outputs, .. } => {
                for (_, target) in outputs {
                    if let Target::Var(v) = target {
                        written.entry(*v).or_insert(s.at);
                    }
                }
            }
            StmtKind::If(arms, rest) => {
                stmts.extend(arms.iter().flat_map(|(_, b)| b));
                stmts.extend(rest);
            }
            StmtKind::Case(_, arms, rest) => {
                stmts.extend(arms.iter().flat_map(|(_, b)| b));
                stmts.extend(rest);
            }
            StmtKind::For { body, .. } | StmtKind::While(_, body) | StmtKind::Repeat(body, _) => {
                stmts.extend(body)
            }
            _ => {}
        }
    }
    let mut both: Vec<(VarId, Span, Span)> =
        driven.iter().filter_map(|(v, at)| written.get(v).map(|w| (*v, *at, *w))).collect();
    both.sort_by_key(|(v, ..)| *v);
    for (v, at, other) in both {
        let name = unit.vars.get(v.index()).map_or("", |v| &*v.name);
        let (code, what) = if grafcet {
            (
                &codes::TWO_CLASSES,
                format!("`{name}` is driven by a continuous action and written by a stored one"),
            )
        } else {
            (
                &codes::ALSO_WRITTEN,
                format!("`{name}` follows an action and is written by a statement as well"),
            )
        };
        problems.push(
            Problem::new(code, other, what)
                .related(at, "follows the activity of steps here")
                .help("use one of the two ways for a variable, not both"),
        );
    }
}
