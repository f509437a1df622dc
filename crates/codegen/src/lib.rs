//! Code for controllers, printed from the equations and the tables of a chart.
//!
//! ```text
//! equations of a scan                     -> flat       -> tree -> C99 | Rust | an Arduino sketch
//! equations of its code, tables, runtime  -> structured -> tree -> the same
//! equations of a scan                     -> plc        -> ST | IL | LD
//! C, names, types                         -> fmu        -> the files of an FMU
//! ```
//!
//! # Invariants
//!
//! - It evolves nothing and decides nothing: what the equations and the tables say is
//!   printed, and the code does what the engine does, scan by scan. The tests run
//!   both beside each other.
//! - What a language cannot say is refused with a [`Problem`], never printed wrong.
//! - The code needs no heap and no library. In the structured style its work follows
//!   the active steps; the flat style looks at every transition in every pass.
#![forbid(unsafe_code)]

mod acts;
mod arduino;
mod body;
mod build;
mod c;
mod c_types;
mod c_words;
mod chart;
mod facts;
mod files;
mod fixed;
mod flat;
pub mod fmu;
mod frame;
mod lets;
mod names;
mod operations;
mod output;
mod pack;
mod places;
pub mod plc;
mod project;
mod prune;
mod roll;
mod room;
mod runtime;
mod rust;
mod size;
mod spare;
mod tree;
mod turns;
mod vars;

use std::collections::{HashMap, HashSet};

use g7_compile::Compiled;
use g7_engine::{Addr, StepId};
use g7_model::{Problem, Severity, Span, codes, say};

use build::Gen;
pub use output::{File, Parts};
pub use project::{Project, is_own, with_project};
pub use room::{Clock, Room};
pub use size::{BOARDS, Board, Sizes};

/// A language that is printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Language {
    /// C99: a header and a source file.
    C,
    /// The same with a sketch round it.
    Arduino,
    /// A Rust module without the standard library.
    Rust,
}

/// How the evolution is written down; what it does is the same.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Style {
    /// The elements of the chart: tables of its steps and transitions, receptivities,
    /// actions. What a scan costs follows the active steps.
    #[default]
    Structured,
    /// Boolean equations with memories: the clearing condition of each transition,
    /// then set and reset of each step, then the outputs.
    Flat,
}

impl Room {
    /// The usual room: a sketch is for a small board, whose clock counts milliseconds.
    pub fn usual(language: Language, style: Style) -> Room {
        if language == Language::Arduino && style == Style::Structured {
            return Room { small: true, clock: Clock::Milliseconds };
        }
        Room::default()
    }
}

/// The choice of code to print.
#[derive(Clone, Debug)]
pub struct Options<'a> {
    /// The language.
    pub language: Language,
    /// How the evolution is written down.
    pub style: Style,
    /// How much room it takes; for the structured style.
    pub room: Room,
    /// The start of file names and public names.
    pub name: &'a str,
    /// The text of the chart, for comments; may be empty.
    pub source: &'a str,
}

/// The printed files and their report.
#[derive(Clone, Debug)]
pub struct Printed {
    /// The files, the main one last.
    pub files: Vec<File>,
    /// The constructs that are printed with a difference.
    pub problems: Vec<Problem>,
    /// Where the variables and steps went.
    pub places: Places,
    /// How much memory the C code takes beside its instructions.
    pub sizes: Sizes,
}

/// Where what the chart names is in the code.
#[derive(Clone, Debug, Default)]
pub struct Places {
    variables: HashMap<u32, String>,
    texts: HashMap<u32, u16>,
    steps: Vec<String>,
    untimed: HashSet<u32>,
}

impl Places {
    /// The field of a variable, as in `v.count`, from its first word.
    pub fn variable(&self, addr: Addr) -> Option<&str> {
        self.variables.get(&addr.0).map(String::as_str)
    }

    /// The number of a step, without what public names begin with.
    pub fn step(&self, step: StepId) -> &str {
        self.steps.get(step.0 as usize).map_or("", String::as_str)
    }

    /// True if the code keeps the time of a step.
    pub fn has_time(&self, step: StepId) -> bool {
        !self.untimed.contains(&step.0)
    }

    /// Bytes that a text can hold, where there is one.
    pub fn text(&self, addr: Addr) -> Option<u16> {
        self.texts.get(&addr.0).copied()
    }
}

/// The name that files begin with, and public names of C.
pub fn file_name(name: &str) -> String {
    names::letters(name).to_lowercase()
}

/// Prints the code of a chart, C as a header and a source file that need no other.
///
/// # Errors
///
/// The constructs that the language cannot say, with their places in the chart.
pub fn print(compiled: &Compiled, options: &Options<'_>) -> Result<Printed, Vec<Problem>> {
    print_as(compiled, options, Parts::Whole)
}

