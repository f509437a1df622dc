//! Writes a chart as steps, transitions and actions.

use g7_model::{
    Action, ActionKind, Chart, ChartItem, NamedAction, Qualifier, Step, Stmt, Target, Transition, Work,
};

use super::{Exporter, clean};
use crate::st::{Known, Writer};

impl<'d> Exporter<'d> {
    /// The body of a chart's program.
    pub(super) fn chart(&mut self, chart: &'d Chart) -> String {
        let types = Known::new(self.document, Some(chart));
        let writer = Writer { types: &types };
        let mut out = String::new();
        if let Some(comment) = &chart.comment {
            out.push_str(&format!("  (* {} *)\n", clean(comment)));
        }
        // A chart begins with its first step.
        let mut early = String::new();
        let mut begun = false;
        for item in &chart.items {
            match item {
                ChartItem::Step(step) => {
                    self.step(step, &writer, &mut out);
                    begun = true;
                    out.push_str(&std::mem::take(&mut early));
                }
                ChartItem::Transition(t) => transition(t, &writer, &mut out),
                ChartItem::Action(a) => named(a, &writer, if begun { &mut out } else { &mut early }),
                ChartItem::Var(_) | ChartItem::Section(_) | ChartItem::Pre(..) | ChartItem::Post(..) => {}
            }
        }
        out + &early
    }

    fn step(&mut self, step: &Step, writer: &Writer, out: &mut String) {
        let name = &step.name.text;
        if let Some(comment) = &step.comment {
            out.push_str(&format!("  (* {} *)\n", clean(comment)));
        }
        let word = if step.initial { "INITIAL_STEP" } else { "STEP" };
        let mut lines = String::new();
        let mut bodies = String::new();
        for (number, action) in step.actions.iter().enumerate() {
            self.action(name, number, action, writer, &mut lines, &mut bodies);
        }
        out.push_str(&format!("  {word} {name}:\n{lines}  END_STEP\n{bodies}"));
    }

    fn action(
        &mut self,
        step: &str,
        number: usize,
        action: &Action,
        writer: &Writer,
        lines: &mut String,
        bodies: &mut String,
    ) {
        match &action.kind {
            ActionKind::Qualified { qualifier, time, target, .. } => {
                let time = time.as_ref().map(|t| writer.plain(t));
                let name = match target {
                    Target::Path(path) => path.text(),
                    Target::Direct(name, _) => format!("%{name}"),
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
        bodies: &mut String,
    ) -> String {
        let name = self.taken.give(&format!("{step}_{}", number + 1));
        block(&name, work.statements(), writer, bodies);
        name
    }
}

fn named(action: &NamedAction, writer: &Writer, out: &mut String) {
    if let Some(comment) = &action.comment {
        out.push_str(&format!("  (* {} *)\n", clean(comment)));
    }
    block(&action.name.text, &action.body.block().statements, writer, out);
}

/// `ACTION name: … END_ACTION`.
fn block(name: &str, list: &[Stmt], writer: &Writer, out: &mut String) {
    out.push_str(&format!("  ACTION {name}:\n"));
    if list.is_empty() {
        out.push_str("    ;\n");
    }
    writer.statements(list, 2, out);
    out.push_str("  END_ACTION\n");
}

fn transition(t: &Transition, writer: &Writer, out: &mut String) {
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
}

fn association(name: &str, qualifier: Qualifier, time: Option<&str>) -> String {
    let time = time.map_or(String::new(), |t| format!(", {t}"));
    format!("    {name}({}{time});\n", qualifier.name())
}
