//! Any bytes as IEC 61131-3 text: problems, never a panic; what comes of it goes
//! through the checker, and what runs is written again.
#![no_main]

use g7_exchange::{Format, Outlet};
use g7_model::FileId;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let _ = g7_exchange::recognise("a.st", bytes);
    let (document, _) = g7_exchange::import(Format::IecText, bytes, FileId(0));
    if g7_compile::compile(&document).0.is_some() {
        let written = g7_exchange::export(Outlet::IecText, &document);
        let _ = g7_exchange::import(Format::IecText, written.text.as_bytes(), FileId(1));
    }
});
