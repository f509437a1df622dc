//! On-line changes: a changed chart continues the run of another.
#![allow(clippy::disallowed_methods, reason = "the tests read the examples")]

use std::path::{Path, PathBuf};

use g7_host::{Runner, Value};
use g7_model::{Nanos, Said};
use g7_rig::{Bench, Carried, Item, Options, Role, Source, build, carry};

fn source(text: &str) -> Source {
    Source::new("a.g7", text.as_bytes().to_vec(), 0)
}

fn bench(source: &Source) -> Bench {
    let (bench, problems) = build(source, &Options::default()).expect("one plant");
    bench.unwrap_or_else(|| panic!("{problems:?}"))
}

fn item<'b>(bench: &'b Bench, name: &str) -> &'b Item {
    bench.item(name).unwrap_or_else(|| panic!("{name}"))
}

/// Runs the first text for a number of scans with these inputs, then continues with the second
/// text.
fn changed(before: &str, after: &str, inputs: &[(&str, u64)], scans: u32) -> (Bench, Carried) {
    let (old, new) = (source(before), source(after));
    let (was, is) = (bench(&old), bench(&new));
    let mut runner = was.runner(0);
    runner.scan().expect("no fault");
    for (name, value) in inputs {
        was.set(&mut runner, item(&was, name), &Value::Word(*value));
    }
    for _ in 0..scans {
        runner.scan().expect("no fault");
    }
    let carried = carry((&is, &new.document), (&was, &old.document), &runner).expect("it goes on");
    (is, carried)
}

fn texts(lost: &[Said]) -> Vec<&str> {
    lost.iter().map(Said::as_str).collect()
}

fn situation(bench: &Bench, runner: &Runner) -> String {
    bench.situation(runner.state()).join(",")
}

fn word(bench: &Bench, runner: &Runner, name: &str) -> u64 {
    bench.value(runner, item(bench, name)).word()
}

const PUMP: &str = "input a : BOOL\noutput pump : BOOL\nvar n : INT\nchart G {\n initial step 1\n step 2 { N pump }\n 1 -> 2 when a\n 2 -> 1 when not a on clearing { n := n + 1 }\n}\n";

#[test]
fn situation_values_and_step_times_go_on() {
    let after =
        PUMP.replace("when not a", "when not a and X2.t > 5s").replace("step 2 {", "step 3\n step 2 {");
    let after = after.replace("}\n}\n", "}\n 2 -> 3 when FALSE\n 3 -> 1 when TRUE\n}\n");
    let (bench, Carried { mut runner, lost }) = changed(PUMP, &after, &[("a", 1)], 100);
    assert_eq!(texts(&lost), [""; 0]);
    assert_eq!(situation(&bench, &runner), "2");
    assert_eq!(word(&bench, &runner, "pump"), 1);
    bench.set(&mut runner, item(&bench, "a"), &Value::Word(0));
    // Step 2 was activated at 10 ms and its time goes on, so 5 s have passed in the scan at 5.02 s.
    while runner.due() <= Nanos::from_millis(5010) {
        runner.scan().expect("no fault");
        assert_eq!(situation(&bench, &runner), "2", "at {} ns", runner.state().now());
    }
    runner.scan().expect("no fault");
    assert_eq!((situation(&bench, &runner), word(&bench, &runner, "n")), ("1".to_owned(), 1));
    assert_eq!(word(&bench, &runner, "pump"), 0);
}

#[test]
fn what_goes_away_is_said() {
    let before = PUMP.replace("1 -> 2 when a", "1 -> 2 when a on clearing { n := 7 }");
    let after = "input a : BOOL\noutput pump : BOOL\nvar n : BOOL\nchart G {\n initial step 1\n step 4 { N pump }\n 1 -> 4 when a\n 4 -> 1 when n\n}\n";
    let (bench, Carried { runner, lost }) = changed(&before, after, &[("a", 1)], 3);
    assert_eq!(
        texts(&lost),
        ["step `2` is active and no longer exists", "`n` was INT and is BOOL: its value 7 is lost"]
    );
    assert_eq!(situation(&bench, &runner), "");
}

#[test]
fn an_output_whose_action_is_gone_is_let_go() {
    let after = PUMP.replace("step 2 { N pump }", "step 2");
    let (bench, Carried { runner, .. }) = changed(PUMP, &after, &[("a", 1)], 3);
    assert_eq!(word(&bench, &runner, "pump"), 0);
}

