//! From workspaces to the document.

use g7_model::codes;
use g7_model::{
    Chart, ChartItem, ChartKind, Document, Expr, ExprKind, Item, Layout, Literal, Name, PlaceAt, Placed,
    Profile, ProfileName, Span, Step, StepKind, Transition, UnaryOp, VarDecl,
};

use super::actions::{MOST_WORK, Texts};
use super::express::written;
use super::links::{self, Ends};
use super::names::{self, Names, writable};
use super::read::name_place;
use super::sheet::{Plan, Sheet, SheetKind, StepNode, StepSort, Value, Var};
use crate::report::Report;

/// JGrafchart's own default, in milliseconds.
const DEFAULT_SCAN: i64 = 40;
/// Hundredths of the drawing's unit in one of JGrafchart's pixels: its steps are
/// some 120 apart, ours 13 units.
const PER_PIXEL: i32 = 10;
const NS_PER_MS: i64 = 1_000_000;

/// The document of a file.
pub(super) fn document(plan: &Plan, report: &mut Report) -> Document {
    if plan.sheets.is_empty() {
        return Document { items: Vec::new(), notes: report.take_notes() };
    }
    let at = report.span(&plan.at);
    let names = names::give(plan, report);
    let scan = scan(plan, report);
    let mut items = vec![
        Item::Profile(Profile { name: ProfileName::Jgrafchart, switches: Vec::new(), at: at.into() }),
        Item::Cycle(scan * NS_PER_MS, at.into()),
    ];
    for (index, sheet) in plan.sheets.iter().enumerate() {
        let of_file = |(n, _): &(usize, &Var)| names.is_of_file(index, *n);
        let vars = sheet.vars.iter().enumerate().filter(of_file);
        items.extend(vars.map(|(_, var)| Item::Var(declaration(var, report))));
    }
    let mut builder = Builder { plan, names: &names, left: MOST_WORK, scan, report };
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
        let what =
            format!("this workspace runs every {} ms, which is no multiple of {scan} ms", speed(sheet));
        report.say(&codes::DIFFERENT, &sheet.at, what);
    }
    scan
}

