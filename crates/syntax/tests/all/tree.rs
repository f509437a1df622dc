//! A tree that follows changes of its text is the tree of the new text: document, places, notes and
//! problems. Random series of edits on every chart of the repository, with slips as they happen while
//! people type.
#![allow(clippy::disallowed_methods, reason = "the test reads the charts of the repository")]

use std::path::{Path, PathBuf};

use g7_model::FileId;
use g7_syntax::Tree;

/// A pseudo-random generator (SplitMix64).
struct Rng(u64);

impl Rng {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    fn below(&mut self, n: usize) -> usize {
        usize::try_from(self.bits() % (n.max(1) as u64)).unwrap_or(0)
    }

    fn pick<'a>(&mut self, list: &[&'a str]) -> &'a str {
        list.get(self.below(list.len())).copied().unwrap_or_default()
    }
}

/// The texts that are put in.
const PIECES: &[&str] = &[
    "a",
    "x1",
    "7",
    " ",
    "\n",
    "\r\n",
    "\t",
    ";",
    ",",
    ".",
    ":",
    "=",
    "->",
    "- >",
    "+",
    "'",
    "\"",
    "`",
    "{",
    "}",
    "(",
    ")",
    "[",
    "]",
    "/*",
    "*/",
    "(*",
    "*)",
    "//",
    "# ",
    "é",
    "“",
    "”",
    "→",
    "·",
    "\u{305}",
    "\u{feff}",
    "?",
    "\u{a0}",
    "\n\n",
    "} ",
    "{ ",
    "\"\"",
    "when",
    "when a",
    " and ",
    " or",
    " not",
    "\n  and b",
    "step",
    "\nstep 9",
    "\n  step 9 { N a }\n",
    "\n  9 -> 1 when a\n",
    "\n  -> 2 when b",
    "STEP",
    "INITIAL STEP 0",
    "stp 4",
    "end_iff",
    "initial ",
    "chart",
    "\nchart Q {\n  initial step 1\n}\n",
    "\ninput k : BOOL\n",
    "output q : BOOL",
    "var ",
    "\n}\n",
    "\n{\n",
    "prove always a\n",
    "\ntest \"t\" {\n  wait 1s\n}\n",
    "layout Q {\n  step 1 at (0, 1)\n}\n",
    "step 5 at (1, 2)\n",
    "\npre il {\n LD a\n ST b\n}\n",
    "il {",
    "ld {",
    "pre { a := 1 }\n",
    "action A { a := 1 }\n",
    "transition section S := a\n",
    "macro step M1 = E\n",
    "VAR_INPUT\n",
    "END_VAR\n",
    "profile unity\n",
    "scan 10ms\n",
    "function f(a : INT) : INT { f := a }\n",
    "plant P {\n state s : REAL\n}\n",
    "IF a THEN",
    "END_IF",
    "1,5",
    "5 s",
    "T#5s",
    "()",
    "(1, 2)",
    "priority",
    "on clearing {",
    "every 20ms",
    "--",
    "\"say\"",
    "at %I0.0",
    "retain",
    "2#",
    "1e",
    "1e+",
    "x1.",
    "safe TRUE",
    ":=",
];

fn charts(folder: &Path, ending: &str, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a folder").flatten() {
        let path = entry.path();
        if path.is_dir() {
            charts(&path, ending, found);
        } else if path.extension().is_some_and(|e| e == ending) {
            found.push(path);
        }
    }
}

/// The texts of files with this ending below a folder; of prose, the charts in it.
fn texts(folder: &str, ending: &str) -> Vec<String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(folder);
    let mut files = Vec::new();
    charts(&root, ending, &mut files);
    files.sort();
    let read = files.iter().map(|f| std::fs::read_to_string(f).expect("readable"));
    if ending != "md" {
        return read.collect();
    }
    let blocks = |text: String| -> Vec<String> {
        let parts = text.split("```g7\n").skip(1);
        parts.filter_map(|p| p.split_once("```").map(|(chart, _)| chart.to_owned())).collect()
    };
    read.flat_map(blocks).collect()
}

/// A place between two characters.
fn place(rng: &mut Rng, text: &str) -> usize {
    let mut at = rng.below(text.len() + 1);
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    match rng.below(4) {
        0 => text.get(..at).and_then(|t| t.rfind('\n')).map_or(0, |n| n + 1),
        1 => text.get(at..).and_then(|t| t.find('\n')).map_or(text.len(), |n| at + n),
        _ => at,
    }
}

