//! Finds what a path or a direct name refers to (grammar.md, "A `path` names").
//!
//! The order is: a local of the block, a variable of the chart, a variable of the file,
//! `Chart.variable`, a member of a function block, the activity of a step, the time since its
//! activation. So a variable called `X12` hides the activity of step 12.

use g7_model::{Name, Problem, ProfileName, Said, Span, Type, codes, normal_address, say};

use super::resolver::{Resolver, Role, nearest};
use super::scopes::{Entity, Home, Homes};
use crate::ir::{ChartId, ChartRole, StepId, StepSort, VarClass, VarId};

/// The meaning of a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ref {
    /// A variable, or the output of a section.
    Var(VarId),
    /// A member of a function block instance.
    Member(VarId, u8),
    /// A bit of a variable; the type need not have so many.
    Bit(VarId, u8),
    /// The activity of a step.
    Active(StepId),
    /// The time since its activation, in one of its units.
    Time(StepId, Unit),
}

/// The units of a step's time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unit {
    /// TIME, or scans under the scan clock.
    Clock,
    /// 100 ms.
    Tenths,
    /// Seconds, under the scan clock.
    Seconds,
}

/// Why a path refers to nothing. Numbers are positions in the path.
enum Miss {
    /// No such name, here or in this chart.
    Name(usize, Option<ChartId>),
    /// No such step, here or in this chart.
    Step(usize, Option<ChartId>),
    /// Several charts have the step.
    Ambiguous(usize, StepId, StepId),
    /// The instance has no such member.
    Member(usize, VarId),
    /// The variable has no members at all.
    NoMembers(usize, VarId),
    /// A step has nothing of that name.
    OfStep(usize, StepId),
    /// A step without `.X`.
    BareStep(usize, StepId),
    /// An action, function or chart has no value.
    NoValue(usize, Said),
}

impl Resolver<'_, '_> {
    /// Finds what the names refer to; reports a problem if they refer to nothing.
    pub(super) fn refer(&mut self, names: &[Name]) -> Option<Ref> {
        if names.iter().any(|n| n.text.is_empty()) {
            return None; // The name could not be read; the parser has reported it.
        }
        match self.lookup(names) {
            Ok(r) => Some(r),
            Err(miss) => {
                let problem = self.explain(names, &miss);
                self.report(problem)
            }
        }
    }

    /// The same, without a report.
    pub(super) fn found(&self, names: &[Name]) -> Option<Ref> {
        self.lookup(names).ok()
    }

    fn lookup(&self, names: &[Name]) -> Result<Ref, Miss> {
        let Some(first) = names.first() else { return Err(Miss::Name(0, None)) };
        let Some(second) = names.get(1) else { return self.single(&first.text) };
        let mut miss = None;
        if let Some(chart) = self.scopes.chart(&first.text) {
            match self.of_chart(chart, names, 1) {
                Ok(r) => return Ok(r),
                Err(m) => miss = Some(m),
            }
        }
        if let Some(Entity::Var(v)) = self.entity(&first.text) {
            if let (Some(part), 2) = (self.part(v, &second.text), names.len()) {
                return Ok(part);
            }
            let fb = matches!(self.var(v).map(|v| v.ty), Some(Type::Fb(_)));
            miss = miss.or(Some(if fb { Miss::Member(1, v) } else { Miss::NoMembers(1, v) }));
        }
        self.step_path(None, names, 0).map_err(|m| miss.unwrap_or(m))
    }

    /// A path of one name.
    fn single(&self, name: &str) -> Result<Ref, Miss> {
        if let Some(e) = self.entity(name) {
            return self.value_of(e, 0);
        }
        match self.activity(None, name) {
            Some(Home::One(_, s)) => return Ok(Ref::Active(s)),
            Some(Home::Several(a, b)) => return Err(Miss::Ambiguous(0, a, b)),
            None => {}
        }
        match self.scopes.home(self.frame.chart, name) {
            Some(Home::One(_, s) | Home::Several(s, _)) => Err(Miss::BareStep(0, s)),
            None if self.scopes.chart(name).is_some() => Err(Miss::NoValue(0, say!("a chart"))),
            None if step_number(name).is_some() => Err(Miss::Step(0, None)),
            None => Err(Miss::Name(0, None)),
        }
    }

