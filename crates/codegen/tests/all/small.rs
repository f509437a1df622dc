//! The memory that printed C takes: as it is worked out, as avr-gcc lays it out, and as the
//! chart of a small board may take.
#![allow(clippy::disallowed_methods, reason = "it compiles files")]

use std::fmt::Write as _;
use std::process::Command;

use g7_codegen::{BOARDS, Clock, Language, Options, Printed, Room, Style, print};
use g7_model::{FileId, codes};

/// A ring of steps with signals, edges, times of steps and delays, eight outputs, and a stored
/// action at every fifth step where `stored`.
fn ring(steps: usize, profile: &str, stored: bool) -> String {
    let mut t = format!("profile {profile}\ninput go, stop, a, b : BOOL\nvar n : INT\n");
    (0..8).for_each(|i| {
        let _ = writeln!(t, "output q{i} : BOOL");
    });
    t += "chart C {\n";
    for i in 0..steps {
        let first = if i == 0 { "initial " } else { "" };
        let more = if stored && i % 5 == 2 { " P1 { n := n + 1 }" } else { "" };
        let _ = writeln!(t, "  {first}step {i} {{ N q{}{more} }}", i % 8);
    }
    for i in 0..steps {
        let when = ["go", "↑a", &format!("3s/X{i}"), "not stop and b"][i % 4].to_owned();
        let _ = writeln!(t, "  {i} -> {} when {when}", (i + 1) % steps);
    }
    t + "}\n"
}

const SMALL: Room = Room { small: true, clock: Clock::Milliseconds };

fn printed(text: &str, room: Room) -> Printed {
    let (document, problems) = g7_syntax::parse(text, FileId(0));
    let (compiled, more) = g7_compile::compile(&document);
    let compiled = compiled.unwrap_or_else(|| panic!("{problems:?} {more:?}"));
    let options =
        Options { language: Language::C, style: Style::Structured, room, name: "ring", source: text };
    print(&compiled, &options).unwrap_or_else(|p| panic!("{p:?}"))
}

#[test]
fn fifty_steps_take_300_bytes_and_200_take_1000() {
    for (steps, most) in [(50, 300), (200, 1_000)] {
        for profile in ["iec60848", "iec61131", "pl7", "unity", "jgrafchart"] {
            for stored in [false, true] {
                let p = printed(&ring(steps, profile, stored), SMALL);
                let sizes = p.sizes;
                println!("{steps} steps of {profile}, stored {stored}: {} bytes", sizes.avr);
                assert!(sizes.avr <= most, "{steps} steps of {profile}: {sizes:?}\n{}", p.files[0].text);
            }
        }
    }
    let uno = BOARDS.into_iter().find(|b| b.name == "uno").expect("it is known");
    assert!(uno.holds(printed(&ring(200, "iec60848", true), SMALL).sizes));
    assert!(!uno.holds(printed(&ring(200, "iec60848", true), Room::default()).sizes));
}

/// The number of a symbol of an object file, as the tool lists its size.
fn symbol(list: &str, name: &str) -> usize {
    let line = list.lines().find(|l| l.ends_with(&format!(" {name}"))).unwrap_or_else(|| panic!("{list}"));
    let size = line.split_whitespace().nth(1).unwrap_or("");
    usize::from_str_radix(size, 16).unwrap_or_else(|_| panic!("{line}"))
}

