//! Random series of gestures on every example. After each accepted gesture the text has no syntax
//! errors; undoing all of them restores the first text byte for byte, redoing all of them the last
//! one; no id and no text causes a panic.
#![allow(clippy::disallowed_methods, reason = "the test reads the examples")]

use std::path::{Path, PathBuf};

use g7_edit::{Edit, Gesture, History, Refusal, Source, apply_placed, copy, spliced};
use g7_model::{Document, FileId, StepKind};
use g7_syntax::Tree;
use serde_json::{Value, json};

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

    fn pick<'a, T>(&mut self, list: &'a [T]) -> Option<&'a T> {
        list.get(self.below(list.len()))
    }

    fn text(&mut self, list: &[&'static str]) -> &'static str {
        self.pick(list).copied().unwrap_or_default()
    }
}

fn examples(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a folder").flatten() {
        let path = entry.path();
        if path.is_dir() {
            examples(&path, found);
        } else if path.extension().is_some_and(|e| e == "g7") {
            found.push(path);
        }
    }
}

/// Texts with unusual layout.
const ODD: &[&str] = &[
    "",
    "// nothing but a note",
    "chart G {}",
    "chart G { initial step 1 step 2 1 -> 2 when a -> 1 when b }\ninput a, b : BOOL",
    "input a : BOOL\r\nchart `a b` {\r\n  initial step 1 // one\r\n  step `step` { N x; N y }\r\n  1 -> `step` when a\r\n    -> 1 when (a) // back\r\n}\r\n",
    "chart G {\n  initial step 1\n  1 -> 2 when x\n  step 2 { /* two */ }\n  2 -> 3 when x -> 4 when y /* here\n and there */ -> 5 when z\n  step 3\n  step 4\n  step 5 \"five\" { P1 { a := 1\n    b := 2 }\n  }\n}\nlayout G { step 1 at (0, 0) transition #2 at (1.5, -3.25) }",
    "task T { entry step E exit step S E -> S when TRUE }\nchart G {\n\tinitial step A { call T }\n\tstep B\n\n\tt1: A -> B when c priority 1 \"go\" on clearing { n := n + 1 }\n\tt2: A -> () when d\n\t() -> B when e\n\t(A, B) -> (A, B) when f\n}\nlayout G {\n  transition t1 at (2, 3)\n}\n",
];

fn texts() -> Vec<String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    let mut files = Vec::new();
    examples(&root, &mut files);
    files.sort();
    assert!(files.len() > 10, "the examples are there");
    let mut all: Vec<String> = ODD.iter().map(|t| (*t).to_owned()).collect();
    all.extend(files.iter().map(|f| std::fs::read_to_string(f).expect("readable")));
    all
}

fn read(text: &str) -> (Document, bool) {
    let (doc, problems) = g7_syntax::parse(text, FileId(0));
    (doc, problems.is_empty())
}

fn run(text: &str, gesture: &Gesture) -> Result<Edit, Refusal> {
    let Tree { text, document, problems, marks } = &Tree::read(text.to_owned(), FileId(0));
    let source = Source { text, document, problems, marks: Some(marks) };
    let edit = apply_placed(&source, gesture, &|id| Some((id.to_string().len() as i32 * 100, 300)))?;
    // A gesture hands on the document that a reading of the new text gives.
    if let Some(read) = &edit.read {
        let whole = Tree::read(spliced(text, &edit.splices).expect("it fits"), FileId(0));
        assert_eq!(read.text, whole.text);
        let shown = |t: &Tree| format!("{:?}\n{:?}", t.document, t.problems);
        assert_eq!(shown(read), shown(&whole), "{gesture:?} in\n{text}");
    }
    Ok(edit)
}

