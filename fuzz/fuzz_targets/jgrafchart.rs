//! Reads arbitrary bytes as a JGrafchart file: problems, never a panic. The resulting document goes
//! through the checker, is written as such a file, and read again.
#![no_main]

use g7_model::FileId;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let _ = g7_exchange::recognise("", bytes);
    let Some((document, _)) = g7_exchange::named("jgrafchart").and_then(|f| f.read(bytes, FileId(0))) else { return };
    let _ = g7_compile::compile(&document);
    let Some(written) = g7_exchange::named("jgrafchart").and_then(|f| f.write(&document)) else { return };
    let _ = g7_exchange::named("jgrafchart").and_then(|f| f.read(written.text.as_bytes(), FileId(0)));
});
