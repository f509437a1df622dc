//! `g7 gen`: complete files or none; the same exit codes as other commands.
#![allow(clippy::disallowed_methods, reason = "a test starts a compiler")]

use crate::common;

use std::path::Path;
use std::process::Command;

use common::Folder;

const CHART: &str = "profile iec60848
input a : BOOL
output v : BOOL
chart G {
  initial step 1
  step 2 { N v }
  1 -> 2 when a
  2 -> 1 when not a
}
";

#[test]
fn files_bear_the_name_of_the_folder_of_a_chart() {
    let folder = Folder::new();
    folder.write("tank/chart.g7", CHART);
    folder.g7(&["gen", "c", "tank", "-o", "out"]).is(0);
    assert!(folder.read("out/tank.h").contains("tank_scan("));
    assert!(folder.read("out/tank.c").contains("#include \"tank_run.h\""));
    assert!(folder.read("out/tank.h").contains("#include \"g7.h\""));
    folder.g7(&["gen", "arduino", "tank", "-o", "sketch", "--name", "Mill"]).is(0);
    assert!(folder.read("sketch/mill.ino").contains("mill_scan_in_place("));
    folder.g7(&["gen", "rust", "tank", "-o", "src"]).is(0);
    assert!(folder.read("src/tank.rs").contains("pub fn scan("));
}

#[test]
fn what_is_there_stays_unless_forced() {
    let folder = Folder::with(CHART);
    folder.write("out/t.rs", "mine");
    folder.g7(&["gen", "rust", "--name", "t", "-o", "out"]).is_refused(&["t.rs", "--force"]);
    assert_eq!(folder.read("out/t.rs"), "mine");
    folder.g7(&["gen", "rust", "--name", "t", "-o", "out", "--force"]).is(0);
    assert_eq!(folder.g7(&["gen", "rust", "--name", "t"]).is(0).out, folder.read("out/t.rs"));
}

#[test]
fn what_c_cannot_say_is_a_problem_and_nothing_is_written() {
    let text = "profile iec60848\noutput t : STRING(20)\nvar x : REAL\nchart G {\n  \
                initial step 1 { P1 t := REAL_TO_STRING(x) }\n}\n";
    let folder = Folder::with(text);
    folder.g7(&["gen", "c", "-o", "out"]).is(1);
    assert_eq!(folder.names(), ["chart.g7"]);
    folder.write("chart.g7", CHART.replace("when a", "when nothing_has_this"));
    folder.g7(&["gen", "c", "-o", "out"]).is(1);
    assert_eq!(folder.names(), ["chart.g7"]);
}

#[test]
fn charts_of_one_folder_share_what_they_have_in_common() {
    let folder = Folder::new();
    folder.write("tank/chart.g7", CHART);
    folder.write("mill/chart.g7", CHART.replace("not a", "not a and 2s/X2"));
    folder.g7(&["gen", "c", "tank", "-o", "out"]).is(0);
    let ran = folder.g7(&["gen", "c", "mill", "-o", "out"]).is(0).err.clone();
    assert!(ran.contains("mill.c") && !ran.contains("g7.c"), "{ran}");
    folder.g7(&["gen", "c", "tank", "--style", "flat", "-o", "out"]).is(2);
    // Another `g7.c` is not replaced without a word.
    folder.write("out/g7.c", "mine");
    folder.g7(&["gen", "c", "mill", "-o", "out"]).is(2);
    assert_eq!(folder.read("out/g7.c"), "mine");
    folder.g7(&["gen", "c", "tank", "--name", "g7", "-o", "new"]).is(1);
    assert_eq!(folder.names(), ["mill", "out", "tank"]);
}

