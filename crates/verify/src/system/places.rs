//! Sequences of a chart: sets of steps among which a token moves, so that one of them is active and no two at
//! once, if nothing but the transitions changes them and no step is left twice in one pass.
//!
//! In the theory of Petri nets these are P-invariants with weights of 0 and 1 and one token (T. Murata,
//! "Petri nets: properties, analysis and applications", Proceedings of the IEEE, 1989). They are read from
//! the arcs alone, so they are candidates only: forcing orders, enclosures and the evolution of several
//! tokens may break them. Who uses them proves first which of them hold (`sat/kept.rs`).

use std::collections::BTreeSet;

use g7_engine::Tables;

use crate::look::sides;

/// Most sets that are looked at for one step before the next one is taken.
const TRIES: usize = 64;
/// Most steps that are marked in all searches together.
const EFFORT: usize = 10_000_000;
/// Most pairs of steps of all sequences together; the shortest sequences come first.
const PAIRS: usize = 20_000;

/// Pairs of steps of these sequences, thought never to be active at once.
pub(crate) fn exclusive(sequences: &[Vec<u32>]) -> BTreeSet<(u32, u32)> {
    let mut pairs = BTreeSet::new();
    for set in sequences {
        if pairs.len() + set.len() * set.len() / 2 > PAIRS {
            break;
        }
        for (i, a) in set.iter().enumerate() {
            pairs.extend(set.iter().skip(i + 1).map(|b| (*a, *b)));
        }
    }
    pairs
}

/// Sequences with one initial step at most, each ascending, so many that each step is in one if it can be. The
/// shortest come first.
pub(crate) fn sequences(t: &Tables) -> Vec<Vec<u32>> {
    let net = Net::new(t);
    // Each search takes a mark for each step.
    let mut left = EFFORT / t.steps.len().max(1);
    let mut covered = vec![false; t.steps.len()];
    let mut found = Vec::new();
    for step in 0..t.steps.len() as u32 {
        if covered.get(step as usize) == Some(&true) {
            continue;
        }
        if left == 0 {
            break;
        }
        left -= 1;
        let Some(set) = net.sequence(step) else { continue };
        for s in &set {
            covered.get_mut(*s as usize).into_iter().for_each(|c| *c = true);
        }
        found.push(set);
    }
    found.sort_by_key(Vec::len);
    found
}

/// The arcs of a chart.
struct Net {
    /// By transition: the steps before it and those behind it.
    sides: Vec<[Vec<u32>; 2]>,
    /// By step: the transitions that it is before or behind.
    touching: Vec<Vec<u32>>,
    /// By step: it is an initial one.
    initial: Vec<bool>,
}

/// The place of a step in a set that is being made.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Mark {
    Open,
    In,
    Out,
}

/// A set in the making, with the transitions that are to be looked at.
#[derive(Clone)]
struct Attempt {
    marks: Vec<Mark>,
    work: Vec<u32>,
    /// Initial steps in the set.
    tokens: usize,
}

impl Net {
    fn new(t: &Tables) -> Net {
        let mut touching = vec![Vec::new(); t.steps.len()];
        let mut all = Vec::new();
        for rank in 0..t.transitions.len() as u32 {
            let (mut from, mut to) = sides(t, rank);
            for list in [&mut from, &mut to] {
                list.sort_unstable();
                list.dedup();
            }
            for s in from.iter().chain(&to) {
                touching.get_mut(*s as usize).into_iter().for_each(|l| l.push(rank));
            }
            all.push([from, to]);
        }
        let mut initial = vec![false; t.steps.len()];
        for s in t.initial.iter() {
            initial.get_mut(s.0 as usize).into_iter().for_each(|i| *i = true);
        }
        Net { sides: all, touching, initial }
    }

