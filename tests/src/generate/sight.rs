//! The variables of a random document, and random expressions over the names that are visible at a
//! place.

use g7_model::{BinaryOp, Operands, Type};

use super::rng::Rng;

/// The names that an expression may use, and the operations it may contain.
#[derive(Clone, Debug, Default)]
pub(super) struct Sight {
    pub(super) inputs: Vec<String>,
    pub(super) bools: Vec<String>,
    pub(super) ints: Vec<(String, Type)>,
    pub(super) reals: Vec<(String, Type)>,
    pub(super) times: Vec<String>,
    pub(super) strings: Vec<String>,
    /// Step variables.
    pub(super) steps: Vec<String>,
    /// Step times.
    pub(super) step_times: Vec<String>,
    /// User functions: of two INT with an INT result, and of one INT with a BOOL result.
    pub(super) int_functions: Vec<String>,
    pub(super) bool_functions: Vec<String>,
    pub(super) edges: bool,
    pub(super) timers: bool,
    /// True if step times count scans.
    pub(super) scans: bool,
    /// The percentage of operations that may fault.
    pub(super) risk: usize,
    /// True if there are bit strings and bits of numbers.
    pub(super) bits: bool,
}

/// True if the name is an element of an array with a variable index.
pub(super) fn is_chosen(name: &str) -> bool {
    name.contains(" mod ")
}

/// A duration that scans of a few milliseconds can observe.
pub(super) fn duration(rng: &mut Rng) -> String {
    rng.one(["0s", "5ms", "10ms", "20ms", "25ms", "30ms", "50ms", "100ms"]).to_owned()
}

impl Sight {
    /// The same names, for expressions without edges and timers.
    pub(super) fn plain(&self) -> Sight {
        Sight { edges: false, timers: false, ..self.clone() }
    }

    /// The same names, for arithmetic that never faults: for expressions that are evaluated in
    /// every pass.
    fn safe(&self) -> Sight {
        Sight { risk: 0, edges: false, timers: false, ..self.clone() }
    }

    pub(super) fn boolean(&self, rng: &mut Rng, depth: usize) -> String {
        if depth == 0 {
            return self.atom(rng);
        }
        let d = depth - 1;
        match rng.weighted(&[30, 14, 14, 12, 5, 8, 6, 4, 3, 4]) {
            0 => self.atom(rng),
            1 => format!("({} and {})", self.boolean(rng, d), self.boolean(rng, d)),
            2 => format!("({} or {})", self.boolean(rng, d), self.boolean(rng, d)),
            3 => format!("not {}", self.bracketed(rng, d)),
            4 => format!("({} xor {})", self.boolean(rng, d), self.boolean(rng, d)),
            5 => self.edge(rng, d),
            6 => self.timer(rng, d),
            7 => self.comparison(rng, d),
            8 => format!("({} = {})", self.boolean(rng, d), self.boolean(rng, d)),
            _ => format!("({} + {} * {})", self.atom(rng), self.atom(rng), self.atom(rng)),
        }
    }

    fn bracketed(&self, rng: &mut Rng, depth: usize) -> String {
        format!("({})", self.boolean(rng, depth))
    }

    pub(super) fn edge(&self, rng: &mut Rng, depth: usize) -> String {
        if !self.edges {
            return self.atom(rng);
        }
        let inner = match rng.weighted(&[50, 20, 15, 15]) {
            0 => rng.pick(&self.inputs).cloned().unwrap_or_else(|| "TRUE".to_owned()),
            1 => rng.pick(&self.steps).cloned().unwrap_or_else(|| "TRUE".to_owned()),
            2 => self.safe().comparison(rng, depth),
            _ => {
                let mut within = self.safe();
                within.edges = rng.percent(15);
                within.timers = self.timers && rng.percent(30);
                within.boolean(rng, depth)
            }
        };
        match rng.below(4) {
            0 => format!("↓({inner})"),
            1 => format!("fall({inner})"),
            2 => format!("rise({inner})"),
            _ => format!("↑({inner})"),
        }
    }

    pub(super) fn timer(&self, rng: &mut Rng, depth: usize) -> String {
        let step = rng.pick(&self.steps).cloned().unwrap_or_else(|| "TRUE".to_owned());
        if !self.timers {
            return step;
        }
        let t1 = duration(rng);
        let watched = self.safe().boolean(rng, depth.min(1));
        match rng.below(5) {
            0 | 1 if step.starts_with('X') || step.starts_with('G') => format!("{t1}/{step}"),
            2 => format!("{t1}/({watched})/{}", duration(rng)),
            3 => match rng.pick(&self.times) {
                Some(t) => format!("delay({t}, {watched}, {})", duration(rng)),
                None => format!("{t1}/({watched})"),
            },
            _ => format!("{t1}/({watched})"),
        }
    }

