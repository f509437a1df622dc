//! The dossier of a chart: cover and contents, the charts on sheets, tables of what stands in the file, tests and answers.
//!
//! # Where this sits
//!
//! ```text
//! rig::Source (document, texts) -> variables, references, listings -+
//! draw::sheets (charts on paper) -----------------------------------+-> flow (tables, texts, pages) -> Dossier: SVG
//! Evidence: tests and answers, as whoever ran them tells them ------+
//! ```
//!
//! Nothing is run or asked here, and no file is read: the command line and the page bring what they know.
//!
//! # What must hold
//!
//! - The same input gives the same sheets, byte for byte; the date is given by the caller.
//! - No text is cut: what a drawing shortens stands in full in a table. What is left out is named on the cover.
#![forbid(unsafe_code)]

mod charts;
mod cover;
mod data;
mod evidence;
mod flow;
mod listing;
mod recorded;
mod references;
mod sites;
mod table;
mod variables;
mod words;
mod writes;

pub use charts::print;
pub use data::{
    Answer, Dossier, Entry, Failure, Head, Input, Known, Missing, Part, Placed, Test, Verdict, View,
    title_block,
};
pub use recorded::{chronogram, on_paper, thinned};

/// Makes the dossier.
pub fn dossier(input: &Input<'_>) -> Dossier {
    // The contents stand before the charts, whose connectors name sheets: their length has to be known first.
    let mut contents = 1;
    loop {
        let mut flow = cover::begin(input, contents);
        for part in Part::ALL {
            if input.parts.contains(&part) {
                section(&mut flow, input, part);
            }
        }
        let needs = cover::sheets_of_contents(&flow);
        // It only grows, so that this ends: labels that name sheets may let a chart take one sheet more or less.
        if needs <= contents {
            cover::contents(&mut flow, input);
            return flow.done(input);
        }
        contents = needs;
    }
}

fn section(flow: &mut flow::Flow, input: &Input<'_>, part: Part) {
    match part {
        Part::Charts => charts::section(flow, input),
        Part::Signals => variables::signals(flow, input),
        Part::Variables => variables::variables(flow, input),
        Part::References => references::section(flow, input),
        Part::Bodies => listing::section(flow, input),
        Part::Plants => evidence::plants(flow, input),
        Part::Tests => evidence::tests(flow, input),
        Part::Proofs => evidence::proofs(flow, input),
        Part::Problems => evidence::problems(flow, input),
    }
}
