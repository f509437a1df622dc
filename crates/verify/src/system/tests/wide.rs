//! Three searches must give the same verdicts, and runs of the same length: the search with the engine, the search of
//! the system state by state, and the search of the system by sets.
//!
//! `G7_CHARTS` is the least number of random charts a profile, `G7_SEED` the first.

use std::collections::BTreeSet;

use g7_model::ProfileName;
use g7_tests::generate::sample;

use super::random::{number, with_questions};
use super::{asked, parsed};
use crate::ask::Asked;
use crate::explicit::answer;
use crate::layer::Budget;
use crate::model::Model;
use crate::sat::diagram::{Effort, diagram};
use crate::sat::wide::Wide;
use crate::sat::{Ends, Found, Signal, Wanted, wide};
use crate::system::{Observed, Translated, system};
use crate::verdict::{Evidence, Verdict};

/// Answers on which both agree: runs, and proofs.
#[derive(Debug, Default)]
struct Agreed {
    runs: usize,
    proofs: usize,
    open: usize,
    /// Signals that both searches of the system have decided.
    sets: usize,
}

impl Agreed {
    /// Says if so much agrees that the searches did not only leave things open.
    fn enough(&self) -> bool {
        self.runs > 20 && self.runs + self.proofs > 40 && self.sets > 40
    }
}

/// Checks that the search by sets decides each signal as the search state by state does. Returns the number of
/// signals that both have decided.
fn sets_agree(t: &Translated, signals: &[Signal], seen: &Wide, text: &str) -> usize {
    let budget = Budget { states: 0, scans: 0, bytes: 64 << 20, stop: &|| false };
    let effort = Effort { nodes: 1 << 16, ticks: 1 << 16 };
    let wanted = Wanted::of(signals, &t.passes, 1);
    let Some(sets) = diagram(&t.system, &wanted, &t.candidates, effort, &budget) else { return 0 };
    let steps = |found: &Found| match found {
        Found::Reached(trace) => Some(Some(trace.inputs.len())),
        Found::Never(_) => Some(None),
        Found::Open(_) => None,
    };
    let pairs = seen.found.iter().zip(&sets.found).map(|(a, b)| (steps(a), steps(b)));
    let both: Vec<_> = pairs.filter(|(a, b)| a.is_some() && b.is_some()).collect();
    assert!(both.iter().all(|(a, b)| a == b), "{both:?}\n{text}");
    // A search that has shown all signals stops early and does not know the ends.
    if seen.ends != Ends::Open && sets.ends != Ends::Open {
        assert_eq!(seen.ends, sets.ends, "{text}");
    }
    both.len()
}

/// The answers of one search as they can be compared: the scans of a run, or none for a proof.
fn of_engine(verdict: &Verdict) -> Option<Option<usize>> {
    match verdict {
        Verdict::Proved(Evidence::Run(r)) | Verdict::Refuted(Evidence::Run(r)) => Some(Some(r.moves.len())),
        Verdict::Proved(_) | Verdict::Refuted(_) => Some(None),
        Verdict::Open(_) => None,
    }
}

