//! The text of the runtime, for the build of `codegen`.

/// A file of this crate.
#[derive(Clone, Copy, Debug)]
pub struct File {
    /// Its path in this crate, for messages.
    pub path: &'static str,
    /// Its content.
    pub text: &'static str,
}

/// All that `codegen` prints of this crate.
#[derive(Clone, Copy, Debug)]
pub struct Source {
    /// The items that the runtime asks of a chart.
    pub chart: File,
    /// The faults that stop a scan.
    pub faults: File,
    /// The evolution, in the order in which it is printed.
    pub evolution: &'static [File],
    /// The frame of a chart that is printed as equations.
    pub flat: &'static [File],
    /// The functions of either that callers of the printed code may use, beside what each chart offers.
    pub offered: &'static [&'static str],
    /// The function blocks.
    pub function_blocks: File,
    /// Helpers of printed Rust, in the order in which they are printed.
    pub rust: &'static [File],
    /// Helpers of printed C: the file that includes the others, then those.
    pub c: &'static [File],
}

macro_rules! file {
    ($path:literal) => {
        File { path: $path, text: include_str!(concat!("../", $path)) }
    };
}

macro_rules! files {
    ($($path:literal)*) => {
        &[$(file!($path)),*]
    };
}

/// The files of this crate.
pub const ALL: Source = Source {
    chart: file!("src/chart.rs"),
    faults: file!("src/faults.rs"),
    evolution: files! {
        "src/evolution/memory.rs" "src/evolution/changes.rs" "src/evolution/clearing.rs"
        "src/evolution/scan.rs" "src/evolution/enclosing.rs" "src/evolution/forcing.rs"
        "src/evolution/turns.rs" "src/evolution/watches.rs" "src/evolution/services.rs"
        "src/evolution/closing.rs" "src/evolution/control_blocks.rs" "src/cycle.rs"
    },
    flat: files! { "src/flat/frame.rs" "src/cycle.rs" },
    offered: &["is_active", "scan", "scan_in_place", "step_time"],
    function_blocks: file!("src/function_blocks.rs"),
    rust: files! { "src/numbers.rs" "src/text.rs" "src/arithmetic.rs" },
    c: files! {
        "c/helpers.c" "c/faults.h" "c/numbers.h" "c/reals.h" "c/wide.h" "c/text.h" "c/small.h"
        "c/small_product.h" "c/small_signed.h" "c/text_signed.h" "c/text_unsigned.h" "c/order.h"
        "c/bits.h"
    },
};
