//! Files that use others, and projects.
#![allow(missing_docs, reason = "a test")]
#![allow(clippy::disallowed_methods, reason = "tests look at what was written")]

use crate::common;

use common::Folder;
use snapbox::{assert_data_eq, str};

const AXIS: &str = "input order : ARRAY[1..3] OF BOOL\noutput out : ARRAY[1..3] OF BOOL\n\nchart Axis(i : INT) {\n  initial step 0\n  step 1 { N out[i] }\n  0 -> 1 when order[i]\n  1 -> 0 when not order[i]\n}\n";

const MAIN: &str = "use 'lib/axis.g7'\n\ninstance Axis[1..3]\n\ntest \"an axis follows its order\" {\n  set order[2] := TRUE\n  scan\n  expect out[2], not out[1], Axis[2].X1\n}\n";

fn machine() -> Folder {
    let folder = Folder::new();
    folder.write("main.g7", MAIN);
    folder.write("lib/axis.g7", AXIS);
    folder
}

#[test]
fn each_command_sees_the_whole() {
    let folder = machine();
    let checked = folder.g7(&["check", "."]);
    checked.is(0);
    assert_eq!(checked.err, "2 files: no problems\n", "a part is no chart that never runs");
    let tested = folder.g7(&["test", "main.g7"]);
    tested.is(0);
    assert!(tested.out.contains("1 passed, 0 failed"), "{}", tested.out);
    folder.write("claim.g7", format!("{MAIN}\nprove never Axis[1].X0 and Axis[1].X1\n"));
    let proved = folder.g7(&["prove", "claim.g7"]);
    assert!(proved.out.contains("claim.g7:11:1: proved: prove never"), "{}", proved.out);
    let ran = folder.g7(&["run", "main.g7", "--headless", "--for", "50ms", "--set", "order[3]=1@0s"]);
    ran.is(0);
    let code = folder.g7(&["gen", "c", "main.g7", "-o", "c"]);
    code.is(0);
    assert!(folder.read("c/g7.h").len() > 100, "{:?}", folder.names());
    let written = folder.g7(&["export", "main.g7", "-o", "main.xml", "--to", "plcopen"]);
    assert!(folder.read("main.xml").contains("Axis"), "{} {}", written.out, written.err);
    // Its own text is printed, and no other.
    folder.g7(&["fmt", "main.g7"]).is(0);
    assert_eq!(folder.read("main.g7"), MAIN);
    folder.g7(&["prove", "lib/axis.g7"]).is(0);
}

#[test]
fn a_mistake_in_a_file_that_several_use_is_told_once() {
    let folder = machine();
    folder.write("other.g7", MAIN);
    folder.write("lib/axis.g7", AXIS.replace("not order[i]", "not ordre[i]"));
    let ran = folder.g7(&["check", "main.g7", "other.g7", "lib/axis.g7"]);
    assert_eq!(ran.is(1).out.matches("G0202").count(), 1, "{}", ran.out);
    assert!(ran.err.contains("1 error"), "{}", ran.err);
    let all: serde_json::Value =
        serde_json::from_str(&folder.g7(&["check", ".", "--format", "json"]).is(1).out).expect("JSON");
    assert_eq!((&all["errors"], all["problems"].as_array().map(Vec::len)), (&1.into(), Some(1)), "{all}");
}

