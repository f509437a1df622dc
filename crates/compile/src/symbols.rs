//! Names and places in the text for the rows of a program.
//!
//! The engine knows only numbers. Everything that reports about a running program (traces, tests,
//! coverage, the terminal view, the place of a fault) translates through these tables. Names are
//! stored one after another in one string, so that a hundred thousand steps cost two allocations.

use std::sync::Arc;

use g7_engine::{Addr, Duration, GroupId, State, StepId};
use g7_model::{Holds, Nanos, Span, Type};

use crate::held::Held;
use crate::ir::VarClass;

/// Many short texts in one string.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Names {
    text: String,
    ends: Vec<u32>,
}

impl Names {
    /// Adds a text.
    pub fn push(&mut self, name: &str) {
        self.text.push_str(name);
        self.end();
    }

    /// Adds a text, which `write` appends to the string.
    pub(crate) fn push_with(&mut self, write: impl FnOnce(&mut String)) {
        write(&mut self.text);
        self.end();
    }

    fn end(&mut self) {
        self.ends.push(u32::try_from(self.text.len()).unwrap_or(u32::MAX));
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// True if there are none.
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// The text at an index; empty if there is none.
    pub fn get(&self, i: usize) -> &str {
        let start = if i == 0 { Some(0) } else { self.ends.get(i - 1).copied() };
        let (Some(start), Some(end)) = (start, self.ends.get(i)) else { return "" };
        self.text.get(start as usize..*end as usize).unwrap_or("")
    }

    /// All of them.
    pub fn iter(&self) -> impl Iterator<Item = &str> {
        (0..self.len()).map(|i| self.get(i))
    }
}

/// A variable.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// The name as users write it from outside of the chart: `motor`, `Fill.count`; `c.Q` for a
    /// member of an instance.
    pub name: Box<str>,
    /// The role of the variable. Members of an instance have the class of the instance.
    pub class: VarClass,
    /// Its type.
    pub ty: Type,
    /// The values that it can have, if it is of an enumeration or has bounds.
    pub held: Option<Arc<Held>>,
    /// Its first word.
    pub addr: Addr,
    /// Number of elements: 1, except for tables.
    pub elements: u32,
    /// Kept over a restart.
    pub retain: bool,
    /// The channel carries the complement.
    pub inverted: bool,
    /// Address or channel, as written.
    pub address: Option<Box<str>>,
    /// The words that it takes after a fault (outputs).
    pub safe: Box<[u64]>,
    /// `"…"`.
    pub comment: Option<Box<str>>,
    /// Its declaration.
    pub at: Span,
}

impl Variable {
    /// The number of words of all its elements together.
    pub fn words(&self) -> u32 {
        crate::lower::words_of(self.ty).saturating_mul(self.elements)
    }

    /// Its words in a state.
    pub fn value<'a>(&self, state: &'a State) -> &'a [u64] {
        let from = self.addr.0 as usize;
        state.words().get(from..from + self.words() as usize).unwrap_or(&[])
    }
}

/// An outermost chart; the engine counts only these.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ChartSymbol {
    /// Its name.
    pub name: Box<str>,
    /// Its steps, expansions included.
    pub group: GroupId,
    /// Its name in the text.
    pub at: Span,
}

/// A macro-step.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MacroSymbol {
    /// As in traces: `M3`, or `G.M3`.
    pub name: Box<str>,
    /// The same with its chart: `G.M3`.
    pub path: Box<str>,
    /// The name of the chart that it stands in.
    pub chart: Box<str>,
    /// The steps of its expansion: it is active while one of them is.
    pub group: GroupId,
    /// The step that carries the actions and the time of the macro-step, if it has any.
    pub step: Option<StepId>,
    /// Its name in the text.
    pub at: Span,
}

/// An action, by rank.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ActionSymbol {
    /// Where it stands.
    pub at: Span,
    /// True if the lowering made it, and no line of the text stands for it.
    pub hidden: bool,
}

/// A control block.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BlockSymbol {
    /// The variable or named action that it drives; empty for an action without a name.
    pub name: Box<str>,
    /// Its first association, or the named action.
    pub at: Span,
}