/// Some text from a place on: characters, a word, or lines.
fn some(rng: &mut Rng, text: &str, at: usize) -> usize {
    let rest = text.get(at..).unwrap_or_default();
    let length = match rng.below(4) {
        0 => rest.chars().next().map_or(0, char::len_utf8),
        1 => rest.chars().take(1 + rng.below(6)).map(char::len_utf8).sum(),
        2 => rest.find(|c: char| !c.is_alphanumeric()).unwrap_or(rest.len()),
        _ => rest.split_inclusive('\n').take(1 + rng.below(3)).map(str::len).sum(),
    };
    at + length
}

type Splice = (std::ops::Range<usize>, String);

/// One change of the text; now and then in several places.
fn change(rng: &mut Rng, text: &str) -> Vec<Splice> {
    let mut at = place(rng, text);
    let mut out = Vec::new();
    for _ in 0..[1, 1, 1, 1, 1, 2, 3, 12].get(rng.below(8)).copied().unwrap_or(1) {
        let end = some(rng, text, at);
        out.push(match rng.below(8) {
            0..=2 => (at..at, rng.pick(PIECES).to_owned()),
            3 => (at..end, String::new()),
            4 => (at..end, rng.pick(PIECES).to_owned()),
            5 => {
                let from = place(rng, text);
                let to = some(rng, text, from);
                (at..at, text.get(from..to).unwrap_or_default().to_owned())
            }
            6 => (at..end, text.get(at..end).unwrap_or_default().replace('\n', "\r\n")),
            _ => (at..at, "x".to_owned()),
        });
        let last = out.last().map_or(at, |(range, _)| range.end);
        at = last + rng.below(800);
        if text.get(at..).is_none() {
            break;
        }
    }
    out
}

fn show(tree: &Tree) -> String {
    format!("{:?}\n{:?}", tree.document, tree.problems)
}

/// Makes a change, compares, and returns how many bytes were read and how many there are.
fn follow(tree: &mut Tree, splices: &[Splice], before: &str) -> (usize, usize) {
    let edits: Vec<(std::ops::Range<usize>, &str)> =
        splices.iter().map(|(range, words)| (range.clone(), words.as_str())).collect();
    let mut text = before.to_owned();
    for (range, words) in splices.iter().rev() {
        text.replace_range(range.clone(), words);
    }
    assert!(tree.change(&edits), "{splices:?} fit");
    assert_eq!(tree.text, text);
    let whole = Tree::read(text, FileId(0));
    if show(tree) != show(&whole) {
        let (now, read) = (format!("{tree:#?}"), format!("{whole:#?}"));
        let line = now.lines().zip(read.lines()).find(|(a, b)| a != b);
        panic!("{splices:?}\n--- before\n{before}\n--- after\n{}\n--- first difference: {line:?}", tree.text);
    }
    (tree.marks.reread(), tree.text.len())
}

/// Random changes, each followed by its inverse now and then.
fn play(first: &str, seed: u64, count: usize) -> (usize, usize) {
    let mut rng = Rng(seed);
    let mut tree = Tree::read(first.to_owned(), FileId(0));
    let (mut read, mut all) = (0, 0);
    for n in 0..count {
        if n % 12 == 0 {
            tree = Tree::read(first.to_owned(), FileId(0));
        }
        let before = tree.text.clone();
        let splices = change(&mut rng, &before);
        let (part, whole) = follow(&mut tree, &splices, &before);
        (read, all) = (read + part, all + whole);
        if rng.below(3) == 0 {
            let mut shift = 0isize;
            let back: Vec<Splice> = splices
                .iter()
                .map(|(range, words)| {
                    let start = range.start.saturating_add_signed(shift);
                    shift += words.len() as isize - range.len() as isize;
                    (start..start + words.len(), before.get(range.clone()).unwrap_or_default().to_owned())
                })
                .collect();
            let now = tree.text.clone();
            follow(&mut tree, &back, &now);
            assert_eq!(tree.text, before);
        }
    }
    (read, all)
}

/// `G7_TREE_ROUNDS` repeats the changes with other numbers.
fn rounds() -> u64 {
    std::env::var("G7_TREE_ROUNDS").ok().and_then(|n| n.parse().ok()).unwrap_or(1)
}

#[test]
fn a_changed_tree_of_an_example_is_the_tree_of_the_new_text() {
    let all = texts("examples", "g7");
    assert!(all.len() > 20, "the examples are there");
    let (mut read, mut whole) = (0, 0);
    for round in 0..rounds() {
        for (n, text) in all.iter().enumerate() {
            let (a, b) = play(text, (round << 32) + n as u64, 40);
            (read, whole) = (read + a, whole + b);
        }
    }
    assert!(read * 2 < whole, "{read} of {whole} bytes were read anew");
}

