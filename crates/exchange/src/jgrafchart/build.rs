//! Builds the document from workspaces.

use g7_model::codes;
use g7_model::{
    Action, ActionKind, Body, Chart, ChartItem, ChartKind, Document, Expr, Item, Layout, Name, Nanos, Order,
    PlaceAt, Placed, Profile, ProfileName, Span, Step, StepKind, Transition, Type, VarDecl, VarKind, say,
};

use super::actions::Texts;
use super::guards::Guards;
use super::limits::MOST_WORK;
use super::links::{self, Ends};
use super::naming::{self, Names, writable};
use super::sheet::{Plan, Sheet, SheetKind, StepNode, StepSort, Var, name_place};
use super::values::{constant_zero, literal};
use g7_iec::nodes;
use g7_iec::report::Report;

/// JGrafchart's default time between two scans, in milliseconds.
const DEFAULT_SCAN: i64 = 40;
/// Hundredths of the drawing's unit per pixel of JGrafchart. Its steps are about 120 pixels apart,
/// ours 13 units.
const PER_PIXEL: i32 = 10;
/// The longest time between two scans of a workspace, in milliseconds: a day.
const MOST_PACE: i64 = 86_400_000;

/// The document of a file.
pub(super) fn document(plan: &Plan, report: &mut Report) -> Document {
    if plan.sheets.is_empty() {
        return Document { items: Vec::new(), notes: report.take_notes() };
    }
    let at = report.span(&plan.at);
    let names = naming::give(plan, report);
    let scan = scan(plan, report);
    let mut items = vec![
        Item::Profile(Profile { name: ProfileName::Jgrafchart, switches: Vec::new(), at: at.into() }),
        Item::Cycle(Nanos::from_millis(scan), at.into()),
    ];
    for (index, sheet) in plan.sheets.iter().enumerate() {
        let of_file = |(n, _): &(usize, &Var)| names.is_of_file(index, *n);
        let vars = sheet.vars.iter().enumerate().filter(of_file);
        items.extend(vars.map(|(_, var)| Item::Var(declaration(var, report))));
    }
    let ends: Vec<Vec<Ends>> = (0..plan.sheets.len()).map(|i| links::ends(plan, i, &names, report)).collect();
    let guards = Guards::find(plan, &names, &ends, report);
    let mut builder =
        Builder { plan, names: &names, ends: &ends, guards: &guards, left: MOST_WORK, scan, report };
    items.extend((0..plan.sheets.len()).filter_map(|i| builder.chart(i)).map(Item::Chart));
    items.extend((0..plan.sheets.len()).filter_map(|i| builder.layout(i)).map(Item::Layout));
    Document { items, notes: report.take_notes() }
}

/// The time between two scans: the shortest of all top workspaces.
fn scan(plan: &Plan, report: &mut Report) -> i64 {
    let tops = || plan.sheets.iter().filter(|s| s.kind == SheetKind::Top);
    let speed = |s: &Sheet| s.speed.unwrap_or(DEFAULT_SCAN);
    let scan = tops().map(speed).min().unwrap_or(DEFAULT_SCAN);
    for sheet in tops().filter(|s| speed(s) % scan != 0) {
        let what = say!("this workspace runs every {} ms, which is no multiple of {scan} ms", speed(sheet));
        report.say(&codes::DIFFERENT, &sheet.at, what);
    }
    scan
}

struct Builder<'a> {
    plan: &'a Plan,
    names: &'a Names,
    ends: &'a [Vec<Ends>],
    guards: &'a Guards,
    left: usize,
    scan: i64,
    report: &'a mut Report,
}

