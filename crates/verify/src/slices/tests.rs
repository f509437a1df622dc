//! A slice sees what the whole chart sees: random charts of each profile, and charts whose answers follow from
//! the rules and that a slice of too little would answer in another way.
//!
//! `G7_CHARTS` is the number of random charts of a profile, `G7_SEED` the first one.

use g7_engine::StepId;
use g7_model::ProfileName;
use g7_tests::generate::sample;

use super::{Cut, Sliced, Whole};
use crate::answer::answer;
use crate::ask::Asked;
use crate::explicit::Explicit;
use crate::faults::Faults;
use crate::layer::{Budget, Layer};
use crate::model::Model;
use crate::question::Claim;
use crate::reason::Reason;
use crate::verdict::{Evidence, Verdict};
use crate::zones::Zones;
use crate::zones::tests::{PROFILES, answers, asked, length, letter, number, with_questions};

fn of(text: &str) -> Asked {
    asked(text, None).unwrap_or_else(|| panic!("{text}"))
}

/// The answers of the slices of a chart, which are those of the whole chart wherever both have one.
fn agree(text: &str, scans: usize) -> (usize, usize) {
    let Some(asked) = asked(text, None) else { return (0, 0) };
    let whole = answers(&asked, &Explicit, scans);
    let (mut both, mut more) = (0, 0);
    let layers: [&dyn Layer; 3] = [&Sliced(&[&Explicit]), &Sliced(&[&Zones]), &Faults(&[&Explicit])];
    for (kind, layer) in layers.iter().enumerate() {
        let sliced = answers(&asked, *layer, scans);
        for ((q, w), s) in asked.questions.iter().zip(&whole).zip(&sliced) {
            match (letter(w), letter(s)) {
                ('P' | 'R', 'P' | 'R') => {
                    assert_eq!(letter(w), letter(s), "{:?}: {w:?}\n{s:?}\n{text}", q.claim);
                    both += 1;
                    if let (Some(w), Some(s)) = (length(w), length(s)) {
                        // The run of a slice of all states is a shortest one; others may be longer.
                        assert!(if kind == 0 { w == s } else { w <= s }, "{:?}: {w} {s}\n{text}", q.claim);
                    }
                }
                (_, 'P' | 'R') => more += 1,
                _ => {}
            }
        }
    }
    (both, more)
}

fn random(profile: ProfileName) {
    let (first, charts) = (number("G7_SEED", 1), number("G7_CHARTS", 6));
    let (mut both, mut more) = (0, 0);
    for seed in first..first + charts {
        let sample = sample(seed, profile, 1).expect("a random chart can be read");
        let found = agree(&with_questions(&sample.text, seed), 10_000);
        (both, more) = (both + found.0, more + found.1);
    }
    println!("{}: {both} decided by both, {more} by slices alone", profile.name());
    assert!(both > 0);
}

#[test]
fn random_charts_of_iec60848() {
    random(ProfileName::Iec60848);
}

#[test]
fn random_charts_of_iec61131() {
    random(ProfileName::Iec61131);
}

#[test]
fn random_charts_of_pl7() {
    random(ProfileName::Pl7);
}

#[test]
fn random_charts_of_unity() {
    random(ProfileName::Unity);
}

#[test]
fn random_charts_of_jgrafchart() {
    random(ProfileName::Jgrafchart);
}

/// `n` is compared with 3 and 4 alone, `free` and `other` with nothing.
const COUNTERS: &str = "input a, b : BOOL\nvar n, free, other : INT\nchart G {\n  initial step 1\n  \
    step 2 { P1 n := n + 1\n P1 free := free + 1 }\n  step 3 { P1 n := 0\n P1 other := free }\n  step 4\n  \
    1 -> 2 when a and not b\n  2 -> 1 when not a and not b\n  1 -> 3 when b and n >= 3\n  3 -> 1 when not b and not a\n  \
    1 -> 4 when a and b and n = 4\n}\n\
    prove never n = 4 and X3\nprove reachable X1 and n = 3\n";

fn cuts(text: &str, claim: &Claim) -> Vec<Cut> {
    let asked = of(text);
    let model = Model::new(&asked.compiled, asked.assume.clone());
    let whole = Whole::new(&model).expect("it is small");
    whole.slice(claim).map_or(Vec::new(), |s| s.0.into_iter().map(|(_, cut)| cut).collect())
}

#[test]
fn a_counter_is_kept_up_to_one_more_than_what_it_is_compared_with() {
    for profile in PROFILES {
        let text = format!("profile {}\n{COUNTERS}", profile.name());
        let found = cuts(&text, &Claim::Active(StepId(0)));
        // `n = 4` tells 4 from 5.
        assert_eq!(found, [Cut::AtMost(5), Cut::Always(0), Cut::Always(0)], "{text}");
        let (both, _) = agree(&text, 50_000);
        assert!(both > 10, "{both} {text}");
    }
}

/// Each push adds one; nothing stops it, and nothing reads it.
#[test]
fn counters_that_nothing_reads_keep_no_question_from_its_answer() {
    for profile in PROFILES {
        let text = format!(
            "profile {}\ninput a : BOOL\nvar n, m : DINT\nchart G {{ initial step 1 step 2 {{ P1 n := n + 1\n P1 m := m + 2 }} \
             1 -> 2 when a 2 -> 1 when not a }}\n",
            profile.name()
        );
        let asked = of(&text);
        let sliced = answers(&asked, &Sliced(&[&Explicit]), 1_000);
        for (q, v) in asked.questions.iter().zip(&sliced) {
            // Under search for stability a counter that counts is a change, and two writers of it may be opposed.
            let is_sliced =
                !matches!(q.claim, Claim::NoFault | Claim::NoInstability | Claim::NoOpposedWrites);
            assert!(!is_sliced || letter(v) == 'P', "{:?} {v:?} {text}", q.claim);
        }
    }
}

