//! The engine and the runtime of printed charts build for a machine without an operating
//! system: no `std`, no files, no clock, no threads.
#![allow(clippy::disallowed_methods, reason = "the test starts cargo")]

use std::path::Path;
use std::process::Command;

/// An ARM Cortex-M4 without `std`; `make peers` installs it.
const TARGET: &str = "thumbv7em-none-eabi";

#[test]
fn the_engine_and_the_runtime_build_without_an_operating_system() {
    if !g7_peers::target(TARGET) {
        return;
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    // A folder of its own: the one of this build is locked while tests run.
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("bare");
    for package in ["g7-engine", "g7-runtime"] {
        let out = Command::new(env!("CARGO"))
            .args(["build", "--quiet", "--package", package, "--target", TARGET, "--target-dir"])
            .arg(&folder)
            .current_dir(&root)
            .output()
            .expect("cargo starts");
        assert!(out.status.success(), "{package}: {}", String::from_utf8_lossy(&out.stderr));
    }
}