    pub(super) fn atom(&self, rng: &mut Rng) -> String {
        if self.bits && rng.percent(6) {
            return self.bit(rng);
        }
        let from = match rng.weighted(&[40, 20, 22, 8, 3]) {
            0 => &self.inputs,
            1 => &self.bools,
            2 => &self.steps,
            3 => return self.comparison(rng, 0),
            _ => return rng.one(["TRUE", "FALSE"]).to_owned(),
        };
        rng.pick(from).or(self.inputs.first()).cloned().unwrap_or_else(|| "FALSE".to_owned())
    }

    /// A bit of a variable that is a whole number; members of blocks have no bits.
    fn bit(&self, rng: &mut Rng) -> String {
        let variables: Vec<&(String, Type)> =
            self.ints.iter().filter(|(n, _)| !n.ends_with(".CV") && !is_chosen(n)).collect();
        let Some((name, ty)) = rng.pick(&variables).copied().cloned() else { return "TRUE".to_owned() };
        let bits = ty.elementary().map_or(8, |row| usize::from(row.bits));
        // The lowest ones change most.
        let most = if rng.percent(75) { 3 } else { bits };
        format!("{name}.{}", rng.below(most))
    }

    /// A whole number from 0 to 127, made of bit strings.
    fn masked(&self, rng: &mut Rng, ty: Type) -> String {
        let Some((name, from)) = rng.pick(&self.ints).cloned() else { return "0".to_owned() };
        let string = rng.one(["BYTE", "WORD", "DWORD", "LWORD"]);
        let bits = format!("{from}_TO_{string}({name})");
        let mask = format!("16#{:X}", rng.below(128));
        let joined = match rng.below(5) {
            0 => format!("{bits} and {mask}"),
            1 => format!("not {bits} and {mask}"),
            2 => format!("({bits} xor 16#55) and {mask}"),
            3 => format!("SHR({bits}, {}) and {mask}", rng.below(6)),
            _ => format!("({bits} or WORD#16#8040) and {string}#{mask}"),
        };
        // A BYTE beside a WORD is a WORD.
        let string = if joined.contains("WORD#16#8040") && string == "BYTE" { "WORD" } else { string };
        format!("{string}_TO_{ty}({joined})")
    }

    pub(super) fn comparison(&self, rng: &mut Rng, depth: usize) -> String {
        let compares = |op: &BinaryOp| op.row().operands == Operands::Comparison;
        let signs: Vec<&str> = BinaryOp::ALL.into_iter().filter(compares).map(|op| op.row().sign).collect();
        let op = rng.pick(&signs).copied().unwrap_or("=");
        match rng.weighted(&[50, 12, 14, 14, 5, 5]) {
            1 if !self.reals.is_empty() => {
                let (name, ty) = rng.pick(&self.reals).cloned().unwrap_or_default_real();
                format!("({name} {op} {})", self.real(rng, ty, 0))
            }
            2 if !self.times.is_empty() => {
                let name = rng.pick(&self.times).cloned().unwrap_or_default();
                format!("({name} {op} {})", duration(rng))
            }
            3 if !self.step_times.is_empty() => {
                let t = rng.pick(&self.step_times).cloned().unwrap_or_default();
                let against = if self.scans { rng.below(5).to_string() } else { duration(rng) };
                format!("({t} {op} {against})")
            }
            4 if !self.strings.is_empty() => {
                let s = rng.pick(&self.strings).cloned().unwrap_or_default();
                format!("({s} {op} {})", self.string(rng))
            }
            5 if !self.bool_functions.is_empty() => {
                let f = rng.pick(&self.bool_functions).cloned().unwrap_or_default();
                format!("{f}({})", self.int(rng, Type::Int, depth.min(1)))
            }
            _ => match rng.pick(&self.ints).cloned() {
                Some((name, ty)) => format!("({name} {op} {})", self.int(rng, ty, depth.min(1))),
                None => "TRUE".to_owned(),
            },
        }
    }

