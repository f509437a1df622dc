//! Statements and expressions of a unit, rewritten with the names of the document. Calls of function blocks whose
//! instances are units (see [`super::units`]) are replaced by their bodies.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use g7_model::codes;
use g7_model::{Arg, CaseArm, Expr, ExprKind, Name, Path, Said, Span, Stmt, StmtKind, Type, say};

use super::read::SectionKind;
use super::tree::{self, Language, Xml, head, name_of};
use super::units::{Meaning, Plan};
use crate::nodes;
use crate::report::Report;

/// The most statements after calls have been replaced.
const MOST_STATEMENTS: usize = 200_000;
/// The deepest nesting of calls.
const DEEPEST: usize = 20;
/// The deepest nesting of statements, including those of called blocks.
const MOST_NESTED: usize = 100;
/// A placeholder for the call of a block with a chart, until all calls are known.
const CALL: &str = "\u{0}call";

/// A unit, or an action of it, that has a chart and is called.
pub(super) type Callee = (usize, Option<usize>);

/// How a block or action with a chart is called.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Calls {
    /// Called by the body of a program, under a condition.
    pub(super) sometimes: bool,
    /// Called by an action of a chart.
    pub(super) acted: bool,
}

/// Rewrites code until the limit for the file is reached.
pub(super) struct Coder<'r, 'p, 'a> {
    pub(super) plan: &'p Plan<'a>,
    pub(super) report: &'r mut Report,
    pub(super) calls: BTreeMap<Callee, Calls>,
    /// The units without a chart whose bodies stand where they are called.
    pub(super) placed: BTreeSet<usize>,
    left: usize,
    full: bool,
}

/// The context of a piece of code.
#[derive(Clone)]
pub(super) struct Place {
    /// The unit whose names the code uses; None in a function.
    pub(super) unit: Option<usize>,
    /// The chart that contains the code; None in the bodies of the file.
    pub(super) inside: Option<String>,
    /// Names that hide all others, in upper case.
    pub(super) locals: HashMap<String, String>,
    depth: usize,
    nested: usize,
    action: bool,
}

/// The meaning of a path.
enum Found {
    Path(Vec<Name>, Option<Type>),
    Unit(usize),
    Action(usize, usize),
}

impl Place {
    pub(super) fn of_unit(unit: usize, inside: Option<&str>, action: bool) -> Place {
        let inside = inside.map(str::to_string);
        Place { unit: Some(unit), inside, locals: HashMap::new(), depth: 0, nested: 0, action }
    }

    /// The same context with the names of another unit.
    pub(super) fn with_unit(&self, unit: usize) -> Place {
        Place { unit: Some(unit), ..self.clone() }
    }
}

