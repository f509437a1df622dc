//! The state of a resolution, and the problems that all of its parts report.

use std::collections::{HashMap, HashSet};

use g7_model::{Holds, Name, Problem, Span, Type, chart_in, codes, instance_of, say};

use super::scopes::Scopes;
use crate::ir::{ChartId, FunctionId, SectionId, Unit, Value, Var, VarClass, VarId};

/// The number of unknown names that get a "did you mean": each one costs a search through all
/// names.
const GUESSES: u32 = 100;

/// The kind of code that is being resolved; it decides what is allowed there.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Role {
    /// A receptivity, condition, action or body.
    #[default]
    Code,
    /// A function.
    Function(FunctionId),
    /// A transition section.
    Section(SectionId),
    /// A question of a test or of the debugger.
    Query,
    /// An initial value or CASE label.
    Constant,
}

/// The surroundings of the code being read.
#[derive(Clone, Debug, Default)]
pub(super) struct Frame {
    /// The chart in which names are looked up first.
    pub(super) chart: Option<ChartId>,
    /// The kind of code.
    pub(super) role: Role,
    /// The variables of the block itself.
    pub(super) locals: HashMap<Box<str>, VarId>,
    /// The number of loops around the statement.
    pub(super) loops: u32,
    /// True inside the operand of an edge or a timer, which is evaluated outside of any body.
    pub(super) watched: bool,
    /// True in PRE.
    pub(super) pre: bool,
}

/// Resolves one document, or a question on one.
pub(super) struct Resolver<'u, 'd> {
    pub(super) unit: &'u mut Unit,
    pub(super) scopes: &'u mut Scopes<'d>,
    pub(super) problems: Vec<Problem>,
    pub(super) frame: Frame,
    /// Which function calls which, and where.
    pub(super) calls: Vec<(FunctionId, FunctionId, Span)>,
    /// Constants whose values are not computed yet.
    pub(super) pending: HashSet<VarId>,
    /// For each section, the transition that uses it.
    pub(super) section_uses: HashMap<SectionId, Span>,
    guesses: u32,
}

impl<'u, 'd> Resolver<'u, 'd> {
    pub(super) fn new(unit: &'u mut Unit, scopes: &'u mut Scopes<'d>) -> Resolver<'u, 'd> {
        Resolver {
            unit,
            scopes,
            problems: Vec::new(),
            frame: Frame::default(),
            calls: Vec::new(),
            pending: HashSet::new(),
            section_uses: HashMap::new(),
            guesses: GUESSES,
        }
    }

    /// Reports a problem. It always returns `None`, so that a lookup can end with it.
    pub(super) fn report<T>(&mut self, problem: Problem) -> Option<T> {
        self.problems.push(problem);
        None
    }

    /// Resolves code in other surroundings.
    pub(super) fn within<T>(&mut self, frame: Frame, read: impl FnOnce(&mut Self) -> T) -> T {
        let outer = std::mem::replace(&mut self.frame, frame);
        let result = read(self);
        self.frame = outer;
        result
    }

    /// Resolves code of a chart, or of the file.
    pub(super) fn in_chart<T>(&mut self, chart: Option<ChartId>, read: impl FnOnce(&mut Self) -> T) -> T {
        self.within(Frame { chart, ..Frame::default() }, read)
    }

    /// The variable with this id.
    pub(super) fn var(&self, id: VarId) -> Option<&Var> {
        self.unit.vars.get(id.index())
    }

    /// Adds a variable with the zero of its type.
    pub(super) fn add_var(&mut self, name: Box<str>, class: VarClass, ty: Type, at: Span) -> VarId {
        let id = VarId(self.unit.vars.len() as u32);
        self.unit.vars.push(Var {
            name,
            class,
            ty,
            held: None,
            elements: 1,
            init: zero(ty),
            table: Vec::new(),
            retain: false,
            address: None,
            inverted: false,
            safe: zero(ty),
            comment: None,
            at,
        });
        id
    }

    /// The name with the name of its chart before it.
    pub(super) fn qualified(&self, chart: Option<ChartId>, name: &str) -> Box<str> {
        match chart.and_then(|c| self.unit.charts.get(c.index())) {
            Some(c) => format!("{}.{name}", c.name).into(),
            None => name.into(),
        }
    }

    /// Reports a name that is declared twice in one name space.
    pub(super) fn defined_twice(&mut self, name: &Name, first: Span) {
        self.problems.push(
            Problem::new(&codes::DEFINED_TWICE, name.at.0, say!("`{}` is defined twice", name.text))
                .related(first, say!("defined here first")),
        );
    }