#[test]
fn a_chart_more_begins_and_a_pulse_does_not_run_again() {
    let before = "profile iec61131\ninput a : BOOL\nvar n : INT\noutput q : BOOL\nchart G {\n initial step 1\n step 2 { P1 n := n + 1; S q }\n 1 -> 2 when a\n 2 -> 1 when not a\n}\n";
    let after = format!("{before}chart H {{\n initial step 10\n}}\n");
    let (bench, Carried { mut runner, lost }) = changed(before, &after, &[("a", 1)], 3);
    assert_eq!(texts(&lost), [""; 0]);
    for _ in 0..3 {
        runner.scan().expect("no fault");
    }
    assert_eq!(situation(&bench, &runner), "2,10");
    assert_eq!((word(&bench, &runner, "n"), word(&bench, &runner, "q")), (1, 1));
    bench.set(&mut runner, item(&bench, "a"), &Value::Word(0));
    runner.scan().expect("no fault");
    assert_eq!(word(&bench, &runner, "q"), 1, "set stays set");
}

#[test]
fn charts_of_function_blocks_go_on() {
    let before = "input go : BOOL\nfunction block Grip {\n input close : BOOL\n output coil : BOOL\n}\nchart Cycle of Grip {\n var n : INT\n initial step 1\n step 2 { P1 n := n + 1; N coil }\n 1 -> 2 when close\n 2 -> 1 when not close\n}\nvar grip : ARRAY[1..2] OF Grip\npre { grip[2](close := go) }\n";
    let after = before.replace("[1..2]", "[1..3]");
    let (bench, carried) = changed(before, &after, &[("go", 1)], 3);
    assert_eq!(texts(&carried.lost), [""; 0]);
    assert_eq!(situation(&bench, &carried.runner), "grip[1].Cycle.1,grip[2].Cycle.2,grip[3].Cycle.1");
    assert_eq!(word(&bench, &carried.runner, "grip[2].Cycle.n"), 1);
    let (bench, carried) =
        changed(&after, &after.replace("[1..3]", "[1..1]").replace("[2]", "[1]"), &[("go", 1)], 3);
    // The only step with this name has the short one.
    assert_eq!(situation(&bench, &carried.runner), "1");
    assert!(texts(&carried.lost).contains(&"step `grip[2].Cycle.2` is active and no longer exists"));
}

#[test]
fn instances_go_on_and_one_more_begins() {
    let before = "input a : ARRAY[1..3] OF BOOL\nchart Axis(i : INT) {\n var n : INT\n initial step 1\n step 2 { P1 n := n + i }\n 1 -> 2 when a[i]\n 2 -> 1 when not a[i]\n}\ninstance Axis[1..2]\n";
    let after = before.replace("[1..2]\n", "[1..3]\n");
    let (bench, carried) = changed(before, &after, &[("a[2]", 1)], 3);
    assert_eq!(texts(&carried.lost), [""; 0]);
    assert_eq!(situation(&bench, &carried.runner), "Axis[1].1,Axis[2].2,Axis[3].1");
    assert_eq!(word(&bench, &carried.runner, "Axis[2].n"), 2);
    let (bench, carried) = changed(&after, before, &[("a[3]", 1)], 3);
    assert_eq!(situation(&bench, &carried.runner), "Axis[1].1,Axis[2].1");
    assert_eq!(
        texts(&carried.lost),
        ["step `Axis[3].2` is active and no longer exists", "`Axis[3].n`, which is 3, no longer exists"]
    );
}

/// The values of a BOOL in the following scans.
fn seen(bench: &Bench, runner: &mut Runner, name: &str, scans: u32) -> Vec<u64> {
    (0..scans)
        .map(|_| {
            runner.scan().expect("no fault");
            word(bench, runner, name)
        })
        .collect()
}

#[test]
fn a_delay_of_an_action_without_a_name_goes_on() {
    let chart = |own: &str| {
        format!(
            "profile iec61131\ninput a : BOOL\nvar n : INT\noutput q : BOOL\nchart G {{\n initial step 1\n step 2 {{ S q; {own} }}\n 1 -> 2 when a\n 2 -> 1 when not a\n}}\n"
        )
    };
    let before = chart("D 50ms n := n + 1");
    // A chart before it, with steps and blocks of its own, shifts all internal numbers.
    let front = "chart F {\n initial step 8 { D 1s n := 0; S r }\n}\n";
    let after = before.replace("chart G", &format!("output r : BOOL\n{front}chart G"));
    // Step 2 was activated in the second scan; four scans of its delay have passed.
    let (bench, Carried { mut runner, lost }) = changed(&before, &after, &[("a", 1)], 4);
    assert_eq!(texts(&lost), [""; 0]);
    let counts = seen(&bench, &mut runner, "n", 5);
    let (_, Carried { runner: mut unchanged, .. }) = changed(&before, &before, &[("a", 1)], 4);
    assert_eq!(counts, seen(&self::bench(&source(&before)), &mut unchanged, "n", 5));
    assert!(counts[0] == 0 && counts[4] > 1, "the delay ends in between: {counts:?}");
    // An action with another qualifier is a new action: it begins at the change.
    let after = chart("L 30ms n := n + 1");
    let (bench, Carried { mut runner, .. }) = changed(&before, &after, &[("a", 1)], 4);
    let counts = seen(&bench, &mut runner, "n", 8);
    assert!(counts[0] > 0 && counts[4] == counts[7], "{counts:?}");
}

