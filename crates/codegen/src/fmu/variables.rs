//! The list that a simulator sees of a chart: inputs, outputs, variables, steps and the period of scans, with
//! their places in the C code. Read by `description` and `source`, which number them alike.

use std::collections::HashSet;

use g7_compile::Compiled;
use g7_compile::ir::VarClass;
use g7_compile::symbols;
use g7_engine::{State, StepId};
use g7_model::{Span, Type};

use super::version::Version;
use crate::Places;

/// How the code keeps a value; the names of `fmu_kind` in C.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Bool,
    I8,
    I16,
    I32,
    I64,
    U8,
    U16,
    U32,
    U64,
    F32,
    F64,
    Time,
    /// With the most bytes that it holds.
    Text(u16),
    Step,
    Period,
    Clock,
}

/// The role of a value in a simulation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    Input,
    Output,
    Local,
    /// A step: seen and never set.
    Step,
    /// Set before the simulation begins.
    Parameter,
    /// The time, which FMI 3.0 wants.
    Time,
}

/// A value that a simulator sees. Its reference is its place in the list.
#[derive(Clone, Debug)]
pub(super) struct Variable {
    pub(super) name: String,
    pub(super) description: String,
    pub(super) kind: Kind,
    pub(super) role: Role,
    /// Its field in the state (`inputs.start`), or the number of its step.
    pub(super) place: String,
    /// Its first value, as XML writes it.
    pub(super) start: Option<String>,
    /// Its declaration.
    pub(super) at: Span,
}

/// Names that are given once.
#[derive(Default)]
struct Given(HashSet<String>);

impl Given {
    fn give(&mut self, wanted: &str) -> String {
        let mut name = wanted.to_owned();
        let mut number = 2;
        while !self.0.insert(name.clone()) {
            name = format!("{wanted}_{number}");
            number += 1;
        }
        name
    }
}

/// All of them: those of the chart in the order of their declaration, the steps, the period.
pub(super) fn variables(compiled: &Compiled, places: &Places, version: Version) -> Vec<Variable> {
    let state = State::new(&compiled.program);
    let mut given = Given::default();
    let mut all = Vec::new();
    for v in &compiled.symbols.variables {
        declared(v, &state, places, &mut given, &mut all);
    }
    let symbols = &compiled.symbols;
    for step in (0..symbols.steps()).map(StepId).filter(|s| symbols.is_listed(*s)) {
        all.push(Variable {
            name: given.give(&activity(symbols.step_name(step))),
            description: format!("step {} is active", symbols.step_path(step)),
            kind: Kind::Step,
            role: Role::Step,
            place: step.0.to_string(),
            start: None,
            at: symbols.step_place(step),
        });
    }
    let of_simulator = |name: String, description: &str, kind, role, start| Variable {
        name,
        description: description.to_owned(),
        kind,
        role,
        place: "0".to_owned(),
        start,
        at: Span::default(),
    };
    let period = seconds(symbols.cycle.count().max(1));
    let text = "the time between two scans";
    all.push(of_simulator(given.give("scanPeriod"), text, Kind::Period, Role::Parameter, Some(period)));
    if version == Version::V3 {
        let text = "the time of the simulation";
        all.push(of_simulator(given.give("time"), text, Kind::Clock, Role::Time, None));
    }
    all
}

fn declared(
    v: &symbols::Variable,
    state: &State,
    places: &Places,
    given: &mut Given,
    all: &mut Vec<Variable>,
) {
    let role = match v.class {
        VarClass::Input => Role::Input,
        VarClass::Output => Role::Output,
        VarClass::Internal => Role::Local,
        VarClass::Local | VarClass::Const | VarClass::System => return,
    };
    let (Some(kind), Some(place)) = (kind(v.ty), places.variable(v.addr)) else { return };
    let mut description = v.comment.as_deref().unwrap_or("").trim_matches('"').to_owned();
    if let Some(address) = v.address.as_deref() {
        let gap = if description.is_empty() { "" } else { " " };
        description = format!("{description}{gap}(at {address})");
    }
    let size = (v.words() / v.elements.max(1)).max(1) as usize;
    for (i, words) in v.value(state).chunks(size).enumerate() {
        let at = |whole: &str| if v.elements == 1 { whole.to_owned() } else { format!("{whole}[{i}]") };
        all.push(Variable {
            name: given.give(&at(&v.name)),
            description: description.clone(),
            kind,
            role,
            place: at(place),
            start: Some(value(kind, words)),
            at: v.at,
        });
    }
}

