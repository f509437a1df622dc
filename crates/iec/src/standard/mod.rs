//! Rewrites a document in the forms of IEC 61131-3.
//!
//! # Where this sits
//!
//! ```text
//! Document -> standard -> Document -> write (text, PLCopen XML)
//! ```
//!
//! The result can be printed as it is: its names are identifiers of IEC 61131-3, its paths are
//! `name`, `block.member`, `step.X` and `step.T`, and each element has a form in the standard.
//!
//! # What must hold
//!
//! - If no problem is reported, the result means the same as the document. Edges and delays become
//!   function blocks that a body before the charts calls, conditions of actions become bodies, and a
//!   step that another program observes drives a variable.
//! - An element without a form is an error with its place. An element that runs by other rules is a
//!   warning.

mod actions;
mod arrays;
mod assemble;
mod blocks;
mod bodies;
mod counts;
mod enumerations;
mod form;
mod identifiers;
mod idle;
mod instances;
mod lower;
mod macros;
mod structures;
mod watch;

use std::collections::HashSet;

use g7_model::composed::{as_block, as_document};
use g7_model::{Chart, Composed, Document, Item, Problem, Profile, ProfileName, codes, say};

use crate::signs;

use blocks::Blocks;
pub(crate) use counts::LONGEST;
use enumerations::Enumerations;
pub(crate) use form::Form;
use identifiers::Names;
pub(crate) use idle::without_idle;
use lower::Lower;
use structures::Structures;

/// The refusal of a chart without a step, for compilers that ask for a body.
pub(crate) fn without_steps(chart: &Chart) -> Option<Problem> {
    let what = || say!("the chart `{}` has no step, and a program has a body", chart.name.text);
    chart.steps().next().is_none().then(|| Problem::new(&codes::NOT_CARRIED, chart.name.at.0, what()))
}

/// Rewrites a document; returns it with the problems of what it does not carry.
pub(crate) fn standard(document: &Document, form: Form) -> (Document, Vec<Problem>) {
    let document = &signs::in_signs(document);
    let mut blocks = Blocks::of(document, form.words());
    let mut structures = Structures::of(document, &blocks, form);
    let (made, mut problems) = function_blocks(document, form, &mut blocks, &structures);
    let (mut out, mut own, mut names) = lowered(document, form, &blocks, &structures);
    out.items.splice(1..1, made.into_iter().map(Item::Composed));
    without_idle(&mut out);
    let (enumerations, changed) = Enumerations::of(document, form, &mut out, &mut names);
    problems.extend(changed);
    structures.name_values(&enumerations);
    structures.joined(&mut out);
    arrays::named(&mut out, &mut names);
    problems.append(&mut own);
    problems.extend(structures.changed());
    problems.sort_by_key(|p| (p.at.start, p.at.end));
    (out, problems)
}

/// Rewrites the function blocks of a document. Each stands behind those that it has instances of, so that their names are
/// known.
fn function_blocks(
    document: &Document,
    form: Form,
    blocks: &mut Blocks,
    structures: &Structures<'_>,
) -> (Vec<Composed>, Vec<Problem>) {
    let (mut all, mut problems) = (Vec::new(), Vec::from_iter(blocks.take_changed()));
    for c in document.composed().filter(|c| c.block) {
        let (made, mut own, names) = lowered(&unit(document, c), form, blocks, structures);
        problems.append(&mut own);
        let name = blocks.named(&c.name);
        let Some(renamed) = blocks.enter(c, &names) else { continue };
        all.push(Composed { name, ..as_block(c, made, |n| renamed.member(n).unwrap_or(n)) });
    }
    (all, problems)
}

/// A function block as a document, with the functions of the file.
fn unit(document: &Document, c: &Composed) -> Document {
    let profile = Profile { name: ProfileName::Iec61131, switches: Vec::new(), at: c.at };
    let functions = document.items.iter().filter(|i| matches!(i, Item::Function(_))).cloned();
    let items = std::iter::once(Item::Profile(profile)).chain(functions).chain(as_document(c).items);
    Document { items: items.collect(), notes: Vec::new() }
}

/// Rewrites all but the function blocks of a document. The first item of the result is the profile.
fn lowered(
    document: &Document,
    form: Form,
    blocks: &Blocks,
    structures: &Structures<'_>,
) -> (Document, Vec<Problem>, Names) {
    // The variables that several programs use, and the steps that are read, become known on the way,
    // so this repeats until no new one is found.
    let (mut shared, mut read_twins) = (HashSet::new(), HashSet::new());
    loop {
        let known = read_twins.len();
        let mut lower = Lower::new(document, form, (blocks, structures), shared, read_twins);
        let out = lower.document();
        if lower.wanted.is_subset(&lower.shared) && lower.read_twins.len() == known {
            let (problems, names) = lower.finish();
            return (out, problems, names);
        }
        read_twins = std::mem::take(&mut lower.read_twins);
        shared = std::mem::take(&mut lower.shared);
        shared.extend(lower.wanted);
    }
}
