//! The stages of a compilation, one after the other: resolve, check, lower.
//!
//! The root compiles the charts with it, and `plant` the program of a plant. No program comes out
//! while a problem is an error, and problems that only follow from others are dropped.

use std::borrow::Cow;
use std::collections::HashSet;
use std::sync::Arc;

use g7_engine::{Code, Program};
use g7_model::composed::{Composition, decomposed};
use g7_model::instances::instantiated;
use g7_model::linked::unusable;
use g7_model::named::{Checker, declared, held};
use g7_model::{Document, Expr, Item, Problem, ProfileName, PropertyKind, Severity, Span, Type, codes, say};

use crate::symbols::Symbols;
use crate::tree::{Expr as Tree, Piece};
use crate::{allow, check, ir, lower, resolve};

/// A document that can be run.
#[derive(Clone, Debug)]
pub struct Compiled {
    /// Its typed form.
    pub unit: ir::Unit,
    /// Its program, shared by all that run it.
    pub program: Arc<Program>,
    /// Names and places of everything in the program.
    pub symbols: Symbols,
    /// One code for each query, in their order, for `engine::eval`.
    pub queries: Vec<Code>,
    /// The type of each query.
    pub query_types: Vec<Type>,
    /// The tree of each piece of the program's code.
    pub pieces: lower::Pieces,
}

impl Compiled {
    /// The tree of code that gives a value; `None` for an empty one.
    pub fn condition(&self, code: Code) -> Option<&Tree> {
        match self.pieces.get(code)? {
            Piece::Value(e) => Some(e),
            Piece::Work(_) => None,
        }
    }
}

/// Compiles a document; returns no program if a problem is an error.
pub fn compile(doc: &Document) -> (Option<Compiled>, Vec<Problem>) {
    compile_with(doc, None, &[])
}

/// Compiles a document under another profile than its own; the switches of its profile are dropped.
pub fn compile_as(doc: &Document, profile: ProfileName) -> (Option<Compiled>, Vec<Problem>) {
    compile_with(doc, Some(profile), &[])
}

/// Compiles a document together with questions that can be asked of a state of the program. A
/// question is any expression without edges and delays; its names are looked up as if it stood
/// outside of all charts.
pub fn compile_with(
    doc: &Document,
    profile: Option<ProfileName>,
    queries: &[Expr],
) -> (Option<Compiled>, Vec<Problem>) {
    let (typed, mut undone) = declared(doc);
    // Callers join the used files before they compile, so a `use` that is still here was not read. The parser has
    // reported a `use` without a name.
    let unread = doc.uses().filter(|used| !used.name.text.is_empty());
    undone.extend(unread.map(|used| unusable(used, &say!("it was not read"))));
    let (instances, mut wrong) = instantiated(&typed);
    undone.append(&mut wrong);
    let (composed, mut wrong) = decomposed(&instances);
    undone.append(&mut wrong);
    let (plain, mut wrong) = held(&composed);
    undone.append(&mut wrong);
    let (asked, mut wrong) = asked(&instances, &composed, queries);
    undone.append(&mut wrong);
    let (compiled, problems) = compile_charts((doc, &instances), &plain, undone, profile, &asked);
    match (&instances, &plain) {
        (Cow::Borrowed(_), Cow::Borrowed(_)) => (compiled, problems),
        _ => (compiled, once(doc, problems)),
    }
}

/// The questions with plain names and numbers.
fn asked<'q>(
    instances: &Document,
    composed: &Document,
    queries: &'q [Expr],
) -> (Cow<'q, [Expr]>, Vec<Problem>) {
    let (mut asked, mut problems) = (Cow::Borrowed(queries), Vec::new());
    let none = queries.is_empty();
    let mut types = if none { None } else { Composition::of(instances) };
    let mut checker = if none { None } else { Checker::of(composed) };
    if types.is_none() && checker.is_none() {
        return (asked, problems);
    }
    for query in asked.to_mut() {
        if let Some((new, mut wrong)) = types.as_mut().map(|t| t.query(query)) {
            *query = new;
            problems.append(&mut wrong);
        }
        if let Some((new, mut wrong)) = checker.as_mut().map(|c| c.query(query)) {
            *query = new;
            problems.append(&mut wrong);
        }
    }
    (asked, problems)
}

/// A problem of a chart with several instances is told once, not for each of them; so is one of a function block.
fn once(doc: &Document, mut problems: Vec<Problem>) -> Vec<Problem> {
    let several = |i: &Item| match i {
        Item::Chart(c) => !c.params.is_empty() || c.block.is_some(),
        Item::Composed(_) => true,
        _ => false,
    };
    let charts: Vec<Span> = doc.items.iter().filter(|i| several(i)).map(Item::at).collect();
    let mut told = HashSet::new();
    problems.retain(|p| {
        let within = charts.iter().any(|c| c.file == p.at.file && c.start <= p.at.start && p.at.end <= c.end);
        !within || told.insert((p.at, p.code.id))
    });
    problems
}

