//! Zones see what the search of all states sees: random charts, and one chart for each kind of time.
//!
//! `G7_CHARTS` is the number of random charts of a profile, `G7_SEED` the first one.
#![allow(clippy::disallowed_methods, reason = "the tests read charts and variables of the environment")]

use g7_compile::ir::VarClass;
use g7_model::{FileId, ProfileName, Type};
use g7_tests::generate::sample;

use super::Zones;
use crate::ask::{Asked, ask};
use crate::explicit::Explicit;
use crate::layer::{Budget, Layer};
use crate::look::replay;
use crate::model::Model;
use crate::question::Claim;
use crate::verdict::{Certificate, Evidence, Verdict};

pub(crate) const PROFILES: [ProfileName; 5] = [
    ProfileName::Iec60848,
    ProfileName::Iec61131,
    ProfileName::Pl7,
    ProfileName::Unity,
    ProfileName::Jgrafchart,
];

pub(crate) fn number(name: &str, otherwise: u64) -> u64 {
    std::env::var(name).ok().and_then(|v| v.parse().ok()).unwrap_or(otherwise)
}

pub(crate) fn asked(text: &str, profile: Option<ProfileName>) -> Option<Asked> {
    let (document, problems) = g7_syntax::parse(text, FileId(0));
    assert!(problems.is_empty(), "{problems:?}\n{text}");
    let own = document.profile().map(|d| d.name).unwrap_or_default();
    ask(&document, profile.filter(|p| *p != own)).0
}

pub(crate) fn answers(asked: &Asked, layer: &dyn Layer, scans: usize) -> Vec<Option<Verdict>> {
    let model = Model::new(&asked.compiled, asked.assume.clone());
    let budget = Budget { states: 20_000, scans, bytes: 64 << 20, stop: &|| false };
    let mut answers = vec![None; asked.questions.len()];
    layer.answer(&model, &asked.questions, &mut answers, &budget);
    for (q, a) in asked.questions.iter().zip(&answers) {
        if let Some(Verdict::Proved(Evidence::Run(run)) | Verdict::Refuted(Evidence::Run(run))) = a {
            assert!(replay(&model, &q.claim, run), "{:?}", q.claim);
        }
    }
    answers
}

pub(crate) fn letter(v: &Option<Verdict>) -> char {
    match v {
        Some(Verdict::Proved(_)) => 'P',
        Some(Verdict::Refuted(_)) => 'R',
        Some(Verdict::Open(_)) => 'O',
        None => '-',
    }
}

/// Number of questions by what search and zones made of them.
#[derive(Clone, Copy, Debug, Default)]
struct Count {
    charts: usize,
    /// Both decided, and agree.
    both: usize,
    /// Decided by the search alone.
    search: usize,
    /// Decided by zones alone.
    zones: usize,
}

/// Compares the answers of search and zones to all questions of a chart.
fn compare(asked: &Asked, scans: usize, text: &str, count: &mut Count) {
    let zones = answers(asked, &Zones, scans);
    if zones.iter().all(Option::is_none) {
        return;
    }
    count.charts += 1;
    let search = answers(asked, &Explicit, scans);
    for ((q, s), z) in asked.questions.iter().zip(&search).zip(&zones) {
        match (letter(s), letter(z)) {
            ('P' | 'R', 'P' | 'R') => {
                assert_eq!(letter(s), letter(z), "{:?}: {s:?}\n{z:?}\n{text}", q.claim);
                count.both += 1;
                // No run is shorter than the shortest.
                if let (Some(s), Some(z)) = (length(s), length(z)) {
                    assert!(s <= z, "{:?}: {s} {z}\n{text}", q.claim);
                }
            }
            ('P' | 'R', 'O') => {
                count.search += 1;
                if number("G7_SHOW", 0) > 0 {
                    println!("{:?}: {z:?}\n{text}", q.claim);
                }
            }
            (_, 'P' | 'R') => count.zones += 1,
            _ => {}
        }
    }
}

