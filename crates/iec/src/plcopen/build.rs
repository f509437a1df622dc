//! Builds the document from the units of a project.

use std::collections::{BTreeMap, HashMap, HashSet};

use g7_model::codes;
use g7_model::{
    Body, Chart, ChartItem, ChartKind, Document, Expr, Item, Problem, Profile, ProfileName, Span, Stmt,
    StmtKind, Switch, Type, VarDecl, VarKind, say,
};

use super::bodies::{Callee, Calls, Coder, Place, Put, called, flags_of, resolve_calls};
use super::chart::without_blocks;
use super::code;
use super::declare;
use super::draft::{Made, Maker, Order, block};
use super::inputs;
use super::read::{Pou, Project};
use super::tree::{self, Language, head, name_of};
use super::types::Shapes;
use super::units::{self, Meaning, Unit};
use crate::enumerations;
use crate::nodes::{self, Taken};
use crate::report::Report;
use crate::st;

/// The document of a project.
pub(super) fn document<'a>(project: &'a Project<'a>, root: tree::Xml<'a>, report: &mut Report) -> Document {
    if project.pous.is_empty() && project.globals.is_empty() {
        return Document { items: Vec::new(), notes: report.take_notes() };
    }
    let at = report.span(&project.at);
    let mut shapes = Shapes::new(project, report);
    let mut code = code::read(project, &mut shapes, report);
    let (of_code, functions) = (std::mem::take(&mut code.items), std::mem::take(&mut code.functions));
    let plan = units::plan(project, code, report);
    let plain_actions = without_blocks(root);
    let switches = if plain_actions { vec![(Switch::FinalScan(false), at.into())] } else { Vec::new() };
    let steps = root.descendants().any(|n| n.is_element() && tree::tag(n) == "step");
    let switches = if steps { switches } else { Vec::new() };
    let mut items = vec![Item::Profile(Profile { name: ProfileName::Iec61131, switches, at: at.into() })];
    if let Some(cycle) = project.cycle {
        items.push(Item::Cycle(cycle, at.into()));
    }
    items.extend(of_code);
    let globals = declare::globals(&plan, &mut shapes, report);
    items.extend(globals.into_iter().chain(plan.code.globals.iter().cloned()).map(Item::Var));
    let declared: Vec<_> = plan
        .units
        .iter()
        .map(|unit| match project.pous.get(unit.pou) {
            Some(pou) => declare::of_unit(&plan, &mut shapes, unit, pou, report),
            None => declare::Declared::default(),
        })
        .collect();
    let mut of_charts: Vec<Vec<VarDecl>> = Vec::new();
    for declared in declared {
        items.extend(declared.of_file.into_iter().map(Item::Var));
        of_charts.push(declared.of_chart);
    }
    let mut builder = Builder { coder: Coder::new(&plan, report), of_charts, plain_actions };
    items.extend(functions);
    let made = builder.everything();
    items.extend(made.pre.into_iter().map(|b| Item::Pre(Body::St(block(b, at)), at.into())));
    items.extend(made.post.into_iter().map(|b| Item::Post(Body::St(block(b, at)), at.into())));
    items.extend(made.charts.charts.into_iter().map(Item::Chart));
    items.extend(made.charts.layouts.into_iter().map(Item::Layout));
    let mut document = Document { items, notes: report.take_notes() };
    st::settle(&mut document);
    inputs::settle(&mut document, report);
    enumerations::settle(&mut document, report);
    document
}

/// The variables that tell that a chart is called: the chart that declares them and their name,
/// with the variable that keeps the value for the next scan.
type Flags = BTreeMap<(String, String), (Option<String>, Span)>;

/// The bodies and charts of the document.
#[derive(Default)]
struct Whole {
    pre: Option<Vec<Stmt>>,
    post: Option<Vec<Stmt>>,
    charts: Made,
}

struct Builder<'r, 'p, 'a> {
    coder: Coder<'r, 'p, 'a>,
    /// The variables of each unit's chart.
    of_charts: Vec<Vec<VarDecl>>,
    plain_actions: bool,
}

