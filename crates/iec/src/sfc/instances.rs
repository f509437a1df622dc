//! Makes a unit of each instance of a function block with a chart: a chart that is called as the instance is.
//!
//! ```text
//! read (Source) -> instances -> blocks -> build
//! ```
//!
//! A program that calls such an instance is split there: its body runs up to the call and gives the inputs, then
//! the charts evolve, and the rest of the body runs behind them. A chart that is called on a condition waits for a
//! variable that the call sets.

use std::collections::{HashMap, HashSet};

use g7_model::visit_mut::{self, Use, Visitor};
use g7_model::{Arg, Name, Path, Problem, Said, Span, Stmt, StmtKind, Type, VarKind, codes, say};

use super::singles;
use super::unit::{Instance, Part, Source, Unit, UnitKind};
use crate::nodes::{self, Taken};
use crate::report::Report;
use crate::st::{Section, Variable};

/// The most elements of all instances together.
const MOST: usize = 200_000;

/// Replaces the instances in programs without a chart of their own.
pub(super) fn expand(source: &mut Source, report: &mut Report) {
    let is_block = |u: &Unit| u.kind == UnitKind::FunctionBlock && u.is_chart();
    if !source.units.iter().any(is_block) {
        return;
    }
    own_globals(source);
    singles::expand(source, report);
    let mut taken = Taken::default();
    let of_globals = source.globals.iter().chain(source.units.iter().flat_map(|u| &u.vars));
    let is_instance = |v: &&Variable| v.unknown.is_some();
    for name in of_globals.filter(|v| !is_instance(v)).flat_map(|v| &v.decl.names) {
        taken.take(&name.text);
    }
    source.units.iter().filter(|u| !is_block(u)).for_each(|u| _ = taken.take(&u.name.text));
    let (mut used, mut left) = (HashSet::new(), MOST);
    let mut made: Vec<(String, Unit)> = Vec::new();
    for number in 0..source.units.len() {
        let Some(program) = source.units.get(number) else { continue };
        if program.kind != UnitKind::Program || program.is_chart() {
            continue;
        }
        let title = program.name.text.to_string();
        let mut charts = HashMap::new();
        for variable in program.vars.iter().filter(|v| v.section != Section::External) {
            let Some((ty, name)) = variable.unknown.as_ref().zip(variable.decl.names.first()) else {
                continue;
            };
            let named = |u: &&Unit| is_block(u) && u.name.text.eq_ignore_ascii_case(&ty.text);
            let Some(block) = source.units.iter().find(named) else { continue };
            used.insert(block.name.text.to_uppercase());
            let size = block.parts.len() + block.vars.len() + 1;
            if size > left {
                let what = say!("more instances of function blocks than are read");
                report.put(Problem::new(&codes::TOO_LARGE, variable.decl.at.0, what));
                continue;
            }
            left -= size;
            let own = taken.give(&name.text);
            if own != *name.text {
                let what = say!("something else is called `{}`; the chart is called `{own}`", name.text);
                report.put(Problem::new(&codes::RENAMED, name.at.0, what));
            }
            let given = block.vars.iter().filter(|v| v.section == Section::Input);
            let inputs = given.flat_map(|v| v.decl.names.clone()).collect();
            let unit = instance(block, Name::new(own.clone(), name.at.0), report);
            let flag = flag(&unit);
            let chart = Chart { name: own, vars: unit.vars.clone(), inputs, flag };
            charts.insert(name.text.to_uppercase(), chart);
            made.push((title.clone(), unit));
        }
        if let Some(program) = source.units.get_mut(number).filter(|_| !charts.is_empty()) {
            program.vars.retain(|v| {
                let own = v.decl.names.first().map_or(String::new(), |n| n.text.to_uppercase());
                v.unknown.is_none() || !charts.contains_key(&own)
            });
            let (idle, sometimes) = split(program, &charts, report);
            made.retain(|(_, unit)| !idle.contains(&*unit.name.text));
            for (_, unit) in &mut made {
                if let Some(flag) = sometimes.get(&*unit.name.text) {
                    wait(unit, flag);
                }
            }
        }
    }
    source.units.retain(|u| !is_block(u) || !used.contains(&u.name.text.to_uppercase()));
    for (program, unit) in made {
        // The chart runs in the task of its program, behind that.
        let runs = |i: &Instance| i.unit.text.eq_ignore_ascii_case(&program);
        if let Some(place) = source.instances.iter().position(runs)
            && let Some(task) = source.instances.get(place).map(|i| i.task.clone())
        {
            let (name, links) = (unit.name.clone(), Vec::new());
            let run = Instance { name, task, unit: unit.name.clone(), links, at: unit.at };
            source.instances.insert(place + 1, run);
        }
        source.units.push(unit);
    }
}

