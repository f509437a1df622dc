//! On-line changes: a changed chart continues the run of the old one. Parts with the same name in
//! both continue.
//!
//! ```text
//! old Bench + Runner, new Bench -> pairs by name -> engine::carry -> new Runner, losses
//! ```
//!
//! Every loss that matters is reported: an active step, a value that differs from the initial one,
//! a forced signal.

use std::collections::{BTreeMap, BTreeSet};

use g7_compile::ir::VarClass;
use g7_compile::symbols::{Symbols, Variable};
use g7_compile::{Compiled, Held};
use g7_engine::{Addr, Common, GroupId, NONE, State, StepId};
use g7_host::Runner;
use g7_model::composed::decomposed;
use g7_model::instances::instantiated;
use g7_model::{Chart, ChartKind, Document, Said, Type, say};

use crate::{Bench, Role, fault};

/// A run that continues with the changed charts.
pub struct Carried {
    /// The run, at the same instant as the old one.
    pub runner: Runner,
    /// A sentence for each part of the old run that does not continue.
    pub lost: Vec<Said>,
}

/// The document with a chart for each instance.
fn plain(document: &Document) -> Document {
    decomposed(&instantiated(document).0).0.into_owned()
}

/// Continues a run of old charts with new ones.
///
/// # Errors
///
/// The reason why this is impossible: a fault has stopped the run, or an expression of the new
/// charts fails in this state.
pub fn carry(new: (&Bench, &Document), old: (&Bench, &Document), run: &Runner) -> Result<Carried, Said> {
    if run.halt().is_some() {
        return Err(say!("a fault has stopped the run: restart it"));
    }
    let (bench, before) = (new.0, old.0);
    let mut lost = Vec::new();
    let mut own = run.state().clone();
    run.own_outputs().for_each(|(addr, value)| own.set_word(run.program(), addr, value));
    let (now, then) = (plain(new.1), plain(old.1));
    let state = charts((bench, &now), (before, &then), &own, &mut lost)?;
    let mut runner = bench.runner(0).from_state(state, run.due());
    plant(bench, before, run, &mut runner, &mut lost)?;
    for item in &before.items {
        let there = bench.items.iter().find(|i| i.name == item.name && i.kind == item.kind);
        let forced = before.is_forced(run, item);
        match there {
            Some(i) if forced => {
                let value = before.value(run, item);
                bench.force(&mut runner, i, &value);
            }
            None if forced => lost.push(say!("`{}` was forced and no longer exists", item.name)),
            Some(i) if matches!((item.role, i.role), (Role::Input(_), Role::Input(_))) => {
                let value = before.value(run, item);
                bench.set(&mut runner, i, &value);
            }
            Some(_) | None => {}
        }
    }
    Ok(Carried { runner, lost })
}

/// The state with which the new charts continue.
fn charts(
    new: (&Bench, &Document),
    old: (&Bench, &Document),
    state: &State,
    lost: &mut Vec<Said>,
) -> Result<State, Said> {
    let (c, was) = (&new.0.compiled, &old.0.compiled);
    let kept = kept_charts(new.1, old.1);
    let at_work = at_work(old.1, was, state);
    for task in &at_work {
        lost.push(say!("the task `{task}` is being executed: it restarts"));
    }
    let path_kept = |path: &str| chart_of(path, &kept).is_some();
    let restarted: BTreeSet<&str> = tasks(old.1).map(|t| &*t.name.text).collect();
    let partners = partners(&was.symbols);
    let (mut steps, mut begin) = (Vec::new(), Vec::new());
    for step in (0..c.symbols.steps()).map(StepId) {
        let path = key(&c.symbols, step);
        match partners.get(&path).filter(|_| path_kept(&path)) {
            Some(old) => steps.push((step, *old)),
            None if !path_kept(&path) && c.program.tables().initial.contains(&step) => begin.push(step),
            None => {}
        }
    }
    let taken: BTreeSet<StepId> = steps.iter().map(|(_, old)| *old).collect();
    let gone = |s: &StepId| was.symbols.is_listed(*s) && !taken.contains(s);
    for step in state.active().filter(gone) {
        // The loss of a task was reported already; do not report its steps again.
        if chart_of(was.symbols.step_path(step), &restarted).is_none() {
            lost.push(say!("step `{}` is active and no longer exists", was.symbols.step_name(step)));
        }
    }
    let words = words(c, was, state, lost);
    let groups: Vec<(GroupId, GroupId)> = c
        .symbols
        .macro_steps
        .iter()
        .filter_map(|m| Some((m.group, was.symbols.macro_steps.iter().find(|o| o.path == m.path)?.group)))
        .collect();
    let blocks = blocks(c, was);
    let common = Common { words: &words, steps: &steps, begin: &begin, groups: &groups, blocks: &blocks };
    let carried = g7_engine::carry(&c.program, (&was.program, state), &common);
    let (state, delays) =
        carried.map_err(|f| say!("the changed chart cannot go on here: {}", fault(f.kind)))?;
    match delays {
        0 => {}
        1 => lost.push(say!("a running delay restarts")),
        n => lost.push(say!("{n} running delays restart")),
    }
    Ok(state)
}

