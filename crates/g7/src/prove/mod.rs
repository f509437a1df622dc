//! `g7 prove`: asks every question of charts, and prints each answer with what shows it.
//! `g7 compare`: two charts, or one under two profiles, beside each other.

mod apart;
mod output;
mod trace;
mod words;

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use g7_host::{Clock, WallClock};
use g7_model::Nanos;
use g7_rig::Source;
use g7_verify::{Budget, Evidence, Layer, Model, Question, Turns, Verdict, ask};

pub(crate) use apart::compare;

use output::Answered;

use crate::cli::{Format, Prove};
use crate::failure::{self, Failure};
use crate::message::talk;
use crate::report::{self, Tally};
use crate::{files, sources};

pub(crate) fn prove(args: &Prove) -> Result<failure::Verdict, Failure> {
    let paths = files::all(&args.paths)?;
    let stop = stop(args.time)?;
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
        let bytes = args.memory.saturating_mul(1 << 20);
        let budget = Budget { states: args.states, scans: usize::MAX, bytes, stop: &*stop };
        Turns.answer(&model, &asked.questions, &mut answers, &budget);
        let drawer = trace::Drawer::new(&source, args.profile)?;
        for (question, verdict) in asked.questions.iter().zip(answers) {
            let Some(verdict) = verdict else { continue };
            all.push(answered(&source, &model, question, verdict, drawer.as_ref()));
        }
    }
    match args.format {
        Format::Text => output::text(&all, args.all)?,
        Format::Json => output::json(&all)?,
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
    let (own, claim) = words::claim(source, model.compiled, question);
    let run = match &verdict {
        Verdict::Refuted(Evidence::Run(run)) => Some(run),
        _ => None,
    };
    let drawn = run.zip(drawer).map(|(run, drawer)| drawer.draw(&run.moves)).unwrap_or_default();
    Answered { place: source.place(question.at), claim, own, verdict, chronogram: drawn.0, time: drawn.1 }
}

/// Tells when the time is over or Ctrl-C was pressed; what is known by then is printed.
fn stop(time: Nanos) -> Result<Arc<dyn Fn() -> bool + Send + Sync>, Failure> {
    let pressed = Arc::new(AtomicBool::new(false));
    for signal in [signal_hook::consts::SIGINT, signal_hook::consts::SIGTERM] {
        signal_hook::flag::register_conditional_default(signal, pressed.clone())?;
        signal_hook::flag::register(signal, pressed.clone())?;
    }
    let clock = Mutex::new(WallClock::default());
    Ok(Arc::new(move || {
        pressed.load(Ordering::Relaxed) || clock.lock().unwrap_or_else(PoisonError::into_inner).now() >= time
    }))
}
