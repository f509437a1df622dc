//! The commands that the book, the README, the help texts and `g7 new` print, run as they are printed.
//!
//! A command that waits for people, devices or a browser, or that writes outside of the folder, is only read: all
//! its words and options must be those of the program.
#![allow(missing_docs, reason = "a test")]
#![allow(clippy::disallowed_methods, reason = "tests look at the book")]

use crate::common;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use common::Folder;
use snapbox::cmd::cargo_bin;

fn root() -> PathBuf {
    [env!("CARGO_MANIFEST_DIR"), "..", ".."].iter().collect()
}

/// A chart with few states.
const SMALL: &str = "\
input a : BOOL
output m : BOOL
chart G {
  initial step 1
  step 2 { N m }
  1 -> 2 when a
  2 -> 1 when not a
}
prove never m and not a
";

/// Commands that are only read, by how they begin or what they have in them.
const READ: [&str; 15] = [
    "g7 lsp",
    "g7 serve",
    "g7 devices",
    "g7 plant",
    "g7 users",
    "g7 service",
    "g7 log",
    "g7 history",
    "--online",
    "--hosts",
    "--watch",
    "/usr/local",
    "g7 man |",
    "~/plants",
    "g7 run examples/bead-sorter",
];

/// The commands of a text: in blocks of code and in indented lines, without what stands behind them.
fn commands(text: &str) -> BTreeSet<String> {
    let mut fenced = false;
    let mut found = BTreeSet::new();
    for line in text.lines() {
        if line.trim_start().starts_with("```") {
            fenced = !fenced;
        }
        let bare = line.trim_start();
        // `g7 = "0.1"` is a line of a project file.
        if !bare.starts_with("g7 ") || bare.starts_with("g7 = ") || !(fenced || line.starts_with("  ")) {
            continue;
        }
        let end = [bare.find("  "), bare.find(" #")].into_iter().flatten().min().unwrap_or(bare.len());
        let command = bare.get(..end).unwrap_or(bare);
        // A line with brackets, or with words in capitals that the user replaces, shows a form of a command and
        // is no command to run.
        let named = |w: &str| w.len() > 2 && w.chars().all(|c| c.is_ascii_uppercase() || ".]".contains(c));
        if !command.contains('[') && !command.contains('…') && !command.split(' ').any(named) {
            found.extend(command.split(" && ").filter(|c| c.starts_with("g7 ")).map(str::to_owned));
        }
    }
    found
}

fn pages(folder: &Path, found: &mut Vec<PathBuf>) {
    let mut entries: Vec<PathBuf> =
        std::fs::read_dir(folder).expect("a folder").map(|e| e.expect("an entry").path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            pages(&path, found);
        } else if path.extension().is_some_and(|e| e == "md") {
            found.push(path);
        }
    }
}

/// A folder with the files that the printed commands name.
fn workplace() -> Folder {
    let folder = Folder::new();
    folder.g7(&["new", "tank"]).is(0);
    let tank = folder.read("tank/chart.g7");
    for name in ["chart.g7", "tank.g7", "before.g7", "after.g7", "a.g7", "b.g7", "charts/tank.g7", "plant.g7"]
    {
        folder.write(name, &tank);
    }
    let repo = root();
    let copy = |from: &str, to: &str| {
        folder.write(to, std::fs::read(repo.join(from)).unwrap_or_else(|e| panic!("{from}: {e}")));
    };
    copy("examples/bead-sorter/chart.g7", "sorter.g7");
    let foreign = "tests/interchange";
    for (from, to) in [
        ("classicladder/press.clprj", "press.clprj"),
        ("controlexpert/cell.xsf", "robot.xsf"),
        ("jgrafchart/lines.xml", "Sorter.xml"),
        ("jgrafchart/lines.xml", "sorter.xml"),
        ("l5x/filler.L5X", "filler.L5X"),
        ("plcopen/press.xml", "plant.xml"),
        ("s7graph/press.xml", "press.xml"),
    ] {
        copy(&format!("{foreign}/{from}"), to);
    }
    folder.g7(&["export", "tank.g7", "--to", "xmi", "-o", "plant.grafcet"]);
    folder.write(".local/share/bash-completion/completions/none", "");
    folder.write(".config/fish/completions/none", "");
    let mut examples = Vec::new();
    charts(&repo.join("examples"), &mut examples);
    for path in examples {
        let name = path.strip_prefix(&repo).expect("in the repository").to_string_lossy().into_owned();
        folder.write(&name, std::fs::read(&path).expect("an example"));
    }
    folder
}

fn charts(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            charts(&path, found);
        } else if path.extension().is_some_and(|e| e == "g7") {
            found.push(path);
        }
    }
}

/// Runs a command in a shell; its exit code and what it said.
fn shell(folder: &Path, command: &str) -> (Option<i32>, String) {
    let program = cargo_bin!("g7");
    let own = program.parent().expect("in a folder").to_string_lossy().into_owned();
    let ran = Command::new("sh")
        .args(["-c", command])
        .current_dir(folder)
        .env("PATH", format!("{own}:{}", std::env::var("PATH").unwrap_or_default()))
        .env("HOME", folder)
        .stdin(Stdio::null())
        .output()
        .expect("a shell");
    (ran.status.code(), String::from_utf8_lossy(&ran.stderr).into_owned())
}