const NAMES: &[&str] = &["", "1", "12", "Fill", "a b", "step", "on", "a/b>c:d%", "x`y", "Vent på"];
const EXPRESSIONS: &[&str] = &[
    "",
    "TRUE",
    "a",
    "a or (b)",
    "↑m",
    "3s/X1",
    "=1",
    "a // why",
    "a -> 3 when b",
    ")",
    "%I0.1",
    "X1.t > 5s",
];
const ACTIONS: &[&str] = &[
    "",
    "N motor",
    "N a N b",
    "P1 n := n + 1",
    "D 5s `odd name`",
    "\"said\"",
    "N a // note",
    "}",
    "P1 { x := 1\n y := 2 }",
];

/// The id of a part of a chart; now and then one that does not exist.
fn an_id(rng: &mut Rng, doc: &Document) -> Value {
    let charts: Vec<_> = doc.charts().collect();
    let Some(chart) = rng.pick(&charts) else { return json!("G/s/1") };
    let name = g7_edit::ItemId::chart(&*chart.name.text).to_string();
    let steps: Vec<_> = chart.steps().collect();
    let transitions = chart.transitions().count();
    let step = rng.pick(&steps);
    let escaped = step.map_or("x".to_owned(), |s| g7_edit::ItemId::chart(&*s.name.text).to_string());
    let beyond = usize::from(rng.below(20) == 0);
    let n = rng.below(transitions + beyond);
    let t = chart.transitions().nth(n);
    let ends: Vec<_> = t.map(|t| t.from.iter().chain(&t.to).collect()).unwrap_or_default();
    let end = rng.pick(&ends).map_or("1".to_owned(), |e| g7_edit::ItemId::chart(&*e.text).to_string());
    let before = t.is_some_and(|t| t.from.iter().any(|f| *f.text == *end));
    match rng.below(13) {
        0..=4 => json!(format!("{name}/s/{escaped}")),
        5..=8 => json!(format!("{name}/t/{n}")),
        9 if before => json!(format!("{name}/l/s:{end}>t:{n}")),
        9 => json!(format!("{name}/l/t:{n}>s:{end}")),
        10 => json!(format!("{name}/a/{escaped}/{}", rng.below(3))),
        11 => json!(format!("{name}/n/{}", rng.below(3))),
        _ => json!(name),
    }
}

fn ids(rng: &mut Rng, doc: &Document) -> Value {
    let n = 1 + rng.below(5);
    let all: Vec<Value> = (0..n).map(|_| an_id(rng, doc)).collect();
    // Mostly parts of one chart.
    let first = all.first().and_then(Value::as_str).unwrap_or_default().to_owned();
    let home = first.split('/').next().unwrap_or_default();
    let own = all.iter().filter(|v| v.as_str().unwrap_or_default().starts_with(home));
    Value::Array(own.cloned().collect())
}

fn chart(rng: &mut Rng, doc: &Document) -> String {
    let charts: Vec<_> = doc.charts().collect();
    rng.pick(&charts).map_or("G".to_owned(), |c| c.name.text.to_string())
}

fn variable(rng: &mut Rng, doc: &Document) -> String {
    let mut names: Vec<String> = Vec::new();
    for item in &doc.items {
        match item {
            g7_model::Item::Var(v) => names.extend(v.names.iter().map(|n| n.text.to_string())),
            g7_model::Item::Chart(c) => {
                names.extend(c.vars().flat_map(|v| &v.names).map(|n| format!("{}.{}", c.name.text, n.text)));
            }
            _ => {}
        }
    }
    rng.pick(&names).cloned().unwrap_or_default()
}