/// Gives a global instance to the only program that uses it. Of others the reader tells that they are not read.
fn own_globals(source: &mut Source) {
    let is_block = |u: &&Unit| u.kind == UnitKind::FunctionBlock && u.is_chart();
    let blocks: HashSet<String> =
        source.units.iter().filter(is_block).map(|u| u.name.text.to_uppercase()).collect();
    let units = &mut source.units;
    source.globals.retain(|global| {
        let Some((ty, name)) = global.unknown.as_ref().zip(global.decl.names.first()) else { return true };
        if !blocks.contains(&ty.text.to_uppercase()) {
            return true;
        }
        let of = |v: &Variable| {
            v.section == Section::External && v.decl.names.first().is_some_and(|n| same(n, name))
        };
        let mut users = units.iter_mut().filter(|u| u.vars.iter().any(of));
        let (Some(user), None) = (users.next(), users.next()) else { return true };
        let is_program = user.kind == UnitKind::Program && !user.is_chart();
        for variable in user.vars.iter_mut().filter(|v| is_program && of(v)) {
            variable.section = Section::Local;
        }
        !is_program
    });
}

/// A chart that stands for an instance.
struct Chart {
    name: String,
    vars: Vec<Variable>,
    /// Its inputs, in their order.
    inputs: Vec<Name>,
    /// The name of a variable that tells whether it is called, where that has a condition.
    flag: String,
}

/// A name for the variable that tells whether a chart is called, which nothing else of it has.
fn flag(unit: &Unit) -> String {
    let mut taken = Taken::default();
    unit.vars.iter().flat_map(|v| &v.decl.names).for_each(|n| _ = taken.take(&n.text));
    for part in &unit.parts {
        if let Part::Step { name, .. } | Part::Action { name, .. } = part {
            taken.take(&name.text);
        }
    }
    taken.give("Called")
}

/// The transitions and bodies of a chart wait until it is called.
fn wait(unit: &mut Unit, flag: &str) {
    let at = unit.name.at.0;
    let called = || nodes::name(&[flag], at);
    for part in &mut unit.parts {
        match part {
            Part::Transition(t) => t.receptivity = nodes::and(called(), t.receptivity.clone(), at),
            Part::Action { body, .. } if !body.is_empty() => {
                *body = vec![nodes::when(called(), std::mem::take(body), Vec::new(), at)];
            }
            Part::Action { .. } | Part::Step { .. } => {}
        }
    }
    let decl = nodes::variable(VarKind::Var, flag, Type::Bool, at);
    unit.vars.push(Variable { section: Section::Local, decl, unknown: None });
}

/// The unit of one instance: its inputs and outputs are variables that its program uses.
fn instance(block: &Unit, name: Name, report: &mut Report) -> Unit {
    let mut unit = block.clone();
    unit.name = name;
    for variable in &mut unit.vars {
        if variable.section == Section::InOut {
            let what = say!(
                "a variable of both directions of a block with a chart: nothing outside is changed by it"
            );
            report.put(Problem::new(&codes::NOT_CARRIED, variable.decl.at.0, what));
        }
        if matches!(variable.section, Section::Input | Section::Output | Section::InOut) {
            variable.section = Section::Local;
            if variable.decl.kind != VarKind::Const {
                variable.decl.kind = VarKind::Var;
            }
        }
    }
    unit
}

