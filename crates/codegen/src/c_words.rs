//! Numbers and names as C writes them, used by [`crate::c`] and what puts its files together; and where tables
//! stand.

use std::collections::{HashMap, HashSet};

use crate::tree::{Expr, Module, Ty};

/// `StepTimes` as `step_times`.
pub(crate) fn snake(name: &str) -> String {
    let mut out = String::new();
    for (i, c) in name.chars().enumerate() {
        if c.is_uppercase() && i > 0 {
            out.push('_');
        }
        out.extend(c.to_lowercase());
    }
    out
}

/// Text that may stand in a comment.
pub(crate) fn comment(text: &str) -> String {
    text.replace("*/", "* /").replace("/*", "/ *").replace('\\', "\\ ")
}

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

/// Where tables stand: an AVR would copy them into its RAM else.
pub(crate) const FLASH: &str = "\
/* Tables stay in the flash of an AVR; elsewhere constants are there anyway. */
#ifndef G7_FLASH
#if defined(__AVR__) && defined(__FLASH)
#define G7_FLASH __flash
#else
#define G7_FLASH
#endif
#endif

";

/// Tables of which no address is passed on.
pub(crate) fn in_flash(module: &Module) -> HashSet<&str> {
    let tables = module.consts.iter().filter(|c| matches!(c.ty, Ty::Array(..)));
    let mut found: HashSet<&str> = tables.map(|c| c.name.as_str()).collect();
    for s in module.functions.iter().flat_map(|f| &f.body) {
        let (mut names, mut elements) = (HashMap::new(), HashMap::new());
        s.walk(&mut |e| match e {
            Expr::Name(n) => *names.entry(n.clone()).or_insert(0) += 1,
            Expr::Index(of, _) => {
                if let Expr::Name(n) = &**of {
                    *elements.entry(n.clone()).or_insert(0) += 1;
                }
            }
            _ => {}
        });
        found.retain(|n| names.get(*n).copied().unwrap_or(0) == elements.get(*n).copied().unwrap_or(0));
    }
    found
}
