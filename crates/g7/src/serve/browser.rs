//! Opens the user's browser if there is a screen.

use std::process::{Command, Stdio};

/// Tries to open an address; it is printed in any case.
pub(super) fn open(address: &str) {
    if !has_screen() {
        return;
    }
    let (program, args): (&str, &[&str]) = if cfg!(windows) {
        ("rundll32", &["url.dll,FileProtocolHandler"])
    } else if cfg!(target_os = "macos") {
        ("open", &[])
    } else {
        ("xdg-open", &[])
    };
    let quiet = || Stdio::null();
    let child =
        Command::new(program).args(args).arg(address).stdin(quiet()).stdout(quiet()).stderr(quiet()).spawn();
    if let Ok(mut child) = child {
        // Wait for the process, so that no zombie is left behind.
        std::thread::spawn(move || child.wait());
    }
}

fn has_screen() -> bool {
    let set = |name: &str| std::env::var_os(name).is_some_and(|v| !v.is_empty());
    if cfg!(any(windows, target_os = "macos")) {
        // Over SSH the screen belongs to another machine.
        return !set("SSH_CONNECTION");
    }
    set("DISPLAY") || set("WAYLAND_DISPLAY")
}
