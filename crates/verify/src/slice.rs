//! The words of an image that a question does not depend on, for the searches that put one value in their place.
//!
//! `slices.rs` makes a slice of a question; `world.rs` applies it to each image.

/// The words of an image that are not kept as they are, by their places.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Slice(pub(crate) Vec<(usize, Cut)>);

/// The value of such a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Cut {
    /// It has this value.
    Always(u64),
    /// It has no greater value than this one.
    AtMost(i64),
}

impl Slice {
    /// True if nothing is left out.
    pub(crate) fn is_whole(&self) -> bool {
        self.0.is_empty()
    }

    /// Leaves out of an image of the charts what does not matter.
    pub(crate) fn apply(&self, image: &mut [u64]) {
        for (at, cut) in &self.0 {
            let Some(word) = image.get_mut(*at) else { continue };
            *word = match *cut {
                Cut::Always(v) => v,
                Cut::AtMost(most) => (*word as i64).min(most) as u64,
            };
        }
    }
}
