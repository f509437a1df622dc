//! The invariants of ARCHITECTURE that the sources show.

use std::path::{Path, PathBuf};

use g7_tests::house::{ends_in, files, none, read};

/// The sources of the crates without their tests: file, text.
fn sources() -> Vec<(PathBuf, String)> {
    let mut found = Vec::new();
    for file in files().into_iter().filter(|f| f.starts_with("crates") && ends_in(f, &["rs"])) {
        let source = file.iter().any(|p| p == "src");
        let test = file.iter().any(|p| p == "tests" || p.to_string_lossy().ends_with("tests.rs"));
        if source && !test {
            let text = read(&file);
            let own = text.split("#[cfg(test)]\nmod ").next().unwrap_or("").to_owned();
            found.push((file, own));
        }
    }
    assert!(found.len() > 200, "only {} sources", found.len());
    found
}

/// The lines of code in which one of the words stands, but for the places where it may.
fn outside(words: &[&str], places: &[&str]) -> Vec<String> {
    let mut found = Vec::new();
    let mut used = vec![false; places.len()];
    for (file, text) in sources() {
        let code = text.lines().enumerate().filter(|(_, l)| !l.trim_start().starts_with("//"));
        for (k, line) in code.filter(|(_, l)| words.iter().any(|w| l.contains(w))) {
            match places.iter().position(|p| file.starts_with(Path::new("crates").join(p))) {
                Some(place) => used[place] = true,
                None => found.push(format!("{}:{}: {}", file.display(), k + 1, line.trim())),
            }
        }
    }
    // A place that has no need of its leave any more loses it.
    found.extend(places.iter().zip(used).filter(|(_, used)| !used).map(|(p, _)| format!("{p}: not used")));
    found
}

#[test]
fn profiles_are_told_apart_where_rules_are_chosen() {
    let profiles = ["Iec60848", "Iec61131", "Pl7", "Unity", "Jgrafchart"];
    let names: Vec<String> = profiles.iter().map(|p| format!("ProfileName::{p}")).collect();
    let places = [
        "model/src/chart.rs",
        "compile/src/resolve/rules.rs",
        // `.x` of JGrafchart and Unity; plants run as `iec61131`.
        "compile/src/resolve/refer.rs",
        "compile/src/plant/program.rs",
        // Readers choose the profile of what they read, writers ask for the one they can write.
        "exchange/src",
        "iec/src",
    ];
    let words: Vec<&str> = names.iter().map(String::as_str).collect();
    none(&outside(&words, &places), "code that tells profiles apart");
    let rows = ["IEC60848", "IEC61131", "PL7", "UNITY", "JGRAFCHART"];
    let rows: Vec<String> = rows.iter().map(|r| format!("Rules::{r}")).collect();
    let rows: Vec<&str> = rows.iter().map(String::as_str).collect();
    let places = ["engine/src/rules.rs", "compile/src/resolve/rules.rs"];
    none(&outside(&rows, &places), "code that knows the rules of a profile");
}

#[test]
fn bare_crates_say_so() {
    let mut found = Vec::new();
    for (name, lints) in [("engine", true), ("runtime", false)] {
        let text = read(format!("crates/{name}/src/lib.rs"));
        let mut wanted = vec!["#![no_std]", "#![forbid(unsafe_code)]"];
        if lints {
            wanted.push(
                "#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]",
            );
        }
        found.extend(wanted.iter().filter(|w| !text.contains(**w)).map(|w| format!("{name}: {w}")));
    }
    none(&found, "attributes that are missing");
    let leave = [
        "allow(clippy::indexing_slicing",
        "allow(clippy::unwrap_used",
        "allow(clippy::panic",
        "unreachable!(",
    ];
    let engine = outside(&leave, &[]).into_iter().filter(|l| l.starts_with("crates/engine"));
    none(&engine.collect::<Vec<_>>(), "ways round the lints of the engine");
}

#[test]
fn the_lints_of_the_workspace_hold_everywhere() {
    // Three packages are workspaces of their own; Zed compiles the last one.
    let apart = |f: &PathBuf| ["fuzz", "benches/prove", "editors/zed"].iter().any(|own| f.starts_with(own));
    let manifests = files().into_iter().filter(|f| f.ends_with("Cargo.toml") && !apart(f));
    let without = manifests.filter(|f| {
        let text = read(f);
        text.contains("[package]") && !text.contains("[lints]\nworkspace = true")
    });
    none(&without.map(|f| f.display().to_string()).collect::<Vec<_>>(), "packages without the lints");
    let root = read("Cargo.toml");
    assert!(
        root.contains("iter_over_hash_type = \"warn\"") && root.contains("disallowed_methods = \"warn\"")
    );
}

#[test]
fn the_clock_is_read_in_one_place() {
    // The server closes connections that are silent and shares the answers of devices for a moment; no
    // chart sees that time.
    let readers =
        ["host/src/clock.rs", "g7/src/serve/live.rs", "g7/src/serve/line.rs", "g7/src/serve/wiring/turn.rs"];
    let found = outside(&["Instant::now(", "SystemTime::now("], &readers);
    none(&found, "clocks that are read outside of `host::Clock`");
}

#[test]
fn files_are_read_by_the_host_and_the_command_line() {
    let words = ["fs::read", "File::open(path", "fs::metadata", "fs::canonicalize"];
    // Certificates come and go while a controller runs; the levels of a search are its own files.
    let readers = ["host/src", "g7/src", "opcua/src/certificates.rs", "hosts/src/levels.rs"];
    none(&outside(&words, &readers), "files that are read elsewhere");
}

#[test]
fn files_are_written_whole() {
    let words = ["fs::write(", "File::create", "OpenOptions", "File::options"];
    // The values of a controller are written in place, into one of two slots; a request to the kernel is
    // made by a file of its own; a lock is an empty file; the levels of a search are written whole, but too
    // large to wait for the disk.
    let others = [
        "host/src/whole.rs",
        "online/src/disk.rs",
        "online/src/realtime.rs",
        "g7/src/sole.rs",
        "hosts/src/levels.rs",
    ];
    none(&outside(&words, &others), "files that are not written by `host::write_whole`");
}

#[test]
fn examples_in_comments_stand_where_they_are_run() {
    let mut found = Vec::new();
    for (file, text) in sources().into_iter().filter(|(f, _)| !f.starts_with("crates/engine")) {
        let fences = text.lines().enumerate().filter(|(_, l)| {
            let line = l.trim_start();
            (line.starts_with("///") || line.starts_with("//!")) && line.contains("```")
        });
        // Every other one ends an example.
        for (k, line) in fences.step_by(2) {
            if !["text", "toml", "g7", "ebnf"].iter().any(|word| line.ends_with(&format!("```{word}"))) {
                found.push(format!("{}:{}: {}", file.display(), k + 1, line.trim()));
            }
        }
    }
    none(
        &found,
        "examples of code that `make test` does not run: it runs those of `g7-engine`, for its speed",
    );
}
