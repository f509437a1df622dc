//! The common part of Structured Text, Instruction List and Ladder: the
//! equations of a chart with names, before they are printed in one of them.

use g7_model::{Nanos, Said, Type, say};

/// Parts of a conjunction or disjunction that are compared with each other; in a longer one a part
/// may stand twice.
const SHORT: usize = 16;

/// A value.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Ex {
    Bool(bool),
    Int(i128),
    /// A constant bit string of a type.
    Bits(Type, u64),
    Real(f64),
    Time(Nanos),
    Var(String),
    Index(String, Box<Ex>),
    Not(Box<Ex>),
    And(Vec<Ex>),
    Or(Vec<Ex>),
    Xor(Box<Ex>, Box<Ex>),
    /// Arithmetic and comparison, by the sign of Structured Text.
    Op(&'static str, Box<Ex>, Box<Ex>),
    Neg(Box<Ex>),
    Call(String, Vec<Ex>),
}

impl Ex {
    pub(crate) fn var(name: impl Into<String>) -> Ex {
        Ex::Var(name.into())
    }

    pub(crate) fn op(sign: &'static str, a: Ex, b: Ex) -> Ex {
        match (sign, &a, &b) {
            ("+", Ex::Int(x), Ex::Int(y)) => Ex::Int(x + y),
            ("-", Ex::Int(x), Ex::Int(y)) => Ex::Int(x - y),
            // matiec takes 0 and 1 for BOOL, which has no order there.
            ("=", Ex::Int(x), Ex::Int(y)) => Ex::Bool(x == y),
            ("<>", Ex::Int(x), Ex::Int(y)) => Ex::Bool(x != y),
            ("<", Ex::Int(x), Ex::Int(y)) => Ex::Bool(x < y),
            ("<=", Ex::Int(x), Ex::Int(y)) => Ex::Bool(x <= y),
            (">", Ex::Int(x), Ex::Int(y)) => Ex::Bool(x > y),
            (">=", Ex::Int(x), Ex::Int(y)) => Ex::Bool(x >= y),
            // IronPLC has no MAX of times.
            (">=", _, Ex::Call(name, least))
                if name == "MAX" && matches!(least.last(), Some(Ex::Time(_))) =>
            {
                let each = least.iter().map(|least| Ex::op(">=", a.clone(), least.clone()));
                Ex::all(each)
            }
            _ => Ex::Op(sign, Box::new(a), Box::new(b)),
        }
    }

    pub(crate) fn call(name: impl Into<String>, args: Vec<Ex>) -> Ex {
        let name = name.into();
        match (name.as_str(), args.as_slice()) {
            ("MIN", [Ex::Int(x), Ex::Int(y)]) => Ex::Int(*x.min(y)),
            ("MAX", [Ex::Int(x), Ex::Int(y)]) => Ex::Int(*x.max(y)),
            _ => Ex::Call(name, args),
        }
    }

    pub(crate) fn not(self) -> Ex {
        match self {
            Ex::Bool(b) => Ex::Bool(!b),
            Ex::Not(e) => *e,
            Ex::Op("=", a, b) => Ex::Op("<>", a, b),
            Ex::Op("<>", a, b) => Ex::Op("=", a, b),
            other => Ex::Not(Box::new(other)),
        }
    }

    pub(crate) fn and(self, other: Ex) -> Ex {
        Ex::all([self, other])
    }

    pub(crate) fn or(self, other: Ex) -> Ex {
        Ex::any([self, other])
    }

    /// Conjunction, short where something is known.
    pub(crate) fn all(parts: impl IntoIterator<Item = Ex>) -> Ex {
        Ex::list(parts, true)
    }

    /// Disjunction, short where something is known.
    pub(crate) fn any(parts: impl IntoIterator<Item = Ex>) -> Ex {
        Ex::list(parts, false)
    }

