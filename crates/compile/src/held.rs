//! The values of a variable, where they are less than all of its type: known to all that show and set values.

use std::collections::HashMap;
use std::sync::Arc;

use g7_model::{Limits, Type, VarDecl};

/// The values of a variable of an integer type with bounds, or of an enumeration.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Held {
    /// The least and the greatest one.
    Range(i128, i128),
    /// The name of the enumeration, and each value with its number.
    Names(Box<str>, Box<[(Box<str>, i128)]>),
}

impl Held {
    /// True if the number is one of the values. An input of an enumeration can have others: they come from outside.
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

    /// The type with all that its values mean, to be compared with that of another text: `Mode(Off=0,Manual=1)`.
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

/// The values of the variables of a declaration, among the enumerations of a document.
pub(crate) fn held(v: &VarDecl, enumerations: &HashMap<&str, Arc<Held>>) -> Option<Arc<Held>> {
    match v.limits.as_deref()? {
        Limits::Range(least, most) => Some(Arc::new(Held::Range(least.kind.whole()?, most.kind.whole()?))),
        Limits::Of(name) => enumerations.get(&*name.text).cloned(),
        Limits::Values(_) => None,
    }
}

/// The values of an enumeration, by its name.
pub(crate) fn enumeration(t: &VarDecl) -> Option<(&str, Arc<Held>)> {
    let (name, Limits::Values(values)) = (t.names.first()?, t.limits.as_deref()?) else { return None };
    let numbered = g7_model::named::numbered(values).into_iter();
    let all = numbered.filter_map(|(name, n)| Some((name.text.clone(), n?))).collect();
    Some((&name.text, Arc::new(Held::Names(name.text.clone(), all))))
}