/// The state has the size that was worked out, and no table is copied into RAM.
#[test]
fn a_compiler_lays_it_out_as_it_was_worked_out() {
    let texts =
        [ring(50, "iec60848", true), ring(20, "jgrafchart", false), "profile iec60848\noutput y : BOOL\nvar f : LREAL\nvar t : TON\nvar w : STRING(5)\nchart C {\n  initial step 1 { N y }\n  step 2 { D 3s y }\n  step 3 { each scan: t(IN := y, PT := 2s) }\n  1 -> 2 when t.Q and f < 2.0\n  2 -> 3 when 2s/X2\n  3 -> 1 when w = 'a'\n}\n".to_owned()];
    let compilers: [(&str, &[&str], bool); 2] =
        // Of tables in flash this compiler says that they are not initialised; they are.
        [("avr-gcc", &["-mmcu=atmega328p", "-std=gnu99", "-Wno-uninitialized"], true), ("gcc", &["-std=c99"], false)];
    for (compiler, flags, avr) in compilers {
        if !g7_peers::tool(compiler) {
            continue;
        }
        for (i, room) in [SMALL, Room::default()].into_iter().enumerate() {
            for (k, text) in texts.iter().enumerate() {
                let p = printed(text, room);
                let folder =
                    std::env::temp_dir().join(format!("g7-size-{}-{compiler}-{i}-{k}", std::process::id()));
                std::fs::create_dir_all(&folder).expect("a folder");
                for f in &p.files {
                    std::fs::write(folder.join(&f.name), &f.text).expect("a file");
                }
                let main = "#include \"ring.c\"\nring_state the_state;\n";
                std::fs::write(folder.join("main.c"), main).expect("a file");
                let run = |tool: &str, args: &[&str]| {
                    let out = Command::new(tool).args(args).current_dir(&folder).output().expect("it starts");
                    assert!(out.status.success(), "{tool}: {}", String::from_utf8_lossy(&out.stderr));
                    String::from_utf8_lossy(&out.stdout).into_owned()
                };
                run(compiler, &[&["-Os", "-Wall", "-Wextra", "-Werror"], flags, &["-c", "main.c"]].concat());
                let list = run(if avr { "avr-nm" } else { "nm" }, &["-S", "main.o"]);
                let seen = symbol(&list, "the_state");
                if avr {
                    assert_eq!(seen, p.sizes.avr, "chart {k}");
                    // Nothing begins with a value in RAM: the tables are in flash.
                    let sections = run("avr-size", &["main.o"]);
                    let data = sections.lines().nth(1).and_then(|l| l.split_whitespace().nth(1));
                    assert_eq!(data, Some("0"), "tables in RAM: {sections}");
                } else {
                    // gcc for x86-64 aligns 64-bit numbers to 8 bytes, as compilers for 32-bit controllers do.
                    assert_eq!(seen, p.sizes.wide, "chart {k}");
                }
                let _ = std::fs::remove_dir_all(&folder);
            }
        }
    }
}

/// A time that 32 bits of the unit cannot hold is refused at its place, wherever it stands.
#[test]
fn a_time_that_does_not_fit_is_refused() {
    let at = |when: &str, more: &str, clock: Clock| {
        let text = format!(
            "profile iec60848\noutput y : BOOL\nvar t : TIME := {more}\nchart C {{\n  initial step 1 {{ N y if t = 1s }}\n  step 2\n  1 -> 2 when {when}\n  2 -> 1 when true\n}}\n"
        );
        let (document, _) = g7_syntax::parse(&text, FileId(0));
        let (compiled, problems) = g7_compile::compile(&document);
        let compiled = compiled.unwrap_or_else(|| panic!("{problems:?}"));
        let room = Room { small: false, clock };
        let options =
            Options { language: Language::C, style: Style::Structured, room, name: "c", source: &text };
        match print(&compiled, &options) {
            Ok(_) => None,
            Err(p) => {
                let p = p.first().expect("a problem").clone();
                assert_eq!(p.code.id, codes::NOT_CARRIED.id);
                text.get(p.at.start as usize..p.at.end as usize).map(str::to_owned)
            }
        }
    };
    assert_eq!(at("20d/X1", "1s", Clock::Milliseconds), None);
    assert_eq!(at("30d/X1", "1s", Clock::Nanoseconds), None);
    assert!(at("30d/X1", "1s", Clock::Milliseconds).is_some_and(|t| t.contains("30d")));
    assert!(at("36m/X1", "1s", Clock::Microseconds).is_some_and(|t| t.contains("36m")));
    assert_eq!(at("35m/X1", "1s", Clock::Microseconds), None);
    assert!(at("true", "25d", Clock::Milliseconds).is_some());
}
