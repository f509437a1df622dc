//! Expressions and statements in the words of the file.
//!
//! Each is rewritten in the names of the file first; the printer of Structured Text then prints it.

use std::collections::BTreeSet;

use g7_iec::nodes;
use g7_iec::scopes::{Ref, Scopes, VarKey};
use g7_iec::st::{Known, Writer as Printer};
use g7_model::{
    Arg, CaseArm, Expr, ExprKind, Literal, Nanos, Path, Place, Problem, Said, Span, StandardFunction, Stmt,
    StmtKind, Type, UnaryOp, VarKind, codes, say,
};

use super::names::Names;
use crate::controlexpert::dialect;

/// The longest TIME: 32 bits of milliseconds.
const LONGEST_TIME: i64 = u32::MAX as i64;
/// The deepest nesting of sections within sections.
const DEEPEST: usize = 20;

/// The names and types of a document, with which its texts are written.
pub(super) struct Speech<'d> {
    pub(super) scopes: Scopes<'d>,
    pub(super) names: Names<'d>,
    pub(super) problems: Vec<Problem>,
    /// Variables of which an edge is asked.
    pub(super) edges: BTreeSet<VarKey<'d>>,
    /// The types of the variables, by their names in the file.
    types: Known<'d>,
    /// Inside a transition section: the name of its result in the document, and in the file.
    pub(super) output: Option<(Box<str>, String)>,
}

/// A chart, or None for the file: where the names of a text are looked up.
type Home = Option<usize>;