/// Compiles a document whose charts have no parameters, and whose variables are elementary.
fn compile_charts(
    (written, instances): (&Document, &Document),
    doc: &Document,
    mut undone: Vec<Problem>,
    profile: Option<ProfileName>,
    queries: &[Expr],
) -> (Option<Compiled>, Vec<Problem>) {
    let (mut unit, mut scopes, mut problems) = resolve::resolve_open(doc, profile);
    problems.append(&mut undone);
    let mut questions = Vec::new();
    for query in queries {
        let (expr, mut wrong) = resolve::resolve_query(&mut unit, &mut scopes, query, None, None);
        questions.extend(expr);
        problems.append(&mut wrong);
    }
    problems.append(&mut properties(doc, &mut unit, &mut scopes));
    let unread = unread(doc);
    let gaps = !unread.is_empty();
    let judged = clear(check::check(instances, doc, &unit), &problems, unread);
    problems.extend(judged);
    if gaps || problems.iter().any(|p| p.severity() == Severity::Error) {
        // A part with an error may be the one that reads the input or leaves the step.
        let loose = [&codes::DEAD_END, &codes::NEVER_JOINS, &codes::INPUT_UNREAD, &codes::OUTPUT_UNDRIVEN];
        problems.retain(|p| !loose.contains(&p.code));
    }
    if is_part(written) {
        let loose =
            [&codes::CHART_UNUSED, &codes::UNUSED_VARIABLE, &codes::INPUT_UNREAD, &codes::OUTPUT_UNDRIVEN];
        problems.retain(|p| !loose.contains(&p.code));
    }
    allow::apply(doc, &mut problems);
    let failed = problems.iter().any(|p| p.severity() == Severity::Error);
    if failed || questions.len() < queries.len() {
        return (None, sorted(problems));
    }
    match lower::program(&unit, &questions) {
        Ok((program, symbols, queries, pieces)) => {
            let program = Arc::new(program);
            let query_types = questions.iter().map(|q| q.ty).collect();
            (Some(Compiled { unit, program, symbols, queries, query_types, pieces }), sorted(problems))
        }
        Err(problem) => {
            problems.push(problem);
            (None, sorted(problems))
        }
    }
}

/// True for a document that runs nothing, but has what a file that uses it can run: there it is used.
pub fn is_part(written: &Document) -> bool {
    let runs = |i: &Item| match i {
        Item::Chart(c) => c.params.is_empty() && c.block.is_none(),
        Item::Instance(_) | Item::Pre(..) | Item::Post(..) | Item::Plant(_) | Item::Test(_) => true,
        _ => false,
    };
    let offers =
        |i: &Item| matches!(i, Item::Chart(_) | Item::Composed(_) | Item::Type(_) | Item::Function(_));
    written.items.iter().any(offers) && !written.items.iter().any(runs)
}

/// Names and types of what is to be proved.
fn properties<'d>(doc: &'d Document, unit: &mut ir::Unit, scopes: &mut resolve::Scopes<'d>) -> Vec<Problem> {
    let mut problems = Vec::new();
    // Those with a plant may ask the plant as well: `verify` compiles them with it.
    for property in doc.properties().filter(|p| p.plant.is_none()) {
        for claim in property.kind.claims() {
            let (expr, mut wrong) = resolve::resolve_query(unit, scopes, claim, None, Some(Type::Bool));
            problems.append(&mut wrong);
            let is_assumed = matches!(property.kind, PropertyKind::Assume(_));
            if is_assumed && expr.is_some_and(|e| !reads_input(unit, &e)) {
                let what =
                    say!("an assumption tells what values inputs may have, and this one reads no input");
                let help = say!("name an input in it, or write what the chart does as `prove always …`");
                problems.push(Problem::new(&codes::ASSUMPTION, property.at.0, what).help(help));
            }
        }
    }
    problems
}

/// True if an expression reads an input.
fn reads_input(unit: &ir::Unit, e: &ir::Expr) -> bool {
    match &e.kind {
        ir::ExprKind::Var(v) | ir::ExprKind::Element(ir::Elements { first: v, .. }, _) => {
            unit.vars.get(v.index()).is_some_and(|v| v.class == ir::VarClass::Input)
                || e.operands().any(|e| reads_input(unit, e))
        }
        _ => e.operands().any(|e| reads_input(unit, e)),
    }
}

/// Drops follow-up problems of parts that failed to resolve. An unresolved expression stands for
/// FALSE and must not be checked as if the author had written that; and where a transition or a
/// nesting was left out, unreachable steps follow from it.
fn clear(mut found: Vec<Problem>, unresolved: &[Problem], unread: Vec<Span>) -> Vec<Problem> {
    let errors = || unresolved.iter().filter(|p| p.severity() == Severity::Error);
    let gaps = [
        &codes::UNKNOWN_STEP,
        &codes::UNKNOWN_CHART,
        &codes::EXPANSION_SHARED,
        &codes::NESTED_IN_ITSELF,
        &codes::NESTED_TOO_DEEPLY,
        &codes::ENCLOSED_TWICE,
        &codes::WRONG_KIND,
        &codes::NOT_HERE,
    ];
    if errors().any(|p| gaps.contains(&p.code)) {
        let loose = [&codes::UNREACHABLE, &codes::NEVER_STARTS, &codes::CHART_UNUSED];
        found.retain(|p| !loose.contains(&p.code));
    }
    let mut unclear: Vec<Span> = errors().map(|p| p.at).chain(unread).collect();
    unclear.sort_unstable();
    found.retain(|p| {
        let from = unclear.partition_point(|e| (e.file, e.start) < (p.at.file, p.at.start));
        unclear.get(from).is_none_or(|e| e.file != p.at.file || e.end > p.at.end)
    });
    found
}

/// The places of the receptivities that could not be read.
fn unread(doc: &Document) -> Vec<Span> {
    let transitions = doc.charts().flat_map(|c| c.transitions());
    transitions.filter(|t| !t.receptivity.is_read()).map(|t| t.receptivity.at.0).collect()
}

/// Sorts by place; problems at one place keep the order in which they were found.
pub(crate) fn sorted(mut problems: Vec<Problem>) -> Vec<Problem> {
    problems.sort_by_key(|p| p.at);
    problems
}