/// An arbitrary gesture.
fn a_gesture(rng: &mut Rng, text: &str, doc: &Document) -> Value {
    let id = an_id(rng, doc);
    let or_and = if rng.below(2) == 0 { "or" } else { "and" };
    match rng.below(34) {
        0 => json!({"g": "add_step", "chart": chart(rng, doc), "at": [rng.below(900) as f64, -12.5]}),
        1 => json!({"g": "add_step", "chart": chart(rng, doc)}),
        2 | 3 => json!({"g": "next", "id": id}),
        4 => json!({"g": "before", "id": id}),
        5 | 6 => json!({"g": "connect", "from": id, "to": an_id(rng, doc)}),
        7 | 8 => {
            let what = rng.text(&["step", "transition", "macro", "enclosing"]);
            json!({"g": "insert", "link": id, "what": what})
        }
        9 => json!({"g": "branch", "id": id, "how": or_and}),
        10 => json!({"g": "converge", "ids": ids(rng, doc), "how": or_and}),
        11 => json!({"g": "converge", "ids": ids(rng, doc), "how": or_and, "to": id}),
        12 => json!({"g": "jump", "id": id, "to": an_id(rng, doc)}),
        13 => json!({"g": "parallel", "ids": ids(rng, doc)}),
        14 | 15 => json!({"g": "delete", "ids": ids(rng, doc), "heal": rng.below(2) == 0}),
        16 => json!({"g": "rename", "id": id, "to": rng.text(NAMES)}),
        17 => json!({"g": "rename", "name": variable(rng, doc), "to": rng.text(NAMES)}),
        18 => json!({"g": "receptivity", "id": id, "text": rng.text(EXPRESSIONS)}),
        19 => json!({"g": "action", "id": id, "text": rng.text(ACTIONS)}),
        20 => json!({"g": "action", "id": id, "index": rng.below(3), "text": rng.text(ACTIONS)}),
        21 => json!({"g": "comment", "id": id, "text": rng.text(NAMES)}),
        22 => json!({"g": "label", "id": id, "text": rng.text(NAMES)}),
        23 => json!({"g": "priority", "id": id, "n": if rng.below(2) == 0 { json!(null) } else { json!(3) }}),
        24 => json!({"g": "initial", "id": id, "on": rng.below(2) == 0}),
        25 => {
            let kind = rng.text(&["plain", "macro", "enclosing", "entry", "exit"]);
            json!({"g": "kind", "id": id, "kind": kind})
        }
        26 => json!({"g": "move", "ids": ids(rng, doc), "dx": 13.0, "dy": -0.37}),
        27 => {
            let how = rng.text(&["left", "top", "center", "distribute_x", "distribute_y"]);
            json!({"g": "align", "ids": ids(rng, doc), "how": how})
        }
        28 => {
            let (document, _) = read(text);
            let source = Source { text, document: &document, problems: &[], marks: None };
            let chosen: Vec<g7_edit::ItemId> = serde_json::from_value(ids(rng, doc)).unwrap_or_default();
            json!({"g": "paste", "chart": chart(rng, doc), "text": copy(&source, &chosen), "at": [40, 50]})
        }
        29 => json!({"g": "macro", "ids": ids(rng, doc)}),
        30 => match rng.below(7) {
            4 => {
                json!({"g": "switch", "name": rng.text(&["one-pass", "stable", "x"]), "on": rng.below(2) == 0})
            }
            5 => json!({"g": "bound", "n": rng.below(3)}),
            6 => {
                let steps = json!([rng.text(&["1", "2", "E"]), rng.text(&["2", "3", "S"])]);
                json!({"g": "ends", "id": id, "before": steps, "after": ["1"]})
            }
            0 => json!({"g": "add_chart", "kind": rng.text(&["chart", "expansion", "task"])}),
            1 => json!({"g": "tidy", "chart": chart(rng, doc)}),
            2 => json!({"g": "profile", "name": rng.text(&["pl7", "unity", "what"])}),
            _ => json!({"g": "scan", "ms": rng.below(50) as f64 / 4.0}),
        },
        32 => json!({"g": "relink", "link": id, "end": rng.text(&["from", "to"]), "to": an_id(rng, doc)}),
        31 => {
            let text = rng.text(&["a note", "", "two\nlines \"quoted\"", "`b\\`"]);
            json!({"g": "comment_at", "chart": chart(rng, doc), "text": text, "at": [rng.below(400), -7.25]})
        }
        _ => match rng.below(3) {
            0 => json!({"g": "delete_variable", "name": variable(rng, doc)}),
            1 => {
                let row = json!({"name": rng.text(NAMES), "class": rng.text(&["input", "output", "var"]),
                    "type": "INT", "init": rng.text(&["", "16#0F", "3 + (4)"]), "comment": "new"});
                json!({"g": "variable", "name": null, "row": row})
            }
            _ => {
                let name = variable(rng, doc);
                let own = name.rsplit('.').next().unwrap_or_default();
                let row = json!({"name": own, "class": "var", "type": "INT", "init": "16#0F",
                    "address": rng.text(&["", "%MW3", "chan 1"]), "comment": rng.text(NAMES)});
                json!({"g": "variable", "name": name, "row": row})
            }
        },
    }
}

