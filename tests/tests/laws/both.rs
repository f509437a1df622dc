//! Search and solver never contradict each other: random charts of each profile, every question
//! asked of both. (`make prove-table` does the same with the examples, the litmus charts and the corpus.)

use std::collections::BTreeMap;

use g7_model::{Document, ProfileName};
use g7_tests::generate::sample;
use g7_verify::{Budget, Claim, Evidence, Explicit, Layer, Model, Reason, Satisfiability, Verdict, ask};

/// Random charts of each profile.
const CHARTS: u64 = 12;

/// Answers of both layers, counted by what they are.
type Tally = BTreeMap<(&'static str, &'static str), usize>;

fn word(v: &Verdict) -> &'static str {
    match v {
        Verdict::Proved(_) => "proved",
        Verdict::Refuted(_) => "refuted",
        Verdict::Open(_) => "open",
    }
}

fn length(v: &Verdict) -> Option<usize> {
    match v {
        Verdict::Proved(Evidence::Run(r)) | Verdict::Refuted(Evidence::Run(r)) => Some(r.moves.len()),
        Verdict::Proved(_) | Verdict::Refuted(_) | Verdict::Open(_) => None,
    }
}

fn compare(document: &Document, name: &str, tally: &mut Tally) {
    let Some(asked) = ask(document, None).0 else { return };
    let model = Model::new(&asked.compiled, asked.assume.clone());
    let budget = Budget { states: 3000, scans: 60_000, bytes: 256 << 20, stop: &|| false };
    let [searched, solved] = [&Explicit as &dyn Layer, &Satisfiability { turns: 3 }].map(|layer| {
        let mut answers = vec![None; asked.questions.len()];
        layer.answer(&model, &asked.questions, &mut answers, &budget);
        answers.into_iter().map(|a| a.expect("each question has an answer")).collect::<Vec<Verdict>>()
    });
    for ((q, a), b) in asked.questions.iter().zip(&searched).zip(&solved) {
        *tally.entry((word(a), word(b))).or_default() += 1;
        let open = word(a) == "open" || word(b) == "open";
        assert!(open || word(a) == word(b), "{name}: {:?}: {a:?} or {b:?}", q.claim);
        // Of values that make no difference both may try others; all else is as short as can be.
        let whole = model.inputs.iter().all(|v| v.whole);
        if let (Some(x), Some(y)) = (length(a), length(b))
            && !matches!(q.claim, Claim::Asked(_))
        {
            assert!(x == y || !whole && y < x, "{name}: {:?}: {x} or {y} scans", q.claim);
        }
        if let Verdict::Open(open) = b {
            assert!(open.reason != Reason::NotRepeated, "{name}: {:?}: {open:?}", q.claim);
        }
    }
}

#[test]
fn random_charts_have_one_answer() {
    let of_profile = |profile: ProfileName| {
        let mut tally = Tally::new();
        for seed in 1..=CHARTS {
            let sample = sample(seed, profile, 1).expect("a random chart can be read");
            let name = format!("{} seed {seed}\n{}", profile.name(), sample.text);
            compare(&sample.document, &name, &mut tally);
        }
        tally
    };
    let mut tally = Tally::new();
    std::thread::scope(|scope| {
        let all = ProfileName::ALL.map(|profile| scope.spawn(move || of_profile(profile)));
        for (kind, count) in all.into_iter().flat_map(|t| t.join().expect("its charts agree")) {
            *tally.entry(kind).or_default() += count;
        }
    });
    println!("search, solver: {tally:?}");
    let both: usize = ["proved", "refuted"].iter().map(|w| tally.get(&(*w, *w)).copied().unwrap_or(0)).sum();
    assert!(both > 300, "{tally:?}");
}
