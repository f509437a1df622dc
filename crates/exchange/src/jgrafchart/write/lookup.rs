//! The meaning of names in the document, and the spelling of things in JGrafchart's texts.
//!
//! The first chart becomes the workspace of the file, with the variables of the file. Each other
//! chart becomes a workspace object in it; expansions and enclosed charts become the workspaces of
//! their macro-steps. A text names a thing by the shortest dotted name that reaches it from its
//! workspace outward.

use std::collections::{BTreeSet, HashMap, HashSet};

use g7_model::{Chart, ChartKind, Document, Item, Path, Step, StepKind, Transition, VarDecl};

/// A variable: its chart (None: the file), the numbers of its declaration and of its name there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) struct VarId {
    pub(super) chart: Option<usize>,
    pub(super) decl: usize,
    pub(super) name: usize,
}

/// A step: its chart and its number.
pub(super) type StepId = (usize, usize);

/// A property of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Property {
    Active,
    Scans,
    Seconds,
}

/// The meaning of a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Meaning {
    Var(VarId),
    Step(StepId, Property),
}

/// A thing with a name in the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) enum Thing {
    Var(VarId),
    Step(StepId),
}

/// The names of a document.
pub(super) struct Look<'d> {
    /// The chart that becomes the workspace of the file.
    pub(super) top: usize,
    pub(super) charts: Vec<&'d Chart>,
    by_name: HashMap<&'d str, usize>,
    steps: Vec<HashMap<&'d str, usize>>,
    file_vars: Vec<&'d VarDecl>,
    chart_vars: Vec<Vec<&'d VarDecl>>,
    vars: HashMap<(Option<usize>, &'d str), VarId>,
    addresses: HashMap<String, VarId>,
    /// The step that contains each chart.
    pub(super) owner: Vec<Option<StepId>>,
    step_list: Vec<Vec<&'d Step>>,
    transition_list: Vec<Vec<&'d Transition>>,
    /// The chart within each macro-step.
    insides: HashMap<StepId, usize>,
    /// Names that had to be changed, with the new names.
    pub(super) renamed: HashMap<Thing, String>,
    by_new_name: HashMap<(Option<usize>, String), Thing>,
    /// Things whose name no text can hold, although texts refer to them.
    pub(super) unspeakable: BTreeSet<Thing>,
}

impl<'d> Look<'d> {
    pub(super) fn new(document: &'d Document) -> Look<'d> {
        let charts: Vec<&Chart> = document.charts().collect();
        let file_vars: Vec<&VarDecl> =
            document.items.iter().filter_map(|i| if let Item::Var(v) = i { Some(v) } else { None }).collect();
        let mut look = Look {
            top: charts.iter().position(|c| c.kind == ChartKind::Chart).unwrap_or(0),
            by_name: HashMap::new(),
            steps: Vec::new(),
            chart_vars: charts.iter().map(|c| c.vars().collect()).collect(),
            vars: HashMap::new(),
            addresses: HashMap::new(),
            owner: vec![None; charts.len()],
            transition_list: charts.iter().map(|c| c.transitions().collect()).collect(),
            step_list: charts.iter().map(|c| c.steps().collect()).collect(),
            insides: HashMap::new(),
            renamed: HashMap::new(),
            by_new_name: HashMap::new(),
            unspeakable: BTreeSet::new(),
            charts,
            file_vars,
        };
        look.declare(None, look.file_vars.clone());
        for (index, chart) in look.charts.clone().into_iter().enumerate() {
            look.by_name.entry(&chart.name.text).or_insert(index);
            look.declare(Some(index), chart.vars().collect());
            let mut steps = HashMap::new();
            for (number, step) in chart.steps().enumerate() {
                steps.entry(&*step.name.text).or_insert(number);
            }
            look.steps.push(steps);
        }
        for index in 0..look.charts.len() {
            let macros: Vec<(usize, &str)> = look.charts.get(index).map_or(Vec::new(), |c| {
                let of = |(n, s): (usize, &'d Step)| match &s.kind {
                    StepKind::Macro(name) => Some((n, &*name.text)),
                    _ => None,
                };
                c.steps().enumerate().filter_map(of).collect()
            });
            for (step, name) in macros {
                if let Some(inside) = look.by_name.get(name).copied() {
                    look.put_inside(inside, (index, step));
                }
            }
        }
        look
    }

    fn declare(&mut self, chart: Option<usize>, vars: Vec<&'d VarDecl>) {
        for (decl, var) in vars.into_iter().enumerate() {
            for (name, text) in var.names.iter().enumerate() {
                let id = VarId { chart, decl, name };
                self.vars.entry((chart, &text.text)).or_insert(id);
                if let Some(address) = &var.address {
                    self.addresses.entry(address.text.to_uppercase()).or_insert(id);
                }
            }
        }
    }

    /// Makes a chart the content of a step.
    pub(super) fn put_inside(&mut self, inside: usize, step: StepId) {
        if let Some(owner) = self.owner.get_mut(inside) {
            *owner = Some(step);
            self.insides.insert(step, inside);
        }
    }

    /// The chart within a step.
    pub(super) fn inside_of(&self, step: StepId) -> Option<usize> {
        self.insides.get(&step).copied()
    }

    pub(super) fn chart(&self, name: &str) -> Option<usize> {
        self.by_name.get(name).copied()
    }

    pub(super) fn step(&self, chart: usize, name: &str) -> Option<usize> {
        self.steps.get(chart)?.get(name).copied()
    }

    pub(super) fn step_at(&self, (chart, step): StepId) -> Option<&'d Step> {
        self.step_list.get(chart)?.get(step).copied()
    }