    fn list(parts: impl IntoIterator<Item = Ex>, and: bool) -> Ex {
        let mut list = Vec::new();
        let mut add = |e: Ex| {
            if list.len() > SHORT || !list.contains(&e) {
                list.push(e);
            }
        };
        for part in parts {
            match part {
                Ex::Bool(b) if b == and => {}
                Ex::Bool(_) => return part,
                Ex::And(inner) if and => inner.into_iter().for_each(&mut add),
                Ex::Or(inner) if !and => inner.into_iter().for_each(&mut add),
                other => add(other),
            }
        }
        match list.len() {
            0 => Ex::Bool(and),
            1 => list.remove(0),
            _ if and => Ex::And(list),
            _ => Ex::Or(list),
        }
    }

    /// Exclusive disjunction.
    pub(crate) fn xor(self, other: Ex) -> Ex {
        match (self, other) {
            (Ex::Bool(b), e) | (e, Ex::Bool(b)) => {
                if b {
                    e.not()
                } else {
                    e
                }
            }
            (a, b) => Ex::Xor(Box::new(a), Box::new(b)),
        }
    }

    /// Every part, itself included.
    pub(crate) fn walk(&self, f: &mut dyn FnMut(&Ex)) {
        f(self);
        match self {
            Ex::Bool(_) | Ex::Int(_) | Ex::Bits(..) | Ex::Real(_) | Ex::Time(_) | Ex::Var(_) => {}
            Ex::Index(_, e) | Ex::Not(e) | Ex::Neg(e) => e.walk(f),
            Ex::And(list) | Ex::Or(list) | Ex::Call(_, list) => list.iter().for_each(|e| e.walk(f)),
            Ex::Xor(a, b) | Ex::Op(_, a, b) => {
                a.walk(f);
                b.walk(f);
            }
        }
    }

    /// The expressions that it is made of, in their order.
    pub(crate) fn inner_mut(&mut self) -> Vec<&mut Ex> {
        match self {
            Ex::Bool(_) | Ex::Int(_) | Ex::Bits(..) | Ex::Real(_) | Ex::Time(_) | Ex::Var(_) => Vec::new(),
            Ex::Index(_, e) | Ex::Not(e) | Ex::Neg(e) => vec![e],
            Ex::And(list) | Ex::Or(list) | Ex::Call(_, list) => list.iter_mut().collect(),
            Ex::Xor(a, b) | Ex::Op(_, a, b) => vec![a, b],
        }
    }

    /// True if it reads no variable at all.
    pub(crate) fn is_constant(&self) -> bool {
        let mut found = true;
        self.walk(&mut |e| found &= !matches!(e, Ex::Var(_) | Ex::Index(..)));
        found
    }

    /// True for a constant, and for SEL and MUX among constants: such a value has no type of its own, but the type that is
    /// wanted where it stands.
    pub(crate) fn is_open(&self) -> bool {
        match self {
            Ex::Call(n, args) if matches!(n.as_str(), "SEL" | "MUX") => args.iter().skip(1).all(Ex::is_open),
            e => e.is_constant(),
        }
    }

    /// True if working it out can fail or leave the range: it calculates.
    pub(crate) fn calculates(&self) -> bool {
        let mut found = false;
        self.walk(&mut |e| {
            found |= matches!(e, Ex::Op("+" | "-" | "*" | "/" | "MOD", ..) | Ex::Neg(_) | Ex::Call(..));
        });
        found
    }
}

/// A statement.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum St {
    /// The statements that follow belong together.
    Title(String),
    /// A comment to the statement that follows.
    Note(String),
    Assign(Ex, Ex),
    If(Ex, Vec<St>, Vec<St>),
    /// Until EXIT.
    Loop(Vec<St>),
    /// Again and again, until the condition holds behind the statements.
    Until(Vec<St>, Ex),
    Exit,
    /// A function block with its inputs.
    Call(String, Vec<(String, Ex)>),
}