/// Prints the code of a chart in these files.
///
/// # Errors
///
/// The constructs that the language cannot say, with their places in the chart.
pub fn print_as(compiled: &Compiled, options: &Options<'_>, parts: Parts) -> Result<Printed, Vec<Problem>> {
    let mut g = Gen::new(compiled, options.source, options.room);
    if options.style == Style::Flat && options.room != Room::default() {
        let text = say!("code for little memory is in the structured style alone");
        return Err(vec![Problem::new(&codes::NOT_CARRIED, Span::default(), text)]);
    }
    g.judge_initial_times();
    match options.style {
        Style::Structured => g.structured(),
        Style::Flat => flat::flat(&mut g),
    }
    g.frame();
    g.structures();
    let mut module = std::mem::take(&mut g.m);
    let called = prune::prune(&mut module);
    let mut problems = std::mem::take(&mut g.problems);
    if let Some(at) = g.real_text.filter(|_| options.language != Language::Rust) {
        problems.push(Problem::new(
            &codes::NOT_CARRIED,
            at,
            say!("reals are turned into text or back: C has no way for that without a library"),
        ));
    }
    if let Some(at) = g.math {
        let text = match options.language {
            Language::C | Language::Arduino => say!(
                "the functions of LREAL come from `<math.h>`; their last digit can be another than in a run here"
            ),
            Language::Rust => {
                say!("the functions of LREAL come from the crate `libm`; add it to the dependencies")
            }
        };
        problems.push(Problem::new(&codes::DIFFERENT, at, text));
    }
    if problems.iter().any(|p| p.severity() == Severity::Error) {
        return Err(problems);
    }
    let all = if options.language == Language::Rust { runtime::rust_helpers() } else { runtime::c_helpers() };
    let helpers = match (prune::missing(&module), runtime::helpers(all, &called)) {
        (None, Ok(helpers)) => helpers,
        (Some(name), _) | (None, Err(name)) => {
            let text = say!("the code asks for `{name}`, which is not there");
            return Err(vec![Problem::new(&codes::NOT_CARRIED, Span::default(), text)]);
        }
    };
    let name = file_name(options.name);
    if parts == Parts::Apart && ["g7", "g7_math"].contains(&name.as_str()) {
        let text =
            say!("a chart called `{name}` would have the files of all charts; give its code another name");
        return Err(vec![Problem::new(&codes::NOT_CARRIED, Span::default(), text)]);
    }
    let files = match options.language {
        Language::C => files::c(&module, &helpers, &name, options.room, parts),
        Language::Arduino => {
            // A sketch and C are two languages: one file cannot hold both.
            let parts = if parts == Parts::One { Parts::Whole } else { parts };
            let mut files = files::c(&module, &helpers, &name, options.room, parts);
            if parts == Parts::Apart {
                files.insert(0, project::platformio(&name));
            }
            files.push(File { name: format!("{name}.ino"), text: arduino::sketch(&g, &name, options.room) });
            files
        }
        Language::Rust => {
            let head = format!(
                "//! The chart `{name}`, printed by G7. Call [`init`] once, then [`scan`] in each cycle.\n{}#![forbid(unsafe_code)]\n\
                 // Writes of a chart that nothing reads stand as they are, and so do brackets.\n\
                 #![allow(dead_code, unused_assignments, unused_mut, unused_parens)]\n{}\n",
                if options.room.is_narrow() {
                    format!("//! {}\n", options.room.note())
                } else {
                    String::new()
                },
                rust::ALLOWED
            );
            vec![File { name: format!("{name}.rs"), text: head + &rust::print(&module, &helpers.text) }]
        }
    };
    Ok(Printed { files, problems, places: places(&g), sizes: size::sizes(&module) })
}

fn places(g: &Gen<'_>) -> Places {
    let mut places = Places { steps: g.steps.clone(), ..Places::default() };
    if g.room.small {
        places.untimed = (0..g.t.steps.len() as u32).filter(|s| !g.timed.contains(s)).collect();
    }
    for v in &g.c.symbols.variables {
        let Some(slot) = g.vars.slot(v.addr.0) else { continue };
        let home = match slot.home {
            vars::Home::Inputs => "inputs",
            vars::Home::Outputs => "outputs",
            vars::Home::Variables => "v",
            vars::Home::Locals | vars::Home::Constant => continue,
        };
        let mut path = format!("{home}.{}", slot.field);
        match slot.shape {
            vars::Shape::Fb(kind) => {
                let member = vars::members(kind).get((v.addr.0 - slot.start) as usize);
                match member.filter(|_| !matches!(v.ty, g7_model::Type::Fb(_))) {
                    Some((name, _)) => path = format!("{path}.{name}"),
                    None => continue,
                }
            }
            vars::Shape::Text(cap) | vars::Shape::Texts(cap, _) => {
                places.texts.insert(v.addr.0, cap);
            }
            vars::Shape::One(_) | vars::Shape::Many(..) => {}
        }
        places.variables.insert(v.addr.0, path);
    }
    places
}