pub(crate) fn length(v: &Option<Verdict>) -> Option<usize> {
    match v {
        Some(Verdict::Proved(Evidence::Run(r)) | Verdict::Refuted(Evidence::Run(r))) => Some(r.moves.len()),
        _ => None,
    }
}

/// A random chart with questions about its inputs, outputs and steps.
pub(crate) fn with_questions(text: &str, seed: u64) -> String {
    let Some(asked) = asked(text, None) else { return text.to_owned() };
    let of = |wanted: VarClass| {
        let all = asked.compiled.symbols.variables.iter();
        let bools = all.filter(move |v| v.class == wanted && v.ty == Type::Bool && v.elements == 1);
        bools.map(|v| v.name.to_string()).collect::<Vec<_>>()
    };
    let (ins, outs) = (of(VarClass::Input), of(VarClass::Output));
    let pick = |list: &[String], k: u64| list.get((seed / k) as usize % list.len().max(1)).cloned();
    let (Some(a), Some(b), Some(c)) = (pick(&ins, 1), pick(&outs, 3), pick(&outs, 7)) else {
        return text.to_owned();
    };
    let within = 10 * (seed % 6) + seed % 3;
    let mut text = format!("{text}\nprove always {a} or not {b}\nprove reachable {a} and {c}\n");
    text += &match seed % 5 {
        0 => format!("prove after {a} within {within}ms expect {b}\n"),
        1 => format!("prove after {b} until {a} expect {c}\n"),
        2 => format!("prove {a} leads to {b}\n"),
        3 => format!("prove after {b} within {within}ms expect not {b}\n"),
        _ => format!("prove between {c} and {a} never {b}\n"),
    };
    if seed.is_multiple_of(4) {
        text += &format!("assume {a} or not {b}\n");
    }
    text
}

