//! Charts side by side, answered by their parts and as a whole.

use g7_model::ProfileName;
use g7_tests::generate::{Weights, sample_with};

use super::{divided, jobs, run};
use crate::divide::{Who, comes_to_rest, divide};
use crate::explicit::answer;
use crate::{Asked, Budget, Claim, Evidence, Model, Question, Reason, Verdict, ask, asks_for_traps, replay};

/// Charts with the names and numbers of one side; most of them have something to be found.
const CHARTS: [&str; 22] = [
    // Never more than two, and a claim that fails.
    "input a# : BOOL\nvar n# : INT\nchart G# { initial step #1 step #2 { P1 n# := (n# + 1) mod 3 } \
     #1 -> #2 when a# #2 -> #1 when not a# }\nprove always n# < 3\nprove never n# = 2\n",
    // A step that nobody can reach, an output that is never on.
    "input a# : BOOL\noutput q# : BOOL\nchart G# { initial step #1 step #2 step #3 { N q# } \
     #1 -> #2 when a# #2 -> #3 when a# and not a# #2 -> #1 when not a# }\n",
    // A deadlock behind two inputs.
    "input a#, b# : BOOL\nchart G# { initial step #1 step #2 step #3 step #4 #1 -> #2 when a# and not b# \
     #2 -> #3 when b# #3 -> #1 when a# #2 -> #4 when a# and b# #4 -> #1 when a# and not a# }\n",
    // A conflict, and an unsafe marking behind it.
    "input a#, b# : BOOL\nchart G# { initial step #1 step #2 step #3 #1 -> #2 when a# #1 -> #3 when b# \
     #2 -> #1 when not a# #3 -> #1 when not b# }\n",
    // An evolution without end.
    "input a#, b# : BOOL\nchart G# { initial step #1 step #2 #1 -> #2 when a# #2 -> #1 when b# }\n",
    // A division by zero.
    "input a# : BOOL\nvar n# : INT := 3\nchart G# { initial step #1 step #2 { P1 n# := 6 / (n# - 1) } \
     #1 -> #2 when a# #2 -> #1 when not a# }\n",
    // A delay.
    "input a# : BOOL\nchart G# { initial step #1 step #2 step #3 #1 -> #2 when a# #2 -> #3 when X#2.t >= T#50ms \
     #3 -> #1 when not a# }\nprove after X#2 within 60ms expect X#3\nprove X#2 leads to X#1\n",
    // Edges.
    "input a#, b# : BOOL\nchart G# { initial step #1 step #2 #1 -> #2 when ↑a# and not ↑b# #2 -> #1 when ↓b# }\n",
    // A claim that fails after some scans.
    "input a#, b# : BOOL\nchart G# { initial step #1 step #2 step #3 #1 -> #2 when a# #2 -> #3 when b# \
     #3 -> #1 when a# and b# }\nprove never X#3 and not b#\nprove after X#2 until X#1 expect a#\n",
    // At rest it comes to an end; it can also come to a step that it never leaves.
    "input a# : BOOL\nchart G# { initial step #1 step #2 step #3 #1 -> #2 when not a# #1 -> #3 when a# \
     #3 -> #1 when a# and not a# }\nprove X#1 leads to X#2\n",
    // An end.
    "input a# : BOOL\nchart G# { initial step #1 step #2 #1 -> #2 when a# }\nprove X#1 leads to X#2\n",
    // Behind step #2 each scan has a fault.
    "input a# : BOOL\nvar k# : INT\nchart G# { initial step #1 step #2 step #3 #1 -> #2 when a# \
     #2 -> #3 when 6 / k# > 0 }\nprove X#1 leads to X#2\n",
    // In step #2 no input satisfies the assumption.
    "input a# : BOOL\nchart G# { initial step #1 step #2 #1 -> #2 when a# #2 -> #1 when not a# }\n\
     assume not X#2 or (a# and not a#)\nprove X#2 leads to X#1\n",
    // An assumption about the inputs of one side.
    "input a#, b# : BOOL\nchart G# { initial step #1 step #2 #1 -> #2 when a# #2 -> #1 when b# }\n\
     assume not (a# and b#)\nprove X#2 leads to X#1\n",
    // A forcing order.
    "input a#, b# : BOOL\nchart F# { initial step #5 step #6 { force G# := {#2} } #5 -> #6 when a# \
     #6 -> #5 when not a# }\nchart G# { initial step #1 step #2 step #3 #1 -> #2 when b# #2 -> #3 when b# \
     #3 -> #1 when not b# }\nprove never X#6 and X#3\nprove X#6 leads to X#3\n",
    // Two orders that disagree.
    "input a#, b# : BOOL\nchart F# { initial step #5 step #6 { force G# := {#2} } #5 -> #6 when a# \
     #6 -> #5 when not a# }\nchart H# { initial step #7 step #8 { force G# := {#1} } #7 -> #8 when b# \
     #8 -> #7 when not b# }\nchart G# { initial step #1 step #2 #1 -> #2 when b# #2 -> #1 when not b# }\n",
    // An enclosing step.
    "input a#, b# : BOOL\nchart E# { initial step #5 enclosing step #6 { enclose G# } #5 -> #6 when a# \
     #6 -> #5 when not a# }\nchart G# { step #1 * step #2 #1 -> #2 when b# #2 -> #1 when not b# }\n\
     prove never X#5 and X#2\n",
    // A macro-step.
    "input a#, b# : BOOL\nchart G# { initial step #1 macro M#2 = E# #1 -> M#2 when a# M#2 -> #1 when not a# }\n\
     macrochart E# { entry step #3 exit step #4 #3 -> #4 when b# }\nprove never XM#2 and X#1\n",
    // Actions that are stored and delayed.
    "input a#, b# : BOOL\noutput q#, r# : BOOL\nchart G# { initial step #1 { R q# } step #2 { S q# } \
     step #3 { L 30ms r# } #1 -> #2 when a# #2 -> #3 when b# #3 -> #1 when not b# }\nprove never r# and X#1\n",
    // A source and a sink, and an action on clearing that changes nothing the second time.
    "input a#, b# : BOOL\nvar n# : INT\nchart G# { initial step #1 step #2 () -> #1 when a# on clearing { n# := 1; } \
     #1 -> #2 when b# #2 -> () when not b# }\nprove never n# = 1 and X#2\n",
    // A function block before each scan.
    "input a#, b# : BOOL\nvar f# : TON\npre { f#(IN := a#, PT := 30ms); }\nchart G# { initial step #1 step #2 \
     #1 -> #2 when f#.Q #2 -> #1 when not a# and b# }\nprove after X#2 within 50ms expect X#1\n",
    // A condition that no value has: which of two faults comes first.
    "input a#, b# : BOOL\nvar n# : INT := 2\nchart G# { initial step #1 step #2 { P1 n# := n# - 1 } \
     #1 -> #2 when a# and 6 / n# > 1 #2 -> #1 when b# and 6 / n# > 1 }\nprove X#2 leads to X#1\n",
];