impl<'a> Builder<'_, '_, 'a> {
    fn everything(&mut self) -> Whole {
        let (mut body, mut behind) = self.programs();
        self.called_by_actions();
        let mut charts = Taken::default();
        let units = self.coder.plan.units.iter().map(|u| &u.chart);
        units.chain(self.coder.plan.globals.keys()).for_each(|name| _ = charts.take(name));
        let mut flags: Flags = BTreeMap::new();
        let mut guards: HashMap<Callee, Expr> = HashMap::new();
        for (callee, calls) in self.coder.calls.clone() {
            if let Some(guard) = self.guard(callee, calls, &mut flags) {
                guards.insert(callee, guard);
            }
        }
        let mut whole = Whole::default();
        let plan = self.coder.plan;
        for index in 0..plan.units.len() {
            let vars = self.of_charts.get_mut(index).map(std::mem::take).unwrap_or_default();
            let mut maker = Maker {
                coder: &mut self.coder,
                charts: &mut charts,
                plain_actions: self.plain_actions,
                guards: &guards,
                made: std::mem::take(&mut whole.charts),
            };
            unit_chart(&mut maker, index, vars, guards.get(&(index, None)));
            whole.charts = maker.made;
        }
        self.never_called();
        let put = |chart: &str, flag: &str, at: Span| mark(&flags, chart, flag, at);
        place_calls(&mut whole.charts.charts, &put);
        resolve_calls(&mut behind, &put);
        self.bodies(&mut body, behind, &mut whole, &flags);
        whole
    }

    /// Tells of the instances of blocks without a chart that no code calls.
    fn never_called(&mut self) {
        let plan = self.coder.plan;
        for (index, unit) in plan.units.iter().enumerate() {
            let written = |pou: &Pou| tree::body(pou.node).is_some_and(|(l, _)| l != Language::Sfc);
            let waits = !unit.program && !self.coder.placed.contains(&index);
            if waits && plan.pou(index).is_some_and(written) {
                let what = say!("no code calls the function block `{}`; its body is left out", unit.chart);
                self.coder.say(&codes::LEFT_OUT, unit.node, what);
            }
        }
    }

    /// The bodies of programs without a chart, in order: first those that the tasks run before a
    /// chart or without one, then those behind all charts.
    fn programs(&mut self) -> (Vec<Stmt>, Vec<Stmt>) {
        let plan = self.coder.plan;
        let turn = |unit: &Unit| plan.project.runs.iter().position(|r| r.node == unit.node);
        let running = |u: &Unit| u.program;
        let mut order: Vec<usize> = (0..plan.units.len()).collect();
        order.retain(|u| plan.units.get(*u).is_some_and(running));
        // Programs that no task runs come last.
        order.sort_by_key(|u| plan.units.get(*u).map(turn).map(|turn| (turn.is_none(), turn)));
        let charts = order.iter().filter(|u| plan.is_chart(**u)).filter_map(|u| plan.units.get(*u));
        let last = charts.map(turn).collect::<Option<Vec<usize>>>().and_then(|turns| turns.into_iter().max());
        let (mut before, mut behind) = (Vec::new(), Vec::new());
        for index in order.iter().copied() {
            let (Some(unit), Some(pou)) = (plan.units.get(index), plan.pou(index)) else { continue };
            let Some((language, node)) = tree::body(pou.node) else { continue };
            if language == Language::Sfc {
                continue;
            }
            if unit.interval.is_some() {
                let what = say!("the body of a slower task; it runs in every scan");
                self.coder.say(&codes::NOT_CARRIED, unit.node, what);
            }
            let body = self.coder.body(language, node, &Place::of_unit(index, None, false));
            if order.len() > 1 && body.iter().any(Stmt::returns) {
                let what = say!("RETURN in one of several programs: the others would not run either");
                self.coder.say(&codes::NOT_CARRIED, pou.node, what);
            }
            let late = last.zip(turn(unit)).is_some_and(|(last, turn)| turn > last);
            if late { &mut behind } else { &mut before }.extend(body);
        }
        (before, behind)
    }

    /// Charts that actions call. They are found before the charts are made.
    fn called_by_actions(&mut self) {
        let plan = self.coder.plan;
        let mut called = HashSet::new();
        for pou in &plan.project.pous {
            for text in pou.node.descendants().filter(|n| n.is_text()).filter_map(|n| n.text()) {
                names_called(text, &mut called);
            }
        }
        for (index, unit) in plan.units.iter().enumerate() {
            let Some(pou) = plan.pou(index) else { continue };
            for (number, action) in pou.actions.iter().enumerate() {
                let chart = matches!(tree::body(*action), Some((Language::Sfc, _)));
                let name = name_of(*action).unwrap_or_default().to_uppercase();
                if chart && called.contains(&name) {
                    let note = self.coder.calls.entry((index, Some(number))).or_default();
                    note.acted = true;
                }
            }
            for (name, meaning) in &unit.names {
                let Meaning::Unit(inner) = meaning else { continue };
                let acts = plan.is_chart(index) || !pou.actions.is_empty();
                let known = self.coder.calls.contains_key(&(*inner, None));
                if plan.is_chart(*inner) && acts && !known && called.contains(name) {
                    self.coder.calls.entry((*inner, None)).or_default().acted = true;
                }
            }
        }
    }

