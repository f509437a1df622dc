//! The types that a file declares, as they are known while it is read.

use std::collections::HashMap;
use std::rc::Rc;

use g7_model::named::numbered;
use g7_model::{
    Composed, Expr, ExprKind, Limits, Name, Path, Problem, Said, Type, VarDecl, VarKind, codes, say,
};

use crate::nodes;
use crate::report::Report;

/// The most dimensions of an array.
const MOST_DIMENSIONS: usize = 16;

/// The form of a type.
#[derive(Clone, Debug)]
pub(crate) enum Shape {
    Simple(Type, Option<Expr>),
    /// A subrange: its type, its least and greatest value, and its initial value.
    Range(Type, Box<(Expr, Expr)>, Option<Expr>),
    /// An enumeration of the file, and its initial value.
    Enum(Rc<Enumeration>, Option<Expr>),
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

/// The values of an enumeration, each with the number that is written behind it.
pub(crate) type Values = Vec<(Name, Option<Expr>)>;

/// An enumeration, as far as declarations of its variables need it.
#[derive(Clone, Debug)]
pub(crate) struct Enumeration {
    pub(crate) name: Name,
    /// The type of its numbers.
    pub(crate) ty: Type,
    /// The names of its values.
    values: Vec<Name>,
    /// The number of the first value.
    pub(crate) least: Option<i128>,
}

impl Enumeration {
    /// `Mode#Auto`, one name in all passes up to `settle` and `enumerations`: whatever else is called
    /// `Auto`, this is the value.
    fn value(&self, value: &Name) -> Expr {
        typed(&self.name.text, value)
    }

    /// The value of a variable without an initial value.
    pub(crate) fn first(&self) -> Option<Expr> {
        self.values.first().map(|first| self.value(first))
    }

    /// An initial value; the bare name of a value gets that of the type.
    pub(crate) fn initial(&self, mut e: Expr) -> Expr {
        match &mut e.kind {
            ExprKind::List(values) => {
                for (_, value) in values {
                    *value = self.initial(std::mem::replace(value, nodes::bad(e.at.0)));
                }
            }
            ExprKind::Path(path) => {
                let [name] = path.names.as_slice() else { return e };
                let own = self.values.iter().find(|v| v.text.eq_ignore_ascii_case(&name.text));
                if let Some(own) = own {
                    return self.value(&Name::new(own.text.clone(), name.at.0));
                }
            }
            _ => {}
        }
        e
    }
}

/// `Mode#Auto`.
pub(crate) fn typed(of: &str, value: &Name) -> Expr {
    let names = vec![Name { text: format!("{of}#{}", value.text).into(), at: value.at }];
    Expr { kind: ExprKind::Path(Path { names }), at: value.at }
}

/// The types that a file declares, by their names in upper case.
#[derive(Clone, Debug, Default)]
pub(crate) struct Types {
    shapes: HashMap<String, Shape>,
    /// The type that is being declared.
    pub(crate) declaring: Option<Name>,
    /// The enumerations, in the order of the text.
    pub(crate) enumerations: Vec<VarDecl>,
    /// The structures, in the order of the text.
    pub(crate) structures: Vec<Composed>,
}

impl Types {
    /// Adds a type.
    pub(crate) fn add(&mut self, name: &Name, shape: Shape) {
        if let Shape::Enum(own, Some(init)) = &shape
            && own.name == *name
            && let Some(decl) = self.enumerations.iter_mut().rfind(|t| t.names.first() == Some(name))
        {
            decl.init = Some(init.clone());
        }
        self.shapes.insert(name.text.to_ascii_uppercase(), shape);
    }

    /// Declares an enumeration whose numbers have a type. It stands in the declaration of the type or variable `of`.
    pub(crate) fn enumeration(
        &mut self,
        of: &Name,
        ty: Type,
        mut values: Values,
        report: &mut Report,
    ) -> Shape {
        for (_, number) in &mut values {
            let Some(written) = number else { continue };
            let at = written.at.0;
            *number = written.kind.whole().map(|n| nodes::int(n, at));
            if number.is_none() {
                let what = say!("the number of an enumeration's value is written as a number");
                report.put(Problem::new(&codes::NOT_CARRIED, at, what));
            }
        }
        let own = self.declaring.as_ref() == Some(of);
        let name = if own { of.clone() } else { self.free(of) };
        let same = |t: &VarDecl| t.names.iter().any(|n| n.text.eq_ignore_ascii_case(&name.text));
        if self.enumerations.iter().any(same) {
            let what = say!("`{}` is declared twice", name.text);
            report.put(Problem::new(&codes::TWICE, name.at.0, what));
        }
        let least = numbered(&values).first().and_then(|(_, number)| *number);
        let names = values.iter().map(|(name, _)| name.clone()).collect();
        let shape = Shape::Enum(Rc::new(Enumeration { name: name.clone(), ty, values: names, least }), None);
        let limits = Some(Box::new(Limits::Values(values)));
        let decl = VarDecl { limits, ..VarDecl::new(VarKind::Var, vec![name.clone()], ty, name.at) };
        self.enumerations.push(decl);
        if !own {
            self.add(&name, shape.clone());
        }
        shape
    }

    pub(crate) fn get(&self, name: &str) -> Option<&Shape> {
        self.shapes.get(&name.to_ascii_uppercase())
    }

    /// A name for the structure or enumeration of a variable that has no type with a name.
    pub(crate) fn free(&self, variable: &Name) -> Name {
        let mut text = format!("{}_type", variable.text);
        while self.get(&text).is_some() {
            text.push('_');
        }
        Name::new(text, variable.at.0)
    }
}