const PROFILES: [&str; 5] = ["iec60848", "iec61131", "pl7", "unity", "jgrafchart"];

/// Both charts in one file. Nothing, where the profile refuses it.
fn asked(profile: &str, one: &str, two: &str) -> Option<Asked> {
    let of = |text: &str, side: &str| -> Vec<String> {
        // `T#50ms` is no name.
        text.replace("T#", "T~").replace('#', side).replace("T~", "T#").lines().map(str::to_owned).collect()
    };
    let mut lines = [of(one, "1"), of(two, "2")].concat();
    let rank =
        |l: &String| ["pre", "macro", "chart", "assume", "prove"].iter().position(|w| l.starts_with(w));
    lines.sort_by_key(rank);
    if profile == "jgrafchart" {
        // Its step times count scans.
        lines.iter_mut().for_each(|l| *l = l.replace(">= T#50ms", ">= 5"));
    }
    let text = format!("profile {profile}\nscan 10ms\n{}\n", lines.join("\n"));
    let (document, problems) = g7_syntax::parse(&text, Default::default());
    assert!(problems.is_empty(), "{problems:?}\n{text}");
    ask(&document, None).0
}

fn letter(v: &Verdict) -> String {
    match v {
        Verdict::Proved(Evidence::Run(r)) => format!("proved {}", r.moves.len()),
        Verdict::Refuted(Evidence::Run(r)) => format!("refuted {}", r.moves.len()),
        Verdict::Proved(_) => "proved".to_owned(),
        Verdict::Refuted(_) => "refuted".to_owned(),
        Verdict::Open(_) => "open".to_owned(),
    }
}

