//! Projects for CODESYS: flags that reset and hold charts, bodies beside steps.
#![allow(clippy::disallowed_methods, reason = "the corpus is read")]

use crate::plcopen::show::{document, errors, text};
use crate::support;

use g7_exchange::Dialect;
use g7_iec::Written;
use g7_model::{Document, FileId, Item};

fn written(document: &Document) -> Written {
    let format = g7_exchange::named("plcopen").expect("a format of the table");
    format.write_in(document, Dialect::Codesys).expect("it has dialects")
}

/// A document without its places.
fn unplaced(mut document: Document) -> String {
    document.items.retain(|i| !matches!(i, Item::Layout(_)));
    text(&document)
}

/// Two charts as CODESYS controls them; the flags are written by the body before them.
const FLAGS: &str = r#"
profile iec61131 { no-final-scan }
var stop : BOOL
var done : BOOL
pre {
  One.SFCReset := stop
  One.part := stop
  Two.SFCInit := stop
  Two.SFCPause := not stop
  done := One.full
}
chart One {
  var part : BOOL
  var full : BOOL
  var SFCReset : BOOL
  initial step Rest
  step Run { N Run_active  P1 Run_entry }
  Rest -> Run when part
  Run -> Rest when not part
  action Run_active { full := TRUE }
  action Run_entry { full := FALSE }
  pre { IF SFCReset THEN INITCHART(One) END_IF }
}
chart Two {
  var SFCInit : BOOL
  var SFCPause : BOOL
  var full : BOOL
  initial step Rest { P0 Rest_exit }
  step Run
  Rest -> Run when not SFCInit and not SFCPause and One.part
  Run -> Rest when not SFCInit and not SFCPause
  action Rest_exit { IF not SFCInit and not SFCPause THEN full := not full END_IF }
  pre { IF SFCInit THEN INITCHART(Two) END_IF }
}
"#;

#[test]
fn flags_of_codesys_come_back() {
    let there = document(FLAGS);
    let made = written(&there);
    assert_eq!(errors(&made.problems), Vec::<&str>::new());
    assert!(!made.text.contains("INITCHART"), "{}", made.text);
    let (back, problems) = support::import("plcopen", made.text.as_bytes(), FileId(1));
    assert_eq!(errors(&problems), Vec::<&str>::new());
    assert_eq!(unplaced(back), text(&there), "{}", made.text);
}

#[test]
fn what_flags_would_change_is_refused() {
    let cases = [
        // Nothing resets the chart here, and CODESYS would.
        (
            "  pre { IF SFCReset THEN INITCHART(One) END_IF }\n",
            "",
            "initial steps while its variable `SFCReset`",
        ),
        // A transition that does not wait.
        (
            "when not SFCInit and not SFCPause\n",
            "when not SFCInit\n",
            "holds the chart `Two` while its variable `SFCPause`",
        ),
        // A body that does not wait.
        ("IF not SFCInit and not SFCPause THEN", "IF not SFCPause THEN", "while its variable `SFCInit`"),
        // A reset by something else.
        ("IF SFCReset THEN", "IF part THEN", "a call of `INITCHART`"),
        // A flag of all charts.
        (
            "var stop : BOOL",
            "var stop : BOOL\nvar sfcinit : BOOL",
            "controls charts by variables called `sfcinit`",
        ),
    ];
    for (from, to, expected) in cases {
        let changed = FLAGS.replace(from, to);
        assert_ne!(changed, FLAGS);
        let made = written(&document(&changed));
        let told = errors(&made.problems);
        assert!(told.iter().any(|t| t.contains(expected)), "{expected}: {told:?}");
    }
    // Other dialects have no flags.
    let standard =
        g7_exchange::named("plcopen").and_then(|f| f.write_in(&document(FLAGS), Dialect::Standard));
    let problems = standard.expect("it has dialects").problems;
    assert!(errors(&problems).iter().all(|t| t.contains("a form for CODESYS alone")), "{problems:?}");
    assert_eq!(errors(&problems).len(), 2);
}

#[test]
fn projects_of_codesys_come_back() {
    let Some(folder) = g7_peers::corpus("plcopen-sfc") else { return };
    let mut same = 0;
    for case in
        ["share/PPU", "aps-rvt/examples/ppumod/02_03", "aps-rvt/examples/ppumod/05_07", "absintsfc/examples"]
    {
        for file in std::fs::read_dir(folder.join("VerifAPS").join(case)).expect(case) {
            let path = file.expect("a file").path();
            let bytes = std::fs::read(&path).expect("a file");
            let (there, _) = support::import("plcopen", &bytes, FileId(0));
            let made = written(&there);
            assert_eq!(errors(&made.problems), Vec::<&str>::new(), "{}", path.display());
            let (back, _) = support::import("plcopen", made.text.as_bytes(), FileId(1));
            assert_eq!(text(&back), text(&there), "{}", path.display());
            same += 1;
        }
    }
    assert!(same >= 14, "only {same}");
}