#[test]
fn the_time_of_a_macro_step_goes_on() {
    let chart = "output v, w : BOOL\nchart G {\n initial macro M1 = A\n initial macro M2 = B\n initial step 9 { N v if XM1.t >= 50ms\n N w if XM2.t >= 60ms }\n}\nmacrochart A {\n entry step E\n exit step S\n E -> S when TRUE\n}\nmacrochart B {\n entry step E\n exit step S\n E -> S when TRUE\n}\n";
    let front = "chart F {\n initial macro M0 = C\n}\nmacrochart C {\n entry step E\n exit step S\n E -> S when TRUE\n}\n";
    let after = chart.replace("chart G", &format!("{front}chart G"));
    // At the change, 20 ms have passed.
    let (bench, Carried { mut runner, lost }) = changed(chart, &after, &[], 2);
    assert_eq!(texts(&lost), [""; 0]);
    let mut both = Vec::new();
    for _ in 0..6 {
        runner.scan().expect("no fault");
        both.push((word(&bench, &runner, "v"), word(&bench, &runner, "w")));
    }
    assert_eq!(both, [(0, 0), (0, 0), (1, 0), (1, 1), (1, 1), (1, 1)], "at 30 to 80 ms");
}

#[test]
fn scans_and_time_of_a_macro_step_go_on_where_the_clock_counts_scans() {
    let chart = "profile jgrafchart\nscan 10ms\ninput a : BOOL\nchart G {\n initial step 1\n macro M1 = A\n macro M2 = B\n 1 -> (M1, M2) when a\n}\nmacrochart A {\n entry step E\n exit step S\n E -> S when FALSE\n}\nmacrochart B {\n entry step E\n exit step S\n E -> S when FALSE\n}\n";
    let front = "chart F {\n initial macro M0 = C\n}\nmacrochart C {\n entry step E\n exit step S\n E -> S when FALSE\n}\n";
    let after = chart.replace("chart G", &format!("{front}chart G"));
    // The macro-steps are activated in the second scan, at 10 ms; the change comes three scans later.
    let (bench, Carried { mut runner, lost }) = changed(chart, &after, &[("a", 1)], 4);
    assert_eq!(texts(&lost), [""; 0]);
    runner.scan().expect("no fault");
    let program = &bench.compiled.program;
    let mut found = Vec::new();
    for m in &bench.compiled.symbols.macro_steps {
        let group = m.group;
        let s = runner.state();
        found.push((
            s.group_active(program, group),
            s.group_time(program, group),
            s.group_age(program, group),
        ));
    }
    // Scans and nanoseconds go on as before; M0 begins at the change.
    assert_eq!(found[1..], [(true, 4, 40_000_000); 2], "{found:?}");
    assert!(found[0].0 && found[0].1 <= 1, "{found:?}");
}

#[test]
fn step_times_begin_anew_from_a_clock_of_time_to_one_of_scans() {
    let after = format!("profile jgrafchart\n{}", PUMP.replace("when not a on", "when X2.t >= 5 on"));
    let (bench, Carried { mut runner, .. }) = changed(PUMP, &after, &[("a", 1)], 50);
    bench.set(&mut runner, item(&bench, "a"), &Value::Word(0));
    let mut scans = 0;
    while situation(&bench, &runner) == "2" && scans < 20 {
        runner.scan().expect("no fault");
        scans += 1;
    }
    assert_eq!(scans, 5);
}

#[test]
fn an_output_that_nothing_drives_any_more_goes_off_where_another_step_has_an_action_for_it() {
    let before = PUMP.replace("step 2 { N pump }", "step 2 { L 9s pump }");
    let after = PUMP.replace("step 2 { N pump }", "step 2").replace("step 1\n", "step 1 { D 5s pump }\n");
    let (bench, Carried { mut runner, .. }) = changed(&before, &after, &[("a", 1)], 3);
    runner.scan().expect("no fault");
    assert_eq!((situation(&bench, &runner), word(&bench, &runner, "pump")), ("2".to_owned(), 0));
}

