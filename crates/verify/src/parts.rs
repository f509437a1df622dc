//! Searches side by side: one for each question with a memory, or one for each part of a chart that
//! consists of parts. None of them knows of the others, so their number at a time changes no answer.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::divide::{Who, divide};
use crate::layer::Budget;
use crate::model::Model;
use crate::monitor::has_memory;
use crate::question::Question;
use crate::search::Search;
use crate::verdict::{Certificate, Evidence, Verdict};

/// One search.
pub(crate) struct Job<'q> {
    pub(crate) questions: Vec<(usize, &'q Question)>,
    /// The places of the inputs of a part, of a chart that is divided.
    pub(crate) inputs: Option<&'q [usize]>,
}

/// The searches for some questions: one for those without a memory, and one for each other.
pub(crate) fn jobs<'q>(questions: &[(usize, &'q Question)], inputs: Option<&'q [usize]>) -> Vec<Job<'q>> {
    let (alone, together): (Vec<_>, Vec<_>) =
        questions.iter().copied().partition(|(_, q)| has_memory(&q.claim));
    let groups = std::iter::once(together).chain(alone.into_iter().map(|q| vec![q]));
    groups.filter(|g| !g.is_empty()).map(|questions| Job { questions, inputs }).collect()
}

/// The result of a search.
pub(crate) struct Found {
    /// The answers, with the numbers of their questions.
    pub(crate) answers: Vec<(usize, Verdict)>,
    /// It made as many scans as it was allowed.
    pub(crate) short: bool,
}

/// Does all searches, so many at a time, and gives their answers in the order of the jobs.
pub(crate) fn run(model: &Model<'_>, jobs: &[Job<'_>], budget: &Budget<'_>, threads: usize) -> Vec<Found> {
    let threads = threads.clamp(1, jobs.len().max(1));
    // Each has its share of the memory.
    let budget = Budget { bytes: budget.bytes / threads, ..*budget };
    let one = |job: &Job<'_>| {
        let mut search = Search::new(model, &budget, job.questions.clone());
        search.within = job.inputs.map(<[usize]>::to_vec);
        let (answers, scans) = search.run();
        Found { answers, short: scans >= budget.scans }
    };
    if threads == 1 {
        return jobs.iter().map(one).collect();
    }
    let (next, found) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    let work = || {
        while let Some((at, job)) = {
            let at = next.fetch_add(1, Ordering::Relaxed);
            jobs.get(at).map(|job| (at, job))
        } {
            let done = one(job);
            found.lock().unwrap_or_else(|e| e.into_inner()).push((at, done));
        }
    };
    std::thread::scope(|scope| {
        (1..threads).for_each(|_| drop(scope.spawn(work)));
        work();
    });
    let mut found = found.into_inner().unwrap_or_else(|e| e.into_inner());
    found.sort_by_key(|(at, _)| *at);
    found.into_iter().map(|(_, done)| done).collect()
}

/// Answers the questions that the parts of a chart decide, if it can be divided.
pub(crate) fn divided(
    model: &Model<'_>,
    questions: &[(usize, &Question)],
    budget: &Budget<'_>,
    threads: usize,
) -> Vec<(usize, Verdict)> {
    let claims: Vec<&Question> = questions.iter().map(|(_, q)| *q).collect();
    let Some(division) = divide(model, &claims) else { return Vec::new() };
    let who = || questions.iter().zip(&division.who);
    let all: Vec<Job<'_>> = division
        .inputs
        .iter()
        .enumerate()
        .flat_map(|(k, inputs)| {
            let mine = who().filter(|(_, w)| matches!(w, Who::Each | Who::Some) || **w == Who::Part(k));
            let mine: Vec<_> = mine.map(|(q, _)| *q).collect();
            jobs(&mine, Some(inputs))
        })
        .collect();
    let found = run(model, &all, budget, threads);
    let of = |i: usize| found.iter().flat_map(|f| &f.answers).filter(move |(n, _)| *n == i).map(|(_, v)| v);
    let answers = who().filter_map(|((i, _), who)| {
        let verdict = match who {
            Who::Part(_) => of(*i).next().cloned(),
            Who::Each => each(of(*i)),
            Who::Some => of(*i).find(|v| matches!(v, Verdict::Proved(_))).cloned(),
            Who::Nobody => None,
        };
        verdict.filter(|v| !matches!(v, Verdict::Open(_))).map(|v| (*i, v))
    });
    answers.collect()
}

