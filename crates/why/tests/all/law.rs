//! The laws of answers: a cause is true at its time and not later than its effect, and what is followed ends
//! at an input, a time, the start or what came from outside.

use g7_compile::{Compiled, compile};
use g7_engine::{Addr, GroupId, Receptivity, State, StepId, begin, pass};
use g7_host::{Runner, Tape};
use g7_model::{Nanos, ProfileName};
use g7_tests::generate::sample;
use g7_why::{Cause, Fact, Question, Why};

/// Number of charts for each profile.
const CHARTS: u64 = 40;
/// Number of scans of each chart.
const SCANS: usize = 40;

/// The state behind a scan.
struct Left {
    now: Nanos,
    /// The variables behind its beginning, in which PRE runs, and behind its passes: later parts may write them again.
    parts: Vec<Vec<u64>>,
    words: Vec<u64>,
    active: Vec<StepId>,
    cleared: Vec<u32>,
    /// It made more passes than one that changes and one that does not: values may have come and gone within it.
    passes: u32,
}

struct Run {
    tape: Tape,
    scans: Vec<Left>,
}

/// The variables behind each part of a scan but the last one.
fn parts(c: &Compiled, mut state: State, inputs: &[u64], now: Nanos) -> Vec<Vec<u64>> {
    let mut parts = Vec::new();
    let mut more = begin(&c.program, &mut state, inputs, now.count()).is_ok();
    while more && parts.len() < 70 {
        parts.push(state.words().to_vec());
        more = pass(&c.program, &mut state) == Ok(true) && c.program.tables().rules.stable;
    }
    parts.push(state.words().to_vec());
    parts
}

fn run(c: &Compiled, seed: u64) -> Run {
    let rows = c.program.tables().inputs;
    let period = Nanos::from_millis(100);
    let flags = c.symbols.s0.zip(c.symbols.s1);
    let mut runner = Runner::new(c.program.clone(), period).with_flags(flags).with_tape();
    let mut chance = seed;
    let mut next = || {
        chance = chance.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(99);
        chance >> 33
    };
    let mut scans = Vec::new();
    for _ in 0..SCANS {
        for index in 0..rows.end - rows.start {
            if next() % 3 == 0 {
                runner.set_input(index, next() & 1);
            }
        }
        let inputs: Vec<u64> = (0..rows.end - rows.start).map(|index| runner.input(index)).collect();
        let parts = parts(c, runner.state().clone(), &inputs, runner.due());
        let done = runner.scan();
        let s = runner.state();
        scans.push(Left {
            now: Nanos::new(s.now()),
            parts,
            words: s.words().to_vec(),
            active: s.active().collect(),
            cleared: s.cleared().to_vec(),
            passes: done.map_or(9, |r| r.passes),
        });
        if done.is_err() {
            break;
        }
    }
    Run { tape: runner.tape().cloned().expect("it has a tape"), scans }
}

/// Says why a sentence is not true of the run, if it is not.
fn wrong(c: &Compiled, run: &Run, cause: &Cause) -> Option<String> {
    let Some(at) = run.scans.iter().position(|s| s.now == cause.now) else {
        return Some("there is no scan at its time".to_owned());
    };
    let left = &run.scans[at];
    let active = |step: StepId| left.active.contains(&step);
    let in_group = |group: GroupId| {
        let rows = c.program.tables().groups[group.0 as usize].steps;
        (rows.start..rows.end).any(|s| active(StepId(s)))
    };
    // Within a scan of several passes a value can come and go; in the first scan the initial situation comes before
    // the passes.
    let passing = left.passes > 2 || at == 0;
    let word = |addr: Addr| left.words[addr.0 as usize];
    let is_so = match cause.fact {
        Fact::Input(addr, value) => {
            let before = at.checked_sub(1).map_or(0, |b| run.scans[b].words[addr.0 as usize]);
            word(addr) == value && before != value
        }
        Fact::Word(addr, value) => {
            word(addr) == value || left.parts.iter().any(|words| words[addr.0 as usize] == value)
        }
        Fact::Step(step, on) => active(step) == on || passing,
        Fact::Group(group, on) => in_group(group) == on || passing,
        Fact::Cleared(rank) => left.cleared.contains(&rank) || passing,
        Fact::Waits(rank) => !left.cleared.contains(&rank) || passing,
        _ => true,
    };
    (!is_so).then(|| "it is not so".to_owned())
}

/// True if a value that a cause names stands up to the scan of its effect: it was the last change before that.
fn stands(run: &Run, cause: &Cause, until: Nanos) -> bool {
    let mut between = run.scans.iter().filter(|s| cause.now <= s.now && s.now < until);
    between.all(|s| match cause.fact {
        Fact::Input(addr, value) | Fact::Word(addr, value) => s.words[addr.0 as usize] == value,
        Fact::Step(step, on) => s.active.contains(&step) == on,
        _ => true,
    })
}

#[derive(Default, Debug)]
struct Ends {
    all: usize,
    bounds: usize,
    code: usize,
}

