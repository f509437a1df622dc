//! Replaces the elements that only the plant language has by plain variables.

use std::collections::{HashMap, HashSet};

use g7_model::{
    Arg, Block, Expr, ExprKind, Literal, Name, Path, Place, Problem, Said, Stmt, StmtKind, Type, VarDecl,
    VarKind, codes, say,
};

use super::build::At;
use super::parts::Table;

/// Names of the functions that only plants have, as the resolver knows them.
pub(super) const RANDOM: &str = "@random";
/// Time since the tick before, in seconds (LREAL).
pub(super) const DT: &str = "@dt";

/// Rewrites expressions and statements of one plant.
#[derive(Default)]
pub(super) struct Rewrite<'d> {
    pub(super) tables: HashMap<&'d str, Table<'d>>,
    pub(super) charts: Vec<&'d str>,
    /// The names of the outputs of the charts.
    pub(super) outputs: HashSet<&'d str>,
    pub(super) problems: Vec<Problem>,
    /// Functions that are called.
    pub(super) called: HashSet<Box<str>>,
    /// Variables of blocks, under names of their own.
    pub(super) hidden: Vec<VarDecl>,
    /// The variables of the current block, and the names that replace them.
    pub(super) locals: HashMap<Box<str>, String>,
    /// The amount of code made for parts so far, in units of [`Table::size`].
    pub(super) spent: usize,
}

/// The largest amount of code for parts: a plant is a small model.
const MOST: usize = 200_000;
/// The largest number of operators and operands in an expression that is repeated for each part.
const SMALL: usize = 64;

/// True if an expression is short and contains no random number, so that it can be repeated.
fn repeats(e: &Expr) -> bool {
    fn count(e: &Expr, left: &mut usize) -> bool {
        *left = left.saturating_sub(1);
        let fine = match &e.kind {
            ExprKind::Unary(_, a) => count(a, left),
            ExprKind::Binary(_, a, b) => count(a, left) && count(b, left),
            ExprKind::Timer { .. } => false,
            ExprKind::Call(path, args) => {
                path.names.first().is_none_or(|n| &*n.text != RANDOM)
                    && args.iter().all(|a| count(&a.value, left))
            }
            ExprKind::Element(_, index, _) => index.iter().all(|e| count(e, left)),
            ExprKind::List(values) => values.iter().all(|(_, e)| count(e, left)),
            ExprKind::Path(_) | ExprKind::Literal(_) | ExprKind::Direct(_) | ExprKind::Bad => true,
        };
        fine && *left > 0
    }
    let mut left = SMALL;
    count(e, &mut left)
}