/// The parts decide nothing that the whole decides otherwise, and show only runs that are repeated. Gives the
/// number of their answers, and of those that the whole has as well.
fn agree(text: &str, asked: &Asked, budget: &Budget<'_>) -> (usize, usize) {
    let model = Model::new(&asked.compiled, asked.assume.clone());
    let all: Vec<(usize, &Question)> = asked.questions.iter().enumerate().collect();
    let parts = divided(&model, &all, budget, 1);
    if parts.is_empty() {
        return (0, 0);
    }
    let whole = run(&model, &jobs(&all, None), budget, 1);
    let whole: Vec<_> = whole.into_iter().flat_map(|f| f.answers).collect();
    let mut both = 0;
    for (n, verdict) in &parts {
        let (_, expected) = whole.iter().find(|(m, _)| m == n).expect("all are answered");
        let claim = &asked.questions[*n].claim;
        match expected {
            // A state from which no input leads on cuts runs, so it breaks no other claim than these.
            Verdict::Open(open) if matches!(open.reason, Reason::NoInput(_)) => {
                assert!(
                    !asks_for_traps(claim) || matches!(verdict, Verdict::Refuted(_)),
                    "{claim:?}\n{text}"
                );
            }
            Verdict::Open(_) => {}
            _ => {
                assert_eq!(letter(verdict), letter(expected), "{claim:?}\n{text}");
                both += 1;
            }
        }
        if let Verdict::Proved(Evidence::Run(r)) | Verdict::Refuted(Evidence::Run(r)) = verdict {
            assert!(replay(&model, claim, r), "{claim:?}\n{text}");
        }
    }
    (parts.len(), both)
}

#[test]
fn parts_answer_as_the_whole_does() {
    let budget = Budget { states: 100_000, scans: usize::MAX, bytes: 1 << 30, stop: &|| false };
    let (mut charts, mut answers) = (0, 0);
    for profile in PROFILES {
        for (i, one) in CHARTS.iter().enumerate() {
            for two in CHARTS.iter().skip(i) {
                let Some(asked) = asked(profile, one, two) else { continue };
                let (found, both) = agree(&format!("{profile}\n{one}{two}"), &asked, &budget);
                charts += usize::from(found > 0);
                answers += both;
            }
        }
    }
    println!("{charts} charts, {answers} answers");
    assert!(charts > 120 && answers > 2000, "{charts} charts, {answers} answers");
}

/// A claim about the charts of two sides, with the letter of its verdict by parts; none if they do not decide it.
fn of_parts(one: usize, two: usize, is: impl Fn(&Claim) -> bool) -> Vec<Option<String>> {
    let budget = Budget { states: 100_000, scans: usize::MAX, bytes: 1 << 30, stop: &|| false };
    let each = PROFILES.into_iter().map(|profile| {
        let asked = asked(profile, CHARTS[one], CHARTS[two])?;
        let model = Model::new(&asked.compiled, asked.assume.clone());
        let all: Vec<(usize, &Question)> = asked.questions.iter().enumerate().collect();
        let parts = divided(&model, &all, &budget, 1);
        assert!(!parts.is_empty(), "{profile}");
        let (mine, _) = all.iter().find(|(_, q)| is(&q.claim)).expect("it is asked");
        Some(parts.iter().find(|(n, _)| n == mine).map(|(_, v)| letter(v)))
    });
    let found: Vec<_> = each.flatten().collect();
    assert!(found.len() > 2, "most profiles know these charts");
    found
}

/// One chart at its end, and the other in a step that it never leaves: that is a deadlock, though the other would
/// be at its end at rest.
#[test]
fn an_end_of_one_part_is_no_end_of_all() {
    let found = of_parts(10, 9, |c| *c == Claim::NoDeadlock);
    assert!(found.iter().all(Option::is_none), "{found:?}");
}

