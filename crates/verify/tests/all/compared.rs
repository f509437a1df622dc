//! Two charts beside each other: search and solver agree on random charts and small edits of them, and the
//! solver answers for charts whose pairs of states cannot be visited.

use g7_model::{FileId, ProfileName};
use g7_syntax::parse;
use g7_tests::generate::sample;
use g7_verify::{
    Asked, Budget, Certificate, Compare, Difference, Equality, Reason, ask, compare, compare_by_search,
    compare_by_solver,
};

fn budget() -> Budget<'static> {
    Budget { states: 3_000, scans: 30_000, bytes: 256 << 20, stop: &|| false }
}

fn asked(text: &str, profile: Option<ProfileName>) -> Option<Asked> {
    let (document, problems) = parse(text, FileId(0));
    if problems.iter().any(|p| p.severity() == g7_model::Severity::Error) {
        return None;
    }
    ask(&document, profile).0
}

fn pair<'c>(a: &'c Asked, b: &'c Asked, situations: bool) -> Compare<'c> {
    Compare { charts: [&a.compiled, &b.compiled], assume: [a.assume.clone(), b.assume.clone()], situations }
}

fn chart(text: &str) -> Asked {
    asked(text, None).unwrap_or_else(|| panic!("{text}"))
}

/// The number of scans of a difference.
fn length(e: &Equality) -> Option<usize> {
    if let Equality::Apart { moves, .. } = e { Some(moves[0].len()) } else { None }
}

#[derive(Debug, Default)]
struct Count {
    charts: usize,
    equal: usize,
    apart: usize,
    open: usize,
    further: usize,
}

impl Count {
    /// Compares in both ways.
    fn both(&mut self, what: &Compare<'_>, tell: &str) {
        let searched = compare_by_search(what, &budget());
        let solved = compare_by_solver(what, 6, &budget());
        self.charts += 1;
        match (&searched, &solved) {
            (Equality::Equal(_), Equality::Equal(_)) => self.equal += 1,
            (Equality::Apart { .. }, Equality::Apart { .. }) => {
                assert!(length(&solved) <= length(&searched), "{tell}{searched:?}\n{solved:?}");
                self.apart += 1;
            }
            (Equality::Equal(_) | Equality::Apart { .. }, Equality::Open(open)) => {
                assert!(open.reason != Reason::NotRepeated, "{tell}{open:?}");
                assert!(length(&searched).is_none_or(|n| open.scans < n), "{tell}{searched:?}\n{open:?}");
                self.open += 1;
            }
            (Equality::Open(open), Equality::Equal(_)) => {
                assert!(!matches!(open.reason, Reason::NoInput(_) | Reason::Assumptions), "{tell}{open:?}");
                self.further += 1;
            }
            (Equality::Open(open), Equality::Apart { .. }) => {
                assert!(
                    length(&solved).is_some_and(|n| n > open.scans) || open.reason == Reason::Inputs,
                    "{tell}{open:?}\n{solved:?}"
                );
                self.further += 1;
            }
            (Equality::Open(_), Equality::Open(open)) => {
                assert!(open.reason != Reason::NotRepeated, "{tell}{open:?}");
                self.open += 1;
            }
            _ => panic!("{tell}search: {searched:?}\nsolver: {solved:?}"),
        }
    }
}

/// Small edits, of which a seed chooses one: each is made at one place.
const EDITS: [(&str, &str); 10] = [
    (" and ", " or "),
    (" or ", " and "),
    ("not ", ""),
    ("↑", "↓"),
    ("when ", "when not "),
    ("{ N ", "{ S "),
    ("P1", "P0"),
    ("10ms", "20ms"),
    (":= 1", ":= 0"),
    (" + 1", " + 2"),
];

fn edited(text: &str, seed: u64) -> Option<String> {
    let (from, to) = EDITS[seed as usize % EDITS.len()];
    let places: Vec<usize> = text.match_indices(from).map(|(i, _)| i).collect();
    let at = *places.get((seed as usize / EDITS.len()) % places.len().max(1))?;
    Some(format!("{}{to}{}", &text[..at], &text[at + from.len()..]))
}

