//! `g7 prove`: asks every question of charts, and prints each answer with what shows it.
//! `g7 compare`: two charts, or one under two profiles, beside each other.

mod added;
mod apart;
mod cover;
mod graph;
mod made;
mod output;
mod patience;
mod process;
mod sarif;
mod save;
mod shard;
mod trace;
mod workers;

use g7_model::Problem;
use g7_rig::Source;
use g7_rig::testing::plants;
use g7_verify::{Budget, Evidence, Model, Question, Verdict, answer, ask, ask_with, words};

pub(crate) use apart::compare;
pub(crate) use graph::{Graph, graph};
pub(crate) use shard::{Part, part};

use output::Answered;
use patience::Patience;

use crate::cli::{Answers, Prove, Shared};
use crate::failure::{self, Failure};
use crate::message::talk;
use crate::report::{self, Tally};
use crate::{files, sources};

pub(crate) fn prove(args: &Prove) -> Result<failure::Verdict, Failure> {
    let paths = files::all(&args.paths)?;
    made::one_file(args, &paths)?;
    process::refuse(args, &paths)?;
    let patience = Patience::new()?;
    let shared = &args.shared;
    if process::is_shared(shared) && shared.process.is_none() {
        return workers::run(args, &*patience.pressed());
    }
    if shared.child {
        patience.until_input_ends()?;
    }
    let stop = patience.within(args.time);
    let (mut all, mut tally, mut count) = (Vec::new(), Tally::default(), 0);
    let mut printed = 0;
    for path in &paths {
        let source = sources::load(path, 0)?;
        let bytes = args.memory.saturating_mul(1 << 20);
        let budget = Budget { states: args.states, scans: usize::MAX, bytes, stop: &*stop };
        let mut file = File {
            source: &source,
            args,
            budget,
            patience: &patience,
            drawer: None,
            contradicts: false,
            asked: &mut count,
            all: &mut all,
        };
        let problems = file.prove()?;
        let contradicts = file.contradicts;
        let mine = Tally::of(&problems);
        if mine.errors > 0 && !is_silent(shared) {
            talk!("{}", report::text(&source, &problems).trim_end());
        }
        tally.add(mine);
        tally.errors += usize::from(contradicts);
        if shared.shard.is_some() {
            output::lines(all.get(printed..).unwrap_or(&[]))?;
            printed = all.len();
        }
    }
    match args.format {
        _ if shared.shard.is_some() => {}
        // Process 0 has all answers, and prints them.
        _ if is_silent(shared) => return Ok(failure::Verdict::Fine),
        Answers::Text => output::text(&all, args.all)?,
        Answers::Json => output::json(&all)?,
        Answers::Sarif => sarif::print(&all, args.all)?,
    }
    if let Some(path) = &args.junit {
        files::write(path, output::junit(&all).as_bytes())?;
    }
    let refuted = all.iter().any(|a| matches!(a.verdict, Verdict::Refuted(_)));
    let open = all.iter().any(|a| matches!(a.verdict, Verdict::Open(_)));
    Ok(match (tally.errors > 0 || refuted, open) {
        (true, _) => failure::Verdict::Found,
        (false, true) => failure::Verdict::Open,
        (false, false) => failure::Verdict::Fine,
    })
}

/// True for a process of a shared search that has others print the answers.
fn is_silent(shared: &Shared) -> bool {
    shared.process.is_some_and(|me| me > 0)
}

/// A file with the answers to its questions.
struct File<'a> {
    source: &'a Source,
    args: &'a Prove,
    budget: Budget<'a>,
    patience: &'a Patience,
    drawer: Option<trace::Drawer>,
    /// The assumptions contradict each other.
    contradicts: bool,
    /// The number of questions asked so far, in all files.
    asked: &'a mut usize,
    all: &'a mut Vec<Answered>,
}

