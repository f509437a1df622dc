//! The messages of the page as TypeScript: made of the table of `g7-page`.
#![allow(clippy::disallowed_methods, reason = "the tests read files")]

use g7_tests::house::{ends_in, files, none, read};
use g7_tests::types;

#[test]
fn the_messages_are_up_to_date() {
    let old = (read(types::PATH) != types::text()).then(|| types::PATH.to_owned());
    none(&Vec::from_iter(old), "made of a table that it no longer agrees with (`make types`)");
}

/// A field of a struct with the attributes of both.
#[derive(Debug, Default, PartialEq)]
struct Field {
    of: String,
    own: String,
    line: String,
}

/// The fields of a file.
fn fields(text: &str) -> Vec<Field> {
    let (mut found, mut of, mut own, mut inside) = (Vec::new(), String::new(), String::new(), false);
    for line in text.lines().map(str::trim) {
        if inside || line.starts_with("#[") {
            own.push_str(line);
            inside = !line.ends_with(']');
        } else if ["struct", "enum", "fn"].iter().any(|word| line.split(' ').take(2).any(|w| w == *word)) {
            of = std::mem::take(&mut own);
        } else if !line.starts_with("//") {
            found.push(Field { of: of.clone(), own: std::mem::take(&mut own), line: line.to_owned() });
        }
    }
    found
}

/// True if `serde` and `ts-rs` say the same about a field: it may be missing, or it is always there.
fn agrees(field: &Field) -> bool {
    let (own, of) = (&field.own, &field.of);
    let option = field.line.contains(": Option<");
    let told = own.contains("optional)")
        || (of.contains("optional_fields)") && (option || own.contains("Option<_>")));
    if own.contains("skip_serializing_if") || (of.contains("Serialize") && option) {
        return told == own.contains("skip_serializing_if");
    }
    if of.contains("Deserialize") && option {
        return of.contains("optional_fields = nullable");
    }
    !own.contains("#[serde(default") || option || own.contains("optional)")
}

#[test]
fn fields_that_may_be_missing_say_so_in_both() {
    let sources = ["crates/page/src", "crates/edit/src/gesture.rs"];
    let ours = |f: &std::path::PathBuf| sources.iter().any(|s| f.starts_with(s)) && ends_in(f, &["rs"]);
    let (mut wrong, mut seen) = (Vec::new(), 0);
    for file in files().into_iter().filter(ours) {
        for field in fields(&read(&file)) {
            seen += usize::from(field.own.contains("ts("));
            if !agrees(&field) {
                wrong.push(format!("{}: {}", file.display(), field.line));
            }
        }
    }
    assert!(seen > 30, "only {seen} fields with an attribute of ts-rs");
    none(&wrong, "fields that may be missing for `serde` and not for `ts-rs`, or the other way round");
}

#[test]
fn a_missing_attribute_is_seen() {
    let whole = "#[derive(Debug, Serialize)]\n#[cfg_attr(feature = \"types\", derive(ts_rs::TS), ts(optional_fields))]\n\
        pub(crate) struct A {\n    #[serde(skip_serializing_if = \"Option::is_none\")]\n    a: Option<u32>,\n}\n";
    let all = |text: &str| fields(text).iter().all(agrees);
    assert!(all(whole));
    assert!(!all(&whole.replace("optional_fields", "rename = \"B\"")));
    assert!(!all(&whole.replace("    #[serde(skip_serializing_if = \"Option::is_none\")]\n", "")));
    assert!(!all(&whole.replace("Option<u32>", "Vec<u32>")));
}