fn check(c: &Compiled, run: &Run, cause: &Cause, ends: &mut Ends) -> Result<(), String> {
    let told =
        |why: &str, cause: &Cause| format!("{why}: {} ({:?} at {})", cause.said, cause.fact, cause.now);
    if let Some(why) = wrong(c, run, cause) {
        return Err(told(&why, cause));
    }
    for behind in &cause.causes {
        if behind.now > cause.now {
            return Err(told("later than its effect", behind));
        }
        if !stands(run, behind, cause.now) {
            return Err(told("it changed again before its effect", behind));
        }
        check(c, run, behind, ends)?;
    }
    let followed = cause.causes.iter().any(|b| !b.aside);
    if cause.aside || followed {
        return Ok(());
    }
    ends.all += 1;
    match cause.fact {
        Fact::Input(..) | Fact::Start | Fact::Time | Fact::Outside | Fact::Fault | Fact::Scan => Ok(()),
        Fact::Bound => {
            ends.bounds += 1;
            Ok(())
        }
        // A chain may end at code that runs in each scan, such as a counter, or at an order of the system or of a chart above.
        Fact::Code | Fact::Order | Fact::Waits(_) => {
            ends.code += 1;
            Ok(())
        }
        Fact::Part(false) => Ok(()),
        // A sentence that was told before is an aside; so nothing lies behind it but asides.
        Fact::Cleared(_) | Fact::Part(true) | Fact::Step(..) | Fact::Group(..) | Fact::Word(..)
            if !cause.causes.is_empty() =>
        {
            Ok(())
        }
        Fact::Cleared(rank) if is_free(c, rank) => Ok(()),
        _ => Err(told("nothing lies behind it", cause)),
    }
}

/// True for a transition that clears without a reason but its steps, or none: its receptivity is always TRUE.
fn is_free(c: &Compiled, rank: u32) -> bool {
    c.program.tables().transitions[rank as usize].receptivity == Receptivity::True
}

/// An answer as text, with its facts.
fn shown(cause: &Cause) -> String {
    let line = |(depth, c): (usize, &Cause)| format!("{}{} {:?}", "  ".repeat(depth), c.said, c.fact);
    cause.lines().into_iter().map(line).collect::<Vec<_>>().join("\n")
}

/// Most wrong answers that are told.
const WRONG: usize = 6;

/// Asks about each change of an output; returns the number of changes, and tells the answers that are wrong.
fn changes_of_outputs(profile: ProfileName, ends: &mut Ends, wrong: &mut Vec<String>) -> usize {
    let mut asked = 0;
    for seed in 1..=CHARTS {
        let sample = sample(seed, profile, 1).expect("a random chart can be read");
        let (Some(c), _) = compile(&sample.document) else { continue };
        let run = run(&c, seed);
        let why = Why::new(&c, &run.tape).expect("the run comes again");
        let outputs = c.program.tables().outputs;
        for (at, left) in run.scans.iter().enumerate() {
            for addr in (outputs.start..outputs.end).map(Addr) {
                let first = c.program.tables().init[addr.0 as usize];
                let before = at.checked_sub(1).map_or(first, |b| run.scans[b].words[addr.0 as usize]);
                let value = left.words[addr.0 as usize];
                if before == value {
                    continue;
                }
                asked += 1;
                let cause = why.ask(Question::Variable(addr, 1), left.now).expect("there is a scan");
                let is_it = cause.fact == Fact::Word(addr, value) && cause.now == left.now;
                let judged =
                    if is_it { check(&c, &run, &cause, ends) } else { Err("another change".to_owned()) };
                if let Err(what) = judged {
                    let at = format!("{} seed {seed} at {}", profile.name(), left.now);
                    wrong.push(format!("{at}: {what}\n{}\n{}", shown(&cause), sample.text));
                }
            }
        }
    }
    asked
}

fn none(wrong: &[String]) {
    let first: Vec<&str> = wrong.iter().take(WRONG).map(String::as_str).collect();
    assert!(wrong.is_empty(), "{} wrong answers:\n{}", wrong.len(), first.join("\n\n"));
}

#[test]
fn causes_are_true_and_not_later_than_their_effects_and_chains_end() {
    let (mut ends, mut wrong) = (Ends::default(), Vec::new());
    for profile in ProfileName::ALL {
        let asked = changes_of_outputs(profile, &mut ends, &mut wrong);
        assert!(asked > 200, "{}: only {asked} changes of outputs", profile.name());
    }
    none(&wrong);
    assert!(ends.bounds * 100 < ends.all, "too many bounds: {ends:?}");
    assert!(ends.code * 2 < ends.all, "too often only code is known: {ends:?}");
}

#[test]
fn every_question_about_every_scan_has_an_answer_that_is_true() {
    let mut wrong = Vec::new();
    for profile in ProfileName::ALL {
        for seed in 1..=CHARTS / 4 {
            let sample = sample(seed, profile, 1).expect("a random chart can be read");
            let (Some(c), _) = compile(&sample.document) else { continue };
            let run = run(&c, seed);
            let why = Why::new(&c, &run.tape).expect("the run comes again");
            let t = c.program.tables();
            let mut questions = vec![Question::Scan];
            questions.extend((0..t.steps.len() as u32).map(|s| Question::Step(StepId(s))));
            questions.extend((0..t.groups.len() as u32).map(|g| Question::Group(GroupId(g))));
            questions.extend((0..t.transitions.len() as u32).map(Question::Transition));
            questions.extend(c.symbols.variables.iter().map(|v| Question::Variable(v.addr, v.words())));
            for left in run.scans.iter().step_by(7) {
                for question in &questions {
                    let cause = why.ask(*question, left.now).expect("there is a scan");
                    if let Err(what) = check(&c, &run, &cause, &mut Ends::default()) {
                        let at = format!("{} seed {seed} {question:?} at {}", profile.name(), left.now);
                        wrong.push(format!("{at}: {what}\n{}\n{}", shown(&cause), sample.text));
                    }
                }
            }
        }
    }
    none(&wrong);
}
