//! The document with its names in maps: charts as scopes, steps, transitions. Actions and
//! expressions stay as they were written.

use std::collections::{BTreeMap, BTreeSet};

use g7_model::{
    Action, ActionKind, Block, Body, Chart, ChartItem, ChartKind, Composed, Document, Expr, ExprKind,
    Function, Item, Name, NamedAction, Nanos, Order, ProfileName, Section, Situation, StepKind, Switch,
    TargetPlc, Type, VarDecl, VarKind,
};

use super::block_charts::Home;
use super::instances::{charts_of, numbered};
use super::named::named;
use super::value::{Run, bad};

pub(super) type ScopeId = usize;
pub(super) type StepId = usize;
pub(super) type VarId = usize;
pub(super) type TransId = usize;

/// The scope outside of all charts.
pub(super) const FILE: ScopeId = 0;

/// The rules of a profile after the switches of the document.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Rules {
    pub(super) profile: ProfileName,
    pub(super) stable: bool,
    pub(super) multi_token: bool,
    pub(super) sequential: bool,
    pub(super) parallel_actions: bool,
    pub(super) final_scan: bool,
    pub(super) keep_step_time: bool,
    pub(super) scan_clock: bool,
    pub(super) pulse_first: bool,
    pub(super) bound: Option<u32>,
}

impl Rules {
    fn of(profile: ProfileName) -> Rules {
        use ProfileName as P;
        Rules {
            profile,
            stable: profile == P::Iec60848,
            multi_token: matches!(profile, P::Iec60848 | P::Pl7 | P::Jgrafchart),
            sequential: profile == P::Jgrafchart,
            parallel_actions: profile == P::Iec60848,
            final_scan: profile == P::Iec61131,
            keep_step_time: profile != P::Jgrafchart,
            scan_clock: profile == P::Jgrafchart,
            pulse_first: profile == P::Unity,
            bound: None,
        }
    }

    fn set(&mut self, switch: Switch) {
        match switch {
            Switch::Stable(b) => self.stable = b,
            Switch::MultiToken(b) => self.multi_token = b,
            Switch::Sequential(b) => self.sequential = b,
            Switch::ParallelActions(b) => self.parallel_actions = b,
            Switch::FinalScan(b) => self.final_scan = b,
            Switch::KeepStepTime(b) => self.keep_step_time = b,
            Switch::ScanClock(b) => self.scan_clock = b,
            Switch::PulseFirst(b) => self.pulse_first = b,
            Switch::Bound(n) => self.bound = Some(n),
        }
    }

    /// P1 and P0 assignments and bodies are stored actions (decision 10).
    pub(super) fn stored_pulses(self) -> bool {
        !matches!(self.profile, ProfileName::Iec61131 | ProfileName::Unity)
    }
}

/// A chart, the expansion of one macro-step, a task, or the file itself.
pub(super) struct Scope {
    /// Its qualified name: `G`, `G.M3`; empty for the file.
    pub(super) qualified: String,
    /// Its name in the document.
    pub(super) name: String,
    pub(super) kind: ChartKind,
    pub(super) every: Option<i64>,
    /// For an expansion: its macro-step.
    pub(super) macro_step: Option<StepId>,
    /// For an enclosed chart: the enclosing step.
    pub(super) enclosed_by: Option<StepId>,
    /// The chart that contains this expansion, directly or through other expansions.
    pub(super) root: ScopeId,
    pub(super) steps: Vec<StepId>,
    pub(super) by_name: BTreeMap<String, StepId>,
    /// Of an instance: the parameters that are whole numbers.
    pub(super) numbers: BTreeMap<String, i128>,
    /// Of a chart of a function block: the instance.
    pub(super) home: Option<Home>,
    pub(super) transitions: Vec<TransId>,
    pub(super) vars: BTreeMap<String, VarId>,
    /// The indexes of the elements of each array, as in `[1,2]`.
    pub(super) arrays: BTreeMap<String, Vec<String>>,
    pub(super) actions: BTreeMap<String, NamedAction>,
    pub(super) sections: BTreeMap<String, Section>,
}

pub(super) struct Step {
    pub(super) scope: ScopeId,
    pub(super) name: String,
    pub(super) qualified: String,
    pub(super) kind: StepKind,
    pub(super) initial: bool,
    pub(super) linked: bool,
    pub(super) actions: Vec<Action>,
    /// For a macro-step: its expansion, entry step and exit step.
    pub(super) expansion: Option<(ScopeId, StepId, StepId)>,
    pub(super) encloses: Vec<ScopeId>,
    /// The tasks that the step calls.
    pub(super) calls: Vec<ScopeId>,
}

