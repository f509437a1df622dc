//! `g7 gen`: files of code, whole or not at all; exit codes as the other commands.

mod common;

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
    assert!(folder.read("out/tank.c").contains("#include \"tank.h\""));
    folder.g7(&["gen", "arduino", "tank", "-o", "sketch", "--name", "Mill"]).is(0);
    assert!(folder.read("sketch/mill.ino").contains("mill_scan("));
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