/// The answer for a claim that each part must keep: the shortest run that breaks it, or all proofs.
fn each<'v>(answers: impl Iterator<Item = &'v Verdict>) -> Option<Verdict> {
    let (mut shortest, mut states, mut scans, mut open) = (None, 0, 0, false);
    for a in answers {
        match a {
            Verdict::Refuted(Evidence::Run(run)) => {
                let length = run.moves.len();
                if shortest.as_ref().is_none_or(|(least, _)| length < *least) {
                    shortest = Some((length, a.clone()));
                }
            }
            Verdict::Proved(Evidence::Certificate(Certificate::Search { states: s, scans: n })) => {
                states += s;
                scans += n;
            }
            _ => open = true,
        }
    }
    // A part that is open might have a shorter run, but a run is a run.
    match shortest {
        Some((_, verdict)) if !open => Some(verdict),
        None if !open => Some(Verdict::Proved(Evidence::Certificate(Certificate::Search { states, scans }))),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::{divided, jobs, run};
    use crate::divide::{Who, divide};
    use crate::explicit::answer;
    use crate::{Asked, Budget, Evidence, Model, Question, Verdict, ask, replay};

    /// Charts with the names and numbers of one side; most of them have something to be found.
    const CHARTS: [&str; 9] = [
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
    ];

    fn asked(profile: &str, one: &str, two: &str) -> Asked {
        let of = |text: &str, side: &str| -> Vec<String> {
            // `T#50ms` is no name.
            text.replace("T#", "T~")
                .replace('#', side)
                .replace("T~", "T#")
                .lines()
                .map(str::to_owned)
                .collect()
        };
        let mut lines = [of(one, "1"), of(two, "2")].concat();
        lines.sort_by_key(|l| (l.starts_with("chart"), l.starts_with("prove")));
        if profile == "jgrafchart" {
            // Its step times count scans.
            lines.iter_mut().for_each(|l| *l = l.replace(">= T#50ms", ">= 5"));
        }
        let text = format!("profile {profile}\nscan 10ms\n{}\n", lines.join("\n"));
        let (document, problems) = g7_syntax::parse(&text, Default::default());
        assert!(problems.is_empty(), "{problems:?}\n{text}");
        let (asked, problems) = ask(&document, None);
        asked.unwrap_or_else(|| panic!("{problems:?}\n{text}"))
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

    #[test]
    fn parts_answer_as_the_whole_does() {
        let budget = Budget { states: 100_000, scans: usize::MAX, bytes: 1 << 30, stop: &|| false };
        let (mut charts, mut answers) = (0, 0);
        for profile in ["iec60848", "iec61131", "pl7", "unity", "jgrafchart"] {
            for (i, one) in CHARTS.iter().enumerate() {
                for two in CHARTS.iter().skip(i) {
                    let asked = asked(profile, one, two);
                    let model = Model::new(&asked.compiled, asked.assume.clone());
                    let all: Vec<(usize, &Question)> = asked.questions.iter().enumerate().collect();
                    let parts = divided(&model, &all, &budget, 1);
                    charts += usize::from(!parts.is_empty());
                    let whole = run(&model, &jobs(&all, None), &budget, 1);
                    let whole: Vec<_> = whole.into_iter().flat_map(|f| f.answers).collect();
                    for (n, verdict) in &parts {
                        let (_, expected) = whole.iter().find(|(m, _)| m == n).expect("all are answered");
                        let claim = &asked.questions[*n].claim;
                        assert_eq!(letter(verdict), letter(expected), "{profile} {claim:?}\n{one}{two}");
                        if let Verdict::Proved(Evidence::Run(r)) | Verdict::Refuted(Evidence::Run(r)) =
                            verdict
                        {
                            assert!(replay(&model, claim, r), "{profile} {claim:?}\n{one}{two}");
                        }
                        answers += 1;
                    }
                }
            }
        }
        assert!(charts > 120 && answers > 2000, "{charts} charts, {answers} answers");
    }

    #[test]
    fn the_number_of_searches_at_a_time_changes_no_answer() {
        for (one, two) in [(CHARTS[6], CHARTS[8]), (CHARTS[8], CHARTS[2])] {
            let asked = asked("iec60848", one, two);
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
}