/// The first part leads on for ever by itself, but in no scan of a state in which the second only has a fault.
#[test]
fn a_part_goes_on_only_where_the_others_have_no_fault() {
    let leads = |c: &Claim| matches!(c, Claim::LeadsTo { .. });
    // Under search for stability the fault comes in the scan that reaches the step: it is no state.
    let found = of_parts(13, 11, leads);
    assert!(found.iter().skip(1).all(Option::is_none), "{found:?}");
    assert!(of_parts(13, 12, leads).iter().all(Option::is_none));
    assert!(of_parts(13, 12, |c| *c == Claim::NoDeadlock).iter().all(Option::is_none));
    let found = of_parts(13, 13, leads);
    assert!(found.iter().flatten().any(|l| l == "proved"), "{found:?}");
}

/// A random chart whose names end with a letter of its own. Steps are known by their charts.
fn side(seed: u64, profile: ProfileName, weights: &Weights, letter: char) -> Option<String> {
    let text = sample_with(seed, profile, 1, weights).ok()?.text;
    let mut out = String::new();
    let mut chars = text.lines().skip(2).flat_map(|l| l.chars().chain(['\n'])).peekable();
    let (mut word, mut before) = (String::new(), ' ');
    while let Some(c) = chars.next() {
        if c == '\'' {
            // A text is no name.
            out.push(c);
            out.extend(chars.by_ref().take_while(|c| *c != '\''));
            out.push(c);
            before = c;
        } else if c.is_ascii_alphanumeric() || c == '_' {
            word.push(c);
            if !chars.peek().is_some_and(|c| c.is_ascii_alphanumeric() || *c == '_') {
                out += &word;
                if before != '%' && is_name(&word) {
                    out.push(letter);
                }
                before = c;
                word.clear();
            }
        } else {
            out.push(c);
            before = c;
        }
    }
    Some(out.replace("Gear_TO_INT", &format!("Gear{letter}_TO_INT")))
}

/// The names of types with a name, and of what is declared of them.
const NAMED: [&str; 14] = [
    "Gear", "Turn", "Turns", "Low", "Middle", "High", "gear", "gears", "spin", "turns", "rows", "high",
    "shown", "Gears",
];

/// True for the names that random documents give to variables, charts and sections.
fn is_name(word: &str) -> bool {
    let stem = word.trim_end_matches(|c: char| c.is_ascii_digit());
    match word.len() - stem.len() {
        0 => {
            ["a", "b", "c", "d", "n", "r", "x", "w", "s", "K", "Sum", "Odd", "Ready"].contains(&word)
                || NAMED.contains(&word)
        }
        _ => ["m", "k", "f", "Q", "G", "Exp", "Task", "Act"].contains(&stem),
    }
}

/// A random chart that is one side of a file: its text and claims about it.
fn side_of(seed: u64, profile: ProfileName, letter: char) -> Option<(String, String)> {
    let stable = is_stable(profile);
    let weights = Weights { switches: 0, sections: 0, periods: 3, moments: !stable, ..Weights::default() };
    let text = side(seed, profile, &weights, letter)?;
    let mut claims = format!("prove never a{letter} and Q0{letter}\nprove a{letter} leads to Q0{letter}\n");
    claims += &format!("prove Q0{letter} leads to not Q0{letter}\nprove b{letter} leads to not Q0{letter}\n");
    claims += &format!("prove after Q1{letter} within 40ms expect b{letter}\n");
    claims += &format!("prove after Q1{letter} until b{letter} expect not Q0{letter}\n");
    if seed.is_multiple_of(4) {
        claims += &format!("assume not (a{letter} and b{letter})\n");
    }
    Some((text, claims))
}

fn is_stable(profile: ProfileName) -> bool {
    profile == ProfileName::Iec60848
}

/// Some sides in one file; nothing where a check refuses them.
fn file_of(profile: ProfileName, sides: &[(String, String)]) -> Option<(String, Asked)> {
    let switch = if is_stable(profile) { " { bound 60 }" } else { "" };
    let mut text = format!("profile {}{switch}\nscan 10ms\n", profile.name());
    sides.iter().for_each(|(charts, _)| text += charts);
    sides.iter().for_each(|(_, claims)| text += claims);
    let (document, problems) = g7_syntax::parse(&text, Default::default());
    assert!(problems.is_empty(), "{problems:?}\n{text}");
    let asked = ask(&document, None).0?;
    Some((text, asked))
}

