//! The common part of Structured Text, Instruction List and Ladder: the
//! equations of a chart with names, before they are printed in one of them.

use g7_model::Nanos;

/// A value.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Ex {
    Bool(bool),
    Int(i128),
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
        let mut list = Vec::new();
        for part in parts {
            match part {
                Ex::Bool(true) => {}
                Ex::Bool(false) => return part,
                Ex::And(inner) => {
                    for e in inner {
                        if !list.contains(&e) {
                            list.push(e);
                        }
                    }
                }
                other if list.contains(&other) => {}
                other => list.push(other),
            }
        }
        match list.len() {
            0 => Ex::Bool(true),
            1 => list.remove(0),
            _ => Ex::And(list),
        }
    }

    /// Disjunction, short where something is known.
    pub(crate) fn any(parts: impl IntoIterator<Item = Ex>) -> Ex {
        let mut list = Vec::new();
        for part in parts {
            match part {
                Ex::Bool(false) => {}
                Ex::Bool(true) => return part,
                Ex::Or(inner) => {
                    for e in inner {
                        if !list.contains(&e) {
                            list.push(e);
                        }
                    }
                }
                other if list.contains(&other) => {}
                other => list.push(other),
            }
        }
        match list.len() {
            0 => Ex::Bool(false),
            1 => list.remove(0),
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
            Ex::Bool(_) | Ex::Int(_) | Ex::Real(_) | Ex::Time(_) | Ex::Var(_) => {}
            Ex::Index(_, e) | Ex::Not(e) | Ex::Neg(e) => e.walk(f),
            Ex::And(list) | Ex::Or(list) | Ex::Call(_, list) => list.iter().for_each(|e| e.walk(f)),
            Ex::Xor(a, b) | Ex::Op(_, a, b) => {
                a.walk(f);
                b.walk(f);
            }
        }
    }

    /// True if it reads no variable at all.
    fn is_constant(&self) -> bool {
        let mut found = true;
        self.walk(&mut |e| found &= !matches!(e, Ex::Var(_) | Ex::Index(..)));
        found
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

/// The whole of it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Block {
    pub(crate) name: String,
    pub(crate) variables: Vec<Declared>,
    /// The statements of a scan. Where a fault can come, each part runs only
    /// while none has.
    pub(crate) parts: Vec<Vec<St>>,
    /// Safe values of the outputs, where a fault can come.
    pub(crate) safe: Option<Vec<St>>,
}

/// The type of a variable.
pub(crate) fn type_of(variables: &[Declared], name: &str) -> String {
    let name = name.split(['[', '.']).next().unwrap_or(name);
    variables.iter().find(|v| v.name == name).map_or("DINT".into(), |v| v.ty.clone())
}

/// The type of a value.
pub(crate) fn type_name(variables: &[Declared], e: &Ex) -> String {
    match e {
        Ex::Bool(_) | Ex::Not(_) | Ex::And(_) | Ex::Or(_) | Ex::Xor(..) => "BOOL".into(),
        Ex::Op("=" | "<>" | "<" | "<=" | ">" | ">=", ..) => "BOOL".into(),
        Ex::Int(_) => "DINT".into(),
        Ex::Real(_) => "LREAL".into(),
        Ex::Time(_) => "TIME".into(),
        Ex::Var(n) if n.ends_with(".ET") || n.ends_with(".PT") => "TIME".into(),
        Ex::Var(n) if n.ends_with(".CV") || n.ends_with(".PV") => "INT".into(),
        Ex::Var(n) if n.contains('.') => "BOOL".into(),
        Ex::Var(n) | Ex::Index(n, _) => type_of(variables, n),
        Ex::Neg(e) => type_name(variables, e),
        Ex::Op(_, a, b) => type_of_any(variables, [&**a, &**b]),
        Ex::Call(n, args) => match n.split_once("_TO_").or_else(|| n.split_once("_TRUNC_")) {
            Some((_, to)) => to.to_owned(),
            None if n == "TRUNC" => "LINT".into(),
            None => {
                let selects = matches!(n.as_str(), "SEL" | "MUX");
                type_of_any(variables, args.iter().skip(usize::from(selects)))
            }
        },
    }
}

/// The type of several values together: constants take that of the others.
fn type_of_any<'a>(variables: &[Declared], list: impl IntoIterator<Item = &'a Ex>) -> String {
    let mut of_constant = None;
    for e in list {
        let ty = type_name(variables, e);
        // The type of a TIME is written on it.
        if !e.is_constant() || ty == "TIME" {
            return ty;
        }
        of_constant = of_constant.or(Some(ty));
    }
    of_constant.unwrap_or_else(|| "DINT".into())
}

/// The type of a memory for an operand of a value: a constant takes the type that
/// is wanted there.
pub(crate) fn operand_type(variables: &[Declared], of: &Ex, operand: &Ex) -> String {
    let own = type_name(variables, operand);
    if !operand.is_constant() || own == "BOOL" || own == "TIME" {
        return own;
    }
    let wanted = match of {
        Ex::Op(_, a, b) => type_of_any(variables, [&**a, &**b]),
        Ex::Call(n, args) => match n.split_once("_TO_") {
            Some((from, _)) => from.to_owned(),
            None => type_of_any(variables, args.iter().skip(usize::from(n == "SEL" || n == "MUX"))),
        },
        _ => own.clone(),
    };
    // A TIME is multiplied by a number and divided by one.
    if wanted == "TIME" { own } else { wanted }
}

/// A number that was only widened, as it was.
pub(super) fn narrow(e: Ex) -> Ex {
    match e {
        Ex::Call(name, mut args) if name.ends_with("_TO_LINT") && args.len() == 1 => args.remove(0),
        other => other,
    }
}