impl File<'_> {
    /// Answers the questions of the file; gives the problems of its text.
    fn prove(&mut self) -> Result<Vec<Problem>, Failure> {
        let (source, args) = (self.source, self.args);
        let mut problems = source.problems.clone();
        if source.has_errors() {
            return Ok(problems);
        }
        let profile = args.profile;
        self.drawer = trace::Drawer::new(source, profile)?;
        let mut saved = save::Saved::default();
        if args.plant.is_none() {
            let (asked, found) = ask(&source.document, profile);
            problems.extend(found);
            let Some(asked) = asked else { return Ok(problems) };
            let model = Model::new(&asked.compiled, asked.assume.clone());
            let answers = match process::is_shared(&args.shared) {
                true => process::answer(args, source, &asked, &model, &self.budget)?,
                false => self.ask(&model, &asked.questions),
            };
            if is_silent(&args.shared) {
                return Ok(problems);
            }
            self.take(&model, &asked.questions, &answers, None);
            let given: Vec<_> = answers.iter().filter(|a| a.is_some()).cloned().collect();
            if made::contradiction(source, &model, profile, &given, &self.budget)? {
                self.contradicts = true;
            }
            if args.save.is_some()
                && let Some(bench) = trace::bench(source, profile)?
            {
                let answered = (&*asked.questions, &*answers);
                save::tests(&mut saved, source, &bench, &model, answered, profile)?;
            }
            made::scenarios(args, source, &asked, &answers, self.patience)?;
        }
        let plants = match &args.plant {
            Some(plant) => vec![plant.as_str()],
            None => plants(&source.document),
        };
        for plant in plants {
            let (closed, found) = ask_with(source, profile, plant, args.plant.is_some())?;
            problems.extend(found.into_iter().filter(|p| !problems.contains(p)).collect::<Vec<_>>());
            if let Some(closed) = closed {
                let model = closed.model();
                if process::is_shared(&args.shared) {
                    talk!("the questions with {plant} are not shared: process 0 answers them alone");
                }
                let answers = self.ask(&model, &closed.questions);
                self.take(&model, &closed.questions, &answers, args.plant.as_deref());
                if args.save.is_some() {
                    let answered = (&*closed.questions, &*answers);
                    save::tests(&mut saved, source, &closed.bench, &model, answered, profile)?;
                }
            }
        }
        made::saved(args, source, &saved)?;
        Ok(problems)
    }

    /// Answers the questions about a model; with `--shard` those of the part alone.
    fn ask(&mut self, model: &Model<'_>, questions: &[Question]) -> Vec<Option<Verdict>> {
        let first = *self.asked;
        *self.asked += questions.len();
        let is_mine = |k: &usize| self.args.shared.shard.is_none_or(|part| part.has(first + k));
        let mine: Vec<usize> = (0..questions.len()).filter(is_mine).collect();
        let picked: Vec<Question> = mine.iter().filter_map(|k| questions.get(*k)).cloned().collect();
        let mut found = vec![None; picked.len()];
        if !picked.is_empty() {
            answer(model, &picked, &mut found, &self.budget);
        }
        let mut answers = vec![None; questions.len()];
        for (k, verdict) in mine.into_iter().zip(found) {
            answers.get_mut(k).into_iter().for_each(|a| *a = verdict.clone());
        }
        answers
    }

    /// Takes answers for print; those of every chart name their plant.
    fn take(
        &mut self,
        model: &Model<'_>,
        questions: &[Question],
        answers: &[Option<Verdict>],
        plant: Option<&str>,
    ) {
        for (question, verdict) in questions.iter().zip(answers) {
            let Some(verdict) = verdict.clone() else { continue };
            let mut one = answered(self.source, model, question, verdict, self.drawer.as_ref());
            if let Some(plant) = plant.filter(|_| !one.own) {
                one.claim = format!("{} with {plant}", one.claim);
            }
            self.all.push(one);
        }
    }
}

fn answered(
    source: &Source,
    model: &Model<'_>,
    question: &Question,
    verdict: Verdict,
    drawer: Option<&trace::Drawer>,
) -> Answered {
    let written = source.text.get(source.range(question.at)).unwrap_or_default();
    let [claim, ..] = words::claim(written, model.compiled, question);
    let run = match &verdict {
        Verdict::Refuted(Evidence::Run(run)) => Some(run),
        _ => None,
    };
    let (chronogram, time) =
        run.zip(drawer).map(|(run, drawer)| drawer.draw(&run.moves, &claim)).unwrap_or_default();
    let scans = run.zip(drawer).map(|(run, drawer)| drawer.scans(&run.moves)).unwrap_or_default();
    let [reason, ..] = words::reason(&verdict, time);
    let [help, ..] = words::help(question, &verdict);
    let (own, rule) = (question.claim.is_own(), sarif::rule(&question.claim));
    let place = source.place(question.at);
    Answered { place, claim, own, reason, help, verdict, chronogram, rule, scans }
}
