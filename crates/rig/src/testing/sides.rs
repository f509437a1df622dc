//! Decides which side a condition of a test asks: the charts or the plant. Each is a program of its
//! own, so an expression can be evaluated on one of them only.

use g7_compile::ir::VarClass;
use g7_compile::symbols::Symbols;
use g7_model::{BinaryOp, Expr, ExprKind, Path, Problem, codes, say};

use crate::{Activity, Ask, Bench, Role};

/// The first name in an expression that only the charts know, and the first that only the plant
/// knows. Names that both know (constants, outputs of the charts) do not count.
#[derive(Debug, Default)]
struct Needs {
    plant: Option<String>,
    charts: Option<String>,
}

impl Needs {
    fn of(bench: &Bench, e: &Expr) -> Needs {
        let mut needs = Needs::default();
        needs.look(bench, e);
        needs
    }

    /// The problem of an expression that neither side can evaluate alone.
    fn problem(&self, e: &Expr) -> Option<Problem> {
        let (plant, charts) = (self.plant.as_ref()?, self.charts.as_ref()?);
        let what =
            say!("`{plant}` is the plant's and `{charts}` the charts': one expression cannot ask both");
        let help = say!(
            "conditions on either can be joined by `and` or a comma; the plant knows the charts' outputs as well"
        );
        Some(Problem::new(&codes::TEST_NAME, e.at.0, what).help(help))
    }

    fn look(&mut self, bench: &Bench, e: &Expr) {
        match &e.kind {
            ExprKind::Path(path) => self.name(bench, path),
            ExprKind::Direct(name) => self.charts = self.charts.take().or(Some(format!("%{name}"))),
            ExprKind::Unary(_, a) => self.look(bench, a),
            ExprKind::Binary(_, a, b) => {
                self.look(bench, a);
                self.look(bench, b);
            }
            ExprKind::Timer { t1, e, t2 } => {
                self.look(bench, t1);
                self.look(bench, e);
                t2.iter().for_each(|t| self.look(bench, t));
            }
            ExprKind::Call(path, args) => {
                if of_parts(bench, path) {
                    self.plant = self.plant.take().or(Some(path.text()));
                }
                args.iter().for_each(|a| self.look(bench, &a.value));
            }
            ExprKind::Element(path, index, _) => {
                // The plant knows the outputs as well.
                if of_array(&bench.compiled.symbols, path).is_some_and(|c| c != VarClass::Output) {
                    self.charts = self.charts.take().or(Some(path.text()));
                }
                index.iter().for_each(|e| self.look(bench, e));
            }
            ExprKind::List(values) => values.iter().for_each(|(_, e)| self.look(bench, e)),
            ExprKind::Literal(_) | ExprKind::Bad => {}
        }
    }

    fn name(&mut self, bench: &Bench, path: &Path) {
        let name = path.text();
        let charts = || class(&bench.compiled.symbols, &name);
        let plant = || bench.plant.as_ref().and_then(|p| class(&p.compiled.symbols, &name));
        let own = bench.items.iter().any(|i| i.role == Role::Plant && i.name == name)
            || of_parts(bench, path)
            || charts().is_none() && plant() == Some(VarClass::Const);
        if own {
            self.plant = self.plant.take().or(Some(name));
        } else if is_step(bench, path)
            || charts().is_some_and(|c| !matches!(c, VarClass::Const | VarClass::Output))
        {
            self.charts = self.charts.take().or(Some(name));
        }
    }
}

/// The parts of a condition: if it asks the plant, each operand of `and` is asked of its own side.
pub(super) fn parts<'e>(bench: &Bench, e: &'e Expr) -> Vec<&'e Expr> {
    if Needs::of(bench, e).plant.is_some() { conjuncts(e) } else { vec![e] }
}

/// An expression for the side that knows all of its names; the charts if both do.
pub(super) fn ask(bench: &Bench, e: &Expr) -> Result<Ask, Problem> {
    let needs = Needs::of(bench, e);
    match needs.problem(e) {
        Some(problem) => Err(problem),
        None => Ok(Ask { expr: e.clone(), of_plant: needs.plant.is_some() }),
    }
}

/// The operands of the outermost `and`, regardless of brackets.
fn conjuncts(e: &Expr) -> Vec<&Expr> {
    match &e.kind {
        ExprKind::Binary(BinaryOp::And | BinaryOp::Dot, a, b) => [conjuncts(a), conjuncts(b)].concat(),
        _ => vec![e],
    }
}

/// The role of the elements of an array.
fn of_array(symbols: &Symbols, path: &Path) -> Option<VarClass> {
    let first = format!("{}[", path.text());
    symbols.variables.iter().find(|v| v.name.starts_with(&first)).map(|v| v.class)
}

fn class(symbols: &Symbols, name: &str) -> Option<VarClass> {
    symbols.variable(name).map(|v| v.class)
}

/// True if a path asks about the parts of a queue or track: `T.empty`, `T.first.colour`, `T.at(a,
/// b)`.
fn of_parts(bench: &Bench, path: &Path) -> bool {
    let Some(first) = path.names.first().filter(|_| path.names.len() > 1) else { return false };
    let count = format!("{}.count", first.text);
    bench.items.iter().any(|i| i.role == Role::Plant && i.name == count)
}

/// True if a path asks about a step: `X12`, `G.X12`, `Fill.t`.
fn is_step(bench: &Bench, path: &Path) -> bool {
    let names: Vec<&str> = path.names.iter().map(|n| &*n.text).collect();
    let step = match names.as_slice() {
        [.., step, "X" | "x" | "t" | "T" | "s"] => step,
        [.., last] => last,
        [] => return false,
    };
    bench.steps.iter().any(|s| {
        let last = s.name.rsplit('.').next().unwrap_or_default();
        let stem = step.strip_prefix('X').unwrap_or(step);
        let number = if matches!(s.id, Activity::Macro(_)) { stem.strip_prefix('M') } else { None };
        *step == last || stem == last || number == Some(last)
    })
}
