//! Rewrites words of Logix' Structured Text that the language spells differently.

use std::collections::{HashMap, HashSet};
use std::ops::Range;

use g7_model::{BinaryOp, Expr, ExprKind, Nanos, Path, Span, Stmt, StmtKind, codes, say};

use g7_iec::nodes::{self, binary, call, int, name};
use g7_iec::report::Report;
use g7_model::visit_mut::{self, Visitor};

/// The presets of steps and actions in milliseconds, by names in upper case.
#[derive(Debug, Default)]
pub(super) struct Presets {
    pub(super) steps: HashMap<String, i64>,
    pub(super) actions: HashMap<String, i64>,
}

/// `[:=]`, an assignment that is undone when the step ends, becomes `:=`.
pub(super) fn retentive(
    text: &str,
    place: &dyn Fn(Range<usize>) -> Range<usize>,
    report: &mut Report,
) -> String {
    if let Some(found) = text.find("[:=]") {
        let what =
            say!("`[:=]` takes its value back only in the last scan with automatic reset; it is `:=` here");
        report.element(&codes::DIFFERENT, "[:=]", &place(found..found + 4), what);
    }
    text.replace("[:=]", " := ")
}

/// Members of steps that do not exist here, and calls of routines.
pub(super) struct Words<'a, 'r> {
    presets: &'a Presets,
    /// The statements of the text routines of the same program, by names in upper case.
    routines: &'a HashMap<String, Vec<Stmt>>,
    report: &'r mut Report,
    /// The nesting depth of routines that are being copied.
    depth: usize,
    /// The number of statements of routines that may still be copied.
    left: usize,
    /// The routines that have been called, in upper case.
    pub(super) called: HashSet<String>,
}

/// The deepest nesting of calls of routines.
const DEEPEST: usize = 8;
/// The most statements copied for calls of routines.
const MOST: usize = 20_000;

/// Counts statements, including nested ones.
struct Count(usize);

impl Visitor for Count {
    fn stmt(&mut self, _: &mut Stmt) {
        self.0 += 1;
    }
}

impl<'a, 'r> Words<'a, 'r> {
    pub(super) fn new(
        presets: &'a Presets,
        routines: &'a HashMap<String, Vec<Stmt>>,
        report: &'r mut Report,
    ) -> Self {
        Words { presets, routines, report, depth: 0, left: MOST, called: HashSet::new() }
    }

    /// The statements of a routine, within the limits.
    fn routine(&mut self, name: &str) -> Option<Vec<Stmt>> {
        if self.depth >= DEEPEST {
            return None;
        }
        let mut body = self.routines.get(&name.to_uppercase())?.clone();
        let mut count = Count(0);
        visit_mut::stmts(&mut body, &mut count);
        self.left = self.left.checked_sub(count.0)?;
        self.called.insert(name.to_uppercase());
        self.depth += 1;
        visit_mut::stmts(&mut body, self);
        self.depth -= 1;
        Some(body)
    }
}

impl Words<'_, '_> {
    fn range(at: Span) -> Range<usize> {
        at.start as usize..at.end as usize
    }

    /// The meaning of a member of a step.
    fn member(&mut self, path: &Path, at: Span) -> Option<Expr> {
        let [step, member] = path.names.as_slice() else { return None };
        let preset = *self.presets.steps.get(&step.text.to_uppercase())?;
        let time = || name(&[&step.text, "T"], at);
        match member.text.to_ascii_uppercase().as_str() {
            "X" => None,
            "T" => Some(call("TIME_TO_DINT", vec![time()], at)),
            "DN" => Some(binary(BinaryOp::Ge, time(), nodes::time(Nanos::from_millis(preset), at), at)),
            "PRE" => Some(int(preset.into(), at)),
            other => {
                let what = say!("`{}.{other}` of a step has no counterpart", step.text);
                self.report.say(&codes::NOT_CARRIED, &Self::range(at), what);
                Some(nodes::bad(at))
            }
        }
    }
}

impl Visitor for Words<'_, '_> {
    fn expr(&mut self, e: &mut Expr) {
        let at = e.at.0;
        if let ExprKind::Path(path) = &e.kind
            && let Some(other) = self.member(&path.clone(), at)
        {
            *e = other;
        }
    }

    fn stmt(&mut self, stmt: &mut Stmt) {
        let at = stmt.at.0;
        let nothing = |at: Span| StmtKind::If(vec![(nodes::boolean(false, at), Vec::new())], Vec::new());
        match &stmt.kind {
            StmtKind::Assign { target, .. } => {
                let ExprKind::Path(path) = &target.kind else { return };
                let [step, member] = path.names.as_slice() else { return };
                if self.presets.steps.contains_key(&step.text.to_uppercase()) {
                    let what = say!("writing `{}.{}` of a step has no counterpart", step.text, member.text);
                    self.report.say(&codes::NOT_CARRIED, &Self::range(at), what);
                    stmt.kind = nothing(at);
                }
            }
            StmtKind::Call(path, args)
                if matches!(
                    &*path.text().to_ascii_uppercase(),
                    "JSR" | "SFR" | "SFP" | "EOT" | "SBR" | "RET"
                ) =>
            {
                let routine = args.first().and_then(|a| match &a.value.kind {
                    ExprKind::Path(p) => Some(p.text()),
                    _ => None,
                });
                let text = path.text();
                let plain = text.eq_ignore_ascii_case("JSR") && args.len() <= 2;
                let body = routine.clone().filter(|_| plain).and_then(|r| self.routine(&r));
                if let Some(body) = body {
                    stmt.kind = StmtKind::If(vec![(nodes::boolean(true, at), body)], Vec::new());
                    return;
                }
                let what = say!("`{text}({})` has no counterpart", routine.unwrap_or_default());
                self.report.say(&codes::NOT_CARRIED, &Self::range(at), what);
                stmt.kind = nothing(at);
            }
            _ => {}
        }
    }
}