/// Plays a series of gestures on a text; returns how many were accepted.
fn play(seed: u64, first: &str, length: usize) -> usize {
    let mut rng = Rng(seed);
    let mut history = History::default();
    let mut text = first.to_owned();
    let mut accepted = 0;
    for k in 0..length {
        let (doc, clean) = read(&text);
        assert!(clean);
        let value = a_gesture(&mut rng, &text, &doc);
        let Ok(gesture) = serde_json::from_value::<Gesture>(value.clone()) else { continue };
        let told = || format!("seed {seed}, gesture {k}: {value}\n--- before\n{text}");
        match run(&text, &gesture) {
            Ok(edit) => {
                let after =
                    spliced(&text, &edit.splices).unwrap_or_else(|| panic!("does not fit: {}", told()));
                let (doc, clean) = read(&after);
                assert!(clean, "not clean: {}\n--- after\n{after}", told());
                let takes = [
                    "delete",
                    "delete_variable",
                    "macro",
                    "action",
                    "tidy",
                    "paste",
                    "kind",
                    "comment",
                    "switch",
                    "bound",
                ];
                if !takes.contains(&value["g"].as_str().unwrap_or_default()) {
                    let (before, _) = read(&text);
                    let mut left = doc.notes.iter();
                    let kept = before.notes.iter().all(|n| left.any(|l| l == n));
                    assert!(kept, "notes: {}\n--- after\n{after}", told());
                }
                for id in edit.select.iter().chain(&edit.begin) {
                    assert!(known(&doc, id), "no {id}: {}\n--- after\n{after}", told());
                }
                assert!(history.record(&text, &edit.splices, false));
                accepted += usize::from(!edit.splices.is_empty());
                text = after;
            }
            Err(why) => {
                let why = why.to_string();
                let typed = matches!(
                    gesture,
                    Gesture::Receptivity { .. } | Gesture::Action { .. } | Gesture::Variable { .. }
                );
                assert!(typed || !why.contains("cannot be written"), "{why}: {}", told());
            }
        }
        if text.len() > 60_000 {
            break;
        }
    }
    let last = text.clone();
    while let Some(back) = history.undo(&text) {
        text = spliced(&text, &back).expect("what is undone fits");
    }
    assert_eq!(text, first, "seed {seed}: undone");
    while let Some(there) = history.redo(&text) {
        text = spliced(&text, &there).expect("what is done again fits");
    }
    assert_eq!(text, last, "seed {seed}: done again");
    accepted
}

/// True if an id names a part of the document.
fn known(doc: &Document, id: &g7_edit::ItemId) -> bool {
    use g7_edit::Part;
    let Some(chart) = doc.charts().find(|c| *c.name.text == *id.chart) else { return false };
    let step = |name: &str| chart.steps().find(|s| *s.name.text == *name);
    match &id.part {
        Part::Chart => true,
        Part::Step(name) => step(name).is_some(),
        Part::Action(name, k) => step(name).is_some_and(|s| *k < s.actions.len()),
        Part::Transition(n) => chart.transitions().nth(*n).is_some(),
        Part::Note(n) => {
            let layout = doc.items.iter().find_map(|i| match i {
                g7_model::Item::Layout(l) if l.chart == chart.name => Some(l),
                _ => None,
            });
            let note = |p: &&g7_model::PlaceAt| matches!(p.what, g7_model::Placed::Comment(_));
            layout.is_some_and(|l| l.places.iter().filter(note).nth(*n).is_some())
        }
        Part::Link(..) | Part::Connector(..) | Part::Other(_) => true,
    }
}

