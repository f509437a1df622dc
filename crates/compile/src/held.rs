//! The values that a variable of an enumeration or of a type with bounds can have. Whatever shows or sets values reads them
//! in [`crate::symbols`].

use std::collections::HashMap;
use std::sync::Arc;

use g7_model::{Limits, Type, VarDecl};

/// The values of a variable of an integer type with bounds, or of an enumeration.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Held {
    /// Bounds: the least and the greatest value.
    Range(i128, i128),
    /// An enumeration: its name, and each of its values with the number.
    Names(Box<str>, Box<[(Box<str>, i128)]>),
}

impl Held {
    /// True if the number is one of the values. An input of an enumeration can receive others from outside.
    pub fn admits(&self, number: i128) -> bool {
        match self {
            Held::Range(least, most) => (*least..=*most).contains(&number),
            Held::Names(..) => self.name_of(number).is_some(),
        }
    }

    /// The name of a value.
    pub fn name_of(&self, number: i128) -> Option<&str> {
        let Held::Names(_, all) = self else { return None };
        all.iter().find(|(_, n)| *n == number).map(|(name, _)| &**name)
    }

    /// The number of a value.
    pub fn number_of(&self, name: &str) -> Option<i128> {
        let Held::Names(_, all) = self else { return None };
        all.iter().find(|(known, _)| **known == *name).map(|(_, n)| *n)
    }

    /// The type as the text declares it: `INT(0..100)`, `Mode`.
    pub fn declared(&self, ty: Type) -> String {
        match self {
            Held::Range(least, most) => format!("{ty}({least}..{most})"),
            Held::Names(name, _) => name.to_string(),
        }
    }

    /// The type with its values and their numbers, as in `Mode(Off=0,Manual=1)`: if two texts give the same, a number means
    /// the same in both.
    pub fn meaning(&self, ty: Type) -> String {
        match self {
            Held::Range(..) => self.declared(ty),
            Held::Names(name, all) => {
                let values: Vec<String> = all.iter().map(|(value, n)| format!("{value}={n}")).collect();
                format!("{name}({})", values.join(","))
            }
        }
    }

    /// The names of all values, in the order of the text.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        let all: &[(Box<str>, i128)] = match self {
            Held::Names(_, all) => all,
            Held::Range(..) => &[],
        };
        all.iter().map(|(name, _)| &**name)
    }
}

/// The values that the variables of a declaration can have; `enumerations` are those of the document.
pub(crate) fn held(v: &VarDecl, enumerations: &HashMap<&str, Arc<Held>>) -> Option<Arc<Held>> {
    match v.limits.as_deref()? {
        Limits::Of(name) => enumerations.get(&*name.text).cloned(),
        Limits::Range(..) | Limits::Values(_) => {
            v.range().map(|(least, most)| Arc::new(Held::Range(least, most)))
        }
    }
}

/// The name of an enumeration and its values; None for other types.
pub(crate) fn enumeration(t: &VarDecl) -> Option<(&str, Arc<Held>)> {
    let name = t.names.first().filter(|_| !t.values().is_empty())?;
    let numbered = g7_model::named::numbered(t.values()).into_iter();
    let all = numbered.filter_map(|(name, n)| Some((name.text.clone(), n?))).collect();
    Some((&name.text, Arc::new(Held::Names(name.text.clone(), all))))
}