pub(super) struct Transition {
    pub(super) scope: ScopeId,
    pub(super) pre: Vec<StepId>,
    pub(super) post: Vec<StepId>,
    pub(super) receptivity: Expr,
    pub(super) priority: Option<u32>,
    pub(super) on_clearing: Option<Block>,
}

pub(super) struct Var {
    pub(super) qualified: String,
    pub(super) kind: VarKind,
    pub(super) ty: Type,
    pub(super) init: Option<Expr>,
    pub(super) safe: Option<Expr>,
    pub(super) retain: bool,
    pub(super) scope: ScopeId,
    /// The least and the greatest value, of a type with bounds.
    pub(super) range: Option<(i128, i128)>,
}

/// A forcing order of a step.
pub(super) struct Forcing {
    pub(super) step: StepId,
    pub(super) chart: ScopeId,
    pub(super) situation: Situation,
}

/// A whole document.
pub(super) struct Model {
    pub(super) rules: Rules,
    /// The nominal scan time, in nanoseconds.
    pub(super) cycle: i64,
    pub(super) target: Option<TargetPlc>,
    pub(super) scopes: Vec<Scope>,
    /// All steps, in the order of the text.
    pub(super) steps: Vec<Step>,
    /// All transitions, in the order of the text.
    pub(super) transitions: Vec<Transition>,
    pub(super) vars: Vec<Var>,
    pub(super) addresses: BTreeMap<String, VarId>,
    pub(super) functions: BTreeMap<String, Function>,
    /// The structures and function blocks of the file.
    pub(super) types: BTreeMap<String, Composed>,
    /// The other types of the file.
    pub(super) named: BTreeMap<String, VarDecl>,
    /// The types of all that has members, elements of arrays among them.
    pub(super) composed: BTreeMap<(ScopeId, String), String>,
    /// The bodies of PRE (true) and POST with their scopes, in the order of the text.
    pub(super) bodies: Vec<(ScopeId, bool, Block)>,
    pub(super) forcings: Vec<Forcing>,
    /// The charts with enabling orders, and the steps that give these.
    pub(super) enables: BTreeMap<ScopeId, Vec<StepId>>,
    /// The steps that mask a chart.
    pub(super) chart_masks: Vec<(StepId, ScopeId)>,
    /// The steps that mask a variable.
    pub(super) var_masks: Vec<(StepId, VarId)>,
    /// The variables whose associations all go through a control block.
    pub(super) blocked_vars: BTreeSet<VarId>,
    /// The charts, each forcing chart before the forced ones.
    pub(super) order: Vec<ScopeId>,
}

/// The structures and function blocks that a file declares.
fn types(doc: &Document) -> BTreeMap<String, Composed> {
    let composed =
        |i: &Item| if let Item::Composed(c) = i { Some((c.name.text.to_string(), c.clone())) } else { None };
    doc.items.iter().filter_map(composed).collect()
}

impl Model {
    pub(super) fn new(doc: &Document, profile: Option<ProfileName>) -> Run<Model> {
        let mut model = Model {
            rules: rules(doc, profile),
            cycle: doc.cycle().map_or(10_000_000, Nanos::count),
            target: doc.items.iter().find_map(|i| if let Item::Target(t, _) = i { Some(*t) } else { None }),
            scopes: vec![Scope::new("", ChartKind::Chart, None, FILE)],
            steps: Vec::new(),
            transitions: Vec::new(),
            vars: Vec::new(),
            addresses: BTreeMap::new(),
            functions: BTreeMap::new(),
            types: types(doc),
            named: named(doc),
            composed: BTreeMap::new(),
            bodies: Vec::new(),
            forcings: Vec::new(),
            enables: BTreeMap::new(),
            chart_masks: Vec::new(),
            var_masks: Vec::new(),
            blocked_vars: BTreeSet::new(),
            order: Vec::new(),
        };
        for item in &doc.items {
            for made in charts_of(doc, item)? {
                let (id, chart) = (model.scopes.len(), made.chart);
                let every = chart.every.map(Nanos::count);
                let numbers = made.numbers();
                let home = made.home.clone();
                model.scopes.push(Scope { numbers, home, ..Scope::new(&made.name, chart.kind, every, id) });
            }
        }
        model.read_items(doc)?;
        model.link_expansions()?;
        model.link_orders()?;
        model.qualify();
        model.order = model.chart_order()?;
        if model.rules.profile == ProfileName::Pl7 {
            model.system_words();
        }
        Ok(model)
    }