    /// The guard of a called chart, unless it is called in every scan.
    fn guard(&mut self, callee: Callee, calls: Calls, flags: &mut Flags) -> Option<Expr> {
        let (unit, action) = callee;
        let chart = self.coder.plan.units.get(unit)?.chart.clone();
        let action = action.and_then(|a| self.coder.plan.pou(unit)?.actions.get(a).copied());
        let name = action.and_then(name_of);
        if name.is_none() && !calls.sometimes && !calls.acted {
            return None;
        }
        let (called, calling) = flags_of(name.as_deref());
        let node = action.unwrap_or(self.coder.plan.units.get(unit)?.node);
        let at = self.coder.report.span(&head(node));
        let title = name.unwrap_or_else(|| chart.clone());
        let what = if calls.acted {
            say!(
                "`{title}` is called by an action: its chart evolves in the scan behind that, while it is called"
            )
        } else {
            say!("`{title}` is called on a condition: its chart evolves behind the body, while it is called")
        };
        self.coder.say(&codes::DIFFERENT, node, what);
        let vars = self.of_charts.get_mut(unit)?;
        vars.push(nodes::variable(VarKind::Var, &called, Type::Bool, at));
        let waits = if calls.acted { &calling } else { &called };
        let guard = nodes::name(&[&chart, waits], at);
        if calls.acted {
            vars.push(nodes::variable(VarKind::Var, &calling, Type::Bool, at));
        }
        flags.insert((chart, called), (calls.acted.then_some(calling), at));
        Some(guard)
    }

    /// The bodies of the file: before the charts and behind them.
    fn bodies(&mut self, body: &mut Vec<Stmt>, mut behind: Vec<Stmt>, whole: &mut Whole, flags: &Flags) {
        let first = body.iter().position(calls);
        let last = body.iter().rposition(calls);
        if let (Some(first), Some(last)) = (first, last) {
            self.between(body, first, last);
        }
        let mut post = last.map(|last| body.split_off(last + 1)).unwrap_or_default();
        post.append(&mut behind);
        let mut pre = self.coder.plan.code.before.clone();
        for ((chart, called), (calling, at)) in flags {
            let flag = |name: &str| nodes::name(&[chart, name], *at);
            if let Some(calling) = calling {
                pre.push(nodes::assign(flag(calling), flag(called), *at));
            }
            pre.push(nodes::assign(flag(called), nodes::boolean(false, *at), *at));
        }
        resolve_calls(body, &|chart, flag, at| mark(flags, chart, flag, at));
        pre.append(body);
        whole.pre = (!pre.is_empty()).then_some(pre);
        whole.post = (!post.is_empty()).then_some(post);
    }

    /// Reports where a program uses values of a block between the calls of two charts.
    fn between(&mut self, body: &[Stmt], first: usize, last: usize) {
        let charts: HashSet<&str> = body.iter().filter_map(called).map(|c| c.0).collect();
        let gives = |s: &Stmt| match &s.kind {
            StmtKind::Assign { target, .. } => match &target.kind {
                g7_model::ExprKind::Path(p) => {
                    p.names.len() > 1 && p.names.first().is_some_and(|n| charts.contains(&*n.text))
                }
                _ => false,
            },
            StmtKind::Call(..) => called(s).is_some(),
            _ => false,
        };
        let last =
            if body.get(last).is_some_and(|s| called(s).is_none()) { last.saturating_sub(1) } else { last };
        let stretch = body.get(first..=last).unwrap_or(&[]);
        if let Some(other) = stretch.iter().find(|s| !gives(s)) {
            let what = say!(
                "charts of called blocks evolve together, behind this; what it reads of them is of the scan before"
            );
            self.coder.report.put(Problem::new(&codes::DIFFERENT, other.at.0, what));
        }
    }
}

/// The chart of a unit: its drawing, or a chart with only its variables and actions.
fn unit_chart(maker: &mut Maker, index: usize, vars: Vec<VarDecl>, guard: Option<&Expr>) {
    let plan = maker.coder.plan;
    let (Some(unit), Some(pou)) = (plan.units.get(index), plan.pou(index)) else { return };
    let sfc = tree::body(pou.node).filter(|(l, _)| *l == Language::Sfc).map(|(_, n)| n);
    let body = sfc.unwrap_or(pou.node);
    let (pre, flags) = flags(maker, index, &vars);
    let guard = match (guard.cloned(), flags) {
        (Some(a), Some(b)) => Some(nodes::and(a, b, Span::default())),
        (a, b) => a.or(b),
    };
    if sfc.is_none() && vars.is_empty() && pou.actions.is_empty() {
        return;
    }
    let order = Order {
        kind: ChartKind::Chart,
        name: unit.chart.clone(),
        unit: index,
        body,
        of: pou.node,
        guard,
        vars,
        pre,
        every: unit.interval,
    };
    if sfc.is_some() {
        maker.chart(order);
    } else {
        maker.shell(order);
    }
}