/// Splits the body of a program where it calls charts. Returns the charts that it never calls, and the flags of
/// those that it calls on a condition.
fn split(
    program: &mut Unit,
    charts: &HashMap<String, Chart>,
    report: &mut Report,
) -> (HashSet<String>, HashMap<String, String>) {
    let mut body = std::mem::take(&mut program.body);
    visit_mut::stmts(&mut body, &mut Inside { charts });
    let most: HashMap<&str, usize> =
        charts.values().map(|c| (c.name.as_str(), most(&body, &c.name))).collect();
    let calls = |s: &Stmt| charts.values().any(|c| most_in(s, &c.name) > 0);
    let last = body.iter().rposition(calls);
    let first = body.iter().position(calls);
    if last.is_some() && body.iter().any(Stmt::returns) {
        let what = say!("RETURN in a program that calls a chart: the chart would evolve behind it");
        report.put(Problem::new(&codes::NOT_CARRIED, program.name.at.0, what));
    }
    for chart in charts.values().filter(|c| most.get(c.name.as_str()).is_some_and(|n| *n > 1)) {
        let what = say!("`{}` is called twice in a scan; its chart evolves once", chart.name);
        let at = body.iter().rfind(|s| most_in(s, &chart.name) > 0);
        report.put(Problem::new(&codes::NOT_CARRIED, at.map_or(program.name.at.0, |s| s.at.0), what));
    }
    let mut turns =
        Turns { charts, report, given: Reads::default(), flags: HashMap::new(), behind: Vec::new() };
    let mut late = Vec::new();
    for (number, stmt) in body.into_iter().enumerate() {
        if last.is_some_and(|last| number > last) {
            late.push(stmt);
            continue;
        }
        if first.is_some_and(|f| f < number) && !calls(&stmt) {
            turns.report.put(Problem::new(&codes::DIFFERENT, stmt.at.0, of_before()));
        }
        let list = turns.list(vec![stmt], false);
        program.body.extend(list);
    }
    program.behind.append(&mut turns.behind);
    program.behind.append(&mut late);
    let flags = turns.flags;
    let mut reset: Vec<&Chart> = charts.values().filter(|c| flags.contains_key(&c.name)).collect();
    reset.sort_by(|a, b| b.name.cmp(&a.name));
    for chart in reset {
        let at = program.name.at.0;
        let flag = nodes::name(&[&chart.name, &chart.flag], at);
        program.body.insert(0, nodes::assign(flag, nodes::boolean(false, at), at));
    }
    let mut idle = HashSet::new();
    for chart in charts.values().filter(|c| most.get(c.name.as_str()) == Some(&0)) {
        let what = say!("the instance `{}` is never called; it is left out", chart.name);
        report.put(Problem::new(&codes::LEFT_OUT, program.name.at.0, what));
        idle.insert(chart.name.clone());
    }
    (idle, flags)
}

/// Told of a statement between calls of charts.
fn of_before() -> Said {
    say!("charts of called blocks evolve together, behind this; what it reads of them is of the scan before")
}

/// The most calls of a chart in one run of a list.
fn most(list: &[Stmt], chart: &str) -> usize {
    list.iter().map(|s| most_in(s, chart)).sum()
}

fn most_in(stmt: &Stmt, chart: &str) -> usize {
    if let StmtKind::Call(path, _) = &stmt.kind {
        return usize::from(path.text() == chart);
    }
    let most = stmt.lists().into_iter().map(|list| most(list, chart)).max().unwrap_or(0);
    // A loop can call it again and again.
    if stmt.is_loop() { 2 * most } else { most }
}

/// Puts the assignments of their inputs in the place of calls.
struct Turns<'c, 'r> {
    charts: &'c HashMap<String, Chart>,
    report: &'r mut Report,
    given: Reads,
    /// The flags of charts that are called on a condition, by the chart.
    flags: HashMap<String, String>,
    /// The statements that run behind the charts.
    behind: Vec<Stmt>,
}