    fn read_items(&mut self, doc: &Document) -> Run<()> {
        let mut next_chart = FILE + 1;
        for item in &doc.items {
            match item {
                Item::Chart(_) | Item::Instance(_) | Item::Var(_) => {
                    if let Item::Var(v) = item {
                        self.declare(FILE, v);
                    }
                    for made in charts_of(doc, item)? {
                        made.constants.iter().for_each(|v| self.declare(next_chart, v));
                        self.read_chart(next_chart, made.chart)?;
                        next_chart += 1;
                    }
                }
                Item::Action(a) => {
                    self.scopes[FILE].actions.insert(a.name.text.to_string(), a.clone());
                }
                Item::Section(s) => {
                    self.scopes[FILE].sections.insert(s.name.text.to_string(), s.clone());
                }
                Item::Function(f) => {
                    self.functions.insert(f.name.text.to_string(), f.clone());
                }
                Item::Pre(b, _) => self.bodies.push((FILE, true, st(b)?)),
                Item::Post(b, _) => self.bodies.push((FILE, false, st(b)?)),
                Item::Profile(_)
                | Item::Cycle(..)
                | Item::Target(..)
                | Item::Use(_)
                | Item::Plant(_)
                | Item::Test(_)
                | Item::Prove(_)
                | Item::Composed(_)
                | Item::Type(_)
                | Item::Layout(_) => {}
            }
        }
        Ok(())
    }

    pub(super) fn declare(&mut self, scope: ScopeId, v: &VarDecl) {
        let v = &self.with_type(v);
        if let Some(of) = &v.of {
            return self.declare_composed(scope, v, &of.text.clone());
        }
        for single in self.singles(scope, v) {
            self.declare_single(scope, &single);
            for (name, element) in v.names.iter().zip(&single.names).filter(|_| v.array.is_some()) {
                let indexes = element.text[name.text.len()..].to_owned();
                self.scopes[scope].arrays.entry(name.text.to_string()).or_default().push(indexes);
            }
        }
    }

    fn declare_single(&mut self, scope: ScopeId, v: &VarDecl) {
        for name in &v.names {
            let id = self.vars.len();
            let prefix = &self.scopes[scope].name;
            let qualified =
                if scope == FILE { name.text.to_string() } else { format!("{prefix}.{}", name.text) };
            self.vars.push(Var {
                qualified,
                kind: v.kind,
                ty: v.ty,
                init: v.init.clone(),
                safe: v.safe.clone(),
                retain: v.retain,
                scope,
                range: self.range(scope, v),
            });
            self.scopes[scope].vars.insert(name.text.to_string(), id);
            if let Some(address) = v.address.as_ref().and_then(|a| a.text.strip_prefix('%')) {
                self.addresses.insert(address.to_ascii_uppercase(), id);
            }
        }
    }

    fn read_chart(&mut self, scope: ScopeId, chart: &Chart) -> Run<()> {
        for item in &chart.items {
            match item {
                ChartItem::Var(v) => self.declare(scope, v),
                ChartItem::Step(s) => {
                    let id = self.steps.len();
                    self.scopes[scope].steps.push(id);
                    if self.scopes[scope].by_name.insert(s.name.text.to_string(), id).is_some() {
                        return bad(format!("step {} twice", s.name.text));
                    }
                    self.steps.push(Step {
                        scope,
                        name: s.name.text.to_string(),
                        qualified: String::new(),
                        kind: s.kind.clone(),
                        initial: s.initial,
                        linked: s.linked,
                        actions: s.actions.clone(),
                        expansion: None,
                        encloses: Vec::new(),
                        calls: Vec::new(),
                    });
                }
                ChartItem::Pre(b, _) => self.bodies.push((scope, true, st(b)?)),
                ChartItem::Post(b, _) => self.bodies.push((scope, false, st(b)?)),
                ChartItem::Action(a) => {
                    self.scopes[scope].actions.insert(a.name.text.to_string(), a.clone());
                }
                ChartItem::Section(s) => {
                    self.scopes[scope].sections.insert(s.name.text.to_string(), s.clone());
                }
                ChartItem::Transition(_) => {}
            }
        }
        for t in chart.transitions() {
            let id = self.transitions.len();
            self.transitions.push(Transition {
                scope,
                pre: self.named_steps(scope, &t.from)?,
                post: self.named_steps(scope, &t.to)?,
                receptivity: t.receptivity.clone(),
                priority: t.priority,
                on_clearing: t.on_clearing.clone(),
            });
            self.scopes[scope].transitions.push(id);
        }
        Ok(())
    }

