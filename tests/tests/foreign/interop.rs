//! Projects in PLCopen XML and Ladder, opened by the generators of Beremiz and OpenPLC where these are found
//! (`g7_peers::projects`), compiled by matiec, and run beside the engine. `make interop` does so with many charts.
#![allow(clippy::disallowed_methods, reason = "the test starts other programs")]

use std::path::Path;

use g7_codegen::plc;
use g7_exchange::{Dialect, Format};
use g7_model::{Document, FileId, Item, Severity};
use g7_peers::Matiec;
use g7_peers::mended::mended;
use g7_peers::projects::{output, readers};
use g7_tests::generated::cases::Folder;
use g7_tests::generated::project;

/// Charts with what these tools need in a form of their own, or do otherwise than the standard:
///
/// - chained divergences, jumps, macro-steps, two charts, addresses, function blocks, no variables at all;
/// - several steps with one output, pulses of initial steps, bodies that run once more, `R` after `SD`;
/// - inverted channels and actions of macro-steps, which are rewritten;
/// - a step, or the time of a step, that another chart reads; step times in scans;
/// - conditions that read what actions drive;
/// - constants of several programs, and a block of the file that is called with an output;
/// - a step that nothing reaches, and a step that is called like its program;
/// - steps that are called like members of blocks.
const CHARTS: [(&str, &str); 13] = [
    (
        "letters",
        "input a, b : BOOL
         output l : BOOL
         chart G {
           initial step X { D 300ms l }
           step Q { L 200ms l }
           step T { N l if T.T > 200ms }
           X -> Q when a
           Q -> T when b and Q.T > 100ms
           T -> X when not a
         }",
    ),
    (
        "never",
        "input a, b : BOOL
         output q, r : BOOL
         chart Press {
           initial step Rest { N r if Out.X or Out.T > 1s }
           step press { N q }
           step Out { N q }
           step Behind
           Rest -> press when a
           press -> Rest when b and not Out.X
           Out -> Behind when a
           (press, Out) -> Rest when a
         }",
    ),
    (
        "clocks",
        "input a, b : BOOL
         const far : TIME := 300ms
         chart One {
           initial step S1  step S2  macro M = Inner
           S1 -> S2 when S4.X and S4.T >= 200ms
           S2 -> S1 when S3.T > far
           S2 -> M when b
           M -> S1 when M.T > 400ms
         }
         macrochart Inner { entry step I  exit step O  I -> O when a }
         chart Two { initial step S3  step S4  S3 -> S4 when a  S4 -> S3 when S2.X and S2.T >= 100ms or not a }",
    ),
    (
        "before",
        "input a, b : BOOL
         output q, r, s, t : BOOL
         var n : INT
         chart G {
           initial step A { N r  N q if r  N n := n + 1 }
           step B { N r if not q  N s if n > 9  N t if not t }
           A -> B when a
           B -> A when b
           initial step C { N q if s }
           step D { N t if r }
           C -> D when b
           D -> C when a
         }",
    ),
    (
        "scans",
        "profile iec61131 { scan-clock }
         input a, b : BOOL
         output q : BOOL
         var n : INT
         var x : REAL
         chart G {
           initial step A { N x := A.s }
           step B { N q  N n := B.t }
           A -> B when a and A.t >= 3 or A.s > 0.085
           B -> A when B.t > 2
         }
         chart H { initial step C  step D  C -> D when B.t = 2  D -> C when b and D.s >= 0.015 }",
    ),
    (
        "outputs",
        "input a : BOOL
         output q, r : BOOL
         var pause : TON
         pre { pause(IN := a, PT := 100ms, Q => q) }
         chart G {
           initial step A { N { if a then pause(IN := not a, PT := 50ms, Q => r) end_if } }
           step B
           A -> B when q
           B -> A when not a
         }",
    ),
    (
        "channels",
        "input a, b : BOOL
         input c : BOOL at %IX0.3 inverted
         output horn, lamp : BOOL
         output q : BOOL := TRUE at %QX0.1 inverted
         var n, m : INT
         chart G {
           initial step A { N q }
           macro M = Inner { N horn if a  D 300ms lamp  P1 n := n + 1  P0 m := m + 1  S q }
           step B { N horn  R q }
           A -> M when b
           M -> B when c
           B -> A when ↑c or B.T > 2s
         }
         macrochart Inner { entry step I { N horn if not a }  step K  exit step O  I -> K when a  K -> I when ↑b  K -> O when not a }",
    ),
    (
        "conveyor",
        "input start, stop, part : BOOL
         output motor, lamp : BOOL
         var parts : INT
         chart Conveyor {
           initial step Rest { P1 parts := 0 }
           step Run { N motor  N lamp }
           step Clear { N motor  P0 parts := parts + 1 }
           Rest -> Run when start and not stop
           Run -> Clear when part
           Run -> Rest when stop
           Clear -> Run when Clear.T >= 500ms
         }",
    ),
    (
        "qualifiers",
        "input a, b : BOOL
         output q, r, s, t, u : BOOL
         var n, m : INT
         chart G {
           initial step A { SD 1s q  SL 2s r  P u  N Count  P0 Last }
           step B { R q  DS 300ms s  N t  L 200ms u }
           step C { R s  N t  N Count  P1 n := n + 1 }
           A -> B when a
           B -> C when b
           B -> A when not a
           C -> A when A.T > 5s or not b
           action Count { m := m + 1 }
           action Last { n := n + 10 }
         }
         chart H { initial step D { N Own }  step E  D -> E when G.B.X  E -> D when not G.C.X and a  action Own { m := m - 1 } }",
    ),
    (
        "chained",
        "input a, b : BOOL
         chart G {
           initial step S1  step S2  step S3  step S4  macro M = Inner
           S1 -> (S2, S3) when a
           S1 -> S2 when b
           S2 -> S4 when not a
           (S2, S3) -> M when a and b
           M -> S1 when a
           S4 -> S1 when b
         }
         macrochart Inner { entry step I  exit step O  I -> O when a }",
    ),
    ("bare", "chart G { initial step S1  step S2  S1 -> S2 when S1.t >= 1s  S2 -> S1 when S2.t >= 1s }"),
    (
        "two",
        "input a : BOOL at %IX0.0
         output q : BOOL at %QX0.0
         chart One { initial step S1  step S2 { N q }  S1 -> S2 when a  S2 -> S1 when not a }
         chart Two { initial step S3  step S4  S3 -> S4 when One.S2.X  S4 -> S3 when a }",
    ),
    (
        "blocks",
        "input a : BOOL
         output q : BOOL
         var n : INT
         chart G {
           initial step S1 { N q if a  P1 n := n + 1 }
           step S2 { D 2s q }
           S1 -> S2 when ↑a
           S2 -> S1 when 3s/a
         }",
    ),
];

