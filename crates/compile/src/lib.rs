//! From a document to a program.
//!
//! ```text
//! model::Document -> resolve (names, types) -> ir::Unit -> check (rules of GRAFCET and SFC)
//!                                                       -> lower -> engine::Program + Symbols
//! ```
//!
//! What an author did wrong is a [`Problem`], never an `Err` and never a panic;
//! a document with problems still gives all the others that it has.
#![forbid(unsafe_code)]

pub mod check;
pub mod ir;
pub mod lower;
mod mentions;
pub mod plant;
pub mod references;
pub mod resolve;
pub mod symbols;

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
    /// A code for each query, in their order, for `engine::eval`.
    pub queries: Vec<Code>,
    /// The type of each query.
    pub query_types: Vec<Type>,
}

/// What is wrong with a document and its plants, in the order of the text. Plants
/// are judged where the charts they answer are right.
pub fn check(doc: &Document) -> Vec<Problem> {
    let (charts, mut problems) = compile(doc);
    if let Some(charts) = charts {
        for plant in plant::plants(doc) {
            problems.extend(plant::compile_plant(doc, plant, &charts, &[]).1);
        }
    }
    sorted(problems)
}

/// The program of a document; none if a problem is an error.
pub fn compile(doc: &Document) -> (Option<Compiled>, Vec<Problem>) {
    compile_with(doc, None, &[])
}

/// The same under another profile than the document's, without its switches.
pub fn compile_as(doc: &Document, profile: ProfileName) -> (Option<Compiled>, Vec<Problem>) {
    compile_with(doc, Some(profile), &[])
}

/// The same with questions that can be put to a state of the program: any
/// expression without edges and delays, names as seen from outside of all charts.
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
    let judged = clear(check::check(doc, &unit), &problems);
    problems.extend(judged);
    let failed = problems.iter().any(|p| p.severity() == Severity::Error);
    if failed || questions.len() < queries.len() {
        return (None, sorted(problems));
    }
    match lower::program(&unit, &questions) {
        Ok((program, symbols, queries)) => {
            let program = Arc::new(program);
            let query_types = questions.iter().map(|q| q.ty).collect();
            (Some(Compiled { unit, program, symbols, queries, query_types }), sorted(problems))
        }
        Err(problem) => {
            problems.push(problem);
            (None, sorted(problems))
        }
    }
}

/// The problems that are none of something that has no meaning yet: what could
/// not be resolved stands for FALSE, and is not to be judged as that; where a
/// transition or nesting had to be left out, ways that lead nowhere are no news.
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

/// By place, and at one place as they were found.
fn sorted(mut problems: Vec<Problem>) -> Vec<Problem> {
    problems.sort_by_key(|p| p.at);
    problems
}
