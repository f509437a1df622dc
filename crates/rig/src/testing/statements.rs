//! Prepares the statements of a test for execution: names become items, expressions become asks.

use g7_model::{
    Expr, ExprKind, Literal, Name, Nanos, Problem, Said, Scenario, Span, TestStmt, TestStmtKind, Type, codes,
    say,
};

use super::sides;
use crate::Source;
use crate::{Answer, Ask, Bench, Role};

/// A prepared test.
#[derive(Debug, Default)]
pub(super) struct Plan {
    pub(super) lines: Vec<Line>,
}

/// A prepared statement.
#[derive(Debug)]
pub(super) struct Line {
    pub(super) does: Does,
    pub(super) at: Span,
}

/// The position of an item in [`Bench::items`].
type ItemId = usize;
/// The position of an ask among all asks.
type AskId = usize;

#[derive(Debug)]
pub(super) enum Does {
    Set(Vec<(ItemId, AskId)>),
    Pulse(ItemId, Option<Nanos>),
    Wait(Nanos),
    WaitUntil(Check, Nanos),
    Scan(u32),
    Expect(Vec<Check>),
    ExpectFault(Option<String>),
    Always(Vec<Check>, Vec<Line>),
    Force(ItemId, AskId),
    Release(ItemId),
    Restart { cold: bool },
    Repeat(u32, Vec<Line>),
    Nothing,
}

/// A condition, with the names in it for the report of a failure.
#[derive(Debug)]
pub(super) struct Check {
    /// The parts, all of which must hold. There are several only if the condition asks both charts
    /// and plant.
    pub(super) asks: Vec<Asked>,
    pub(super) at: Span,
    pub(super) mentions: Vec<(String, AskId)>,
}

/// A condition, or one operand of its outermost `and`.
#[derive(Debug)]
pub(super) struct Asked {
    pub(super) ask: AskId,
    at: Span,
    /// True for `0` and `1`, which are accepted as a BOOL.
    bit: bool,
}

/// How long `wait until` waits if the test gives no limit.
const PATIENCE: Nanos = Nanos::from_millis(10_000);
/// Most names shown for one condition.
const MENTIONS: usize = 8;

/// The problem of a test or a property that names a plant which does not exist.
pub(super) fn unknown_plant(source: &Source, name: &Name) -> Option<Problem> {
    let there: Vec<String> =
        g7_compile::plant::plants(&source.document).map(|p| format!("`{}`", p.name.text)).collect();
    if g7_compile::plant::plants(&source.document).any(|p| p.name.text == name.text) {
        return None;
    }
    let problem = Problem::new(&codes::TEST_PLANT, name.at.0, say!("there is no plant `{}`", name.text));
    Some(if there.is_empty() {
        problem
    } else {
        problem.help(say!("there is {}", Said::foreign(there.join(", "))))
    })
}

/// Prepares a test.
pub(super) fn plan(test: &Scenario, bench: &Bench, asks: &mut Vec<Ask>) -> (Plan, Vec<Problem>) {
    let mut planner = Planner { bench, asks, problems: Vec::new() };
    let lines = planner.lines(&test.body);
    (Plan { lines }, planner.problems)
}

struct Planner<'a> {
    bench: &'a Bench,
    asks: &'a mut Vec<Ask>,
    problems: Vec<Problem>,
}

