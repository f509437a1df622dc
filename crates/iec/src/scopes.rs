//! Finds the meaning of names in a document, in the order of the language (grammar.md, "A `path`
//! names").

use std::collections::HashMap;

use g7_model::{
    Chart, ChartItem, ChartKind, Document, Item, Name, NamedAction, Section, Step, StepKind, Type, VarDecl,
};

/// A step: the index of its chart and its index among the steps there.
pub type StepKey = (usize, usize);

/// The meaning of a path.
#[derive(Clone, Copy)]
pub enum Ref<'d> {
    /// A variable of a chart or of the file.
    Var(VarKey<'d>),
    /// A member of a function block.
    Member(VarKey<'d>, &'static str),
    /// A member of an instance of a function block of the file, see [`g7_model::composed::with_blocks`]; so many names of
    /// the path stand behind the instance.
    Inner(VarKey<'d>, usize),
    /// A bit of a bit string or a whole number.
    Bit(VarKey<'d>, u8),
    /// The activity of a step.
    Active(StepKey),
    /// The time of a step.
    Time(StepKey),
    /// The time of a step in seconds, a REAL, where step times count scans.
    Seconds(StepKey),
    /// A transition section, with its chart.
    Section(Option<usize>, &'d Section),
    /// A named action, with its chart.
    Action(Option<usize>, &'d NamedAction),
}

/// A variable: the chart that declares it (None: the file), and its name.
pub type VarKey<'d> = (Option<usize>, &'d str);

/// The names of one chart, or of the file.
#[derive(Default)]
struct Table<'d> {
    vars: HashMap<&'d str, &'d VarDecl>,
    actions: HashMap<&'d str, &'d NamedAction>,
    sections: HashMap<&'d str, &'d Section>,
}

/// All names of a document.
pub struct Scopes<'d> {
    /// The charts, expansions and tasks, by number.
    pub charts: Vec<&'d Chart>,
    steps: Vec<Vec<&'d Step>>,
    places: Vec<HashMap<&'d str, usize>>,
    /// The steps with a name, in all charts.
    homes: HashMap<&'d str, Vec<StepKey>>,
    tables: Vec<Table<'d>>,
    file: Table<'d>,
    numbers: HashMap<&'d str, usize>,
    addresses: HashMap<String, VarKey<'d>>,
}

impl<'d> Scopes<'d> {
    /// The names of a document.
    pub fn new(document: &'d Document) -> Scopes<'d> {
        let charts: Vec<&Chart> = document.charts().collect();
        let mut scopes = Scopes {
            steps: charts.iter().map(|c| c.steps().collect()).collect(),
            places: Vec::new(),
            homes: HashMap::new(),
            tables: Vec::new(),
            file: Table::default(),
            numbers: charts.iter().enumerate().map(|(i, c)| (&*c.name.text, i)).collect(),
            addresses: HashMap::new(),
            charts,
        };
        for item in &document.items {
            match item {
                Item::Var(v) => scopes.declare(None, v),
                Item::Action(a) => _ = scopes.file.actions.insert(&a.name.text, a),
                Item::Section(s) => _ = scopes.file.sections.insert(&s.name.text, s),
                _ => {}
            }
        }
        for (number, chart) in scopes.charts.clone().into_iter().enumerate() {
            scopes.tables.push(Table::default());
            for item in &chart.items {
                match item {
                    ChartItem::Var(v) => scopes.declare(Some(number), v),
                    ChartItem::Action(a) => {
                        scopes.tables.last_mut().map(|t| t.actions.insert(&a.name.text, a));
                    }
                    ChartItem::Section(s) => {
                        scopes.tables.last_mut().map(|t| t.sections.insert(&s.name.text, s));
                    }
                    _ => {}
                }
            }
            let mut places = HashMap::new();
            for (place, step) in chart.steps().enumerate() {
                places.entry(&*step.name.text).or_insert(place);
                scopes.homes.entry(&step.name.text).or_default().push((number, place));
            }
            scopes.places.push(places);
        }
        scopes
    }

    fn declare(&mut self, chart: Option<usize>, decl: &'d VarDecl) {
        for name in &decl.names {
            if let Some(address) = &decl.address {
                self.addresses.entry(address_of(&address.text)).or_insert((chart, &name.text));
            }
            let table = match chart {
                Some(c) => self.tables.get_mut(c),
                None => Some(&mut self.file),
            };
            table.map(|t| t.vars.insert(&name.text, decl));
        }
    }

    /// A chart by its number.
    pub fn chart(&self, number: usize) -> Option<&'d Chart> {
        self.charts.get(number).copied()
    }

    /// The number of the chart with a name.
    pub fn chart_named(&self, name: &str) -> Option<usize> {
        self.numbers.get(name).copied()
    }

    /// A step.
    pub fn step(&self, key: StepKey) -> Option<&'d Step> {
        self.steps.get(key.0)?.get(key.1).copied()
    }

    /// The step of a chart with a name.
    pub fn step_in(&self, chart: usize, name: &str) -> Option<StepKey> {
        Some((chart, *self.places.get(chart)?.get(name)?))
    }

    /// The steps of a chart, in the order of the text.
    pub fn steps_of(&self, chart: usize) -> impl Iterator<Item = (StepKey, &'d Step)> + use<'d> {
        let steps = self.steps.get(chart).cloned().unwrap_or_default();
        steps.into_iter().enumerate().map(move |(i, s)| ((chart, i), s))
    }

    /// The declaration of a variable.
    pub fn decl(&self, key: VarKey) -> Option<&'d VarDecl> {
        let table = match key.0 {
            Some(c) => self.tables.get(c)?,
            None => &self.file,
        };
        table.vars.get(key.1).copied()
    }

    /// The variable at an address.
    pub fn at(&self, address: &str) -> Option<VarKey<'d>> {
        self.addresses.get(&address_of(address)).copied()
    }

    /// The chart that is the expansion of a macro-step.
    pub fn expansion(&self, key: StepKey) -> Option<usize> {
        match &self.step(key)?.kind {
            StepKind::Macro(name) => self.chart_named(&name.text),
            _ => None,
        }
    }

    /// The meaning of a path in a chart or in the file.
    pub fn refer(&self, chart: Option<usize>, names: &[Name]) -> Option<Ref<'d>> {
        let (first, rest) = names.split_first()?;
        if rest.is_empty() {
            let own = chart.and_then(|c| self.entity(Some(c), &first.text));
            let found = own.or_else(|| self.entity(None, &first.text));
            return found.or_else(|| self.activity(None, chart, &first.text).map(Ref::Active));
        }
        if let Some(named) = self.chart_named(&first.text)
            && let Some(found) = self.of_chart(named, rest)
        {
            return Some(found);
        }
        let own = chart.and_then(|c| self.entity(Some(c), &first.text));
        if let Some(Ref::Var(key)) = own.or_else(|| self.entity(None, &first.text))
            && let Some(part) = self.behind(key, rest)
        {
            return Some(part);
        }
        self.step_path(None, chart, names)
    }

    fn entity(&self, chart: Option<usize>, name: &str) -> Option<Ref<'d>> {
        let table = match chart {
            Some(c) => self.tables.get(c)?,
            None => &self.file,
        };
        if let Some((name, _)) = table.vars.get_key_value(name) {
            return Some(Ref::Var((chart, name)));
        }
        let section = table.sections.get(name).map(|s| Ref::Section(chart, s));
        section.or_else(|| table.actions.get(name).map(|a| Ref::Action(chart, a)))
    }

    /// The meaning of the names behind a variable.
    fn behind(&self, key: VarKey<'d>, rest: &[Name]) -> Option<Ref<'d>> {
        if self.decl(key)?.is_own_instance() {
            return Some(Ref::Inner(key, rest.len()));
        }
        match rest {
            [part] => self.part(key, &part.text),
            _ => None,
        }
    }

    /// A member of an instance, or a bit of a number.
    fn part(&self, key: VarKey<'d>, name: &str) -> Option<Ref<'d>> {
        match self.decl(key)?.ty {
            Type::Fb(kind) => {
                let member = kind.members().iter().find(|m| m.0.eq_ignore_ascii_case(name))?;
                Some(Ref::Member(key, member.0))
            }
            ty if ty.is_bits() || ty.is_integer() => name.parse().ok().map(|bit| Ref::Bit(key, bit)),
            _ => None,
        }
    }

    /// The bit at an address such as `MW4:X3`, of a variable that is declared at `%MW4`.
    pub fn bit_at(&self, address: &str) -> Option<Ref<'d>> {
        let (word, bit) = address.split_once(":X")?;
        self.part(self.at(word)?, bit)
    }

    fn of_chart(&self, chart: usize, names: &[Name]) -> Option<Ref<'d>> {
        let (first, rest) = names.split_first()?;
        let entity = self.entity(Some(chart), &first.text);
        match (entity, rest) {
            (Some(found), []) => return Some(found),
            (Some(Ref::Var(key)), behind) => {
                if let Some(part) = self.behind(key, behind) {
                    return Some(part);
                }
            }
            _ => {}
        }
        if rest.is_empty() {
            return self.activity(Some(chart), None, &first.text).map(Ref::Active);
        }
        self.step_path(Some(chart), None, names)
    }

    /// `Fill.X`, `X12.t`, `M3.X12`.
    fn step_path(&self, inside: Option<usize>, from: Option<usize>, names: &[Name]) -> Option<Ref<'d>> {
        let [first, second, rest @ ..] = names else { return None };
        let by_name = self.find(inside, from, &first.text);
        let step = by_name.or_else(|| self.activity(inside, from, &first.text))?;
        if rest.is_empty() {
            match &*second.text {
                "X" | "x" if by_name.is_some() => return Some(Ref::Active(step)),
                "T" | "t" => return Some(Ref::Time(step)),
                "s" => return Some(Ref::Seconds(step)),
                _ => {}
            }
        }
        by_name?;
        self.of_chart(self.expansion(step)?, names.get(1..)?)
    }

    /// A step by its name: in one chart, or as visible from one.
    fn find(&self, inside: Option<usize>, from: Option<usize>, name: &str) -> Option<StepKey> {
        if let Some(chart) = inside {
            return self.step_in(chart, name);
        }
        if let Some(own) = from.and_then(|c| self.step_in(c, name)) {
            return Some(own);
        }
        let all = self.homes.get(name)?;
        let proper = |k: &&StepKey| self.chart(k.0).is_some_and(|c| c.kind == ChartKind::Chart);
        match all.as_slice() {
            [one] => Some(*one),
            several => {
                let mut found = several.iter().filter(proper);
                let first = found.next()?;
                found.next().is_none().then_some(*first)
            }
        }
    }

    /// `X12`, `XFill`, `XM3`.
    fn activity(&self, inside: Option<usize>, from: Option<usize>, name: &str) -> Option<StepKey> {
        let step = name.strip_prefix('X').filter(|s| !s.is_empty())?;
        self.find(inside, from, step).or_else(|| {
            let found = self.find(inside, from, step.strip_prefix('M').filter(|s| !s.is_empty())?)?;
            self.expansion(found).map(|_| found)
        })
    }

    /// `X12`, `XM3` as a direct name: a step of the first chart. `X3.12`, `X3.IN`, `X3.OUT`: one of the expansion of
    /// a macro-step.
    pub fn direct_step(&self, text: &str) -> Option<StepKey> {
        let first = self.charts.iter().position(|c| c.kind == ChartKind::Chart)?;
        let name = text.strip_prefix('X')?;
        let macro_step = |number: &str| {
            let names = [number.to_owned(), format!("M{number}")];
            let step = names.iter().find_map(|n| self.find(None, Some(first), n))?;
            self.expansion(step).map(|inner| (step, inner))
        };
        if let Some((outer, inside)) = name.split_once('.') {
            let (_, inner) = macro_step(outer)?;
            let of_kind = |kind: StepKind| self.steps_of(inner).find(|(_, s)| s.kind == kind).map(|(k, _)| k);
            return match inside {
                "IN" => of_kind(StepKind::Entry),
                "OUT" => of_kind(StepKind::Exit),
                _ => self.step_in(inner, inside),
            };
        }
        match name.strip_prefix('M') {
            Some(number) => macro_step(number).map(|(step, _)| step),
            None => self.step_in(first, name),
        }
    }
}

/// An address in a uniform spelling: upper case without `%`, `IX0.1` as `I0.1`.
fn address_of(text: &str) -> String {
    let upper = text.trim_start_matches('%').to_ascii_uppercase();
    match upper.as_bytes() {
        [area @ (b'I' | b'Q' | b'M'), b'X', b'0'..=b'9', ..] => {
            format!("{}{}", char::from(*area), upper.get(2..).unwrap_or(""))
        }
        _ => upper,
    }
}