struct Builder<'a> {
    plan: &'a Plan,
    names: &'a Names,
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
        let kinds = self.kinds(index, sheet);
        for (number, (step, kind)) in sheet.steps.iter().zip(kinds).enumerate() {
            let step = self.step(index, number, step, kind);
            items.push(ChartItem::Step(step));
        }
        items.extend(self.missing_exit(index, sheet).map(ChartItem::Step));
        let ends = links::ends(self.plan, index, self.names, self.report);
        for (number, ends) in ends.iter().enumerate() {
            items.extend(self.transition(index, number, ends).map(ChartItem::Transition));
        }
        let at = self.report.span(&sheet.at);
        let pace = self.pace(sheet);
        Some(Chart {
            kind: if sheet.kind == SheetKind::Macro { ChartKind::Expansion } else { ChartKind::Chart },
            name: Name::new(self.names.chart(index), self.report.span(&name_place(&sheet.name, &sheet.at))),
            comment: comment(sheet),
            every: (sheet.kind != SheetKind::Macro && pace != self.scan).then_some(pace * NS_PER_MS),
            items,
            at: at.into(),
        })
    }

    /// Milliseconds between two scans of a workspace: those of the top one around it.
    fn pace(&self, sheet: &Sheet) -> i64 {
        let mut top = sheet;
        while let Some(outer) = top.parent.and_then(|p| self.plan.sheets.get(p)) {
            top = outer;
        }
        top.speed.unwrap_or(DEFAULT_SCAN)
    }

    /// What each step is; enter and exit steps have their place in macro-steps only.
    fn kinds(&mut self, index: usize, sheet: &Sheet) -> Vec<StepKind> {
        let inside = sheet.kind == SheetKind::Macro;
        let mut ends = [(StepSort::Enter, "enter", None), (StepSort::Exit, "exit", None)];
        let mut kinds = Vec::with_capacity(sheet.steps.len());
        for (number, step) in sheet.steps.iter().enumerate() {
            let mut kind = StepKind::Plain;
            if let StepSort::Macro(inner) = step.sort {
                kind = self.macro_kind(inner, step);
            }
            for (sort, word, first) in ends.iter_mut().filter(|(sort, ..)| *sort == step.sort) {
                if !inside {
                    let what = format!("an {word} step outside a macro-step; it is a plain step");
                    self.report.say(&codes::DIFFERENT, &step.at, what);
                } else if first.replace(number).is_some() {
                    let what =
                        format!("a second {word} step; only one way in and one way out are carried over");
                    self.report.say(&codes::NOT_CARRIED, &step.at, what);
                } else {
                    kind = if *sort == StepSort::Enter { StepKind::Entry } else { StepKind::Exit };
                }
            }
            if inside && step.sort == StepSort::Initial {
                let what =
                    "an initial step inside a macro-step; the enter step is what a macro-step starts with";
                self.report.say(&codes::DIFFERENT, &step.at, what);
            }
            kinds.push(kind);
        }
        if let [(_, _, None), _] = ends
            && inside
        {
            let what = format!("the macro-step `{}` has no enter step", self.names.chart(index));
            self.report.say(&codes::BAD_MACRO, &sheet.at, what);
        }
        kinds
    }

    fn macro_kind(&mut self, inner: Option<usize>, step: &StepNode) -> StepKind {
        match inner {
            Some(chart) => {
                let at = self.report.span(&name_place(&step.name, &step.at));
                StepKind::Macro(Name::new(self.names.chart(chart), at))
            }
            None => {
                self.report.say(&codes::BAD_MACRO, &step.at, "a macro-step without a workspace inside");
                StepKind::Plain
            }
        }
    }

    fn step(&mut self, index: usize, number: usize, node: &StepNode, kind: StepKind) -> Step {
        let mut texts = Texts { plan: self.plan, names: self.names, report: self.report, left: self.left };
        let actions = texts.actions(index, &node.actions);
        self.left = texts.left;
        let at = self.report.span(&node.at);
        Step {
            name: Name::new(
                self.names.step(index, number),
                self.report.span(&name_place(&node.name, &node.at)),
            ),
            kind,
            initial: node.sort == StepSort::Initial && self.starts(index),
            linked: false,
            comment: None,
            braces: !actions.is_empty(),
            actions,
            at: at.into(),
        }
    }

    /// Whether the initial steps of a workspace are active at the start.
    fn starts(&self, index: usize) -> bool {
        self.plan.sheets.get(index).is_some_and(|s| s.kind != SheetKind::Macro)
    }

    /// A macro-step that is never left needs no exit step there, but has one here.
    fn missing_exit(&mut self, index: usize, sheet: &Sheet) -> Option<Step> {
        if sheet.kind != SheetKind::Macro || sheet.steps.iter().any(|s| s.sort == StepSort::Exit) {
            return None;
        }
        let what = format!(
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

    fn transition(&mut self, index: usize, number: usize, ends: &Ends) -> Option<Transition> {
        let sheet = self.plan.sheets.get(index)?;
        let node = sheet.transitions.get(number)?;
        let mut texts = Texts { plan: self.plan, names: self.names, report: self.report, left: self.left };
        let receptivity = texts.condition(index, &node.condition, &node.at);
        self.left = texts.left;
        let at = self.report.span(&node.at);
        let name = |step: &usize| Name::new(self.names.step(index, *step), at);
        Some(Transition {
            label: None,
            from: ends.from.iter().map(name).collect(),
            to: ends.to.iter().map(name).collect(),
            receptivity,
            priority: node.priority,
            comment: None,
            on_clearing: None,
            chained: false,
            at: at.into(),
        })
    }

    fn layout(&self, index: usize) -> Option<Layout> {
        let sheet = self.plan.sheets.get(index)?;
        let at = self.report.span(&sheet.at);
        let place = |what: Placed, x: i32, y: i32, at: Span| PlaceAt {
            what,
            x: x.saturating_mul(PER_PIXEL),
            y: y.saturating_mul(PER_PIXEL),
            at: at.into(),
        };
        let steps = sheet.steps.iter().enumerate().map(|(number, step)| {
            let at = self.report.span(&step.at);
            place(Placed::Step(Name::new(self.names.step(index, number), at)), step.x, step.y, at)
        });
        let transitions = sheet.transitions.iter().zip(0u32..).map(|(transition, number)| {
            let at = self.report.span(&transition.at);
            place(Placed::TransitionNumber(number), transition.x, transition.y, at)
        });
        let places: Vec<PlaceAt> = steps.chain(transitions).collect();
        let chart = Name::new(self.names.chart(index), at);
        (!places.is_empty()).then_some(Layout { chart, places, at: at.into() })
    }
}

/// The free texts of a workspace, as the comment of its chart.
fn comment(sheet: &Sheet) -> Option<Box<str>> {
    let clean = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    let texts: Vec<String> = sheet.texts.iter().map(|t| clean(&t.text)).collect();
    (!texts.is_empty()).then(|| texts.join(" / ").into())
}

fn declaration(var: &Var, report: &Report) -> VarDecl {
    let at = report.span(&var.at);
    let name_at = report.span(&name_place(&var.name, &var.at));
    VarDecl {
        kind: var.kind,
        names: vec![Name::new(writable(&var.name.text), name_at)],
        ty: var.ty,
        init: var.init.as_ref().map(|v| literal(v, at)).or_else(|| constant_zero(var, at)),
        address: var.channel.as_ref().map(|c| Name::new(writable(c.text.trim()), report.span(&c.at))),
        inverted: var.inverted,
        retain: var.retain,
        safe: None,
        comment: None,
        at: at.into(),
    }
}

/// A constant has a value in any case.
fn constant_zero(var: &Var, at: Span) -> Option<Expr> {
    if var.kind != g7_model::VarKind::Const {
        return None;
    }
    let zero = match var.ty {
        g7_model::Type::Bool => Value::Bool(false),
        g7_model::Type::Dint => Value::Int(0),
        g7_model::Type::Lreal => Value::Real(0.0),
        _ => Value::Str(String::new()),
    };
    Some(literal(&zero, at))
}

/// A value as it would be written: a sign stands before the number.
fn literal(value: &Value, at: Span) -> Expr {
    let (literal, negative) = match value {
        Value::Bool(b) => (Literal::Bool(*b), false),
        Value::Int(n) => (Literal::Int(i128::from(*n).abs(), None), *n < 0),
        Value::Real(r) => (Literal::Real(written(r.abs()).into(), None), *r < 0.0),
        Value::Str(s) => (Literal::Str(s.as_str().into()), false),
    };
    let expr = Expr { kind: ExprKind::Literal(literal), at: at.into() };
    if !negative {
        return expr;
    }
    Expr { kind: ExprKind::Unary(UnaryOp::Neg, Box::new(expr)), at: at.into() }
}
