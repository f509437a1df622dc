//! `g7 prove`: asks every question of charts, and prints each answer with what shows it.
//! `g7 compare`: two charts, or one under two profiles, beside each other.

mod added;
mod apart;
mod cover;
mod graph;
mod made;
mod output;
mod patience;
mod sarif;
mod save;
mod trace;

use g7_model::Problem;
use g7_rig::Source;
use g7_rig::testing::plants;
use g7_verify::{Budget, Evidence, Model, Question, Verdict, answer, ask, ask_with, words};

pub(crate) use apart::compare;
pub(crate) use graph::{Graph, graph};

use output::Answered;
use patience::Patience;

use crate::cli::{Answers, Prove};
use crate::failure::{self, Failure};
use crate::message::talk;
use crate::report::{self, Tally};
use crate::{files, sources};

pub(crate) fn prove(args: &Prove) -> Result<failure::Verdict, Failure> {
    let paths = files::all(&args.paths)?;
    made::one_file(args, &paths)?;
    let patience = Patience::new()?;
    let stop = patience.within(args.time);
    let (mut all, mut tally) = (Vec::new(), Tally::default());
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
            all: &mut all,
        };
        let problems = file.prove()?;
        let contradicts = file.contradicts;
        let mine = Tally::of(&problems);
        if mine.errors > 0 {
            talk!("{}", report::text(&source, &problems).trim_end());
        }
        tally.add(mine);
        tally.errors += usize::from(contradicts);
    }
    match args.format {
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

/// A file with the answers to its questions.
struct File<'a> {
    source: &'a Source,
    args: &'a Prove,
    budget: Budget<'a>,
    patience: &'a Patience,
    drawer: Option<trace::Drawer>,
    /// The assumptions contradict each other.
    contradicts: bool,
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
            let answers = self.answer(&model, &asked.questions, None);
            if made::contradiction(source, &model, profile, &answers, &self.budget)? {
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
                let answers = self.answer(&model, &closed.questions, args.plant.as_deref());
                if args.save.is_some() {
                    let answered = (&*closed.questions, &*answers);
                    save::tests(&mut saved, source, &closed.bench, &model, answered, profile)?;
                }
            }
        }
        made::saved(args, source, &saved)?;
        Ok(problems)
    }

    /// Answers the questions about a model; those of every chart name their plant.
    fn answer(
        &mut self,
        model: &Model<'_>,
        questions: &[Question],
        plant: Option<&str>,
    ) -> Vec<Option<Verdict>> {
        let mut answers = vec![None; questions.len()];
        answer(model, questions, &mut answers, &self.budget);
        for (question, verdict) in questions.iter().zip(answers.clone()) {
            let Some(verdict) = verdict else { continue };
            let mut one = answered(self.source, model, question, verdict, self.drawer.as_ref());
            if let Some(plant) = plant.filter(|_| !one.own) {
                one.claim = format!("{} with {plant}", one.claim);
            }
            self.all.push(one);
        }
        answers
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
