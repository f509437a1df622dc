//! Charts, steps, actions and transitions.

use super::Printer;
use super::item::starts;
use crate::quote;
use g7_model::{
    Action, ActionKind, Chart, ChartItem, ChartKind, ExprKind, Literal, Name, Order, Situation, Span, Step,
    StepKind, Target, Transition,
};

impl Printer<'_> {
    pub(super) fn chart(&mut self, chart: &Chart) {
        self.push(match chart.kind {
            ChartKind::Chart => "chart ",
            ChartKind::Expansion => "macrochart ",
            ChartKind::Task => "task ",
        });
        self.name(&chart.name.text);
        if !chart.params.is_empty() {
            self.params(&chart.params);
        }
        if let Some(block) = &chart.block {
            self.push(" of ");
            self.name(&block.text);
        }
        self.comment(chart.comment.as_deref());
        self.time_clause("every", chart.every, chart.at.0);
        self.push(" ");
        let first = starts(chart.items.first().map(ChartItem::at));
        self.braces(chart.at.0, first, |p| p.chart_items(&chart.items));
    }

    fn chart_items(&mut self, items: &[ChartItem]) {
        let mut before: Option<&ChartItem> = None;
        for item in items {
            let apart = self.source.is_none() && before.is_some_and(|b| stand_apart(b, item));
            self.chart_item(item, before, apart);
            before = Some(item);
        }
    }

    pub(super) fn chart_item(&mut self, item: &ChartItem, before: Option<&ChartItem>, apart: bool) {
        let at = item.at();
        match item {
            ChartItem::Var(v) => self.line(at, apart, |p| p.variable(v)),
            ChartItem::Step(s) if !s.braces && s.actions.is_empty() => self.line(at, apart, |p| p.step(s)),
            ChartItem::Step(s) => self.group(at, apart, |p| p.step(s)),
            ChartItem::Transition(t) => {
                let chained = before.is_some_and(|b| follows(t, b));
                self.indent += usize::from(chained);
                if t.on_clearing.is_some() {
                    self.group(at, apart, |p| p.transition(t, chained));
                } else {
                    self.line(at, apart, |p| p.transition(t, chained));
                }
                self.indent -= usize::from(chained);
            }
            ChartItem::Pre(body, _) => self.group(at, apart, |p| {
                p.push("pre ");
                p.body(body);
            }),
            ChartItem::Post(body, _) => self.group(at, apart, |p| {
                p.push("post ");
                p.body(body);
            }),
            ChartItem::Action(a) => self.group(at, apart, |p| p.named_action(a)),
            ChartItem::Section(s) => self.section_item(s, apart),
        }
    }

    pub(super) fn step_words(&mut self, kind: &StepKind, initial: bool) {
        self.push(if initial { "initial " } else { "" });
        self.push(match kind {
            StepKind::Plain => "step",
            StepKind::Entry => "entry step",
            StepKind::Exit => "exit step",
            StepKind::Enclosing => "enclosing step",
            StepKind::Macro(_) => "macro",
        });
    }

    fn step(&mut self, step: &Step) {
        self.step_words(&step.kind, step.initial);
        self.push(" ");
        self.name(&step.name.text);
        if let StepKind::Macro(expansion) = &step.kind {
            self.push(" = ");
            self.chart_path(&expansion.text);
        }
        self.push(if step.linked { "*" } else { "" });
        self.comment(step.comment.as_deref());
        if step.actions.is_empty() && !step.braces {
            return;
        }
        self.push(" ");
        self.actions(&step.actions, step.at.0);
    }

    /// The actions of a step at a place, in braces; a single short one stays on the line.
    pub(super) fn actions(&mut self, actions: &[Action], at: Span) {
        let alone = match actions {
            [one] => Some(one).filter(|_| !self.notes_in(at) && !self.spelled_with_note(one.at.0)),
            _ => None,
        };
        let inline = alone.is_some_and(|action| {
            self.try_inline(|p| {
                p.push("{ ");
                p.action(action);
                p.push(" }");
            })
        });
        if inline {
            return;
        }
        let first = actions.first().map(|a| a.at.0.start);
        self.braces(at, first, |p| {
            for action in actions {
                if has_block(action) {
                    p.group(action.at.0, false, |p| p.action(action));
                } else {
                    p.line(action.at.0, false, |p| p.action(action));
                }
            }
        });
    }

    pub(super) fn action(&mut self, action: &Action) {
        if self.as_spelled(action.at.0) {
            return;
        }
        match &action.kind {
            ActionKind::Qualified { qualifier, time, target, condition } => {
                self.push(qualifier.name());
                self.push(" ");
                if let Some(time) = time {
                    if matches!(time.kind, ExprKind::Literal(Literal::Time(_))) {
                        self.expr(time);
                        self.push(" ");
                    } else {
                        self.push("(");
                        self.expr(time);
                        self.push(") ");
                    }
                }
                self.action_target(target);
                self.if_condition(condition.as_ref());
            }
            ActionKind::OnEvent { event, work } => {
                self.push("on ");
                self.expr(event);
                self.push(": ");
                self.work(work);
            }
            ActionKind::EachScan { work, condition } => {
                self.push("each scan: ");
                self.work(work);
                self.if_condition(condition.as_ref());
            }
            ActionKind::Order(order) => self.order(order),
            ActionKind::Comment(text) => self.push(&quote::quote(text, '"')),
        }
    }

    fn action_target(&mut self, target: &Target) {
        match target {
            Target::Path(path) => self.path(path),
            Target::Element(element) => self.expr(element),
            Target::Direct(name, _) => {
                self.push("%");
                self.push(name);
            }
            Target::Work(work) => self.work(work),
        }
    }

    fn if_condition(&mut self, condition: Option<&g7_model::Expr>) {
        if let Some(condition) = condition {
            self.push(" if ");
            self.expr(condition);
        }
    }

    fn order(&mut self, order: &Order) {
        let (word, name) = match order {
            Order::Force(name, _) => ("force ", name),
            Order::Enable(name) => ("enable ", name),
            Order::Mask(name) => ("mask ", name),
            Order::Call(name) => ("call ", name),
            Order::Enclose(name) => ("enclose ", name),
        };
        self.push(word);
        self.chart_path(&name.text);
        let Order::Force(_, situation) = order else { return };
        self.push(" := ");
        match situation {
            Situation::Init => self.push("INIT"),
            Situation::Current => self.push("{*}"),
            Situation::Steps(steps) => {
                self.push("{");
                self.step_names(steps);
                self.push("}");
            }
        }
    }

    fn step_names(&mut self, names: &[Name]) {
        for (i, name) in names.iter().enumerate() {
            self.push(if i > 0 { ", " } else { "" });
            self.first_name(&name.text);
        }
    }

    fn transition(&mut self, t: &Transition, chained: bool) {
        if !chained {
            if let Some(label) = &t.label {
                self.transition_label(label);
                self.push(" ");
            }
            self.step_list(&t.from);
            self.push(" ");
        }
        self.push("-> ");
        self.step_list(&t.to);
        self.push(" when ");
        self.expr(&t.receptivity);
        if let Some(n) = t.priority {
            self.push(&format!(" priority {n}"));
        }
        self.comment(t.comment.as_deref());
        if let Some(block) = &t.on_clearing {
            self.push(" on clearing ");
            self.block(block);
        }
    }

    /// A label and its colon.
    pub(super) fn transition_label(&mut self, label: &Name) {
        self.first_name(&label.text);
        self.push(":");
    }

    pub(super) fn step_list(&mut self, names: &[Name]) {
        if let [one] = names {
            return self.first_name(&one.text);
        }
        self.push("(");
        self.step_names(names);
        self.push(")");
    }
}

/// True if a transition continues where the one before it ended.
fn follows(t: &Transition, before: &ChartItem) -> bool {
    let ChartItem::Transition(b) = before else { return false };
    t.chained && t.label.is_none() && t.from == b.to
}

/// True if the action contains a block, which may have notes of its own.
fn has_block(action: &Action) -> bool {
    use g7_model::Work;
    match &action.kind {
        ActionKind::Qualified { target: Target::Work(work), .. }
        | ActionKind::OnEvent { work, .. }
        | ActionKind::EachScan { work, .. } => matches!(work, Work::Block(_)),
        _ => false,
    }
}

/// True if a blank line separates two items that a program made.
pub(super) fn stand_apart(a: &ChartItem, b: &ChartItem) -> bool {
    family(a) != family(b) || family(b) == 3
}

/// The group of an item: items of one group stand together without a blank line, those of group 3
/// never.
fn family(item: &ChartItem) -> u8 {
    match item {
        ChartItem::Var(_) => 0,
        ChartItem::Step(_) => 1,
        ChartItem::Transition(_) => 2,
        ChartItem::Pre(..) | ChartItem::Post(..) | ChartItem::Action(_) | ChartItem::Section(_) => 3,
    }
}
