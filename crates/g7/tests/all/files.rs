//! Files are written completely or not at all; a failure is reported in one line.
#![allow(missing_docs, reason = "a test")]

use crate::common;

use common::{Folder, PINGPONG};

#[test]
fn new_makes_a_project_that_is_fine_formatted_and_tested() {
    let folder = Folder::new();
    let ran = folder.g7(&["new", "tank"]);
    assert_eq!(ran.is(0).out, "tank/chart.g7\ntank/README.md\n");
    folder.g7(&["check", "--strict", "tank"]).is(0);
    folder.g7(&["fmt", "--check", "tank"]).is(0);
    assert!(folder.g7(&["test", "tank"]).is(0).out.ends_with("\n2 passed, 0 failed\n"));
}

#[test]
fn new_leaves_what_is_there_alone() {
    let folder = Folder::new();
    folder.write("tank/mine.txt", "mine");
    folder.g7(&["new", "tank"]).is_refused(&["tank", "not empty"]);
    folder.write("file", "x");
    folder.g7(&["new", "file"]).is_refused(&["file"]);
    assert_eq!((folder.read("tank/mine.txt").as_str(), folder.read("file").as_str()), ("mine", "x"));
    assert_eq!(folder.names(), ["file", "tank"]);
}

const UNTIDY: &str =
    "// first\ninput a:BOOL // why\nchart G{initial step 1 step 2 1->2 when a 2->1 when not a}";

#[test]
fn fmt_writes_the_canonical_form_once_and_keeps_notes() {
    let folder = Folder::with(UNTIDY);
    let check = folder.g7(&["fmt", "--check"]);
    assert_eq!(check.is(1).out, "./chart.g7\n");
    assert_eq!(folder.read("chart.g7"), UNTIDY, "--check writes nothing");
    folder.g7(&["fmt"]).is(0);
    let tidy = folder.read("chart.g7");
    assert!(tidy.contains("// first\n") && tidy.contains("// why\n"), "{tidy}");
    assert!(tidy.contains("  1 -> 2 when a\n"), "{tidy}");
    folder.g7(&["fmt", "--check"]).is(0);
    let again = folder.g7(&["fmt"]);
    assert_eq!((again.code, again.err.as_str()), (0, ""), "nothing to do");
    assert_eq!(folder.names(), ["chart.g7"], "nothing left beside it");
}

#[test]
fn fmt_leaves_a_file_with_syntax_errors_as_it_is() {
    let text = "chart G { initial step 1 1 -> 1 when ( }";
    let folder = Folder::with(text);
    assert!(folder.g7(&["fmt"]).is(1).err.contains("left as it is"));
    assert_eq!(folder.read("chart.g7"), text);
}

#[test]
fn fmt_of_a_dash_goes_to_the_standard_output() {
    let ran: common::Ran = Folder::new().command(&["fmt", "-"]).stdin(PINGPONG).assert().into();
    assert_eq!(ran.is(0).out, PINGPONG);
}

#[cfg(target_os = "linux")]
mod full {
    use super::*;
    use std::fs::{File, OpenOptions};
    use std::os::unix::fs::symlink;

    fn full() -> File {
        OpenOptions::new().write(true).open("/dev/full").expect("/dev/full")
    }

    #[test]
    fn a_full_disk_is_one_line_and_code_2_for_every_command_that_prints() {
        let folder = Folder::with("chart G {");
        folder.write("ok.g7", PINGPONG);
        for args in [
            &["check"][..],
            &["explain", "G0004"],
            &["explain"],
            &["completions", "bash"],
            &["man"],
            &["run", "ok.g7", "--headless"],
            &["test", "ok.g7"],
            &["check", "--format", "json"],
        ] {
            let mut command = std::process::Command::new(snapbox::cmd::cargo_bin!("g7"));
            let output =
                command.args(args).current_dir(folder.root()).stdout(full()).output().expect("it runs");
            let err = String::from_utf8_lossy(&output.stderr);
            assert_eq!(output.status.code(), Some(2), "{args:?}: {err}");
            assert!(err.lines().last().is_some_and(|l| l.contains("no space left")), "{args:?}: {err}");
            assert!(!err.contains("panicked"), "{args:?}: {err}");
        }
    }

    #[test]
    fn a_full_disk_stops_every_file_that_is_written() {
        let folder = Folder::with(PINGPONG);
        for name in ["full.csv", "full.vcd", "full.xml", "full"] {
            symlink("/dev/full", folder.path(name)).expect("a link");
        }
        for args in [
            &["run", "--headless", "--trace", "full.csv"][..],
            &["run", "--headless", "--trace", "full.vcd"],
            &["run", "--headless", "--record", "full"],
        ] {
            let ran = folder.g7(args);
            ran.is_refused(&["cannot write full", "no space left on device", "nothing was changed"]);
        }
        let ran = folder.g7(&["test", "--junit", "full.xml"]);
        assert!(ran.is(2).err.contains("no space left"), "{}", ran.err);
    }
}