/// The variables by which CODESYS lets a program control its charts: those that reset the chart,
/// and the guard of the chart.
fn flags(maker: &mut Maker, index: usize, vars: &[VarDecl]) -> (Vec<Stmt>, Option<Expr>) {
    let plan = maker.coder.plan;
    let Some(unit) = plan.units.get(index).filter(|_| plan.is_chart(index)) else {
        return (Vec::new(), None);
    };
    let (mut pre, mut guard) = (Vec::new(), None);
    for decl in vars {
        let Some(name) = decl.names.first() else { continue };
        let (upper, at) = (name.text.to_uppercase(), name.at.0);
        let value = || nodes::name(&[&unit.chart, &name.text], at);
        match upper.as_str() {
            "SFCRESET" | "SFCINIT" => {
                let reset = nodes::path(&["INITCHART"], at);
                let arg = g7_model::Arg::input(None, nodes::name(&[&unit.chart], at));
                let reset = Stmt { kind: StmtKind::Call(reset, vec![arg]), at: at.into() };
                pre.push(nodes::when(nodes::name(&[&name.text], at), vec![reset], Vec::new(), at));
                if upper == "SFCINIT" {
                    guard = Some(held(guard, value(), at));
                }
            }
            "SFCPAUSE" => guard = Some(held(guard, value(), at)),
            other if other.starts_with("SFC") => {
                let what = say!("variables by which CODESYS tells of its charts; nothing writes them here");
                let range = decl.at.0.start as usize..decl.at.0.end as usize;
                maker.coder.report.element(&codes::DIFFERENT, "SFC flags", &range, what);
            }
            _ => {}
        }
    }
    (pre, guard)
}

fn held(guard: Option<Expr>, flag: Expr, at: Span) -> Expr {
    let free = nodes::not(flag, at);
    match guard {
        Some(guard) => nodes::and(guard, free, at),
        None => free,
    }
}

/// Collects names that are followed by a bracket, in upper case.
fn names_called(text: &str, called: &mut HashSet<String>) {
    for (at, _) in text.match_indices('(') {
        let before = text.get(..at).unwrap_or("").trim_end();
        let start = before.rfind(|c: char| !c.is_alphanumeric() && c != '_');
        let start =
            start.map_or(0, |s| s + before.get(s..).and_then(|r| r.chars().next()).map_or(1, char::len_utf8));
        let name = before.get(start..).unwrap_or("");
        if !name.is_empty() && name.len() <= 200 {
            called.insert(name.to_uppercase());
        }
    }
}

/// True if the statement calls a chart.
fn calls(statement: &Stmt) -> bool {
    called(statement).is_some() || statement.lists().into_iter().flatten().any(calls)
}

/// The statement that replaces the call of a chart: it sets the flag that the chart waits for.
fn mark(flags: &Flags, chart: &str, flag: &str, at: Span) -> Option<Stmt> {
    let known = flags.contains_key(&(chart.to_string(), flag.to_string()));
    known.then(|| nodes::assign(nodes::name(&[chart, flag], at), nodes::boolean(true, at), at))
}

/// Does the same in the actions of charts.
fn place_calls(charts: &mut [Chart], put: Put) {
    for chart in charts {
        for item in &mut chart.items {
            match item {
                ChartItem::Action(action) => body_calls(&mut action.body, put),
                ChartItem::Pre(body, _) | ChartItem::Post(body, _) => body_calls(body, put),
                ChartItem::Section(section) => resolve_calls(&mut section.body.statements, put),
                ChartItem::Step(step) => {
                    for action in &mut step.actions {
                        work_calls(action, put);
                    }
                }
                ChartItem::Var(_) | ChartItem::Transition(_) => {}
            }
        }
    }
}

fn body_calls(body: &mut Body, put: Put) {
    if let Body::St(block) = body {
        resolve_calls(&mut block.statements, put);
    }
}

fn work_calls(action: &mut g7_model::Action, put: Put) {
    use g7_model::{ActionKind, Target, Work};
    let work = match &mut action.kind {
        ActionKind::Qualified { target: Target::Work(work), .. }
        | ActionKind::OnEvent { work, .. }
        | ActionKind::EachScan { work, .. } => work,
        ActionKind::Qualified { .. } | ActionKind::Order(_) | ActionKind::Comment(_) => return,
    };
    let (mut statements, at) = match work {
        Work::Single(one) => (vec![(**one).clone()], one.at.0),
        Work::Block(block) => (std::mem::take(&mut block.statements), block.at.0),
    };
    resolve_calls(&mut statements, put);
    *work = match (work.clone(), statements.len()) {
        (Work::Single(_), 1) => match statements.pop() {
            Some(one) => Work::Single(Box::new(one)),
            None => Work::Block(block(Vec::new(), at)),
        },
        _ => Work::Block(block(statements, at)),
    };
}
