//! A chart with more states than can be visited: the solver answers.

use g7_model::FileId;
use g7_syntax::parse;
use g7_verify::{Budget, Certificate, Claim, Evidence, Layer, Model, Satisfiability, Verdict, ask, replay};

/// Cells of five steps, each transition with an input of its own. Two cells share a resource,
/// which they hold from their third to their fourth step. With `faulty` the last pair does not
/// ask for it.
fn cells(count: usize, faulty: bool) -> String {
    let mut text = String::from("profile iec61131\nscan 10ms\n");
    for c in 1..=count {
        text += &format!("input a{c}, b{c}, c{c}, d{c}, e{c} : BOOL\n");
    }
    text += "chart G {\n";
    for c in 1..=count {
        let s = |k: usize| c * 10 + k;
        let pair = 1000 + c.div_ceil(2);
        if c % 2 == 1 {
            text += &format!("  initial step {pair}\n");
        }
        text += &format!(
            "  initial step {}\n  step {}\n  step {}\n  step {}\n  step {}\n",
            s(1),
            s(2),
            s(3),
            s(4),
            s(5)
        );
        let (take, give) = if faulty && c == count {
            (format!("{} -> {}", s(2), s(3)), format!("{} -> {}", s(4), s(5)))
        } else {
            (format!("({}, {pair}) -> {}", s(2), s(3)), format!("{} -> ({}, {pair})", s(4), s(5)))
        };
        text += &format!(
            "  {} -> {} when a{c};\n  {take} when b{c} priority {};\n  {} -> {} when c{c};\n  {give} when d{c};\n  {} -> {} when e{c};\n",
            s(1),
            s(2),
            c,
            s(3),
            s(4),
            s(5),
            s(1)
        );
    }
    text += "}\n";
    for c in (1..count).step_by(2) {
        let held = |c: usize| format!("(X{} or X{})", c * 10 + 3, c * 10 + 4);
        text += &format!("prove never {} and {}\n", held(c), held(c + 1));
    }
    text
}

/// The answers to the author's questions, each run replayed.
fn answers(text: &str) -> Vec<Verdict> {
    let (document, problems) = parse(text, FileId(0));
    assert!(problems.is_empty(), "{problems:?}");
    let (asked, problems) = ask(&document, None);
    let asked = asked.unwrap_or_else(|| panic!("{problems:?}"));
    let mine: Vec<_> =
        asked.questions.iter().filter(|q| matches!(q.claim, Claim::Never(_))).cloned().collect();
    let model = Model::new(&asked.compiled, asked.assume.clone());
    let mut answers = vec![None; mine.len()];
    let budget = Budget { states: 1000, scans: 1000, bytes: 1 << 30, stop: &|| false };
    Satisfiability::default().answer(&model, &mine, &mut answers, &budget);
    for (q, a) in mine.iter().zip(&answers) {
        if let Some(Verdict::Refuted(Evidence::Run(run))) = a {
            assert!(replay(&model, &q.claim, run));
        }
    }
    answers.into_iter().map(|a| a.expect("each question has an answer")).collect()
}

/// 50 cells have 21^25 situations, more than 10^33.
#[test]
fn fifty_cells_exclude_each_other() {
    let all = answers(&cells(50, false));
    assert_eq!(all.len(), 25);
    for a in &all {
        let certified = matches!(
            a,
            Verdict::Proved(Evidence::Certificate(
                Certificate::Invariant { .. } | Certificate::Induction { .. }
            ))
        );
        assert!(certified, "{a:?}");
    }
}

/// The last cell takes no resource: after two scans both cells of its pair are inside.
#[test]
fn one_cell_that_does_not_ask_is_found() {
    let all = answers(&cells(50, true));
    for (i, a) in all.iter().enumerate() {
        match a {
            Verdict::Refuted(Evidence::Run(run)) if i == 24 => assert_eq!(run.moves.len(), 2),
            Verdict::Proved(_) if i < 24 => {}
            _ => panic!("{i}: {a:?}"),
        }
    }
}