impl Builder<'_> {
    fn chart(&mut self, index: usize) -> Option<Chart> {
        let sheet = self.plan.sheets.get(index)?;
        let mut items: Vec<ChartItem> = Vec::new();
        for (number, var) in sheet.vars.iter().enumerate() {
            if !self.names.is_of_file(index, number) {
                items.push(ChartItem::Var(declaration(var, self.report)));
            }
        }
        for inside in self.insides(index) {
            items.extend(self.flag(inside).map(ChartItem::Var));
        }
        let kinds = self.kinds(index, sheet);
        for (number, (step, kind)) in sheet.steps.iter().zip(kinds).enumerate() {
            if step.fused.is_none() {
                let step = self.step(index, number, step, kind);
                items.push(ChartItem::Step(step));
            }
        }
        items.extend(self.missing_exit(index, sheet).map(ChartItem::Step));
        let mut conditions = Vec::new();
        for number in 0..sheet.transitions.len() {
            let Some((transition, condition)) = self.transition(index, number) else { continue };
            items.push(ChartItem::Transition(transition));
            conditions.push(condition);
        }
        items.extend(self.beginning(index, &conditions));
        let at = self.report.span(&sheet.at);
        let pace = self.pace(sheet);
        Some(Chart {
            params: Vec::new(),
            block: None,
            kind: if self.is_expansion(index) { ChartKind::Expansion } else { ChartKind::Chart },
            name: Name::new(self.names.chart(index), self.report.span(&name_place(&sheet.name, &sheet.at))),
            comment: None,
            every: (!self.is_expansion(index) && pace != self.scan).then_some(Nanos::from_millis(pace)),
            items,
            at: at.into(),
        })
    }

    /// True if a workspace is the expansion of a macro-step and not a chart of its own.
    fn is_expansion(&self, index: usize) -> bool {
        let inside = self.plan.sheets.get(index).is_some_and(|s| s.kind == SheetKind::Macro);
        inside && !self.guards.enclosed.get(index).copied().unwrap_or(false)
    }

    /// The workspaces inside the steps of this one.
    fn insides(&self, index: usize) -> Vec<usize> {
        let steps = self.plan.sheets.get(index).map_or(&[][..], |s| &s.steps);
        let inside = |s: &StepNode| if let StepSort::Macro(inside) = s.sort { inside } else { None };
        steps.iter().filter_map(inside).collect()
    }

    /// The variable that tells that an exception transition deactivates a workspace.
    fn flag(&self, inside: usize) -> Option<VarDecl> {
        let name = self.guards.flag.get(inside)?.as_ref()?;
        let at = self.report.span(&self.plan.sheets.get(inside)?.at);
        Some(nodes::variable(VarKind::Var, name, Type::Bool, at))
    }

    /// The body at the beginning of a scan: it computes variables that follow an expression, then
    /// the flags of macro-steps that an exception transition deactivates.
    fn beginning(&mut self, index: usize, conditions: &[Expr]) -> Option<ChartItem> {
        let sheet = self.plan.sheets.get(index)?;
        let at = self.report.span(&sheet.at);
        let mut statements = Vec::new();
        for (number, var) in sheet.vars.iter().enumerate() {
            let Some(text) = &var.follows else { continue };
            let mut texts =
                Texts { plan: self.plan, names: self.names, report: self.report, left: self.left };
            statements.extend(texts.follow(index, number, text));
            self.left = texts.left;
        }
        let ends = self.ends.get(index).map_or(&[][..], Vec::as_slice);
        let all = sheet.transitions.iter().zip(ends).zip(conditions);
        let exceptions: Vec<(&Ends, &Expr)> =
            all.filter(|((t, _), _)| t.exception).map(|((_, e), c)| (e, c)).collect();
        for inside in self.insides(index) {
            let Some(flag) = self.guards.flag.get(inside).and_then(Option::as_ref) else { continue };
            let marked = self.guards.marked((self.plan, self.names), inside, &exceptions, at);
            let target = nodes::name(&[flag], at);
            statements.extend(marked.map(|value| nodes::assign(target, value, at)));
        }
        let body = Body::St(nodes::block(statements, at));
        matches!(&body, Body::St(b) if !b.statements.is_empty()).then(|| ChartItem::Pre(body, at.into()))
    }

    /// The milliseconds between two scans of a workspace: those of the top workspace around it.
    fn pace(&self, sheet: &Sheet) -> i64 {
        let mut top = sheet;
        let mut cycle = sheet.cycle;
        while let Some(outer) = top.owner.map(|o| o.0).or(top.parent).and_then(|p| self.plan.sheets.get(p)) {
            top = outer;
            cycle = cycle.saturating_mul(top.cycle);
        }
        top.speed.unwrap_or(DEFAULT_SCAN).saturating_mul(cycle).min(MOST_PACE)
    }

    /// The kind of each step. Enter and exit steps are allowed only in macro-steps.
    fn kinds(&mut self, index: usize, sheet: &Sheet) -> Vec<StepKind> {
        let inside = sheet.kind == SheetKind::Macro;
        let expansion = self.is_expansion(index);
        let mut ends = [(StepSort::Enter, say!("enter"), None), (StepSort::Exit, say!("exit"), None)];
        let mut kinds = Vec::with_capacity(sheet.steps.len());
        for (number, step) in sheet.steps.iter().enumerate() {
            let mut kind = StepKind::Plain;
            if let StepSort::Macro(inner) = step.sort {
                kind = self.macro_kind(inner, step);
            }
            for (sort, word, first) in ends.iter_mut().filter(|(sort, ..)| *sort == step.sort) {
                if !inside {
                    let what = say!("an {} step outside a macro-step; it is a plain step", &*word);
                    self.report.say(&codes::DIFFERENT, &step.at, what);
                } else if first.replace(number).is_some() {
                    if *sort == StepSort::Enter {
                        let what = say!("a second enter step; only one way in is carried over");
                        self.report.say(&codes::NOT_CARRIED, &step.at, what);
                    }
                } else if expansion {
                    kind = if *sort == StepSort::Enter { StepKind::Entry } else { StepKind::Exit };
                }
            }
            if inside && step.sort == StepSort::Initial {
                let what = say!(
                    "an initial step inside a macro-step; the enter step is what a macro-step starts with"
                );
                self.report.say(&codes::DIFFERENT, &step.at, what);
            }
            kinds.push(kind);
        }
        if let [(_, _, None), _] = ends
            && inside
        {
            let what = say!("the macro-step `{}` has no enter step", self.names.chart(index));
            self.report.say(&codes::BAD_MACRO, &sheet.at, what);
        }
        kinds
    }

    fn macro_kind(&mut self, inner: Option<usize>, step: &StepNode) -> StepKind {
        match inner {
            Some(chart) if !self.is_expansion(chart) => StepKind::Enclosing,
            Some(chart) => {
                let at = self.report.span(&name_place(&step.name, &step.at));
                StepKind::Macro(Name::new(self.names.chart(chart), at))
            }
            None => {
                self.report.say(&codes::BAD_MACRO, &step.at, say!("a macro-step without a workspace inside"));
                StepKind::Plain
            }
        }
    }

    fn step(&mut self, index: usize, number: usize, node: &StepNode, kind: StepKind) -> Step {
        let at = self.report.span(&node.at);
        let expansion = self.is_expansion(index);
        let entry = node.sort == StepSort::Enter && self.first_enter(index) == Some(number);
        let inside = if let StepSort::Macro(inside) = node.sort { inside } else { None };
        let aborted = self.guards.aborted(self.plan, self.names, inside.unwrap_or(index), index, at);
        let mut texts = Texts { plan: self.plan, names: self.names, report: self.report, left: self.left };
        let mut actions = Vec::new();
        if let Some(inside) = inside.filter(|_| kind == StepKind::Enclosing) {
            let chart = Name::new(self.names.chart(inside), at);
            actions.push(Action { kind: ActionKind::Order(Order::Enclose(chart)), at: at.into() });
        }
        if entry {
            actions.extend(texts.begin(index));
        }
        for text in &node.actions {
            actions.extend(texts.actions(index, text, aborted.as_ref()));
        }
        self.left = texts.left;
        Step {
            name: Name::new(
                self.names.step(index, number),
                self.report.span(&name_place(&node.name, &node.at)),
            ),
            kind,
            initial: node.sort == StepSort::Initial && self.starts(index),
            linked: entry
                && !expansion
                && self.plan.sheets.get(index).is_some_and(|s| s.kind == SheetKind::Macro),
            comment: None,
            braces: !actions.is_empty(),
            actions,
            at: at.into(),
        }
    }

    /// The first enter step of a macro-step.
    fn first_enter(&self, index: usize) -> Option<usize> {
        self.plan.sheets.get(index)?.steps.iter().position(|s| s.sort == StepSort::Enter)
    }

    /// True if the initial steps of a workspace are active at the start.
    fn starts(&self, index: usize) -> bool {
        self.plan.sheets.get(index).is_some_and(|s| s.kind != SheetKind::Macro)
    }

    /// A macro-step that is never left needs no exit step in JGrafchart, but needs one here.
    fn missing_exit(&mut self, index: usize, sheet: &Sheet) -> Option<Step> {
        if !self.is_expansion(index) || sheet.steps.iter().any(|s| s.sort == StepSort::Exit) {
            return None;
        }
        let what = say!(
            "the macro-step `{}` has no exit step; it gets one that is never reached",
            self.names.chart(index)
        );
        self.report.say(&codes::DIFFERENT, &sheet.at, what);
        let at = self.report.span(&sheet.at);
        let taken = |name: &str| self.names.steps.get(index).is_some_and(|s| s.iter().any(|n| n == name));
        let mut name = "no exit".to_string();
        while taken(&name) {
            name.push('_');
        }
        Some(Step {
            name: Name::new(name, at),
            kind: StepKind::Exit,
            initial: false,
            linked: false,
            comment: None,
            actions: Vec::new(),
            braces: false,
            at: at.into(),
        })
    }

    /// A transition, and the condition of its own text.
    fn transition(&mut self, index: usize, number: usize) -> Option<(Transition, Expr)> {
        let sheet = self.plan.sheets.get(index)?;
        let node = sheet.transitions.get(number)?;
        let nowhere = Ends::default();
        let ends = self.ends.get(index).and_then(|e| e.get(number)).unwrap_or(&nowhere);
        let mut texts = Texts { plan: self.plan, names: self.names, report: self.report, left: self.left };
        let condition = texts.condition(index, &node.condition, &node.at);
        self.left = texts.left;
        let at = self.report.span(&node.at);
        let name = |step: &usize| Name::new(self.names.step(index, *step), at);
        let receptivity =
            self.guards.receptivity((self.plan, self.names), (index, number), ends, condition.clone(), at);
        let transition = Transition {
            label: None,
            from: ends.from.iter().map(name).collect(),
            to: ends.to.iter().map(name).collect(),
            receptivity,
            priority: node.priority,
            comment: None,
            on_clearing: None,
            chained: false,
            at: at.into(),
        };
        Some((transition, condition))
    }

    fn layout(&self, index: usize) -> Option<Layout> {
        let sheet = self.plan.sheets.get(index)?;
        let at = self.report.span(&sheet.at);
        let place = |what: Placed, x: i32, y: i32, at: Span| PlaceAt {
            what,
            x: x.saturating_mul(PER_PIXEL),
            y: y.saturating_mul(PER_PIXEL),
            then: Vec::new(),
            at: at.into(),
        };
        let drawn = sheet.steps.iter().enumerate().filter(|(_, step)| step.fused.is_none());
        let steps = drawn.map(|(number, step)| {
            let at = self.report.span(&step.at);
            place(Placed::Step(Name::new(self.names.step(index, number), at)), step.x, step.y, at)
        });
        let transitions = sheet.transitions.iter().zip(0u32..).map(|(transition, number)| {
            let at = self.report.span(&transition.at);
            place(Placed::TransitionNumber(number), transition.x, transition.y, at)
        });
        let texts = sheet.texts.iter().map(|free| {
            place(Placed::Comment(comment(&free.text.text)), free.x, free.y, self.report.span(&free.text.at))
        });
        let places: Vec<PlaceAt> = steps.chain(transitions).chain(texts).collect();
        let chart = Name::new(self.names.chart(index), at);
        (!places.is_empty()).then_some(Layout { chart, places, at: at.into() })
    }
}

/// A text of the drawing without characters that a comment cannot hold.
fn comment(text: &str) -> Box<str> {
    let put = |c: char| if c != '\n' && c.is_control() { ' ' } else { c };
    text.trim_end().chars().map(put).collect::<String>().into()
}

fn declaration(var: &Var, report: &Report) -> VarDecl {
    let at = report.span(&var.at);
    let name_at = report.span(&name_place(&var.name, &var.at));
    VarDecl {
        init: var.init.as_ref().map(|v| literal(v, at)).or_else(|| constant_zero(var, at)),
        address: var.channel.as_ref().map(|c| Name::new(writable(c.text.trim()), report.span(&c.at))),
        inverted: var.inverted,
        retain: var.retain,
        ..VarDecl::new(var.kind, vec![Name::new(writable(&var.name.text), name_at)], var.ty, at.into())
    }
}
