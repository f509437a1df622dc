//! Procedures: each step that calls a procedure gets a copy of it, as JGrafchart makes one whenever
//! the step is activated.
//!
//! The step becomes a macro-step whose expansion is the copy. Its variables are reset at each call
//! to the values of the parameters. A parameter by reference is another name for a variable of the
//! caller. A procedure that calls itself, and a procedure whose name is computed by a text, are not
//! carried over.

use g7_model::{codes, say};
use roxmltree::Node as Xml;

use super::limits::MOST_BYTES;
use super::phrase::{self, PhraseKind};
use super::read::{Caller, Procedure, Reader};
use super::sheet::{Call, Plan, Sheet, SheetKind, StepSort};
use g7_iec::report::shown;
use g7_iec::xml::attr::{self, Text};

/// The most elements in all copies of procedures.
const MOST_COPIED: usize = 50_000;

/// Gives each calling step its copy.
pub(super) fn expand(reader: &mut Reader<'_, '_>) {
    let mut copied = 0;
    let mut next = 0;
    let mut called = vec![false; reader.procedures.len()];
    while next < reader.callers.len() {
        let Some(caller) = reader.callers.get(next) else { break };
        next += 1;
        let found = find(&reader.plan, &reader.procedures, caller);
        let known = found.and_then(|f| Some((f, reader.procedures.get(f)?.xml)));
        let Some((index, xml)) = known else {
            let what = say!(
                "a `ProcedureStep` calls `{}`, which is the name of no procedure; it is read as a step that calls none",
                shown(&caller.procedure.text)
            );
            let at = if caller.procedure.text.is_empty() { &caller.at } else { &caller.procedure.at };
            reader.report.say(&codes::NOT_CARRIED, at, what);
            plain(&mut reader.plan, next - 1, &reader.callers);
            continue;
        };
        if let Some(c) = called.get_mut(index) {
            *c = true;
        }
        let refused = if caller.chain.contains(&index) {
            Some(&codes::NOT_CARRIED)
        } else {
            copied += xml.descendants().count();
            (copied > MOST_COPIED).then_some(&codes::TOO_LARGE)
        };
        if let Some(code) = refused {
            let what = if *code == codes::TOO_LARGE {
                say!("the copies of procedures are too large; this call is left out")
            } else {
                say!("a procedure that calls itself; this call is left out")
            };
            let at = caller.at.clone();
            reader.report.say(code, &at, what);
            plain(&mut reader.plan, next - 1, &reader.callers);
            continue;
        }
        copy(reader, next - 1, index, xml);
    }
    for (procedure, called) in reader.procedures.iter().zip(&called) {
        if !called {
            let what = say!("a procedure that no step calls is left out");
            reader.report.element(&codes::LEFT_OUT, "GrafcetProcedure", &attr::head(procedure.xml), what);
        }
    }
}

/// Makes a plain step of a step whose call is not carried over.
fn plain(plan: &mut Plan, caller: usize, callers: &[Caller]) {
    let step = callers.get(caller).and_then(|c| plan.sheets.get_mut(c.sheet)?.steps.get_mut(c.step));
    if let Some(step) = step {
        step.sort = StepSort::Plain;
    }
}

/// Finds the procedure with this name: from the innermost workspace outward, then by its full name.
fn find(plan: &Plan, procedures: &[Procedure], caller: &Caller) -> Option<usize> {
    let name = caller.procedure.text.trim();
    let among = |sheet: usize, name: &str| procedures.iter().position(|p| p.sheet == sheet && p.name == name);
    let mut here = Some(caller.sheet);
    while let Some(sheet) = here {
        if let Some(found) = among(sheet, name) {
            return Some(found);
        }
        here = plan.sheets.get(sheet).and_then(|s| s.parent);
    }
    let (top, name) = name.split_once('.')?;
    let of_top = |s: &Sheet| s.kind == SheetKind::Top && s.name.text == top;
    among(plan.sheets.iter().position(of_top)?, name)
}

fn copy<'x>(reader: &mut Reader<'_, 'x>, caller: usize, index: usize, xml: Xml<'x, 'x>) {
    let Some(home) = reader.procedures.get(index).map(|p| p.sheet) else { return };
    let Some(c) = reader.callers.get_mut(caller) else { return };
    let (sheet, step, parameters) = (c.sheet, c.step, c.parameters.clone());
    let name = c.name.clone();
    let mut chain = std::mem::take(&mut c.chain);
    chain.push(index);
    let outer = std::mem::replace(&mut reader.chain, chain);
    let inside = reader.inner(xml, SheetKind::Macro, home);
    reader.chain = outer;
    let Some(inside) = inside else { return };
    if let Some(known) = reader.plan.sheets.get_mut(inside) {
        known.owner = Some((sheet, step));
        if !name.text.trim().is_empty() {
            known.name = name;
        }
    }
    let step = reader.plan.sheets.get_mut(sheet).and_then(|s| s.steps.get_mut(step));
    if let Some(step) = step {
        step.sort = StepSort::Macro(Some(inside));
    }
    give(reader, inside, sheet, parameters);
}

/// Reads the parameters of a call.
fn give(reader: &mut Reader<'_, '_>, inside: usize, caller: usize, text: Text) {
    if text.text.len() > MOST_BYTES {
        let what = say!("a text of {} bytes; at most {MOST_BYTES} are read", text.text.len());
        reader.report.say(&codes::TOO_LARGE, &text.at, what);
        return;
    }
    let (parameters, faults) = phrase::parameters(&text.text);
    for fault in faults {
        reader.report.say(&codes::BAD_TEXT, &text.place(&fault.at), fault.what);
    }
    let mut values = Vec::new();
    for parameter in parameters {
        let Some(sheet) = reader.plan.sheets.get_mut(inside) else { return };
        let Some(var) = sheet.vars.iter().position(|v| v.name.text == parameter.name) else {
            let what = say!("the procedure has no variable `{}`", shown(&parameter.name));
            reader.report.say(&codes::UNKNOWN_OBJECT, &text.place(&parameter.at), what);
            continue;
        };
        if !parameter.by_reference {
            values.push((parameter.name, parameter.value));
            continue;
        }
        let PhraseKind::Name(path) = parameter.value.kind else {
            let what = say!("a parameter by reference that is no name");
            reader.report.say(&codes::BAD_TEXT, &text.place(&parameter.at), what);
            continue;
        };
        sheet.vars.remove(var);
        sheet.refs.insert(parameter.name, (caller, path));
    }
    if let Some(sheet) = reader.plan.sheets.get_mut(inside) {
        let number = |name: &str| sheet.vars.iter().position(|v| v.name.text == name);
        let values = values.into_iter().filter_map(|(name, value)| Some((number(&name)?, value))).collect();
        sheet.call = Some(Call { parameters: text, values });
    }
}
