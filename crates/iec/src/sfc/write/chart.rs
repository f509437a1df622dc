//! Writes a chart as steps, transitions and actions.

use std::collections::HashSet;

use g7_model::{
    Action, ActionKind, Chart, ChartItem, NamedAction, Problem, Qualifier, Step, Stmt, Target, Transition,
    Work, codes, say,
};

use super::{Exporter, clean};
use crate::st::{Known, Writer};

impl<'d> Exporter<'d> {
    /// The body of a chart's program.
    pub(super) fn chart(&mut self, chart: &'d Chart) -> String {
        let types = Known::new(self.document, Some(chart));
        let writer = Writer { types: &types };
        self.order(chart);
        let mut parts = Parts::default();
        if let Some(comment) = &chart.comment {
            parts.out.push_str(&format!("  (* {} *)\n", clean(comment)));
        }
        for item in &chart.items {
            match item {
                ChartItem::Step(step) => {
                    let (text, bodies) = self.step(step, &writer);
                    parts.step(step, &text);
                    bodies.into_iter().for_each(|b| parts.other(b));
                }
                ChartItem::Transition(t) => parts.other(transition(t, &writer)),
                ChartItem::Action(a) => parts.other(named(a, &writer)),
                ChartItem::Var(_) | ChartItem::Section(_) | ChartItem::Pre(..) | ChartItem::Post(..) => {}
            }
        }
        parts.finish()
    }

    /// Warns if actions change their order because the initial step is written first.
    fn order(&mut self, chart: &Chart) {
        let acts = |s: &Step| s.actions.iter().any(|a| !matches!(a.kind, ActionKind::Comment(_)));
        let mut before = chart.steps().take_while(|s| !s.initial);
        let Some(initial) = chart.steps().find(|s| s.initial).filter(|s| acts(s)) else { return };
        if before.any(acts) {
            let what = say!(
                "the initial step `{}` stands before the other steps there, as compilers want it; in a scan that runs actions of it and of a step before it, they run in the other order",
                initial.name.text
            );
            self.problems.push(Problem::new(&codes::DIFFERENT, initial.name.at.0, what));
        }
    }

    /// A step, and the actions that have no name of their own.
    fn step(&mut self, step: &Step, writer: &Writer) -> (String, Vec<String>) {
        let name = &step.name.text;
        let mut out = String::new();
        if let Some(comment) = &step.comment {
            out.push_str(&format!("  (* {} *)\n", clean(comment)));
        }
        let word = if step.initial { "INITIAL_STEP" } else { "STEP" };
        let mut lines = String::new();
        let mut bodies = Vec::new();
        for (number, action) in step.actions.iter().enumerate() {
            self.action(name, number, action, writer, &mut lines, &mut bodies);
        }
        out.push_str(&format!("  {word} {name}:\n{lines}  END_STEP\n"));
        (out, bodies)
    }

    fn action(
        &mut self,
        step: &str,
        number: usize,
        action: &Action,
        writer: &Writer,
        lines: &mut String,
        bodies: &mut Vec<String>,
    ) {
        match &action.kind {
            ActionKind::Qualified { qualifier, time, target, .. } => {
                let time = time.as_ref().map(|t| writer.plain(t));
                let name = match target {
                    Target::Path(path) => path.text(),
                    Target::Direct(name, _) => format!("%{name}"),
                    Target::Element(element) => writer.plain(element),
                    Target::Work(work) => self.anonymous(step, number, work, writer, bodies),
                };
                lines.push_str(&association(&name, *qualifier, time.as_deref()));
            }
            ActionKind::Comment(text) => lines.push_str(&format!("    (* {} *)\n", clean(text))),
            ActionKind::EachScan { .. } | ActionKind::OnEvent { .. } | ActionKind::Order(_) => {}
        }
    }

    /// An action without a name gets the name of its step.
    fn anonymous(
        &mut self,
        step: &str,
        number: usize,
        work: &Work,
        writer: &Writer,
        bodies: &mut Vec<String>,
    ) -> String {
        let name = self.taken.give(&format!("{step}_{}", number + 1));
        bodies.push(block(&name, work.statements(), writer));
        name
    }
}