#[test]
fn the_program_round_a_chart_is_never_written_over() {
    let folder = Folder::new();
    folder.write("tank/chart.g7", CHART);
    for (args, own, file) in [
        (&["c", "--project", "cmake"] as &[&str], "main.c", "tank.c"),
        (&["rust", "--project", "cargo"], "src/main.rs", "src/tank.rs"),
        (&["arduino"], "platformio.ini", "tank.c"),
    ] {
        let out = args[0];
        let given = [&["gen"], args, &["tank", "-o", out]].concat();
        folder.g7(&given).is(0);
        let mine = format!("{out}/{own}");
        folder.write(&mine, "mine");
        folder.write(&format!("{out}/{file}"), "old");
        folder.g7(&[&given[..], &["--force"]].concat()).is(0);
        assert_eq!(folder.read(&mine), "mine");
        assert_ne!(folder.read(&format!("{out}/{file}")), "old");
    }
}

/// Every language and style: arguments, files in their order, a text that only this style contains.
const ALL: [(&[&str], &[&str], &str); 19] = [
    (&["c"], &["tank.h", "tank.c"], "receptivity("),
    (&["c", "--style", "structured"], &["tank.h", "tank.c"], "receptivity("),
    (&["c", "--style", "flat"], &["tank.h", "tank.c"], "sections_of_pass("),
    (&["c", "--small", "--time-unit", "us"], &["tank.h", "tank.c"], "`now` is in microseconds"),
    (&["arduino"], &["tank.h", "tank.c", "tank.ino"], "_scan_in_place(&state, ms)"),
    (&["arduino", "--time-unit", "ns"], &["tank.h", "tank.c", "tank.ino"], "_scan_in_place(&state, now_ns)"),
    (&["arduino", "--style", "flat"], &["tank.h", "tank.c", "tank.ino"], "sections_of_pass("),
    (&["rust"], &["tank.rs"], "fn receptivity("),
    (&["rust", "--style", "flat"], &["tank.rs"], "fn sections_of_pass("),
    (&["st"], &["tank.st"], "END_FUNCTION_BLOCK"),
    (&["il"], &["tank.il"], "END_FUNCTION_BLOCK"),
    (&["il", "--style", "dolog80"], &["tank.il"], "R_"),
    // Ladder has no loops, so it needs a profile with one pass.
    (&["ld", "--profile", "pl7"], &["tank.xml"], "<LD>"),
    (&["ld", "--profile", "pl7", "--style", "drawn"], &["tank.svg"], "<svg"),
    (&["awl"], &["tank.asc", "tank.awl"], "END_DATA_BLOCK"),
    (&["scl"], &["tank.tags.xml", "tank.scl"], "S7_Optimized_Access"),
    (&["twincat"], &["tank.TcPOU"], "<TcPlcObject"),
    (&["logix"], &["tank.L5X"], "<RSLogix5000Content"),
    (&["unity"], &["tank.XST"], "<STExchangeFile>"),
];

#[test]
fn every_language_and_style_goes_to_the_standard_output_and_to_files() {
    for (args, files, sign) in ALL {
        let folder = Folder::new();
        folder.write("tank/chart.g7", CHART);
        let given = [&["gen"], args, &["tank"]].concat();
        let out = folder.g7(&given).is(0).out.clone();
        assert!(out.contains(sign), "{args:?}: no `{sign}` in\n{out}");
        assert_eq!(folder.names(), ["tank"], "{args:?}: the standard output leaves no file");
        let whole: &[&str] = if ["c", "arduino"].contains(&args[0]) { &["--whole"] } else { &[] };
        folder.g7(&[&given[..], whole, &["-o", "out"]].concat()).is(0);
        let texts: Vec<String> = files.iter().map(|f| folder.read(&format!("out/{f}"))).collect();
        let mut texts = texts.join("\n");
        if args[0] == "c" {
            // As one file it does not ask for the other.
            texts = texts.replace("/* The chart tank, printed by G7. */\n#include \"tank.h\"\n", "");
        }
        assert_eq!(texts, out, "{args:?}: the files one behind the other");
        let count = std::fs::read_dir(folder.path("out")).expect("a folder").count();
        assert_eq!(count, files.len(), "{args:?}: these files and no other");
    }
}