    /// An integer expression whose value fits a variable of this type.
    pub(super) fn int(&self, rng: &mut Rng, ty: Type, depth: usize) -> String {
        let fits: Vec<&String> = self.ints.iter().filter(|(_, t)| widens(*t, ty)).map(|(n, _)| n).collect();
        let small = rng.below(8).to_string();
        let Some(name) = rng.pick(&fits).map(|n| (*n).clone()) else { return small };
        if depth == 0 {
            return if rng.percent(65) { name } else { small };
        }
        let d = depth - 1;
        if rng.percent(self.risk) {
            return match rng.below(5) {
                // A divisor that may be zero but is not written as zero.
                0 => format!("({small} / {name})"),
                1 => format!("({small} mod ({name} - 1))"),
                2 => format!("({name} * {})", self.int(rng, ty, d)),
                3 => format!("({name} - {})", self.int(rng, ty, d)),
                _ => format!("({name} + {})", self.int(rng, ty, d)),
            };
        }
        if self.bits && rng.percent(20) {
            return self.masked(rng, ty);
        }
        match rng.below(9) {
            0 => name,
            1 => format!("({name} mod 7)"),
            2 => format!("MIN({name}, {small})"),
            3 => format!("MAX({name}, {small}, {})", self.int(rng, ty, 0)),
            4 => format!("LIMIT(0, {name}, 9)"),
            5 => format!("SEL({}, {name}, {})", self.safe().boolean(rng, 0), self.int(rng, ty, 0)),
            6 => format!("(({name} mod 5) + {small})"),
            7 if ty == Type::Int && !self.int_functions.is_empty() => {
                let f = rng.pick(&self.int_functions).cloned().unwrap_or_default();
                format!("{f}({name} mod 9, {small})")
            }
            8 if ty == Type::Int && !self.strings.is_empty() && rng.percent(20) => {
                let s = rng.pick(&self.strings).cloned().unwrap_or_default();
                rng.one([0, 1]).eq(&0).then(|| format!("LEN({s})")).unwrap_or(format!("FIND({s}, 'b')"))
            }
            _ => format!("({name} / 2)"),
        }
    }

    pub(super) fn real(&self, rng: &mut Rng, ty: Type, depth: usize) -> String {
        let fits: Vec<&String> =
            self.reals.iter().filter(|(_, t)| *t == ty || *t == Type::Real).map(|(n, _)| n).collect();
        let number = rng.one(["0.5", "1.25", "2.0", "10.0", "0.1"]).to_owned();
        let Some(name) = rng.pick(&fits).map(|n| (*n).clone()) else { return number };
        if depth == 0 {
            return if rng.percent(50) { name } else { number };
        }
        match rng.below(7) {
            0 => format!("({name} * 0.5 + {number})"),
            1 => format!("ABS({name} - {number})"),
            2 => format!("SQRT(ABS({name}))"),
            3 => format!("LIMIT(-10.0, {name}, 10.0)"),
            4 if self.risk > 0 => format!("({number} / {name})"),
            5 => match rng.pick(&self.ints).cloned() {
                Some((n, t)) if ty == Type::Real && t == Type::Int => format!("INT_TO_REAL({n} mod 20)"),
                _ => format!("({name} - {number})"),
            },
            _ => format!("MAX({name}, {number})"),
        }
    }

    pub(super) fn time(&self, rng: &mut Rng) -> String {
        let t = duration(rng);
        match (rng.pick(&self.times).cloned(), rng.below(6)) {
            (Some(name), 0) => format!("({name} + {t})"),
            (Some(name), 1) => format!("MIN({name} * 2, 200ms)"),
            (Some(name), 2) => format!("({name} / 2)"),
            (Some(name), 3) => format!("(MAX({name}, 5ms) - 5ms)"),
            _ => t,
        }
    }

    pub(super) fn string(&self, rng: &mut Rng) -> String {
        let text = rng.one(["'ab'", "'b'", "'xyz'", "''"]).to_owned();
        match (rng.pick(&self.strings).cloned(), rng.below(6)) {
            (Some(s), 0) => format!("CONCAT(LEFT({s}, 6), {text})"),
            (Some(s), 1) => format!("RIGHT({s}, 3)"),
            (Some(s), 2) => format!("MID(CONCAT({s}, 'pqr'), 2, 1)"),
            (Some(s), 3) => format!("INSERT(LEFT({s}, 4), {text}, 0)"),
            (Some(s), 4) => format!("REPLACE(CONCAT(LEFT({s}, 4), 'mn'), {text}, 1, 1)"),
            _ => text,
        }
    }
}

/// A default for an empty list.
trait OrReal {
    fn unwrap_or_default_real(self) -> (String, Type);
}

impl OrReal for Option<(String, Type)> {
    fn unwrap_or_default_real(self) -> (String, Type) {
        self.unwrap_or(("0.0".to_owned(), Type::Real))
    }
}

/// True if one integer type widens to another.
pub(super) fn widens(from: Type, to: Type) -> bool {
    match (from.bounds(), to.bounds()) {
        (Some((l, h)), Some((tl, th))) => tl <= l && h <= th,
        _ => false,
    }
}