fn named(action: &NamedAction, writer: &Writer) -> String {
    let comment = action.comment.as_ref().map_or(String::new(), |c| format!("  (* {} *)\n", clean(c)));
    comment + &block(&action.name.text, &action.body.block().statements, writer)
}

/// `ACTION name: … END_ACTION`.
fn block(name: &str, list: &[Stmt], writer: &Writer) -> String {
    let mut out = format!("  ACTION {name}:\n");
    if list.is_empty() {
        // matiec fails behind an action that is only `;`. Our reader takes this statement for an empty action.
        out.push_str("    IF FALSE THEN RETURN; END_IF;\n");
    }
    writer.statements(list, 2, &mut out);
    out.push_str("  END_ACTION\n");
    out
}

fn transition(t: &Transition, writer: &Writer) -> String {
    let mut out = String::new();
    if let Some(comment) = &t.comment {
        out.push_str(&format!("  (* {} *)\n", clean(comment)));
    }
    let label = t.label.as_ref().map_or(String::new(), |l| format!(" {}", l.text));
    let priority = t.priority.map_or(String::new(), |p| format!(" (PRIORITY := {p})"));
    let steps = |list: &[g7_model::Name]| -> String {
        let names: Vec<&str> = list.iter().map(|n| &*n.text).collect();
        match names.as_slice() {
            [one] => (*one).to_string(),
            _ => format!("({})", names.join(", ")),
        }
    };
    let (from, to) = (steps(&t.from), steps(&t.to));
    let condition = writer.condition(&t.receptivity);
    out.push_str(&format!(
        "  TRANSITION{label}{priority} FROM {from} TO {to}\n    := {condition};\n  END_TRANSITION\n"
    ));
    out
}

/// The parts of a chart in an order that compilers of one pass take: a chart begins with an initial
/// step, and no part reads `Fill.X` or `Fill.T` before the step `Fill`. Otherwise the order of the
/// author is kept, because it is that of the document when the text is read again.
#[derive(Default)]
struct Parts {
    out: String,
    /// True behind the first initial step.
    begun: bool,
    /// The steps that are written, in upper case.
    written: HashSet<String>,
    /// Steps before the first initial one.
    early: String,
    /// Parts that wait for a step.
    waiting: Vec<String>,
}

impl Parts {
    fn step(&mut self, step: &Step, text: &str) {
        if step.initial && !self.begun {
            self.begun = true;
            let early = std::mem::take(&mut self.early);
            self.out.push_str(text);
            self.out.push_str(&early);
        } else if self.begun {
            self.out.push_str(text);
        } else {
            self.early.push_str(text);
        }
        self.written.insert(step.name.text.to_uppercase());
        if self.begun {
            for part in std::mem::take(&mut self.waiting) {
                self.other(part);
            }
        }
    }

    /// A transition or an action.
    fn other(&mut self, text: String) {
        if self.begun && steps_read(&text).all(|s| self.written.contains(&s)) {
            self.out.push_str(&text);
        } else {
            self.waiting.push(text);
        }
    }

    fn finish(mut self) -> String {
        self.out.push_str(&self.early);
        self.waiting.iter().for_each(|part| self.out.push_str(part));
        self.out
    }
}

/// The steps, in upper case, of which a text reads the activity or the time.
fn steps_read(text: &str) -> impl Iterator<Item = String> {
    let words = text.split(|c: char| !c.is_ascii_alphanumeric() && c != '_' && c != '.');
    words.filter_map(|w| w.strip_suffix(".X").or_else(|| w.strip_suffix(".T"))).map(str::to_uppercase)
}

fn association(name: &str, qualifier: Qualifier, time: Option<&str>) -> String {
    let time = time.map_or(String::new(), |t| format!(", {t}"));
    format!("    {name}({}{time});\n", qualifier.name())
}
