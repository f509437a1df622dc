//! Numbers and names as C writes them; used by [`crate::c`] alone.

/// The name of a function of the file's own; one that C's library has is another (rule 21.2).
pub(crate) fn own_name(name: &str) -> String {
    if matches!(name, "clock" | "time") { format!("{name}_of") } else { name.to_owned() }
}

/// A whole number as C writes one of its type.
pub(crate) fn integer(n: i128, signed: bool, bits: u8) -> String {
    if bits == 64 && n == i128::from(i64::MIN) {
        return "INT64_MIN".into();
    }
    if bits == 64 {
        return format!("{}INT64_C({n})", if signed { "" } else { "U" });
    }
    if !signed && bits == 32 {
        return format!("UINT32_C({n})");
    }
    if n > i128::from(i64::MAX) {
        format!("UINT64_C({n})")
    } else if n == i128::from(i64::MIN) {
        "INT64_MIN".into()
    } else if signed && n == i128::from(i32::MIN) {
        "INT32_MIN".into()
    } else if n > i128::from(u32::MAX) || n < i128::from(i32::MIN) {
        format!("INT64_C({n})")
    } else {
        n.to_string()
    }
}

/// A real number; `text` is its shortest form.
pub(crate) fn real(v: f64, text: &str, suffix: &str) -> String {
    if v.is_nan() {
        format!("(0.0{suffix} / 0.0{suffix})")
    } else if v.is_infinite() {
        format!("({}1.0{suffix} / 0.0{suffix})", if v < 0.0 { "-" } else { "" })
    } else {
        format!("{text}{suffix}")
    }
}
