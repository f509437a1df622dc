//! The types of expressions, as far as the tree tells them; used by [`crate::c`].

use std::collections::HashMap;

use crate::tree::{Bin, Expr, Function, Module, Struct, Ty};

/// The names of a module and of the function at hand.
pub(crate) struct Types<'a> {
    structs: HashMap<&'a str, &'a Struct>,
    functions: HashMap<&'a str, &'a Function>,
    /// Types of the names in the function at hand.
    pub(crate) scope: HashMap<String, Ty>,
}

impl<'a> Types<'a> {
    pub(crate) fn new(module: &'a Module) -> Types<'a> {
        Types {
            structs: module.structs.iter().map(|s| (s.name.as_str(), s)).collect(),
            functions: module.functions.iter().map(|f| (f.name.as_str(), f)).collect(),
            scope: HashMap::new(),
        }
    }

    pub(crate) fn function(&self, name: &str) -> Option<&'a Function> {
        self.functions.get(name).copied()
    }

    /// The type of a place, as far as the tree tells it.
    pub(crate) fn of(&self, e: &Expr) -> Option<Ty> {
        match e {
            Expr::Name(n) => self.scope.get(n).cloned(),
            Expr::Field(of, name) => {
                let of = match self.of(of)? {
                    Ty::Named(n) => n,
                    Ty::Ref(_, inner) => match *inner {
                        Ty::Named(n) => n,
                        _ => return None,
                    },
                    _ => return None,
                };
                self.structs.get(of.as_str())?.fields.iter().find(|f| f.name == *name).map(|f| f.ty.clone())
            }
            Expr::Index(of, _) => match self.of(of)? {
                Ty::Array(of, _) | Ty::Slice(_, of) => Some(*of),
                _ => None,
            },
            Expr::Deref(of) => match self.of(of)? {
                Ty::Ref(_, of) => Some(*of),
                _ => None,
            },
            _ => None,
        }
    }

    /// The type of a value, as far as the tree tells it.
    pub(crate) fn of_value(&self, e: &Expr) -> Option<Ty> {
        match e {
            Expr::Cast(_, ty) | Expr::Int(_, Some(ty)) => Some(ty.clone()),
            Expr::Call(f, _) if f != "inv" => self.functions.get(f.as_str())?.result.clone(),
            Expr::Bin(Bin::BitAnd | Bin::BitOr | Bin::BitXor, a, b) => {
                self.of_value(a).or_else(|| self.of_value(b))
            }
            Expr::Bin(Bin::Add | Bin::Sub, a, b) => {
                let wide = |ty: &Ty| matches!(ty, Ty::Size | Ty::Int { bits: 32 | 64, .. });
                self.of_value(a).or_else(|| self.of_value(b)).filter(wide)
            }
            Expr::Bin(Bin::Shl | Bin::Shr, a, _) => {
                self.of_value(a).filter(|ty| matches!(ty, Ty::Size | Ty::Int { bits: 32 | 64, .. }))
            }
            place => self.of(place),
        }
    }
}
