//! Outputs: what they replace and leave alone; records; signals; completions.
#![allow(missing_docs, reason = "a test")]

use crate::common;

use std::process::Command;
use std::time::Duration;

use common::{Folder, PINGPONG};
use snapbox::cmd::cargo_bin;

#[test]
fn an_output_never_replaces_its_chart() {
    let folder = Folder::with(PINGPONG);
    folder.write("z.svg", PINGPONG);
    std::fs::create_dir(folder.path("sub")).expect("a folder");
    for args in [
        &["draw", "z.svg", "-o", "z.svg"][..],
        &["draw", "chart.g7", "-o", "sub/../chart.g7", "--as", "svg"],
        &["run", "chart.g7", "--headless", "--record", "chart.g7"],
        &["run", "z.svg", "--headless", "--record", "z.svg"],
        &["run", "chart.g7", "--headless", "--retain", "chart.g7"],
        &["test", "chart.g7", "--junit", "chart.g7"],
        &["prove", "chart.g7", "--junit", "chart.g7"],
        &["compare", "chart.g7", "z.svg", "--aiger", "chart.g7"],
        &["graph", "chart.g7", "-o", "chart.g7", "--as", "dot"],
        &["export", "chart.g7", "-o", "chart.g7", "--to", "mermaid"],
        &["gen", "fmu", "chart.g7", "-o", "chart.g7"],
    ] {
        // Whoever insists does not get it either.
        let force = ["--force"];
        let force = if args.contains(&"--retain") { &force[..0] } else { &force[..] };
        for more in [&[][..], force] {
            folder.g7(&[args, more].concat()).is_refused(&["itself", "nothing was changed"]);
            assert_eq!((folder.read("chart.g7"), folder.read("z.svg")), (PINGPONG.into(), PINGPONG.into()));
        }
    }
}

#[test]
fn an_output_replaces_what_g7_wrote_and_nothing_else_unasked() {
    let folder = Folder::with(&format!("{PINGPONG}\ntest \"t\" {{ scan }}"));
    let run = ["run", "chart.g7", "--headless"];
    for (name, args) in [
        ("a.svg", &["draw", "chart.g7", "-o", "a.svg"][..]),
        ("a.png", &["draw", "chart.g7", "-o", "a.png"]),
        ("a.pdf", &["draw", "chart.g7", "-o", "a.pdf"]),
        ("a.drawio", &["draw", "chart.g7", "-o", "a.drawio"]),
        ("d/G.svg", &["draw", "chart.g7", "-o", "d/"]),
        ("a.csv", &[&run[..], &["--trace", "a.csv"]].concat()),
        ("a.vcd", &[&run[..], &["--trace", "a.vcd"]].concat()),
        ("a.rec", &[&run[..], &["--record", "a.rec"]].concat()),
        ("a.xml", &["test", "chart.g7", "--junit", "a.xml"]),
        ("b.xml", &["prove", "chart.g7", "--junit", "b.xml"]),
        ("g.svg", &["graph", "chart.g7", "-o", "g.svg"]),
        ("g.dot", &["graph", "chart.g7", "-o", "g.dot"]),
        ("g.json", &["graph", "chart.g7", "-o", "g.json"]),
    ] {
        folder.write(name, "theirs");
        let ran = folder.g7(args);
        assert!(
            ran.is(2).err.contains("--force") && ran.err.contains("did not write"),
            "{name}: {}",
            ran.err
        );
        assert_eq!(folder.read(name), "theirs");
        let forced = folder.g7(&[args, &["--force"]].concat());
        assert!(forced.code != 2, "{name}: {}", forced.err);
        // Its own output is replaced again and again.
        let again = folder.g7(args);
        assert_eq!(again.code, forced.code, "{name}: {}", again.err);
    }
}

