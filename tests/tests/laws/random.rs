//! Random charts are useful tests: the checker accepts them, they contain every feature, most scans
//! end without a fault, and the situations change.

use g7_model::{Document, Item, ProfileName};
use g7_tests::agree::{Statistics, agree};
use g7_tests::generate::{Script, sample};
use g7_tests::shrink::shrink;
use g7_tests::subject::naive;

const CHARTS: u64 = 250;

#[test]
fn one_seed_gives_one_chart() {
    for seed in 0..20 {
        let draw = || sample(seed, ProfileName::Pl7, 10).expect("a random chart can be read").text;
        assert_eq!(draw(), draw());
    }
}

#[test]
fn the_checker_accepts_them() {
    for profile in ProfileName::ALL {
        for seed in 1..=CHARTS {
            let sample = sample(seed, profile, 1).expect("a random chart can be read");
            let problems = g7_compile::check(&sample.document);
            let error = problems.iter().find(|p| p.severity() == g7_model::Severity::Error);
            if let Some(p) = error {
                panic!("{} seed {seed}: {} {}\n{}", profile.name(), p.code.id, p.what, sample.text);
            }
        }
    }
}

#[test]
fn the_printer_keeps_them() {
    for seed in 1..=CHARTS {
        let sample = sample(seed, ProfileName::Unity, 1).expect("a random chart can be read");
        let (again, problems) =
            g7_syntax::parse(&g7_syntax::print(&sample.document, None), Default::default());
        assert!(problems.is_empty(), "seed {seed}: {problems:?}");
        assert!(again == sample.document, "seed {seed} reads otherwise as printed");
    }
}

#[test]
fn they_live() {
    for profile in ProfileName::ALL {
        let mut all = Statistics::default();
        for seed in 1..=CHARTS {
            let sample = sample(seed, profile, 40).expect("a random chart can be read");
            let run = agree(&sample.document, &sample.script, [naive, naive]);
            all.add(&run.expect("one engine agrees with itself"));
        }
        let line = format!("{}: {}", profile.name(), all.line());
        println!("{line}");
        assert!(all.sound() * 100 >= all.scans * 90, "too many faults: {line}");
        assert!(all.moved * 100 >= all.scans * 12, "too little moves: {line}");
        assert!(all.situations as u64 >= 3 * CHARTS, "too few situations: {line}");
        assert!(all.active >= 2 * all.scans, "too few active steps: {line}");
    }
}

#[test]
fn every_feature_is_there() {
    let words = [
        "macro M",
        "macrochart",
        "task ",
        "call ",
        "enclosing step",
        "enclose ",
        "force ",
        ":= INIT",
        "{*}",
        "enable ",
        "mask ",
        " every ",
        "initial step",
        "priority ",
        "on clearing",
        "each scan:",
        "on ↑",
        "on ↓",
        "P1 ",
        "P0 ",
        "N Q",
        "S Q",
        "R Q",
        "L ",
        "D ",
        "SD ",
        "DS ",
        "SL ",
        "P Q",
        " if ",
        "delay(",
        "ms/",
        ".t ",
        "rise(",
        "fall(",
        "↑(",
        "transition section",
        "function ",
        "action Act",
        "pre ",
        "post ",
        "IF ",
        "CASE ",
        "FOR ",
        "WHILE ",
        "REPEAT ",
        "EXIT",
        "STRING",
        "REAL",
        "TIME",
        "USINT",
        "TON",
        "CTU",
        "retain",
        "safe ",
        "%S21",
        "%S23",
        "RESET_XIT",
        "INITCHART",
        "FREEZECHART",
        "SETSTEP",
        "single-token",
        "sequential",
        "ordered-actions",
        "() -> ",
        "-> ()",
        "X1.t",
        "SEL(",
        "MIN(",
        "CONCAT(",
        " mod ",
        " xor ",
    ];
    let mut text = String::new();
    for profile in ProfileName::ALL {
        for seed in 1..=CHARTS {
            text += &sample(seed, profile, 1).expect("a random chart can be read").text;
        }
    }
    let missing: Vec<&str> = words.into_iter().filter(|w| !text.contains(w)).collect();
    assert!(missing.is_empty(), "never drawn: {missing:?}");
}

#[test]
fn the_shrinker_leaves_what_matters() {
    let sample = sample(3, ProfileName::Iec61131, 30).expect("a random chart can be read");
    let transitions = |d: &Document| d.charts().flat_map(|c| c.transitions()).count();
    let fails = |d: &Document, s: &Script| transitions(d) > 0 && s.len() > 2;
    assert!(fails(&sample.document, &sample.script));
    let (doc, script) = shrink(&sample.document, &sample.script, &fails);
    assert_eq!(script.len(), 3);
    assert_eq!(transitions(&doc), 1);
    let charts = doc.items.iter().filter(|i| matches!(i, Item::Chart(_))).count();
    assert_eq!((charts, doc.items.len()), (1, 1), "{}", g7_syntax::print(&doc, None));
}
