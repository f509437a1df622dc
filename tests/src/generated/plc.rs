//! Printed PLC code beside the engine: what both of them show, scan by scan.

use std::collections::BTreeMap;

use g7_codegen::plc::{self, Form, Printed};
use g7_compile::ir::VarClass;
use g7_compile::symbols::Variable;
use g7_engine::{FaultKind, State, StepId, scan};
use g7_model::Type;

use super::Subject;

/// Variables that the chart and its code both have, with the names of the code in capitals.
pub fn shown<'a>(s: &'a Subject, printed: &Printed) -> Vec<(&'a Variable, String)> {
    let all = s.compiled.symbols.variables.iter();
    let all = all.filter(|v| !matches!(v.class, VarClass::Const | VarClass::Local));
    all.filter_map(|v| printed.variable(v.addr).map(|(n, _)| (v, n.to_uppercase())))
        .filter(|(v, _)| !matches!(v.ty, Type::Fb(_) | Type::String(_)))
        .collect()
}

/// What one scan shows: steps and variables; after a fault the outputs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Seen {
    /// No stable situation, or orders that disagree.
    pub stopped: bool,
    /// Steps, then variables in their order.
    pub words: Vec<u64>,
}

/// What the code does next.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Event {
    /// It starts anew.
    Start,
    /// A scan: the time, and the inputs that are shown, word by word.
    Scan {
        /// Nanoseconds.
        now: i64,
        /// Inputs.
        inputs: Vec<u64>,
    },
}

/// What happens to the code, and what the engine shows in each scan of it. A run
/// ends where values fail (a controller goes on) and at a warm restart (what is
/// kept is the controller's matter).
///
/// # Errors
///
/// A script that ends within a scan.
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
                FaultKind::Unstable { .. } | FaultKind::Forcing { .. } | FaultKind::Bound
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

/// What differs between two scans, with the names of the code.
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

/// Charts with their code, and why the others have none.
#[derive(Debug)]
pub struct Prints<'a> {
    /// Those that are printed.
    pub list: Vec<(&'a Subject, Printed)>,
    /// How many are refused, by the reason.
    pub refused: BTreeMap<String, usize>,
}

/// Prints what can be printed. Each refusal must give a place in the chart.
///
/// # Errors
///
/// A refusal without a reason or a place.
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
                *all.refused.entry(first.what.clone()).or_default() += 1;
            }
        }
    }
    Ok(all)
}