#[test]
fn step_times_go_on_from_a_clock_of_scans_to_one_of_time() {
    let before = format!("profile jgrafchart\n{PUMP}");
    let after = PUMP.replace("when not a on", "when X2.t >= 1s on");
    // Step 2 was activated in the second scan, at 10 ms; the change is at 500 ms.
    let (bench, Carried { mut runner, .. }) = changed(&before, &after, &[("a", 1)], 50);
    bench.set(&mut runner, item(&bench, "a"), &Value::Word(0));
    while situation(&bench, &runner) == "2" {
        runner.scan().expect("no fault");
    }
    assert_eq!(runner.state().now(), 1_010_000_000);
}

#[test]
fn delays_that_run_or_are_over_are_said_to_begin_anew() {
    let before = "input a, b : BOOL\noutput q, r : BOOL\nchart G {\n initial step 1 {\n N q if 20ms/a\n N r if 9s/b\n }\n}\n";
    let lost = |inputs: &[(&str, u64)]| {
        let said = changed(before, before, inputs, 5).1.lost;
        texts(&said).into_iter().filter(|s| s.contains("delay")).map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(lost(&[]), [""; 0]);
    // The delay of `a` is over, that of `b` is still running.
    let one = lost(&[("a", 1)]);
    assert_eq!(one, ["a running delay restarts"]);
    assert_eq!(lost(&[("b", 1)]), one);
    let two = lost(&[("a", 1), ("b", 1)]);
    assert!(two.len() == 1 && two[0].contains('2'), "{two:?}");
}

fn examples(folder: &Path, all: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            examples(&path, all);
        } else if path.extension().is_some_and(|e| e == "g7") {
            all.push(path);
        }
    }
}

/// A pseudo-random number; every run gives the same ones.
fn next(seed: &mut u64) -> u64 {
    *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    *seed >> 33
}

