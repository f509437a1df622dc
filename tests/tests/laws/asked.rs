//! The inputs that the prover leaves out make no difference: with all inputs tried everywhere
//! it finds the same situations and outputs, scan for scan, and the same answers.

use std::collections::BTreeSet;

use g7_compile::ir::VarClass;
use g7_model::ProfileName;
use g7_tests::generate::sample;
use g7_verify::{Asked, Budget, Claim, Evidence, Model, Question, Tried, Verdict, ask, watch};

/// Random charts of each profile.
const CHARTS: u64 = 60;
/// Most combinations of inputs.
const WIDE: usize = 64;
/// Scans of a search that are looked at.
const SCANS: usize = 2500;
/// Most states of a search.
const STATES: usize = 400;

/// A situation with the outputs, and how many scans come before.
type Seen = BTreeSet<(usize, Vec<u32>, Vec<u64>)>;

/// The sights of a search over all runs, and how many of its levels are complete.
fn levels(asked: &Asked, model: &Model<'_>, tried: Tried) -> (Seen, usize) {
    let outputs: Vec<_> =
        asked.compiled.symbols.variables.iter().filter(|v| v.class == VarClass::Output).collect();
    let (mut scans, mut last) = (0, 0);
    let mut cut = None;
    let mut seen = Seen::new();
    let budget = Budget { states: STATES, scans: usize::MAX, bytes: 64 << 20, stop: &|| false };
    // A claim that every run keeps, so that the search goes on.
    let all = [Question { claim: Claim::AtMost(9, Vec::new()), at: Default::default() }];
    let answers = watch(model, &all, &budget, tried, &mut |level, s| {
        scans += 1;
        last = level;
        if scans > SCANS {
            cut.get_or_insert(level);
            return;
        }
        let words = outputs.iter().flat_map(|v| (0..v.words()).map(|k| s.words()[(v.addr.0 + k) as usize]));
        seen.insert((level, s.active().map(|s| s.0).collect(), words.collect()));
    });
    let full = matches!(answers.first(), Some((_, Verdict::Open(open))) if open.states > STATES);
    (seen, cut.unwrap_or(if full { last } else { usize::MAX }))
}

/// A word for each verdict, with the length of its run.
fn letters(verdicts: &mut [(usize, Verdict)]) -> Vec<String> {
    verdicts.sort_by_key(|(i, _)| *i);
    let one = |v: &Verdict| match v {
        Verdict::Proved(Evidence::Run(r)) => format!("proved {}", r.moves.len()),
        Verdict::Refuted(Evidence::Run(r)) => format!("refuted {}", r.moves.len()),
        Verdict::Proved(_) => "proved".to_owned(),
        Verdict::Refuted(_) => "refuted".to_owned(),
        Verdict::Open(_) => "open".to_owned(),
    };
    verdicts.iter().map(|(_, v)| one(v)).collect()
}

#[test]
fn inputs_that_are_left_out_make_no_difference() {
    let (mut compared, mut answered) = (0, 0);
    for profile in ProfileName::ALL {
        for seed in 1..=CHARTS {
            let sample = sample(seed, profile, 1).expect("a random chart can be read");
            let Some(asked) = ask(&sample.document, None).0 else { continue };
            let mut model = Model::new(&asked.compiled, Vec::new());
            // Both searches try the same values.
            model.inputs.iter_mut().for_each(|v| v.whole = true);
            let wide = model.inputs.iter().fold(1usize, |n, v| n.saturating_mul(v.tried.len().max(1)));
            if wide > WIDE {
                continue;
            }
            let at = || format!("{} seed {seed}\n{}", profile.name(), sample.text);
            let (all, far) = levels(&asked, &model, Tried::All);
            let (some, near) = levels(&asked, &model, Tried::Matter);
            let far = far.min(near);
            let near = |s: Seen| -> Seen { s.into_iter().filter(|(d, _, _)| *d < far).collect() };
            let (all, some) = (near(all), near(some));
            assert!(some.is_subset(&all), "{:?}\n{}", some.difference(&all).next(), at());
            assert!(all.is_subset(&some), "{:?}\n{}", all.difference(&some).next(), at());
            compared += all.len();
            if far == usize::MAX {
                let budget = Budget { states: STATES, scans: usize::MAX, bytes: 64 << 20, stop: &|| false };
                let mine: Vec<Question> =
                    asked.questions.iter().filter(|q| !matches!(q.claim, Claim::Asked(_))).cloned().collect();
                let answers = |tried| letters(&mut watch(&model, &mine, &budget, tried, &mut |_, _| {}));
                assert_eq!(answers(Tried::All), answers(Tried::Matter), "{}", at());
                answered += mine.len();
            }
        }
    }
    println!("{compared} situations with outputs, {answered} answers");
    assert!(compared > 2000 && answered > 300, "{compared} situations, {answered} answers");
}

/// Steps that become active with others, by links and by orders, read too in the same scan.
#[test]
fn enclosed_and_forced_steps_are_followed() {
    let base = "profile iec60848\ninput a, b : BOOL\noutput q : BOOL\n\
        chart G { step 10 LINK step 11 { N q } 10 -> 11 when b }\n";
    let enclosed =
        "chart M { initial step 1 enclosing step 2 { enclose G } 1 -> 2 when a 2 -> 1 when not a }\n";
    let forced = "chart M { initial step 1 step 2 { force G := {10} } step 3 1 -> 2 when a 2 -> 3 when not a \
        3 -> 1 when a and b }\n";
    for (link, order) in [("*", enclosed), ("", forced)] {
        let text = base.replace("LINK", link) + order;
        let (document, problems) = g7_syntax::parse(&text, Default::default());
        assert!(problems.is_empty(), "{problems:?}");
        let (asked, problems) = ask(&document, None);
        let asked = asked.unwrap_or_else(|| panic!("{problems:?}"));
        let model = Model::new(&asked.compiled, Vec::new());
        let both = [Tried::All, Tried::Matter].map(|tried| levels(&asked, &model, tried));
        assert_eq!(both[0], both[1], "{text}");
    }
}