fn compare(asked: &Asked, text: &str, agreed: &mut Agreed) {
    let model = Model::new(&asked.compiled, asked.assume.clone());
    let budget = Budget { states: 20_000, scans: 20_000, bytes: 64 << 20, stop: &|| false };
    let mut answers = vec![None; asked.questions.len()];
    answer(&model, &asked.questions, &mut answers, &budget, 1);
    let t = system(&model, &asked.questions, Observed::Asked);
    let signals = t.asked.iter().flat_map(|a| a.iter().flat_map(|a| [a.bad, a.unsure]));
    let signals: Vec<Signal> = signals.collect::<BTreeSet<_>>().into_iter().collect();
    let threads = 1 + asked.questions.len() % 2;
    let Some(seen) = wide(&t.system, &Wanted::of(&signals, &t.passes, threads), &budget) else {
        return;
    };
    agreed.sets += sets_agree(&t, &signals, &seen, text);
    let found = |s: Signal| signals.binary_search(&s).ok().and_then(|at| seen.found.get(at));
    for ((question, signals), (follows, verdict)) in
        asked.questions.iter().zip(&t.asked).zip(t.follows.iter().zip(&answers))
    {
        // A claim about all that can follow has a signal with another meaning.
        let (Ok(signals), None, Some(verdict)) = (signals, follows, verdict) else { continue };
        let Some(engine) = of_engine(verdict) else { continue };
        let mine = match (found(signals.bad), found(signals.unsure)) {
            // A scan with more passes than the system unrolls may end in it: then a shorter run can be there.
            (Some(Found::Reached(trace)), Some(Found::Reached(before)))
                if before.inputs.len() < trace.inputs.len() =>
            {
                agreed.open += 1;
                continue;
            }
            (Some(Found::Reached(trace)), _) if t.limits(&[signals.bad]).is_empty() => {
                Some(trace.inputs.len())
            }
            (Some(Found::Never(_)), Some(Found::Never(_))) if seen.ends == Ends::None => None,
            _ => {
                agreed.open += 1;
                continue;
            }
        };
        assert_eq!(mine, engine, "{:?}: {verdict:?}\n{text}", question.claim);
        if mine.is_some() {
            agreed.runs += 1;
        } else {
            agreed.proofs += 1;
        }
    }
}

/// Random charts are made until enough answers of all three kinds have been compared. One chart gives between none
/// and fifty.
#[test]
fn both_searches_agree() {
    let (charts, first) = (number("G7_CHARTS", 4), number("G7_SEED", 1));
    for profile in ProfileName::ALL {
        let mut agreed = Agreed::default();
        for seed in first..first + 6 * charts {
            if seed >= first + charts && agreed.enough() {
                break;
            }
            let sample = sample(seed, profile, 1).expect("a random chart can be read");
            let text = with_questions(&sample.text, seed);
            if let Some(asked) = asked(&parsed(&text), None) {
                compare(&asked, &text, &mut agreed);
            }
        }
        println!("{}: {agreed:?}", profile.name());
        assert!(charts < 4 || agreed.enough(), "{}: {agreed:?}", profile.name());
    }
}

/// Numbers, a count with an assumption that couples inputs, a comparison of an analogue input with a constant.
#[test]
fn charts_with_numbers_agree() {
    for profile in ProfileName::ALL {
        let mut agreed = Agreed::default();
        for text in [
            "input a, b : BOOL\nvar n : INT\nchart G { initial step 1 step 2 { P1 n := (n + 3) mod 50 } 1 -> 2 when a \
             2 -> 1 when b }\nassume not (a and b)\nprove always n < 50\nprove never n = 49\nprove reachable n = 1\n",
            "input level : INT\noutput q : BOOL\nchart G { initial step 1 step 2 { N q } 1 -> 2 when level > 1000 \
             2 -> 1 when level < 200 }\nprove after q until level < 200 expect q\nprove never q and level > 30000\n",
            "input a, b, c, d, e, f, g, h : BOOL\nchart G { initial step 1 step 2 step 3 \
             1 -> 2 when (a or b) and (c or d) and (e or f) and not (g and h) 2 -> 3 when a and h 3 -> 1 when not a }\n\
             assume not (a and (c or e or g)) and not (c and (e or g)) and not (e and g)\nprove never X3 and g\nprove never X2 and g\n",
        ] {
            let text = format!("profile {}\n{text}", profile.name());
            let (text, asked) = match asked(&parsed(&text), None) {
                Some(asked) => (text, asked),
                None => panic!("{text}"),
            };
            compare(&asked, &text, &mut agreed);
        }
        assert!(agreed.runs > 10 && agreed.proofs > 5, "{}: {agreed:?}", profile.name());
    }
}
