//! Builds a bench from a document: compiles it, couples it to its plant, and names everything.

use std::collections::BTreeMap;

use g7_compile::Compiled;
use g7_compile::ir::VarClass;
use g7_compile::plant::{self, Link};
use g7_compile::resolve::set_by_terminal;
use g7_compile::symbols::{Symbols, Variable};
use g7_engine::{Code, StepId};
use g7_host::{Coupling, Kind};
use g7_model::{ChartKind, Document, Expr, Holds, Nanos, Plant, Problem, Span, Step, Type};

use super::ask::{Answer, Ask, Options};
use super::{Activity, Bench, Item, PlantSide, Role, StepItem};
use crate::error::Error;
use crate::source::Source;

/// Number of elements of a table that get a name each.
const ELEMENTS: u32 = 32;
/// Number of parts in a queue that get a name each.
const PARTS: u32 = 6;

/// Compiles a document and its plant. Gives no bench if one of the problems is an error.
///
/// # Errors
///
/// The plant that was asked for does not exist.
pub fn build(source: &Source, options: &Options<'_>) -> Result<(Option<Bench>, Vec<Problem>), Error> {
    let mut problems = source.read_problems();
    if source.is_broken() {
        return Ok((None, problems));
    }
    let plant = plant_of(source, options.plant)?;
    let asks = |of_plant| -> Vec<Expr> {
        options.asks.iter().filter(|a| a.of_plant == of_plant).map(|a| a.expr.clone()).collect()
    };
    // The bench is the terminal too: what that sets is there, whether the text names it or not,
    // and before all that the questions name, so that the items are the same for any questions.
    let mut of_charts = g7_compile::resolve::terminal(source.whole(), options.profile);
    let own = of_charts.len();
    of_charts.extend(asks(false));
    let (charts, found) = g7_compile::compile_with(source.whole(), options.profile, &of_charts);
    problems.extend(source.about(found));
    let Some(charts) = charts else { return Ok((None, problems)) };
    let mut items = Vec::new();
    variables(&charts, &mut items);
    let mut side = None;
    if let Some(plant) = plant {
        let (made, found) = plant_side(source.whole(), plant, &charts, &asks(true));
        problems.extend(source.about(found));
        let Some(made) = made else { return Ok((None, problems)) };
        states(&made.compiled.symbols, &mut items);
        side = Some(made);
    }
    system_bits(&charts.symbols, &mut items);
    let answers = answers(options.asks, &charts, own, side.as_ref());
    let steps = steps(source.whole(), &charts.symbols);
    let period = options.scan.unwrap_or(charts.symbols.cycle).max(Nanos::new(1));
    Ok((Some(Bench { items, steps, plant: side, period, answers, compiled: charts }), problems))
}

/// Compiles the plant as a program of its own and couples it to the charts.
fn plant_side(
    document: &Document,
    plant: &Plant,
    charts: &Compiled,
    asks: &[Expr],
) -> (Option<PlantSide>, Vec<Problem>) {
    let (made, problems) = plant::compile_plant(document, plant, charts, asks);
    let side = made.map(|made| {
        let (c, p) = (charts.program.tables(), made.compiled.program.tables());
        let coupling = Coupling {
            to_plant: words(&made.to_plant, c.outputs.start, p.inputs.start),
            to_charts: words(&made.to_charts, p.outputs.start, c.inputs.start),
        };
        PlantSide {
            name: made.name.to_string(),
            coupling,
            view: made.view.map(String::from),
            bindings: made.bindings,
            queries: made.queries,
            compiled: made.compiled,
        }
    });
    (side, problems)
}

/// The links between two programs, word by word, counted from the first output and input.
fn words(links: &[Link], outputs: u32, inputs: u32) -> Vec<(u32, u32)> {
    let pair =
        |link: &Link, k: u32| (link.from.0.saturating_sub(outputs) + k, link.to.0.saturating_sub(inputs) + k);
    links.iter().flat_map(|link| (0..link.words).map(move |k| pair(link, k))).collect()
}

/// The compiled expressions, in the order of `asks`; those of the charts stand behind `own` others.
fn answers(asks: &[Ask], charts: &Compiled, own: usize, plant: Option<&PlantSide>) -> Vec<Answer> {
    let of = |queries: &[Code], c: &Compiled| -> Vec<(Code, Type)> {
        queries.iter().copied().zip(c.query_types.iter().copied()).collect()
    };
    let mut of_charts = of(&charts.queries, charts).into_iter().skip(own);
    let mut of_plant = plant.map(|p| of(&p.queries, &p.compiled)).unwrap_or_default().into_iter();
    let answer = |ask: &Ask| {
        let (code, ty) = if ask.of_plant { of_plant.next() } else { of_charts.next() }?;
        Some(Answer { code, ty, of_plant: ask.of_plant })
    };
    asks.iter().map_while(answer).collect()
}