/// The event writes 5. Once it has, it changes nothing any more, so there is no second pass, in which the edge
/// would be absent: then `a` holds at the end of a scan with step 1.
#[test]
fn a_pass_that_only_a_variable_causes_is_seen() {
    let text = "profile iec60848\ninput a : BOOL\nvar n : INT\nchart G {\n  initial step 1 { on ↑a: n := 5 }\n  step 2\n  \
                1 -> 2 when a and not ↑a\n  2 -> 1 when not a\n}\nprove never X1 and a\n";
    let asked = of(text);
    let own = asked.questions.iter().position(|q| matches!(q.claim, Claim::Never(_))).expect("it is asked");
    let found = answers(&asked, &Sliced(&[&Explicit]), 10_000);
    assert_eq!(letter(&answers(&asked, &Explicit, 10_000)[own]), 'R', "by the rule");
    assert!(matches!(letter(&found[own]), 'R' | '-'), "{:?}", found[own]);
    agree(text, 10_000);
}

/// The divisor is set before it is used. A slice that leaves it out divides by 0 where the chart does not.
#[test]
fn a_fault_of_a_slice_proves_nothing() {
    for profile in PROFILES {
        let text = format!(
            "profile {}\ninput a : BOOL\nvar y, z : INT\nchart G {{ initial step 1 step 2 {{ P1 y := 5 }} step 3 {{ P1 z := 10 / y }} step 4 \
             1 -> 2 when a 2 -> 3 when not a 3 -> 4 when a 4 -> 1 when not a }}\n",
            profile.name()
        );
        let asked = of(&text);
        let found = answers(&asked, &Sliced(&[&Explicit]), 10_000);
        for (q, v) in asked.questions.iter().zip(&found) {
            if matches!(q.claim, Claim::Active(_) | Claim::Clears(_)) {
                assert_ne!(letter(v), 'R', "{:?} {text}", q.claim);
            }
        }
        agree(&text, 10_000);
    }
}

/// A fault for each push but the first 127; the search of all states finds the same run.
#[test]
fn a_counter_without_a_bound_overflows_in_as_many_rounds_as_its_type_has() {
    for profile in PROFILES {
        let text = |ty: &str| {
            format!(
                "profile {}\ninput a : BOOL\nvar n : {ty}\nvar m : LINT\nchart G {{ initial step 1 step 2 {{ P1 n := n + 1\n P0 m := m + 1 }} \
                 1 -> 2 when a 2 -> 1 when not a }}\n",
                profile.name()
            )
        };
        let fault = |text: &str, layer: &dyn Layer| {
            let asked = of(text);
            let own = asked.questions.iter().position(|q| q.claim == Claim::NoFault).expect("it is asked");
            answers(&asked, layer, 20_000)[own].clone()
        };
        let short = fault(&text("SINT"), &Faults(&[&Explicit]));
        assert_eq!(
            (letter(&short), length(&short)),
            ('R', length(&fault(&text("SINT"), &Explicit))),
            "{short:?}"
        );
        let long = fault(&text("INT"), &Faults(&[&Explicit]));
        // A push and its end are two scans.
        assert!(length(&long).is_some_and(|n| (65_535..=65_537).contains(&n)), "{:?}", length(&long));
        // Two billion pushes are told of, and not made.
        let far = fault(&text("DINT"), &Faults(&[&Explicit]));
        assert!(matches!(&far, Some(Verdict::Open(o)) if matches!(o.reason, Reason::Counter(_))), "{far:?}");
    }
}

/// The reset comes in time: each place has no fault in its slice, so there is none.
#[test]
fn counters_with_bounds_have_no_fault() {
    for profile in PROFILES {
        let text = format!(
            "profile {}\ninput a, b : BOOL\nvar n, m : INT\nvar free : LINT\nchart G {{ initial step 1 step 2 {{ P1 n := n + 1 }} step 3 {{ P1 n := 0 }} \
             1 -> 2 when a and n < 9 2 -> 1 when not a 1 -> 3 when a and n >= 9 3 -> 1 when not a }}\n\
             chart H {{ initial step 11 step 12 {{ P1 m := (m + 1) mod 7 }} 11 -> 12 when b 12 -> 11 when not b }}\n",
            profile.name()
        );
        let asked = of(&text);
        let model = Model::new(&asked.compiled, asked.assume.clone());
        let own = asked.questions.iter().position(|q| q.claim == Claim::NoFault).expect("it is asked");
        let found = answers(&asked, &Faults(&[&Explicit]), 20_000);
        assert!(matches!(found[own], Some(Verdict::Proved(Evidence::Certificate(_)))), "{:?}", found[own]);
        let mut all = vec![None; asked.questions.len()];
        let budget = Budget { states: 100_000, scans: 100_000, bytes: 64 << 20, stop: &|| false };
        answer(&model, &asked.questions, &mut all, &budget);
        assert!(all.iter().all(|v| letter(v) != 'O'), "{text}");
    }
}
