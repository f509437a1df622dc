//! From a document to a program.
//!
//! ```text
//! model::Document -> resolve (names, types) -> ir::Unit -> check (rules of GRAFCET and SFC)
//!                                                       -> lower -> engine::Program + Symbols
//! ```
//!
//! A mistake of the author is a [`Problem`], never an `Err` and never a panic. All problems of a
//! document are reported, not only the first.
#![forbid(unsafe_code)]

pub mod check;
mod circles;
pub mod ir;
pub mod lower;
pub mod plant;
pub mod references;
pub mod resolve;
pub mod symbols;
pub mod tree;

use std::sync::Arc;

use g7_engine::{Code, Program};
use g7_model::{Document, Expr, Problem, ProfileName, Severity, Span, Type, codes};

pub use references::{Definition, References, references};
use symbols::Symbols;

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

/// Returns the problems of a document and of its plants, in the order of the text. Plants are
/// checked only if the charts that they drive compile.
pub fn check(doc: &Document) -> Vec<Problem> {
    let (charts, mut problems) = compile(doc);
    if let Some(charts) = charts {
        for plant in plant::plants(doc) {
            problems.extend(plant::compile_plant(doc, plant, &charts, &[]).1);
        }
    }
    sorted(problems)
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
    let (mut unit, mut scopes, mut problems) = resolve::resolve_open(doc, profile);
    let mut questions = Vec::new();
    for query in queries {
        let (expr, mut wrong) = resolve::resolve_query(&mut unit, &mut scopes, query, None, None);
        questions.extend(expr);
        problems.append(&mut wrong);
    }
    problems.append(&mut properties(doc, &mut unit, &mut scopes));
    let judged = clear(check::check(doc, &unit), &problems);
    problems.extend(judged);
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

/// Names and types of what is to be proved.
fn properties<'d>(doc: &'d Document, unit: &mut ir::Unit, scopes: &mut resolve::Scopes<'d>) -> Vec<Problem> {
    let mut problems = Vec::new();
    for property in doc.properties() {
        for claim in property.kind.claims() {
            problems.append(&mut resolve::resolve_query(unit, scopes, claim, None, Some(Type::Bool)).1);
        }
    }
    problems
}

/// Drops follow-up problems of parts that failed to resolve. An unresolved expression stands for
/// FALSE and must not be checked as if the author had written that; and where a transition or a
/// nesting was left out, unreachable steps follow from it.
fn clear(mut found: Vec<Problem>, unresolved: &[Problem]) -> Vec<Problem> {
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
    let mut unclear: Vec<Span> = errors().map(|p| p.at).collect();
    unclear.sort_unstable();
    found.retain(|p| {
        let from = unclear.partition_point(|e| (e.file, e.start) < (p.at.file, p.at.start));
        unclear.get(from).is_none_or(|e| e.file != p.at.file || e.end > p.at.end)
    });
    found
}

/// Sorts by place; problems at one place keep the order in which they were found.
fn sorted(mut problems: Vec<Problem>) -> Vec<Problem> {
    problems.sort_by_key(|p| p.at);
    problems
}