/// One of the charts; those without a profile have that of the standard.
/// All of them, and the conveyor that a story of the page draws (`web/tests/stories.test.ts`), by the rules of the tools that
/// take it.
fn charts() -> Vec<(&'static str, String)> {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../web/tests/drawn/conveyor.g7");
    let drawn = std::fs::read_to_string(&file).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
    let charts = CHARTS.iter().map(|(name, text)| (*name, (*text).to_owned()));
    charts.chain([("drawn in the page", drawn)]).collect()
}

fn chart(name: &str, text: &str) -> Document {
    let profile = if text.starts_with("profile") { "" } else { "profile iec61131\n" };
    let (document, problems) = g7_syntax::parse(&format!("{profile}{text}"), FileId(0));
    assert!(problems.is_empty(), "{name}: {problems:?}");
    document
}

/// The project for each tool is read again and runs as the chart, without any peer.
#[test]
fn projects_run_as_their_charts() {
    let plcopen = g7_exchange::named("plcopen").expect("a format of the table");
    for (name, text) in &charts() {
        let document = chart(name, text);
        let before = g7_compile::compile(&document).0.expect("the chart is compiled");
        for dialect in Dialect::ALL {
            let written = plcopen.write_in(&document, dialect).expect("it has dialects");
            let lost: Vec<_> = written.problems.iter().filter(|p| p.severity() == Severity::Error).collect();
            assert!(lost.is_empty(), "{name}: {lost:?}");
            let (again, problems) = plcopen.read(written.text.as_bytes(), FileId(0)).expect("it is read");
            let (compiled, more) = g7_compile::compile(&again);
            let behind =
                compiled.unwrap_or_else(|| panic!("{name}: {problems:?} {more:?}\n{}", written.text));
            for seed in 1..4 {
                let scans = project::scans(&before, seed, 300, 10_000_000, false);
                let (want, got) = (project::of_engine(&before, &scans), project::of_engine(&behind, &scans));
                let (names, differ) = project::difference(&want, &got);
                assert!(names > 0, "{name}: no name in common");
                if let Some(differ) = differ {
                    panic!("{name} for {}, seed {seed}: {differ}\n{}", dialect.word(), written.text);
                }
            }
        }
    }
}

#[test]
fn beremiz_and_openplc_open_projects() {
    let readers = readers();
    let matiec = if readers.is_empty() { None } else { g7_peers::matiec() };
    let folder = Folder::new("interop");
    std::fs::create_dir_all(&folder.0).expect("a folder");
    let plcopen = g7_exchange::named("plcopen").expect("a format of the table");
    for reader in &readers {
        for (name, text) in &charts() {
            let document = chart(name, text);
            let dialect = if reader.name == "OpenPLC" { Dialect::OpenPlc } else { Dialect::Beremiz };
            let written = plcopen.write_in(&document, dialect).expect("it has dialects");
            let lost: Vec<_> = written.problems.iter().filter(|p| p.severity() == Severity::Error).collect();
            assert!(lost.is_empty(), "{name}: {lost:?}");
            let project = folder.0.join("plc.xml");
            std::fs::write(&project, &written.text).expect("a file");
            let made = reader.text(&project).unwrap_or_else(|e| panic!("{} on {name}: {e}", reader.name));
            assert!(made.contains("INITIAL_STEP"), "{name}: {made}");
            if let Some(matiec) = &matiec {
                let compared =
                    alike(matiec, &folder.0, &document, &made).unwrap_or_else(|e| panic!("{name}: {e}"));
                assert!(compared > 0, "{name}: no name in common");
            }
        }
    }
}