/// `G7_CHARTS` is the number of charts a profile, `G7_SEED` the first of them. By default there is one chart, of
/// one profile.
#[test]
fn search_and_solver_agree_on_random_charts_and_their_edits() {
    let number = |name: &str, otherwise: u64| {
        #[allow(clippy::disallowed_methods, reason = "how much a test does is told by its environment")]
        std::env::var(name).ok().and_then(|v| v.parse().ok()).unwrap_or(otherwise)
    };
    let (first, count) = (number("G7_SEED", 1), number("G7_CHARTS", 1));
    let all = [
        ProfileName::Iec60848,
        ProfileName::Iec61131,
        ProfileName::Pl7,
        ProfileName::Unity,
        ProfileName::Jgrafchart,
    ];
    let mut all_done = Count::default();
    // One chart of each takes a minute.
    let all = if count > 1 { &all[..] } else { &all[1..2] };
    for &profile in all {
        let mut done = Count::default();
        for seed in first..first + count {
            let text = sample(seed, profile, 1).expect("a random chart can be read").text;
            let Some(a) = asked(&text, None) else { continue };
            let tell = |what: &str| format!("{} seed {seed}, {what}:\n{text}\n", profile.name());
            done.both(&pair(&a, &a, true), &tell("itself"));
            if let Some(other) = edited(&text, seed)
                && let Some(b) = asked(&other, None)
            {
                let what = pair(&a, &b, seed % 3 == 0);
                done.both(&what, &format!("{}with{other}\n", tell("edited")));
            }
            let other = all[seed as usize % all.len()];
            if other != profile
                && let Some(b) = asked(&text, Some(other))
            {
                done.both(&pair(&a, &b, false), &tell(other.name()));
            }
        }
        println!("{}: {done:?}", profile.name());
        all_done.equal += done.equal;
        all_done.apart += done.apart;
        all_done.open += done.open;
    }
    let decided = all_done.equal + all_done.apart;
    assert!(
        count < 12 || decided > all_done.open && all_done.equal > 20 && all_done.apart > 20,
        "{all_done:?}"
    );
}

/// Cells of five steps, each transition with an input of its own; two cells share a resource, which they hold
/// from their third to their fourth step. In the first chart the resource is a step; in the
/// second the receptivities ask whether the other cell holds it, and the first of a pair goes first.
fn cells(count: usize) -> [String; 2] {
    let mut head = String::from("profile iec61131\nscan 10ms\n");
    for c in 1..=count {
        head += &format!("input a{c}, b{c}, c{c}, d{c}, e{c} : BOOL\noutput m{c}, n{c} : BOOL\n");
    }
    let mut texts = [format!("{head}chart G {{\n"), format!("{head}chart G {{\n")];
    for c in 1..=count {
        let pair = 1000 + c.div_ceil(2);
        let other = if c % 2 == 1 { c + 1 } else { c - 1 };
        let [first, second] = &mut texts;
        for (text, base) in [(&mut *first, 0), (&mut *second, 20_000)] {
            let s = |k: usize| base + c * 10 + k;
            *text += &format!(
                "  initial step {}\n  step {}\n  step {} {{ N m{c} }}\n  step {}\n  step {} {{ N n{c} }}\n",
                s(1),
                s(2),
                s(3),
                s(4),
                s(5)
            );
            *text += &format!(
                "  {} -> {} when a{c}\n  {} -> {} when c{c}\n  {} -> {} when e{c}\n",
                s(1),
                s(2),
                s(3),
                s(4),
                s(5),
                s(1)
            );
        }
        let s = |k: usize| c * 10 + k;
        if c % 2 == 1 {
            *first += &format!("  initial step {pair}\n");
        }
        *first += &format!(
            "  ({}, {pair}) -> {} when b{c} priority {c}\n  {} -> ({}, {pair}) when d{c}\n",
            s(2),
            s(3),
            s(4),
            s(5)
        );
        let (s, o) = (|k: usize| 20_000 + c * 10 + k, |k: usize| 20_000 + other * 10 + k);
        let mut free =
            if other <= count { format!(" and not X{} and not X{}", o(3), o(4)) } else { String::new() };
        if c % 2 == 0 {
            free += &format!(" and not (X{} and b{other})", o(2));
        }
        *second += &format!("  {} -> {} when b{c}{free}\n  {} -> {} when d{c}\n", s(2), s(3), s(4), s(5));
    }
    texts.map(|t| t + "}\n")
}

