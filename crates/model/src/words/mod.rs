//! The one table of the words of the .g7 language: where each may stand, whether it is reserved, and what it
//! does, in English, French and Portuguese.
//!
//! The parser in `syntax` reads it to know reserved words and to find the nearest word to a misspelt one;
//! completion shows it; the grammars in `editors/` are generated from it. Qualifiers, types, profiles and
//! functions have tables of their own with a row for each (`Qualifier`, `Type`, `ProfileName`,
//! `StandardFunction`); the words about them stand here, those about profiles beside `ProfileName`. `crates/syntax/tests/all/words.rs` holds the table to
//! the parser. What a word means in full stands in `docs/book/src/language/grammar.md`.

mod begin;
mod go_on;
mod row;
mod values;

pub use begin::{ACTION, BLOCK, CHART, FILE, LAYOUT, PLANT, TEST};
pub use go_on::{CLAUSES, STATEMENT};
pub use row::{Told, Word};
pub use values::{OPERATOR, PART, STEP, TYPE, VALUE, of_qualifier, of_switch, of_type};

use crate::{Language, ProfileName, Qualifier, StandardFunction, Type};

/// The kinds of places, each with its words.
pub const PLACES: [(&str, &[Word]); 14] = [
    ("file", FILE),
    ("chart", CHART),
    ("action", ACTION),
    ("plant", PLANT),
    ("test", TEST),
    ("layout", LAYOUT),
    ("block", BLOCK),
    ("clauses", CLAUSES),
    ("statement", STATEMENT),
    ("operator", OPERATOR),
    ("value", VALUE),
    ("type", TYPE),
    ("step", STEP),
    ("part", PART),
];

/// The words of a list, each once.
pub fn texts(list: &'static [Word]) -> Vec<&'static str> {
    let mut texts: Vec<&str> = list.iter().map(|w| w.text).collect();
    texts.dedup();
    texts
}

/// The rows of a word at all kinds of places, members aside; a word of IEC 61131-3 may stand in capitals.
pub fn rows(word: &str) -> impl Iterator<Item = &'static Word> {
    let lists = PLACES.into_iter().filter(|(place, _)| !matches!(*place, "step" | "part"));
    let all = lists.flat_map(|(_, list)| list.iter());
    all.filter(move |w| w.text == word || w.capitals && w.text.to_ascii_uppercase() == word)
}

/// True if the word is in the list.
pub fn has(list: &[Word], word: &str) -> bool {
    list.iter().any(|w| w.text == word)
}

/// True if an item, an action or a statement of a test can begin with this word.
pub fn begins(word: &str) -> bool {
    [FILE, CHART, ACTION, PLANT, TEST].iter().any(|list| has(list, word)) || Qualifier::named(word).is_some()
}

/// True if the word goes on with an item within its line, and is a name elsewhere.
pub fn goes_on(word: &str) -> bool {
    CLAUSES.iter().any(|w| w.text == word && !w.reserved)
}

/// The reserved words as they may be written, each once, in the order of the alphabet.
pub fn reserved() -> Vec<String> {
    let all = PLACES.iter().flat_map(|(_, list)| list.iter()).filter(|w| w.reserved);
    let mut words: Vec<String> = all.clone().map(|w| w.text.to_owned()).collect();
    words.extend(all.filter(|w| w.capitals).map(|w| w.text.to_ascii_uppercase()));
    words.sort();
    words.dedup();
    words
}

/// The sentence on a word in a language, by the one in English; other texts stay as they are.
pub fn in_language(english: &str, language: Language) -> &str {
    if language == Language::English {
        return english;
    }
    let places = PLACES.into_iter().flat_map(|(_, list)| list.iter().map(|w| w.does));
    let functions = StandardFunction::ALL.into_iter().map(|f| f.row().does);
    let types = Type::names().filter_map(Type::named).map(of_type);
    let qualifiers = Qualifier::ALL.into_iter().map(of_qualifier);
    let profiles = ProfileName::ALL.into_iter().map(ProfileName::does);
    let mut all = places.chain(functions).chain(types).chain(qualifiers).chain(profiles);
    all.find(|told| told[0] == english).map_or(english, |told| language.told(told))
}

#[cfg(test)]
mod tests {
    use super::{PLACES, reserved, rows};

    #[test]
    fn a_word_is_reserved_everywhere_or_nowhere_and_is_told_in_three_languages() {
        let reserved = reserved();
        for (place, list) in PLACES {
            for word in list {
                let text = word.text;
                assert_eq!(word.reserved, reserved.iter().any(|r| r == text), "{place}: {text}");
                for told in word.does {
                    let ends = told.ends_with(['.', ' ']) || told.starts_with(' ') || told.len() < 4;
                    assert!(!ends && told.chars().count() < 90, "{place}: {text}: {told}");
                }
            }
        }
    }

    #[test]
    fn no_word_stands_twice_at_a_place() {
        for (place, list) in PLACES {
            let mut phrases: Vec<String> = list.iter().map(super::Word::phrase).collect();
            phrases.sort();
            let all = phrases.len();
            phrases.dedup();
            assert_eq!(phrases.len(), all, "{place}");
        }
    }

    #[test]
    fn a_word_has_a_row_for_each_of_its_places() {
        let told = |word: &str| rows(word).map(|w| w.does[0]).collect::<Vec<_>>();
        assert_eq!(told("force"), ["a forcing order: holds a chart in a situation", "holds a value"]);
        assert_eq!(told("END_IF"), told("end_if"));
        assert_eq!(told("WHEN"), [""; 0]);
        assert_eq!(told("X"), [""; 0]);
    }
}