    /// A set with this step that each transition leaves as often as it enters it, once or not at all, and that has
    /// one initial step at most.
    fn sequence(&self, step: u32) -> Option<Vec<u32>> {
        let mut first = Attempt { marks: vec![Mark::Open; self.touching.len()], work: Vec::new(), tokens: 0 };
        self.take(&mut first, step);
        let mut open = vec![first];
        for _ in 0..TRIES {
            let mut attempt = open.pop()?;
            match self.complete(&mut attempt) {
                Some(choice) if choice.is_empty() => {
                    let is_in = |s: &u32| attempt.marks.get(*s as usize) == Some(&Mark::In);
                    return Some((0..attempt.marks.len() as u32).filter(is_in).collect());
                }
                // One of these steps is the way on; the first is tried first.
                Some(choice) => open.extend(choice.into_iter().rev().map(|s| {
                    let mut next = attempt.clone();
                    self.take(&mut next, s);
                    next
                })),
                None => {}
            }
        }
        None
    }

    fn take(&self, attempt: &mut Attempt, step: u32) {
        let Some(mark) = attempt.marks.get_mut(step as usize).filter(|m| **m != Mark::In) else { return };
        *mark = Mark::In;
        attempt.tokens += usize::from(self.initial.get(step as usize) == Some(&true));
        attempt.work.extend(self.touching.get(step as usize).into_iter().flatten());
    }

    /// Adds the steps that must be in the set. Gives nothing if there is no such set, and no steps if it is
    /// complete; else the steps of which one must be added.
    fn complete(&self, attempt: &mut Attempt) -> Option<Vec<u32>> {
        while let Some(rank) = attempt.work.pop() {
            if attempt.tokens > 1 {
                return None;
            }
            let sides = self.sides.get(rank as usize)?;
            let mark = |s: &u32| attempt.marks.get(*s as usize).copied().unwrap_or(Mark::Out);
            let inside = |side: &[u32]| side.iter().filter(|s| mark(s) == Mark::In).count();
            let (before, behind) = (inside(&sides[0]), inside(&sides[1]));
            if before > 1 || behind > 1 {
                return None;
            }
            // A transition without steps behind it ends the sequence there.
            if before == 1 && sides[1].is_empty() {
                self.exclude(attempt, &sides[0]);
                continue;
            }
            let wanted = if before == 0 { &sides[0] } else { &sides[1] };
            if before + behind == 1 {
                let choice: Vec<u32> = wanted.iter().copied().filter(|s| mark(s) == Mark::Open).collect();
                match choice.as_slice() {
                    [] => return None,
                    [only] => self.take(attempt, *only),
                    _ => {
                        attempt.work.push(rank);
                        return Some(choice);
                    }
                }
            }
            sides.iter().for_each(|side| self.exclude(attempt, side));
        }
        (attempt.tokens < 2).then(Vec::new)
    }

