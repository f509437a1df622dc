//! A chart as the files of an FMU: its C code, the functions of FMI round it, and what describes it.
//!
//! ```text
//! Compiled -> print (C) -> files of the chart ------------------+
//!     |            |                                            +-> Fmu: paths and texts, to be packed
//!     +-> variables: names, types, places, start values         |
//!             +-> description (modelDescription.xml) -----------+
//!             +-> source (table of the variables + c/*.c) ------+
//! ```
//!
//! # Invariants
//!
//! - The same chart gives the same bytes: the token is a hash of the sources and the variables.
//! - The C of the chart is what [`crate::print`] gives, untouched.

mod description;
mod source;
mod variables;
mod version;

use g7_compile::Compiled;
use g7_model::{Problem, Span, codes, say};

use crate::{File, Language, Options, Room, Style, names};
use variables::{Kind, Variable};
pub use version::Version;

/// The files of an FMU, without a library for a machine.
#[derive(Clone, Debug)]
pub struct Fmu {
    /// The name of its library and of its C functions: a C identifier.
    pub identifier: String,
    /// Its files, with their folders: `modelDescription.xml`, `sources/…`.
    pub files: Vec<File>,
    /// The names of the files in `sources` that are compiled.
    pub compiled: Vec<String>,
    /// The constructs that are printed with a difference.
    pub problems: Vec<Problem>,
}

/// Makes the files of an FMU for Co-Simulation from a chart.
///
/// # Errors
///
/// The constructs that cannot be written in C, with their places in the chart.
pub fn fmu(compiled: &Compiled, version: Version, name: &str, source: &str) -> Result<Fmu, Vec<Problem>> {
    let options =
        Options { language: Language::C, style: Style::Structured, room: Room::default(), name, source };
    let printed = crate::print(compiled, &options)?;
    let identifier = names::letters(name).to_lowercase();
    let all = variables::variables(compiled, &printed.places, version);
    let mut problems = printed.problems;
    problems.extend(inexact(&all, version));
    let period = compiled.symbols.cycle.count().max(1);
    let (own, text) = source::source(&all, version, &identifier, period);
    let mut sources = printed.files;
    sources.push(File { name: own, text });
    let token = token(&sources, &all);
    for file in &mut sources {
        if file.text.contains(source::TOKEN) {
            file.text = file.text.replace(source::TOKEN, &token);
        }
    }
    let names: Vec<String> = sources.iter().map(|f| f.name.clone()).filter(|n| n.ends_with(".c")).collect();
    let math = problems.iter().any(|p| p.what.contains("<math.h>"));
    let what = description::Chart {
        name,
        identifier: &identifier,
        token: &token,
        period,
        sources: &names,
        variables: &all,
        math,
    };
    let mut files = vec![File { name: "modelDescription.xml".to_owned(), text: what.model(version) }];
    if version == Version::V3 {
        files.push(File { name: "sources/buildDescription.xml".to_owned(), text: what.build() });
    }
    files.extend(sources.into_iter().map(|f| File { name: format!("sources/{}", f.name), text: f.text }));
    Ok(Fmu { identifier, files, compiled: names, problems })
}

/// The variables for which FMI 2.0 has no exact type.
fn inexact(all: &[Variable], version: Version) -> Vec<Problem> {
    let long = |v: &&Variable| version == Version::V2 && matches!(v.kind, Kind::I64 | Kind::U64);
    let said = |v: &Variable| {
        let text = say!(
            "FMI 2.0 has no whole numbers of 64 bits: `{}` is a Real there, exact up to 2^53; FMI 3.0 has them",
            v.name
        );
        Problem::new(&codes::DIFFERENT, v.at, text)
    };
    all.iter().filter(long).filter(|v| v.at != Span::default()).map(said).collect()
}

/// A hash of the content (FNV-1a of 128 bits) in the form of a UUID. It finds accidents.
fn token(sources: &[File], all: &[Variable]) -> String {
    let mut hash: u128 = 0x6c62_272e_07bb_0142_62b8_2175_6295_c58d;
    let mut add = |text: &str| {
        for byte in text.bytes().chain([0]) {
            hash = (hash ^ u128::from(byte)).wrapping_mul((1 << 88) + 0x13b);
        }
    };
    for file in sources {
        add(&file.name);
        add(&file.text);
    }
    for v in all {
        add(&v.name);
        add(&v.description);
        add(&format!("{:?} {:?} {:?}", v.kind, v.role, v.start));
    }
    let hex = format!("{hash:032x}");
    let part = |from: usize, to: usize| hex.get(from..to).unwrap_or("").to_owned();
    format!("{{{}-{}-{}-{}-{}}}", part(0, 8), part(8, 12), part(12, 16), part(16, 20), part(20, 32))
}
