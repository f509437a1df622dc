//! A chart of any number of cells, for the benches of the prover.
//!
//! A cell is a circle of five steps whose transitions each wait for an input of their own. Two cells share
//! a resource, a step, from their third to their fourth step. A pair has 21 situations (25, but for the
//! four in which both have the resource), so `n` cells have `21^(n/2)`; one state more stands for the time
//! before the first scan.

/// The chart as text, of an even number of cells under a profile, with the claim that the cells of each
/// pair exclude each other.
pub fn cells(count: usize, profile: &str) -> String {
    let mut text = format!("profile {profile}\nscan 10ms\n");
    for c in 1..=count {
        text += &format!("input a{c}, b{c}, c{c}, d{c}, e{c} : BOOL\n");
    }
    text += "chart G {\n";
    for c in 1..=count {
        let s = |k: usize| c * 10 + k;
        let pair = 10_000 + c.div_ceil(2);
        if c % 2 == 1 {
            text += &format!("  initial step {pair}\n");
        }
        text += &format!("  initial step {}\n", s(1));
        (2..=5).for_each(|k| text += &format!("  step {}\n", s(k)));
        text += &format!("  {} -> {} when a{c}\n", s(1), s(2));
        text += &format!("  ({}, {pair}) -> {} when b{c} priority {c}\n", s(2), s(3));
        text += &format!("  {} -> {} when c{c}\n", s(3), s(4));
        text += &format!("  {} -> ({}, {pair}) when d{c}\n", s(4), s(5));
        text += &format!("  {} -> {} when e{c}\n", s(5), s(1));
    }
    text += "}\n";
    for c in (1..count).step_by(2) {
        let held = |c: usize| format!("(X{} or X{})", c * 10 + 3, c * 10 + 4);
        text += &format!("prove never {} and {}\n", held(c), held(c + 1));
    }
    text
}
