//! The types that `wants` knows without a look at the uses of a name: of declared variables, of literals, of the
//! inputs of standard functions.

use std::collections::BTreeMap;

use g7_compile::resolve::common;
use g7_model::{Document, FbKind, Item, Literal, StandardFunction, Type};

/// The type that has the values of both, or the one that says more where there is none.
pub(super) fn joined(a: Type, b: Type) -> Type {
    common(a, b).unwrap_or(if a.is_integer() { b } else { a })
}

/// The types of the variables that a document declares, by name. Of two with one name it has the first.
pub(super) fn declared(document: &Document) -> BTreeMap<&str, Type> {
    let own = document.items.iter().filter_map(|i| if let Item::Var(v) = i { Some(v) } else { None });
    let of_charts = document.charts().flat_map(|c| c.vars());
    let mut types = BTreeMap::new();
    for v in own.chain(of_charts) {
        if v.of.is_some() {
            continue;
        }
        for name in &v.names {
            types.entry(&*name.text).or_insert(v.ty);
        }
    }
    types
}

/// The type of `.T` and `.X` of a step, and of the members of a standard function block.
pub(super) fn member(of: Option<Type>, name: &str) -> Option<Type> {
    match of {
        Some(Type::Fb(kind)) => FbKind::type_of(kind, name),
        Some(_) => None,
        None => match name {
            "T" => Some(Type::Time),
            "X" | "x" => Some(Type::Bool),
            _ => None,
        },
    }
}

/// The activity of a step by its name, `X12`.
pub(super) fn step(name: &str) -> Option<Type> {
    let number = name.strip_prefix('X')?;
    (!number.is_empty() && number.chars().all(|c| c.is_ascii_digit())).then_some(Type::Bool)
}

pub(super) fn of_literal(literal: &Literal) -> Type {
    match literal {
        Literal::Bool(_) => Type::Bool,
        Literal::Int(_, Some(ty)) | Literal::Real(_, Some(ty)) => *ty,
        Literal::Int(n, None) => {
            let holds = |ty: &Type| ty.bounds().is_some_and(|(least, most)| (least..=most).contains(n));
            [Type::Int, Type::Dint].into_iter().find(holds).unwrap_or(Type::Lint)
        }
        Literal::Real(_, None) => Type::Real,
        Literal::Time(_) => Type::Time,
        Literal::Moment(moment, _) => Type::Moment(*moment),
        Literal::Str(_) => Type::STRING,
    }
}

/// The type of an input of a standard function; `known` is that of its arguments, `want` that of its result.
pub(super) fn of_input(
    f: StandardFunction,
    place: usize,
    known: Option<Type>,
    want: Option<Type>,
) -> Option<Type> {
    match f {
        StandardFunction::Sel if place == 0 => Some(Type::Bool),
        StandardFunction::Mux if place == 0 => Some(Type::Int),
        StandardFunction::Shl | StandardFunction::Shr | StandardFunction::Rol | StandardFunction::Ror => {
            Some(if place == 0 { want.unwrap_or(Type::Word) } else { Type::Int })
        }
        StandardFunction::Len | StandardFunction::Find | StandardFunction::Concat => Some(Type::STRING),
        StandardFunction::Left
        | StandardFunction::Right
        | StandardFunction::Mid
        | StandardFunction::Insert
        | StandardFunction::Delete
        | StandardFunction::Replace => Some(if place == 0 {
            Type::STRING
        } else {
            known.filter(|t| !t.is_integer()).unwrap_or(Type::Int)
        }),
        StandardFunction::Sqrt
        | StandardFunction::Ln
        | StandardFunction::Log
        | StandardFunction::Exp
        | StandardFunction::Sin
        | StandardFunction::Cos
        | StandardFunction::Tan
        | StandardFunction::Asin
        | StandardFunction::Acos
        | StandardFunction::Atan
        | StandardFunction::Trunc => known.or(Some(Type::Real)),
        _ => known.or(want),
    }
}
