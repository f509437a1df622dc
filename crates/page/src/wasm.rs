//! The interface of the wasm module. A message is written into a buffer of the module, and the
//! answer is read from another one. The host sees the memory as an array, so only numbers are
//! exchanged.
//!
//! `g7_reserve(length)` returns the place for a message of this many bytes; `g7_call()` answers it
//! and returns the length of the answer; `g7_answer()` returns the place of the answer. A module
//! holds one page.

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

/// Longest message in bytes; a longer one is cut off and therefore refused.
const MOST: usize = 64 << 20;

/// Reserves room for a message of `length` bytes.
#[allow(unsafe_code, reason = "a name without mangling is unsafe by itself; the prefix makes it ours alone")]
#[unsafe(no_mangle)]
pub extern "C" fn g7_reserve(length: usize) -> *mut u8 {
    DOOR.with_borrow_mut(|door| {
        door.message.clear();
        door.message.resize(length.min(MOST), 0);
        door.message.as_mut_ptr()
    })
}

/// Answers the message; returns the length of the answer in bytes.
#[allow(unsafe_code, reason = "a name without mangling is unsafe by itself; the prefix makes it ours alone")]
#[unsafe(no_mangle)]
pub extern "C" fn g7_call() -> usize {
    DOOR.with_borrow_mut(|door| {
        door.answer = door.page.call(&String::from_utf8_lossy(&door.message));
        door.message = Vec::new();
        door.answer.len()
    })
}

/// The place of the answer; it is valid until the next call.
#[allow(unsafe_code, reason = "a name without mangling is unsafe by itself; the prefix makes it ours alone")]
#[unsafe(no_mangle)]
pub extern "C" fn g7_answer() -> *const u8 {
    DOOR.with_borrow(|door| door.answer.as_ptr())
}
