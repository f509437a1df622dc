//! The samples run: what each scan makes of a situation, from the rules of evolution.

use g7_runtime::faults::{FAULT_INPUTS, FAULT_NONE, FAULT_STOPPED, FAULT_UNSTABLE};
use g7_runtime::sample::{lamp, press, tank, turns};

const MS: i64 = 1_000_000;

#[test]
fn a_tank_is_filled() {
    use tank::chart::{FILL, IDLE, Inputs, Outputs};
    let (mut s, mut out) = (tank::State::default(), Outputs::default());
    let mut scan = |start: bool, full: bool, ms: i64| {
        let fault = tank::scan(&Inputs { start, full }, &mut out, &mut s, ms * MS);
        assert_eq!(fault, FAULT_NONE);
        (tank::is_active(&s, IDLE), tank::is_active(&s, FILL), out.valve, tank::step_time(&s, FILL))
    };
    assert_eq!(scan(false, false, 0), (true, false, false, 0), "rule 1: the initial situation");
    assert_eq!(scan(true, false, 10), (false, true, true, 0), "rule 3: the clearing");
    assert_eq!(scan(true, false, 30), (false, true, true, 20 * MS), "the time since its activation");
    assert_eq!(scan(false, true, 40), (true, false, false, 0), "and back");
}

#[test]
fn a_scan_in_place_takes_and_leaves_what_stands_in_the_state() {
    use tank::chart::{IDLE, Inputs, Outputs};
    let mut s = tank::State::default();
    s.inputs.start = true;
    assert_eq!(tank::scan_in_place(&mut s, 0), FAULT_NONE);
    assert!(s.outputs.valve && !tank::is_active(&s, IDLE));
    s.inputs = Inputs { start: true, full: true };
    assert_eq!(tank::scan_in_place(&mut s, MS), FAULT_UNSTABLE);
    assert_eq!(s.outputs, Outputs { valve: false }, "the safe value");
    let mut out = Outputs { valve: true };
    assert_eq!(tank::scan(&Inputs::default(), &mut out, &mut s, 2 * MS), FAULT_STOPPED);
    assert_eq!(s.inputs, Inputs { start: true, full: true }, "a scan that is not made takes no inputs");
    assert!(!out.valve);
}

#[test]
fn a_lamp_goes_out_by_itself() {
    use lamp::chart::{Inputs, OFF, ON, Outputs};
    let (mut s, mut out) = (lamp::State::default(), Outputs::default());
    let mut scan = |press: bool, ms: i64| {
        assert_eq!(lamp::scan(&Inputs { press }, &mut out, &mut s, ms * MS), FAULT_NONE);
        (lamp::is_active(&s, OFF), lamp::is_active(&s, ON), out.lamp, lamp::step_time(&s, ON))
    };
    assert_eq!(scan(false, 7), (true, false, false, 0), "rule 1: the initial situation");
    assert_eq!(scan(true, 10), (false, true, true, 0), "rule 3: the clearing");
    assert_eq!(scan(false, 2009), (false, true, true, 1999 * MS), "the time since its activation");
    assert_eq!(scan(false, 2010), (true, false, false, 0), "and back");
    let mut s = lamp::State::default();
    let mut out = Outputs::default();
    assert_eq!(lamp::scan(&Inputs { press: true }, &mut out, &mut s, 5), FAULT_NONE);
    assert_eq!(lamp::scan(&Inputs { press: true }, &mut out, &mut s, 4), FAULT_INPUTS, "time goes back");
    assert!(!out.lamp, "the safe value");
    assert_eq!(lamp::scan(&Inputs { press: true }, &mut out, &mut s, 6), FAULT_STOPPED);
    assert!(!lamp::is_active(&s, 2) && lamp::step_time(&s, 2) == 0, "no such step");
}

#[test]
fn an_unstable_chart_ends_in_a_fault() {
    use tank::chart::{Inputs, Outputs};
    let (mut s, mut out) = (tank::State::default(), Outputs::default());
    let both = Inputs { start: true, full: true };
    let fault = tank::scan(&both, &mut out, &mut s, 0);
    assert_eq!(fault, FAULT_UNSTABLE, "Idle and Fill follow one another for ever");
    assert_eq!(tank::scan(&both, &mut out, &mut s, MS), FAULT_STOPPED);
    let mut s = tank::State::default();
    assert_eq!(tank::scan(&Inputs::default(), &mut out, &mut s, 5), FAULT_NONE);
    assert_eq!(tank::scan(&Inputs::default(), &mut out, &mut s, 4), FAULT_INPUTS, "time goes back");
}