    /// Looks for a local, then for a name of the chart and of the file.
    pub(super) fn entity(&self, name: &str) -> Option<Entity> {
        match self.frame.locals.get(name) {
            Some(v) => Some(Entity::Var(*v)),
            None => self.scopes.visible(self.frame.chart, name),
        }
    }

    /// The meaning of `name` or `Chart.name`, steps aside.
    pub(super) fn named(&self, names: &[Name]) -> Option<Entity> {
        match names {
            [name] => self.entity(&name.text),
            [chart, name] => self.scopes.of_chart(self.scopes.chart(&chart.text)?, &name.text),
            _ => None,
        }
    }

    fn value_of(&self, entity: Entity, k: usize) -> Result<Ref, Miss> {
        match entity {
            Entity::Var(v) => Ok(Ref::Var(v)),
            Entity::Section(s) => {
                self.unit.sections.get(s.index()).map(|s| Ref::Var(s.output)).ok_or(Miss::Name(k, None))
            }
            Entity::Array(_) => Err(Miss::NoValue(k, say!("an array"))),
            Entity::Body(_) => Err(Miss::NoValue(k, say!("an action"))),
            Entity::Function(_) => Err(Miss::NoValue(k, say!("a function"))),
        }
    }

    /// Resolves `names[k..]` in the chart that was named before them.
    fn of_chart(&self, chart: ChartId, names: &[Name], k: usize) -> Result<Ref, Miss> {
        let Some(name) = names.get(k) else {
            return Err(Miss::NoValue(k.saturating_sub(1), say!("a chart")));
        };
        let entity = self.scopes.of_chart(chart, &name.text);
        if k + 1 < names.len() {
            if let (Some(Entity::Var(v)), Some(member)) = (entity, names.get(k + 1)) {
                if let (Some(part), true) = (self.part(v, &member.text), k + 2 == names.len()) {
                    return Ok(part);
                }
                if matches!(self.var(v).map(|v| v.ty), Some(Type::Fb(_))) {
                    return Err(Miss::Member(k + 1, v));
                }
            }
            return self.step_path(Some(chart), names, k);
        }
        if let Some(e) = entity {
            return self.value_of(e, k);
        }
        match self.activity(Some(chart), &name.text) {
            Some(Home::One(_, s)) => Ok(Ref::Active(s)),
            Some(Home::Several(a, b)) => Err(Miss::Ambiguous(k, a, b)),
            None => match self.scopes.step(chart, &name.text) {
                Some(s) => Err(Miss::BareStep(k, s)),
                None if step_number(&name.text).is_some() => Err(Miss::Step(k, Some(chart))),
                None => Err(Miss::Name(k, Some(chart))),
            },
        }
    }

    /// `Fill.X`, `X12.t`, `M3.X12`: at least two names from `k` on.
    fn step_path(&self, chart: Option<ChartId>, names: &[Name], k: usize) -> Result<Ref, Miss> {
        let (Some(first), Some(second)) = (names.get(k), names.get(k + 1)) else {
            return Err(Miss::Name(k, chart));
        };
        let last = k + 2 == names.len();
        let by_name = match chart {
            Some(c) => self.scopes.step(c, &first.text).map(|s| Home::One(c, s)),
            None => self.scopes.home(self.frame.chart, &first.text),
        };
        let (home, bare) = match by_name {
            Some(h) => (h, true),
            None => match self.activity(chart, &first.text) {
                Some(h) => (h, false),
                None if step_number(&first.text).is_some() => return Err(Miss::Step(k, chart)),
                None => return Err(Miss::Name(k, chart)),
            },
        };
        let step = match home {
            Home::One(_, s) => s,
            Home::Several(a, b) => return Err(Miss::Ambiguous(k, a, b)),
        };
        if let (Some(r), true) = (self.of_step(step, &second.text, bare), last) {
            return Ok(r);
        }
        match self.expansion(step) {
            Some(inner) if bare => self.of_chart(inner, names, k + 1),
            _ => Err(Miss::OfStep(k + 1, step)),
        }
    }

