//! The questions of one file with their answers, as `g7 prove` prints them.

use std::path::Path;

use g7_model::{Nanos, Problem, Said, say};
use g7_rig::Source;
use g7_rig::testing::plants;
use g7_verify::{Budget, Evidence, Model, Question, Verdict, answer, ask, ask_with, is_open, words};

use super::found::{Answered, Found};
use super::made;
use super::patience::{Patience, Phase, Progress, Share, Stop};
use super::{guilt, process, sarif, save, trace};
use crate::cli::{Answers, Prove};
use crate::failure::Failure;
use crate::message::tell;
use crate::report::{self, Tally};
use crate::sources;

/// The work on a file.
pub(super) struct Work {
    pub(super) args: Prove,
    /// The number of the file among all.
    pub(super) number: usize,
    pub(super) patience: Patience,
    pub(super) time: Share,
    pub(super) progress: Progress,
}

impl Work {
    /// Asks a file all of its questions.
    pub(super) fn prove(&self, path: &Path) -> Result<Found, Failure> {
        self.progress.enter(Phase::Read);
        let source = sources::load(path, 0)?;
        let mut file =
            File { source: &source, work: self, drawer: None, asked: self.number, found: Found::default() };
        file.found.name.clone_from(&source.name);
        let problems = file.prove()?;
        let mut found = file.found;
        let mine = Tally::of(&problems);
        if mine.errors > 0 {
            let text = report::text(&source, &problems);
            found.trouble.insert_str(0, text.trim_end());
        }
        found.tally.add(mine);
        Ok(found)
    }

    fn budget<'s>(&self, stop: &'s Stop) -> Budget<'s> {
        let bytes = self.args.memory.saturating_mul(1 << 20);
        Budget { states: self.args.states, scans: usize::MAX, bytes, stop: &**stop }
    }

    /// True if each question is to be told, also those that are not decided for one reason.
    fn tells_all(&self) -> bool {
        let args = &self.args;
        args.all || args.answers() != Answers::Text || args.junit.is_some() || args.shared.shard.is_some()
    }
}

/// A file with the answers to its questions.
struct File<'a> {
    source: &'a Source,
    work: &'a Work,
    /// Made for the first run that is drawn.
    drawer: Option<trace::Drawer>,
    /// The number of the next question, for those who answer a part of all.
    asked: usize,
    found: Found,
}

