//! The pages of the library: each has a chronogram of a run of the part's test bench, and tells how it was run.

use std::path::{Path, PathBuf};

use g7_draw::{Chronogram, Edge, Lane, LaneKind, Options as Look, chronogram_svg};
use g7_host::{Kind, Value};
use g7_model::Nanos;
use g7_rig::values::duration;
use g7_rig::{Bench, Options, Source};

/// The folder of the pages, from the root of the repository.
pub const PAGES: &str = "docs/book/src/library";

/// How a line of a page begins that tells how its picture was made; the options of `g7 run` follow.
const LINE: &str = "*A run of `library/tests/";

/// The place of the picture of a part.
pub fn picture(root: &Path, part: &str) -> PathBuf {
    root.join(PAGES).join(format!("img/{part}.svg"))
}

/// The options on the page of a part.
///
/// # Errors
///
/// The page has no picture, or does not tell how it was made.
pub fn options<'p>(page: &'p str, part: &str) -> Result<&'p str, String> {
    let line = page.lines().find_map(|l| l.strip_prefix(LINE)?.strip_prefix(part)?.strip_prefix(".g7 "));
    let options = line.and_then(|l| l.strip_suffix("`*"));
    let shown = page.contains(&format!("](img/{part}.svg)"));
    options.filter(|_| shown).ok_or_else(|| format!("{part}: no picture, or not how it was made"))
}

/// A value that is set at a time.
struct Move<'o> {
    name: &'o str,
    value: &'o str,
    at: Nanos,
}

/// Runs the test bench of a part with these options and draws the signals that they show.
///
/// # Errors
///
/// The bench has errors, or an option has no meaning.
pub fn chronogram(root: &Path, part: &str, options: &str) -> Result<String, String> {
    let path = root.join(format!("library/tests/{part}.g7"));
    let bytes = std::fs::read(&path).map_err(|e| format!("{}: {e}", path.display()))?;
    let mut source = Source::native("bench.g7", bytes, 0);
    source.link(&mut |path| Err(g7_model::Said::foreign(path)));
    let (mut length, mut plant, mut shown) = (Nanos::ZERO, None, Vec::new());
    let mut moves: Vec<Move<'_>> = Vec::new();
    let mut words = options.split_whitespace();
    while let (Some(option), Some(value)) = (words.next(), words.next()) {
        let wrong = || format!("{part}: `{option} {value}` has no meaning");
        match option {
            "--for" => length = duration(value).map_err(|_| wrong())?,
            "--plant" => plant = Some(value),
            "--show" => shown = value.split(',').collect(),
            "--set" => {
                let (set, at) = value.split_once('@').ok_or_else(wrong)?;
                let (name, value) = set.split_once('=').ok_or_else(wrong)?;
                moves.push(Move { name, value, at: duration(at).map_err(|_| wrong())? });
            }
            _ => return Err(wrong()),
        }
    }
    let wanted = Options { plant, ..Options::default() };
    let (bench, problems) = g7_rig::build(&source, &wanted).map_err(|e| format!("{part}: {e:?}"))?;
    let bench = bench.ok_or_else(|| format!("{part}: {problems:?}"))?;
    let lanes = run(&bench, &moves, length, &shown).map_err(|why| format!("{part}: {why}"))?;
    let look = Look { font: false, ..Look::default() };
    Ok(chronogram_svg(&Chronogram { lanes, from: Nanos::ZERO, to: length }, &look))
}

fn run(bench: &Bench, moves: &[Move<'_>], length: Nanos, shown: &[&str]) -> Result<Vec<Lane>, String> {
    let item = |name: &str| bench.item(name).ok_or_else(|| format!("there is no `{name}`"));
    let mut lanes: Vec<Lane> = Vec::new();
    for name in shown {
        let kind = if item(name)?.kind == Kind::Bool { LaneKind::Bool } else { LaneKind::Number };
        lanes.push(Lane { name: (*name).to_owned(), kind, edges: Vec::new() });
    }
    let mut runner = bench.runner(0);
    let mut left = moves;
    while runner.due() <= length {
        let due = runner.due();
        let now = left.iter().take_while(|m| m.at <= due).count();
        let (set, rest) = left.split_at(now);
        left = rest;
        for m in set {
            let item = item(m.name)?;
            let value = item.read(m.value).map_err(|why| why.to_string())?;
            bench.set(&mut runner, item, &value);
        }
        runner.scan().map_err(|halt| bench.halt(&runner, halt).to_string())?;
        for lane in &mut lanes {
            let item = item(&lane.name)?;
            edge(lane, due, &bench.value(&runner, item), item);
        }
    }
    Ok(lanes)
}

/// Adds a value to a lane, if it differs from the one before.
fn edge(lane: &mut Lane, at: Nanos, value: &Value, item: &g7_rig::Item) {
    let show = item.show(value);
    if lane.edges.last().is_none_or(|e| e.show != show) {
        lane.edges.push(Edge { at, value: value.number(item.kind), show });
    }
}
