//! The names of charts, steps, transitions and variables in the document.
//!
//! References of the file use positions, so its names may be missing, equal or strange; names of a
//! document may not.

use std::collections::{HashMap, HashSet};

use g7_model::{Expr, ExprKind, Literal, Name, Nanos, Path, Problem, Span, Type, codes, say};

use super::read::{DEFAULT_NAME, Plan, Sheet, StepSort, Thing, VarSort};
use super::refs::Xml;
use super::timed;
use g7_iec::nodes::Taken;
use g7_iec::report::{Report, shown};
use g7_iec::xml::attr;

/// The names of the document.
pub(super) struct Names {
    charts: Vec<String>,
    steps: Vec<Vec<String>>,
    labels: Vec<Vec<Option<String>>>,
    vars: Vec<String>,
    /// The Booleans that stand for a time operator on the activity of a step.
    timed: HashMap<usize, (Nanos, (usize, usize))>,
    /// The number of steps in all charts with each name.
    uses: HashMap<String, usize>,
    /// The names of the variables of the file and of each chart.
    shadows: HashSet<(Option<usize>, String)>,
}

/// Gives every chart, step, transition and variable its name.
pub(super) fn give(plan: &Plan, report: &mut Report) -> Names {
    let vars = variables(plan, report);
    let charts = charts(plan, &vars, report);
    let steps: Vec<Vec<String>> = plan.sheets.iter().map(|s| steps(s, report)).collect();
    let mut uses: HashMap<String, usize> = HashMap::new();
    for name in steps.iter().flatten() {
        *uses.entry(name.clone()).or_default() += 1;
    }
    let labels = plan.sheets.iter().map(|s| labels(s, report)).collect();
    let timed = timed(plan, &vars, &steps, report);
    let real = plan.vars.iter().zip(&vars).filter(|(v, _)| v.sort != VarSort::Step);
    let shadows = real.map(|(v, name)| (v.sheet, name.clone())).collect();
    Names { charts, steps, labels, vars, timed, uses, shadows }
}

impl Names {
    pub(super) fn chart(&self, sheet: usize) -> &str {
        self.charts.get(sheet).map_or("", String::as_str)
    }

    pub(super) fn step(&self, sheet: usize, step: usize) -> &str {
        self.steps.get(sheet).and_then(|s| s.get(step)).map_or("", String::as_str)
    }

    pub(super) fn label(&self, sheet: usize, transition: usize) -> Option<&str> {
        self.labels.get(sheet)?.get(transition)?.as_deref()
    }

    pub(super) fn var(&self, var: usize) -> &str {
        self.vars.get(var).map_or("", String::as_str)
    }

    /// True if a variable stands for a time operator, so that it needs no declaration.
    pub(super) fn is_timed(&self, var: usize) -> bool {
        self.timed.contains_key(&var)
    }

    /// The time operator for which a variable stands, in a text of a chart.
    pub(super) fn timer(&self, var: usize, from: usize, at: Span) -> Option<Expr> {
        let (time, step) = self.timed.get(&var)?;
        let t1 = Expr { kind: ExprKind::Literal(Literal::Time(*time)), at: at.into() };
        let e = self.activity(*step, from, at);
        Some(Expr { kind: ExprKind::Timer { t1: Box::new(t1), e: Box::new(e), t2: None }, at: at.into() })
    }

    /// The path of a variable in a text of a chart.
    pub(super) fn path_of_var(&self, plan: &Plan, var: usize, from: usize, at: Span) -> Path {
        let name = self.var(var).to_string();
        let holder = plan.vars.get(var).and_then(|v| v.sheet).filter(|s| *s != from);
        path(holder.map(|s| self.chart(s).to_string()).into_iter().chain([name]), at)
    }

