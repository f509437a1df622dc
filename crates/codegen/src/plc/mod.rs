//! Code for PLCs, printed from the equations of a chart: the same as Structured
//! Text, Instruction List and Ladder.
//!
//! ```text
//! Equations -> spare (less to read) -> scan, terms (statements with names) -> ST | IL | Ladder | AWL
//!                                                                             +-> families: ST of a maker
//! ```
//!
//! # Invariants
//!
//! - The equations do what the engine does, scan by scan; the tests run both.
//! - What a form cannot say is refused with its place, never printed wrong.

mod ascii;
mod awl;
mod dialect;
mod drawn;
mod families;
mod form;
mod il;
mod ladder;
mod ld;
mod memories;
mod names;
mod native;
mod scan;
mod shared;
mod signals;
mod st;
mod terms;
mod variables;

use std::collections::HashMap;

pub use ascii::ascii;

use dialect::Dialect;
use g7_compile::Compiled;
use g7_engine::{Addr, StepId};
use g7_model::{Problem, Severity, codes, say};

/// The form of the equations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// Structured Text.
    St,
    /// Instruction List.
    Il,
    /// Instruction List in the manner of DOLOG80: a memory for each receptivity,
    /// steps that are set and reset.
    Dolog80,
    /// Ladder, as PLCopen XML.
    Ld,
    /// Ladder, drawn (SVG).
    Drawing,
    /// AWL (STL) of Siemens for S7-300 and S7-400, with a symbol table.
    Awl,
    /// SCL of Siemens for TIA Portal, with a table of PLC tags.
    Scl,
    /// A POU of TwinCAT 3 (`.TcPOU`).
    TwinCat,
    /// A program of Logix with a routine in Structured Text (L5X).
    Logix,
    /// A section of Control Expert in Structured Text (`.XST`).
    Unity,
}

impl Form {
    /// All forms, in the order in which they are offered: by the command line and by the page.
    pub const ALL: [Form; 10] = [
        Form::St,
        Form::Il,
        Form::Dolog80,
        Form::Ld,
        Form::Drawing,
        Form::Awl,
        Form::Scl,
        Form::TwinCat,
        Form::Logix,
        Form::Unity,
    ];

    /// Its word, its title, and the ending of its file.
    fn facts(self) -> [&'static str; 3] {
        match self {
            Form::St => ["st", "Structured Text", "st"],
            Form::Il => ["il", "Instruction List", "il"],
            Form::Dolog80 => ["dolog80", "Instruction List, set and reset", "il"],
            Form::Ld => ["ld", "Ladder (PLCopen XML)", "xml"],
            Form::Drawing => ["ladder", "Ladder, drawn", "svg"],
            Form::Awl => ["awl", "Siemens AWL (S7-300, S7-400)", "awl"],
            Form::Scl => ["scl", "Siemens SCL (TIA Portal)", "scl"],
            Form::TwinCat => ["twincat", "TwinCAT 3 (TcPOU)", "TcPOU"],
            Form::Logix => ["logix", "Logix 5000 (L5X)", "L5X"],
            Form::Unity => ["unity", "Control Expert (XST)", "XST"],
        }
    }

    /// The word that names it.
    pub fn word(self) -> &'static str {
        self.facts()[0]
    }

    /// Its name in a list.
    pub fn title(self) -> &'static str {
        self.facts()[1]
    }

    /// The ending of its file.
    pub fn ending(self) -> &'static str {
        self.facts()[2]
    }

    fn dialect(self) -> Dialect {
        let standard = Dialect { set_reset: self == Form::Dolog80, ..Dialect::default() };
        match self {
            // The blocks of these are called otherwise, or count otherwise.
            Form::Awl => Dialect { own_blocks: false, longest: 24, ..standard },
            Form::Scl | Form::TwinCat => Dialect { own_blocks: false, ..standard },
            Form::Logix => Dialect { own_blocks: false, longest: 40, ..standard },
            Form::Unity => Dialect { own_blocks: false, longest: 32, ..standard },
            Form::St | Form::Il | Form::Dolog80 | Form::Ld | Form::Drawing => standard,
        }
    }
}

/// Equations that were printed.
#[derive(Clone, Debug)]
pub struct Printed {
    /// The text.
    pub text: String,
    /// Files that belong to it, by their endings: a table of symbols.
    pub beside: Vec<(&'static str, String)>,
    /// The name of the function block.
    pub name: String,
    /// The constructs that are printed with a difference.
    pub problems: Vec<Problem>,
    steps: Vec<String>,
    variables: HashMap<u32, (String, u32)>,
}

impl Printed {
    /// The memory of a step.
    pub fn step(&self, step: StepId) -> &str {
        self.steps.get(step.0 as usize).map_or("", String::as_str)
    }

    /// The name of a variable, and how many elements it has.
    pub fn variable(&self, addr: Addr) -> Option<(&str, u32)> {
        self.variables.get(&addr.0).map(|(n, k)| (n.as_str(), *k))
    }
}

/// Prints a chart as a function block for a PLC.
///
/// `name` is what the block is called, `source` the text of the chart, for comments.
///
/// # Errors
///
/// The constructs that the form cannot say, with their places in the chart.
pub fn print(compiled: &Compiled, form: Form, name: &str, source: &str) -> Result<Printed, Vec<Problem>> {
    let dialect = form.dialect();
    let dates = dates(compiled);
    if !dates.is_empty() {
        return Err(dates);
    }
    let (block, memories, problems) = scan::block(compiled, name, source, dialect);
    if problems.iter().any(|p| p.severity() == Severity::Error) {
        return Err(problems);
    }
    let place = compiled.symbols.charts.first().map_or(g7_model::Span::default(), |c| c.at);
    if block.variables.is_empty() && block.parts.iter().all(Vec::is_empty) {
        let what = say!("there is nothing to print: neither a step nor a variable nor a body");
        return Err(vec![Problem::new(&codes::NOT_CARRIED, place, what)]);
    }
    let mut beside = Vec::new();
    let text = match form {
        Form::St => st::print(&block),
        Form::Il | Form::Dolog80 => il::print(&block, dialect.set_reset),
        Form::Awl => {
            let (text, symbols) = awl::print(&block, place)?;
            beside.push(("asc", symbols));
            text
        }
        Form::Scl => {
            let (text, tags) = families::scl(&block, place)?;
            beside.push(("tags.xml", tags));
            text
        }
        Form::TwinCat => families::twincat(&block, place)?,
        Form::Logix => families::logix(&block, place)?,
        Form::Unity => families::unity(&block, place)?,
        Form::Ld | Form::Drawing => {
            let ladder = ladder::ladder(&block, place, form == Form::Ld)?;
            if form == Form::Ld { ld::print(&block.name, &ladder) } else { drawn::draw(&block.name, &ladder) }
        }
    };
    let variables = memories.shown.into_iter().map(|(addr, name, n)| (addr.0, (name, n))).collect();
    Ok(Printed { text, name: block.name, beside, problems, steps: memories.steps, variables })
}

/// The refusal of dates and times of day: they are durations here, and the TIME of a controller holds some weeks.
fn dates(compiled: &Compiled) -> Vec<Problem> {
    let mut problems: Vec<Problem> = Vec::new();
    for v in compiled.symbols.variables.iter().filter(|v| v.ty.is_moment()) {
        let what = say!("a {} cannot be printed as code for PLCs", v.ty);
        if problems.iter().all(|p| p.at != v.at) {
            problems.push(Problem::new(&codes::NOT_CARRIED, v.at, what));
        }
    }
    problems
}