/// Names and places of everything in a program.
#[derive(Clone, Debug, Default)]
pub struct Symbols {
    /// Variables, constants, locals and system bits, in text order; behind each
    /// instance its members.
    pub variables: Vec<Variable>,
    /// Outermost charts.
    pub charts: Vec<ChartSymbol>,
    /// Macro-steps, in text order.
    pub macro_steps: Vec<MacroSymbol>,
    /// By step: its name in traces.
    pub(crate) step_names: Names,
    /// By step: chart and name.
    pub(crate) step_paths: Names,
    /// By step: its chart in [`Symbols::chart_names`].
    pub(crate) step_charts: Vec<u32>,
    /// By transition: its chart in [`Symbols::chart_names`].
    pub(crate) transition_charts: Vec<u32>,
    /// The names of all charts, expansions and tasks; of an instance its own, `Axis[3]`.
    pub(crate) chart_names: Vec<Box<str>>,
    /// By step: where its name stands.
    pub(crate) step_places: Vec<Span>,
    /// By step: it stands for a macro-step.
    pub(crate) pseudo: Vec<bool>,
    /// By transition: label, or empty.
    pub(crate) labels: Names,
    /// By transition: `1 -> 2`.
    pub(crate) arrows: Names,
    /// By transition: all of it in the text.
    pub(crate) transition_places: Vec<Span>,
    /// By transition: made by the lowering.
    pub(crate) hidden: Vec<bool>,
    /// Actions, by rank.
    pub actions: Vec<ActionSymbol>,
    /// Control blocks.
    pub blocks: Vec<BlockSymbol>,
    /// By instruction: the place to name in a fault.
    pub(crate) places: Vec<Span>,
    /// `%S0`, TRUE in the first scan after a cold start.
    pub s0: Option<Addr>,
    /// `%S1`, to be set by the host before the first scan after a warm restart
    /// (and `%S0` taken back).
    pub s1: Option<Addr>,
    /// The word of the random generator, to be set before the first scan.
    pub seed: Option<Addr>,
    /// The nominal scan time.
    pub cycle: Nanos,
}

impl Symbols {
    /// The variable of this name (`motor`, `Fill.count`, `c.Q`).
    pub fn variable(&self, name: &str) -> Option<&Variable> {
        self.variables.iter().find(|v| &*v.name == name)
    }

    /// The variable that begins at this word; an instance is found before its members.
    pub fn variable_at(&self, addr: Addr) -> Option<&Variable> {
        self.variables.iter().find(|v| v.addr <= addr && addr.0 < v.addr.0.saturating_add(v.words()))
    }

    /// Number of steps, including those that stand for macro-steps.
    pub fn steps(&self) -> u32 {
        self.step_names.len() as u32
    }

    /// A step's name in traces: `5`, `G.5` where another chart has a step 5,
    /// `M3.E` in an expansion.
    pub fn step_name(&self, step: StepId) -> &str {
        self.step_names.get(step.0 as usize)
    }

    /// A step's name with its chart: `G.5`, `G.M3.E`.
    pub fn step_path(&self, step: StepId) -> &str {
        self.step_paths.get(step.0 as usize)
    }

    /// The name of the chart, expansion or task with a step; `Axis[3]` for that of an instance.
    pub fn step_chart(&self, step: StepId) -> &str {
        self.chart_name(self.step_charts.get(step.0 as usize))
    }

    /// The same of a transition, by rank.
    pub fn transition_chart(&self, rank: u32) -> &str {
        self.chart_name(self.transition_charts.get(rank as usize))
    }

    fn chart_name(&self, chart: Option<&u32>) -> &str {
        chart.and_then(|c| self.chart_names.get(*c as usize)).map_or("", |name| name)
    }

    /// Where a step's name stands.
    pub fn step_place(&self, step: StepId) -> Span {
        self.step_places.get(step.0 as usize).copied().unwrap_or_default()
    }

    /// True if the step is written in the text. A step that stands for a macro-step is not listed
    /// in situations.
    pub fn is_listed(&self, step: StepId) -> bool {
        !self.pseudo.get(step.0 as usize).copied().unwrap_or(true)
    }