    /// The activity of a step in a text of a chart.
    pub(super) fn activity(&self, (sheet, step): (usize, usize), from: usize, at: Span) -> Expr {
        let name = self.step(sheet, step);
        let short = short_activity(name);
        let first = short.clone().unwrap_or_else(|| name.to_string());
        let hidden = self.shadows.contains(&(None, first.clone()))
            || self.shadows.contains(&(Some(from), first.clone()));
        let near = sheet == from || self.uses.get(name) == Some(&1);
        let mut names = Vec::new();
        if hidden || !near {
            names.push(self.chart(sheet).to_string());
        }
        match short {
            Some(short) => names.push(short),
            None => names.extend([name.to_string(), "X".to_string()]),
        }
        Expr { kind: ExprKind::Path(path(names, at)), at: at.into() }
    }
}

/// The activity of a step as one word, `X12` or `XM3`, if it has such a form.
pub(super) fn short_activity(step: &str) -> Option<String> {
    let number = step.strip_prefix(['M', 'E', 'S']).unwrap_or(step);
    let whole = !number.is_empty() && number.bytes().all(|b| b.is_ascii_digit());
    whole.then(|| format!("X{step}"))
}

fn path(names: impl IntoIterator<Item = String>, at: Span) -> Path {
    Path { names: names.into_iter().map(|n| Name::new(n, at)).collect() }
}

/// A name without the characters that back-ticks cannot hold.
fn writable(name: &str) -> String {
    let put = |c: char| match c {
        '`' => '\'',
        c if c.is_control() => ' ',
        c => c,
    };
    name.chars().map(put).collect()
}

/// The name of an element; reports if it had to be changed.
fn clean(xml: Xml, report: &mut Report) -> Option<String> {
    let name = attr::text(xml, "name")?;
    let text = writable(&name.text);
    if text != name.text {
        let what = say!("a back-tick or line end in the name `{}` is written otherwise", shown(&text));
        report.say(&codes::RENAMED, &name.at, what);
    }
    (!text.trim().is_empty()).then_some(text)
}

fn variables(plan: &Plan, report: &mut Report) -> Vec<String> {
    let mut spaces: HashMap<Option<usize>, Taken> = HashMap::new();
    let mut names = Vec::with_capacity(plan.vars.len());
    for (number, var) in plan.vars.iter().enumerate() {
        let at = attr::head(var.xml);
        // Variables for the activity of a step are named after the step, so several may have the
        // same name.
        if var.sort == VarSort::Step {
            names.push(String::new());
            continue;
        }
        let wanted = clean(var.xml, report).unwrap_or_else(|| {
            let name = format!("v{number}");
            let what = say!("a variable without a name; it is called `{name}`");
            report.say(&codes::RENAMED, &at, what);
            name
        });
        let taken = spaces.entry(var.sheet).or_insert_with(Taken::exact);
        if taken.has(&wanted) {
            let what = say!("a second variable is called `{}`; it is renamed", shown(&wanted));
            report.say(&codes::TWICE, &at, what);
        }
        let name = taken.give(&wanted);
        names.push(name);
    }
    names
}

/// The Booleans that are named like a time operator on a step that is there, `2s/X202`. One that an
/// action writes is a variable nevertheless.
fn timed(
    plan: &Plan,
    vars: &[String],
    steps: &[Vec<String>],
    report: &mut Report,
) -> HashMap<usize, (Nanos, (usize, usize))> {
    let mut found = HashMap::new();
    let mut written: Option<HashSet<usize>> = None;
    for (number, (var, name)) in plan.vars.iter().zip(vars).enumerate() {
        if var.sort == VarSort::Output || var.ty != Type::Bool {
            continue;
        }
        let Some((time, step)) = timed::parse(name) else { continue };
        let all = steps.iter().enumerate().flat_map(|(sheet, names)| {
            names.iter().enumerate().filter(|(_, n)| *n == step).map(move |(i, _)| (sheet, i))
        });
        let all: Vec<(usize, usize)> = all.take(2).collect();
        let set = written.get_or_insert_with(|| set_by_actions(plan)).contains(&number);
        let what = match all[..] {
            _ if set => say!("`{}` stays a variable, because an action writes it", shown(name)),
            [one] => {
                found.insert(number, (time, one));
                say!("the Boolean `{}` is read as the time operator that its name says", shown(name))
            }
            [] => say!("`{}` stays a variable: there is no step `{}`", shown(name), shown(step)),
            _ => {
                say!("`{}` stays a variable: several steps are called `{}`", shown(name), shown(step))
            }
        };
        report.say(&codes::DIFFERENT, &attr::head(var.xml), what);
    }
    found
}