    /// The other steps of a side of which one is in the set.
    fn exclude(&self, attempt: &mut Attempt, side: &[u32]) {
        for s in side {
            if let Some(mark) = attempt.marks.get_mut(*s as usize).filter(|m| **m == Mark::Open) {
                *mark = Mark::Out;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Model;
    use crate::sat::{Effort, Found, Proof};
    use crate::system::{Observed, system};

    /// Two cells that share a resource, each of five steps; the second holds it in its steps 23 and 24.
    fn cells(profile: &str) -> String {
        format!(
            "profile {profile}\ninput a, b, c, d, e, f, g : BOOL\nchart G {{\n  initial step 1\n  initial step 11\n  step 12\n  \
             step 13\n  step 14\n  step 15\n  initial step 21\n  step 22\n  step 23\n  step 24\n  step 25\n  11 -> 12 when a\n  \
             (12, 1) -> 13 when b priority 1\n  13 -> 14 when c\n  14 -> (15, 1) when d\n  15 -> 11 when e\n  21 -> 22 when f\n  \
             (22, 1) -> 23 when g priority 2\n  23 -> 24 when c\n  24 -> (25, 1) when d\n  25 -> 21 when e\n}}\n\
             prove never (X13 or X14) and (X23 or X24)\n"
        )
    }

    fn asked(text: &str) -> crate::ask::Asked {
        let (document, problems) = g7_syntax::parse(text, g7_model::FileId(0));
        assert!(problems.is_empty(), "{problems:?}");
        crate::ask::ask(&document, None).0.expect("a chart")
    }

    #[test]
    fn sequences_are_cells_and_what_they_share() {
        let asked = asked(&cells("iec61131"));
        let name = |s: &u32| asked.compiled.symbols.step_path(g7_engine::StepId(*s)).to_string();
        let found: Vec<Vec<String>> = sequences(asked.compiled.program.tables())
            .iter()
            .map(|l| l.iter().map(name).map(|n| n.trim_start_matches("G.").to_owned()).collect())
            .collect();
        let all = ["1 13 14 23 24", "11 12 13 14 15", "21 22 23 24 25"];
        let mut found: Vec<String> = found.into_iter().map(|l| l.join(" ").replace('X', "")).collect();
        found.sort();
        assert_eq!(found, all);
    }

    /// Where both cells can take the resource at once its sequence is broken, and the others are not.
    #[test]
    fn sequences_that_a_step_keeps_prove_at_once() {
        for (profile, safe) in [("iec61131", true), ("pl7", false)] {
            let asked = asked(&cells(profile));
            let model = Model::new(&asked.compiled, Vec::new());
            let question = asked.questions.last().cloned().expect("a question");
            let t = system(&model, &[question], Observed::Asked);
            let bad = t.asked[0].as_ref().expect("it is asked").bad;
            let effort = Effort { bytes: 1 << 28, turns: 12, stop: &|| false };
            let kept =
                crate::sat::kept(&t.system, &[], t.candidates.clone(), 1 << 30, &|| false).expect("time");
            assert_eq!(
                kept.len() == t.candidates.len(),
                safe,
                "{profile}: {} of {}",
                kept.len(),
                t.candidates.len()
            );
            assert!(kept.len() > 20, "{profile}");
            let found = crate::sat::decide_with(
                &t.system,
                &[bad],
                &crate::sat::Needs::default(),
                &t.candidates,
                &effort,
            );
            match found.first() {
                Some(Found::Never(Proof::Invariant(clauses))) => {
                    assert!(safe && clauses.len() <= t.candidates.len(), "{profile}: {clauses:?}");
                }
                Some(Found::Reached(_)) => assert!(!safe, "{profile}"),
                other => panic!("{profile}: {other:?}"),
            }
        }
    }

    /// A ring of places, each with a token that moves on when the place before it is free. Some token can always move,
    /// since each place is full or free.
    #[test]
    fn sequences_that_are_never_left_prove_that_a_token_can_move() {
        let count = 30;
        let mut text = String::from("profile iec61131\n");
        for c in 1..=count {
            text += &format!("input a{c} : BOOL\n");
        }
        text += "chart G {\n";
        let mut moves = Vec::new();
        for c in 1..=count {
            let next = c % count + 1;
            let (full, free) = if c % 2 == 1 { ("initial ", "") } else { ("", "initial ") };
            text += &format!("  {full}step {c}1\n  {free}step {c}2\n");
            text += &format!("  ({c}1, {next}2) -> ({c}2, {next}1) when a{c}\n");
            moves.push(format!("X{c}1 and X{next}2"));
        }
        text += &format!("}}\nprove always {}\n", moves.join(" or "));
        let asked = asked(&text);
        let model = Model::new(&asked.compiled, Vec::new());
        let question = asked.questions.last().cloned().expect("a question");
        let t = system(&model, &[question], Observed::Asked);
        let bad = t.asked[0].as_ref().expect("it is asked").bad;
        let effort = Effort { bytes: 1 << 28, turns: 8, stop: &|| false };
        let found =
            crate::sat::decide_with(&t.system, &[bad], &crate::sat::Needs::default(), &t.candidates, &effort);
        assert!(matches!(found[..], [Found::Never(_)]), "{found:?}");
    }
}