/// The name of a step's variable in the language: `X12`, `G.X12`, `Fill.X`.
fn activity(name: &str) -> String {
    let (before, last) = name.rsplit_once('.').map_or(("", name), |(before, last)| (before, last));
    let dot = if before.is_empty() { "" } else { "." };
    if last.starts_with(|c: char| c.is_ascii_digit()) {
        format!("{before}{dot}X{last}")
    } else {
        format!("{name}.X")
    }
}

fn kind(ty: Type) -> Option<Kind> {
    Some(match ty {
        Type::Bool => Kind::Bool,
        Type::Sint => Kind::I8,
        Type::Int => Kind::I16,
        Type::Dint => Kind::I32,
        Type::Lint => Kind::I64,
        Type::Usint | Type::Byte => Kind::U8,
        Type::Uint | Type::Word => Kind::U16,
        Type::Udint | Type::Dword => Kind::U32,
        Type::Ulint | Type::Lword => Kind::U64,
        Type::Real => Kind::F32,
        Type::Lreal => Kind::F64,
        Type::Time | Type::Moment(_) => Kind::Time,
        Type::String(room) => Kind::Text(room),
        Type::Fb(_) => return None,
    })
}

/// A first value as XML writes it.
fn value(kind: Kind, words: &[u64]) -> String {
    let word = words.first().copied().unwrap_or(0);
    match kind {
        Kind::Bool | Kind::Step => (word != 0).to_string(),
        Kind::I8 | Kind::I16 | Kind::I32 | Kind::I64 => (word as i64).to_string(),
        Kind::U8 | Kind::U16 | Kind::U32 | Kind::U64 => word.to_string(),
        Kind::F32 => {
            real(f64::from(f32::from_bits(word as u32)), &format!("{:?}", f32::from_bits(word as u32)))
        }
        Kind::F64 => real(f64::from_bits(word), &format!("{:?}", f64::from_bits(word))),
        Kind::Time | Kind::Period | Kind::Clock => seconds(word as i64),
        Kind::Text(_) => {
            let bytes: Vec<u8> =
                words.iter().skip(1).flat_map(|w| w.to_le_bytes()).take(word as usize).collect();
            String::from_utf8_lossy(&bytes).into_owned()
        }
    }
}

fn real(value: f64, text: &str) -> String {
    match value {
        v if v.is_nan() => "NaN".to_owned(),
        v if v.is_infinite() => (if v > 0.0 { "INF" } else { "-INF" }).to_owned(),
        _ => text.to_owned(),
    }
}

/// Nanoseconds as seconds, exactly.
pub(super) fn seconds(nanoseconds: i64) -> String {
    let (sign, n) = (if nanoseconds < 0 { "-" } else { "" }, nanoseconds.unsigned_abs());
    let text = format!("{sign}{}.{:09}", n / 1_000_000_000, n % 1_000_000_000);
    let short = text.trim_end_matches('0');
    if short.ends_with('.') { format!("{short}0") } else { short.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seconds_are_exact() {
        let said: Vec<String> =
            [0, 10_000_000, 1_000_000_000, 1_500_000_001, -20_000_000].map(seconds).into();
        assert_eq!(said, ["0.0", "0.01", "1.0", "1.500000001", "-0.02"]);
    }

    #[test]
    fn numbers_without_end_have_words() {
        assert_eq!(value(Kind::F64, &[f64::NEG_INFINITY.to_bits()]), "-INF");
        assert_eq!(value(Kind::F32, &[u64::from(f32::NAN.to_bits())]), "NaN");
        assert_eq!(value(Kind::F32, &[u64::from(0.1f32.to_bits())]), "0.1");
    }

    #[test]
    fn a_name_is_given_once() {
        let mut given = Given::default();
        assert_eq!(
            [given.give("time"), given.give("time"), given.give("time")],
            ["time", "time_2", "time_3"]
        );
    }
}
