//! Runs every text that compiles for some scans: faults are values, never panics.
#![no_main]

use g7_model::FileId;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let (document, problems) = g7_syntax::parse_bytes(bytes, FileId(0));
    if !problems.is_empty() {
        return;
    }
    let (Some(c), _) = g7_compile::compile(&document) else { return };
    let mut state = g7_engine::State::new(&c.program);
    let inputs = c.program.tables().inputs;
    let mut values: Vec<u64> = vec![0; (inputs.end - inputs.start) as usize];
    for k in 0..20u64 {
        for (i, v) in values.iter_mut().enumerate() {
            *v = (k >> (i % 4)) & 1;
        }
        if g7_engine::scan(&c.program, &mut state, &values, k as i64 * 500_000_000).is_err() {
            break;
        }
    }
});
