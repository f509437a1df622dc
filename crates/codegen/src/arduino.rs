//! The sketch round the C code: pins from addresses, `millis()` as the clock.

use crate::build::Gen;

pub(crate) fn sketch(_g: &Gen<'_>, name: &str) -> String {
    format!("#include \"{name}.h\"\n")
}