/// The charts and expansions that exist in both documents. Tasks are left out: they restart,
/// because their callers decide where they stand.
fn kept_charts<'d>(new: &'d Document, old: &'d Document) -> BTreeSet<&'d str> {
    let of = |d: &'d Document| -> BTreeSet<&'d str> {
        d.charts().filter(|c| c.kind == ChartKind::Chart).map(|c| &*c.name.text).collect()
    };
    of(new).intersection(&of(old)).copied().collect()
}

/// The one of some charts with whose name the path of a step begins. A name can have dots: `left.Cycle`.
fn chart_of<'p>(path: &'p str, charts: &BTreeSet<&str>) -> Option<&'p str> {
    let mut heads = path.match_indices('.').filter_map(|(dot, _)| path.get(..dot));
    heads.find(|head| charts.contains(head))
}

fn tasks(document: &Document) -> impl Iterator<Item = &Chart> {
    document.charts().filter(|c| c.kind == ChartKind::Task)
}

/// The tasks that are being executed.
fn at_work(document: &Document, was: &Compiled, state: &State) -> Vec<String> {
    let initial = &was.program.tables().initial;
    let busy = |task: &str| {
        let within = |path: &str| path.strip_prefix(task).is_some_and(|rest| rest.starts_with('.'));
        let own = |s: &StepId| within(was.symbols.step_path(*s));
        state.active().filter(own).any(|s| !initial.contains(&s))
    };
    tasks(document).map(|t| t.name.text.to_string()).filter(|t| busy(t)).collect()
}

/// The steps of the old charts by a key that also identifies the internal step of a macro-step.
fn partners(symbols: &Symbols) -> BTreeMap<String, StepId> {
    (0..symbols.steps()).map(StepId).map(|s| (key(symbols, s), s)).collect()
}

fn key(symbols: &Symbols, step: StepId) -> String {
    let path = symbols.step_path(step);
    if symbols.is_listed(step) { path.to_owned() } else { format!("{path}.@") }
}

