//! Rows that are handed in, as the page does: its modules have none of their own.

use g7_model::{Language, Said, said};

#[test]
fn rows_that_are_handed_in_tell_a_text_in_other_languages() {
    let text = "a text that stands in no file";
    let told = |language| Said::plain(text, text).in_language(language);
    said::teach(format!("# a remark\n\n{text}\nfr un texte\npt um texto\n"));
    assert_eq!(Language::ALL.map(told), [text, "un texte", "um texto"]);
    assert!(said::rows().count() > 1, "beside those of the files");
}
