//! The names of charts, steps and variables in the document, and the meaning of dotted names in
//! texts.
//!
//! JGrafchart looks a name up in the workspace of the text, then in those around it, finally among
//! the top workspaces. A `.g7` chart sees its own variables and those of the file; all others are
//! written `Chart.name`. A variable of a top workspace therefore moves to the file if its name is
//! unique, and stays in its chart otherwise.

use std::collections::{HashMap, HashSet};

use g7_model::{codes, say};

use super::sheet::{Plan, Sheet, SheetKind, StepSort, name_place};
use g7_iec::nodes::Taken;
use g7_iec::report::{Report, shown};
use g7_iec::xml::attr::Text;

/// The most nested calls of procedures through which a parameter by reference is followed.
const MOST_CALLS: u8 = 50;

/// The names of the document.
pub(super) struct Names {
    /// The name of each workspace's chart.
    pub(super) charts: Vec<String>,
    /// The names of the steps of each workspace.
    pub(super) steps: Vec<Vec<String>>,
    /// For each variable, true if it is declared in the file, false if in its chart.
    pub(super) of_file: Vec<Vec<bool>>,
    vars: Vec<HashMap<String, usize>>,
    by_name: Vec<HashMap<String, usize>>,
}

/// The meaning of a dotted name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Meaning<'a> {
    /// A variable, input or output: its workspace and number.
    Var(usize, usize),
    /// A property of a step.
    Step(usize, usize, Property),
    /// An object that is not carried over, given by its element.
    Stranger(&'a str),
    /// A known object that has no such part.
    NoPart,
    /// No meaning.
    Nothing,
}

/// A property of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Property {
    /// `.x`: the activity.
    Active,
    /// `.t`: the number of scans since the activation.
    Scans,
    /// `.s`: the seconds since the activation.
    Seconds,
}

impl Property {
    fn of(word: &str) -> Option<Property> {
        match word {
            "x" => Some(Property::Active),
            "t" => Some(Property::Scans),
            "s" => Some(Property::Seconds),
            _ => None,
        }
    }

    /// The property as written.
    pub(super) fn word(self) -> &'static str {
        match self {
            Property::Active => "x",
            Property::Scans => "t",
            Property::Seconds => "s",
        }
    }
}

/// Gives every chart, step and variable its name.
pub(super) fn give(plan: &Plan, report: &mut Report) -> Names {
    let charts = chart_names(plan, report);
    let mut names = Names {
        steps: plan.sheets.iter().map(|s| step_names(s, report)).collect(),
        of_file: Vec::new(),
        vars: plan.sheets.iter().map(|s| variables(s, report)).collect(),
        by_name: plan.sheets.iter().map(steps_by_name).collect(),
        charts,
    };
    names.of_file = names.places(plan);
    names
}

impl Names {
    /// The variables that move to the file: those of top workspaces with a unique name.
    fn places(&self, plan: &Plan) -> Vec<Vec<bool>> {
        let mut uses: HashMap<&str, usize> = HashMap::new();
        for chart in &self.charts {
            *uses.entry(chart).or_default() += 1;
        }
        for var in plan.sheets.iter().flat_map(|s| &s.vars) {
            *uses.entry(&var.name.text).or_default() += 1;
        }
        let alone = |name: &str| uses.get(name) == Some(&1);
        let of = |s: &Sheet| s.vars.iter().map(|v| s.kind == SheetKind::Top && alone(&v.name.text)).collect();
        plan.sheets.iter().map(of).collect()
    }

    /// The meaning of a dotted name in a text of the workspace.
    pub(super) fn find<'a>(&self, plan: &'a Plan, sheet: usize, path: &[&str]) -> Meaning<'a> {
        self.look(plan, sheet, path, MOST_CALLS)
    }

    fn look<'a>(&self, plan: &'a Plan, sheet: usize, path: &[&str], depth: u8) -> Meaning<'a> {
        let mut here = Some(sheet);
        while let Some(index) = here {
            match self.find_in(plan, index, path, depth) {
                Meaning::Nothing => {}
                found => return found,
            }
            here = plan.sheets.get(index).and_then(|s| s.parent);
        }
        let Some((first, rest)) = path.split_first() else { return Meaning::Nothing };
        let top = plan.sheets.iter().position(|s| s.kind == SheetKind::Top && s.name.text == **first);
        match top {
            Some(index) if rest.is_empty() => self.find_in(plan, index, rest, depth),
            Some(index) => match self.find_in(plan, index, rest, depth) {
                Meaning::Nothing => Meaning::NoPart,
                found => found,
            },
            None => Meaning::Nothing,
        }
    }

    /// The meaning of a dotted name in one workspace.
    fn find_in<'a>(&self, plan: &'a Plan, index: usize, path: &[&str], depth: u8) -> Meaning<'a> {
        let (Some(sheet), Some((first, rest))) = (plan.sheets.get(index), path.split_first()) else {
            return Meaning::Nothing;
        };
        if let Some((caller, target)) = sheet.refs.get(*first) {
            let whole: Vec<&str> = target.iter().map(String::as_str).chain(rest.iter().copied()).collect();
            // The caller's name may itself be a parameter by reference, of its own caller.
            return if depth == 0 { Meaning::NoPart } else { self.look(plan, *caller, &whole, depth - 1) };
        }
        if rest.is_empty()
            && let Some(var) = self.vars.get(index).and_then(|v| v.get(*first))
        {
            return Meaning::Var(index, *var);
        }
        if let Some(&step) = self.by_name.get(index).and_then(|s| s.get(*first)) {
            return self.part_of_step(plan, sheet, (index, step), rest, depth);
        }
        if let Some((_, inside)) = sheet.objects.iter().find(|(name, _)| name == first) {
            return self.inside(plan, *inside, rest, depth);
        }
        match sheet.strangers.get(*first) {
            Some(tag) => Meaning::Stranger(tag),
            None if self.vars.get(index).is_some_and(|v| v.contains_key(*first)) => Meaning::NoPart,
            None => Meaning::Nothing,
        }
    }

    fn part_of_step<'a>(
        &self,
        plan: &'a Plan,
        sheet: &Sheet,
        (index, step): (usize, usize),
        rest: &[&str],
        depth: u8,
    ) -> Meaning<'a> {
        if let [word] = rest
            && let Some(property) = Property::of(word)
        {
            return Meaning::Step(index, step, property);
        }
        match sheet.steps.get(step).map(|s| s.sort) {
            Some(StepSort::Macro(Some(inside))) => self.inside(plan, inside, rest, depth),
            _ => Meaning::NoPart,
        }
    }

    fn inside<'a>(&self, plan: &'a Plan, index: usize, rest: &[&str], depth: u8) -> Meaning<'a> {
        match self.find_in(plan, index, rest, depth) {
            Meaning::Nothing => Meaning::NoPart,
            found => found,
        }
    }

    /// The name of a step in the document.
    pub(super) fn step(&self, sheet: usize, step: usize) -> &str {
        self.steps.get(sheet).and_then(|s| s.get(step)).map_or("", String::as_str)
    }

    /// The name of a workspace's chart.
    pub(super) fn chart(&self, sheet: usize) -> &str {
        self.charts.get(sheet).map_or("", String::as_str)
    }

    /// True if a variable is declared in the file.
    pub(super) fn is_of_file(&self, sheet: usize, var: usize) -> bool {
        self.of_file.get(sheet).and_then(|s| s.get(var)).copied().unwrap_or(false)
    }
}