/// The pairs of words of variables that exist in both with the same type. Reports the values that
/// are lost.
fn words(c: &Compiled, was: &Compiled, state: &State, lost: &mut Vec<Said>) -> Vec<(Addr, Addr)> {
    let old: BTreeMap<&str, &Variable> = was.symbols.variables.iter().map(|v| (&*v.name, v)).collect();
    let lasting = |v: &Variable| !matches!(v.class, VarClass::Const | VarClass::Local);
    let (drives, drove) = (driven(c), driven(was));
    let mut words = Vec::new();
    let mut kept = BTreeSet::new();
    for v in c.symbols.variables.iter().filter(|v| lasting(v)) {
        let fits = |o: &&&Variable| lasting(o) && o.ty == v.ty && is_held(v, o, state);
        let Some(o) = old.get(&*v.name).filter(fits) else { continue };
        kept.insert(&*v.name);
        // If an action was removed, its variable returns to its initial value.
        if drove.contains(&o.addr) && !drives.contains(&v.addr) {
            continue;
        }
        let count = v.words().min(o.words());
        words.extend((0..count).map(|k| (Addr(v.addr.0 + k), Addr(o.addr.0 + k))));
    }
    let fresh = State::new(&was.program);
    for o in was.symbols.variables.iter().filter(|o| lasting(o) && o.class != VarClass::System) {
        // The members of an instance have no name of their own, so the instance reports their loss.
        if kept.contains(&*o.name) || o.value(state) == o.value(&fresh) || o.class == VarClass::Input {
            continue;
        }
        let value = Said::foreign(Symbols::value_text(o.ty, o.value(state)));
        let now = c.symbols.variable(&o.name);
        lost.push(match now {
            Some(v) => {
                let (mut before, mut now) = (declared(o, Held::declared), declared(v, Held::declared));
                if before == now {
                    (before, now) = (declared(o, Held::meaning), declared(v, Held::meaning));
                }
                let (before, now) = (Said::foreign(before), Said::foreign(now));
                say!("`{}` was {before} and is {now}: its value {value} is lost", o.name)
            }
            None if value.is_empty() => say!("`{}` no longer exists", o.name),
            None => say!("`{}`, which is {value}, no longer exists", o.name),
        });
    }
    words
}

/// True if the changed variable can have the old value, and this means the same: a number within the bounds, or the number
/// of a value with the same name.
fn is_held(now: &Variable, before: &Variable, state: &State) -> bool {
    if now.held == before.held {
        return true;
    }
    let number = before.value(state).first().map_or(0, |word| i128::from(*word as i64));
    let name = |v: &'_ Variable| v.held.as_ref().and_then(|held| held.name_of(number).map(str::to_owned));
    now.held.as_ref().is_none_or(|held| held.admits(number)) && name(now) == name(before)
}

/// The type of a variable as text; `told` tells an enumeration or a type with bounds.
fn declared(v: &Variable, told: fn(&Held, Type) -> String) -> String {
    v.held.as_ref().map_or_else(|| v.ty.to_string(), |held| told(held, v.ty))
}

/// The variables that are driven by steps and control blocks.
fn driven(c: &Compiled) -> BTreeSet<Addr> {
    let tables = c.program.tables();
    let direct = tables.steps.iter().map(|s| s.direct);
    direct.chain(tables.blocks.iter().map(|b| b.output)).filter(|a| a.0 != NONE).collect()
}

/// The pairs of control blocks with the same name.
fn blocks(c: &Compiled, was: &Compiled) -> Vec<(u32, u32)> {
    let named = |s: &Symbols| -> BTreeMap<Box<str>, u32> {
        (0u32..)
            .zip(&s.blocks)
            .filter(|(_, b)| !b.name.is_empty())
            .map(|(i, b)| (b.name.clone(), i))
            .collect()
    };
    let old = named(&was.symbols);
    named(&c.symbols).into_iter().filter_map(|(name, i)| Some((i, *old.get(&name)?))).collect()
}

/// Continues the plant, as far as it is unchanged.
fn plant(
    bench: &Bench,
    before: &Bench,
    run: &Runner,
    runner: &mut Runner,
    lost: &mut Vec<Said>,
) -> Result<(), Said> {
    let (Some(side), Some(old), Some((_, state))) = (&bench.plant, &before.plant, run.plant()) else {
        if let Some(old) = &before.plant {
            lost.push(say!("the plant `{}` no longer exists", old.name));
        }
        return Ok(());
    };
    let mut words = words(&side.compiled, &old.compiled, state, lost);
    words.extend(side.compiled.symbols.seed.zip(old.compiled.symbols.seed));
    let common = Common { words: &words, ..Common::default() };
    let carried = g7_engine::carry(&side.compiled.program, (&old.compiled.program, state), &common);
    let (state, _) = carried.map_err(|f| say!("the changed plant cannot go on here: {}", fault(f.kind)))?;
    runner.set_plant_state(state);
    Ok(())
}