    pub(super) fn transition_at(&self, (chart, number): (usize, usize)) -> Option<&'d Transition> {
        self.transition_list.get(chart)?.get(number).copied()
    }

    pub(super) fn decl(&self, var: VarId) -> Option<&'d VarDecl> {
        match var.chart {
            None => self.file_vars.get(var.decl).copied(),
            Some(chart) => self.chart_vars.get(chart)?.get(var.decl).copied(),
        }
    }

    /// The variables of the file or of a chart.
    pub(super) fn declared(&self, chart: Option<usize>) -> Vec<&'d VarDecl> {
        match chart {
            None => self.file_vars.clone(),
            Some(chart) => self.chart_vars.get(chart).cloned().unwrap_or_default(),
        }
    }

    /// The variable at an address.
    pub(super) fn direct(&self, address: &str) -> Option<Meaning> {
        self.addresses.get(&format!("%{address}").to_uppercase()).copied().map(Meaning::Var)
    }

    /// The meaning of a path in a chart, in the order of the grammar.
    pub(super) fn path(&self, chart: usize, path: &Path) -> Option<Meaning> {
        let names: Vec<&str> = path.names.iter().map(|n| &*n.text).collect();
        let (first, rest) = names.split_first()?;
        if rest.is_empty() {
            let var = self.vars.get(&(Some(chart), *first)).or_else(|| self.vars.get(&(None, *first)));
            if let Some(var) = var {
                return Some(Meaning::Var(*var));
            }
            let step = first.strip_prefix('X')?;
            return self.home(chart, step).map(|s| Meaning::Step(s, Property::Active));
        }
        // A step of this chart has precedence over a chart with that name.
        if let [word] = rest
            && let Some(property) = property(word)
            && let Some(step) = self.step(chart, first)
        {
            return Some(Meaning::Step((chart, step), property));
        }
        if let Some(inner) = self.inner(chart, first) {
            if let [name] = rest
                && let Some(var) = self.vars.get(&(Some(inner), *name))
            {
                return Some(Meaning::Var(*var));
            }
            if let Some(found) = self.step_of(inner, rest) {
                return Some(found);
            }
        }
        let [word] = rest else { return None };
        let property = property(word)?;
        let step = self.home(chart, first).or_else(|| self.home(chart, first.strip_prefix('X')?))?;
        Some(Meaning::Step(step, property))
    }

    /// A chart, or the expansion of a macro-step of this one.
    fn inner(&self, chart: usize, name: &str) -> Option<usize> {
        self.chart(name).or_else(|| {
            let owner = self.home(chart, name)?;
            self.inside_of(owner)
        })
    }

    /// `X12`, `Fill.x`, `X12.t` or `M3.X12` within a chart that has been named.
    fn step_of(&self, chart: usize, rest: &[&str]) -> Option<Meaning> {
        let (first, more) = rest.split_first()?;
        match more {
            [] => Some(Meaning::Step((chart, self.step(chart, first.strip_prefix('X')?)?), Property::Active)),
            [word] if property(word).is_some() => {
                let step = self.step(chart, first).or_else(|| self.step(chart, first.strip_prefix('X')?))?;
                Some(Meaning::Step((chart, step), property(word)?))
            }
            _ => {
                let owner = (chart, self.step(chart, first)?);
                self.step_of(self.inside_of(owner)?, more)
            }
        }
    }

    /// A step by its name alone: of this chart, otherwise the only one in all charts.
    fn home(&self, chart: usize, name: &str) -> Option<StepId> {
        if let Some(step) = self.step(chart, name) {
            return Some((chart, step));
        }
        let all = |proper: bool| {
            let charts = self.charts.iter().enumerate();
            let charts = charts.filter(move |(_, c)| !proper || c.kind == ChartKind::Chart);
            charts.filter_map(|(c, _)| Some((c, self.step(c, name)?))).collect::<Vec<_>>()
        };
        let of_charts = all(true);
        let found = if of_charts.is_empty() { all(false) } else { of_charts };
        match found[..] {
            [one] => Some(one),
            _ => None,
        }
    }

    /// The name of a variable in the file.
    pub(super) fn var_name(&self, var: VarId) -> &str {
        if let Some(name) = self.renamed.get(&Thing::Var(var)) {
            return name;
        }
        self.decl(var).and_then(|d| d.names.get(var.name)).map_or("", |n| &*n.text)
    }

    /// The name of a step in the file.
    pub(super) fn step_name(&self, (chart, step): StepId) -> &str {
        if let Some(name) = self.renamed.get(&Thing::Step((chart, step))) {
            return name;
        }
        self.step_list.get(chart).and_then(|c| c.get(step)).map_or("", |s| &*s.name.text)
    }

    /// The workspace around that of a chart. None means the first chart's.
    fn around(&self, chart: usize) -> Option<usize> {
        match self.owner.get(chart).copied().flatten() {
            Some((outer, _)) => Some(outer),
            None => (chart != self.top).then_some(self.top),
        }
    }

    /// The spelling of a thing in a text of a chart's workspace; records names that no text can
    /// hold.
    pub(super) fn speak(&mut self, chart: usize, thing: Thing) -> Option<String> {
        let (home, own) = match thing {
            Thing::Var(var) => (var.chart.unwrap_or(self.top), self.var_name(var).to_string()),
            Thing::Step(step) => (step.0, self.step_name(step).to_string()),
        };
        let mut parts = vec![(Some(thing), own)];
        let mut here = Some(home);
        let mut left = self.charts.len() + 1;
        loop {
            let names: Vec<&str> = parts.iter().rev().map(|(_, n)| n.as_str()).collect();
            if self.resolve(chart, &names) == Some(thing) {
                for (thing, name) in &parts {
                    if !is_name(name) {
                        self.unspeakable.extend(*thing);
                    }
                }
                return Some(names.join("."));
            }
            let outer = here?;
            left = left.checked_sub(1)?;
            let step = self.owner.get(outer).copied().flatten();
            let name = match step {
                Some(step) => self.step_name(step).to_string(),
                None => self.charts.get(outer)?.name.text.to_string(),
            };
            parts.push((step.map(Thing::Step), name));
            here = self.around(outer);
        }
    }

    /// The thing that JGrafchart finds for a dotted name: in the workspace, then in those around
    /// it, finally by the name of the top workspace.
    fn resolve(&self, chart: usize, names: &[&str]) -> Option<Thing> {
        let mut here = Some(chart);
        let mut left = self.charts.len() + 1;
        while let Some(index) = here {
            match self.resolve_in(index, names) {
                Found::Nothing => {}
                Found::Wrong => return None,
                Found::Thing(thing) => return Some(thing),
            }
            left = left.checked_sub(1)?;
            here = self.around(index);
        }
        let (first, rest) = names.split_first()?;
        match self.charts.get(self.top) {
            Some(top) if *top.name.text == **first => match self.resolve_in(self.top, rest) {
                Found::Thing(thing) => Some(thing),
                _ => None,
            },
            _ => None,
        }
    }

    fn resolve_in(&self, chart: usize, names: &[&str]) -> Found {
        let Some((first, rest)) = names.split_first() else { return Found::Nothing };
        if rest.is_empty()
            && let Some(var) = self.variable_called(chart, first)
        {
            return Found::Thing(Thing::Var(var));
        }
        if let Some(step) = self.step_called(chart, first) {
            if rest.is_empty() {
                return Found::Thing(Thing::Step((chart, step)));
            }
            return self.inside_of((chart, step)).map_or(Found::Wrong, |inside| self.inside(inside, rest));
        }
        if chart == self.top
            && let Some(object) =
                self.chart(first).filter(|c| *c != self.top && self.owner.get(*c) == Some(&None))
        {
            return self.inside(object, rest);
        }
        Found::Nothing
    }

    fn inside(&self, chart: usize, rest: &[&str]) -> Found {
        match self.resolve_in(chart, rest) {
            Found::Nothing => Found::Wrong,
            found => found,
        }
    }

    fn variable_called(&self, chart: usize, name: &str) -> Option<VarId> {
        let homes = if chart == self.top { [None, Some(chart)] } else { [Some(chart), Some(chart)] };
        homes.iter().find_map(|home| {
            let var = self.vars.get(&(*home, name)).copied();
            let plain = var.filter(|v| !self.renamed.contains_key(&Thing::Var(*v)));
            plain.or_else(|| match self.by_new_name.get(&(*home, name.to_string())) {
                Some(Thing::Var(var)) => Some(*var),
                _ => None,
            })
        })
    }

    fn step_called(&self, chart: usize, name: &str) -> Option<usize> {
        let step = self.step(chart, name).filter(|s| !self.renamed.contains_key(&Thing::Step((chart, *s))));
        step.or_else(|| match self.by_new_name.get(&(Some(chart), name.to_string())) {
            Some(Thing::Step((_, step))) => Some(*step),
            _ => None,
        })
    }

    /// Gives new names to things that texts refer to under names they cannot hold.
    pub(super) fn rename(&mut self) {
        let mut taken: HashSet<String> = self.charts.iter().map(|c| c.name.text.to_string()).collect();
        taken.extend(self.vars.keys().map(|(_, n)| (*n).to_string()));
        taken.extend(self.steps.iter().flat_map(|s| s.keys().map(|n| (*n).to_string())));
        for thing in std::mem::take(&mut self.unspeakable) {
            let old = match thing {
                Thing::Var(var) => self.var_name(var).to_string(),
                Thing::Step(step) => self.step_name(step).to_string(),
            };
            let mut new: String = old.chars().map(|c| if is_part(c) { c } else { '_' }).collect();
            if !new.chars().next().is_some_and(is_first) {
                new.insert_str(0, if matches!(thing, Thing::Step(_)) { "S" } else { "v" });
            }
            while !taken.insert(new.clone()) {
                new.push('_');
            }
            let home = match thing {
                Thing::Var(var) => var.chart,
                Thing::Step((chart, _)) => Some(chart),
            };
            self.by_new_name.insert((home, new.clone()), thing);
            self.renamed.insert(thing, new);
        }
    }
}

enum Found {
    Thing(Thing),
    /// A known thing without such a part.
    Wrong,
    Nothing,
}

fn property(word: &str) -> Option<Property> {
    match word {
        "x" | "X" => Some(Property::Active),
        "t" | "T" => Some(Property::Scans),
        "s" => Some(Property::Seconds),
        _ => None,
    }
}

/// True if a text of JGrafchart can hold a name.
pub(super) fn is_name(name: &str) -> bool {
    name.chars().next().is_some_and(is_first) && name.chars().all(is_part)
}

fn is_first(c: char) -> bool {
    c.is_alphabetic() || matches!(c, '_' | '#' | '$')
}

fn is_part(c: char) -> bool {
    c.is_alphanumeric() || matches!(c, '_' | '#' | '$')
}