impl Planner<'_> {
    fn lines(&mut self, body: &[TestStmt]) -> Vec<Line> {
        body.iter().map(|s| Line { does: self.does(s), at: s.at.0 }).collect()
    }

    fn does(&mut self, s: &TestStmt) -> Does {
        match &s.kind {
            TestStmtKind::Set(list) => Does::Set(list.iter().filter_map(|(p, e)| self.put(p, e)).collect()),
            TestStmtKind::Pulse(target, time) => self.pulse(target, *time),
            TestStmtKind::Wait(time) => Does::Wait(*time),
            TestStmtKind::WaitUntil(e, within) => Does::WaitUntil(self.check(e), within.unwrap_or(PATIENCE)),
            TestStmtKind::Scan(n) => Does::Scan(*n),
            TestStmtKind::Expect(list) => Does::Expect(list.iter().map(|e| self.check(e)).collect()),
            TestStmtKind::ExpectFault(name) => self.fault(name.as_ref()),
            TestStmtKind::Always(list, body) => {
                Does::Always(list.iter().map(|e| self.check(e)).collect(), self.lines(body))
            }
            TestStmtKind::Force(target, e) => {
                let item = self.item(target, true);
                match item.and_then(|item| Some((item, self.ask(e)?))) {
                    Some((item, ask)) => Does::Force(item, ask),
                    None => Does::Nothing,
                }
            }
            TestStmtKind::Release(target) => self.item(target, true).map_or(Does::Nothing, Does::Release),
            TestStmtKind::Restart { cold } => Does::Restart { cold: *cold },
            TestStmtKind::Repeat(n, body) => Does::Repeat(*n, self.lines(body)),
            TestStmtKind::Comment(_) => Does::Nothing,
        }
    }

    fn put(&mut self, target: &Expr, e: &Expr) -> Option<(ItemId, AskId)> {
        let item = self.item(target, false)?;
        Some((item, self.ask(e)?))
    }

    fn pulse(&mut self, target: &Expr, time: Option<Nanos>) -> Does {
        let Some(item) = self.item(target, false) else { return Does::Nothing };
        if self.bench.items.get(item).is_some_and(|i| i.ty != Type::Bool) {
            self.wrong(target, say!("`{}` is not a BOOL, so it cannot be pulsed", written(target)), None);
        }
        Does::Pulse(item, time)
    }

    fn fault(&mut self, name: Option<&Name>) -> Does {
        let words = ["unstable", "bound", "overflow", "division", "range", "forcing", "table"];
        if let Some(name) = name.filter(|n| !words.contains(&&*n.text)) {
            let what = say!("there is no fault `{}`", name.text);
            let problem = Problem::new(&codes::TEST_NAME, name.at.0, what);
            self.problems.push(problem.help(say!("there are {}", Said::foreign(words.join(", ")))));
        }
        Does::ExpectFault(name.map(|n| n.text.to_string()))
    }

    /// Finds the item that a name means; reports a problem if it cannot be set (or, with `hold`,
    /// forced).
    fn item(&mut self, target: &Expr, hold: bool) -> Option<ItemId> {
        let name = written(target);
        let found = match &target.kind {
            ExprKind::Direct(_) => self.bench.item(&name).map(|i| i.name.as_str()),
            _ => Some(name.as_str()),
        };
        let at = found.and_then(|name| self.bench.items.iter().position(|i| i.name == name));
        let Some(at) = at else {
            let (what, help) = self.bench.no_item(&name);
            self.wrong(target, what, Some(help));
            return None;
        };
        let item = self.bench.items.get(at)?;
        match item.role {
            Role::Output if !hold => {
                let help = say!("`force {name} := …` holds an output");
                self.wrong(target, say!("`{name}` is an output: the charts set it"), Some(help));
            }
            Role::Plant if hold => {
                self.wrong(target, say!("`{name}` is a state of the plant: it can be set, not held"), None);
            }
            Role::Input(index) if !hold && self.is_driven(index) => {
                let help = say!("`force {name} := …` holds it against the plant");
                self.wrong(target, say!("`{name}` is driven by the plant"), Some(help));
            }
            Role::Input(_) | Role::Output | Role::Variable | Role::Plant => {}
        }
        Some(at)
    }

    fn is_driven(&self, index: u32) -> bool {
        let plant = self.bench.plant.as_ref();
        plant.is_some_and(|p| p.coupling.to_charts.iter().any(|(_, to)| *to == index))
    }

    fn wrong(&mut self, target: &Expr, what: Said, help: Option<Said>) {
        let mut problem = Problem::new(&codes::TEST_NAME, target.at.0, what);
        problem.help = help.filter(|h| !h.is_empty());
        self.problems.push(problem);
    }

    /// Adds an ask for the side that knows all names of the expression; the charts if both do.
    /// Reports a problem if neither does.
    fn ask(&mut self, e: &Expr) -> Option<AskId> {
        match sides::ask(self.bench, e) {
            Ok(ask) => self.asks.push(ask),
            Err(problem) => {
                self.problems.push(problem);
                return None;
            }
        }
        Some(self.asks.len() - 1)
    }

    /// Prepares a condition.
    fn check(&mut self, e: &Expr) -> Check {
        let mut check = Check { asks: Vec::new(), at: e.at.0, mentions: Vec::new() };
        for part in sides::parts(self.bench, e) {
            let Some(ask) = self.ask(part) else { continue };
            check.asks.push(Asked { ask, at: part.at.0, bit: is_bit(part) });
            self.mention(part, ask, &mut check.mentions);
        }
        check
    }

    /// Adds an ask for each name in a condition, so that a failure can show its value.
    fn mention(&mut self, e: &Expr, ask: AskId, mentions: &mut Vec<(String, AskId)>) {
        let of_plant = self.asks.get(ask).is_some_and(|a| a.of_plant);
        let mut variables: Vec<&Expr> = Vec::new();
        collect(e, &mut variables);
        for expr in variables {
            let Some(name) = expr.kind.variable() else { continue };
            if mentions.len() < MENTIONS && mentions.iter().all(|(n, _)| *n != name) {
                self.asks.push(Ask { expr: expr.clone(), of_plant });
                mentions.push((name, self.asks.len() - 1));
            }
        }
    }
}