/// The exit codes that are right for a command.
fn right(command: &str) -> &'static [i32] {
    let word = command.split(' ').nth(1).unwrap_or("");
    match word {
        "prove" | "compare" | "graph" => &[0, 1, 3],
        // Foreign files are shown with what is not carried over; `fmt --check` finds what is not formatted; a tank
        // solves no exercise.
        "check" | "import" | "export" | "fmt" | "grade" => &[0, 1],
        _ => &[0],
    }
}

fn try_all(from: &str, text: &str, wrong: &mut Vec<String>, counts: &mut [usize; 2]) {
    for command in commands(text) {
        // Each has a folder of its own, so that none sees what another wrote.
        let folder = workplace();
        if READ.iter().any(|part| command.contains(part)) {
            counts[1] += 1;
            let words = command.split(['|', '>', '<']).next().unwrap_or(&command);
            let (code, err) = shell(folder.root(), &format!("{words} --help"));
            if code != Some(0) {
                wrong.push(format!("{from}: {command}: {err}"));
            }
            continue;
        }
        if command.contains("| dot") && !g7_peers::tool("dot") {
            continue;
        }
        counts[0] += 1;
        if ["g7 prove", "g7 compare", "g7 graph"].iter().any(|begin| command.starts_with(begin)) {
            // A small chart is proved in a moment.
            let mut all = Vec::new();
            charts(folder.root(), &mut all);
            all.iter().for_each(|path| std::fs::write(path, SMALL).expect("written"));
        }
        if command.starts_with("g7 import") || command.starts_with("g7 export") {
            // Files that one goes on with must not be there yet.
            let output = command.split(" -o ").nth(1).and_then(|rest| rest.split(' ').next());
            output.map(|name| std::fs::remove_file(folder.path(name)).ok());
        }
        if command.starts_with("g7 gen") {
            // Ladder and the lists of instructions have one pass a scan.
            let tank = folder.read("tank/chart.g7").replace("profile iec60848", "profile iec61131");
            folder.write("tank/chart.g7", tank);
        }
        if command.starts_with("g7 grade ") {
            folder.g7(&["new", "exercise", "lamp"]).is(0);
            folder.write("handed-in/ana.g7", folder.read("lamp/model.g7"));
        }
        if command.starts_with("g7 why run.") {
            let run =
                ["run", "tank", "--headless", "--for", "20s", "--trace", "run.csv", "--record", "run.tape"];
            folder.g7(&run).is(0);
        }
        if command.starts_with("g7 new ") {
            std::fs::remove_dir_all(folder.path("tank")).expect("gone");
        }
        if command.contains(".fmu") && command.starts_with("g7 run") {
            continue;
        }
        let (code, err) = shell(folder.root(), &command);
        if !code.is_some_and(|c| right(&command).contains(&c)) || err.contains("panicked") {
            wrong.push(format!("{from}: {command}: {code:?} {err}"));
        }
    }
}

#[test]
fn the_commands_of_the_book_work_as_printed() {
    let repo = root();
    let mut found = Vec::new();
    pages(&repo.join("docs/book/src"), &mut found);
    pages(&repo.join("examples"), &mut found);
    found.push(repo.join("README.md"));
    let (mut wrong, mut counts) = (Vec::new(), [0; 2]);
    for page in found {
        let name = page.strip_prefix(&repo).expect("in the repository").display().to_string();
        let text = std::fs::read_to_string(&page).expect("a page");
        try_all(&name, &text, &mut wrong, &mut counts);
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    println!("{} commands were run and {} read", counts[0], counts[1]);
    assert!(counts[0] > 60 && counts[1] > 20, "{counts:?}");
}

#[test]
fn the_commands_of_the_help_texts_work_as_printed() {
    let folder = Folder::new();
    let all = folder.g7(&["--help"]).is(0).out.clone();
    let list =
        all.split("Commands:").nth(1).and_then(|t| t.split("\n\n").next()).expect("a list of commands");
    let (mut wrong, mut counts) = (Vec::new(), [0; 2]);
    for line in list.lines() {
        let Some(word) = line.strip_prefix("  ").and_then(|l| l.split(' ').next()).filter(|w| !w.is_empty())
        else {
            continue;
        };
        if word == "help" {
            continue;
        }
        let help = folder.g7(&[word, "--help"]).is(0).out.clone();
        let text = help.split("Examples:").nth(1).unwrap_or("");
        try_all(&format!("g7 {word} --help"), text, &mut wrong, &mut counts);
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(counts[0] > 40, "{counts:?}");
}

#[test]
fn the_commands_of_a_new_project_work_as_printed() {
    let folder = Folder::new();
    let said = folder.g7(&["new", "tank"]).is(0).err.clone();
    let (mut wrong, mut counts) = (Vec::new(), 0);
    for command in said.split('`').skip(1).step_by(2) {
        counts += 1;
        let (code, err) = shell(folder.root(), command);
        if code != Some(0) {
            wrong.push(format!("g7 new says: {command}: {err}"));
        }
    }
    for command in commands(&folder.read("tank/README.md")) {
        counts += 1;
        let (code, err) = shell(&folder.path("tank"), &command);
        if code != Some(0) {
            wrong.push(format!("tank/README.md: {command}: {err}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert_eq!(counts, 7);
}