impl<'r, 'p, 'a> Coder<'r, 'p, 'a> {
    pub(super) fn new(plan: &'p Plan<'a>, report: &'r mut Report) -> Coder<'r, 'p, 'a> {
        Coder {
            plan,
            report,
            calls: BTreeMap::new(),
            placed: BTreeSet::new(),
            left: MOST_STATEMENTS,
            full: false,
        }
    }

    /// The statements of a body in any language except SFC.
    pub(super) fn body(&mut self, language: Language, node: Xml<'a>, place: &Place) -> Vec<Stmt> {
        let raw = self.plan.code.body(language, node, self.report);
        self.statements(raw, place)
    }

    /// Statements with the names of the document.
    pub(super) fn statements(&mut self, raw: Vec<Stmt>, place: &Place) -> Vec<Stmt> {
        let mut done = Vec::with_capacity(raw.len());
        for statement in raw {
            let Some(left) = self.left.checked_sub(1) else {
                if !self.full {
                    self.full = true;
                    let what = say!("calls of blocks make more statements than are read");
                    self.report.put(g7_model::Problem::new(&codes::TOO_LARGE, statement.at.0, what));
                }
                break;
            };
            self.left = left;
            self.statement(statement, place, &mut done);
        }
        done
    }

    fn statement(&mut self, statement: Stmt, place: &Place, done: &mut Vec<Stmt>) {
        let at = statement.at.0;
        let mut inner = place.clone();
        inner.nested += 1;
        if inner.nested > MOST_NESTED {
            let what = say!("statements nested too deeply, calls of blocks counted in");
            self.report.put(g7_model::Problem::new(&codes::TOO_DEEP, at, what));
            return;
        }
        let kind = match statement.kind {
            StmtKind::Assign { target, value } => {
                StmtKind::Assign { target: self.expr(target, place), value: self.expr(value, place) }
            }
            StmtKind::Call(path, args) => return self.call(path, args, at, place, done),
            StmtKind::If(branches, otherwise) => StmtKind::If(
                branches
                    .into_iter()
                    .map(|(c, b)| (self.expr(c, place), self.statements(b, &inner)))
                    .collect(),
                self.statements(otherwise, &inner),
            ),
            StmtKind::Case(e, arms, otherwise) => StmtKind::Case(
                self.expr(e, place),
                arms.into_iter().map(|arm| self.arm(arm, &inner)).collect(),
                self.statements(otherwise, &inner),
            ),
            StmtKind::For { var, from, to, by, body } => StmtKind::For {
                var: self.loop_variable(var, place),
                from: self.expr(from, place),
                to: self.expr(to, place),
                by: by.map(|b| self.expr(b, place)),
                body: self.statements(body, &inner),
            },
            StmtKind::While(e, body) => StmtKind::While(self.expr(e, place), self.statements(body, &inner)),
            StmtKind::Repeat(body, e) => StmtKind::Repeat(self.statements(body, &inner), self.expr(e, place)),
            StmtKind::Return if place.depth > 0 => {
                let what =
                    say!("RETURN in a block that is called: the rest of the caller would not run either");
                self.report.put(g7_model::Problem::new(&codes::NOT_CARRIED, at, what));
                return;
            }
            kind @ (StmtKind::Exit | StmtKind::Return) => kind,
        };
        done.push(Stmt { kind, at: statement.at });
    }

    fn arm(&mut self, arm: CaseArm, place: &Place) -> CaseArm {
        let labels = arm.labels.into_iter();
        let labels = labels.map(|(a, b)| (self.expr(a, place), b.map(|b| self.expr(b, place)))).collect();
        CaseArm { labels, body: self.statements(arm.body, place) }
    }

    fn loop_variable(&mut self, var: Name, place: &Place) -> Name {
        match self.find(std::slice::from_ref(&var), place) {
            Found::Path(mut names, _) if names.len() == 1 => names.pop().unwrap_or(var),
            Found::Path(..) | Found::Unit(_) | Found::Action(..) => {
                let what = say!("the loop counts with `{}`, a variable of another chart", var.text);
                self.report.put(g7_model::Problem::new(&codes::NOT_CARRIED, var.at.0, what));
                var
            }
        }
    }

    /// An expression with the names of the document.
    pub(super) fn expr(&mut self, expr: Expr, place: &Place) -> Expr {
        let kind = match expr.kind {
            ExprKind::Path(path) => match self.find(&path.names, place) {
                Found::Path(names, _) => ExprKind::Path(Path { names }),
                Found::Unit(_) | Found::Action(..) => ExprKind::Path(path),
            },
            ExprKind::Unary(op, e) => ExprKind::Unary(op, Box::new(self.expr(*e, place))),
            ExprKind::Binary(op, a, b) => {
                ExprKind::Binary(op, Box::new(self.expr(*a, place)), Box::new(self.expr(*b, place)))
            }
            ExprKind::Timer { t1, e, t2 } => ExprKind::Timer {
                t1: Box::new(self.expr(*t1, place)),
                e: Box::new(self.expr(*e, place)),
                t2: t2.map(|t| Box::new(self.expr(*t, place))),
            },
            ExprKind::Call(mut path, args) => {
                if path.names.first().is_some_and(|n| self.plan.code.wide.contains(&n.text.to_uppercase())) {
                    let what = crate::sfc::in_receptivity();
                    self.report.put(g7_model::Problem::new(&codes::NOT_CARRIED, expr.at.0, what));
                }
                if let [name] = path.names.as_mut_slice()
                    && let Some(pou) = self.plan.functions.get(&name.text.to_uppercase())
                    && let Some(pou) = self.plan.project.pous.get(*pou)
                {
                    name.text = nodes::line(&pou.name.text).into();
                }
                ExprKind::Call(path, self.args(args, place))
            }
            ExprKind::Element(path, index, member) => {
                let names = match self.find(&path.names, place) {
                    Found::Path(names, _) => names,
                    Found::Unit(_) | Found::Action(..) => path.names,
                };
                let index = index.into_iter().map(|e| self.expr(e, place)).collect();
                ExprKind::Element(Box::new(Path { names }), index, member)
            }
            ExprKind::List(values) => {
                ExprKind::List(values.into_iter().map(|(n, e)| (n, self.expr(e, place))).collect())
            }
            kind @ (ExprKind::Literal(_) | ExprKind::Direct(_) | ExprKind::Bad) => kind,
        };
        Expr { kind, at: expr.at }
    }

    fn args(&mut self, args: Vec<Arg>, place: &Place) -> Vec<Arg> {
        args.into_iter().map(|a| Arg { value: self.expr(a.value, place), ..a }).collect()
    }

    /// The meaning of a path, and its spelling in this context.
    fn find(&self, names: &[Name], place: &Place) -> Found {
        let plain = || Found::Path(names.to_vec(), None);
        let Some(first) = names.first() else { return plain() };
        let upper = g7_model::bare(&first.text).0.to_uppercase();
        if let Some(local) = place.locals.get(&upper) {
            let mut found = names.to_vec();
            if let Some(first) = found.first_mut() {
                first.text = local.as_str().into();
            }
            return Found::Path(found, None);
        }
        let near = place.unit.and_then(|u| self.plan.units.get(u).and_then(|known| known.names.get(&upper)));
        if let (Some(meaning), Some(unit)) = (near, place.unit) {
            return self.meant(meaning, Some(unit), names, 0, place);
        }
        if let Some(meaning) = self.plan.globals.get(&upper) {
            return self.meant(meaning, None, names, 0, place);
        }
        if self.plan.lists.contains(&upper)
            && let Some(second) = names.get(1)
            && let Some(meaning) = self.plan.globals.get(&second.text.to_uppercase())
        {
            return self.meant(meaning, None, names, 1, place);
        }
        let units = self.plan.units.iter().enumerate();
        let program = units.filter(|(_, u)| u.program).find(|(_, u)| u.chart.to_uppercase() == upper);
        match program {
            Some((unit, _)) if names.len() > 1 => self.within(unit, names, 1, place),
            _ => plain(),
        }
    }

    /// A path whose `k`-th name has this meaning in a unit; None for the global names.
    fn meant(
        &self,
        meaning: &Meaning,
        unit: Option<usize>,
        names: &[Name],
        k: usize,
        place: &Place,
    ) -> Found {
        let at = names.get(k).map(|n| n.at.0).unwrap_or_default();
        let rest = || names.iter().skip(k + 1).cloned();
        let home = |chart: &String| {
            let foreign = place.inside.as_ref() != Some(chart);
            foreign.then(|| Name::new(chart.as_str(), at))
        };
        match meaning {
            Meaning::Var(chart, name, ty) => {
                let mut found: Vec<Name> = chart.as_ref().and_then(home).into_iter().collect();
                // The index of an element of an array stands in the name: `d[i]`.
                let index = names.get(k).map_or("", |n| g7_model::bare(&n.text).1);
                found.push(Name::new(format!("{name}{index}"), at));
                found.extend(rest());
                Found::Path(found, *ty)
            }
            Meaning::Step(name) => {
                let chart = unit.and_then(|u| self.plan.units.get(u)).map(|u| &u.chart);
                // In its own chart, and in charts within it, the name alone is enough.
                let own = unit.is_some() && place.unit == unit && place.inside.is_some();
                let mut found: Vec<Name> = chart.filter(|_| !own).and_then(home).into_iter().collect();
                found.push(Name::new(name.as_str(), at));
                found.extend(rest().map(|n| match &*n.text.to_ascii_uppercase() {
                    "X" => Name { text: "X".into(), at: n.at },
                    "T" => Name { text: "t".into(), at: n.at },
                    _ => n,
                }));
                Found::Path(found, None)
            }
            Meaning::Unit(inner) if names.len() == k + 1 => Found::Unit(*inner),
            Meaning::Unit(inner) => self.within(*inner, names, k + 1, place),
            Meaning::Action(action) => match unit {
                Some(unit) => Found::Action(unit, *action),
                None => Found::Path(names.to_vec(), None),
            },
        }
    }

    /// A path whose first names led to a unit.
    fn within(&self, unit: usize, names: &[Name], k: usize, place: &Place) -> Found {
        let known = self.plan.units.get(unit);
        let name = names.get(k);
        let meaning = known.zip(name).and_then(|(u, n)| u.names.get(&n.text.to_uppercase()));
        match meaning {
            Some(meaning) => self.meant(meaning, Some(unit), names, k, place),
            None => Found::Path(names.to_vec(), None),
        }
    }

    /// A call as a statement. A call of a standard block stays a call; a call of the file's own
    /// block or action is replaced by its body.
    fn call(&mut self, path: Path, args: Vec<Arg>, at: Span, place: &Place, done: &mut Vec<Stmt>) {
        match self.find(&path.names, place) {
            Found::Unit(unit) => self.run(unit, args, at, place, done),
            Found::Action(unit, action) => self.act(unit, action, at, place, done),
            Found::Path(names, ty) => {
                let block = matches!(ty, Some(Type::Fb(_)));
                if !block && !args.is_empty() && names.len() == 1 && self.is_function(&path) {
                    let what = say!("the result of a function that is called as a statement is dropped");
                    self.report.put(g7_model::Problem::new(&codes::LEFT_OUT, at, what));
                    return;
                }
                let args = self.args(args, place);
                done.push(Stmt { kind: StmtKind::Call(Path { names }, args), at: at.into() });
            }
        }
    }

    fn is_function(&self, path: &Path) -> bool {
        path.names.first().is_some_and(|n| self.plan.functions.contains_key(&n.text.to_uppercase()))
    }

    /// A call of an instance of one of the file's own blocks.
    fn run(&mut self, unit: usize, args: Vec<Arg>, at: Span, place: &Place, done: &mut Vec<Stmt>) {
        let (Some(known), Some(pou)) = (self.plan.units.get(unit), self.plan.pou(unit)) else { return };
        if place.depth > DEEPEST {
            self.report.put(g7_model::Problem::new(
                &codes::TOO_DEEP,
                at,
                say!("calls within calls without end"),
            ));
            return;
        }
        let inputs =
            pou.sections.iter().filter(|s| matches!(s.kind, SectionKind::Input | SectionKind::InOut));
        let inputs: Vec<String> = inputs.flat_map(|s| &s.variables).filter_map(|v| name_of(*v)).collect();
        let mut behind = Vec::new();
        let mut by_place = inputs.iter();
        let of_block = Place { locals: HashMap::new(), unit: Some(unit), ..place.clone() };
        for arg in args {
            let Some(name) = arg.name.clone().or_else(|| by_place.next().map(|n| Name::new(n.as_str(), at)))
            else {
                self.report.put(g7_model::Problem::new(
                    &codes::BAD_TEXT,
                    at,
                    say!("more values than the block has inputs"),
                ));
                break;
            };
            let there = nodes::expr(ExprKind::Path(Path { names: vec![name.clone()] }), name.at.0);
            let there = self.expr(there, &of_block);
            let here = self.expr(arg.value, place);
            let both = self.shared(pou.sections.as_slice(), &name.text);
            if arg.output {
                behind.push(nodes::assign(here, there, at));
            } else {
                done.push(nodes::assign(there.clone(), here.clone(), at));
                if both {
                    behind.push(nodes::assign(here, there, at));
                }
            }
        }
        if self.plan.is_chart(unit) {
            let flag = flags_of(None).0;
            let mark = nodes::path(&[CALL, &known.chart, &flag], at);
            self.note((unit, None), place);
            done.push(Stmt { kind: StmtKind::Call(mark, Vec::new()), at: at.into() });
        } else if let Some((language, node)) = tree::body(pou.node) {
            let of_block = Place { depth: place.depth + 1, ..of_block };
            self.placed.insert(unit);
            done.append(&mut self.body(language, node, &of_block));
        }
        done.append(&mut behind);
    }

    /// Records how a chart is called.
    fn note(&mut self, callee: Callee, place: &Place) {
        let calls = self.calls.entry(callee).or_default();
        calls.acted |= place.action;
        calls.sometimes |= !place.action && place.nested > 0;
    }

    /// True if a parameter is both input and output.
    fn shared(&self, sections: &[super::read::Section], name: &str) -> bool {
        let both = sections.iter().filter(|s| s.kind == SectionKind::InOut);
        both.flat_map(|s| &s.variables).filter_map(|v| name_of(*v)).any(|n| n.eq_ignore_ascii_case(name))
    }

    /// A call of an action.
    fn act(&mut self, unit: usize, action: usize, at: Span, place: &Place, done: &mut Vec<Stmt>) {
        let Some(whole) = self.plan.pou(unit).and_then(|p| p.actions.get(action).copied()) else { return };
        let Some((language, node)) = tree::body(whole) else { return };
        if place.depth > DEEPEST {
            self.report.put(g7_model::Problem::new(
                &codes::TOO_DEEP,
                at,
                say!("calls within calls without end"),
            ));
            return;
        }
        if language == Language::Sfc {
            let chart = self.plan.units.get(unit).map(|u| u.chart.clone()).unwrap_or_default();
            let (flag, _) = flags_of(name_of(whole).as_deref());
            let mark = nodes::path(&[CALL, &chart, &flag], at);
            self.note((unit, Some(action)), place);
            done.push(Stmt { kind: StmtKind::Call(mark, Vec::new()), at: at.into() });
            return;
        }
        let of_action =
            Place { unit: Some(unit), locals: HashMap::new(), depth: place.depth + 1, ..place.clone() };
        done.append(&mut self.body(language, node, &of_action));
    }

    /// The type of the variable that a path names.
    pub(super) fn variable(&self, text: &str, at: Span, place: &Place) -> Option<(Path, Option<Type>)> {
        let names: Vec<Name> = text.split('.').map(|n| Name::new(n.trim(), at)).collect();
        let first = names.first()?.text.to_uppercase();
        let near = place.unit.and_then(|u| self.plan.units.get(u));
        let known = near.is_some_and(|u| u.names.contains_key(&first))
            || self.plan.globals.contains_key(&first)
            || self.plan.lists.contains(&first)
            || self.plan.units.iter().any(|u| u.program && u.chart.to_uppercase() == first);
        match self.find(&names, place) {
            Found::Path(names, ty) if known => Some((Path { names }, ty)),
            Found::Path(..) | Found::Unit(_) | Found::Action(..) => None,
        }
    }

    /// A unit's action of this name, with the unit that declares it.
    pub(super) fn action(&self, text: &str, at: Span, place: &Place) -> Option<(usize, usize)> {
        let names: Vec<Name> = text.split('.').map(|n| Name::new(n.trim(), at)).collect();
        match self.find(&names, place) {
            Found::Action(unit, action) => Some((unit, action)),
            Found::Path(..) | Found::Unit(_) => None,
        }
    }

    /// Reports a problem of an element.
    pub(super) fn say(&mut self, code: &'static codes::Code, node: Xml, what: Said) {
        self.report.say(code, &head(node), what);
    }
}

/// The names of the variables that are true while a chart is called: the first in this scan, the
/// second in the scan before. The charts of actions store theirs in the chart of their unit.
pub(super) fn flags_of(action: Option<&str>) -> (String, String) {
    match action {
        Some(action) => (format!("{action}_Called"), format!("{action}_Calling")),
        None => ("Called".to_string(), "Calling".to_string()),
    }
}

/// The chart whose call this statement stands for, with the variable of that call.
pub(super) fn called(statement: &Stmt) -> Option<(&str, &str)> {
    match &statement.kind {
        StmtKind::Call(path, _) => match path.names.as_slice() {
            [mark, chart, flag] if &*mark.text == CALL => Some((&chart.text, &flag.text)),
            _ => None,
        },
        _ => None,
    }
}

/// Gives the statement that replaces the call of a chart.
pub(super) type Put<'p> = &'p dyn Fn(&str, &str, Span) -> Option<Stmt>;

/// Replaces each call of a block or action with a chart by `put(chart, flag)`.
pub(super) fn resolve_calls(body: &mut Vec<Stmt>, put: Put) {
    let old = std::mem::take(body);
    for mut statement in old {
        if let Some((chart, flag)) = called(&statement) {
            body.extend(put(chart, flag, statement.at.0));
            continue;
        }
        g7_model::visit_mut::lists(&mut statement, |list| resolve_calls(list, put));
        body.push(statement);
    }
}