#[cfg(unix)]
#[test]
fn links_stay_when_a_file_is_formatted() {
    use std::os::unix::fs::{MetadataExt, PermissionsExt, symlink};
    let folder = Folder::with("input a:BOOL\nchart G {\n  initial step 1\n  1 -> 1 when a\n}\n");
    let at = |name: &str| folder.path(name);
    std::fs::hard_link(at("chart.g7"), at("second.g7")).expect("a link");
    symlink("second.g7", at("third.g7")).expect("a link");
    std::fs::set_permissions(at("chart.g7"), std::fs::Permissions::from_mode(0o640)).expect("a mode");
    folder.g7(&["fmt", "third.g7"]).is(0);
    assert!(folder.read("chart.g7").starts_with("input a : BOOL\n"));
    let meta = std::fs::metadata(at("chart.g7")).expect("it is there");
    assert_eq!((meta.nlink(), meta.mode() & 0o777), (2, 0o640));
    assert!(std::fs::symlink_metadata(at("third.g7")).expect("it is there").is_symlink());
}

#[test]
fn a_foreign_or_cut_record_is_named_as_such() {
    let folder = Folder::with(PINGPONG);
    folder.g7(&["run", "--headless", "--for", "1s", "--set", "a=1@200ms", "--record", "a.rec"]).is(0);
    let whole = folder.read("a.rec");
    folder.g7(&["run", "--replay", "a.rec"]).is(0);
    let replay = |text: &str| {
        folder.write("b.rec", text);
        folder.g7(&["run", "--replay", "b.rec"])
    };
    replay(&whole[..whole.len() / 2]).is_refused(&["b.rec", "cut off", "behind line"]);
    let lines: Vec<&str> = whole.lines().collect();
    replay(&(lines[..20].join("\n") + "\n")).is_refused(&["cut off", "behind line 20"]);
    replay(&whole.replacen("s ", "q ", 1)).is_refused(&["damaged", "line 2"]);
    replay("g7 tape 2 1\n").is_refused(&["another version"]);
    replay("time,a\n0,1\n").is_refused(&["not a record"]);
    folder.write(
        "chart.g7",
        PINGPONG.replace("input a", "input b").replace("when a", "when b").replace("not a", "not b"),
    );
    replay(&whole).is_refused(&["record of another chart", "inputs"]);
    // A chart that only does something else is replayed, and differs.
    folder.write("chart.g7", PINGPONG.replace("n + 1", "n + 2"));
    assert!(replay(&whole).is(1).err.contains("differs from the record at scan 20"));
}

#[cfg(unix)]
#[test]
fn a_signal_ends_a_run_and_everything_is_written() {
    for signal in ["TERM", "INT"] {
        let folder = Folder::with(&PINGPONG.replace("var n : INT", "var n : INT retain"));
        let child = Command::new(cargo_bin!("g7"))
            .args([
                "run",
                "--headless",
                "--real-time",
                "--for",
                "600s",
                "--trace",
                "a.vcd",
                "--record",
                "a.rec",
            ])
            .args(["--retain", "kept"])
            .current_dir(folder.root())
            .stdout(std::process::Stdio::piped())
            .stderr(std::process::Stdio::piped())
            .spawn()
            .expect("it starts");
        std::thread::sleep(Duration::from_millis(700));
        let pid = child.id().to_string();
        assert!(Command::new("kill").args(["-s", signal, &pid]).status().expect("kill").success());
        let ended = child.wait_with_output().expect("it ends");
        let err = String::from_utf8_lossy(&ended.stderr);
        assert_eq!(ended.status.code(), Some(0), "{signal}: {err}");
        assert!(err.contains("ended at ") && err.contains("wrote a.vcd"), "{signal}: {err}");
        assert!(folder.read("a.vcd").starts_with("$version g7"), "{signal}");
        folder.g7(&["run", "--replay", "a.rec"]).is(0);
        assert!(folder.path("kept").is_file());
    }
}

#[test]
fn completions_know_the_values_of_options() {
    let folder = Folder::new();
    for shell in ["bash", "zsh", "fish"] {
        let text = folder.g7(&["completions", shell]).is(0).out.clone();
        for value in ["iec60848", "iec61131", "tsx3720", "sarif", "github", "mermaid"] {
            assert!(text.contains(value), "{shell}: {value}");
        }
    }
    // Fish gets no values of arguments without a name.
    for shell in ["bash", "zsh"] {
        assert!(folder.g7(&["completions", shell]).is(0).out.contains("G0101"), "{shell}");
    }
    let ran = folder.g7(&["check", "--profile", "iec6084"]);
    assert!(ran.is(2).err.contains("iec60848"), "{}", ran.err);
    assert!(folder.g7(&["explain", "--help"]).is(0).out.lines().count() < 40);
}