/// Fifty cells have more than 10^33 pairs of situations.
#[test]
fn fifty_cells_are_equal_with_a_resource_and_with_conditions() {
    let [a, b] = cells(50).map(|t| chart(&t));
    let found = compare_by_solver(&pair(&a, &b, false), 12, &budget());
    assert!(
        matches!(found, Equality::Equal(Certificate::Invariant { clauses }) if clauses > 100),
        "{found:?}"
    );
}

/// The last cell of the second chart takes the resource though the other cell is in its fourth step.
#[test]
fn one_cell_of_fifty_that_asks_too_little_is_found() {
    let [a, b] = cells(50);
    let b = b.replacen(" and not X20494 and not (X20492", " and not (X20492", 1);
    let (a, b) = (chart(&a), chart(&b));
    let found = compare(&pair(&a, &b, false), &budget());
    // One scan each to leave the first step, to take the resource and to come to the fourth; one that differs.
    let Equality::Apart { moves, what } = found else { panic!("{found:?}") };
    assert_eq!((moves[0].len(), what), (4, Difference::Output("m50".to_owned())));
}

#[test]
fn two_cells_are_equal_but_for_the_names_of_their_steps() {
    let [a, b] = cells(2).map(|t| chart(&t));
    let mut done = Count::default();
    done.both(&pair(&a, &b, false), "");
    done.both(&pair(&a, &b, true), "");
    assert!(done.equal == 1 && done.apart == 1, "{done:?}");
}

/// Inputs keep the assumptions of both charts.
#[test]
fn assumptions_of_either_chart_bind_both() {
    let head = "profile iec61131\ninput a, b : BOOL\noutput m : BOOL\n";
    let one = format!("{head}chart G {{ initial step 1 step 2 {{ N m }} 1 -> 2 when a 2 -> 1 when b }}\n");
    let two = one.replace("when a", "when a and not b");
    let assumed = |text: &str| format!("{text}assume not (a and b)\n");
    let equal = |a: &str, b: &str| {
        let (a, b) = (chart(a), chart(b));
        let what = pair(&a, &b, false);
        let mut done = Count::default();
        done.both(&what, "");
        let found = compare(&what, &budget());
        assert!(done.open == 0 && done.further == 0, "{done:?}");
        matches!(found, Equality::Equal(_))
    };
    assert!(!equal(&one, &two));
    assert!(
        equal(&assumed(&one), &two) && equal(&one, &assumed(&two)) && equal(&assumed(&one), &assumed(&two))
    );
    // Together they leave no input: nothing is proved by that.
    let [never, always] = ["assume not a", "assume a"].map(|line| chart(&format!("{one}{line}\n")));
    let other = chart(&format!("{two}assume a\n"));
    for (x, y) in [(&never, &always), (&never, &other)] {
        let what = pair(x, y, false);
        for found in [
            compare(&what, &budget()),
            compare_by_search(&what, &budget()),
            compare_by_solver(&what, 9, &budget()),
        ] {
            assert!(
                matches!(&found, Equality::Open(open) if matches!(open.reason, Reason::NoInput(_))),
                "{found:?}"
            );
        }
    }
}

/// A timer of an hour is 360000 scans, which neither search nor an unrolled system would wait for.
#[test]
fn timers_of_any_length() {
    let text = |wait: &str, time: &str| {
        format!(
            "profile iec61131\nscan 10ms\ninput a : BOOL\noutput m : BOOL\nchart G {{ initial step 1 step 2 {{ N m }} \
             1 -> 2 when a 2 -> 1 when {} }}\n",
            wait.replace("T", time)
        )
    };
    let charts = [("T/X2", "40ms"), ("X2.t >= T", "40ms"), ("T/X2", "50ms")].map(|(w, t)| chart(&text(w, t)));
    let mut done = Count::default();
    done.both(&pair(&charts[0], &charts[1], false), "");
    done.both(&pair(&charts[0], &charts[2], false), "");
    assert_eq!((done.equal, done.apart), (1, 1));
    let [a, b] = ["X2.t >= T", "not (X2.t < T)"].map(|w| chart(&text(w, "1h")));
    let found = compare_by_solver(&pair(&a, &b, false), 12, &budget());
    assert!(matches!(found, Equality::Equal(_)), "{found:?}");
}
