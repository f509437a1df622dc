//! The types that a file declares, as they are known while it is read.

use std::collections::HashMap;

use g7_model::{Composed, Expr, Name, Problem, Said, Type, codes, say};

use crate::report::Report;

/// The most dimensions of an array.
const MOST_DIMENSIONS: usize = 16;

/// The form of a type.
#[derive(Clone, Debug)]
pub(crate) enum Shape {
    Simple(Type, Option<Expr>),
    /// A subrange: its type, its least and greatest value, and its initial value.
    Range(Type, Box<(Expr, Expr)>, Option<Expr>),
    /// Its values with their numbers, and its initial value.
    Enum(Vec<(Name, i128)>, Option<Expr>),
    /// A structure of the file.
    Struct(Name),
    /// The bounds of each dimension, and the type of the elements, which is no array.
    Array(Vec<(Expr, Expr)>, Box<Shape>),
    /// An unknown function block or type.
    Unknown(Name),
}

impl Shape {
    /// An array. An array of arrays is one with more dimensions: `a[1][2]` is `a[1, 2]`. The type of the elements alone if
    /// it has no dimension or too many.
    pub(crate) fn array(mut bounds: Vec<(Expr, Expr)>, element: Shape) -> Result<Shape, Shape> {
        let element = match element {
            Shape::Array(inner, element) => {
                bounds.extend(inner);
                element
            }
            element => Box::new(element),
        };
        if bounds.is_empty() || bounds.len() > MOST_DIMENSIONS {
            return Err(*element);
        }
        Ok(Shape::Array(bounds, element))
    }

    /// The type of the elements of an array; of anything else, that itself.
    pub(crate) fn element(&self) -> &Shape {
        match self {
            Shape::Array(_, element) => element,
            other => other,
        }
    }

    /// The name of the type, of an array that of its elements, if the file has not declared it before.
    pub(crate) fn unknown(&self) -> Option<&Name> {
        match self.element() {
            Shape::Unknown(of) => Some(of),
            _ => None,
        }
    }
}

/// Told of an array that [`Shape::array`] refuses.
pub(crate) fn no_array() -> Said {
    say!("an array has 1 to {MOST_DIMENSIONS} dimensions")
}

/// An enumeration. A value without a number has the next one (IEC 61131-3:2013, 6.4.4.4).
pub(crate) fn enumeration(values: Vec<(Name, Option<Expr>)>, report: &mut Report) -> Shape {
    let (mut numbered, mut number) = (Vec::new(), 0);
    for (name, written) in values {
        if let Some(written) = written {
            match written.kind.whole() {
                Some(n) => number = n,
                None => {
                    let what = say!("the number of an enumeration's value is written as a number");
                    report.put(Problem::new(&codes::NOT_CARRIED, written.at.0, what));
                }
            }
        }
        numbered.push((name, number));
        number = number.saturating_add(1);
    }
    Shape::Enum(numbered, None)
}

/// The types that a file declares, by their names in upper case.
#[derive(Clone, Debug, Default)]
pub(crate) struct Types {
    shapes: HashMap<String, Shape>,
    /// The values of all enumerations, with their numbers.
    pub(crate) values: Vec<(Name, i128)>,
    /// The structures, in the order of the text.
    pub(crate) structures: Vec<Composed>,
}

impl Types {
    /// Adds a type, and its values if it is an enumeration.
    pub(crate) fn add(&mut self, name: &Name, shape: Shape) {
        if let Shape::Enum(values, _) = &shape {
            self.values.extend(values.iter().cloned());
        }
        self.shapes.insert(name.text.to_ascii_uppercase(), shape);
    }

    pub(crate) fn get(&self, name: &str) -> Option<&Shape> {
        self.shapes.get(&name.to_ascii_uppercase())
    }

    /// A name for the structure of a variable that has no type with a name.
    pub(crate) fn free(&self, variable: &Name) -> Name {
        let mut text = format!("{}_type", variable.text);
        while self.get(&text).is_some() {
            text.push('_');
        }
        Name::new(text, variable.at.0)
    }
}
