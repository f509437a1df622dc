//! Slips in TOML, in words that can be told in each language.
//!
//! It has its sentences in English alone. Those that authors meet most are told by ours; any other is quoted.

use g7_model::{Said, say};

/// The sentence for a place with invalid TOML.
pub(super) fn no_toml(message: &str) -> Said {
    let what = message.split_once(", expected").map_or(message, |(what, _)| what);
    match what {
        "duplicate key" => say!("this key stands here already"),
        "missing value" | "missing value for key" => {
            say!("behind `=` a value is missing")
        }
        "missing assignment between key-value pairs" | "key with no value" => {
            say!("behind a key `=` and a value are missing")
        }
        "extra assignment between key-value pairs" | "extra `=`" => say!("there is a `=` too many"),
        "string values must be quoted" => say!("a text stands in quotes"),
        "invalid unquoted key" => {
            say!("a key with other letters than A-Z, a-z, 0-9, `_` and `-` stands in quotes")
        }
        "missing opening quote" | "invalid basic string" | "invalid literal string" => {
            say!("this text is not closed with its quote on its line")
        }
        "unclosed table" | "unclosed array table" => say!("the head of this table is not closed with `]`"),
        "unclosed array" => say!("this list is not closed with `]`"),
        "unclosed inline table" => say!("this table is not closed with `}}`"),
        "missing comma between array elements" | "missing comma between key-value pairs" => {
            say!("a comma is missing here")
        }
        "extra comma in array" | "extra comma in inline table" => say!("there is a comma too many"),
        "unexpected content" | "unexpected key or value" => say!("nothing more is expected on this line"),
        "unexpected leading zero" | "redundant integer number prefix" => {
            say!("a number does not begin with a zero")
        }
        "integer number overflowed" | "floating-point number overflowed" => say!("this number is too large"),
        _ => say!("this is no TOML: {}", Said::foreign(message)),
    }
}

#[cfg(test)]
mod tests {
    use super::no_toml;
    use g7_model::Language;

    /// The sentence that a text gets.
    fn said(text: &str) -> String {
        let errors = toml::de::DeTable::parse_recoverable(text).1;
        let error = errors.first().unwrap_or_else(|| panic!("{text} is TOML"));
        no_toml(error.message()).in_language(Language::French)
    }

    #[test]
    fn common_slips_are_told_in_our_words() {
        for text in [
            "a = 1\na = 2\n",
            "a =\n",
            "a\n",
            "a = b\n",
            "a = \"b\n",
            "a = [1 2]\n",
            "a = [1\n",
            "a = { b = 1\n",
            "[a\nb = 1\n",
            "a = 1 2\n",
            "a = 01\n",
            "é = 1\n",
        ] {
            let said = said(text);
            assert!(!said.contains("TOML"), "{text}: {said}");
        }
        assert!(no_toml("a new one").contains("no TOML: a new one"));
    }
}