impl Rewrite<'_> {
    fn report(&mut self, code: &'static codes::Code, at: Place, what: Said) -> Expr {
        self.problems.push(Problem::new(code, at.0, what));
        At(at).expr(ExprKind::Bad)
    }

    pub(super) fn expr(&mut self, e: &Expr) -> Expr {
        let at = At(e.at);
        let kind = match &e.kind {
            ExprKind::Path(path) => return self.path(at, path),
            ExprKind::Call(path, args) => return self.call(at, path, args),
            ExprKind::Unary(op, a) => ExprKind::Unary(*op, Box::new(self.expr(a))),
            ExprKind::Binary(op, a, b) => {
                ExprKind::Binary(*op, Box::new(self.expr(a)), Box::new(self.expr(b)))
            }
            ExprKind::Timer { t1, e, t2 } => ExprKind::Timer {
                t1: Box::new(self.expr(t1)),
                e: Box::new(self.expr(e)),
                t2: t2.as_ref().map(|t| Box::new(self.expr(t))),
            },
            ExprKind::Element(_, _, None) => return self.element(at, e),
            ExprKind::Element(..) => {
                return self.report(&codes::WRONG_KIND, e.at, say!("a plant reads no bits of elements"));
            }
            ExprKind::Literal(_) | ExprKind::Direct(_) | ExprKind::List(_) | ExprKind::Bad => e.kind.clone(),
        };
        at.expr(kind)
    }

    /// An element of an array of outputs, which the document of the plant has as a variable of this name.
    fn element(&mut self, at: At, e: &Expr) -> Expr {
        match self.charts_variable(e) {
            Some(name) => at.var(&name),
            None => at.expr(ExprKind::Bad),
        }
    }

    /// The name of a variable of the charts; reports a problem if an index in it is not written as a number.
    pub(super) fn charts_variable(&mut self, e: &Expr) -> Option<String> {
        let name = e.kind.variable();
        if name.is_none() {
            self.report(&codes::NOT_CONSTANT, e.at, say!("a plant names elements by written indexes"));
        }
        name
    }

    fn path(&mut self, at: At, path: &Path) -> Expr {
        let names: Vec<&str> = path.names.iter().map(|n| &*n.text).collect();
        match names[..] {
            [local] if self.locals.contains_key(local) => {
                let name = self.locals.get(local).map(String::as_str).unwrap_or_default();
                at.var(name)
            }
            [table, ..] if self.tables.contains_key(table) => self.member(at, table, &names[1..]),
            // An output of a chart has one name in the document of the plant.
            [chart, name] if self.charts.contains(&chart) => at.var(&format!("{chart}.{name}")),
            [_, _, ..] if self.outputs.contains(&*path.text()) => at.var(&path.text()),
            _ => at.expr(ExprKind::Path(path.clone())),
        }
    }

    /// `T.count`, `T.first.colour`, …
    fn member(&mut self, at: At, table: &str, rest: &[&str]) -> Expr {
        if rest.first() == Some(&"last") && !self.afford(at, table) {
            return at.expr(ExprKind::Bad);
        }
        let Some(t) = self.tables.get(table) else { return at.expr(ExprKind::Bad) };
        match rest {
            ["count"] => at.var(&t.count()),
            ["lost"] => at.var(&t.lost()),
            ["empty"] => at.binary(g7_model::BinaryOp::Eq, at.var(&t.count()), at.int(0)),
            ["full"] => {
                at.binary(g7_model::BinaryOp::Ge, at.var(&t.count()), at.int(i128::from(t.parts.max)))
            }
            ["first", column] if t.has(column) => t.first(at, column),
            ["last", column] if t.has(column) => t.last(at, column),
            _ => {
                let known: Vec<&str> = t.attributes().map(|(n, _)| n).collect();
                let what = say!("parts `{table}` have no `{}`", rest.join("."));
                self.problems.push(Problem::new(&codes::UNKNOWN_PART_MEMBER, at.0.0, what).help(say!(
                    "there are count, empty, full, lost, first.… and last.… with {}",
                    Said::foreign(if known.is_empty() { "position".to_owned() } else { known.join(", ") })
                )));
                at.expr(ExprKind::Bad)
            }
        }
    }

    /// The two arguments of a range: where it begins and ends.
    fn range(&mut self, args: &[Arg]) -> Option<(Expr, Expr)> {
        match args {
            [a, b] => Some((self.bound(&a.value), self.bound(&b.value))),
            _ => None,
        }
    }

    /// A bound of a range; it is repeated for each part.
    fn bound(&mut self, e: &Expr) -> Expr {
        let bound = self.expr(e);
        if repeats(&bound) {
            return bound;
        }
        let what = say!("this is too much, or too uncertain, for the end of a range");
        self.problems.push(
            Problem::new(&codes::BAD_PARTS, e.at.0, what)
                .help(say!("compute it in an `each` block and keep it in a state")),
        );
        At(e.at).expr(ExprKind::Bad)
    }

    /// Counts the code of one more operation on a table; false, and reported once, if it becomes too
    /// much.
    fn afford(&mut self, at: At, table: &str) -> bool {
        let size = self.tables.get(table).map_or(0, Table::size);
        let before = self.spent <= MOST;
        self.spent = self.spent.saturating_add(size);
        if before && self.spent > MOST {
            let what = say!("the plant does more with its parts than can be run");
            self.problems.push(
                Problem::new(&codes::BAD_PARTS, at.0.0, what)
                    .help(say!("give the parts fewer places, or look at them less often")),
            );
        }
        self.spent <= MOST
    }

    fn call(&mut self, at: At, path: &Path, args: &[Arg]) -> Expr {
        let names: Vec<&str> = path.names.iter().map(|n| &*n.text).collect();
        if let [table, what] = names[..]
            && self.tables.contains_key(table)
        {
            let range = self.range(args);
            if !self.afford(at, table) {
                return at.expr(ExprKind::Bad);
            }
            let Some(t) = self.tables.get(table) else { return at.expr(ExprKind::Bad) };
            return match range {
                Some(range) if t.is_track() && what == "at" => t.any(at, &range),
                Some(range) if t.is_track() && t.has(what) => t.seen(at, what, &range),
                _ => {
                    let what = say!("`{table}.{what}(…)` is nothing that parts can tell");
                    self.report(&codes::UNKNOWN_PART_MEMBER, at.0, what)
                }
            };
        }
        let args: Vec<Arg> = args.iter().map(|a| Arg { value: self.expr(&a.value), ..a.clone() }).collect();
        if let ["random"] = names[..] {
            return self.random(at, args);
        }
        self.called.extend(names.first().map(|n| Box::from(*n)));
        at.expr(ExprKind::Call(path.clone(), args))
    }

    /// `random()` in 0..1, `random(a, b)` in a..b.
    fn random(&mut self, at: At, args: Vec<Arg>) -> Expr {
        let dice = at.call(RANDOM, Vec::new());
        let mut values = args.into_iter().map(|a| a.value);
        match (values.next(), values.next(), values.next()) {
            (None, ..) => dice,
            (Some(a), Some(b), None) => {
                use g7_model::BinaryOp::{Add, Mul, Sub};
                if !repeats(&a) {
                    let what = say!("this is too much, or too uncertain, for a bound of chance");
                    return self.report(&codes::BAD_PARTS, a.at, what);
                }
                let width = at.binary(Sub, b, a.clone());
                at.binary(Add, a, at.binary(Mul, width, dice))
            }
            _ => self.report(
                &codes::BAD_PARTS,
                at.0,
                say!("`random` takes no argument, or the least and the largest value"),
            ),
        }
    }

    pub(super) fn block(&mut self, block: &Block) -> Vec<Stmt> {
        let mut out = self.declare(block);
        out.extend(self.statements(&block.statements));
        self.locals.clear();
        out
    }

    /// Gives the variables of a block unique names; returns the statements that set them to their
    /// initial values.
    fn declare(&mut self, block: &Block) -> Vec<Stmt> {
        let mut out = Vec::new();
        for local in &block.locals {
            let init = local.init.as_ref().map(|e| self.expr(e));
            for name in &local.names {
                let at = At(name.at);
                let hidden = format!("@{}.{}", name.text, self.hidden.len());
                let mut decl = at.declare(VarKind::Var, &hidden, local.ty.base, None);
                decl.limits.clone_from(&local.ty.limits);
                decl.at = local.at;
                self.hidden.push(decl);
                let first = match local.ty.base {
                    Type::Fb(_) => None,
                    Type::String(_) => Some(at.expr(ExprKind::Literal(Literal::Str("".into())))),
                    ty => Some(at.zero(ty)),
                };
                out.extend(init.clone().or(first).map(|value| at.assign(&hidden, value)));
                if self.locals.insert(name.text.clone(), hidden).is_some() {
                    let what = say!("`{}` is defined twice", name.text);
                    self.problems.push(Problem::new(&codes::DEFINED_TWICE, name.at.0, what));
                }
            }
        }
        out
    }

    /// The name that replaces a variable in this block.
    fn variable(&self, name: &Name) -> Name {
        let text = self.locals.get(&name.text).map_or_else(|| name.text.clone(), |n| n.as_str().into());
        Name { text, at: name.at }
    }

    pub(super) fn statements(&mut self, list: &[Stmt]) -> Vec<Stmt> {
        let mut out = Vec::with_capacity(list.len());
        for s in list {
            self.statement(s, &mut out);
        }
        out
    }

    fn statement(&mut self, s: &Stmt, out: &mut Vec<Stmt>) {
        let kind = match &s.kind {
            StmtKind::Call(path, args) => {
                if let Some(mut done) = self.action(At(s.at), path, args) {
                    out.append(&mut done);
                    return;
                }
                self.called.extend(path.names.first().map(|n| n.text.clone()));
                let args = args.iter().map(|a| Arg { value: self.expr(&a.value), ..a.clone() }).collect();
                StmtKind::Call(path.clone(), args)
            }
            StmtKind::Assign { target, value } => {
                StmtKind::Assign { target: self.expr(target), value: self.expr(value) }
            }
            StmtKind::If(arms, rest) => StmtKind::If(
                arms.iter().map(|(c, body)| (self.expr(c), self.statements(body))).collect(),
                self.statements(rest),
            ),
            StmtKind::Case(selector, arms, rest) => StmtKind::Case(
                self.expr(selector),
                arms.iter()
                    .map(|arm| g7_model::CaseArm {
                        labels: arm.labels.clone(),
                        body: self.statements(&arm.body),
                    })
                    .collect(),
                self.statements(rest),
            ),
            StmtKind::For { var, from, to, by, body } => StmtKind::For {
                var: self.variable(var),
                from: self.expr(from),
                to: self.expr(to),
                by: by.as_ref().map(|e| self.expr(e)),
                body: self.statements(body),
            },
            StmtKind::While(c, body) => StmtKind::While(self.expr(c), self.statements(body)),
            StmtKind::Repeat(body, c) => StmtKind::Repeat(self.statements(body), self.expr(c)),
            StmtKind::Exit | StmtKind::Return => s.kind.clone(),
        };
        out.push(Stmt { kind, at: s.at });
    }

    /// `T.enter(…)`, `T.leave()`, `T.leave_last()`, `T.take(…)`, `T.clear()`;
    /// `None` for other calls.
    fn action(&mut self, at: At, path: &Path, args: &[Arg]) -> Option<Vec<Stmt>> {
        let names: Vec<&str> = path.names.iter().map(|n| &*n.text).collect();
        let [table, what] = names[..] else { return None };
        let wanted = self.tables.get(table)?.attributes().count();
        let range = if what == "take" { self.range(args) } else { None };
        let values: Vec<Expr> =
            if range.is_some() { Vec::new() } else { args.iter().map(|a| self.expr(&a.value)).collect() };
        if !self.afford(at, table) {
            return Some(Vec::new());
        }
        let count = args.len();
        let t = self.tables.get(table)?;
        let done = match (what, range) {
            ("enter", _) if values.len() == wanted => Some(t.enter(at, values)),
            ("leave", _) if count == 0 => Some(t.leave(at)),
            ("leave_last", _) if count == 0 => Some(t.leave_last(at)),
            ("clear", _) if count == 0 => Some(t.clear(at)),
            ("take", Some(range)) if t.is_track() => Some(t.take(at, &range)),
            _ => None,
        };
        if done.is_none() {
            let what = say!("`{table}.{what}` with {count} argument(s) is nothing that parts can do");
            self.problems.push(Problem::new(&codes::UNKNOWN_PART_MEMBER, at.0.0, what).help(say!(
                "`{table}.enter` takes {wanted} value(s); `leave`, `leave_last` and `clear` take none; \
                 `take` a range of a track"
            )));
        }
        Some(done.unwrap_or_default())
    }
}