#[test]
fn a_reader_that_goes_away_is_no_failure() {
    use std::io::Read;
    use std::process::{Command, Stdio};
    let mut child = Command::new(snapbox::cmd::cargo_bin!("g7"))
        .args(["completions", "zsh"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("it starts");
    drop(child.stdout.take());
    let mut err = String::new();
    child.stderr.take().expect("piped").read_to_string(&mut err).expect("text");
    assert_eq!((child.wait().expect("it ends").code(), err.as_str()), (Some(0), ""));
}

#[test]
fn explain_knows_every_code_and_says_where_it_comes_from() {
    let folder = Folder::new();
    let list = folder.g7(&["explain"]).is(0).out.clone();
    for code in g7_model::codes::ALL {
        assert!(list.contains(code.id), "{}", code.id);
    }
    let french = folder.g7(&["explain", "--lang", "fr"]).is(0).out.clone();
    assert!(french.contains("G0101  warning  un grafcet qui ne démarre jamais\n"), "{french}");
    assert_eq!(french.lines().count(), list.lines().count());
    let page = folder.g7(&["explain", "g0202"]).is(0).out.clone();
    assert!(page.contains("G0202") && page.contains("Source: "), "{page}");
    let french = folder.g7(&["explain", "--lang", "fr", "g0202"]).is(0).out.clone();
    assert!(french.starts_with("# G0202 : ") && french.contains("\nSource : IEC 61131-3"), "{french}");
    for (lang, first) in
        [("pt_PT.UTF-8", "# G0202: um nome"), ("de_DE.UTF-8", "# G0202: a name"), ("C", "# G0202: a name")]
    {
        folder
            .command(&["explain", "G0202"])
            .env("LANG", lang)
            .assert()
            .success()
            .stdout_eq(format!("{first}[..]\n...\n"));
    }
    assert!(folder.g7(&["explain", "--lang", "xx", "g0202"]).is(2).err.contains("--lang"));
    folder.g7(&["explain", "G9999"]).is_refused(&["G9999", "g7 explain"]);
}

const COMMANDS: [&str; 14] = [
    "new",
    "check",
    "fmt",
    "run",
    "devices",
    "plant",
    "service",
    "test",
    "draw",
    "import",
    "export",
    "explain",
    "completions",
    "man",
];

#[test]
fn completions_and_manual_pages_name_every_command() {
    let folder = Folder::new();
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let text = folder.g7(&["completions", shell]).is(0).out.clone();
        assert!(COMMANDS.iter().all(|c| text.contains(c)), "{shell}");
    }
    folder.g7(&["man", "--out", "pages"]).is(0);
    for command in COMMANDS {
        assert!(folder.read(&format!("pages/g7-{command}.1")).contains(".TH"), "{command}");
    }
    assert!(folder.g7(&["man"]).is(0).out.contains("g7"));
}

#[test]
fn help_teaches_by_example() {
    let folder = Folder::new();
    for command in COMMANDS {
        let help = folder.g7(&[command, "--help"]).is(0).out.clone();
        assert!(help.contains("Examples:") && help.contains(&format!("  g7 {command}")), "{command}: {help}");
    }
    assert!(folder.g7(&["--help"]).is(0).out.contains("Exit codes:"));
}

#[test]
fn import_refuses_what_is_no_foreign_file_and_what_is_there_already() {
    let folder = Folder::with(PINGPONG);
    folder.g7(&["import", "chart.g7"]).is_refused(&["chart.g7", "not a file of another tool"]);
    folder.write("a.xml", XML);
    folder.write("out.g7", "mine");
    folder.g7(&["import", "a.xml", "-o", "out.g7"]).is_refused(&["out.g7", "--force"]);
    assert_eq!(folder.read("out.g7"), "mine");
    folder.g7(&["import", "a.xml", "-o", "out.g7", "--force"]).is(0);
    folder.g7(&["check", "out.g7"]).is(0);
    assert_eq!(folder.g7(&["import", "a.xml"]).is(0).out, folder.read("out.g7"));
    let both = [folder.g7(&["run", "a.xml", "--headless"]), folder.g7(&["run", "out.g7", "--headless"])];
    for ran in both {
        assert!(ran.is(0).out.contains("now in {Vent på start}"), "{}", ran.out);
    }
}

/// A minimal file: one initial step whose name contains blanks and a non-ASCII letter.
const XML: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<GCDocument name="Top" threadSpeed="40" saveVersion="8">
  <GCInitialStep id="1" name="Vent på start" actionText="" x="10" y="10" width="40" height="40"/>
  <GCTransition id="2" actionText="0" x="10" y="80"/>
  <GCLink fromObject="1" toObject="2"/>
  <GCLink fromObject="2" toObject="1"/>
</GCDocument>
"#;

#[test]
fn export_writes_whole_files_and_asks_for_the_form() {
    let folder = Folder::with(PINGPONG);
    let shown = folder.g7(&["export", "chart.g7", "--to", "mermaid"]).is(0).out.clone();
    assert!(shown.starts_with("flowchart TB\n"), "{shown}");
    folder.g7(&["export", "chart.g7"]).is_refused(&["--to", "mermaid"]);
    folder.g7(&["export", "chart.g7", "-o", "chart.mmd"]).is(0);
    assert_eq!(folder.read("chart.mmd"), shown);
    folder.g7(&["export", "chart.g7", "-o", "chart.mmd"]).is_refused(&["chart.mmd", "--force"]);
    folder.write("wrong.g7", "chart G { initial step 1 1 -> 2 when TRUE }");
    let out = folder.g7(&["export", "wrong.g7", "-o", "wrong.mmd"]).is(1).err.clone();
    assert!(out.contains("G0204"), "{out}");
    assert!(!folder.path("wrong.mmd").exists(), "nothing is written of a chart with errors");
}