    pub(super) fn named_steps(&self, scope: ScopeId, names: &[Name]) -> Run<Vec<StepId>> {
        names.iter().map(|n| self.named_step(scope, &n.text)).collect()
    }

    pub(super) fn named_step(&self, scope: ScopeId, name: &str) -> Run<StepId> {
        match self.scopes[scope].by_name.get(name) {
            Some(&id) => Ok(id),
            None => bad(format!("no step {name} in {}", self.scopes[scope].name)),
        }
    }

    /// The chart with this name as one in `scope` writes it.
    pub(super) fn chart_named(&self, scope: ScopeId, name: &str) -> Option<ScopeId> {
        let parts: Vec<String> = name.split('.').map(|p| numbered(p, &self.scopes[scope].numbers)).collect();
        let named = |name: String| (FILE + 1..self.scopes.len()).find(|&s| self.scopes[s].name == name);
        self.chart_names(scope, &parts.join(".")).into_iter().find_map(named)
    }

    fn link_expansions(&mut self) -> Run<()> {
        for id in 0..self.steps.len() {
            let StepKind::Macro(name) = self.steps[id].kind.clone() else { continue };
            let home = self.steps[id].scope;
            let Some(scope) = self.chart_named(home, &name.text) else {
                return bad(format!("no {}", name.text));
            };
            if self.scopes[scope].macro_step.is_some() || self.scopes[scope].kind != ChartKind::Expansion {
                return bad(format!("{} cannot expand {}", name.text, self.steps[id].name));
            }
            let (entry, exit) = self.ends(scope)?;
            self.scopes[scope].macro_step = Some(id);
            self.steps[id].expansion = Some((scope, entry, exit));
        }
        Ok(())
    }

    /// The entry and the exit step of an expansion or task.
    pub(super) fn ends(&self, scope: ScopeId) -> Run<(StepId, StepId)> {
        let find =
            |kind: StepKind| self.scopes[scope].steps.iter().copied().find(|&s| self.steps[s].kind == kind);
        match (find(StepKind::Entry), find(StepKind::Exit)) {
            (Some(entry), Some(exit)) => Ok((entry, exit)),
            _ => bad(format!("{} lacks an entry or exit step", self.scopes[scope].name)),
        }
    }

    fn link_orders(&mut self) -> Run<()> {
        for id in 0..self.steps.len() {
            for action in self.steps[id].actions.clone() {
                if let ActionKind::Order(order) = action.kind {
                    self.link_order(id, order)?;
                }
            }
        }
        Ok(())
    }

    fn link_order(&mut self, step: StepId, order: Order) -> Run<()> {
        let (Order::Force(name, _)
        | Order::Enable(name)
        | Order::Mask(name)
        | Order::Call(name)
        | Order::Enclose(name)) = &order;
        let Some(chart) = self.chart_named(self.steps[step].scope, &name.text) else {
            if let Order::Mask(name) = &order
                && let Some(var) = self.variable_named(self.steps[step].scope, &name.text)
            {
                self.var_masks.push((step, var));
                return Ok(());
            }
            return bad(format!("no chart {}", name.text));
        };
        match order {
            Order::Force(_, situation) => self.forcings.push(Forcing { step, chart, situation }),
            Order::Enable(_) => self.enables.entry(chart).or_default().push(step),
            Order::Mask(_) => self.chart_masks.push((step, chart)),
            Order::Call(_) => self.steps[step].calls.push(chart),
            Order::Enclose(_) => {
                if self.scopes[chart].enclosed_by.replace(step).is_some() {
                    return bad(format!("{} enclosed twice", name.text));
                }
                self.steps[step].encloses.push(chart);
            }
        }
        Ok(())
    }

    pub(super) fn variable_named(&self, scope: ScopeId, name: &str) -> Option<VarId> {
        self.scopes[scope].vars.get(name).or_else(|| self.scopes[FILE].vars.get(name)).copied()
    }

    /// Computes roots and qualified names, from the outermost chart inward.
    fn qualify(&mut self) {
        for scope in FILE + 1..self.scopes.len() {
            let mut path = Vec::new();
            let mut at = scope;
            while let Some(m) = self.scopes[at].macro_step {
                path.insert(0, self.steps[m].name.clone());
                at = self.steps[m].scope;
                if path.len() > self.scopes.len() {
                    break; // an expansion that contains itself; `check` refuses it
                }
            }
            path.insert(0, self.scopes[at].name.clone());
            self.scopes[scope].qualified = path.join(".");
            self.scopes[scope].root = at;
        }
        for step in &mut self.steps {
            step.qualified = format!("{}.{}", self.scopes[step.scope].qualified, step.name);
        }
    }

