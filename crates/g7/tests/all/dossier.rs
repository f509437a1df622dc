//! `g7 dossier` and `g7 draw --pages a4`: what stands on the sheets, as other programs read them.
#![allow(missing_docs, reason = "a test")]
#![allow(clippy::disallowed_methods, reason = "tests look at what was written")]

use std::process::Command;

use crate::common;

use common::Folder;

const TANK: &str = "\
input  start : BOOL at %I0.0 \"the green button\"
output pump : BOOL at %Q0.1 safe FALSE \"lifts water\"
var    count : INT := 0 retain \"full tanks\"
const  MOST : INT := 3

chart Tank \"fills and empties\" {
  initial step 0 \"at rest\"
  step 1 \"fills\" {
    N pump
    P1 count := count + 1
  }
  fork: 0 -> 1 when ↑start and count < MOST
  1 -> 0 when 2s/X1
}

action Reset { count := 0; }

plant Water {
  view 'water.svg' { }
}

test \"one press fills once\" {
  pulse start
  expect X1, pump
  wait 3s
  expect not pump
}

test \"a press never fills\" {
  pulse start
  expect not pump
}

prove never count > MOST \"never too many\"
prove never pump \"the pump rests\"
";

/// The text of a PDF without blanks, so that no line end matters; none where nothing can read it.
fn text(folder: &Folder, file: &str) -> Option<String> {
    let out = run("pdftotext", &[file, "-"], folder)?;
    Some(out.chars().filter(|c| !c.is_whitespace()).collect())
}

fn run(tool: &str, args: &[&str], folder: &Folder) -> Option<String> {
    // Poppler's tools know `-v` and no `--version`.
    if !Command::new(tool).arg("-v").output().is_ok_and(|o| o.status.success()) {
        g7_peers::skip(&format!("{tool} missing"));
        return None;
    }
    let done = Command::new(tool).args(args).current_dir(folder.path(".")).output().expect("it runs");
    assert!(done.status.success(), "{tool}: {}", String::from_utf8_lossy(&done.stderr));
    Some(String::from_utf8(done.stdout).expect("UTF-8"))
}

fn pages(folder: &Folder, file: &str) -> Option<usize> {
    let told = run("pdfinfo", &[file], folder)?;
    let line = told.lines().find_map(|l| l.strip_prefix("Pages:")).expect("a number of pages");
    Some(line.trim().parse().expect("a number"))
}

fn tank() -> Folder {
    let folder = Folder::with(TANK);
    folder.write(
        "water.svg",
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 40 20\"><rect width=\"40\" height=\"20\" fill=\"blue\"/></svg>",
    );
    folder
}

#[test]
fn everything_of_the_file_stands_in_the_dossier() {
    let folder = tank();
    let args = ["dossier", "-o", "tank.pdf", "--title", "Tank 4", "--author", "A. Martin", "--revision", "B"];
    let done = folder.g7(&args);
    done.is(0);
    let last = done.err.lines().last().expect("a last line").to_owned();
    assert!(last.contains("2 tests, 1 failed") && last.contains("refuted"), "{last}");
    if let Some(pages) = pages(&folder, "tank.pdf") {
        assert!(last.starts_with(&format!("{pages} sheets;")), "{pages}: {last}");
    }
    if let Some(about) = run("pdfinfo", &["tank.pdf"], &folder) {
        assert!(about.contains("Tank 4") && about.contains("A. Martin") && about.contains("A4"), "{about}");
        assert!(!about.contains("CreationDate"), "no clock is read: {about}");
    }
    let Some(text) = text(&folder, "tank.pdf") else { return };
    for part in [
        "Tank 4",
        "ChartTank",
        "fills and empties",
        "at rest",
        "N pump",
        "P1 count := count + 1",
        "fork: 0 → 1",
        "↑start and count < MOST",
        "2s/X1",
        "%I0.0",
        "%Q0.1",
        "the green button",
        "lifts water",
        "retain",
        "full tanks",
        "MOST",
        "action Reset",
        "count := 0;",
        "one press fills once – passed",
        "a press never fills – failed",
        "expected: not pump",
        "never too many",
        "the pump rests",
        "refuted",
        "Cross references",
        "Tank: step 1",
        "plant Water",
    ] {
        let part: String = part.chars().filter(|c| !c.is_whitespace()).collect();
        assert!(text.contains(&part), "{part} is in\n{text}");
    }
}

