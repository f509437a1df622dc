//! Reads arbitrary bytes as a .g7 file: problems, never a panic. A document without problems is
//! printed and read again, with the same result.
#![no_main]

use g7_model::FileId;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let (document, problems) = g7_syntax::parse_bytes(bytes, FileId(0));
    if problems.is_empty() {
        let printed = g7_syntax::print(&document, None);
        let (again, problems) = g7_syntax::parse(&printed, FileId(0));
        assert!(problems.is_empty(), "{problems:?}\n{printed}");
        assert_eq!(again, document, "{printed}");
        assert_eq!(g7_syntax::print(&again, None), printed);
    }
});
