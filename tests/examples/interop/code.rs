//! C and Rust, taken by compilers without a warning.

use std::process::Command;

use g7_codegen::{Language, Options, Parts, Room, Style};
use g7_peers::projects::output;

use crate::charts::Chart;
use crate::table::{Table, Written};

/// Compilers, their languages and arguments.
const COMPILERS: [(&str, Language, &[&str]); 6] = [
    ("gcc", Language::C, &["-std=c99", "-Wall", "-Wextra", "-pedantic", "-Werror", "-fsyntax-only"]),
    ("clang", Language::C, &["-std=c99", "-Wall", "-Wextra", "-pedantic", "-Werror", "-fsyntax-only"]),
    // Not to the null device: tcc takes the file away first, and as root that is the device.
    ("tcc", Language::C, &["-c", "-o", "code.o"]),
    (
        "avr-gcc",
        Language::C,
        &["-std=gnu99", "-mmcu=atmega2560", "-Wall", "-Wextra", "-Werror", "-fsyntax-only"],
    ),
    ("rustc", Language::Rust, &RUST),
    ("rustc for thumbv7em", Language::Rust, &CORTEX),
];
const RUST: [&str; 6] =
    ["--edition=2021", "--crate-type=lib", "--emit=metadata", "--deny=warnings", "-o", "code.meta"];
const CORTEX: [&str; 8] = [
    "--edition=2021",
    "--crate-type=lib",
    "--emit=metadata",
    "--deny=warnings",
    "-o",
    "code.meta",
    "--target",
    "thumbv7em-none-eabi",
];

pub(crate) fn rows(table: &mut Table<'_>) {
    for (name, language, arguments) in COMPILERS {
        let program = name.split(' ').next().unwrap_or(name);
        let there = match name {
            "tcc" => Command::new("tcc").arg("-v").output().is_ok(),
            "rustc for thumbv7em" => g7_peers::target("thumbv7em-none-eabi"),
            _ => g7_peers::tool(program),
        };
        if !there {
            println!("| {name} | not installed | |");
            continue;
        }
        let is_rust = matches!(language, Language::Rust);
        let ending = if is_rust { "rs" } else { "c" };
        let written = |chart: &Chart| {
            let text = printed(chart, language)?;
            // The module asks for the crate libm, which stands beside no single file.
            (!is_rust || !text.as_ref().is_ok_and(|text| text.contains("libm::"))).then_some(text)
        };
        table.tries(name, written, |table, text| {
            let text = if is_rust { format!("#![no_std]\n{text}") } else { text.to_owned() };
            let file = table.file(&format!("code.{ending}"), &text);
            let mut command = Command::new(program);
            command.args(arguments).arg(&file).current_dir(&table.folder.0);
            output(&command).map(|_| ())
        });
    }
}

fn printed(chart: &Chart, language: Language) -> Option<Written> {
    let options =
        Options { language, style: Style::Structured, room: Room::default(), name: "chart", source: "" };
    let printed = g7_codegen::print_as(chart.compiled.as_ref()?, &options, Parts::Whole);
    Some(match printed {
        // A header and its code, as one file: the code need not ask for the header.
        Ok(printed) => {
            let whole = printed.files.iter().map(|f| f.text.as_str()).collect::<Vec<_>>().join("\n");
            Ok(whole.replace("#include \"chart.h\"\n", ""))
        }
        Err(lost) => {
            let first = lost.first().map_or("no reason", |p| p.what.as_str());
            Err(format!("C and Rust, refused by G7: {first}"))
        }
    })
}
