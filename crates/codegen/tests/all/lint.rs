//! Linters and printed code: rules of MISRA C:2012 as the addon of cppcheck finds them, checks of clang-tidy.
//! Each exception is explained in `docs/book/src/exchange/code.md`.
#![allow(clippy::disallowed_methods, reason = "the tests start linters")]

use std::path::PathBuf;
use std::process::Command;

use g7_codegen::{Clock, File, Language, Options, Parts, Room, Style, print_as};
use g7_compile::compile;
use g7_model::FileId;

/// A folder for the time of a test; it stays where `G7_KEEP` is set.
struct Scratch(PathBuf);

impl Scratch {
    fn new(of: &str) -> Scratch {
        let folder = std::env::temp_dir().join(format!("g7-lint-{of}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        Scratch(folder)
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        if std::env::var_os("G7_KEEP").is_none() {
            let _ = std::fs::remove_dir_all(&self.0);
        }
    }
}

/// Edges, inverted conditions, times, and actions of every qualifier.
const EDGES: &str = "profile iec61131
input a : BOOL
input b : BOOL
output p, q, r, s : BOOL
chart G {
  initial step 1
  step 2 { N p D 2s q L 1s r }
  step 3 { SD 3s q S s }
  step 4 { R q DS 1s r }
  step 5 { SL 2s r P s P0 p R s }
  1 -> 2 when ↑a
  2 -> 3 when ↓b
  3 -> 4 when 2s/X3
  4 -> 5 when a
  5 -> 1 when not a
}
";

/// Numbers of several types, texts, function blocks.
const NUMBERS: &str = "profile iec60848
input a : BOOL
input n : INT
output y : INT
output w : STRING(12)
output z : REAL
var u : UINT
var t : TON
var c : CTU
chart G {
  initial step 1 { P1 y := n * 3 - 1; P1 u := u + 1 }
  step 2 { each scan: t(IN := a, PT := 2s) }
  step 3 { P1 w := CONCAT('no. ', LEFT(w, 2)); N z := 1.5 if n > 2 }
  1 -> 2 when n / 2 > 3 or t.Q
  2 -> 3 when t.Q and c.CV < 4
  3 -> 1 when w = 'a' or 3s/X3
}
";

/// Rules that are kept: numbers beside unsigned values, chains that end with `else`, names of the
/// library.
const KEPT: [&str; 3] = ["misra-c2012-10.4]", "misra-c2012-15.7]", "misra-c2012-21.2]"];

/// Rules that are not kept, each explained in the book.
const EXPLAINED: [&str; 4] =
    ["misra-c2012-15.5]", "misra-c2012-2.4]", "misra-c2012-8.7]", "misra-c2012-8.9]"];

/// The same of `g7.c`, where the arithmetic is.
const EXPLAINED_FIXED: [&str; 2] = ["misra-c2012-7.2]", "misra-c2012-14.1]"];

/// The checks of clang-tidy; each that is left out is explained in the book.
const TIDY: &str = "-*,bugprone-*,cert-*,clang-analyzer-*,misc-*,performance-*,portability-*,readability-*,\
                    -bugprone-branch-clone,-bugprone-easily-swappable-parameters,-readability-identifier-length,\
                    -readability-magic-numbers,-readability-function-cognitive-complexity,\
                    -readability-function-size,-readability-math-missing-parentheses";

fn printed(text: &str, language: Language, style: Style, room: Room) -> Result<Vec<File>, String> {
    let (doc, problems) = g7_syntax::parse(text, FileId(0));
    let (compiled, more) = compile(&doc);
    let compiled = compiled.ok_or_else(|| format!("{problems:?} {more:?}"))?;
    let options = Options { language, style, room, name: "tank", source: text };
    let printed = print_as(&compiled, &options, Parts::Apart).map_err(|p| format!("{p:?}"))?;
    if printed.problems.is_empty() { Ok(printed.files) } else { Err(format!("{:?}", printed.problems)) }
}

/// The charts in both styles, and for little memory, each in a folder of its own.
fn in_c(of: &str) -> Scratch {
    let scratch = Scratch::new(of);
    let small = Room { small: true, clock: Clock::Milliseconds };
    let forms =
        [(Style::Structured, Room::default()), (Style::Flat, Room::default()), (Style::Structured, small)];
    for (i, text) in [EDGES, NUMBERS].into_iter().enumerate() {
        for (k, (style, room)) in forms.into_iter().enumerate() {
            let files = printed(text, Language::C, style, room).unwrap_or_else(|e| panic!("{e}"));
            let folder = scratch.0.join(format!("{i}-{k}"));
            std::fs::create_dir_all(&folder).expect("a folder");
            for f in files {
                std::fs::write(folder.join(&f.name), &f.text).expect("a file");
            }
        }
    }
    scratch
}

/// The folders of a scratch, with the sources to look at: `g7.c`, which is always the same, once.
fn sources(scratch: &Scratch) -> Vec<(PathBuf, &'static [&'static str])> {
    let mut folders: Vec<PathBuf> =
        std::fs::read_dir(&scratch.0).expect("a folder").map(|e| e.expect("an entry").path()).collect();
    folders.sort();
    let all = folders.into_iter().enumerate();
    all.map(|(i, f)| (f, if i == 0 { &["g7.c", "tank.c"][..] } else { &["tank.c"] })).collect()
}

fn said(command: &mut Command) -> String {
    let out = command.output().expect("the linter starts");
    String::from_utf8_lossy(&out.stdout).into_owned() + &String::from_utf8_lossy(&out.stderr)
}

#[test]
fn rules_are_kept_as_cppcheck_finds_them() {
    if !g7_peers::tool("cppcheck") {
        return;
    }
    let scratch = in_c("misra");
    for (folder, names) in sources(&scratch) {
        for name in names {
            let args = ["--addon=misra", "--std=c99", "--quiet", name];
            let text = said(Command::new("cppcheck").args(args).current_dir(&folder));
            // The addon has run: functions with several exits are found.
            assert!(text.contains("misra-c2012-15.5]"), "{text}");
            for rule in KEPT {
                assert!(!text.contains(rule), "{}: {rule}\n{text}", folder.display());
            }
            let fixed = if *name == "g7.c" { &EXPLAINED_FIXED[..] } else { &[] };
            let other = |l: &&str| {
                l.contains("[misra-c2012-") && !EXPLAINED.iter().chain(fixed).any(|rule| l.contains(rule))
            };
            let first = text.lines().find(other);
            assert_eq!(first, None, "{}: every deviation is explained in the book\n{text}", folder.display());
        }
    }
}

#[test]
fn clang_tidy_finds_nothing() {
    if !g7_peers::tool("clang-tidy") {
        return;
    }
    let scratch = in_c("tidy");
    for (folder, names) in sources(&scratch) {
        let checks = format!("--checks={TIDY}");
        let mut command = Command::new("clang-tidy");
        command.args(["--quiet", checks.as_str(), "--header-filter=.*"]).args(names);
        let text = said(command.args(["--", "-std=c99"]).current_dir(&folder));
        assert!(!text.contains("warning:") && !text.contains("error:"), "{}: {text}", folder.display());
    }
    // The check can fail: it finds a branch without braces.
    std::fs::write(scratch.0.join("bad.c"), "int f(int a)\n{\n    if (a > 1) return 2;\n    return a;\n}\n")
        .expect("a file");
    let checks = format!("--checks={TIDY}");
    let text = said(
        Command::new("clang-tidy")
            .args(["--quiet", &checks, "bad.c", "--", "-std=c99"])
            .current_dir(&scratch.0),
    );
    assert!(text.contains("warning:"), "{text}");
}