    /// `.X`, `.T`, `.t`; in `jgrafchart` and `unity` also `.x`, in `jgrafchart` `.s`.
    pub(super) fn of_step(&self, step: StepId, name: &str, bare: bool) -> Option<Ref> {
        let small = matches!(self.unit.profile, ProfileName::Jgrafchart | ProfileName::Unity);
        match name {
            "X" if bare => Some(Ref::Active(step)),
            "x" if bare && small => Some(Ref::Active(step)),
            "T" | "t" => Some(Ref::Time(step, Unit::Clock)),
            "s" if self.unit.rules.scan_clock => Some(Ref::Time(step, Unit::Seconds)),
            _ => None,
        }
    }

    /// `X12`, `XFill`, `XM3` (of macro-step `M3` or `3`): the activity of a step.
    pub(super) fn activity(&self, chart: Option<ChartId>, name: &str) -> Option<Home> {
        let step = name.strip_prefix('X').filter(|s| !s.is_empty())?;
        let find = |name: &str| match chart {
            Some(c) => self.scopes.step(c, name).map(|s| Home::One(c, s)),
            None => self.scopes.home(self.frame.chart, name),
        };
        find(step).or_else(|| {
            let home = find(step.strip_prefix('M').filter(|s| !s.is_empty())?)?;
            let Home::One(_, s) = home else { return Some(home) };
            self.expansion(s).map(|_| home)
        })
    }

    pub(super) fn expansion(&self, step: StepId) -> Option<ChartId> {
        match &self.unit.steps.get(step.index())?.sort {
            StepSort::Macro(c) => Some(*c),
            StepSort::Plain | StepSort::Enclosing(_) => None,
        }
    }

    pub(super) fn member(&self, instance: VarId, name: &str) -> Option<u8> {
        match self.var(instance)?.ty {
            Type::Fb(kind) => super::fb::member(kind, name),
            _ => None,
        }
    }

    /// A member of an instance, or a bit of a number.
    pub(super) fn part(&self, v: VarId, name: &str) -> Option<Ref> {
        let bit = || Self::bit_number(name, self.var(v)?.ty).map(|bit| Ref::Bit(v, bit));
        self.member(v, name).map(|m| Ref::Member(v, m)).or_else(bit)
    }

    /// The problem to report if nothing was found.
    fn explain(&mut self, names: &[Name], miss: &Miss) -> Problem {
        let at = |k: usize| names.get(k).or(names.last()).map_or(Span::default(), |n| n.at.0);
        let text = |k: usize| names.get(k).or(names.last()).map_or("", |n| &*n.text);
        match *miss {
            Miss::Name(k, chart) => self.unknown_name(text(k), at(k), chart),
            Miss::Step(k, chart) => {
                let step = step_number(text(k)).unwrap_or_default();
                let home = chart.and_then(|c| self.unit.charts.get(c.index()));
                let what = match home {
                    Some(c) => say!("chart `{}` has no step `{step}`", c.name),
                    None => say!("there is no step `{step}`"),
                };
                Problem::new(&codes::UNKNOWN_STEP, at(k), what)
            }
            Miss::Ambiguous(k, a, b) => self.ambiguous(text(k), at(k), a, b),
            Miss::Member(k, v) => self.no_member(text(k), at(k), v),
            Miss::NoMembers(k, v) => {
                let (name, ty) = self.var(v).map(|v| (v.name.clone(), v.ty)).unzip();
                let what = match (name, ty) {
                    (Some(n), Some(ty)) => say!("`{n}` is a {ty}; it has no member `{}`", text(k)),
                    _ => say!("there is no member `{}`", text(k)),
                };
                Problem::new(&codes::UNKNOWN_MEMBER, at(k), what)
            }
            Miss::OfStep(k, s) => self.not_of_step(text(k), at(k), s),
            Miss::BareStep(k, s) => {
                let path = self.activity_path(s);
                let what = say!("`{}` is a step, not a value", text(k));
                Problem::new(&codes::WRONG_KIND, at(k), what).help(say!("its activity is `{path}`"))
            }
            Miss::NoValue(k, ref what) => {
                let what = say!("`{}` is {what}; it has no value", text(k));
                Problem::new(&codes::WRONG_KIND, at(k), what)
            }
        }
    }