    /// Finds a step by its name in traces, by its name with its chart, or by the end of that name
    /// if only one step has it.
    pub fn step(&self, name: &str) -> Option<StepId> {
        let listed = |i: &usize| self.is_listed(StepId(*i as u32));
        let exact = |names: &Names| (0..names.len()).filter(listed).find(|i| names.get(*i) == name);
        let by_end = || {
            let mut ends = (0..self.step_paths.len()).filter(listed).filter(|i| {
                let rest = self.step_paths.get(*i).strip_suffix(name);
                rest.is_some_and(|r| r.ends_with('.'))
            });
            let first = ends.next();
            // Two steps end alike: then the name is ambiguous.
            match (first, ends.next()) {
                (Some(i), None) => Some(i),
                _ => None,
            }
        };
        let i = exact(&self.step_names).or_else(|| exact(&self.step_paths)).or_else(by_end)?;
        Some(StepId(i as u32))
    }

    /// The active steps by name, in the order of the program.
    pub fn situation<'a>(&'a self, state: &'a State) -> impl Iterator<Item = &'a str> {
        state.active().filter(|s| self.is_listed(*s)).map(|s| self.step_name(s))
    }

    /// Number of transitions, those made by the lowering included.
    pub fn transitions(&self) -> u32 {
        self.arrows.len() as u32
    }

    /// A transition's label, by rank.
    pub fn label(&self, rank: u32) -> Option<&str> {
        Some(self.labels.get(rank as usize)).filter(|l| !l.is_empty())
    }

    /// A transition as `1 -> 2`, by rank.
    pub fn transition_text(&self, rank: u32) -> &str {
        self.arrows.get(rank as usize)
    }

    /// Where a transition stands, by rank.
    pub fn transition_place(&self, rank: u32) -> Span {
        self.transition_places.get(rank as usize).copied().unwrap_or_default()
    }

    /// True if a transition is one of the text, by rank. The others take a task
    /// whose caller has gone back to its start.
    pub fn is_written(&self, rank: u32) -> bool {
        !self.hidden.get(rank as usize).copied().unwrap_or(true)
    }

    /// The place in the text behind an instruction.
    pub fn place(&self, at: u32) -> Span {
        self.places.get(at as usize).copied().unwrap_or_default()
    }

    /// A value as one writes it: `TRUE`, `5`, `2.5`, `T#1s500ms`, `'text'`.
    /// `words` are those of one element; of an instance nothing is written.
    pub fn value_text(ty: Type, words: &[u64]) -> String {
        let word = words.first().copied().unwrap_or(0);
        match ty.holds() {
            Some(Holds::Truth) => (if word == 0 { "FALSE" } else { "TRUE" }).into(),
            Some(Holds::Signed) => (word as i64).to_string(),
            Some(Holds::Unsigned) => word.to_string(),
            Some(Holds::Bits) => format!("16#{word:X}"),
            Some(Holds::Real) if ty == Type::Real => format!("{:?}", f32::from_bits(word as u32)),
            Some(Holds::Real) => format!("{:?}", f64::from_bits(word)),
            Some(Holds::Time) => Duration(word as i64).to_string(),
            Some(Holds::Moment(moment)) => moment.literal(Nanos::new(word as i64)),
            Some(Holds::Text) => quoted(words),
            None => String::new(),
        }
    }
}

/// The name of the variable of a step or macro-step, by its name in traces: `X12`, `G.X12`, `XM3`, `Fill.X`.
pub fn activity(name: &str, of_macro: bool) -> String {
    let (before, last) = match name.rsplit_once('.') {
        Some((before, last)) => (format!("{before}."), last),
        None => (String::new(), name),
    };
    let digits = if of_macro { last.strip_prefix('M').unwrap_or(last) } else { last };
    if digits.starts_with(|c: char| c.is_ascii_digit()) {
        format!("{before}X{last}")
    } else {
        format!("{before}{last}.X")
    }
}

/// A STRING's words as a literal (IEC 61131-3:2003, 2.2.2).
fn quoted(words: &[u64]) -> String {
    let len = words.first().map_or(0, |w| usize::try_from(*w).unwrap_or(usize::MAX));
    let bytes: Vec<u8> = words.iter().skip(1).flat_map(|w| w.to_le_bytes()).take(len).collect();
    let mut text = String::from("'");
    for c in String::from_utf8_lossy(&bytes).chars() {
        match c {
            '\'' => text.push_str("$'"),
            '$' => text.push_str("$$"),
            '\n' => text.push_str("$n"),
            '\r' => text.push_str("$r"),
            '\t' => text.push_str("$t"),
            c if (c as u32) < 0x20 => text.push_str(&format!("${:02X}", c as u32)),
            c => text.push(c),
        }
    }
    text.push('\'');
    text
}
