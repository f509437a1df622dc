//! `interop FILE…`: writes charts for other tools, has these take them, and prints a table of what was accepted:
//!
//! - PLCopen XML, opened by Beremiz and OpenPLC; matiec compiles what they make, and it runs beside the engine; the
//!   schema of TC6 is asked as well;
//! - the same with Ladder (`gen ld`);
//! - text as SFC, Structured Text and Instruction List, compiled by matiec; IronPLC checks the first two;
//! - XMI, loaded by pyecore with the meta-model of the corpus;
//! - C and Rust, taken by compilers.
//!
//! Files may be charts, files of other tools and conformance cases, or folders of them. Whatever G7
//! refuses with a reason is not tried; a second table has each reason with its count, its first file and who is right.
//! Each call of a program has a limit of time, and each row has one (`G7_LIMIT`, in seconds), behind which the rest is
//! counted as not tried. `G7_ROWS` chooses groups of rows (`plcopen,ladder,schema,texts,models,code`). Each refusal is
//! told on the standard error output as well, with its file.
#![allow(
    clippy::disallowed_methods,
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a tool: it starts other programs"
)]

mod charts;
mod code;
mod models;
mod projects;
mod reasons;
mod table;
mod texts;

use std::path::PathBuf;

/// Groups of rows, by name.
type Rows = fn(&mut table::Table<'_>);
const ROWS: [(&str, Rows); 6] = [
    ("plcopen", projects::charts),
    ("ladder", projects::ladders),
    ("schema", projects::valid),
    ("texts", texts::rows),
    ("models", models::rows),
    ("code", code::rows),
];

fn main() {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let charts = charts::read(&arguments);
    let mut table = table::Table::new(&charts);
    let wanted = std::env::var("G7_ROWS").unwrap_or_default();
    for (name, rows) in ROWS {
        if wanted.is_empty() || wanted.split(',').any(|w| w == name) {
            rows(&mut table);
        }
    }
    table.end();
}
