//! The C library of matiec as tests use it: with its known faults mended.

use std::path::Path;

/// A copy of matiec's C library in which what contradicts IEC 61131-3 is mended. Counters end at PV
/// and at 0 there; table 36 has them end at PVmax and PVmin. The sum of two TIMEs is wrong where the
/// parts of a second make exactly one.
///
/// # Errors
///
/// A file cannot be read or written.
pub fn mended(from: &Path, to: &Path) -> std::io::Result<()> {
    std::fs::create_dir_all(to)?;
    for entry in std::fs::read_dir(from)? {
        let entry = entry?;
        let text = std::fs::read_to_string(entry.path())?;
        let text = match entry.file_name().to_str() {
            Some("iec_std_FB.h") => counters(&text),
            Some("iec_std_lib.h") => text.replace("tv_nsec > 1000000000", "tv_nsec >= 1000000000"),
            _ => text,
        };
        std::fs::write(to.join(entry.file_name()), text)?;
    }
    Ok(())
}

/// The counters of INT with the limits of INT.
fn counters(text: &str) -> String {
    let mut of_int = false;
    let mut mended = String::new();
    for line in text.lines() {
        if line.starts_with("static void ") {
            of_int = ["CTU_body__(", "CTD_body__(", "CTUD_body__("].iter().any(|name| line.contains(name));
        }
        if of_int && line.contains("_T.Q,) && ") {
            let line = line.replace("CV,) < __GET_VAR(data__->PV,)", "CV,) < 32767");
            mended += &line.replace("CV,) > 0", "CV,) > -32768");
        } else {
            mended += line;
        }
        mended.push('\n');
    }
    mended
}
