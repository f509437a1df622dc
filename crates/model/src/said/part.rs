//! What fills a hole of a text.

use super::Said;
use crate::{FbKind, Language, Nanos, ProfileName, Qualifier, Type};

/// What fills a hole.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Part {
    /// A name, a number, a piece of somebody's text: the same in each language.
    Raw(String),
    /// A text with a row of its own.
    Said(Said),
}

impl Part {
    /// What stands in back-ticks.
    pub fn raw(shown: &impl ToString) -> Part {
        Part::Raw(shown.to_string())
    }

    /// What stands among the words.
    pub fn spoken(part: &impl Spoken) -> Part {
        part.part()
    }

    pub(super) fn in_language(&self, language: Language) -> String {
        match self {
            Part::Raw(text) => text.clone(),
            Part::Said(said) => said.in_language(language),
        }
    }
}

/// What may stand among the words of a text. A `str` may not: it would stay English.
pub trait Spoken {
    /// The part that it is.
    fn part(&self) -> Part;
}

impl Spoken for Said {
    fn part(&self) -> Part {
        Part::Said(self.clone())
    }
}

impl<T: Spoken + ?Sized> Spoken for &T {
    fn part(&self) -> Part {
        (**self).part()
    }
}

macro_rules! spoken_as_shown {
    ($($ty:ty)*) => {$(
        impl Spoken for $ty {
            fn part(&self) -> Part {
                Part::Raw(self.to_string())
            }
        }
    )*};
}

spoken_as_shown! { u8 u16 u32 u64 u128 usize i8 i16 i32 i64 i128 isize f32 f64 Nanos Type }

macro_rules! spoken_by_name {
    ($($ty:ty)*) => {$(
        impl Spoken for $ty {
            fn part(&self) -> Part {
                Part::Raw(self.name().to_owned())
            }
        }
    )*};
}

spoken_by_name! { FbKind ProfileName Qualifier }
