//! One scan of a chart as a structured list of typed assignments.
//!
//! ```text
//! compile::Compiled (tables, trees) -> Equations -> codegen (printed)
//!                                                -> verify (proved)
//!                                                -> Machine (a plain interpreter, for the tests)
//! ```
//!
//! This is the second form of a chart's meaning beside `engine`, made to be read:
//! every memory has a type and a name for what it stands for, every expression
//! has a value in every state, and nothing happens that no statement says.
//!
//! # Invariants
//!
//! - Equal to the engine, scan by scan, in every profile: the conformance cases
//!   and random charts run on both.
//! - No absolute time and no count of scans: equal memories have equal futures
//!   (but for [`StepTimes::Stamps`], which printed code asks for).
//! - The order of the statements is the order of the engine (SEMANTICS sections 3
//!   and 4), so that the first fault is the same.
//!
//! # Reading order
//!
//! `form.rs` (what equations consist of), `frame.rs` (a scan), `evolve.rs` (a
//! pass), `change.rs` (what follows from a change of steps), `control.rs`
//! (qualifiers), `code.rs` (receptivities, bodies), `bodies.rs` (the same piece by
//! piece), `run.rs` (the interpreter).
#![forbid(unsafe_code)]

mod apart;
mod bodies;
mod change;
mod clocks;
mod code;
mod control;
mod elements;
mod evolve;
mod fb;
pub mod form;
mod frame;
mod make;
mod run;
mod whole;

use g7_compile::Compiled;
use g7_engine::Addr;

pub use bodies::Bodies;
pub use fb::expand;
pub use form::{About, Class, Expr, Memory, MemoryId, Part, Section, Stmt, What};
pub use run::{Machine, Value};
pub use whole::{Equations, Options, StepTimes};

use form::Class as Lasts;
use make::{Make, lower};

/// The equations of a chart.
pub fn equations(compiled: &Compiled, options: Options) -> Equations {
    let mut m = Make::new(compiled, options);
    let rules = m.t.rules;
    // Made first: what the start leaves for the end of the scan is run there.
    let start = m.start();
    let mut pass = Vec::new();
    if let Some(changed) = m.changed() {
        let mut s = Section::new("Nothing has changed in this pass yet");
        s.body.push(lower(changed));
        pass.push(s);
    }
    pass.push(m.watches());
    pass.extend(m.opening());
    pass.extend(m.pass());
    let mut search = None;
    if rules.stable {
        let opening = m.flag(What::Opening);
        let mut s = Section::new("The pass has been made");
        s.body.push(lower(opening));
        pass.push(s);
        search = m.changed().map(|changed| (changed, rules.bound));
    }
    let finish = m.finish();
    let mut begin = vec![m.clocks(), m.nothing_late()];
    let mut frame = Section::new("As the scan begins");
    if rules.stable {
        let opening = m.flag(What::Opening);
        frame.body.push(Stmt::Set(opening, Expr::truth(true)));
    }
    if let Some(work) = m.known(What::Work) {
        frame.body.push(Stmt::Set(work, Expr::Const(g7_model::Type::Dint, 0)));
    }
    begin.push(frame);
    begin.push(start);
    let is_note = |w: &What| matches!(w, What::Conflict(_) | What::Ran(_));
    let notes: Vec<What> = m.memories.iter().map(|m| m.what).filter(is_note).collect();
    if let Some(frame) = begin.get_mut(2) {
        frame.body.extend(notes.into_iter().map(|what| lower(m.flag(what))));
    }
    let questions = compiled.queries.iter().map(|q| m.value(*q)).collect();
    let mut e =
        Equations { memories: Vec::new(), begin, pass, search, finish, questions, safe: safe(&mut m) };
    e.memories = m.memories;
    for list in [&mut e.begin, &mut e.pass, &mut e.finish] {
        list.retain(|s| s.body.iter().any(|s| !matches!(s, Stmt::About(_))));
    }
    e
}

/// The safe values of the outputs.
fn safe(m: &mut Make<'_>) -> Vec<(MemoryId, Box<[u64]>)> {
    let from = m.t.outputs.start;
    let outputs: Vec<(MemoryId, u32, usize)> = m
        .memories
        .iter()
        .enumerate()
        .filter_map(|(i, memory)| match (memory.class, memory.what) {
            (Lasts::Output, What::Variable(Addr(a))) => {
                Some((MemoryId(i as u32), a.checked_sub(from)?, memory.init.len()))
            }
            _ => None,
        })
        .collect();
    let words = |at: u32, n: usize| m.t.safe.get(at as usize..at as usize + n).unwrap_or_default().into();
    outputs.into_iter().map(|(id, at, n)| (id, words(at, n))).collect()
}
