//! A row of the table of words.

/// A short sentence in English, French and Portuguese.
pub type Told = [&'static str; 3];

/// A row of the table: a word at one kind of place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Word {
    /// As written.
    pub text: &'static str,
    /// The text that usually follows, up to the place where the author goes on: ` step` behind `initial`.
    pub then: &'static str,
    /// True if it is never a plain name.
    pub reserved: bool,
    /// True if it may be written in capitals as well: a word of IEC 61131-3.
    pub capitals: bool,
    /// A short sentence on its work.
    pub does: Told,
}

impl Word {
    /// A word that is reserved.
    pub(super) const fn reserved(text: &'static str, does: Told) -> Word {
        Word { text, then: "", reserved: true, capitals: false, does }
    }

    /// A word that is a name elsewhere.
    pub(super) const fn free(text: &'static str, does: Told) -> Word {
        Word { text, then: "", reserved: false, capitals: false, does }
    }

    /// A reserved word of IEC 61131-3.
    pub(super) const fn of_iec(text: &'static str, does: Told) -> Word {
        Word { text, then: "", reserved: true, capitals: true, does }
    }

    /// The same word, with what usually follows.
    pub(super) const fn then(self, then: &'static str) -> Word {
        Word { then, ..self }
    }

    /// The word and what usually follows, as completion offers it.
    pub fn phrase(&self) -> String {
        [self.text, self.then].concat()
    }
}