#[test]
fn a_changed_tree_of_a_case_is_the_tree_of_the_new_text() {
    let mut all = texts("tests/spec", "md");
    assert!(all.len() > 100, "the cases are there");
    all.extend(texts("tests/edit", "md"));
    for (folder, least) in [("tests/check", 50), ("tests/interchange", 1)] {
        let found = texts(folder, "g7");
        assert!(found.len() >= least, "{folder}");
        all.extend(found);
    }
    for round in 0..rounds() {
        for (n, text) in all.iter().enumerate() {
            play(text, (round << 32) + 1000 + n as u64, 24);
        }
    }
}

/// A chart of so many steps in a cycle, with its layout.
fn chain(steps: usize) -> String {
    let mut text =
        String::from("input a : BOOL\noutput q : BOOL\n\nchart Main {\n  initial step 0 { N q }\n");
    for n in 1..steps {
        text.push_str(&format!("  {} -> {n} when a\n  step {n} {{ N q if a }}\n", n - 1));
    }
    text.push_str(&format!("  {} -> 0 when not a\n}}\n\nlayout Main {{\n", steps - 1));
    for n in 0..steps {
        text.push_str(&format!("  step {n} at (0, {n})\n"));
    }
    text + "}\n\nprove never a and not a\n"
}

#[test]
fn a_key_reads_a_few_lines_whatever_the_length_of_the_chart() {
    let text = chain(1000);
    let mut tree = Tree::read(text.clone(), FileId(0));
    assert_eq!((tree.marks.reread(), tree.problems.len()), (text.len(), 0));
    let at = |what: &str| text.find(what).expect("it is there");
    for (place, old, new) in [
        (at("step 500 {"), 0, "x"),
        (at("500 -> 501 when a") + 17, 0, "b"),
        (at("500 -> 501 when a") + 16, 1, ""),
        (at("step 998 {") + 10, 0, " "),
        (at("  step 700 {"), 0, "  step 7000\n"),
        (at("initial step 0"), 0, " "),
        (at("step 500 at"), 0, " "),
        (at("999 -> 0 when not a") + 19, 0, "7"),
    ] {
        let (read, _) = follow(&mut tree, &[(place..place + old, new.to_owned())], &text);
        assert!(read < 300, "{new:?} at {place}: {read} bytes of {} were read", text.len());
        let now = tree.text.clone();
        let back = text.get(place..place + old).expect("old text").to_owned();
        let (read, _) = follow(&mut tree, &[(place..place + new.len(), back)], &now);
        assert!(read < 300, "{new:?} at {place} taken back: {read} bytes were read");
    }
    // A step and its place, far from each other: two short readings.
    let both = [
        (at("  step 700 {")..at("  step 700 {"), "  step 7000\n".to_owned()),
        (at("  step 700 at")..at("  step 700 at"), "  step 7000 at (1, 1)\n".to_owned()),
    ];
    let (read, _) = follow(&mut tree, &both, &text);
    assert!(read < 600, "{read} bytes were read");
}

#[test]
fn what_does_not_fit_changes_nothing() {
    let mut tree = Tree::read("chart é {}".to_owned(), FileId(0));
    let before = format!("{tree:?}");
    for wrong in
        [vec![(0..99, "")], vec![(7..7, "")], vec![(3..4, ""), (0..1, "")], vec![(0..2, ""), (1..3, "")]]
    {
        assert!(!tree.change(&wrong), "{wrong:?}");
        assert_eq!(format!("{tree:?}"), before);
    }
}

#[test]
fn more_problems_than_are_kept_come_and_go() {
    let mut text = String::from("chart G {\n  initial step 0\n");
    (1..120).for_each(|n| text.push_str(&format!("  {n} -> 0 when\n")));
    text.push_str("}\n");
    let mut tree = Tree::read(text.clone(), FileId(0));
    assert_eq!(tree.problems.len(), 101);
    // Mended from the top, one by one, until few are left; then all are made again.
    for n in 1..40 {
        let line = format!("  {n} -> 0 when\n");
        let before = tree.text.clone();
        let at = before.find(&line).expect("the line") + line.len() - 1;
        follow(&mut tree, &[(at..at, " a".to_owned())], &before);
    }
    assert_eq!(tree.problems.len(), 80);
    let before = tree.text.clone();
    let lines = "  7 -> 0 when\n".repeat(30);
    follow(&mut tree, &[(27..27, lines)], &before);
    assert_eq!(tree.problems.len(), 101);
}
