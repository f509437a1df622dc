//! Reads arbitrary bytes as a chart of Control Expert: problems, never a panic. The resulting
//! document goes through the checker.
#![no_main]

use g7_model::FileId;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let _ = g7_exchange::recognise("", bytes);
    let Some((document, _)) = g7_exchange::named("controlexpert").and_then(|f| f.read(bytes, FileId(0))) else { return };
    let _ = g7_compile::compile(&document);
});
