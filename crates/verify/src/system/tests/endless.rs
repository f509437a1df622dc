//! Searches for stability that never end: what their passes show is seen to the end, by the engine's
//! passes one by one and by the system.

use super::charts::same;
use super::{asked, parsed};
use crate::explicit::Explicit;
use crate::layer::{Budget, Layer};
use crate::model::Model;
use crate::question::Claim;
use crate::sat::Satisfiability;
use crate::verdict::{Evidence, Verdict};

/// A chart of one ring of `n` steps, all transitions of which ask for `a`.
fn ring(name: &str, first: usize, n: usize, initial: usize) -> String {
    let mut t = format!("chart {name} {{\n");
    for k in 0..n {
        t += &format!("  {}step {}\n", if k < initial { "initial " } else { "" }, first + k);
    }
    for k in 0..n {
        t += &format!("  {} -> {} when a\n", first + k, first + (k + 1) % n);
    }
    t + "}\n"
}

const HEAD: &str = "profile iec60848\ninput a : BOOL\n";

/// The answers of a layer to the claims about what happens within a scan.
fn verdicts(text: &str, layer: &dyn Layer) -> Vec<(Claim, Verdict)> {
    let asked = asked(&parsed(text), None).expect("a chart");
    let model = Model::new(&asked.compiled, Vec::new());
    let mut answers = vec![None; asked.questions.len()];
    let budget = Budget { states: 10_000, scans: usize::MAX, bytes: 64 << 20, stop: &|| false };
    layer.answer(&model, &asked.questions, &mut answers, &budget);
    let all = asked.questions.iter().zip(answers);
    all.map(|(q, v)| (q.claim.clone(), v.expect("each question has an answer"))).collect()
}

/// The reports of a scan have room for some passes only. Two tokens that go round leave each step as they
/// enter it, in every pass; a pass of which one half were reported would look unsafe.
#[test]
fn passes_without_room_in_the_reports_are_seen_as_well() {
    for n in 2..9 {
        let text = format!("{HEAD}{}{}", ring("H", 1, n, 1), ring("G", 21, 2, 2));
        assert!(same(&text, 6).faults > 20, "{text}");
        for layer in [&Explicit as &dyn Layer, &Satisfiability { turns: 12 }] {
            let all = verdicts(&text, layer);
            let safe = all.iter().find(|(c, _)| *c == Claim::NoUnsafe);
            let proved = matches!(safe, Some((_, Verdict::Proved(_))));
            assert!(proved, "{}: {safe:?}\n{text}", layer.name());
        }
    }
}

/// A chart that is left in its first scan for a step at the end of a row stops in a pass that the profile
/// bounds: what a further pass would show never happens.
#[test]
fn passes_beyond_the_bound_are_not_made() {
    let rows = |bound: u32| {
        format!(
            "profile iec60848 {{ bound {bound} }}\ninput a : BOOL\nchart G {{\n  initial step 1\n  step 2\n  step 3\n  \
             step 4\n  initial step 5\n  1 -> 2 when a\n  2 -> 3 when a\n  3 -> 4 when a\n  4 -> 5 when a\n}}\n"
        )
    };
    // The fourth pass activates step 5, which is active; a fifth one sees that nothing changes.
    for (bound, safe) in [(3, true), (4, false), (5, false)] {
        same(&rows(bound), 4);
        for layer in [&Explicit as &dyn Layer, &Satisfiability { turns: 12 }] {
            let all = verdicts(&rows(bound), layer);
            let verdict = all.iter().find(|(c, _)| *c == Claim::NoUnsafe).map(|(_, v)| v);
            let proved = matches!(verdict, Some(Verdict::Proved(_)));
            assert_eq!(proved, safe, "{bound} {}: {verdict:?}", layer.name());
        }
    }
}

/// Rings of 5 and 7 steps are together what they were after 35 passes, more than are unrolled. Each by
/// itself comes back before, and then all of its transitions have cleared.
#[test]
fn parts_that_come_back_one_by_one_are_seen_whole() {
    let text = format!("{HEAD}{}{}", ring("H", 1, 5, 1), ring("G", 21, 7, 1));
    let done = same(&text, 4);
    assert!(done.faults > 20 && done.unsure == 0, "{done:?}");
    for (claim, verdict) in verdicts(&text, &Satisfiability { turns: 12 }) {
        let run = matches!(verdict, Verdict::Proved(Evidence::Run(_)));
        match claim {
            Claim::Active(_) | Claim::Clears(_) => assert!(run, "{claim:?}: {verdict:?}"),
            Claim::NoUnsafe | Claim::NoConflict => {
                assert!(matches!(verdict, Verdict::Proved(_)) && !run, "{claim:?}: {verdict:?}");
            }
            _ => {}
        }
    }
}

/// Two rings evolve without end; a further transition clears only in a pass in which both rings are at certain
/// steps. That pass is beyond those that the system unrolls, so the claim about this transition stays open. The
/// claims about the transitions of each ring are decided.
#[test]
fn a_part_that_has_not_come_back_is_left_open() {
    let meet = "chart M {\n  initial step 41\n  step 42\n  41 -> 42 when H.X5 and G.X27\n}\n";
    let text = format!("{HEAD}{}{}{meet}", ring("H", 1, 5, 1), ring("G", 21, 7, 1));
    let done = same(&text, 4);
    assert!(done.faults > 20 && done.unsure > 20, "{done:?}");
    let all = verdicts(&text, &Satisfiability { turns: 12 });
    let open = |claim: &Claim| all.iter().any(|(c, v)| c == claim && matches!(v, Verdict::Open(_)));
    assert!(open(&Claim::Clears(12)) && open(&Claim::NoUnsafe) && !open(&Claim::Clears(3)), "{all:?}");
}
