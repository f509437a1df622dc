//! Instances of function blocks with a chart, as OpenPLC and Beremiz write them.

use g7_iec::sfc::import;
use g7_model::{Document, FileId, Problem};

const BLOCK: &str = "
FUNCTION_BLOCK Feeder
  VAR_INPUT start : BOOL; END_VAR
  VAR_OUTPUT turning : BOOL; END_VAR
  INITIAL_STEP Rest: END_STEP
  STEP Run: turning(N); END_STEP
  TRANSITION FROM Rest TO Run := start; END_TRANSITION
  TRANSITION FROM Run TO Rest := NOT start; END_TRANSITION
END_FUNCTION_BLOCK
";

fn program(body: &str) -> (Document, Vec<Problem>) {
    let text = format!(
        "{BLOCK}PROGRAM Main
           VAR go AT %IX0.0 : BOOL; lamp AT %QX0.0 : BOOL; both : BOOL; fb0, fb1 : Feeder; END_VAR
           {body}
         END_PROGRAM"
    );
    import(text.as_bytes(), FileId(0))
}

fn told(problems: &[Problem]) -> Vec<(&str, &str)> {
    problems.iter().map(|p| (p.code.id, &*p.what)).collect()
}

#[test]
fn each_instance_is_a_chart_of_its_own() {
    let (found, problems) =
        program("fb0(start := go, turning => lamp); FB1(NOT go); both := lamp AND Fb1.Turning;");
    assert_eq!(told(&problems), []);
    let chart = |name: &str| {
        format!(
            "chart {name} {{
               var start : BOOL
               var turning : BOOL
               initial step Rest
               step Run {{ N turning }}
               Rest -> Run when start
               Run -> Rest when not start
             }}"
        )
    };
    let wanted = format!(
        "profile iec61131
         input go : BOOL at %IX0.0
         output lamp : BOOL at %QX0.0
         var both : BOOL
         pre {{ fb0.start := go  fb1.start := not go }}
         post {{ lamp := fb0.turning  both := lamp and fb1.turning }}
         {}
         {}",
        chart("fb0"),
        chart("fb1")
    );
    let (wanted, wrong) = g7_syntax::parse(&wanted, FileId(0));
    assert_eq!(wrong, []);
    assert_eq!(g7_syntax::print(&found, None), g7_syntax::print(&wanted, None));
    let (compiled, problems) = g7_compile::compile(&found);
    assert!(compiled.is_some(), "{problems:?}");
}

#[test]
fn calls_that_run_otherwise_are_told() {
    let cases: [(&str, &str, &str); 8] = [
        ("IF go THEN fb0(start := go); END_IF; fb1();", "G0614", "called on a condition"),
        ("IF go THEN fb0(); END_IF; fb0(); fb1();", "G0604", "called twice"),
        ("WHILE go DO fb0(); go := FALSE; END_WHILE; fb1();", "G0604", "called twice"),
        ("fb0(start := go); fb0(start := go); fb1();", "G0604", "called twice"),
        ("fb0(start := go);", "G0605", "`fb1` is never called"),
        ("fb0(go); fb1(start := fb0.turning);", "G0614", "of the scan before"),
        ("fb0(start := go, turning => lamp); fb1(start := lamp);", "G0614", "of the scan before"),
        ("IF go THEN RETURN; END_IF; fb0(); fb1();", "G0604", "RETURN in a program that calls a chart"),
    ];
    for (body, code, what) in cases {
        let (found, problems) = program(body);
        let told = told(&problems);
        assert!(told.iter().any(|t| t.0 == code && t.1.contains(what)), "{body}: {told:?}");
        assert!(found.charts().count() >= 1, "{body}");
    }
    let (_, problems) = program("fb0(stop := go); fb1();");
    assert_eq!(told(&problems), [("G0607", "the function block of `fb0` has no input `stop`")]);
}

#[test]
fn a_chart_that_is_called_on_a_condition_waits() {
    let (found, _) =
        program("IF go THEN fb0(start := both, turning => lamp); ELSE fb0(FALSE); END_IF; fb1();");
    let text = g7_syntax::print(&found, None);
    for part in [
        "fb0.Called := FALSE",
        "fb0.start := both\n    fb0.Called := TRUE",
        "if fb0.Called then",
        "Rest -> Run when Called and start",
    ] {
        assert!(text.to_lowercase().contains(&part.to_lowercase()), "{part} in {text}");
    }
    let (compiled, problems) = g7_compile::compile(&found);
    assert!(compiled.is_some(), "{problems:?}");
    assert!(!text.contains("fb1.Called"), "{text}");
}

#[test]
fn a_global_instance_belongs_to_the_program_that_uses_it() {
    let text = format!(
        "{BLOCK}PROGRAM Main VAR_EXTERNAL fb : Feeder; go : BOOL; END_VAR fb(start := go); END_PROGRAM
         CONFIGURATION c VAR_GLOBAL fb : Feeder; go : BOOL; END_VAR RESOURCE r ON PLC
         TASK t(INTERVAL := T#10ms, PRIORITY := 0); PROGRAM i WITH t : Main; END_RESOURCE END_CONFIGURATION"
    );
    let (found, problems) = import(text.as_bytes(), FileId(0));
    assert_eq!(told(&problems), []);
    assert!(g7_syntax::print(&found, None).contains("chart fb {"), "{}", g7_syntax::print(&found, None));
}

#[test]
fn resources_have_tasks_and_variables_of_their_own() {
    let text = "
        PROGRAM A VAR_EXTERNAL x, g : INT; END_VAR x := x + g; END_PROGRAM
        PROGRAM B VAR_EXTERNAL X : INT; END_VAR VAR g : INT; END_VAR g := x + 1; X := g; END_PROGRAM
        CONFIGURATION c
          VAR_GLOBAL g : INT := 3; END_VAR
          RESOURCE r1 ON PLC
            VAR_GLOBAL x : INT; END_VAR
            TASK t(INTERVAL := T#10ms, PRIORITY := 0);
            PROGRAM pa WITH T : A;
          END_RESOURCE
          RESOURCE r2 ON PLC
            VAR_GLOBAL x : INT := 7; g : INT; END_VAR
            TASK t(INTERVAL := T#20ms, PRIORITY := 0);
            PROGRAM pb WITH t : B;
          END_RESOURCE
        END_CONFIGURATION";
    let (found, problems) = import(text.as_bytes(), FileId(0));
    let what = "the programs of all resources run in one controller here, one behind the other";
    assert_eq!(told(&problems), [("G0614", what)]);
    let wanted = "profile iec61131
        scan 10ms
        var g : INT := 3  var x : INT  var r2_x : INT := 7  var r2_g : INT
        pre { x := x + g }
        chart B every 20ms { var g : INT  pre { g := r2_x + 1  r2_x := g } }";
    let (wanted, wrong) = g7_syntax::parse(wanted, FileId(0));
    assert_eq!(wrong, []);
    assert_eq!(g7_syntax::print(&found, None), g7_syntax::print(&wanted, None));
    let block = "FUNCTION_BLOCK f VAR_EXTERNAL x : INT; END_VAR x := 1; END_FUNCTION_BLOCK PROGRAM C VAR b : f; END_VAR b(); END_PROGRAM";
    let (_, problems) = import(format!("{block}{text}").as_bytes(), FileId(0));
    let what = "`x` is a variable of several resources; a function block can name one of them alone";
    assert!(told(&problems).contains(&("G0604", what)), "{:?}", told(&problems));
}
