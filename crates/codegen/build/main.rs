//! Turns the runtime (`crates/runtime`) into data that the printers hold.
//!
//! ```text
//! g7_runtime::source (text, compiled before this runs) -- syn --> OUT_DIR/runtime.rs
//!     chart.rs      facts, names of tables and functions     (read/chart.rs)
//!     evolution/    functions and structures as trees        (read/tree.rs)
//!     numbers.rs .. helpers of printed Rust, as they stand   (read/rust.rs)
//!     c/            the same helpers in C                    (read/c.rs)
//! ```
//!
//! # Invariants
//!
//! - A name that is used and not there, a fact or function that nothing uses, and a
//!   form that the printers do not have end the build, each with its file.

mod read;

use std::error::Error;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo::rerun-if-changed=build");
    let text = read::runtime(&g7_runtime::source::ALL)?;
    let folder = std::env::var("OUT_DIR")?;
    std::fs::write(Path::new(&folder).join("runtime.rs"), text)?;
    Ok(())
}