    /// True if a scope takes part in the evolution: an expansion only if a macro-step uses it.
    pub(super) fn is_live(&self, scope: ScopeId) -> bool {
        self.scopes[self.scopes[scope].root].kind != ChartKind::Expansion
    }

    pub(super) fn root_of(&self, step: StepId) -> ScopeId {
        self.scopes[self.steps[step].scope].root
    }

    /// The charts in an order in which a forcing chart comes before those it forces, and an
    /// enclosing chart before those it encloses.
    fn chart_order(&self) -> Run<Vec<ScopeId>> {
        let roots: Vec<ScopeId> =
            (FILE + 1..self.scopes.len()).filter(|&s| self.scopes[s].root == s).collect();
        let mut before: BTreeMap<ScopeId, BTreeSet<ScopeId>> = BTreeMap::new();
        for f in &self.forcings {
            before.entry(f.chart).or_default().insert(self.root_of(f.step));
        }
        for &s in &roots {
            if let Some(step) = self.scopes[s].enclosed_by {
                before.entry(s).or_default().insert(self.root_of(step));
            }
        }
        let mut order: Vec<ScopeId> = Vec::new();
        while order.len() < roots.len() {
            let free = |s: &ScopeId| before.get(s).is_none_or(|b| b.iter().all(|x| order.contains(x)));
            match roots.iter().copied().find(|s| !order.contains(s) && free(s)) {
                Some(s) => order.push(s),
                None => return bad("the forcing order has a cycle"),
            }
        }
        Ok(order)
    }

    /// Adds the system bits and words of PL7 as variables.
    fn system_words(&mut self) {
        let bits = ["S0", "S1", "S21", "S22", "S23", "S24", "S25"].map(|n| (n, Type::Bool));
        let words = ["SW20", "SW21", "SW22", "SW23", "SW24", "SW25"].map(|n| (n, Type::Int));
        for (name, ty) in bits.into_iter().chain(words) {
            self.addresses.insert(name.to_owned(), self.vars.len());
            self.vars.push(Var {
                qualified: format!("%{name}"),
                kind: VarKind::Var,
                ty,
                init: None,
                safe: None,
                retain: false,
                scope: FILE,
                range: None,
            });
        }
    }

    /// All steps of a scope, including those of expansions in it.
    pub(super) fn steps_within(&self, scope: ScopeId) -> Vec<StepId> {
        let mut all = Vec::new();
        for &s in &self.scopes[scope].steps {
            all.push(s);
            if let Some((inner, ..)) = self.steps[s].expansion {
                all.extend(self.steps_within(inner));
            }
        }
        all
    }
}

impl Scope {
    fn new(name: &str, kind: ChartKind, every: Option<i64>, root: ScopeId) -> Scope {
        Scope {
            qualified: name.to_owned(),
            name: name.to_owned(),
            kind,
            every,
            macro_step: None,
            enclosed_by: None,
            root,
            steps: Vec::new(),
            by_name: BTreeMap::new(),
            numbers: BTreeMap::new(),
            home: None,
            transitions: Vec::new(),
            vars: BTreeMap::new(),
            arrays: BTreeMap::new(),
            actions: BTreeMap::new(),
            sections: BTreeMap::new(),
        }
    }
}

fn rules(doc: &Document, profile: Option<ProfileName>) -> Rules {
    let written = doc.profile();
    let name = profile.or(written.map(|p| p.name)).unwrap_or_default();
    let mut rules = Rules::of(name);
    // The switches belong to the profile beside which they are written.
    if let Some(p) = written.filter(|p| p.name == name) {
        p.switches.iter().for_each(|(s, _)| rules.set(*s));
    }
    rules
}

/// The statements of a body; bodies in Ladder and Instruction List are refused.
pub(super) fn st(body: &Body) -> Run<Block> {
    match body {
        Body::St(b) => Ok(b.clone()),
        Body::Other(..) => bad("a body that is not Structured Text"),
    }
}

/// True if an expression consists of the name of a step variable only.
pub(super) fn is_name(e: &Expr) -> bool {
    matches!(e.kind, ExprKind::Path(_) | ExprKind::Direct(_))
}
