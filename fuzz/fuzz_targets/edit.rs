//! Applies arbitrary gestures to an arbitrary text. An accepted gesture leaves a text that gives
//! the intended document and can be undone byte for byte. The input is a document, a line of four
//! dashes, and one gesture per line.
#![no_main]

use g7_edit::{Gesture, History, Source, apply_placed, spliced};
use g7_model::FileId;
use libfuzzer_sys::fuzz_target;

const MOST: usize = 30;

fuzz_target!(|bytes: &[u8]| {
    let whole = String::from_utf8_lossy(bytes);
    let Some((first, gestures)) = whole.split_once("----\n") else { return };
    let mut text = first.to_owned();
    let mut history = History::default();
    for line in gestures.lines().take(MOST) {
        let Ok(gesture) = serde_json::from_str::<Gesture>(line) else { continue };
        let (document, problems) = g7_syntax::parse(&text, FileId(0));
        let clean = problems.is_empty();
        let source = Source { text: &text, document: &document, problems: &problems, marks: None };
        // Symbols have places derived from the numbers in their names; some have none.
        let stands = |id: &g7_edit::ItemId| {
            let number: i32 = id.to_string().rsplit('/').next()?.parse().ok()?;
            Some((number.wrapping_mul(1000), number.wrapping_mul(500)))
        };
        let Ok(edit) = apply_placed(&source, &gesture, &stands) else { continue };
        let after = spliced(&text, &edit.splices).expect("the splices fit");
        if clean && !matches!(gesture, Gesture::Text { .. }) {
            let problems = g7_syntax::parse(&after, FileId(0)).1;
            assert!(problems.is_empty(), "{line}\n--- before\n{text}\n--- after\n{after}\n{problems:?}");
        }
        assert!(history.record(&text, &edit.splices, false), "{line}");
        text = after;
    }
    let last = text.clone();
    while let Some(back) = history.undo() {
        text = spliced(&text, &back).expect("what is undone fits");
    }
    assert_eq!(text, first, "undone");
    while let Some(there) = history.redo() {
        text = spliced(&text, &there).expect("what is done again fits");
    }
    assert_eq!(text, last, "done again");
});