/// The press with its inputs, scan by scan.
struct Press {
    s: press::State,
    out: press::chart::Outputs,
    input: press::chart::Inputs,
}

impl Press {
    fn new() -> Press {
        Press {
            s: press::State::default(),
            out: press::chart::Outputs::default(),
            input: press::chart::Inputs::default(),
        }
    }

    /// The names of the active steps after a scan.
    fn scan(&mut self, ms: i64) -> String {
        assert_eq!(press::scan(&self.input, &mut self.out, &mut self.s, ms * MS), FAULT_NONE);
        let names = ["1", "2", "10", "11", "12", "20", "30", "31", "32"];
        let active: Vec<&str> = names
            .iter()
            .enumerate()
            .filter(|(i, _)| press::is_active(&self.s, *i))
            .map(|(_, n)| *n)
            .collect();
        active.join(" ")
    }
}

#[test]
fn an_enclosing_step_brings_its_chart_and_takes_it() {
    let mut p = Press::new();
    p.input.on = true;
    assert_eq!(p.scan(0), "1 10");
    p.input.part = true;
    assert_eq!(p.scan(10), "1 11 30", "the step with the activation link comes with its enclosing step");
    assert!(p.out.clamp, "S on activation");
    assert!(p.out.drive, "N of the enclosed step");
    p.input.far = true;
    assert_eq!(p.scan(20), "1 11 31");
    assert_eq!(p.s.v.pieces, 1, "the action on event of step 30, which was active as the edge came");
    assert!(!p.out.drive);
    assert!(p.out.horn, "P for one scan");
    p.input.far = false;
    assert_eq!(p.scan(30), "1 12", "32 is reached within the search, and with 11 its chart ends");
    assert!(!p.out.clamp, "R on activation of 12");
    assert!(!p.out.horn);
    assert_eq!(p.scan(1_030), "1 12");
    assert_eq!(p.scan(2_030), "1 10", "2 s after 12 came");
}

#[test]
fn a_period_holds_its_chart_still() {
    let mut p = Press::new();
    p.input.on = true;
    p.scan(0);
    p.input.part = true;
    p.scan(10);
    p.input.far = true;
    assert_eq!(p.scan(14), "1 11 30", "the chart Stroke evolves every 10 ms");
    assert_eq!(p.scan(20), "1 11 31");
}

#[test]
fn a_delayed_action_waits_for_its_time() {
    let mut p = Press::new();
    p.input.on = true;
    p.scan(0);
    p.input.part = true;
    p.scan(10);
    p.scan(500);
    assert!(!p.out.horn, "D 500ms, 490 ms after step 30 came");
    p.scan(510);
    assert!(p.out.horn, "500 ms after");
}

#[test]
fn a_forcing_order_holds_the_situation() {
    let mut p = Press::new();
    p.input.on = true;
    p.scan(0);
    p.input.part = true;
    assert_eq!(p.scan(10), "1 11 30");
    p.input.stop = true;
    assert_eq!(
        p.scan(20),
        "2 20",
        "the situation {{20}} is imposed on Work; the enclosed chart ends with 11"
    );
    assert!(p.out.lamp);
    assert!(!p.out.drive);
    assert_eq!(p.scan(30), "2 20", "and held, although 20 -> 10 could clear");
    p.input.stop = false;
    p.scan(40);
    assert_eq!(p.scan(50), "1 10");
}

#[test]
fn transitions_clear_in_turn() {
    use turns::chart::{Inputs, Outputs};
    let (mut s, mut out) = (turns::State::default(), Outputs::default());
    let mut input = Inputs::default();
    let mut scan = |input: &Inputs, now: i64| {
        assert_eq!(turns::scan(input, &mut out, &mut s, now), FAULT_NONE);
        let active: Vec<usize> = (1..5).filter(|i| turns::is_active(&s, i - 1)).collect();
        (active, s.v.entered, s.v.left)
    };
    assert_eq!(scan(&input, 0), (vec![1], 0, 0));
    input.go = true;
    input.first = true;
    assert_eq!(scan(&input, 1), (vec![2], 1, 0), "of two that share a step, the better priority");
    input.fork = true;
    assert_eq!(scan(&input, 2), (vec![3, 4], 1, 1), "a fork; P0 as step 2 goes");
    input.fork = false;
    assert_eq!(scan(&input, 3), (vec![1], 1, 1), "a join; 4 -> 2 shares step 4 with it and stands behind it");
    input.go = false;
    assert_eq!(scan(&input, 4), (vec![1], 1, 1));
}
