//! Charts of other tools: read into a [`Document`], and written from one.
//!
//! # Where this sits
//!
//! ```text
//! foreign bytes -> recognise -> import -> model::Document -> print (.g7) or compile
//!                                         model::Document -> export -> foreign text
//! ```
//!
//! A folder a format. `xml` is the gate that every XML file goes through, and
//! `report` collects what each reader has to say.
//!
//! # What must hold
//!
//! - Nothing here panics or fails: what cannot be carried is a [`Problem`] with
//!   its place in the file, never dropped in silence. A warning: the rest runs as
//!   in the tool that wrote the file. An error: it would not.
//! - Every span of an imported document lies in the foreign file, so a message
//!   shows the author's own line.
//! - Time and memory are bounded by the size of the file, and that is bounded.
//! - Nothing is decided here about what a chart means: a reader chooses the
//!   profile, `compile` and `engine` do the rest.
#![forbid(unsafe_code)]

mod classicladder;
mod controlexpert;
mod flow;
mod format;
mod iec;
mod iectext;
mod jgrafchart;
mod l5x;
mod mermaid;
mod nodes;
mod outside;
mod plcopen;
mod report;
mod s7graph;
mod walk;
mod xmi;
mod xml;

use g7_model::{Document, FileId, Problem};

pub use format::{ENDINGS, Format, Outlet};

/// The foreign format of a file, by its content and, where that does not tell, the ending of its name.
///
/// `None`: it is none that is known here; then it is taken for a .g7 file.
/// `name` may be empty or any path.
pub fn recognise(name: &str, bytes: &[u8]) -> Option<Format> {
    Format::ALL.iter().copied().find(|f| f.fits(name, bytes))
}

/// Reads a file of a foreign format.
///
/// Always gives a document, as much of one as could be read, and what is wrong
/// or was not carried over, in the order of the file.
pub fn import(format: Format, bytes: &[u8], file: FileId) -> (Document, Vec<Problem>) {
    match format {
        Format::Jgrafchart => jgrafchart::import(bytes, file),
        Format::IecText => iectext::import(bytes, file),
        Format::Plcopen => plcopen::import(bytes, file),
        Format::Xmi => xmi::import(bytes, file),
        Format::ClassicLadder => classicladder::import(bytes, file),
        Format::ControlExpert => controlexpert::import(bytes, file),
        Format::S7Graph => s7graph::import(bytes, file),
        Format::L5x => l5x::import(bytes, file),
    }
}

/// A document in a foreign form.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Written {
    /// The file, UTF-8.
    pub text: String,
    /// What it does not carry, with its place in the document, in its order.
    /// With an error among them the file does not mean what the document means.
    pub problems: Vec<Problem>,
}

/// Writes a document in a foreign form.
///
/// The document must have been read without errors.
pub fn export(to: Outlet, document: &Document) -> Written {
    match to {
        Outlet::Mermaid => mermaid::export(document),
        Outlet::IecText => iectext::export(document),
        Outlet::Plcopen => plcopen::export(document),
        Outlet::Xmi => xmi::export(document),
        Outlet::Jgrafchart => jgrafchart::export(document),
    }
}
