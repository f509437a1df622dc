//! Archives and descriptions of FMUs: no panic, whatever they hold.
#![no_main]

use g7_fmi::archive::unpack;
use g7_fmi::description::Description;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(text) = std::str::from_utf8(bytes) {
        let _ = Description::read(text);
    }
    for (_, content) in unpack(bytes).unwrap_or_default() {
        if let Ok(text) = std::str::from_utf8(&content) {
            let _ = Description::read(text);
        }
    }
});
