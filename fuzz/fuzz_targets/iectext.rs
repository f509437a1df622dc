//! Reads arbitrary bytes as IEC 61131-3 text: problems, never a panic. The resulting document goes
//! through the checker, and if it can run, it is written again.
#![no_main]

use g7_model::FileId;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let _ = g7_exchange::recognise("a.st", bytes);
    let Some((document, _)) = g7_exchange::named("sfc").and_then(|f| f.read(bytes, FileId(0))) else { return };
    if g7_compile::compile(&document).0.is_some() {
        let Some(written) = g7_exchange::named("sfc").and_then(|f| f.write(&document)) else { return };
        let _ = g7_exchange::named("sfc").and_then(|f| f.read(written.text.as_bytes(), FileId(1)));
    }
});
