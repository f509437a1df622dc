//! `g7 gen fmu` and an FMU as the plant of `g7 run`: a chart is the plant of another one, the reference FMUs run
//! as in FMPy (their folder is named by `G7_FMUS`), and what is wrong is told.
#![allow(missing_docs, reason = "a test")]
#![allow(clippy::disallowed_methods, reason = "tests look at the machine that they run on")]

use crate::common;

use std::path::{Path, PathBuf};
use std::process::Command;

use common::Folder;

const CONTROL: &str = "profile iec60848
input level : REAL
input full : BOOL
output fill : BOOL
output n : INT
chart C {
  initial step 1
  step 2 { N fill }
  step 3 { P1 { n := n + 1 } }
  1 -> 2 when 50ms/X1
  2 -> 3 when full
  3 -> 1 when level < 1.0
}
";

const TANK: &str = "profile iec61131
input fill : BOOL
output level : REAL
output full : BOOL
chart T {
  initial step 1 { N level := MAX(level - 0.5, 0.0) }
  step 2 { N level := level + 1.0 }
  1 -> 2 when fill
  2 -> 1 when not fill
}
chart F {
  initial step F1
  step F2 { N full }
  F1 -> F2 when level >= 3.0
  F2 -> F1 when level < 3.0
}
";

/// Asserts the exit code, and a part of the messages.
#[track_caller]
fn says(ran: common::Ran, code: i32, part: &str) {
    assert!(ran.is(code).err.contains(part), "`{part}` in: {}", ran.err);
}

#[test]
fn a_chart_is_the_plant_of_another() {
    if !g7_peers::tool("cc") {
        return;
    }
    // The tank reads `fill` in the scan that is due where the step begins, and its answer is there where it ends.
    // It finds in the scan behind that its level is 3. A step that ends acts once more (IEC 61131-3): 4 + 1 - 0.5.
    let expected = "time,level,full,fill,n,X1,X2,X3\n\
                    0,0,0,0,0,1,0,0\n\
                    0.05,0,0,1,0,0,1,0\n\
                    0.06,1,0,1,0,0,1,0\n\
                    0.07,2,0,1,0,0,1,0\n\
                    0.08,3,0,1,0,0,1,0\n\
                    0.09,4,1,0,1,0,0,1\n\
                    0.1,4.5,1,0,1,0,0,1\n";
    for version in ["2", "3"] {
        let folder = Folder::with(CONTROL);
        folder.write("tank.g7", TANK);
        says(folder.g7(&["gen", "fmu", "tank.g7", "--fmi", version]), 0, "wrote tank.fmu");
        folder.g7(&["run", "--plant", "tank.fmu", "--for", "100ms", "--trace", "out.csv"]).is(0);
        assert_eq!(folder.read("out.csv"), expected, "FMI {version}");
        // The same by names that differ.
        folder.write("other.g7", CONTROL.replace("fill", "pump").replace("full", "top"));
        let wires = ["--wire", "pump=fill", "--wire", "full=top"];
        let run = ["run", "other.g7", "--plant", "tank.fmu", "--for", "100ms", "--trace", "other.csv"];
        folder.g7(&[&run[..], &wires].concat()).is(0);
        assert_eq!(folder.read("other.csv").replace("pump", "fill").replace("top", "full"), expected);
        // A force is stronger than the plant.
        folder.g7(&[&run[..], &wires, &["--set", "top=1@60ms"]].concat()).is(0);
        assert!(folder.read("other.csv").contains("\n0.06,1,1,0,1,0,0,1\n"), "{}", folder.read("other.csv"));
    }
}

#[test]
fn a_fault_of_the_plant_is_told() {
    if !g7_peers::tool("cc") {
        return;
    }
    let folder = Folder::with(CONTROL);
    folder.write("tank.g7", TANK.replace("level + 1.0", "level + INT_TO_REAL(1 / REAL_TO_INT(level))"));
    folder.g7(&["gen", "fmu", "tank.g7"]).is(0);
    let ran = folder.g7(&["run", "--plant", "tank.fmu", "--for", "1s"]);
    assert!(ran.err.contains("division by zero"), "{}", ran.err);
    says(ran, 2, "`fmi2DoStep` failed: fault in the scan at");
}

#[test]
fn the_same_chart_gives_the_same_archive_and_none_is_lost() {
    let folder = Folder::with(TANK);
    for file in ["a.fmu", "b.fmu"] {
        folder.g7(&["gen", "fmu", "--sources", "--name", "tank", "-o", file]).is(0);
    }
    let bytes = |name: &str| std::fs::read(folder.path(name)).expect("an archive");
    assert!(bytes("a.fmu") == bytes("b.fmu"), "no time of day, no chance");
    says(folder.g7(&["gen", "fmu", "-o", "a.fmu"]), 2, "a.fmu already exists; --force replaces it");
    let without = folder.command(&["gen", "fmu", "-o", "c.fmu"]).env("CC", "no-such-compiler");
    says(without.assert().into(), 0, "no C compiler was found");
}