impl Turns<'_, '_> {
    fn list(&mut self, list: Vec<Stmt>, guarded: bool) -> Vec<Stmt> {
        let mut made = Vec::new();
        for mut stmt in list {
            let charts = self.charts;
            if let StmtKind::Call(path, args) = &mut stmt.kind {
                let text = path.text();
                if let Some(chart) = charts.values().find(|c| *c.name == *text) {
                    let args = std::mem::take(args);
                    made.extend(self.call(chart, &args, stmt.at.0, guarded));
                    continue;
                }
            }
            visit_mut::lists(&mut stmt, |list| *list = self.list(std::mem::take(list), true));
            made.push(stmt);
        }
        made
    }

    fn call(&mut self, chart: &Chart, args: &[Arg], at: Span, guarded: bool) -> Vec<Stmt> {
        let (mut inputs, mut outputs) = passed(chart, args, at, self.report);
        let mut reads = Reads::default();
        visit_mut::stmts(&mut inputs, &mut reads);
        let of_chart = |name: &String| self.charts.values().any(|c| c.name == *name);
        if reads.names.iter().any(|n| of_chart(n) || self.given.written.contains(n)) {
            self.report.put(Problem::new(&codes::DIFFERENT, at, of_before()));
        }
        visit_mut::stmts(&mut outputs.clone(), &mut self.given);
        if guarded {
            let title = &chart.name;
            let what = say!(
                "`{title}` is called on a condition: its chart evolves behind the body, while it is called"
            );
            self.report.put(Problem::new(&codes::DIFFERENT, at, what));
            self.flags.insert(chart.name.clone(), chart.flag.clone());
            let flag = nodes::name(&[&chart.name, &chart.flag], at);
            inputs.push(nodes::assign(flag.clone(), nodes::boolean(true, at), at));
            if !outputs.is_empty() {
                outputs = vec![nodes::when(flag, outputs, Vec::new(), at)];
            }
        }
        self.behind.extend(outputs);
        inputs
    }
}

/// The assignments of a call: to the inputs, and from the outputs.
fn passed(chart: &Chart, args: &[Arg], at: Span, report: &mut Report) -> (Vec<Stmt>, Vec<Stmt>) {
    let (mut inputs, mut outputs) = (Vec::new(), Vec::new());
    for (number, arg) in args.iter().enumerate() {
        let meant = match &arg.name {
            Some(given) => chart.vars.iter().flat_map(|v| &v.decl.names).find(|n| same(n, given)),
            None => chart.inputs.get(number),
        };
        let Some(name) = meant else {
            let given = arg.name.as_ref().map_or("", |n| &*n.text);
            let what = say!("the function block of `{}` has no input `{given}`", chart.name);
            report.put(Problem::new(&codes::UNKNOWN_OBJECT, arg.value.at.0, what));
            continue;
        };
        let inner = nodes::name(&[&chart.name, &name.text], at);
        if arg.output {
            outputs.push(nodes::assign(arg.value.clone(), inner, at));
        } else {
            inputs.push(nodes::assign(inner, arg.value.clone(), at));
        }
    }
    (inputs, outputs)
}

/// The first names of what statements read and write.
#[derive(Default)]
struct Reads {
    names: HashSet<String>,
    written: HashSet<String>,
}

impl Visitor for Reads {
    fn path(&mut self, path: &mut Path, how: Use, _: Span) {
        let Some(first) = path.names.first() else { return };
        let all = if how == Use::Write { &mut self.written } else { &mut self.names };
        all.insert(first.text.to_string());
    }
}

fn same(a: &Name, b: &Name) -> bool {
    a.text.eq_ignore_ascii_case(&b.text)
}

/// Gives instances and their variables the spelling of their declarations.
struct Inside<'c> {
    charts: &'c HashMap<String, Chart>,
}

impl Visitor for Inside<'_> {
    fn path(&mut self, path: &mut Path, _: Use, _: Span) {
        let Some(chart) = path.names.first().and_then(|n| self.charts.get(&n.text.to_uppercase())) else {
            return;
        };
        let mut names = path.names.iter_mut();
        if let Some(first) = names.next() {
            first.text = chart.name.as_str().into();
        }
        if let Some(second) = names.next()
            && let Some(own) = chart.vars.iter().flat_map(|v| &v.decl.names).find(|n| same(n, second))
        {
            second.text = own.text.clone();
        }
    }
}