#[test]
fn an_unchanged_chart_goes_on_as_if_nothing_had_been() {
    let mut paths = Vec::new();
    examples(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples"), &mut paths);
    paths.sort();
    assert!(paths.len() > 15, "{paths:?}");
    let mut compared = 0;
    for path in paths {
        let text = std::fs::read_to_string(&path).expect("an example");
        let source = source(&text);
        let plant = g7_compile::plant::plants(&source.document).next().map(|p| p.name.text.to_string());
        let options = Options { plant: plant.as_deref(), ..Options::default() };
        let Some(bench) = build(&source, &options).expect("its plant").0 else { continue };
        let mut seed = 7;
        for length in [1, 20, 300, 1500] {
            let mut runner = bench.runner(3);
            for _ in 0..length {
                stir(&bench, &mut runner, &mut seed);
                runner.scan().ok();
            }
            let same = (&bench, &source.document);
            let Ok(Carried { runner: mut other, lost }) = carry(same, same, &runner) else { continue };
            if !lost.is_empty() {
                continue;
            }
            compared += 1;
            for scan in 0..200 {
                let mut again = seed;
                stir(&bench, &mut runner, &mut seed);
                stir(&bench, &mut other, &mut again);
                assert_eq!(runner.scan().is_ok(), other.scan().is_ok());
                let at = format!("{} after {length}, scan {scan}", path.display());
                assert_eq!(situation(&bench, &runner), situation(&bench, &other), "{at}");
                for item in &bench.items {
                    let values = (bench.value(&runner, item), bench.value(&other, item));
                    assert_eq!(values.0, values.1, "{} in {at}", item.name);
                }
            }
        }
    }
    assert!(compared > 40, "only {compared}");
}

/// Changes a free input now and then.
fn stir(bench: &Bench, runner: &mut Runner, seed: &mut u64) {
    for item in bench.items.iter().filter(|i| matches!(i.role, Role::Input(_)) && i.words == 1) {
        if next(seed).is_multiple_of(10) && !bench.is_driven(runner, item) {
            let value = next(seed) % 2;
            bench.set(runner, item, &Value::Word(value));
        }
    }
}

#[test]
fn a_copy_of_a_run_goes_on_like_it() {
    let mut paths = Vec::new();
    examples(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples"), &mut paths);
    let mut reports = 0;
    for path in paths {
        let source = source(&std::fs::read_to_string(&path).expect("an example"));
        let plant = g7_compile::plant::plants(&source.document).next().map(|p| p.name.text.to_string());
        let options = Options { plant: plant.as_deref(), ..Options::default() };
        let Some(bench) = build(&source, &options).expect("its plant").0 else { continue };
        let mut seed = 1;
        let mut runner = bench.runner(3);
        for _ in 0..100 {
            stir(&bench, &mut runner, &mut seed);
            runner.scan().ok();
        }
        let mut copy = runner.clone();
        for _ in 0..300 {
            let mut again = seed;
            stir(&bench, &mut runner, &mut seed);
            stir(&bench, &mut copy, &mut again);
            assert_eq!(runner.scan(), copy.scan(), "{}", path.display());
            assert_eq!(runner.state(), copy.state(), "{}", path.display());
            assert_eq!(runner.state().cleared(), copy.state().cleared(), "{}", path.display());
            assert_eq!(runner.state().ran(), copy.state().ran(), "{}", path.display());
            reports += runner.state().cleared().len() + runner.state().ran().len();
        }
    }
    assert!(reports > 1_000, "only {reports}");
}

const MODES: &str = "type Mode : (Off, Manual, Automatic)\ninput n : INT\nvar mode : Mode\nvar p : INT(0..100)\nvar i : INT\noutput q : BOOL\nchart G {\n initial step 1 { each scan: { p := n\n i := n\n mode := Automatic } }\n step 2 { N q }\n 1 -> 2 when p = 7 and mode = Off and i > 0\n 2 -> 1 when q\n}\n";

#[test]
fn a_value_goes_on_where_it_has_the_same_meaning_and_its_type_holds_it() {
    let kept = |after: &str, n: u64| {
        let after = after.replace("each scan: { p := n\n i := n\n mode := Automatic }", "N q");
        let (bench, Carried { runner, lost }) = changed(MODES, &after, &[("n", n)], 2);
        let values = ["mode", "p", "i"].map(|name| word(&bench, &runner, name));
        (values, texts(&lost).join("; "))
    };
    assert_eq!(kept(MODES, 60), ([2, 60, 60], String::new()));
    // Another value behind the one that it has, wider bounds, or none.
    let wider = MODES.replace("Automatic)", "Automatic, Setup)").replace("INT(0..100)", "INT(-9..500)");
    assert_eq!(kept(&wider, 60), ([2, 60, 60], String::new()));
    assert_eq!(kept(&MODES.replace("INT(0..100)", "INT"), 60), ([2, 60, 60], String::new()));
    assert_eq!(kept(&MODES.replace("var i : INT", "var i : INT(0..60)"), 60), ([2, 60, 60], String::new()));
    let closer = MODES.replace("INT(0..100)", "INT(0..59)");
    let lost = "`p` was INT(0..100) and is INT(0..59): its value 60 is lost";
    assert_eq!(kept(&closer, 60), ([2, 0, 60], lost.to_owned()));
    let other = MODES.replace("(Off, Manual, Automatic)", "(Off, Automatic, Manual)");
    let lost = "`mode` was Mode(Off=0,Manual=1,Automatic=2) and is Mode(Off=0,Automatic=1,Manual=2): its value 2 is lost";
    assert_eq!(kept(&other, 60), ([0, 60, 60], lost.to_owned()));
}

#[test]
fn values_are_read_and_shown_by_their_names_and_held_to_their_bounds() {
    let text = source(
        &MODES.replace("input n : INT", "input n : INT\nvar kept : Mode retain\nvar k : INT(0..9) retain"),
    );
    let bench = bench(&text);
    let mode = item(&bench, "mode");
    for (text, wanted) in [("Automatic", 2), (" Mode.Manual ", 1), ("0", 0)] {
        assert_eq!(mode.read(text), Ok(Value::Word(wanted)), "{text}");
    }
    let names = mode.read("Setup").expect_err("no such value");
    assert_eq!(names.as_str(), "`mode` is one of Off, Manual, Automatic");
    mode.read("3").expect_err("no value has this number");
    assert_eq!((mode.show(&Value::Word(2)), mode.show(&Value::Word(3))), ("Automatic".into(), "3".into()));
    let p = item(&bench, "p");
    assert_eq!(p.read("100"), Ok(Value::Word(100)));
    assert_eq!(p.read("101").expect_err("too large").as_str(), "`101` is outside 0 .. 100");
    p.read("-1").expect_err("too small");
    p.read("x").expect_err("no number");
    assert_eq!((p.declared(), mode.declared()), ("INT(0..100)".to_owned(), "Mode".to_owned()));
    let retained = |name| item(&bench, name).retain.clone().unwrap_or_default();
    assert_eq!(retained("kept"), "Mode(Off=0,Manual=1,Automatic=2)");
    assert_eq!(retained("k"), "INT(0..9)");
}