/// The name that a statement sets, as it is written.
fn written(target: &Expr) -> String {
    match &target.kind {
        ExprKind::Direct(text) => format!("%{text}"),
        kind => kind.variable().unwrap_or_default(),
    }
}

/// Collects every variable of an expression, in the order of the text.
fn collect<'e>(e: &'e Expr, to: &mut Vec<&'e Expr>) {
    match &e.kind {
        ExprKind::Path(_) => to.push(e),
        ExprKind::Element(_, index, _) => {
            to.push(e);
            index.iter().for_each(|e| collect(e, to));
        }
        ExprKind::List(values) => values.iter().for_each(|(_, e)| collect(e, to)),
        ExprKind::Unary(_, a) => collect(a, to),
        ExprKind::Binary(_, a, b) => {
            collect(a, to);
            collect(b, to);
        }
        ExprKind::Timer { t1, e, t2 } => {
            collect(t1, to);
            collect(e, to);
            t2.iter().for_each(|t| collect(t, to));
        }
        ExprKind::Call(_, args) => args.iter().for_each(|a| collect(&a.value, to)),
        ExprKind::Literal(_) | ExprKind::Direct(_) | ExprKind::Bad => {}
    }
}

/// True if an expression is `0` or `1`, which are accepted as a BOOL.
fn is_bit(e: &Expr) -> bool {
    matches!(&e.kind, ExprKind::Literal(Literal::Int(0 | 1, _)))
}

/// The problems of types, which are known after the asks are compiled.
pub(super) fn judge(plans: &[(usize, &Scenario, Plan)], bench: &Bench) -> Vec<Problem> {
    let mut problems = Vec::new();
    for (_, scenario, plan) in plans {
        // The statements are needed beside the prepared lines for the places of their expressions.
        judge_lines(&scenario.body, &plan.lines, bench, &mut problems);
    }
    problems
}

fn judge_lines(body: &[TestStmt], lines: &[Line], bench: &Bench, problems: &mut Vec<Problem>) {
    let ty = |ask: AskId| bench.answers.get(ask).map(|a: &Answer| a.ty);
    let condition = |check: &Check, problems: &mut Vec<Problem>| {
        for asked in check.asks.iter().filter(|a| !a.bit) {
            if let Some(ty) = ty(asked.ask).filter(|t| *t != Type::Bool) {
                let what = say!("this is {ty}, a condition is BOOL");
                problems.push(Problem::new(&codes::TEST_TYPE, asked.at, what));
            }
        }
    };
    let value = |item: ItemId, ask: AskId, e: &Expr, problems: &mut Vec<Problem>| {
        let (Some(item), Some(from)) = (bench.items.get(item), ty(ask)) else { return };
        if !fits(from, item.ty, e) {
            let what = say!("this is {from}, `{}` is {}", item.name, item.ty);
            problems.push(Problem::new(&codes::TEST_TYPE, e.at.0, what));
        }
    };
    for (s, line) in body.iter().zip(lines) {
        match (&s.kind, &line.does) {
            (TestStmtKind::Set(list), Does::Set(puts)) if list.len() == puts.len() => {
                for ((_, e), (item, ask)) in list.iter().zip(puts) {
                    value(*item, *ask, e, problems);
                }
            }
            (TestStmtKind::Force(_, e), Does::Force(item, ask)) => value(*item, *ask, e, problems),
            (_, Does::WaitUntil(check, _)) => condition(check, problems),
            (_, Does::Expect(checks)) => checks.iter().for_each(|c| condition(c, problems)),
            (TestStmtKind::Always(_, body), Does::Always(checks, lines)) => {
                checks.iter().for_each(|c| condition(c, problems));
                judge_lines(body, lines, bench, problems);
            }
            (TestStmtKind::Repeat(_, body), Does::Repeat(_, lines)) => {
                judge_lines(body, lines, bench, problems);
            }
            _ => {}
        }
    }
}

fn fits(from: Type, to: Type, e: &Expr) -> bool {
    let number = |t: Type| t.is_integer() || t.is_real();
    match (from, to) {
        (Type::Moment(from), Type::Moment(to)) => from == to,
        (Type::Bool, Type::Bool) | (Type::Time, Type::Time) | (Type::String(_), Type::String(_)) => true,
        (from, Type::Bool) => from.is_integer() && is_bit(e),
        (from, to) if from.is_real() => to.is_real(),
        (from, to) => number(from) && number(to),
    }
}
