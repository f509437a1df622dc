//! How fast does the explicit search visit the states of a chart, and in how much memory?
//!
//! ```text
//! prove [--cells N] [--profile P] [--inputs one|free] [--bits THREADS] [--ask] [--text]
//! ```
//!
//! `--cells` (10) cells of `cells.rs` under `--profile` (iec60848). `--inputs one` (the default): in each
//! scan at most one input is true; `free`: any. `--bits`: the search over the system of bits, by so many
//! threads, instead of that with the engine. `--ask` answers the questions
//! of the file and those that are asked of every chart, with any inputs, instead of counting states. `--text`
//! prints the chart for other tools and ends.
//!
//! One line for a count: cells, inputs, states, scans, depth, seconds, bytes a state without and
//! with what the runs need, MB of the process at most (Linux). For `--ask`: seconds, and how many answers
//! there are of each kind.
#![allow(clippy::disallowed_methods, reason = "a stopwatch reads the clock")]

use std::time::Instant;

use g7_benches::cells::cells;
use g7_model::FileId;
use g7_verify::{Asked, Budget, Explicit, Layer, Model, Tried, Tries, Verdict, ask, visit, visit_bits};

struct Options {
    cells: usize,
    profile: String,
    free: bool,
    bits: Option<usize>,
    ask: bool,
    text: bool,
}

fn main() {
    let o = options().unwrap_or_else(|| {
        eprintln!("prove [--cells N] [--profile P] [--inputs one|free] [--bits THREADS] [--ask] [--text]");
        std::process::exit(2);
    });
    let text = cells(o.cells, &o.profile);
    if o.text {
        print!("{text}");
        return;
    }
    let (document, problems) = g7_syntax::parse(&text, FileId(0));
    assert!(problems.is_empty(), "{problems:?}");
    let (asked, problems) = ask(&document, None);
    let asked = asked.unwrap_or_else(|| panic!("{problems:?}"));
    if o.ask { answer(&asked) } else { count(&asked, &o) }
}

fn options() -> Option<Options> {
    let mut o = Options {
        cells: 10,
        profile: "iec60848".to_owned(),
        free: false,
        bits: None,
        ask: false,
        text: false,
    };
    let mut args = std::env::args().skip(1);
    while let Some(arg) = args.next() {
        match arg.as_str() {
            "--cells" => o.cells = args.next()?.parse().ok()?,
            "--profile" => o.profile = args.next()?,
            "--inputs" => o.free = args.next()? == "free",
            "--bits" => o.bits = Some(args.next()?.parse().ok()?),
            "--ask" => o.ask = true,
            "--text" => o.text = true,
            _ => return None,
        }
    }
    Some(o)
}

fn budget() -> Budget<'static> {
    Budget { states: usize::MAX, scans: usize::MAX, bytes: 8 << 30, stop: &|| false }
}

fn count(asked: &Asked, o: &Options) {
    // The claims need not be looked at: their conditions read no inputs.
    let model = Model::new(&asked.compiled, asked.assume.clone());
    let start = Instant::now();
    let seen = match o.bits {
        Some(threads) => {
            let tries = if o.free { Tries::All } else { Tries::One };
            visit_bits(&model, &budget(), tries, threads).expect("the cells are bits")
        }
        None => visit(&model, &budget(), if o.free { Tried::Classes } else { Tried::One }),
    };
    let seconds = start.elapsed().as_secs_f64();
    let each = |bytes: usize| bytes as f64 / seen.states.max(1) as f64;
    println!(
        "{} cells, {} inputs: {} states, {} scans, depth {}, {seconds:.2} s, {:.1} B/state, \
         {:.1} with runs, {} MB{}",
        o.cells,
        if o.free { "free" } else { "one of the" },
        seen.states,
        seen.scans,
        seen.depth,
        each(seen.bytes),
        each(seen.bytes + seen.runs),
        peak(),
        seen.open.map_or(String::new(), |open| {
            let [why, ..] = g7_verify::words::why(&open.reason);
            format!(", not all: {why}")
        }),
    );
}

fn answer(asked: &Asked) {
    let model = Model::new(&asked.compiled, asked.assume.clone());
    let mut answers = vec![None; asked.questions.len()];
    let start = Instant::now();
    Explicit.answer(&model, &asked.questions, &mut answers, &budget());
    let seconds = start.elapsed().as_secs_f64();
    let of = |is: fn(&Verdict) -> bool| answers.iter().flatten().filter(|v| is(v)).count();
    println!(
        "{} questions: {} proved, {} refuted, {} open, {seconds:.2} s, {} MB",
        answers.len(),
        of(|v| matches!(v, Verdict::Proved(_))),
        of(|v| matches!(v, Verdict::Refuted(_))),
        of(|v| matches!(v, Verdict::Open(_))),
        peak(),
    );
}

/// Most memory of the process so far, MB; 0 where it is not known.
fn peak() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"));
    let kib = line.and_then(|l| l.trim().trim_end_matches(" kB").parse::<u64>().ok());
    kib.unwrap_or(0) / 1024
}