impl<'d> Speech<'d> {
    pub(super) fn new(scopes: Scopes<'d>, names: Names<'d>, types: Known<'d>) -> Speech<'d> {
        Speech { scopes, names, problems: Vec::new(), edges: BTreeSet::new(), types, output: None }
    }

    pub(super) fn say(&mut self, code: &'static codes::Code, at: Place, what: Said) {
        self.problems.push(Problem::new(code, at.0, what));
    }

    /// Refuses something that Control Expert cannot express.
    pub(super) fn cannot(&mut self, at: Place, what: Said) {
        self.say(&codes::NOT_CARRIED, at, say!("{what}: Control Expert has none"));
    }

    /// Warns of something that is left out, without which the chart means the same.
    pub(super) fn leave_out(&mut self, at: Place, what: Said) {
        self.say(&codes::LEFT_OUT, at, say!("{what}: Control Expert has none; it is left out"));
    }

    /// A condition, printed.
    pub(super) fn condition(&mut self, e: &Expr, home: Home) -> String {
        let own = self.expr(e, home);
        let text = Printer { types: &self.types }.condition(&own);
        self.printed(text, e.at)
    }

    /// A constant of a type, printed.
    pub(super) fn value(&mut self, e: &Expr, ty: Type) -> String {
        let own = self.expr(e, None);
        let text = Printer { types: &self.types }.value(&own, ty);
        self.printed(text, e.at)
    }

    /// Statements, printed.
    pub(super) fn body(&mut self, list: &[Stmt], home: Home, at: Place) -> String {
        let own = self.stmts(list, home);
        self.print(&own, at)
    }

    /// Statements that are rewritten already.
    pub(super) fn print(&mut self, list: &[Stmt], at: Place) -> String {
        let text = Printer { types: &self.types }.body(list);
        self.printed(text, at)
    }

    /// Refuses a text with a type that Control Expert does not have; conversions of the printer may name one.
    fn printed(&mut self, text: String, at: Place) -> String {
        let words = text.split(|c: char| !c.is_ascii_alphanumeric() && c != '_' && c != '#');
        let types = words.flat_map(|w| w.split_once('#').map_or(w, |(ty, _)| ty).split("_TO_"));
        let other = types.filter_map(Type::named).find(|ty| dialect::type_name(*ty).is_none());
        if let Some(ty) = other {
            self.cannot(at, say!("a value of the type {ty}"));
        }
        text
    }

    pub(super) fn expr(&mut self, e: &Expr, home: Home) -> Expr {
        self.within(e, home, 0)
    }

    fn within(&mut self, e: &Expr, home: Home, depth: usize) -> Expr {
        let at = e.at.0;
        match &e.kind {
            ExprKind::Literal(Literal::Time(time)) => {
                self.time(*time, e.at);
                e.clone()
            }
            ExprKind::Literal(_) => e.clone(),
            ExprKind::Element(..) | ExprKind::List(_) => {
                self.cannot(e.at, say!("an element of an array"));
                e.clone()
            }
            ExprKind::Path(path) => self.path(path, home, at, depth),
            ExprKind::Direct(text) => self.direct(text, at),
            ExprKind::Unary(op @ (UnaryOp::Rise | UnaryOp::Fall), inner) => self.edge(*op, inner, home, at),
            ExprKind::Unary(op, inner) => {
                if matches!(inner.kind, ExprKind::Literal(Literal::Time(_))) {
                    self.cannot(e.at, say!("a negative TIME"));
                }
                nodes::unary(*op, self.within(inner, home, depth), at)
            }
            ExprKind::Binary(op, a, b) => {
                let (a, b) = (self.within(a, home, depth), self.within(b, home, depth));
                nodes::binary(*op, a, b, at)
            }
            ExprKind::Timer { t1, e: watched, t2 } => {
                if let Some(time) = self.time_of_step(t1, watched, t2.as_deref(), home) {
                    return time;
                }
                self.cannot(e.at, say!("a delay of something other than the activity of a step"));
                nodes::boolean(false, at)
            }
            ExprKind::Call(path, args) => self.call(path, args, home, e.at, depth),
            ExprKind::Bad => nodes::boolean(false, at),
        }
    }

    fn time(&mut self, time: Nanos, at: Place) {
        match time.whole(Nanos::MILLISECOND) {
            Some(0..=LONGEST_TIME) => {}
            Some(..0) => self.cannot(at, say!("a negative TIME")),
            _ => self.cannot(at, say!("a TIME of parts of a millisecond, or above 49 days")),
        }
    }

    /// `2s/X1` is the activity of the step for that time.
    fn time_of_step(&mut self, t1: &Expr, watched: &Expr, t2: Option<&Expr>, home: Home) -> Option<Expr> {
        let ExprKind::Path(path) = &watched.kind else { return None };
        let Some(Ref::Active(step)) = self.scopes.refer(home, &path.names).filter(|_| t2.is_none()) else {
            return None;
        };
        let at = watched.at.0;
        let name = self.names.step(step).to_string();
        let time = self.expr(t1, home);
        let long = nodes::binary(g7_model::BinaryOp::Ge, nodes::name(&[&name, dialect::TIME], at), time, at);
        Some(nodes::and(nodes::name(&[&name, dialect::ACTIVE], at), long, at))
    }

    fn path(&mut self, path: &Path, home: Home, at: Span, depth: usize) -> Expr {
        if let ([only], Some((own, there))) = (path.names.as_slice(), &self.output)
            && only.text == *own
        {
            return nodes::name(&[there], at);
        }
        match self.scopes.refer(home, &path.names) {
            Some(Ref::Var(key)) => nodes::name(&[self.names.var(key)], at),
            Some(Ref::Member(key, member)) => nodes::name(&[self.names.var(key), member], at),
            Some(Ref::Bit(key, bit)) => nodes::name(&[self.names.var(key), &bit.to_string()], at),
            Some(Ref::Active(step)) => nodes::name(&[self.names.step(step), dialect::ACTIVE], at),
            Some(Ref::Time(step)) => nodes::name(&[self.names.step(step), dialect::TIME], at),
            Some(Ref::Section(own, section)) if depth < DEEPEST => match section.body.statements.as_slice() {
                [Stmt { kind: StmtKind::Assign { value, .. }, .. }] if section.short => {
                    self.within(value, own.or(home), depth + 1)
                }
                _ => {
                    self.cannot(at.into(), say!("a transition section within a condition"));
                    nodes::boolean(false, at)
                }
            },
            Some(Ref::Section(..) | Ref::Action(..) | Ref::Seconds(_) | Ref::Inner(..)) | None => {
                self.cannot(at.into(), say!("the use of `{}` as a value", path.text()));
                nodes::boolean(false, at)
            }
        }
    }

    /// A direct name: a declared variable there, a step, or an address of Control Expert.
    fn direct(&mut self, text: &str, at: Span) -> Expr {
        if let Some(key) = self.scopes.at(text) {
            return nodes::name(&[self.names.var(key)], at);
        }
        if let Some(Ref::Bit(key, bit)) = self.scopes.bit_at(text) {
            return nodes::name(&[self.names.var(key), &bit.to_string()], at);
        }
        if let Some(step) = self.scopes.direct_step(text) {
            return nodes::name(&[self.names.step(step), dialect::ACTIVE], at);
        }
        if !dialect::is_address(&format!("%{text}")) {
            self.cannot(at.into(), say!("the address `%{text}`"));
        }
        nodes::expr(ExprKind::Direct(text.into()), at)
    }

    /// `RE(x)` and `FE(x)` are functions of an EBOOL.
    fn edge(&mut self, op: UnaryOp, inner: &Expr, home: Home, at: Span) -> Expr {
        let named = match &inner.kind {
            ExprKind::Path(path) => match self.scopes.refer(home, &path.names) {
                Some(Ref::Var(key)) => Some(key),
                _ => None,
            },
            ExprKind::Direct(text) => self.scopes.at(text),
            _ => None,
        };
        let Some(key) = named else {
            self.cannot(at.into(), say!("an edge of something other than a variable"));
            return nodes::boolean(false, at);
        };
        self.edges.insert(key);
        if self.scopes.decl(key).is_some_and(|d| d.kind != VarKind::Input) {
            let what = say!(
                "an edge of `{}`, which is no input: it lasts there until the variable is written again",
                key.1
            );
            self.say(&codes::DIFFERENT, at.into(), what);
        }
        nodes::call(dialect::edge_word(op), vec![nodes::name(&[self.names.var(key)], at)], at)
    }

    fn call(&mut self, path: &Path, args: &[Arg], home: Home, at: Place, depth: usize) -> Expr {
        let upper = path.text().to_ascii_uppercase();
        if !dialect::has_function(StandardFunction::named(&upper), &upper) {
            self.cannot(at, say!("the function `{}`", path.text()));
        }
        let args =
            args.iter().map(|a| Arg { value: self.within(&a.value, home, depth), ..a.clone() }).collect();
        nodes::expr(ExprKind::Call(path.clone(), args), at.0)
    }

    pub(super) fn stmts(&mut self, list: &[Stmt], home: Home) -> Vec<Stmt> {
        list.iter().map(|s| Stmt { kind: self.stmt(s, home), at: s.at }).collect()
    }

    fn stmt(&mut self, s: &Stmt, home: Home) -> StmtKind {
        match &s.kind {
            StmtKind::Assign { target, value } => {
                StmtKind::Assign { target: self.expr(target, home), value: self.expr(value, home) }
            }
            StmtKind::Call(path, args) => self.block_call(path, args, home, s.at),
            StmtKind::If(arms, otherwise) => {
                let arms = arms.iter().map(|(c, body)| (self.expr(c, home), self.stmts(body, home)));
                let arms = arms.collect();
                StmtKind::If(arms, self.stmts(otherwise, home))
            }
            StmtKind::Case(selector, arms, otherwise) => {
                let selector = self.expr(selector, home);
                let arms = arms.iter().map(|arm| self.arm(arm, home)).collect();
                StmtKind::Case(selector, arms, self.stmts(otherwise, home))
            }
            StmtKind::For { var, from, to, by, body } => {
                let mut own = var.clone();
                match self.scopes.refer(home, std::slice::from_ref(var)) {
                    Some(Ref::Var(key)) => own.text = self.names.var(key).into(),
                    _ => self.cannot(var.at, say!("the use of `{}` as a value", var.text)),
                }
                StmtKind::For {
                    var: own,
                    from: self.expr(from, home),
                    to: self.expr(to, home),
                    by: by.as_ref().map(|e| self.expr(e, home)),
                    body: self.stmts(body, home),
                }
            }
            StmtKind::While(c, body) => StmtKind::While(self.expr(c, home), self.stmts(body, home)),
            StmtKind::Repeat(body, c) => {
                let body = self.stmts(body, home);
                StmtKind::Repeat(body, self.expr(c, home))
            }
            StmtKind::Exit => StmtKind::Exit,
            StmtKind::Return => StmtKind::Return,
        }
    }

    /// The labels of a CASE are numbers there.
    fn arm(&mut self, arm: &CaseArm, home: Home) -> CaseArm {
        let mut label = |e: &Expr| {
            let mut e = e;
            if let ExprKind::Path(path) = &e.kind
                && let Some(Ref::Var(key)) = self.scopes.refer(home, &path.names)
                && let Some(value) = self.scopes.decl(key).and_then(|d| d.init.as_ref())
            {
                e = value;
            }
            if constant(e) {
                return e.clone();
            }
            self.cannot(e.at, say!("a label of CASE that is worked out"));
            e.clone()
        };
        let labels = arm.labels.iter().map(|(a, b)| (label(a), b.as_ref().map(&mut label))).collect();
        CaseArm { labels, body: self.stmts(&arm.body, home) }
    }

    fn block_call(&mut self, path: &Path, args: &[Arg], home: Home, at: Place) -> StmtKind {
        let block = match self.scopes.refer(home, &path.names) {
            Some(Ref::Var(key)) => self.scopes.decl(key).filter(|d| matches!(d.ty, Type::Fb(_))).map(|_| key),
            _ => None,
        };
        let Some(key) = block else {
            self.cannot(at, say!("a call of `{}` in an action", path.text()));
            return StmtKind::Return;
        };
        let args = args.iter().map(|a| Arg { value: self.expr(&a.value, home), ..a.clone() }).collect();
        StmtKind::Call(nodes::path(&[self.names.var(key)], at.0), args)
    }
}

/// True for a literal, with or without a sign.
pub(super) fn constant(e: &Expr) -> bool {
    match &e.kind {
        ExprKind::Literal(_) => true,
        ExprKind::Unary(UnaryOp::Neg, inner) => matches!(inner.kind, ExprKind::Literal(_)),
        _ => false,
    }
}