#[test]
fn what_is_wrong_with_a_plant_is_told() {
    let folder = Folder::with(CONTROL);
    folder.write("tank.g7", TANK);
    folder.write("junk.fmu", "no archive");
    folder.g7(&["gen", "fmu", "tank.g7", "--sources"]).is(0);
    let run = |plant: &str| folder.g7(&["run", "--plant", plant]);
    says(run("junk.fmu"), 2, "junk.fmu: no FMU");
    says(run("none.fmu"), 2, "cannot read none.fmu");
    says(run("tank.fmu"), 2, "it has no library for this machine");
    for (wire, why) in [
        ("n=fill", "`n` is INT here, and `fill` is Boolean there"),
        ("fill=nothing", "neither an output of the charts and an input of the FMU"),
        ("level=level=3", "neither"),
    ] {
        says(folder.g7(&["run", "--plant", "tank.fmu", "--wire", wire]), 2, why);
    }
    says(folder.g7(&["run", "--wire", "a=b"]), 2, "--wire is for a plant that is an FMU");
    says(folder.g7(&["run", "--online", "--plant", "tank.fmu"]), 2, "without --online");
}

/// A reference FMU of each version.
fn references(name: &str) -> Vec<PathBuf> {
    let Some(folder) = std::env::var_os("G7_FMUS").map(PathBuf::from) else {
        g7_peers::skip("reference FMUs absent (G7_FMUS)");
        return Vec::new();
    };
    let all = ["2.0", "3.0"].map(|version| folder.join(version).join(format!("{name}.fmu")));
    all.into_iter().filter(|p| p.is_file() || panic!("{} is not there", p.display())).collect()
}

/// The lines of the rows of G7 and of FMPy, for variables that the chart has as inputs.
fn beside_fmpy(fmu: &Path, chart: &str, names: &[&str]) {
    let Some(python) = g7_peers::python("fmpy") else { return };
    let folder = Folder::with(chart);
    let plant = fmu.to_str().expect("a path");
    let run = ["run", "--plant", plant, "--scan", "100ms", "--for", "2s", "--trace", "out.csv"];
    folder.g7(&run).is(0);
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/peers/python/fmu_plant.py");
    let out = Command::new(python).arg(script).arg(fmu).args(["0.1", "20"]).args(names).output();
    let out = out.expect("Python starts");
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    let text = String::from_utf8_lossy(&out.stdout).into_owned();
    let theirs: Vec<Vec<f64>> =
        text.lines().map(|l| l.split(' ').map(|v| v.parse().expect("a number")).collect()).collect();
    assert_eq!(theirs.len(), 21);
    let csv = folder.read("out.csv");
    let mut rows = csv.lines();
    let head: Vec<&str> = rows.next().expect("a head").split(',').collect();
    let at: Vec<usize> = names.iter().map(|n| head.iter().position(|h| h == n).expect("a column")).collect();
    let mut seen = 0;
    for row in rows {
        let cells: Vec<f64> = row.split(',').map(|c| c.parse().expect("a number")).collect();
        let instant = (cells[0] * 10.0).round() as usize;
        let ours: Vec<f64> = at.iter().map(|i| cells[*i]).collect();
        assert_eq!(ours, theirs[instant], "{} at {} s", fmu.display(), cells[0]);
        seen += 1;
    }
    assert!(seen > 15, "{seen} rows: the plant moves");
}

#[test]
fn reference_fmus_run_as_in_fmpy() {
    let ball = "profile iec60848\ninput h, v : LREAL\noutput low : BOOL\n\
                chart B { initial step 1 step 2 { N low } 1 -> 2 when h < 0.2  2 -> 1 when h > 0.3 }\n";
    for fmu in references("BouncingBall") {
        beside_fmpy(&fmu, ball, &["h", "v"]);
    }
    let decay = "profile iec60848\ninput x : LREAL\noutput half : BOOL\n\
                 chart D { initial step 1 step 2 { N half } 1 -> 2 when x < 0.5  2 -> 1 when x > 0.6 }\n";
    for fmu in references("Dahlquist") {
        beside_fmpy(&fmu, decay, &["x"]);
    }
}

#[test]
fn a_reference_fmu_hands_all_types_through() {
    let chart = "profile iec60848
input Boolean_output : BOOL
input Int32_output : DINT
input Float64_continuous_output : LREAL
output Boolean_input : BOOL
output Int32_input : DINT := 7
output Float64_continuous_input : LREAL := 0.1
chart F {
  initial step 1
  step 2 { N Boolean_input  P1 { Int32_input := -70000; Float64_continuous_input := 2.5 } }
  1 -> 2 when 200ms/X1
}
";
    for fmu in references("Feedthrough") {
        let folder = Folder::with(chart);
        let plant = fmu.to_str().expect("a path");
        let run = ["run", "--plant", plant, "--scan", "100ms", "--for", "300ms", "--trace", "out.csv"];
        says(folder.g7(&run), 0, "not wired, and with their first value");
        let csv = folder.read("out.csv");
        let head = "time,Boolean_output,Int32_output,Float64_continuous_output,";
        let rows: Vec<&str> = csv.lines().collect();
        assert!(rows[0].starts_with(head), "{csv}");
        // The outputs of the scan at 200 ms are there again at 300 ms.
        assert!(rows[1].starts_with("0,0,7,0.1,0,7,0.1,"), "{csv}");
        assert!(csv.contains("\n0.2,0,7,0.1,1,-70000,2.5,"), "{csv}");
        assert!(csv.contains("\n0.3,1,-70000,2.5,1,-70000,2.5,"), "{csv}");
    }
}
