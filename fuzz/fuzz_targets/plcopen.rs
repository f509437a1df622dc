//! Any bytes as PLCopen XML: problems, never a panic; what comes of it goes
//! through the checker and out again.
#![no_main]

use g7_model::FileId;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let _ = g7_exchange::recognise("", bytes);
    let (document, _) = g7_exchange::import(g7_exchange::Format::Plcopen, bytes, FileId(0));
    let _ = g7_exchange::export(g7_exchange::Outlet::Plcopen, &document);
    let _ = g7_compile::compile(&document);
});