    fn unknown_name(&mut self, name: &str, at: Span, chart: Option<ChartId>) -> Problem {
        let home = chart.and_then(|c| self.unit.charts.get(c.index())).map(|c| c.name.clone());
        let what = match &home {
            Some(c) => say!("chart `{c}` has no `{name}`"),
            None => say!("nothing is called `{name}`"),
        };
        let mut problem = Problem::new(&codes::UNKNOWN_NAME, at, what);
        if matches!(name, "True" | "False") {
            return problem.meant(&name.to_ascii_uppercase());
        }
        if let Some(base) = self.overlined(name, chart) {
            problem.help = Some(say!("write `not {base}`, `{base}'` or `/{base}`"));
        } else if self.may_guess() {
            if let Some(instance) = self.instance_near(name) {
                problem.help =
                    Some(say!("an instance is named by a number that is written out, as in `{instance}`"));
            } else if let Some(near) = self.guess(name, home.as_deref()) {
                problem = problem.meant(&near);
            }
        }
        problem
    }

    /// The BOOL variable that was probably meant by a letter with a macron (`ā`): it looks like an
    /// overline but is a letter of its own.
    fn overlined(&self, name: &str, chart: Option<ChartId>) -> Option<String> {
        let base: String = name.chars().map(|c| without_macron(c).unwrap_or(c)).collect();
        if base == name {
            return None;
        }
        let entity = chart.map_or_else(|| self.entity(&base), |c| self.scopes.of_chart(c, &base))?;
        let Ok(Ref::Var(v)) = self.value_of(entity, 0) else { return None };
        (self.var(v)?.ty == Type::Bool).then_some(base)
    }

    /// Searches the variables of the named chart, or of the file and the current chart.
    fn guess(&self, name: &str, chart: Option<&str>) -> Option<String> {
        let here = self.frame.chart.and_then(|c| self.unit.charts.get(c.index())).map(|c| &*c.name);
        let seen = self.unit.vars.iter().filter_map(|v| match v.name.split_once('.') {
            Some((home, rest)) if Some(home) == chart.or(here) => Some(rest),
            Some(_) => None,
            None => chart.is_none().then_some(&*v.name),
        });
        nearest(name, seen.filter(|n| *n != name)).map(str::to_owned)
    }

    fn ambiguous(&self, name: &str, at: Span, a: StepId, b: StepId) -> Problem {
        let what = say!("several charts have the step of `{name}`");
        let mut problem = Problem::new(&codes::AMBIGUOUS_STEP, at, what);
        for s in [a, b] {
            if let Some(step) = self.unit.steps.get(s.index()) {
                let chart = self.unit.charts.get(step.chart.index()).map_or("", |c| &*c.name);
                problem = problem.related(step.at, say!("step `{}` of `{chart}`", step.name));
            }
        }
        problem.help = Some(say!("name the chart, as in `{}`", self.activity_path(a)));
        problem
    }

