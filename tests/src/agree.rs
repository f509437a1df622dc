//! Compares two subjects on the same chart and the same script, scan by scan.

use std::collections::BTreeMap;

use g7_model::Document;

use crate::generate::{Event, Script};
use crate::naive::Value;
use crate::subject::{Backend, Fault, Subject};

/// The first difference between two subjects.
#[derive(Clone, Debug)]
pub struct Disagreement {
    /// The number of the event in the script, from 0.
    pub event: usize,
    /// A description of the difference.
    pub what: String,
}

/// Statistics of a run.
#[derive(Clone, Debug, Default)]
pub struct Statistics {
    /// Number of scans that both subjects made.
    pub scans: usize,
    /// Number of active steps, summed over the scans.
    pub active: usize,
    /// Number of scans in which the situation changed.
    pub moved: usize,
    /// Number of faults by kind.
    pub faults: BTreeMap<String, usize>,
    /// Number of different situations, summed over the runs.
    pub situations: usize,
    /// Number of runs.
    pub runs: usize,
}

impl Statistics {
    /// The number of scans that ended without a fault.
    pub fn sound(&self) -> usize {
        self.scans - self.faults.values().sum::<usize>()
    }

    /// Adds the statistics of another run.
    pub fn add(&mut self, other: &Statistics) {
        self.scans += other.scans;
        self.active += other.active;
        self.moved += other.moved;
        self.situations += other.situations;
        self.runs += other.runs;
        for (kind, n) in &other.faults {
            *self.faults.entry(kind.clone()).or_default() += n;
        }
    }

    /// The statistics on one line.
    pub fn line(&self) -> String {
        let scans = self.scans.max(1) as f64;
        let runs = self.runs.max(1) as f64;
        format!(
            "{} charts, {} scans, {:.1} active steps, {:.0} % of scans move, {:.1} situations a chart, faults {:?}",
            self.runs,
            self.scans,
            self.active as f64 / scans,
            100.0 * self.moved as f64 / scans,
            self.situations as f64 / runs,
            self.faults,
        )
    }
}

/// Runs a script on two backends and compares situation, outputs, variables, step times, conflicts
/// and faults after each scan.
///
/// # Errors
///
/// The first difference, or the reason why a subject cannot be made.
pub fn agree(doc: &Document, script: &Script, backends: [Backend; 2]) -> Result<Statistics, Disagreement> {
    let made = |what: String| Disagreement { event: 0, what };
    let mut one = (backends[0])(doc, None, &[]).map_err(|e| made(format!("the first: {e}")))?;
    let mut two = (backends[1])(doc, None, &[]).map_err(|e| made(format!("the second: {e}")))?;
    let mut statistics = Statistics { runs: 1, ..Statistics::default() };
    let mut seen = std::collections::BTreeSet::new();
    let mut last = one.active();
    let mut current = BTreeMap::new();
    for (event, what) in script.iter().enumerate() {
        match what {
            Event::Restart { cold } => {
                one.restart(*cold);
                two.restart(*cold);
            }
            Event::Scan { now, inputs } => {
                current.extend(inputs.clone());
                let results = [one.scan(&current, *now), two.scan(&current, *now)];
                compare(&results, &*one, &*two).map_err(|what| Disagreement { event, what })?;
                let [result, _] = results;
                if let Err(fault) = &result {
                    *statistics.faults.entry(fault.kind().to_owned()).or_default() += 1;
                    one.restart(true);
                    two.restart(true);
                }
                let active = one.active();
                statistics.scans += 1;
                statistics.active += active.len();
                statistics.moved += usize::from(active != last);
                last.clone_from(&active);
                seen.insert(active);
            }
        }
    }
    statistics.situations = seen.len();
    Ok(statistics)
}

fn compare(results: &[Result<(), Fault>; 2], one: &dyn Subject, two: &dyn Subject) -> Result<(), String> {
    match results {
        [Ok(()), Ok(())] => {}
        [Err(Fault::Other(what)), _] | [_, Err(Fault::Other(what))] => return Err(what.clone()),
        [Err(a), Err(b)] if alike(a, b) => return same("outputs", &one.outputs(), &two.outputs()),
        [a, b] => return Err(format!("results {a:?} against {b:?}")),
    }
    if one.active() != two.active() {
        return Err(format!("situations {:?} against {:?}", one.active(), two.active()));
    }
    let (mut mine, mut theirs) = (one.variables(), two.variables());
    // Left out: outputs of transition sections, which the naive engine does not store, and system
    // words that the chart does not use, which the engine does not have.
    theirs.retain(|name, _| mine.contains_key(name));
    mine.retain(|name, _| !name.starts_with('%') || theirs.contains_key(name));
    same("variables", &mine, &theirs)?;
    same("outputs", &one.outputs(), &two.outputs())?;
    same("step times", &one.step_times(), &two.step_times())?;
    // The second subject reports only the first conflict of a scan.
    let (all, first) = (one.conflicts(), two.conflicts());
    if all.is_empty() == first.is_empty() && first.iter().all(|c| all.contains(c)) {
        Ok(())
    } else {
        Err(format!("conflicts {all:?} against {first:?}"))
    }
}

/// True if two faults are equal. If a search exceeds its bound shortly after its cycle closes,
/// either kind of fault is correct.
fn alike(a: &Fault, b: &Fault) -> bool {
    let search = |f: &Fault| matches!(f.kind(), "unstable" | "bound");
    a.kind() == b.kind() || (search(a) && search(b))
}

fn same<T: PartialEq + std::fmt::Debug>(
    of: &str,
    one: &BTreeMap<String, T>,
    two: &BTreeMap<String, T>,
) -> Result<(), String> {
    let mut differences = Vec::new();
    for (name, value) in one {
        match two.get(name) {
            Some(other) if other == value => {}
            other => differences.push(format!("{name}: {value:?} against {other:?}")),
        }
    }
    differences
        .extend(two.keys().filter(|n| !one.contains_key(*n)).map(|n| format!("{n}: only in the second")));
    if differences.is_empty() { Ok(()) } else { Err(format!("{of}: {}", differences.join("; "))) }
}

/// The events of a script as text, one on each line, up to and including `last`.
pub fn script_text(script: &Script, last: usize) -> String {
    let mut text = String::new();
    for event in script.iter().take(last + 1) {
        match event {
            Event::Restart { cold } => text += if *cold { "! restart cold\n" } else { "! restart\n" },
            Event::Scan { now, inputs } => {
                let inputs: Vec<String> = inputs.iter().map(|(n, v)| format!("{n}={}", value(v))).collect();
                text += &format!("{}us | {}\n", *now as f64 / 1e3, inputs.join(" "));
            }
        }
    }
    text
}

fn value(v: &Value) -> String {
    match v {
        Value::Bool(b) => u8::from(*b).to_string(),
        Value::Int(n) => n.to_string(),
        Value::Real(x) => x.to_string(),
        other => format!("{other:?}"),
    }
}