/// A name without the characters that back-ticks cannot hold.
pub(super) fn writable(name: &str) -> String {
    let put = |c: char| match c {
        '`' => '\'',
        c if c.is_control() => ' ',
        c => c,
    };
    name.chars().map(put).collect()
}

/// The name of a chart, step or variable; reports if it had to be changed.
fn clean(name: &Text, at: &std::ops::Range<usize>, report: &mut Report) -> String {
    let text = writable(&name.text);
    if text != name.text {
        let what = say!("a back-tick or line end in the name `{}` is written otherwise", shown(&text));
        report.say(&codes::RENAMED, &name_place(name, at), what);
    }
    text
}

fn chart_names(plan: &Plan, report: &mut Report) -> Vec<String> {
    let mut taken = Taken::exact();
    let mut names: Vec<String> = Vec::new();
    let mut tops = 0;
    for sheet in &plan.sheets {
        let mut wanted = clean(&sheet.name, &sheet.at, report);
        if sheet.kind == SheetKind::Top {
            tops += 1;
        }
        if wanted.trim().is_empty() {
            wanted = format!("J{}", tops.max(1));
        }
        if taken.has(&wanted) {
            match sheet.parent.and_then(|p| names.get(p)) {
                // Macro-steps with the same name in different workspaces are allowed.
                Some(outer) => wanted = format!("{outer}_{wanted}"),
                None => {
                    let what = say!("two workspaces are called `{}`; the second is renamed", shown(&wanted));
                    report.say(&codes::RENAMED, &name_place(&sheet.name, &sheet.at), what);
                }
            }
        }
        names.push(taken.give(&wanted));
    }
    names
}

fn step_names(sheet: &Sheet, report: &mut Report) -> Vec<String> {
    let mut first: HashMap<&str, &std::ops::Range<usize>> = HashMap::new();
    let mut taken = Taken::exact();
    let written: HashSet<&str> = sheet.steps.iter().map(|s| s.name.text.as_str()).collect();
    let mut number = 0;
    let mut names = Vec::with_capacity(sheet.steps.len());
    for step in &sheet.steps {
        if step.name.text.trim().is_empty() {
            while written.contains(format!("#{number}").as_str()) {
                number += 1;
            }
            names.push(taken.give(&format!("#{number}")));
            number += 1;
            continue;
        }
        if let Some(other) = first.get(step.name.text.as_str()) {
            let what = say!("a second step is called `{}`; it is renamed", shown(&step.name.text));
            let problem = g7_model::Problem::new(&codes::RENAMED, report.span(&step.name.at), what);
            let there = say!("the first step of this name, which references mean");
            report.put(problem.related(report.span(other), there));
        } else {
            first.insert(&step.name.text, &step.name.at);
        }
        names.push(taken.give(&clean(&step.name, &step.at, report)));
    }
    names
}

fn steps_by_name(sheet: &Sheet) -> HashMap<String, usize> {
    let mut map = HashMap::new();
    for (index, step) in sheet.steps.iter().enumerate() {
        if !step.name.text.is_empty() {
            map.entry(step.name.text.clone()).or_insert(step.fused.unwrap_or(index));
        }
    }
    map
}

fn variables(sheet: &Sheet, report: &mut Report) -> HashMap<String, usize> {
    let mut map: HashMap<String, usize> = HashMap::new();
    for (index, var) in sheet.vars.iter().enumerate() {
        clean(&var.name, &var.at, report);
        if let Some(other) = map.get(&var.name.text) {
            let what = say!("`{}` is declared twice in one workspace", shown(&var.name.text));
            let mut problem = g7_model::Problem::new(&codes::TWICE, report.span(&var.name.at), what);
            if let Some(first) = sheet.vars.get(*other) {
                problem = problem.related(report.span(&first.name.at), say!("the first of this name"));
            }
            report.put(problem);
        } else {
            map.insert(var.name.text.clone(), index);
        }
    }
    map
}
