//! Makes a unit of each instance of a function block with a chart: a chart that is called as the instance is.
//!
//! ```text
//! read (Source) -> instances -> blocks -> build
//! ```
//!
//! A program that calls such an instance is split there: its body runs up to the call and gives the inputs, then
//! the charts evolve, and the rest of the body runs behind them.

use std::collections::{HashMap, HashSet};

use g7_model::visit_mut::{self, Use, Visitor};
use g7_model::{Arg, Name, Path, Problem, Span, Stmt, StmtKind, VarKind, codes, say};

use super::unit::{Instance, Source, Unit, UnitKind};
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
            charts.insert(name.text.to_uppercase(), Chart { name: own, vars: unit.vars.clone(), inputs });
            made.push((title.clone(), unit));
        }
        if let Some(program) = source.units.get_mut(number).filter(|_| !charts.is_empty()) {
            program.vars.retain(|v| {
                let own = v.decl.names.first().map_or(String::new(), |n| n.text.to_uppercase());
                v.unknown.is_none() || !charts.contains_key(&own)
            });
            for idle in split(program, &charts, report) {
                made.retain(|(_, unit)| *unit.name.text != *idle);
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
            let run = Instance { task, unit: unit.name.clone(), links: Vec::new(), at: unit.at };
            source.instances.insert(place + 1, run);
        }
        source.units.push(unit);
    }
}

/// A chart that stands for an instance.
struct Chart {
    name: String,
    vars: Vec<Variable>,
    /// Its inputs, in their order.
    inputs: Vec<Name>,
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

/// Splits the body of a program where it calls charts. Returns the charts that it never calls.
fn split(program: &mut Unit, charts: &HashMap<String, Chart>, report: &mut Report) -> Vec<String> {
    let mut body = std::mem::take(&mut program.body);
    visit_mut::stmts(&mut body, &mut Inside { charts });
    let called = |s: &Stmt| match &s.kind {
        StmtKind::Call(path, _) => charts.values().find(|c| *c.name == *path.text()),
        _ => None,
    };
    let last = body.iter().rposition(|s| called(s).is_some());
    let first = body.iter().position(|s| called(s).is_some());
    if last.is_some() && super::blocks::returns(&body, true) {
        let what = say!("RETURN in a program that calls a chart: the chart would evolve behind it");
        report.put(Problem::new(&codes::NOT_CARRIED, program.name.at.0, what));
    }
    let mut seen = HashSet::new();
    let mut given = Reads::default();
    for (number, stmt) in body.into_iter().enumerate() {
        let Some(chart) = called(&stmt) else {
            if first.is_some_and(|f| f < number) && last.is_some_and(|l| number < l) {
                let what = say!(
                    "charts of called blocks evolve together, behind this; what it reads of them is of the scan before"
                );
                report.put(Problem::new(&codes::DIFFERENT, stmt.at.0, what));
            }
            within(&stmt, charts, &mut seen, report);
            let late = last.is_some_and(|last| number > last);
            if late { &mut program.behind } else { &mut program.body }.push(stmt);
            continue;
        };
        let StmtKind::Call(_, args) = &stmt.kind else { continue };
        if !seen.insert(chart.name.clone()) {
            let what = say!("`{}` is called twice in a scan; its chart evolves once", chart.name);
            report.put(Problem::new(&codes::NOT_CARRIED, stmt.at.0, what));
        }
        let (mut inputs, outputs) = passed(chart, args, stmt.at.0, report);
        let mut reads = Reads::default();
        visit_mut::stmts(&mut inputs, &mut reads);
        let of_chart = |name: &String| charts.values().any(|c| c.name == *name);
        if reads.names.iter().any(|n| of_chart(n) || given.written.contains(n)) {
            let what = say!(
                "charts of called blocks evolve together, behind this; what it reads of them is of the scan before"
            );
            report.put(Problem::new(&codes::DIFFERENT, stmt.at.0, what));
        }
        visit_mut::stmts(&mut outputs.clone(), &mut given);
        program.body.extend(inputs);
        program.behind.extend(outputs);
    }
    let idle = charts.values().filter(|c| !seen.contains(&c.name));
    idle.map(|c| {
        let what = say!("the instance `{}` is never called; it is left out", c.name);
        report.put(Problem::new(&codes::LEFT_OUT, program.name.at.0, what));
        c.name.clone()
    })
    .collect()
}

/// Reports calls within a statement: there the chart stands still in some scans.
fn within(stmt: &Stmt, charts: &HashMap<String, Chart>, seen: &mut HashSet<String>, report: &mut Report) {
    let mut look = |list: &[Stmt]| {
        for stmt in list {
            if let StmtKind::Call(path, _) = &stmt.kind
                && let Some(chart) = charts.values().find(|c| *c.name == *path.text())
            {
                let what = say!(
                    "`{}` is called on a condition, so its chart stands still in some scans; it is carried over where it is called in every scan",
                    chart.name
                );
                report.put(Problem::new(&codes::NOT_CARRIED, stmt.at.0, what));
                seen.insert(chart.name.clone());
            }
            within(stmt, charts, seen, report);
        }
    };
    match &stmt.kind {
        StmtKind::If(arms, otherwise) => {
            arms.iter().for_each(|a| look(&a.1));
            look(otherwise);
        }
        StmtKind::Case(_, arms, otherwise) => {
            arms.iter().for_each(|a| look(&a.body));
            look(otherwise);
        }
        StmtKind::For { body, .. } | StmtKind::While(_, body) | StmtKind::Repeat(body, _) => look(body),
        StmtKind::Assign { .. } | StmtKind::Call(..) | StmtKind::Exit | StmtKind::Return => {}
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
