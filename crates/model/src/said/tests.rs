//! Texts with their parts, in English and out of a row.

use super::{Part, Said, table};
use crate::{Language, say};

#[test]
fn a_text_is_english_at_once() {
    let (name, many) = ("a", 3);
    let said = say!("`{name}` has {} and {many} of {}", 2, say!("a step"));
    assert_eq!(&*said, "`a` has 2 and 3 of a step");
    assert_eq!(&*say!("write `{{`"), "write `{`");
    assert_eq!(&*say!("`{name}` {:?}", "x"), "`a` \"x\"");
    assert_eq!(&*say!("{many}, {many}"), "3, 3");
    assert_eq!(say!("`{name}`", name = many).to_string(), "`3`");
}

#[test]
fn rows_may_have_their_holes_in_any_order() {
    let parts = [Part::Raw("x".into()), Part::Raw("2".into()), Part::Raw("y".into())];
    let fill = |row| table::fill("`{a}` {} {}", row, &super::shown(&parts, Language::French));
    assert_eq!(fill("{} {} {a}"), "2 y x");
    assert_eq!(fill("{2} {a} {1} {{}}"), "y x 2 {}");
}

#[test]
fn foreign_text_is_the_same_in_each_language() {
    let said = Said::foreign("{a} refused");
    assert!(Language::ALL.into_iter().all(|l| said.in_language(l) == "{a} refused"));
}