#[test]
fn beremiz_writes_types_and_blocks_that_are_read_as_those_of_the_project() {
    let (plcopen, text) = (format_named("plcopen"), format_named("sfc"));
    let folder = Folder::new("interop-types");
    std::fs::create_dir_all(&folder.0).expect("a folder");
    let project = folder.0.join("plc.xml");
    for reader in readers().iter().filter(|r| r.name == "Beremiz") {
        for name in ["types.xml", "station.xml"] {
            let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("interchange/plcopen").join(name);
            let own = std::fs::read_to_string(own).expect("a file of the repository");
            // Beremiz leaves out the numbers of values of enumerations and the comments of members.
            let own = own.replace("name=\"Hand\" value=\"5\"", "name=\"Hand\"").replace("in mm", "");
            std::fs::write(&project, &own).expect("a file");
            let made = reader.text(&project).unwrap_or_else(|e| panic!("{} on {name}: {e}", reader.name));
            let (read, written) = (lines(plcopen, &own), lines(text, &made));
            assert_eq!(read, written, "{name}: {made}");
        }
    }
}

fn format_named(name: &str) -> &'static Format {
    g7_exchange::named(name).expect("a format of the table")
}

/// The lines of a document but for places, in an order that does not depend on the file.
fn lines(format: &Format, text: &str) -> Vec<String> {
    let (mut document, problems) = format.read(text.as_bytes(), FileId(0)).expect("it is read");
    assert!(problems.iter().all(|p| p.severity() != Severity::Error), "{problems:?}");
    document.items.retain(|i| !matches!(i, Item::Layout(_)));
    let text = g7_syntax::print(&document, None);
    let mut lines: Vec<String> = text.lines().map(str::to_owned).filter(|l| !l.is_empty()).collect();
    lines.sort_unstable();
    lines
}

/// Compiles a program with matiec and runs it beside the chart; returns how many steps and variables they have
/// in common.
fn alike(matiec: &Matiec, folder: &Path, document: &Document, program: &str) -> Result<usize, String> {
    let (code, library) = (folder.join("c"), folder.join("C"));
    let _ = std::fs::remove_dir_all(&code);
    std::fs::create_dir_all(&code).map_err(|e| e.to_string())?;
    mended(&matiec.lib.join("C"), &library).map_err(|e| e.to_string())?;
    std::fs::write(code.join("program.st"), program).map_err(|e| e.to_string())?;
    output(&matiec.translate(&code, "program.st"))?;
    let chart = g7_compile::compile(document).0.ok_or("the chart is not compiled")?;
    let mut compared = 0;
    for seed in 1..4 {
        let scans = project::scans(&chart, seed, 300, 10_000_000, false);
        let got = project::of_matiec(&code, &library, &scans)?;
        let (names, differ) = project::difference(&project::of_engine(&chart, &scans), &got);
        compared = names;
        if let Some(differ) = differ {
            return Err(format!("seed {seed}: {differ}\n{program}"));
        }
    }
    Ok(compared)
}

/// A lone contact beside a series (`q`), edges, a timer and a sum, which are blocks of Ladder.
const LADDER: &str = "profile iec61131
input a : BOOL
output q : BOOL
var n : INT
chart G {
  initial step 1
  step 2 { N q  P1 n := n + 1 }
  step 3 { N q if a }
  1 -> 2 when ↑a
  2 -> 3 when 3s/a
  3 -> 1 when not a
}
";

#[test]
fn beremiz_opens_ladder() {
    let Some(reader) = readers().into_iter().find(|r| r.name == "Beremiz") else { return };
    let folder = Folder::new("interop-ladder");
    std::fs::create_dir_all(&folder.0).expect("a folder");
    let (document, problems) = g7_syntax::parse(LADDER, FileId(0));
    assert!(problems.is_empty(), "{problems:?}");
    let (compiled, problems) = g7_compile::compile(&document);
    let compiled = compiled.unwrap_or_else(|| panic!("{problems:?}"));
    let printed = plc::print(&compiled, plc::Form::Ld, "tank", LADDER).unwrap_or_else(|p| panic!("{p:?}"));
    let project = folder.0.join("tank.xml");
    std::fs::write(&project, &printed.text).expect("a file");
    let made = reader.text(&project).unwrap_or_else(|e| panic!("{e}"));
    assert!(made.contains("FUNCTION_BLOCK tank") && made.contains("TRUE"), "{made}");
}