/// The variables that actions write.
fn set_by_actions(plan: &Plan) -> HashSet<usize> {
    let targets = plan.actions.iter().flat_map(|a| a.children().filter(|c| c.has_tag_name("variable")));
    let meant = targets.filter_map(|v| plan.refs.resolve(v.attribute("variableDeclaration")?.trim()).ok());
    meant
        .filter_map(|xml| match plan.things.get(&xml.id()) {
            Some(Thing::Var(number)) => Some(*number),
            _ => None,
        })
        .collect()
}

fn charts(plan: &Plan, vars: &[String], report: &mut Report) -> Vec<String> {
    let mut taken = Taken::exact();
    vars.iter().filter(|v| !v.is_empty()).for_each(|name| _ = taken.take(name));
    let mut names = Vec::with_capacity(plan.sheets.len());
    for sheet in &plan.sheets {
        let wanted = clean(sheet.xml, report).unwrap_or_else(|| DEFAULT_NAME.to_string());
        let name = taken.give(&wanted);
        if name != wanted {
            let what = say!(
                "`{}` is also the name of something else; the chart is called `{}`",
                shown(&wanted),
                shown(&name)
            );
            report.say(&codes::RENAMED, &attr::head(sheet.xml), what);
        }
        names.push(name);
    }
    names
}

/// The identifier of a node as a number; 0 if missing.
fn number(xml: Xml, report: &mut Report) -> String {
    let text = xml.attribute("id").unwrap_or("0").trim();
    if text.parse::<i64>().is_err() {
        let at = attr::text(xml, "id").map_or_else(|| attr::head(xml), |t| t.at);
        report.say(&codes::BAD_VALUE, &at, say!("the identifier `{}` is no whole number", shown(text)));
    }
    writable(text)
}

fn steps(sheet: &Sheet, report: &mut Report) -> Vec<String> {
    let mut taken = Taken::exact();
    let mut first: HashMap<String, Span> = HashMap::new();
    let mut names = Vec::with_capacity(sheet.steps.len());
    for step in &sheet.steps {
        let number = number(step.xml, report);
        let wanted = match step.sort {
            StepSort::Plain | StepSort::Enclosing => number,
            StepSort::Macro => format!("M{number}"),
            StepSort::Entry => format!("E{number}"),
            StepSort::Exit => format!("S{number}"),
        };
        let at = report.span(&attr::head(step.xml));
        let name = taken.give(&wanted);
        match first.get(&wanted) {
            Some(other) => {
                let what = say!("a second step `{}`; it is called `{}`", shown(&wanted), shown(&name));
                report.put(
                    Problem::new(&codes::RENAMED, at, what).related(*other, say!("the first of this number")),
                );
            }
            None => {
                first.insert(wanted, at);
            }
        }
        names.push(name);
    }
    names
}

/// The label of each transition, `T12` for transition 12.
fn labels(sheet: &Sheet, report: &mut Report) -> Vec<Option<String>> {
    let mut taken = Taken::exact();
    let mut names = Vec::with_capacity(sheet.transitions.len());
    for xml in &sheet.transitions {
        if xml.attribute("id").is_none() {
            names.push(None);
            continue;
        }
        let wanted = format!("T{}", number(*xml, report));
        let name = taken.give(&wanted);
        if name != wanted {
            let what = say!("a second transition `{}`; it is called `{}`", shown(&wanted), shown(&name));
            report.say(&codes::RENAMED, &attr::head(*xml), what);
        }
        names.push(Some(name));
    }
    names
}
