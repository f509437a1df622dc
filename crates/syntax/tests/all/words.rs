//! Compares the table of words with the parser: the parser accepts each word of the table at its place, and the
//! table has each word that the parser looks for.
#![allow(clippy::disallowed_methods, reason = "the test reads the sources of the parser")]

use std::path::Path;

use g7_iec::il;
use g7_model::words::{self, PLACES};
use g7_model::{FileId, ProfileName, Qualifier, TargetPlc, Type, codes};
use g7_syntax::{SWITCHES, parse};

/// A text with `§` where a word of this place begins an item.
const FRAMES: &[(&str, &str)] = &[
    ("file", "§ x\n"),
    ("chart", "chart A {\n  § x\n}\n"),
    ("action", "chart A {\n  step 1 {\n    § x\n  }\n}\n"),
    ("plant", "plant P {\n  § x\n}\n"),
    ("test", "test \"t\" {\n  § x\n}\n"),
];

/// True if the word is told to be none of the language, or no beginning, at its place.
fn refused(frame: &str, word: &str) -> bool {
    let text = frame.replace('§', word);
    let at = frame.find('§').unwrap_or(0) as u32;
    let (_, problems) = parse(&text, FileId(0));
    problems.iter().any(|p| {
        let begins = p.at.start == at && !p.what.contains("belongs to");
        begins && (p.code.id == codes::UNKNOWN_WORD.id || p.what.contains("expected a"))
            || p.at.start == at && p.what.contains("begins with")
    })
}

#[test]
fn each_word_of_the_table_is_accepted_where_something_begins() {
    for (place, frame) in FRAMES {
        let (_, list) = PLACES.iter().find(|(name, _)| name == place).expect("a place");
        for word in *list {
            assert!(!refused(frame, word.text), "{place}: `{}`", word.text);
        }
        for wrong in ["zzyzx", "hovercraft"] {
            assert!(refused(frame, wrong) || *place == "chart", "{place}: `{wrong}` is accepted");
        }
    }
}

/// Every word in double quotes that the code compares a word of the text with.
fn asked_for(code: &str) -> Vec<String> {
    let mut found = Vec::new();
    for line in code.lines().map(str::trim) {
        if line.starts_with("//") {
            continue;
        }
        let arm = line.starts_with('"') && line.contains("=>") || line.starts_with("| \"");
        let compared =
            ["at_word(", "eat_word(", "peek_word(", "at_two_words(", "matches!(word", "self.word(), \""]
                .iter()
                .any(|call| line.contains(call));
        if !arm && !compared {
            continue;
        }
        // Of an arm, only what stands before the arrow.
        let part = if arm { line.split("=>").next().unwrap_or("") } else { line };
        found.extend(part.split('"').skip(1).step_by(2).map(str::to_owned));
    }
    found.retain(|w| !w.is_empty() && w.chars().all(|c| c.is_ascii_alphanumeric() || c == '_'));
    found
}

fn is_known(word: &str) -> bool {
    let listed = PLACES.iter().any(|(_, list)| {
        list.iter().any(|w| w.text == word || w.capitals && w.text.to_ascii_uppercase() == word)
    });
    listed
        || Qualifier::named(word).is_some()
        || Type::named(word).is_some()
        || SWITCHES.iter().any(|(name, _)| *name == word)
        || ProfileName::ALL.iter().any(|p| p.name() == word)
        || TargetPlc::ALL.iter().any(|t| t.name() == word)
        || il::mnemonic(word).is_some()
}

/// Words of other languages. The parser knows them only to suggest the right word.
const OF_OTHERS: &[&str] = &[
    "BIT",
    "BOOLEAN",
    "CHAR",
    "DOUBLE",
    "FLOAT",
    "INTEGER",
    "LONG",
    "SHORT",
    "TEXT",
    "VAR",
    "VAR_EXTERNAL",
    "VAR_GLOBAL",
    "VAR_INPUT",
    "VAR_IN_OUT",
    "VAR_OUTPUT",
    "VAR_TEMP",
    "WSTRING",
    "assert",
    "check",
    "verify",
];

#[test]
fn each_word_that_the_parser_asks_for_is_in_the_table() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let parts = std::fs::read_dir(folder.join("parse")).expect("the parser");
    let mut files: Vec<_> = parts.map(|f| f.expect("a file").path()).collect();
    files.push(folder.join("words.rs"));
    let (mut seen, mut unknown) = (0, Vec::new());
    for file in files {
        let code = std::fs::read_to_string(&file).expect("a source");
        for word in asked_for(&code) {
            seen += 1;
            if !is_known(&word) && !OF_OTHERS.contains(&&*word) {
                unknown.push(word);
            }
        }
    }
    unknown.sort();
    assert_eq!(unknown, [""; 0], "asked for by the parser, and not in the table of g7_model::words");
    assert!(seen > 100, "only {seen} words found: the test no longer reads the parser");
}

#[test]
fn reserved_words_are_those_of_the_table_and_no_others() {
    let reserved = words::reserved();
    assert!(reserved.len() > 70, "{}", reserved.len());
    for word in &reserved {
        assert!(g7_syntax::is_reserved(word), "{word}");
        let (_, problems) = parse(&format!("var {word} : INT\n"), FileId(0));
        assert!(!problems.is_empty(), "`{word}` is reserved, and yet a name");
    }
    for (_, list) in PLACES {
        for word in list.iter().filter(|w| !w.reserved) {
            assert!(!g7_syntax::is_reserved(word.text), "{}", word.text);
            let (_, problems) = parse(&format!("var {} : INT\n", word.text), FileId(0));
            assert_eq!(problems, [], "`{}` is a name there", word.text);
        }
    }
}