impl File<'_> {
    /// Answers the questions of the file; gives the problems of its text.
    fn prove(&mut self) -> Result<Vec<Problem>, Failure> {
        let (source, work) = (self.source, self.work);
        let args = &work.args;
        let mut problems = source.read_problems();
        if source.is_broken() {
            return Ok(problems);
        }
        let profile = args.profile;
        let mut saved = save::Saved::default();
        let plants = match &args.plant {
            Some(plant) => vec![plant.as_str()],
            None => plants(&source.document),
        };
        if args.plant.is_none() {
            work.progress.enter(Phase::Compile);
            let (asked, found) = ask(source.whole(), profile);
            problems.extend(source.about(found));
            let Some(asked) = asked else { return Ok(problems) };
            let model = Model::new(&asked.compiled, asked.assume.clone());
            // The charts alone have no more than their part, so that there is time for those with plants.
            self.work.progress.search(asked.questions.len());
            let answers = if process::is_shared(&args.shared) {
                let stop = work.patience.within(work.time.part(plants.len() + 1));
                let answers = process::answer(args, source, &asked, &model, &work.budget(&stop))?;
                self.found.is_stopped |= stop() && answers.iter().any(is_open);
                answers
            } else {
                self.search(&model, &asked.questions, plants.len() + 1)
            };
            if args.shared.is_silent() {
                return Ok(problems);
            }
            self.tell(&model, &asked.questions, &answers, None)?;
            let stop = work.time.stop();
            let budget = work.budget(&stop);
            let given: Vec<_> = answers.iter().filter(|a| a.is_some()).cloned().collect();
            if let Some(text) = made::contradiction(source, &model, profile, &given, &budget)? {
                self.found.tally.errors += 1;
                self.found.trouble.push_str(&text);
            }
            if args.save.is_some()
                && let Some(bench) = trace::bench(source, profile)?
            {
                let answered = (&*asked.questions, &*answers);
                save::tests(&mut saved, source, &bench, &model, answered, profile)?;
            }
            made::scenarios(args, source, &asked, &answers, &work.patience)?;
        }
        for (plant, models) in plants.iter().zip((1..=plants.len()).rev()) {
            let (closed, found) = ask_with(source, profile, plant, args.plant.is_some())?;
            problems.extend(found.into_iter().filter(|p| !problems.contains(p)).collect::<Vec<_>>());
            if let Some(closed) = closed {
                let model = closed.model();
                if process::is_shared(&args.shared) {
                    tell(say!("the questions with `{plant}` are not shared: process 0 answers them alone"));
                }
                let answers = self.search(&model, &closed.questions, models);
                self.tell(&model, &closed.questions, &answers, args.plant.as_deref())?;
                if args.save.is_some() {
                    let answered = (&*closed.questions, &*answers);
                    save::tests(&mut saved, source, &closed.bench, &model, answered, profile)?;
                }
            }
        }
        made::saved(args, source, &saved)?;
        Ok(problems)
    }

    /// Answers the questions about a model, the first of so many that are left; with `--shard` those of the
    /// part alone.
    fn search(&mut self, model: &Model<'_>, questions: &[Question], models: usize) -> Vec<Option<Verdict>> {
        let (first, shard) = (self.asked, self.work.args.shared.shard);
        self.asked += questions.len();
        let is_mine = |k: &usize| shard.is_none_or(|part| part.has(first + k));
        let mine: Vec<usize> = (0..questions.len()).filter(is_mine).collect();
        let picked: Vec<Question> = mine.iter().filter_map(|k| questions.get(*k)).cloned().collect();
        self.work.progress.search(picked.len());
        let mut found = vec![None; picked.len()];
        let stop = self.work.patience.within(self.work.time.part(models));
        if !picked.is_empty() {
            answer(model, &picked, &mut found, &self.work.budget(&stop));
        }
        self.found.is_stopped |= stop() && found.iter().any(is_open);
        let mut answers = vec![None; questions.len()];
        for (k, verdict) in mine.into_iter().zip(found) {
            answers.get_mut(k).into_iter().for_each(|a| a.clone_from(&verdict));
        }
        answers
    }

    /// Puts answers into words; those of every chart name their plant.
    fn tell(
        &mut self,
        model: &Model<'_>,
        questions: &[Question],
        answers: &[Option<Verdict>],
        plant: Option<&str>,
    ) -> Result<(), Failure> {
        self.work.progress.enter(Phase::Tell);
        for (question, verdict) in questions.iter().zip(answers) {
            let Some(verdict) = verdict else { continue };
            if let Verdict::Open(open) = verdict
                && !question.claim.is_own()
                && !self.work.tells_all()
                && self.found.hides(open, verdict, sarif::rule(&question.claim))
            {
                continue;
            }
            let mut one = self.answered(model, question, verdict)?;
            if let Some(plant) = plant.filter(|_| !one.own) {
                one.claim = say!("{} with {}", one.claim, Said::foreign(plant));
            }
            self.found.answers.push(one);
        }
        Ok(())
    }

    fn answered(
        &mut self,
        model: &Model<'_>,
        question: &Question,
        verdict: &Verdict,
    ) -> Result<Answered, Failure> {
        let source = self.source;
        let written = source.written(question.at);
        let claim = Said::in_each(words::claim(written, model.compiled, question));
        let run = match verdict {
            Verdict::Refuted(Evidence::Run(run)) => Some(run),
            _ => None,
        };
        if run.is_some() && self.drawer.is_none() {
            self.drawer = trace::Drawer::new(source, self.work.args.profile)?;
        }
        let drawn = run.zip(self.drawer.as_ref());
        let guilt = run.map(|run| guilt::guilt(model, &question.claim, run)).unwrap_or_default();
        let chronogram =
            drawn.map(|(run, d)| d.draw(&run.moves, &format!("{claim} {}", guilt.said))).unwrap_or_default();
        let scans = drawn.map(|(run, d)| d.scans(&run.moves)).unwrap_or_default();
        let why = drawn.map(|(run, d)| match guilt.names.as_slice() {
            [] => d.why(&run.moves, &trace::names(written)),
            names => d.why(&run.moves, names),
        });
        let time = match verdict {
            Verdict::Proved(Evidence::Run(run)) | Verdict::Refuted(Evidence::Run(run)) => {
                run.moves.iter().fold(0i64, |sum, m| sum.saturating_add(m.wait))
            }
            _ => 0,
        };
        let mut reason = Said::in_each(words::reason(verdict, Nanos::new(time)));
        if let Verdict::Refuted(Evidence::Certificate(_)) = verdict {
            reason = say!("no run does it: {reason}");
        }
        let help = Said::in_each(words::help(question, verdict));
        Ok(Answered {
            place: source.place(question.at),
            claim,
            own: question.claim.is_own(),
            reason,
            guilt: guilt.said,
            help,
            verdict: verdict.clone(),
            chronogram,
            rule: sarif::rule(&question.claim),
            scans,
            why: why.unwrap_or_default(),
        })
    }
}
