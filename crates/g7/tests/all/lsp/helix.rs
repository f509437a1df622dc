//! Helix with the files of `editors/helix`, in a terminal of tmux: what stands on its screen.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use snapbox::cmd::cargo_bin;

use crate::common::Folder;

/// How long to wait for a word on the screen.
const PATIENCE: Duration = Duration::from_secs(30);

/// A terminal of its own, with Helix in it.
struct Helix {
    socket: PathBuf,
    _home: Folder,
}

impl Helix {
    /// Opens `chart.g7` of a folder; none without Helix or tmux, which is counted.
    fn open(folder: &Folder) -> Option<Helix> {
        let there = g7_peers::tool("hx") && g7_peers::tmux();
        there.then(|| {
            let home = Folder::new();
            let files = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../editors/helix");
            let config = std::fs::read(files.join("languages.toml")).expect("the file for Helix");
            home.write("helix/languages.toml", config);
            home.write("bin/.keep", "");
            std::os::unix::fs::symlink(cargo_bin!("g7"), home.path("bin/g7")).expect("g7 on the PATH");
            let path = std::env::var("PATH").unwrap_or_default();
            let path = format!("{}:{path}", home.path("bin").display());
            let helix = Helix { socket: home.path("tmux"), _home: home };
            let ran = helix
                .tmux()
                .args(["-f", "/dev/null", "new-session", "-d", "-x", "100", "-y", "30", "exec hx chart.g7"])
                .current_dir(folder.path(""))
                .env("XDG_CONFIG_HOME", helix._home.path(""))
                .env("PATH", path)
                .env_remove("TMUX")
                .status();
            assert!(ran.is_ok_and(|status| status.success()), "tmux starts Helix");
            helix
        })
    }

    fn tmux(&self) -> Command {
        let mut command = Command::new("tmux");
        command.arg("-S").arg(&self.socket).stdin(Stdio::null()).stderr(Stdio::null());
        command
    }

    fn keys(&self, keys: &[&str]) {
        assert!(self.tmux().arg("send-keys").args(keys).status().is_ok_and(|s| s.success()), "{keys:?}");
    }

    fn screen(&self) -> String {
        let shown = self.tmux().args(["capture-pane", "-p"]).output().expect("tmux shows the screen");
        String::from_utf8_lossy(&shown.stdout).into_owned()
    }

    /// Waits until the screen is as expected.
    fn until(&self, what: &str, fits: impl Fn(&str) -> bool) {
        let begun = Instant::now();
        loop {
            let screen = self.screen();
            if fits(&screen) {
                return;
            }
            assert!(begun.elapsed() < PATIENCE, "{what}:\n{screen}");
            std::thread::sleep(Duration::from_millis(100));
        }
    }
}

impl Drop for Helix {
    fn drop(&mut self) {
        self.tmux().arg("kill-server").status().ok();
    }
}

#[test]
fn helix_shows_a_problem_while_its_line_is_typed_and_renames() {
    let folder = Folder::with(crate::lsp::TEXT);
    let Some(helix) = Helix::open(&folder) else { return };
    helix.until("the chart", |screen| screen.contains("chart Main"));
    // Line 9, behind `when`: the word becomes an unknown name.
    helix.keys(&["9", "G", "g", "l", "i"]);
    helix.keys(&["n"]);
    helix.until("the problem", |screen| screen.contains("nothing is called"));
    helix.keys(&["BSpace", "Escape"]);
    helix.until("no problem", |screen| !screen.contains("nothing is called"));
    // The name of the variable in the first line becomes another one everywhere.
    helix.keys(&["g", "g", "w", "w", "Space", "r"]);
    helix.until("the prompt", |screen| screen.contains("rename-to:"));
    helix.keys(&["BSpace", "BSpace", "start", "Enter"]);
    helix.until("the new name", |screen| {
        screen.contains("input start : BOOL") && screen.contains("0 -> 1 when start")
    });
    helix.keys(&["Escape", ":q!", "Enter"]);
}
