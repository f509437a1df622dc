//! Any bytes as a chart of Control Expert: problems, never a panic; what comes of it
//! goes through the checker.
#![no_main]

use g7_model::FileId;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let _ = g7_exchange::recognise("", bytes);
    let (document, _) = g7_exchange::import(g7_exchange::Format::ControlExpert, bytes, FileId(0));
    let _ = g7_compile::compile(&document);
});