#[test]
fn a_mistake_in_a_used_file_has_its_own_place() {
    let folder = machine();
    folder.write("lib/axis.g7", AXIS.replace("not order[i]", "not ordre[i]"));
    let ran = folder.g7(&["check", "main.g7"]);
    ran.is(1);
    assert_data_eq!(
        ran.out.as_str(),
        str![[r#"
error[G0202]: nothing is called `ordre`
 --> lib/axis.g7:8:19
  |
8 |   1 -> 0 when not ordre[i]
  |                   ^^^^^


"#]]
    );
    let told = folder.g7(&["check", "main.g7", "--format", "json"]);
    assert!(told.out.contains(r#""file": "lib/axis.g7""#), "{}", told.out);
    let told = folder.g7(&["check", "main.g7", "--format", "github"]);
    assert!(told.out.starts_with("::error file=lib/axis.g7,line=8,"), "{}", told.out);
    let told = folder.g7(&["check", "main.g7", "--format", "sarif"]);
    assert!(told.out.contains(r#""uri": "lib/axis.g7""#), "{}", told.out);
    // A fix of another file is not made in this one.
    folder.g7(&["check", "main.g7", "--fix=likely"]);
    assert_eq!(folder.read("main.g7"), MAIN);
    let ran = folder.g7(&["run", "main.g7", "--headless", "--for", "50ms"]);
    assert!(ran.err.contains("lib/axis.g7:8:19") || ran.out.contains("lib/axis.g7:8:19"), "{}", ran.err);
}

#[test]
fn a_clash_and_a_circle_show_both_places() {
    let folder = machine();
    folder.write("main.g7", format!("{MAIN}\ninput order : BOOL\n"));
    let ran = folder.g7(&["check", "main.g7"]);
    ran.is(1);
    assert!(ran.out.contains("main.g7:11:7") && ran.out.contains("lib/axis.g7:1:7"), "{}", ran.out);
    folder.write("main.g7", MAIN);
    folder.write("lib/axis.g7", format!("use '../main.g7'\n{AXIS}"));
    let ran = folder.g7(&["check", "main.g7"]);
    ran.is(1);
    assert_data_eq!(
        ran.out.as_str(),
        str![[r#"
error[G0011]: `../main.g7` uses itself in a circle
 --> lib/axis.g7:1:5
  |
1 | use '../main.g7'
  |     ^^^^^^^^^^^^
  |
 ::: main.g7:1:5
  |
1 | use 'lib/axis.g7'
  |     ------------- the circle goes through here
  |
  = help: put what both need into a third file, and use that in both


"#]]
    );
    // Two ways to one file are no clash.
    folder.write("lib/axis.g7", AXIS);
    folder.write("lib/two.g7", "use 'axis.g7'\n");
    folder.write("main.g7", format!("use 'lib/two.g7'\n{MAIN}"));
    folder.g7(&["check", "main.g7"]).is(0);
    folder.write("lib/axis.g7", format!("profile iec61131\n{AXIS}"));
    let ran = folder.g7(&["check", "main.g7"]);
    assert!(
        ran.out.contains("the profile of this file differs") && ran.out.contains("lib/axis.g7:1:1"),
        "{}",
        ran.out
    );
    folder.write("main.g7", format!("profile iec61131\n{MAIN}"));
    folder.g7(&["check", "main.g7"]).is(0);
}

#[test]
fn nothing_outside_of_the_folder_is_read() {
    let folder = machine();
    let refused = |line: &str, why: &str| {
        folder.write("lib/a.g7", format!("{line}\n{AXIS}"));
        let ran = folder.g7(&["check", "lib/a.g7"]);
        ran.is(1);
        assert!(ran.out.contains(why), "{line}: {}", ran.out);
    };
    refused("use '../main.g7'", "it lies outside of the folder");
    refused("use '/etc/hostname.g7'", "a path is relative to the file in which it stands");
    refused("use 'axis.st'", "only .g7 files can be used");
    refused("use 'none.g7'", "there is no such file");
    refused("use nonsense", "the library of this g7 has no such part");
    refused("use debounse", "did you mean `debounce`?");
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(folder.path("main.g7"), folder.path("lib/link.g7")).expect("a link");
        refused("use 'link.g7'", "it lies outside of the folder");
        let made = std::process::Command::new("mkfifo").arg(folder.path("lib/pipe.g7")).status();
        if made.is_ok_and(|s| s.success()) {
            refused("use 'pipe.g7'", "it is no file");
        }
    }
    folder.write("lib/bad.g7", b"\xff\xfe\x00");
    refused("use 'bad.g7'", "lib/bad.g7:1:1");
    // With a project file, the folder of the project is the limit.
    folder.write("g7.toml", "");
    folder.write("lib/a.g7", "use '../other.g7'\n");
    folder.write("other.g7", AXIS);
    folder.g7(&["check", "lib/a.g7"]).is(0);
}

#[test]
fn a_project_names_the_chart_that_runs() {
    let folder = machine();
    folder.write("other.g7", "chart G {\n  initial step 1\n}\n");
    let ran = folder.g7(&["run", ".", "--headless", "--for", "20ms"]);
    assert!(ran.err.contains("none of its own is called chart.g7"), "{}", ran.err);
    folder.write("g7.toml", "name = \"Axes\"\nmain = \"main.g7\"\ng7 = \"0.1\"\n");
    folder.g7(&["run", ".", "--headless", "--for", "20ms"]).is(0);
    for (text, why) in [
        ("man = \"main.g7\"\n", "unknown field `man`"),
        ("main = \"../main.g7\"\n", "it lies outside of the folder"),
        ("main = 5\n", "invalid type"),
        ("g7 = \"900.0\"\n", "this project needs G7 900.0 or newer"),
        ("g7 = \"x\"\n", "`x` is no version of G7"),
        ("= =", "TOML parse error"),
    ] {
        folder.write("g7.toml", text);
        let ran = folder.g7(&["run", ".", "--headless", "--for", "20ms"]);
        ran.is(2);
        assert!(ran.err.contains(why) && ran.err.contains("g7.toml"), "{text}: {}", ran.err);
    }
}