/// Two or three of those random charts that come to rest, so that the search may divide them.
#[test]
fn random_charts_side_by_side() {
    #[allow(clippy::disallowed_methods, reason = "how much a test does is told by its environment")]
    let count = std::env::var("G7_CHARTS").ok().and_then(|v| v.parse().ok()).unwrap_or(40u64);
    let budget = Budget { states: 2_000, scans: 6_000, bytes: 1 << 28, stop: &|| false };
    let (mut charts, mut answers) = (0, 0);
    for profile in ProfileName::ALL {
        let rests = |seed: &u64| {
            let side = side_of(*seed, profile, 'u');
            // A chart with loops is never divided.
            let plain =
                side.filter(|(text, _)| !["FOR ", "WHILE ", "REPEAT "].iter().any(|w| text.contains(w)));
            let file = plain.and_then(|side| file_of(profile, &[side]));
            file.is_some_and(|(_, asked)| comes_to_rest(&Model::new(&asked.compiled, asked.assume.clone())))
        };
        // Without edges, most random events are refused.
        let tried = count * if is_stable(profile) { 8 } else { 2 };
        let pool: Vec<u64> = (1..=tried).filter(rests).collect();
        let (mut divided, mut both) = (0, 0);
        for (k, seeds) in pool.windows(3).enumerate() {
            let seeds = seeds.get(..2 + usize::from(k % 4 == 0)).unwrap_or(&[]);
            let sides: Option<Vec<_>> =
                seeds.iter().zip(['u', 'v', 'z']).map(|(seed, l)| side_of(*seed, profile, l)).collect();
            let Some((text, asked)) = sides.and_then(|s| file_of(profile, &s)) else { continue };
            let (found, same) = agree(&text, &asked, &budget);
            divided += usize::from(found > 0);
            both += same;
        }
        println!(
            "{}: {} come to rest, {divided} divided, {both} answers of both",
            profile.name(),
            pool.len()
        );
        (charts, answers) = (charts + divided, answers + both);
    }
    assert!(charts > 10 && answers > 100, "{charts} charts, {answers} answers");
}

#[test]
fn the_number_of_searches_at_a_time_changes_no_answer() {
    for (one, two) in [(CHARTS[6], CHARTS[8]), (CHARTS[8], CHARTS[2])] {
        let asked = asked("iec60848", one, two).expect("it has no error");
        let model = Model::new(&asked.compiled, asked.assume.clone());
        for scans in [300, usize::MAX] {
            let budget = Budget { states: 100_000, scans, bytes: 1 << 30, stop: &|| false };
            let of = |threads| {
                let mut answers = vec![None; asked.questions.len()];
                answer(&model, &asked.questions, &mut answers, &budget, threads);
                answers
            };
            assert_eq!(of(1), of(2));
            assert_eq!(of(1), of(5));
        }
    }
}

/// Five pairs that share nothing: 4 million situations together, 21 each.
#[test]
fn a_question_about_a_pair_is_answered_by_the_pair() {
    let mut text = "profile iec61131\n".to_owned();
    let mut charts = String::new();
    for k in 1..=8 {
        text += &format!("input a{k}, b{k}, c{k} : BOOL\n");
        charts += &format!(
            "chart G{k} {{ initial step {k}1 step {k}2 step {k}3 {k}1 -> {k}2 when a{k} {k}2 -> {k}3 when b{k} \
             {k}3 -> {k}1 when c{k} }}\n"
        );
    }
    text += &charts;
    text += "prove never X11 and X13\n";
    let (document, _) = g7_syntax::parse(&text, Default::default());
    let asked = ask(&document, None).0.expect("it has no error");
    let model = Model::new(&asked.compiled, Vec::new());
    let all: Vec<&Question> = asked.questions.iter().collect();
    let division = divide(&model, &all).expect("it has parts");
    assert_eq!(division.inputs.len(), 8);
    assert!(!division.who.contains(&Who::Nobody), "{:?}", division.who);
    let all: Vec<(usize, &Question)> = asked.questions.iter().enumerate().collect();
    let budget = Budget { states: 1000, scans: 10_000, bytes: 1 << 20, stop: &|| false };
    assert_eq!(divided(&model, &all, &budget, 2).len(), all.len());
}
