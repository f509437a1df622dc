//! Code of a chart that does not end: whatever runs it, the controller is in fault and the outputs are safe.

use g7_model::Qualifier;
use g7_online::{Command, Mode, Raw, Reason};
use g7_peers::faults::row;

use crate::world::{IO, MS, Simulation};

const LOOP: &str = "WHILE TRUE DO spins := spins + 1 END_WHILE";

/// The chart of all cases: parts of it are filled in.
fn chart(step: &str, when: &str, more: &str) -> String {
    format!(
        "profile iec60848
input go : BOOL
input level : INT
input online : BOOL
output valve : BOOL safe FALSE
output lamp : BOOL safe TRUE
output count : INT safe -1
var spins : INT
{more}
chart Main {{
  initial step 1 {{ N valve }}
  step 2 {{ N valve  {step} }}
  step 3
  1 -> 2 when go
  2 -> 3 when {when}
}}
"
    )
}

/// The places where code of a chart runs: a name, and the chart with an endless loop there. It is reached
/// when the button is pressed.
fn places() -> Vec<(String, String)> {
    let endless = format!("{{ {LOOP} }}");
    let mut all = Vec::new();
    for qualifier in Qualifier::ALL {
        let time = if qualifier.timed() { "50ms" } else { "" };
        let name = qualifier.name();
        // R ends a stored action, and so has no code of its own.
        if qualifier != Qualifier::R {
            all.push((name.to_owned(), chart(&format!("{name} {time} {endless}"), "200ms/X2", "")));
            let action = format!("action Spin {endless}");
            all.push((
                format!("{name} of an action"),
                chart(&format!("{name} {time} Spin"), "200ms/X2", &action),
            ));
        }
    }
    let endless_if = format!("{{ IF go THEN {LOOP} END_IF }}");
    let function = format!(
        "function Spin(x : INT) : INT {{ {} Spin := x }}",
        LOOP.replace("spins := spins + 1", "Spin := x")
    );
    all.extend([
        ("each scan".to_owned(), chart(&format!("each scan: {endless}"), "FALSE", "")),
        ("on event".to_owned(), chart(&format!("on ↑(50ms/X2): {endless}"), "FALSE", "")),
        ("on clearing".to_owned(), chart("", &format!("100ms/X2 on clearing {endless}"), "")),
        ("PRE".to_owned(), chart("", "FALSE", &format!("pre {endless_if}"))),
        ("POST".to_owned(), chart("", "FALSE", &format!("post {endless_if}"))),
        ("receptivity".to_owned(), chart("", "Spin(1) > 0", &function)),
        ("condition".to_owned(), chart("N lamp if Spin(1) > 0", "FALSE", &function)),
        ("function".to_owned(), chart("P1 { spins := Spin(2) }", "FALSE", &function)),
    ]);
    all
}

#[test]
fn row_17_code_that_does_not_end_is_a_fault_wherever_it_stands() {
    let places = places();
    for (place, chart) in &places {
        let mut s = Simulation::new(chart, IO);
        s.command(Command::Run);
        s.pass(MS * 200);
        assert_eq!((s.machine.controller.mode(), s.outputs()[0]), (Mode::Run, Raw::Bit(true)), "{place}");
        s.set(|w| w.go = true);
        s.pass(MS * 500);
        let mode = s.machine.controller.mode();
        assert!(matches!(mode, Mode::Fault(Reason::Halt(_))), "{place}: {mode:?}");
        assert_eq!(s.outputs(), crate::safe(), "{place}");
        // It does so again after it was acknowledged, and in no other way.
        s.command(Command::Acknowledge);
        s.command(Command::Run);
        s.pass(MS * 500);
        assert_eq!(s.outputs(), crate::safe(), "{place}");
    }
    row(17, "endless, each place of code", places.len() as u64, 0, "fault and safe outputs each time");
}