    fn no_member(&self, name: &str, at: Span, instance: VarId) -> Problem {
        let Some((Type::Fb(kind), owner)) = self.var(instance).map(|v| (v.ty, &v.name)) else {
            return Problem::new(&codes::UNKNOWN_MEMBER, at, say!("there is no member `{name}`"));
        };
        let members: Vec<&str> = kind.members().iter().map(|m| m.0).collect();
        let what = say!("`{owner}` is a {}; it has no member `{name}`", kind);
        Problem::new(&codes::UNKNOWN_MEMBER, at, what).help(say!(
            "a {} has {}",
            kind,
            Said::foreign(members.join(", "))
        ))
    }

    fn not_of_step(&self, name: &str, at: Span, step: StepId) -> Problem {
        let step_name = self.unit.steps.get(step.index()).map_or("", |s| &*s.name);
        let what = say!("step `{step_name}` has no `{name}`");
        let help = match name {
            "x" => say!("its activity is `.X`"),
            "s" => say!("the time since its activation is `.t`, a TIME"),
            _ => say!("a step has `.X`, its activity, and `.t`, the time since its activation"),
        };
        Problem::new(&codes::UNKNOWN_MEMBER, at, what).help(help)
    }

    /// The activity of a step, written so that it is valid anywhere.
    pub(super) fn activity_path(&self, step: StepId) -> String {
        let Some(s) = self.unit.steps.get(step.index()) else { return String::new() };
        let unique = matches!(self.scopes.step_homes.get(&*s.name), Some(Homes::One(..)));
        let number = s.name.bytes().all(|b| b.is_ascii_digit());
        let own = if number { format!("X{}", s.name) } else { format!("{}.X", s.name) };
        match self.unit.charts.get(s.chart.index()) {
            Some(c) if !unique => format!("{}.{own}", c.name),
            _ => own,
        }
    }

    /// Finds what a direct name refers to: `text` is in upper case, without its `%`.
    pub(super) fn refer_direct(&mut self, text: &str, at: Span) -> Option<Ref> {
        if let Some(v) = self.scopes.addresses.get(&normal_address(text)) {
            return Some(Ref::Var(*v));
        }
        if text.starts_with('X') {
            return self.direct_step(text, at);
        }
        if let Some((word, bit)) = text.split_once(":X")
            && let Some(v) = self.scopes.addresses.get(&normal_address(word)).copied()
            && let Some(bit) = self.var(v).and_then(|v| Self::bit_number(bit, v.ty))
        {
            return Some(Ref::Bit(v, bit));
        }
        if let Some(ty) = super::system::type_of(text) {
            return Some(Ref::Var(self.system(text, ty, at)));
        }
        let problem = Problem::new(&codes::UNKNOWN_DIRECT, at, say!("nothing is declared at `%{text}`"));
        self.report(match text.as_bytes().first() {
            Some(b'I') => problem.help(say!("declare it: `input name : BOOL at %{text}`")),
            Some(b'Q') => problem.help(say!("declare it: `output name : BOOL at %{text}`")),
            Some(b'M') => problem.help(say!("declare it: `var name : BOOL at %{text}`")),
            _ => problem.help(say!("the system bits are %S0, %S1, %S21 to %S25, the words %SW20 to %SW25")),
        })
    }

    /// The variable of a system bit or word; it is made when it is first named.
    fn system(&mut self, text: &str, ty: Type, at: Span) -> VarId {
        let v = self.add_var(format!("%{text}").into(), VarClass::System, ty, at);
        self.scopes.addresses.insert(text.to_owned(), v);
        v
    }

    /// `%X12`, `%XM3`, `%X3.12`, `%X3.IN`, `%X3.OUT`, and `.T` behind these.
    fn direct_step(&mut self, text: &str, at: Span) -> Option<Ref> {
        self.known_direct_step(text).or_else(|| {
            let problem = Problem::new(&codes::UNKNOWN_STEP, at, say!("there is no step `%{text}`"));
            self.report(problem.help(say!(
                "`%X12` is step 12 of the first chart, `%X3.12` step 12 of the expansion of macro-step 3"
            )))
        })
    }