#[test]
fn what_is_no_language_and_no_style_is_refused() {
    let folder = Folder::with(CHART);
    for (args, word) in [
        (&["gen", "cobol"] as &[&str], "cobol"),
        (&["gen", "c", "--style", "round"], "round"),
        (&["gen", "rust", "--style", "dolog80"], "dolog80"),
        (&["gen", "il", "--style", "structured"], "structured"),
        (&["gen", "ld", "--style", "flat"], "flat"),
        (&["gen", "st", "--style", "flat"], "--style"),
        (&["gen", "c", "--style", "flat", "--small"], "structured"),
        (&["gen", "c", "--board", "due"], "uno, mega, esp32"),
        (&["gen", "c", "--time-unit", "s"], "ms"),
        (&["gen", "c", "--whole"], "--output"),
        (&["gen", "rust", "--whole", "-o", "out"], "one file anyway"),
        (&["gen", "rust", "--project", "cmake", "-o", "out"], "--project cargo"),
        (&["gen", "c", "--project", "cmake", "--name", "main", "-o", "out"], "main.c"),
        (&["gen", "c", "nowhere.g7"], "nowhere.g7"),
        (&["gen", "c", "--profile", "iec"], "iec"),
    ] {
        let ran = folder.g7(args);
        assert_eq!((ran.code, ran.out.as_str()), (2, ""), "{args:?}: {}", ran.err);
        assert!(ran.err.contains(word), "{args:?}: {}", ran.err);
    }
    assert_eq!(folder.names(), ["chart.g7"]);
}

#[test]
fn the_bead_sorter_compiles_without_a_warning() {
    let chart = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/bead-sorter/chart.g7");
    let chart = chart.to_str().expect("a path");
    for style in ["structured", "flat"] {
        let folder = Folder::new();
        folder.g7(&["gen", "c", chart, "--style", style, "--name", "sorter", "-o", "."]).is(0);
        let one = folder.g7(&["gen", "c", chart, "--style", style, "--name", "sorter"]).is(0).out.clone();
        folder.write("one.c", &one);
        for compiler in ["gcc", "clang"].into_iter().filter(|c| g7_peers::tool(c)) {
            let strict =
                ["-std=c99", "-Wall", "-Wextra", "-Wconversion", "-pedantic", "-Werror", "-O2", "-c"];
            let files = ["sorter.c", "g7.c", "one.c"];
            let run = Command::new(compiler).args(strict).args(files).current_dir(folder.root()).output();
            let out = run.expect("the compiler starts");
            let said = String::from_utf8_lossy(&out.stderr);
            assert!(out.status.success() && said.is_empty(), "{compiler}, {style}:\n{said}");
        }
    }
}

/// For a board with too little RAM nothing is written, and the message names a way out. A chart that fits is written.
#[test]
fn a_board_that_is_too_small_is_told() {
    let folder = Folder::new();
    let mut chart =
        String::from("profile iec60848\ninput go : BOOL\noutput y : BOOL\nchart C {\n  initial step 0\n");
    (1..300).for_each(|i| chart += &format!("  step {i} {{ N y }}\n"));
    (0..300).for_each(|i| chart += &format!("  {i} -> {} when go\n", (i + 1) % 300));
    folder.write("long/chart.g7", &(chart + "}\n"));
    let ran = folder.g7(&["gen", "c", "long", "--board", "uno", "-o", "out"]);
    assert_eq!((ran.code, ran.out.as_str()), (1, ""), "{}", ran.err);
    assert!(
        ran.err.contains("uno is too small") && ran.err.contains("--small --time-unit ms"),
        "{}",
        ran.err
    );
    assert_eq!(folder.names(), ["long"]);
    for args in [
        &["c", "--board", "mega"] as &[&str],
        &["c", "--small", "--board", "uno"],
        &["arduino", "--board", "uno"],
    ] {
        let ran = folder.g7(&[&["gen"], args, &["long", "-o", "out", "--force"]].concat());
        assert_eq!(ran.code, 0, "{args:?}: {}", ran.err);
        assert!(ran.err.contains("bytes of RAM for the state"), "{}", ran.err);
    }
}
