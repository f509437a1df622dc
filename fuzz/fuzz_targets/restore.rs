//! Restores images with changed words into a state: an image is refused or the state runs on;
//! nothing panics.
//!
//! The bytes are a .g7 text, a zero, then changes of ten bytes each: which word of the image
//! (16 bits), and a word that is combined with it by exclusive or.
#![no_main]

use g7_engine::{State, scan};
use g7_model::FileId;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let Some(end) = bytes.iter().position(|b| *b == 0) else { return };
    let (text, changes) = bytes.split_at(end);
    let (document, problems) = g7_syntax::parse_bytes(text, FileId(0));
    if !problems.is_empty() {
        return;
    }
    let (Some(c), _) = g7_compile::compile(&document) else { return };
    let program = &c.program;
    let inputs = program.tables().inputs;
    let values: Vec<u64> = vec![1; (inputs.end - inputs.start) as usize];
    let mut state = State::new(program);
    for k in 0..3 {
        if scan(program, &mut state, &values, k * 10_000_000).is_err() {
            break;
        }
    }
    let mut image = state.image().to_vec();
    for change in changes[1..].chunks_exact(10) {
        let (place, bits) = change.split_at(2);
        let place = usize::from(u16::from_le_bytes(place.try_into().expect("two bytes")));
        let bits = u64::from_le_bytes(bits.try_into().expect("eight bytes"));
        let length = image.len();
        image[place % length] ^= bits;
    }
    let before = state.image().to_vec();
    if state.restore(program, &image).is_err() {
        assert_eq!(state.image(), before, "a refused image changes nothing");
        return;
    }
    assert_eq!(state.image(), image);
    let mut canonical = Vec::new();
    state.canonical(program, &mut canonical);
    let mut now = state.now();
    for _ in 0..10 {
        now = now.saturating_add(10_000_000);
        if scan(program, &mut state, &values, now).is_err() {
            break;
        }
    }
});
