//! Any bytes as a JGrafchart file: problems, never a panic; what comes of it
//! goes through the checker, out as such a file, and in again.
#![no_main]

use g7_model::FileId;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let _ = g7_exchange::recognise("", bytes);
    let (document, _) = g7_exchange::import(g7_exchange::Format::Jgrafchart, bytes, FileId(0));
    let _ = g7_compile::compile(&document);
    let written = g7_exchange::export(g7_exchange::Outlet::Jgrafchart, &document);
    let _ = g7_exchange::import(g7_exchange::Format::Jgrafchart, written.text.as_bytes(), FileId(0));
});
