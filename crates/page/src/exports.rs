//! The door of the wasm module: a text is put into a buffer of ours, and taken
//! out of one. The host sees our memory as an array, so nothing here points.
//!
//! `g7_reserve(length)` gives the place for a message of so many bytes;
//! `g7_call()` answers it and gives the length of the answer; `g7_answer()`
//! gives the place of the answer. One page a module.

use std::cell::RefCell;

use crate::Page;

#[derive(Default)]
struct Door {
    page: Page,
    message: Vec<u8>,
    answer: String,
}

thread_local! {
    static DOOR: RefCell<Door> = RefCell::default();
}

/// Longest message, in bytes; a longer one is cut off and so refused.
const MOST: usize = 64 << 20;

/// Room for a message of `length` bytes.
#[allow(unsafe_code, reason = "a name without mangling is unsafe by itself; the prefix makes it ours alone")]
#[unsafe(no_mangle)]
pub extern "C" fn g7_reserve(length: usize) -> *mut u8 {
    DOOR.with_borrow_mut(|door| {
        door.message.clear();
        door.message.resize(length.min(MOST), 0);
        door.message.as_mut_ptr()
    })
}

/// Answers the message; the length of the answer in bytes.
#[allow(unsafe_code, reason = "a name without mangling is unsafe by itself; the prefix makes it ours alone")]
#[unsafe(no_mangle)]
pub extern "C" fn g7_call() -> usize {
    DOOR.with_borrow_mut(|door| {
        door.answer = door.page.call(&String::from_utf8_lossy(&door.message));
        door.message = Vec::new();
        door.answer.len()
    })
}

/// Where the answer lies, until the next call.
#[allow(unsafe_code, reason = "a name without mangling is unsafe by itself; the prefix makes it ours alone")]
#[unsafe(no_mangle)]
pub extern "C" fn g7_answer() -> *const u8 {
    DOOR.with_borrow(|door| door.answer.as_ptr())
}