#[test]
fn random_series_keep_the_text_clean_and_can_be_undone() {
    let rounds: u64 = std::env::var("G7_ROUNDS").ok().and_then(|n| n.parse().ok()).unwrap_or(4);
    let mut accepted = 0;
    for (k, text) in texts().iter().enumerate() {
        assert!(read(text).1, "text {k} is clean");
        for round in 0..rounds {
            accepted += play(1000 * k as u64 + round, text, 40);
        }
    }
    assert!(accepted > 400, "only {accepted} gestures were accepted");
}

#[test]
fn an_error_in_another_item_stays_as_it_is() {
    let mut accepted = 0;
    for (k, text) in texts().iter().enumerate() {
        let mut rng = Rng(77 + k as u64);
        let mut text = format!("test \"later\" {{\n  set zz :=\n}}\n\n{text}");
        for _ in 0..30 {
            let tree = Tree::read(text.clone(), FileId(0));
            let gesture = serde_json::from_value::<Gesture>(a_gesture(&mut rng, &text, &tree.document));
            let Ok(gesture) = gesture else { continue };
            if matches!(gesture, Gesture::Text { .. }) {
                continue;
            }
            let Ok(edit) = run(&text, &gesture) else { continue };
            let after = Tree::read(spliced(&text, &edit.splices).expect("it fits"), FileId(0));
            assert_eq!(after.problems, tree.problems, "{gesture:?} in\n{text}");
            accepted += usize::from(!edit.splices.is_empty());
            text = after.text;
        }
    }
    assert!(accepted > 100, "only {accepted} gestures were accepted");
}

#[test]
fn nothing_makes_it_panic() {
    let mut rng = Rng(7);
    let odd = [
        "",
        "/",
        "G/s/",
        "G/t/99999999999999999999",
        "G/l/s:1>s:2",
        "%",
        "é/s/é",
        "G/a/1/9",
        "G/n/7",
        "G/x/0",
    ];
    for text in texts() {
        // The text is cut anywhere, so that most of the pasted texts are wrong.
        let cut = (0..=rng.below(text.len() + 1)).rev().find(|n| text.is_char_boundary(*n)).unwrap_or(0);
        for text in [text.as_str(), text.get(..cut).unwrap_or_default()] {
            let (doc, _) = read(text);
            for _ in 0..12 {
                let mut value = a_gesture(&mut rng, text, &doc);
                if let (Some(fields), 0) = (value.as_object_mut(), rng.below(2)) {
                    for (_, v) in fields.iter_mut().filter(|(k, _)| *k != "g" && *k != "how" && *k != "kind")
                    {
                        if v.is_string() {
                            *v = json!(rng.text(&odd));
                        } else if v.is_number() {
                            *v = json!(1e300);
                        }
                    }
                }
                if let Ok(gesture) = serde_json::from_value::<Gesture>(value) {
                    let answer = run(text, &gesture);
                    assert!(
                        answer.map_or_else(
                            |e| !e.to_string().is_empty(),
                            |e| spliced(text, &e.splices).is_some()
                        )
                    );
                }
            }
        }
    }
}

#[test]
fn a_macro_step_brings_its_expansion_along() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/structure/macro-step.g7");
    let text = std::fs::read_to_string(root).expect("readable");
    let (document, _) = read(&text);
    let source = Source { text: &text, document: &document, problems: &[], marks: None };
    let part = copy(&source, &[g7_edit::ItemId::step("Station", "M3")]);
    let (doc, clean) = read(&part);
    assert!(clean);
    let names: Vec<&str> = doc.charts().map(|c| &*c.name.text).collect();
    assert_eq!(names, ["Station", "Drill", "Clear"]);
    let first = doc.charts().next().and_then(|c| c.steps().next()).map(|s| s.kind.clone());
    assert!(matches!(first, Some(StepKind::Macro(name)) if &*name.text == "Drill"));
}