fn random(profile: ProfileName) {
    let (mut seed, mut count) = (number("G7_SEED", 1), Count::default());
    let charts = number("G7_CHARTS", 10) as usize;
    while count.charts < charts {
        let sample = sample(seed, profile, 1).expect("a random chart can be read");
        let text = with_questions(&sample.text, seed);
        if let Some(asked) = asked(&text, None) {
            compare(&asked, 20_000, &text, &mut count);
        }
        seed += 1;
    }
    println!("{}: {count:?}, {seed} seeds", profile.name());
    assert!(count.both > 5 * count.charts && count.search * 10 < count.both, "{count:?}");
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

/// The head of every chart below; each has inputs a and b, and outputs x and y.
const HEAD: &str = "scan 10ms\ninput a, b : BOOL\noutput x, y : BOOL\n";

/// Questions of every chart below.
const ASK: &str = "prove never x and y\nprove after a within 30ms expect x\nprove after x within 20ms expect not x\n\
                   prove a leads to x\nprove after x until y expect a\nprove reachable x and y\n";

/// A chart for each kind of time, with short times that the search can count.
const KINDS: [&str; 12] = [
    // The time of a step, also of one that something else leaves.
    "chart G { initial step 1 step 2 { N x } step 3 { N y } 1 -> 2 when a 2 -> 3 when 30ms/X2 2 -> 1 when b 3 -> 1 when not b }",
    // A step that is left keeps its time.
    "chart G { initial step 1 step 2 { N x } step 3 { N y } 1 -> 2 when a 2 -> 3 when b 3 -> 1 when X2.t > 25ms 3 -> 2 when X3.t >= 40ms }",
    // Two times side by side, compared in several ways.
    "chart G { initial step 1 step 2 { N x } 1 -> 2 when a 2 -> 1 when X2.t >= 50ms }\n\
     chart H { initial step 11 step 12 { N y } 11 -> 12 when b and X2.t < 30ms 12 -> 11 when 35ms <= X12.t or X2.t = 20ms }",
    // Delays in and out.
    "chart G { initial step 1 step 2 { N x } step 3 { N y } 1 -> 2 when 30ms/a/20ms 2 -> 3 when not 20ms/a 3 -> 1 when not (10ms/b/40ms) }",
    // Timed actions.
    "chart G { initial step 1 step 2 { L 30ms x  D 20ms y } step 3 1 -> 2 when a 2 -> 3 when b 3 -> 1 when not a }",
    "chart G { initial step 1 step 2 { SD 30ms x  SL 20ms y } step 3 step 4 { R x R y } 1 -> 2 when a 2 -> 3 when b 3 -> 4 when a 4 -> 1 when b }",
    "chart G { initial step 1 step 2 { DS 30ms x  L 20ms y if b } step 3 { R x } 1 -> 2 when a 2 -> 3 when b 3 -> 1 when not a }",
    // Timers that are called.
    "var t1 : TON\nvar t2 : TOF\nchart G { initial step 1 step 2 1 -> 2 when b 2 -> 1 when t2.Q }\n\
     post { t1(IN := a, PT := 30ms); t2(IN := X2, PT := 20ms); x := t1.Q; y := t2.Q; }",
    "var t1 : TP\nvar t2 : TON\nvar n : INT\nchart G { initial step 1 step 2 { N x } 1 -> 2 when t1.Q 2 -> 1 when t2.Q or b }\n\
     post { t1(IN := a, PT := 20ms); IF b THEN t2(IN := X2, PT := 30ms); ELSE t2(IN := X2, PT := 50ms); END_IF; y := t1.Q; }",
    // ET is read, so the timer is counted.
    "var t1 : TON\nchart G { initial step 1 step 2 { N x } 1 -> 2 when t1.ET > 20ms 2 -> 1 when b and 30ms/X2 }\n\
     post { t1(IN := a, PT := 40ms); y := t1.Q; }",
    // Charts with periods of their own.
    "chart G every 30ms { initial step 1 step 2 { N x } 1 -> 2 when a 2 -> 1 when b and 50ms/X2 }\n\
     chart H { initial step 11 step 12 { N y } 11 -> 12 when X2 12 -> 11 when X12.t > 20ms }",
    // A time as a number.
    "var late : BOOL\nvar limit : TIME := 30ms\nchart G { initial step 1 step 2 { N x; N late := X2.t > limit } step 3 { N y } 1 -> 2 when a 2 -> 3 when late 3 -> 1 when b or X3.t / 2 > 15ms }",
];

#[test]
fn each_kind_of_time_in_each_profile() {
    let (mut count, mut met) = (Count::default(), 0);
    for (k, chart) in KINDS.iter().enumerate() {
        for profile in PROFILES {
            let text = format!("profile {}\n{HEAD}{chart}\n{ASK}", profile.name());
            let Some(asked) = asked(&text, None) else { continue };
            let before = count;
            compare(&asked, 200_000, &text, &mut count);
            met |= 1u32 << k;
            assert_eq!(count.search, before.search, "zones decide less than the search\n{text}");
        }
    }
    println!("{count:?}");
    assert_eq!(met, (1 << KINDS.len()) - 1, "each chart is one of some profile");
    assert!(count.charts > 25, "{count:?}");
}

/// Two timers side by side: as many zones for long times as for short ones, while states are as many as the
/// product of their times.
#[test]
fn two_times_side_by_side_cost_the_same_however_long() {
    let mut seen = None;
    for ticks in [10u64, 100, 1000, 100_000] {
        let (d, e) = (10 * ticks, 10 * ticks + 30);
        let text = format!(
            "profile iec61131\nscan 10ms\ninput a, b : BOOL\noutput x, y : BOOL\n\
             chart G {{ initial step 1 step 2 {{ N x }} 1 -> 2 when a 2 -> 1 when {d}ms/X2 }}\n\
             chart H {{ initial step 11 step 12 {{ N y }} step 13 11 -> 12 when b 12 -> 11 when {e}ms/X12 11 -> 13 when FALSE }}\n\
             prove reachable x and y and X2.t > {}ms\n\
             prove after x within {d}ms expect not x\nprove after x within {}ms expect not x\n\
             prove x leads to not x\nprove never X2.t > {d}ms and X2\n",
            d - 20,
            d - 10
        );
        let asked = asked(&text, None).expect("it compiles");
        let all = answers(&asked, &Zones, 100_000);
        let letters: String = all.iter().map(letter).collect();
        let own = asked.questions.iter().zip(&all).filter(|(q, _)| q.claim.is_own());
        assert_eq!(own.map(|(_, a)| letter(a)).collect::<String>(), "PPRPP", "{ticks}");
        let deadlock =
            asked.questions.iter().position(|q| q.claim == Claim::NoDeadlock).expect("it is asked");
        let Some(Some(Verdict::Proved(Evidence::Certificate(Certificate::Zones { zones, .. })))) =
            all.get(deadlock)
        else {
            panic!("{:?}", all.get(deadlock));
        };
        let now = (letters, *zones);
        assert_eq!(seen.get_or_insert_with(|| now.clone()), &now, "{ticks}");
        assert!(now.1 < 100, "{now:?}");
    }
}

/// Examples with timers of several seconds, some of which run at the same time.
#[test]
fn examples_with_times_are_decided() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    let names = ["structure/enclosing", "structure/macro-step", "structure/task", "actions/continuous"];
    for name in names {
        let text = std::fs::read_to_string(folder.join(format!("{name}.g7"))).expect("it can be read");
        let asked = asked(&text, None).expect("it compiles");
        let all = answers(&asked, &Zones, 200_000);
        for (q, a) in asked.questions.iter().zip(&all) {
            assert!(matches!(letter(a), 'P' | 'R'), "{name}: {:?} {a:?}", q.claim);
        }
    }
}

