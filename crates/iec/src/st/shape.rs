//! The types that a file declares, as they are known while it is read.

use std::collections::HashMap;

use g7_model::{Composed, Expr, Name, Type};

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