#[test]
fn the_same_command_gives_the_same_bytes() {
    let folder = tank();
    for file in ["a.pdf", "b.pdf"] {
        folder.g7(&["dossier", "-o", file, "--date", "2026-03-01", "--no-prove"]).is(0);
    }
    let bytes = |file| std::fs::read(folder.path(file)).expect("a dossier");
    assert!(bytes("a.pdf") == bytes("b.pdf") && bytes("a.pdf").starts_with(b"%PDF"));
}

#[test]
fn what_is_left_out_is_named_on_the_cover() {
    let folder = tank();
    folder.g7(&["dossier", "-o", "tank.pdf", "--part", "io,tests", "--no-tests"]).is(0);
    let Some(text) = text(&folder, "tank.pdf") else { return };
    assert!(text.contains("Leftout:Charts,Variablesandconstants,Crossreferences"), "{text}");
    assert!(text.contains("Notrunforthisdossier.") && text.contains("onepressfillsonce"), "{text}");
}

#[test]
fn a_dossier_is_in_the_language_of_the_reader() {
    let folder = tank();
    for (language, words) in [
        ("en", ["Contents", "Inputsandoutputs", "receptivity"]),
        ("fr", ["Sommaire", "Entréesetsorties", "réceptivité"]),
        ("pt", ["Índice", "Entradasesaídas", "recetividade"]),
    ] {
        folder.g7(&["dossier", "--lang", language, "-o", "tank.pdf", "--no-prove"]).is(0);
        let Some(text) = text(&folder, "tank.pdf") else { return };
        for word in words {
            assert!(text.contains(word), "{language}: {word}");
        }
    }
}

#[test]
fn a_file_with_syntax_errors_gives_its_problems_and_no_dossier() {
    let folder = Folder::with("chart G {\n  initial step\n}\n");
    let done = folder.g7(&["dossier", "-o", "g.pdf"]);
    assert!(done.is(1).err.contains("chart.g7"), "{}", done.err);
    assert!(!folder.path("g.pdf").exists());
}

#[test]
fn charts_stand_on_sheets_of_paper() {
    let folder = Folder::with(&long(80));
    folder.g7(&["draw", "--pages", "a4", "-o", "long.pdf", "--company", "Atelier Sud"]).is(0);
    if let (Some(pages), Some(text)) = (pages(&folder, "long.pdf"), text(&folder, "long.pdf")) {
        assert!(pages > 1 && text.contains(&format!("{pages}/{pages}")), "{pages}\n{text}");
        assert_eq!(text.matches("AtelierSud").count(), pages, "a title block on each");
        assert!(text.contains("(p.2)") && text.contains("(p.1)"), "connectors both ways");
    }
    folder.write("chart.g7", long(300));
    folder.g7(&["draw", "--pages", "a3-landscape", "-o", "long.svg"]).is(0);
    assert!(folder.path("long-1.svg").exists() && folder.path("long-2.svg").exists());
    let first = std::fs::read_to_string(folder.path("long-1.svg")).expect("a sheet");
    assert!(first.contains("width=\"420mm\" height=\"297mm\""), "A3 on its side");
}

/// A chart of so many steps in a row.
fn long(steps: usize) -> String {
    let mut text = String::from("input a : BOOL\nchart Long {\n  initial step 0\n");
    for n in 1..=steps {
        text.push_str(&format!("  step {n}\n  {} -> {n} when a\n", n - 1));
    }
    text + &format!("  {steps} -> 0 when a\n}}\n")
}

#[test]
fn a_title_block_without_paper_is_refused() {
    let folder = tank();
    folder.g7(&["draw", "--title", "Tank"]).is_refused(&["--pages a4"]);
    folder.g7(&["draw", "--pages", "pl7", "--title", "Tank"]).is_refused(&["--pages a4"]);
    folder.g7(&["draw", "--pages", "a4", "--as", "drawio"]).is_refused(&["draw.io"]);
}
