//! Reads arbitrary bytes as an instance of the AGRAFE meta-model: problems, never a panic. The
//! resulting document goes through the checker and is written again.
#![no_main]

use g7_model::FileId;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let Some((document, _)) = g7_exchange::named("xmi").and_then(|f| f.read(bytes, FileId(0))) else { return };
    let _ = g7_compile::compile(&document);
    let Some(written) = g7_exchange::named("xmi").and_then(|f| f.write(&document)) else { return };
    let _ = g7_exchange::named("xmi").and_then(|f| f.read(written.text.as_bytes(), FileId(0)));
});
