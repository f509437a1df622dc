//! Definitions, and the places where they are named.
//!
//! `resolve::trace` gives a definition for each name, `walk` the place and the way of writing.

use g7_model::{Name, Span};

/// Something that has a name.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Definition {
    /// A chart, expansion or task.
    Chart(String),
    /// A step or macro-step.
    Step {
        /// Its chart.
        chart: String,
        /// Its name.
        name: String,
    },
    /// A variable or constant.
    Variable {
        /// Its chart; `None` for one of the file.
        chart: Option<String>,
        /// Its name.
        name: String,
    },
    /// A named action.
    Action {
        /// Its chart; `None` for one of the file.
        chart: Option<String>,
        /// Its name.
        name: String,
    },
    /// A transition section.
    Section {
        /// Its chart; `None` for one of the file.
        chart: Option<String>,
        /// Its name.
        name: String,
    },
    /// A function.
    Function(String),
    /// A type that the file declares.
    Type(String),
    /// A value of an enumeration.
    Value {
        /// The enumeration.
        of: String,
        /// Its name.
        name: String,
    },
    /// A member, a parameter or a variable of one.
    Member {
        /// The structure or function block.
        of: String,
        /// Its name.
        name: String,
    },
    /// A transition with a label.
    Transition {
        /// Its chart.
        chart: String,
        /// Its label.
        label: String,
    },
    /// A plant.
    Plant(String),
    /// A constant, state or queue of a plant.
    PlantItem {
        /// The plant.
        plant: String,
        /// Its name.
        name: String,
    },
}

impl Definition {
    /// The value `name` of the enumeration `of`.
    pub(super) fn value(of: &Name, name: &Name) -> Definition {
        Definition::Value { of: of.text.to_string(), name: name.text.to_string() }
    }
}

/// How a name is written at a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Written {
    /// Where it is declared.
    Declared,
    /// Alone, where only a name is allowed.
    Name,
    /// In a list of steps, where words of the language are allowed too.
    Step,
    /// In a path.
    Path {
        /// At its beginning.
        first: bool,
        /// Without anything before or after it.
        only: bool,
    },
    /// Within a direct name, `%X12`.
    Direct,
}

/// One place where a name stands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Use {
    /// The whole word, with back-ticks and with the `X` of `X12`.
    pub at: Span,
    /// The definition that it refers to.
    pub definition: Definition,
    /// How it is written.
    pub written: Written,
    /// Letters before the name itself: 1 in `X12`, 2 in `XM3` of macro-step `3`.
    pub before: usize,
}

/// A name in the text that refers to nothing in the document.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unknown {
    /// The whole word.
    pub at: Span,
    /// The chart whose step it names, if it can only name a step of that chart.
    pub step_of: Option<String>,
}