    /// The chart, expansion or task with this name.
    pub(super) fn chart_named(&mut self, name: &Name) -> Option<ChartId> {
        if let Some(c) = self.scopes.chart(&name.text) {
            return Some(c);
        }
        if name.text.is_empty() {
            return None; // The name could not be read; the parser has reported it.
        }
        let mut problem =
            Problem::new(&codes::UNKNOWN_CHART, name.at.0, say!("there is no chart `{}`", name.text));
        if !self.may_guess() {
            return self.report(problem);
        }
        if let Some(near) = self.instance_near(&name.text) {
            problem = problem.help(say!("did you mean `{near}`?"));
        } else {
            let plain = self.unit.charts.iter().map(|c| &*c.name).filter(|n| instance_of(n).is_none());
            if let Some(near) = nearest(&name.text, plain) {
                problem = problem.meant(near);
            }
        }
        self.report(problem)
    }

    /// An instance of the chart with parameters that a wrong name has: `Axis[1]` for `Axis` and `Axis[k]`.
    pub(super) fn instance_near(&self, name: &str) -> Option<&str> {
        let chart = chart_in(name);
        let of_chart = |n: &&str| instance_of(n).is_some_and(|(c, _)| c == chart);
        self.unit.charts.iter().map(|c| &*c.name).find(of_chart)
    }

    /// Finds a step of this chart.
    pub(super) fn step_named(&mut self, chart: ChartId, name: &Name) -> Option<crate::ir::StepId> {
        if let Some(s) = self.scopes.step(chart, &name.text) {
            return Some(s);
        }
        if name.text.is_empty() {
            return None; // The name could not be read; the parser has reported it.
        }
        let home = self.unit.charts.get(chart.index()).map(|c| (c.name.clone(), c.steps.clone()));
        let (chart_name, steps) = home?;
        let what = say!("chart `{chart_name}` has no step `{}`", name.text);
        let mut problem = Problem::new(&codes::UNKNOWN_STEP, name.at.0, what);
        if self.may_guess() {
            let of_chart = self.unit.steps.get(steps.start as usize..steps.end as usize).unwrap_or(&[]);
            let near = nearest(&name.text, of_chart.iter().map(|s| &*s.name));
            problem = match near {
                Some(near) => problem.meant(near),
                None => problem.help(say!("declare it: `step {}`", name.text)),
            };
        }
        self.report(problem)
    }

    /// Takes one of the remaining searches for a "did you mean"; false if none is left.
    pub(super) fn may_guess(&mut self) -> bool {
        let may = self.guesses > 0;
        self.guesses = self.guesses.saturating_sub(1);
        may
    }
}

/// The zero of a type.
pub(super) fn zero(ty: Type) -> Value {
    match ty.holds() {
        Some(Holds::Truth) | None => Value::Bool(false),
        Some(Holds::Real) => Value::Real(0.0),
        Some(Holds::Text) => Value::Str("".into()),
        Some(Holds::Signed | Holds::Unsigned | Holds::Bits | Holds::Time | Holds::Moment(_)) => Value::Int(0),
    }
}

/// The candidate that a mistyped name most likely meant: equal except for case, or at most a third
/// of its letters different.
pub(super) fn nearest<'a>(name: &str, candidates: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let letters: Vec<char> = name.to_lowercase().chars().collect();
    // Numbers are not treated as mistyped words: 12 is not a slip for 13.
    if letters.len() > 40 || letters.iter().all(|c| c.is_ascii_digit()) {
        return None;
    }
    let mut best: Option<(usize, &str)> = None;
    let most = (letters.len() / 3).max(1);
    for candidate in candidates {
        if candidate.len().abs_diff(name.len()) > 4 * most {
            continue;
        }
        let d = distance(&letters, &candidate.to_lowercase().chars().collect::<Vec<_>>());
        if d <= most && d < letters.len() && best.is_none_or(|(b, _)| d < b) {
            best = Some((d, candidate));
        }
    }
    best.map(|(_, n)| n)
}

/// Insertions, deletions, replacements and swaps of neighbours between two words.
fn distance(a: &[char], b: &[char]) -> usize {
    let mut before: Vec<usize> = Vec::new();
    let mut last: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.iter().enumerate() {
        let mut row = vec![i + 1];
        for (j, y) in b.iter().enumerate() {
            let get = |v: &Vec<usize>, k: usize| v.get(k).copied().unwrap_or(usize::MAX / 2);
            let mut d =
                (get(&last, j) + usize::from(x != y)).min(get(&last, j + 1) + 1).min(get(&row, j) + 1);
            let swapped = i > 0 && j > 0 && a.get(i - 1) == Some(y) && b.get(j - 1) == Some(x);
            if swapped {
                d = d.min(get(&before, j - 1) + 1);
            }
            row.push(d);
        }
        before = std::mem::replace(&mut last, row);
    }
    last.last().copied().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::nearest;

    #[test]
    fn the_nearest_name_is_found() {
        let names = ["motor", "Tank", "count", "x"];
        for (given, want) in [
            ("moter", Some("motor")),
            ("mtoor", Some("motor")),
            ("tank", Some("Tank")),
            ("cout", Some("count")),
            ("q", None),
            ("bottle", None),
            ("12", None),
        ] {
            assert_eq!(nearest(given, names.into_iter()), want, "{given}");
        }
    }
}