/// The bounds of the time of step 2 in a receptivity, in ns.
fn bounds(condition: &str) -> Option<Vec<i64>> {
    let text = format!(
        "profile iec61131\nscan 10ms\ninput a : BOOL\nvar limit : TIME := 30ms\nvar moves : TIME := 30ms\n\
         chart G {{ initial step 1 {{ P1 moves := moves + 1ms }} step 2 1 -> 2 when a 2 -> 1 when {condition} }}\n"
    );
    let asked = asked(&text, None).expect("it compiles");
    let times = asked.compiled.program.times().expect("times are told from other words");
    assert_eq!(times.len(), 1, "{condition}: {times:?}");
    times.into_iter().next().and_then(|t| t.bounds)
}

#[test]
fn bounds_are_where_comparisons_change() {
    const MS: i64 = 1_000_000;
    assert_eq!(bounds("30ms/X2"), Some(vec![30 * MS]));
    assert_eq!(bounds("X2.t >= 30ms"), Some(vec![30 * MS]));
    assert_eq!(bounds("X2.t < 30ms"), Some(vec![30 * MS]));
    assert_eq!(bounds("X2.t > 30ms"), Some(vec![30 * MS + 1]));
    assert_eq!(bounds("X2.t <= 30ms"), Some(vec![30 * MS + 1]));
    assert_eq!(bounds("X2.t = 30ms"), Some(vec![30 * MS, 30 * MS + 1]));
    assert_eq!(bounds("30ms <= X2.t"), Some(vec![30 * MS]));
    assert_eq!(bounds("30ms < X2.t"), Some(vec![30 * MS + 1]));
    assert_eq!(bounds("X2.t > limit"), Some(vec![30 * MS + 1]), "nothing writes the variable");
    assert_eq!(bounds("X2.t / 2 >= 15ms"), Some(vec![30 * MS]));
    assert_eq!(bounds("X2.t / 2 > 15ms"), Some(vec![30 * MS + 2]));
    assert_eq!(bounds("X2.t >= 30ms and a or X2.t > 5ms"), Some(vec![5 * MS + 1, 30 * MS]));
    // Every value may matter.
    assert_eq!(bounds("X2.t > moves"), None);
    assert_eq!(bounds("X2.t * 2 > 15ms"), None);
    assert_eq!(bounds("X2.t + 5ms > 15ms"), None);
}
