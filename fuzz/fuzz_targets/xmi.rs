//! Any bytes as an instance of the AGRAFE meta-model: problems, never a panic;
//! what comes of it goes through the checker and out again.
#![no_main]

use g7_exchange::{Format, Outlet};
use g7_model::FileId;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let (document, _) = g7_exchange::import(Format::Xmi, bytes, FileId(0));
    let _ = g7_compile::compile(&document);
    let written = g7_exchange::export(Outlet::Xmi, &document);
    let _ = g7_exchange::import(Format::Xmi, written.text.as_bytes(), FileId(0));
});