impl St {
    pub(crate) fn set(to: impl Into<String>, value: Ex) -> St {
        St::Assign(Ex::Var(to.into()), value)
    }

    /// IF without ELSE; the statements alone where the condition is known.
    pub(crate) fn when(condition: Ex, then: Vec<St>) -> Vec<St> {
        match condition {
            Ex::Bool(true) => then,
            Ex::Bool(false) => Vec::new(),
            _ if then.is_empty() => Vec::new(),
            c => vec![St::If(c, then, Vec::new())],
        }
    }

    /// A BOOL that comes on or goes off where a condition holds, and stays.
    pub(crate) fn latch(&self) -> Option<(&Ex, &str, bool)> {
        match self {
            St::If(c, then, other) if other.is_empty() => match then.as_slice() {
                [St::Assign(Ex::Var(name), Ex::Bool(on))] => Some((c, name, *on)),
                _ => None,
            },
            _ => None,
        }
    }

    /// Title or comment.
    pub(crate) fn is_remark(&self) -> bool {
        matches!(self, St::Title(_) | St::Note(_))
    }
}

/// Which part of the declarations.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Class {
    Input,
    Output,
    Retain,
    Internal,
}

/// The refusal of a variable whose type a family of controllers lacks, or has otherwise.
pub(crate) fn not_printed(ty: &str, family: &'static str) -> Said {
    say!("a variable of type {}, which is not printed for {}", Said::foreign(ty), Said::foreign(family))
}

/// A declaration.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Declared {
    pub(crate) class: Class,
    pub(crate) name: String,
    pub(crate) ty: String,
    pub(crate) elements: u32,
    pub(crate) init: Vec<Ex>,
    pub(crate) note: String,
}

impl Declared {
    /// The address of one variable in the inputs, outputs or memory of a controller, as `I0.0` or `QW4`, where its
    /// note has one, and the rest of this note.
    pub(crate) fn addressed(&self) -> Option<(String, &str)> {
        let (_, behind) = self.note.split_once("at %")?;
        let (address, note) = behind.split_once(": ").unwrap_or((behind, ""));
        let digits = address.find(|c: char| c.is_ascii_digit())?;
        let (area, place) = address.split_at_checked(digits)?;
        let area = area.to_ascii_uppercase().replace('X', "");
        let mut letters = area.chars();
        let known = letters.next().is_some_and(|c| "IQM".contains(c)) && "BWD".contains(letters.as_str());
        let fits =
            area.len() <= 2 && place.len() <= 7 && place.chars().all(|c| c.is_ascii_digit() || c == '.');
        (known && fits && self.elements == 1).then(|| (format!("{area}{place}"), note))
    }
}

/// The whole of it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Block {
    pub(crate) name: String,
    /// Lines that stand as comments before the block.
    pub(crate) notes: Vec<String>,
    pub(crate) variables: Vec<Declared>,
    /// The statements of a scan. Where a fault can come, each part runs only
    /// while none has.
    pub(crate) parts: Vec<Vec<St>>,
    /// Safe values of the outputs, where a fault can come.
    pub(crate) safe: Option<Vec<St>>,
}

impl Block {
    /// The statements of a scan in their order, each list with the value of the memory `FAULT` for which it runs, if
    /// a fault can come. The safe values, for which it is TRUE, are the last.
    pub(crate) fn guarded(&self) -> impl Iterator<Item = (Option<bool>, &[St])> {
        let parts = self.parts.iter().map(|part| (self.safe.is_some().then_some(false), part.as_slice()));
        let safe = self.safe.iter().filter(|safe| !safe.is_empty());
        parts.chain(safe.map(|safe| (Some(true), safe.as_slice())))
    }
}

/// A number that was only widened, as it was.
pub(super) fn narrow(e: Ex) -> Ex {
    match e {
        Ex::Call(name, mut args) if name.ends_with("_TO_LINT") && args.len() == 1 => args.remove(0),
        other => other,
    }
}
