//! The variables of a function block while it is printed: their types by name, and the memories
//! that a form needs for values that are no operands there.

use std::collections::{HashMap, HashSet};

use super::form::{Class, Declared, Ex};

/// The beginning of the names of these memories.
const MEMORY: &str = "K_";

/// Declarations that are found by name.
#[derive(Debug)]
pub(crate) struct Variables {
    list: Vec<Declared>,
    /// By name: its row of the list.
    rows: HashMap<String, usize>,
    /// The declared names that a memory could have, in capitals.
    taken: HashSet<String>,
    memories: usize,
}

impl Variables {
    pub(crate) fn new(list: Vec<Declared>) -> Variables {
        let rows = list.iter().enumerate().map(|(row, v)| (v.name.clone(), row)).collect();
        let capitals = list.iter().map(|v| v.name.to_ascii_uppercase());
        let taken = capitals.filter(|name| name.starts_with(MEMORY)).collect();
        Variables { list, rows, taken, memories: 0 }
    }

    pub(crate) fn into_list(self) -> Vec<Declared> {
        self.list
    }

    /// Declares a memory and returns its name.
    pub(crate) fn memory(&mut self, ty: &str) -> String {
        let name = loop {
            self.memories += 1;
            let name = format!("{MEMORY}{}", self.memories);
            if !self.taken.contains(&name) {
                break name;
            }
        };
        self.rows.insert(name.clone(), self.list.len());
        self.list.push(Declared {
            class: Class::Internal,
            name: name.clone(),
            ty: ty.to_owned(),
            elements: 1,
            init: Vec::new(),
            note: String::new(),
        });
        name
    }

    /// The type of a variable.
    pub(crate) fn type_of(&self, name: &str) -> &str {
        let name = name.split(['[', '.']).next().unwrap_or(name);
        self.rows.get(name).and_then(|row| self.list.get(*row)).map_or("DINT", |v| &v.ty)
    }

    /// The elements of a variable.
    pub(crate) fn elements(&self, name: &str) -> u32 {
        self.rows.get(name).and_then(|row| self.list.get(*row)).map_or(1, |v| v.elements)
    }

    /// The type of a value.
    pub(crate) fn type_name<'a>(&'a self, e: &'a Ex) -> &'a str {
        match e {
            Ex::Bool(_) | Ex::Not(_) | Ex::And(_) | Ex::Or(_) | Ex::Xor(..) => "BOOL",
            Ex::Op("=" | "<>" | "<" | "<=" | ">" | ">=", ..) => "BOOL",
            Ex::Int(_) => "DINT",
            Ex::Bits(ty, _) => ty.name(),
            Ex::Real(_) => "LREAL",
            Ex::Time(_) => "TIME",
            Ex::Var(n) if n.ends_with(".ET") || n.ends_with(".PT") => "TIME",
            Ex::Var(n) if n.ends_with(".CV") || n.ends_with(".PV") => "INT",
            Ex::Var(n) if n.contains('.') => "BOOL",
            Ex::Var(n) | Ex::Index(n, _) => self.type_of(n),
            Ex::Neg(e) => self.type_name(e),
            Ex::Op(_, a, b) => self.type_of_any([&**a, &**b]),
            Ex::Call(n, args) => match n.split_once("_TO_").or_else(|| n.split_once("_TRUNC_")) {
                Some((_, to)) => to,
                None if n == "TRUNC" => "LINT",
                None => {
                    let selects = matches!(n.as_str(), "SEL" | "MUX");
                    self.type_of_any(args.iter().skip(usize::from(selects)))
                }
            },
        }
    }

    /// The type of several values together: constants take that of the others.
    fn type_of_any<'a>(&'a self, list: impl IntoIterator<Item = &'a Ex>) -> &'a str {
        let mut of_constant = None;
        for e in list {
            let ty = self.type_name(e);
            // The type of a TIME is written on it.
            if !e.is_open() || ty == "TIME" {
                return ty;
            }
            of_constant = of_constant.or(Some(ty));
        }
        of_constant.unwrap_or("DINT")
    }

    /// The type of a memory for an operand of a value: a constant takes the type that
    /// is wanted there.
    pub(crate) fn operand_type<'a>(&'a self, of: &'a Ex, operand: &'a Ex) -> &'a str {
        let own = self.type_name(operand);
        if !operand.is_open() || own == "BOOL" || own == "TIME" {
            return own;
        }
        let wanted = match of {
            Ex::Op(_, a, b) => self.type_of_any([&**a, &**b]),
            Ex::Call(n, args) => match n.split_once("_TO_") {
                Some((from, _)) => from,
                None => self.type_of_any(args.iter().skip(usize::from(n == "SEL" || n == "MUX"))),
            },
            _ => own,
        };
        // A TIME is multiplied by a number and divided by one.
        if wanted == "TIME" { own } else { wanted }
    }
}
