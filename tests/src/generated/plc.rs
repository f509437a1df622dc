//! Compares printed PLC code with the engine, scan by scan.

use std::collections::BTreeMap;

use g7_codegen::plc::{self, Form, Printed};
use g7_compile::ir::VarClass;
use g7_compile::symbols::Variable;
use g7_engine::{FaultKind, State, StepId, scan};
use g7_model::Type;

use super::Subject;

/// The variables that both the chart and its code have, with their names in the code in capital
/// letters.
pub fn shown<'a>(s: &'a Subject, printed: &Printed) -> Vec<(&'a Variable, String)> {
    let all = s.compiled.symbols.variables.iter();
    let all = all.filter(|v| !matches!(v.class, VarClass::Const | VarClass::Local));
    all.filter_map(|v| printed.variable(v.addr).map(|(n, _)| (v, n.to_uppercase())))
        .filter(|(v, _)| !matches!(v.ty, Type::Fb(_) | Type::String(_)))
        .collect()
}

/// The result of one scan: steps and variables; after a fault only the outputs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Seen {
    /// True after a fault at which the code stops as well.
    pub stopped: bool,
    /// The steps, then the variables in their order.
    pub words: Vec<u64>,
}

/// An event for the code.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Event {
    /// A restart.
    Start,
    /// A scan: its time, and the words of the visible inputs.
    Scan {
        /// The time, in nanoseconds.
        now: i64,
        /// The inputs.
        inputs: Vec<u64>,
    },
}

/// The events for the code, and the engine's result of each scan. The recording ends where a number
/// overflows (a controller would go on) and at a warm restart (the controller decides what is kept).
///
/// # Errors
///
/// The script ends within a scan.
pub fn played(s: &Subject, printed: &Printed) -> Result<(Vec<Event>, Vec<Seen>), String> {
    let program = &s.compiled.program;
    let table = program.tables().inputs;
    let n = (table.end - table.start) as usize;
    let (mut events, mut seen) = (Vec::new(), Vec::new());
    let mut bytes = s.input.as_slice();
    let mut state = State::new(program);
    let mut ended = false;
    let shown = shown(s, printed);
    while let Some((event, rest)) = bytes.split_first() {
        bytes = rest;
        if *event == 3 {
            state = State::new(program);
            events.push(Event::Start);
            ended = false;
            continue;
        }
        if *event == 2 {
            ended = true;
            continue;
        }
        let mut words = Vec::new();
        for _ in 0..=n {
            let (word, rest) = bytes.split_first_chunk::<8>().ok_or("the script ends within a scan")?;
            words.push(u64::from_le_bytes(*word));
            bytes = rest;
        }
        let Some((now, words)) = words.split_first().filter(|_| !ended) else { continue };
        let now = *now as i64;
        let done = scan(program, &mut state, words, now);
        let stopped = done.is_err();
        if let Err(fault) = done {
            ended = true;
            let stops = matches!(
                fault.kind,
                FaultKind::Unstable { .. }
                    | FaultKind::Forcing { .. }
                    | FaultKind::Bound
                    | FaultKind::DivisionByZero
                    | FaultKind::Range
                    | FaultKind::Table
            );
            if !stops {
                continue;
            }
        }
        let mut inputs = Vec::new();
        for (v, _) in shown.iter().filter(|(v, _)| v.class == VarClass::Input) {
            let from = (v.addr.0 - table.start) as usize;
            inputs.extend(words.get(from..from + v.elements as usize).unwrap_or(&[]));
        }
        events.push(Event::Scan { now, inputs });
        let mut words = Vec::new();
        if !stopped {
            words.extend((0..s.compiled.symbols.steps()).map(|i| u64::from(state.is_active(StepId(i)))));
        }
        for (v, _) in shown.iter().filter(|(v, _)| !stopped || v.class == VarClass::Output) {
            words.extend(v.value(&state));
        }
        seen.push(Seen { stopped, words });
    }
    Ok((events, seen))
}

/// The differences between two results, with the names of the code.
pub fn difference(s: &Subject, printed: &Printed, want: &Seen, got: &Seen) -> String {
    if want.stopped != got.stopped {
        return format!("stopped: {} by the engine, {} by the code", want.stopped, got.stopped);
    }
    let mut names: Vec<String> = Vec::new();
    if !want.stopped {
        names.extend((0..s.compiled.symbols.steps()).map(|i| printed.step(StepId(i)).to_owned()));
    }
    for (v, name) in shown(s, printed).iter().filter(|(v, _)| !want.stopped || v.class == VarClass::Output) {
        names.extend((0..v.elements).map(|i| format!("{name}[{i}]")));
    }
    let all = names.iter().zip(want.words.iter().zip(&got.words)).filter(|(_, (a, b))| a != b);
    all.take(8)
        .map(|(n, (a, b))| format!("{n} {} against {}", *a as i64, *b as i64))
        .collect::<Vec<_>>()
        .join(", ")
}

/// Charts with their code, and the reasons why other charts have none.
#[derive(Debug)]
pub struct Prints<'a> {
    /// The charts that can be printed, with their code.
    pub list: Vec<(&'a Subject, Printed)>,
    /// The number of refused charts for each reason.
    pub refused: BTreeMap<String, usize>,
}

/// Prints all charts that can be printed. Each refusal must name a place in the chart.
///
/// # Errors
///
/// A refusal has no reason or no place.
pub fn prints(subjects: &[Subject], form: Form) -> Result<Prints<'_>, String> {
    let mut all = Prints { list: Vec::new(), refused: BTreeMap::new() };
    for s in subjects {
        let name = format!("chart_{}", all.list.len());
        match plc::print(&s.compiled, form, &name, &s.text) {
            Ok(printed) => all.list.push((s, printed)),
            Err(problems) => {
                let first = problems.first().ok_or_else(|| format!("{}: refused without a word", s.title))?;
                if first.at.end <= first.at.start || first.at.end as usize > s.text.len() {
                    return Err(format!("{}: no place: {}", s.title, first.what));
                }
                *all.refused.entry(first.what.to_string()).or_default() += 1;
            }
        }
    }
    Ok(all)
}
