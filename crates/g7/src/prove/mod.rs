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

use g7_rig::Source;
use g7_verify::{Budget, Evidence, Model, Question, Verdict, answer, ask, words};

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
        let (asked, found) =
            if source.has_errors() { (None, Vec::new()) } else { ask(&source.document, args.profile) };
        let problems: Vec<_> = source.problems.iter().cloned().chain(found).collect();
        let mine = Tally::of(&problems);
        if mine.errors > 0 {
            talk!("{}", report::text(&source, &problems).trim_end());
        }
        tally.add(mine);
        let Some(asked) = asked else { continue };
        let model = Model::new(&asked.compiled, asked.assume.clone());
        let mut answers = vec![None; asked.questions.len()];
        let budget = Budget { states: args.states, bytes: args.memory.saturating_mul(1 << 20), stop: &*stop };
        answer(&model, &asked.questions, &mut answers, &budget);
        if made::contradiction(&source, &model, args.profile, &answers, &budget)? {
            tally.errors += 1;
        }
        made::tests(args, &source, &asked, &model, &answers, &patience)?;
        let drawer = trace::Drawer::new(&source, args.profile)?;
        for (question, verdict) in asked.questions.iter().zip(answers) {
            let Some(verdict) = verdict else { continue };
            all.push(answered(&source, &model, question, verdict, drawer.as_ref()));
        }
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