/// All steps and macro-steps, with their comments.
fn steps(document: &Document, symbols: &Symbols) -> Vec<StepItem> {
    let mut written: BTreeMap<Span, (&Step, bool)> = BTreeMap::new();
    for chart in document.charts() {
        written.extend(chart.steps().map(|s| (s.name.at.0, (s, chart.kind != ChartKind::Chart))));
    }
    let item = |name: &str, chart: &str, at: Span, id| StepItem {
        name: name.to_owned(),
        chart: chart.to_owned(),
        at,
        comment: written.get(&at).and_then(|(s, _)| s.comment.as_deref()).map(str::to_owned),
        id,
        inner: written.get(&at).is_some_and(|(_, inner)| *inner),
    };
    let macros = symbols.macro_steps.iter().map(|m| item(&m.name, &m.chart, m.at, Activity::Macro(m.group)));
    let listed = (0..symbols.steps()).map(StepId).filter(|s| symbols.is_listed(*s));
    let plain = listed
        .map(|s| item(symbols.step_name(s), symbols.step_chart(s), symbols.step_place(s), Activity::Step(s)));
    plain.chain(macros).collect()
}

/// Finds the plant: the one with the given name, or the only one of the file.
fn plant_of<'a>(source: &'a Source, name: Option<&str>) -> Result<Option<&'a Plant>, Error> {
    let plants: Vec<&Plant> = plant::plants(&source.document).collect();
    let there = || plants.iter().map(|p| p.name.text.to_string()).collect();
    match name {
        Some("none") => Ok(None),
        Some(name) => match plants.iter().find(|p| *p.name.text == *name) {
            Some(plant) => Ok(Some(plant)),
            None => Err(Error::NoPlant { file: source.name.clone(), name: name.to_owned(), there: there() }),
        },
        None => match plants.as_slice() {
            [] => Ok(None),
            [one] => Ok(Some(one)),
            _ => Err(Error::SeveralPlants { file: source.name.clone(), there: there() }),
        },
    }
}

pub(super) fn kind(ty: Type) -> Option<Kind> {
    let row = ty.elementary()?;
    Some(match row.holds {
        Holds::Truth => Kind::Bool,
        Holds::Signed => Kind::Int { bits: row.bits, signed: true },
        Holds::Unsigned | Holds::Bits => Kind::Int { bits: row.bits, signed: false },
        Holds::Real if ty == Type::Real => Kind::Real,
        Holds::Real => Kind::Lreal,
        Holds::Time => Kind::Time,
        Holds::Moment(moment) => Kind::Moment(moment),
        Holds::Text => Kind::Text,
    })
}

/// The variables of the charts, each with its role.
fn variables(charts: &Compiled, items: &mut Vec<Item>) {
    let first = charts.program.tables().inputs.start;
    for v in &charts.symbols.variables {
        let role = match v.class {
            VarClass::Input => Role::Input(v.addr.0.saturating_sub(first)),
            VarClass::Output => Role::Output,
            VarClass::Internal => Role::Variable,
            VarClass::Local | VarClass::Const | VarClass::System => continue,
        };
        push(v, role, items);
    }
}

/// The system bits and words that a terminal sets.
fn system_bits(symbols: &Symbols, items: &mut Vec<Item>) {
    let system = |v: &&Variable| v.class == VarClass::System && set_by_terminal(&v.name);
    symbols.variables.iter().filter(system).for_each(|v| push(v, Role::Variable, items));
}

/// The states of the plant. Variables that it shares with the charts are listed among the charts'
/// own.
fn states(symbols: &Symbols, items: &mut Vec<Item>) {
    for v in symbols.variables.iter().filter(|v| v.class == VarClass::Internal) {
        // A name with `@` is internal; of a queue only the first parts are listed.
        let place = v.name.rsplit_once('.').and_then(|(_, last)| last.parse::<u32>().ok());
        if !v.name.starts_with('@') && place.is_none_or(|p| p < PARTS) {
            push(v, Role::Plant, items);
        }
    }
}

fn push(v: &Variable, role: Role, items: &mut Vec<Item>) {
    let Some(kind) = kind(v.ty) else { return };
    let words = v.words().checked_div(v.elements.max(1)).unwrap_or(1).max(1);
    let meaning = || v.held.as_ref().map_or_else(|| v.ty.to_string(), |held| held.meaning(v.ty));
    let retain = v.retain.then(meaning);
    let comment = v.comment.as_deref().map(str::to_owned);
    for k in 0..v.elements.min(ELEMENTS) {
        let name = if v.elements == 1 { v.name.to_string() } else { format!("{}[{k}]", v.name) };
        let (addr, retain, comment) = (v.addr.0 + k * words, retain.clone(), comment.clone());
        let held = v.held.clone();
        items.push(Item { name, kind, held, role, addr, words, retain, comment, ty: v.ty, at: v.at });
    }
}