    /// The same, of a name that may be that of no step.
    pub(super) fn known_direct_step(&self, text: &str) -> Option<Ref> {
        let rest = text.strip_prefix('X')?;
        let (name, tenths) = match rest.strip_suffix(".T") {
            Some(n) => (n, true),
            None => (rest, false),
        };
        let step = match name.split_once('.') {
            Some((outer, inner)) => self.macro_numbered(outer).and_then(|c| {
                let chart = self.unit.charts.get(c.index())?;
                match inner {
                    "IN" => chart.entry,
                    "OUT" => chart.exit,
                    _ => self.scopes.step(c, inner),
                }
            }),
            None => match name.strip_prefix('M') {
                Some(number) => self.macro_step(number),
                None => self.first_chart().and_then(|c| self.scopes.step(c, name)),
            },
        }?;
        Some(if tenths { Ref::Time(step, Unit::Tenths) } else { Ref::Active(step) })
    }

    pub(super) fn first_chart(&self) -> Option<ChartId> {
        let k = self.unit.charts.iter().position(|c| c.role == ChartRole::Chart)?;
        Some(ChartId(k as u32))
    }

    /// Macro-step 3, called `3` or `M3`: of the current chart, else the only one.
    pub(super) fn macro_step(&self, number: &str) -> Option<StepId> {
        [number.to_owned(), format!("M{number}")].iter().find_map(|name| {
            let own = self.first_chart().and_then(|c| self.scopes.step(c, name));
            let step = own.or_else(|| match self.scopes.home(None, name)? {
                Home::One(_, s) => Some(s),
                Home::Several(..) => None,
            })?;
            self.expansion(step).map(|_| step)
        })
    }

    fn macro_numbered(&self, number: &str) -> Option<ChartId> {
        self.macro_step(number).and_then(|s| self.expansion(s))
    }

    /// Checks that code in this place may read it; reports a problem if not.
    pub(super) fn may_read(&mut self, r: Ref, at: Span) -> bool {
        let class = match r {
            Ref::Var(v) | Ref::Bit(v, _) => self.var(v).map(|v| v.class),
            Ref::Member(..) | Ref::Active(_) | Ref::Time(..) => None,
        };
        if self.frame.watched && class == Some(VarClass::Local) {
            self.problems.push(
                Problem::new(&codes::NOT_HERE, at, say!("an edge or a delay cannot watch a local variable"))
                    .help(say!("a local has no value between two runs; watch a variable of the chart")),
            );
            return false;
        }
        if self.frame.role == Role::Constant && class != Some(VarClass::Const) {
            let what = say!("a value that is known before the chart runs is needed here");
            self.problems.push(Problem::new(&codes::NOT_CONSTANT, at, what));
            return false;
        }
        true
    }
}

/// The number in `X12`.
fn step_number(name: &str) -> Option<&str> {
    name.strip_prefix('X').filter(|n| !n.is_empty() && n.bytes().all(|b| b.is_ascii_digit()))
}

/// The letter below the macron of a precomposed one (Unicode's decompositions with U+0304).
fn without_macron(c: char) -> Option<char> {
    const LETTERS: [(char, char); 16] = [
        ('Ā', 'A'),
        ('ā', 'a'),
        ('Ē', 'E'),
        ('ē', 'e'),
        ('Ī', 'I'),
        ('ī', 'i'),
        ('Ō', 'O'),
        ('ō', 'o'),
        ('Ū', 'U'),
        ('ū', 'u'),
        ('Ȳ', 'Y'),
        ('ȳ', 'y'),
        ('Ḡ', 'G'),
        ('ḡ', 'g'),
        ('Ǣ', 'Æ'),
        ('ǣ', 'æ'),
    ];
    LETTERS.iter().find(|(with, _)| *with == c).map(|(_, base)| *base)
}
