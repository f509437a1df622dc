//! The parts that may stand among the words of a text.

use super::{Part, Said};
use crate::{FbKind, Nanos, ProfileName, Qualifier, Type};

impl Part {
    /// A part that stands among the words.
    pub fn spoken(part: &impl Spoken) -> Part {
        part.part()
    }
}

/// A part that may stand among the words of a text. A `str` may not: it would stay English.
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
