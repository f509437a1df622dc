//! Runs the cases of `tests/edit`: a text, a gesture, and the text that the rule asks for.
//!
//! A case is a `##` section with a block `g7` (before), a block `json` (one or more gestures, one
//! per line), and a block `g7` (after) or `no` (words of the refusal). A block `select` names the
//! parts that are selected afterwards; `begin` precedes the part whose field the user fills in
//! next. A block `told` has a part of each sentence for the user; without this block there must be
//! none.
#![allow(clippy::disallowed_methods, reason = "the test reads the cases")]

use std::path::Path;

use g7_edit::{Edit, Gesture, ItemId, Source, apply_placed, copy, spliced};
use g7_model::FileId;

struct Case {
    name: String,
    blocks: Vec<(String, String)>,
}

impl Case {
    fn block(&self, kind: &str, n: usize) -> Option<&str> {
        self.blocks.iter().filter(|(k, _)| k == kind).nth(n).map(|(_, t)| t.as_str())
    }
}

fn cases() -> Vec<Case> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/edit");
    let mut files: Vec<_> =
        std::fs::read_dir(folder).expect("the folder").flatten().map(|e| e.path()).collect();
    files.sort();
    let mut all = Vec::new();
    for file in files.iter().filter(|f| f.extension().is_some_and(|e| e == "md")) {
        let text = std::fs::read_to_string(file).expect("readable");
        let stem = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let mut block: Option<(String, String)> = None;
        let mut home: Option<Case> = None;
        for line in text.lines() {
            match &mut block {
                Some((kind, body)) if line == "```" => {
                    let done = (kind.clone(), body.clone());
                    block = None;
                    home.as_mut().expect("a block stands in a case").blocks.push(done);
                }
                Some((_, body)) => {
                    body.push_str(line);
                    body.push('\n');
                }
                None => {
                    if let Some(kind) = line.strip_prefix("```") {
                        block = Some((kind.to_owned(), String::new()));
                    } else if let Some(title) = line.strip_prefix("## ") {
                        all.extend(
                            home.replace(Case { name: format!("{stem}: {title}"), blocks: Vec::new() }),
                        );
                    }
                }
            }
        }
        assert!(block.is_none(), "{stem}: a block is not closed");
        all.extend(home);
    }
    all
}

/// Places for symbols: in rows, by the number of the step or transition in units of ten.
fn stands(id: &ItemId) -> Option<(i32, i32)> {
    let text = id.to_string();
    let number: i32 = text.rsplit('/').next()?.parse().ok()?;
    Some((number * 1000, number * 500))
}

fn run(text: &str, gesture: &Gesture) -> Result<Edit, String> {
    let (document, problems) = g7_syntax::parse(text, FileId(0));
    let source = Source { text, document: &document, problems: &problems, marks: None };
    apply_placed(&source, gesture, &stands).map_err(|e| e.to_string())
}

/// Runs a case; returns what is wrong, if anything.
fn wrong(case: &Case) -> Option<String> {
    let mut text = case.block("g7", 0)?.to_owned();
    let mut last = Edit::default();
    let mut refused = None;
    for line in case.block("json", 0).unwrap_or_default().lines() {
        let gesture: Gesture = match serde_json::from_str(line) {
            Ok(gesture) => gesture,
            Err(e) => return Some(format!("{e} in {line}")),
        };
        match run(&text, &gesture) {
            Ok(edit) => {
                text = spliced(&text, &edit.splices)?;
                last = edit;
            }
            Err(why) => refused = Some(why),
        }
    }
    let wanted = case.block("no", 0).map(str::trim);
    match (wanted, &refused) {
        (Some(part), Some(why)) if why.contains(part) => {}
        (Some(_), Some(why)) => return Some(format!("refused with: {why}")),
        (Some(_), None) => return Some(format!("not refused:\n{text}")),
        (None, Some(why)) => return Some(format!("refused: {why}")),
        (None, None) => {}
    }
    let after = case.block("g7", 1).or(case.block("g7", 0))?;
    if text != after {
        return Some(format!("--- expected\n{after}--- found\n{text}"));
    }
    let told: Vec<&str> = case.block("told", 0).unwrap_or_default().lines().collect();
    let fits = told.len() == last.told.len() && told.iter().zip(&last.told).all(|(w, t)| t.contains(w));
    if !fits {
        return Some(format!("told {:?}", last.told));
    }
    let select = case.block("select", 0)?;
    let mut found: Vec<String> = last.select.iter().map(ToString::to_string).collect();
    found.extend(last.begin.iter().map(|id| format!("begin {id}")));
    let wanted: Vec<&str> = select.lines().collect();
    (found != wanted).then(|| format!("selected {found:?}"))
}

#[test]
fn every_gesture_does_what_its_case_says() {
    let cases = cases();
    assert!(cases.len() > 60, "only {} cases were found", cases.len());
    let mut failed = String::new();
    for case in &cases {
        assert!(case.block("g7", 0).is_some() && case.block("json", 0).is_some(), "{}", case.name);
        assert!(case.block("g7", 1).is_some() != case.block("no", 0).is_some(), "{}", case.name);
        if let Some(why) = wrong(case) {
            failed.push_str(&format!("== {}\n{why}\n", case.name));
        }
    }
    assert!(failed.is_empty(), "{failed}");
}

#[test]
fn each_gesture_has_a_case() {
    let seen: String = cases().iter().filter_map(|c| c.block("json", 0)).collect();
    for gesture in [
        "add_step",
        "next",
        "before",
        "connect",
        "insert",
        "branch",
        "converge",
        "jump",
        "parallel",
        "delete",
        "rename",
        "receptivity",
        "action",
        "comment",
        "comment_at",
        "ends",
        "label",
        "priority",
        "initial",
        "kind",
        "move",
        "align",
        "tidy",
        "paste",
        "cut",
        "add_chart",
        "delete_chart",
        "macro",
        "variable",
        "delete_variable",
        "profile",
        "switch",
        "bound",
        "scan",
        "text",
    ] {
        assert!(seen.contains(&format!("\"g\":\"{gesture}\"")), "{gesture} has no case");
    }
}

#[test]
fn a_copy_has_what_was_chosen_and_no_links_to_the_rest() {
    let text = "chart G {\n  initial step 1 \"one\"\n  step 2 { N a }\n  step 3\n  1 -> 2 when a -> 3 when b\n  3 -> 1 when c\n}\n";
    let (document, _) = g7_syntax::parse(text, FileId(0));
    let source = Source { text, document: &document, problems: &[], marks: None };
    let ids = |list: &[&str]| list.iter().map(|t| t.parse().expect("an id")).collect::<Vec<ItemId>>();
    for (chosen, wanted) in [
        (&["G/s/2", "G/s/3"][..], "chart G {\n  step 2 { N a }\n  step 3\n\n  2 -> 3 when b\n}\n"),
        (&["G/s/2", "G/t/0"][..], "chart G {\n  step 2 { N a }\n\n  () -> 2 when a\n}\n"),
        (&["G/x/1", "H/s/1"][..], ""),
        (&[][..], ""),
    ] {
        assert_eq!(copy(&source, &ids(chosen)), wanted, "{chosen:?}");
    }
}

#[test]
fn new_lines_end_as_the_others_do() {
    let text = "chart G {\r\n\tinitial step 1\r\n\t1 -> 1 when a\r\n}\r\n";
    let next = Gesture::Next { id: ItemId::step("G", "1") };
    let edit = run(text, &next).expect("it can be done");
    let wanted =
        "chart G {\r\n\tinitial step 1\r\n\tstep 2\r\n\t1 -> 1 when a\r\n\t1 -> 2 when TRUE\r\n}\r\n";
    assert_eq!(spliced(text, &edit.splices).as_deref(), Some(wanted));
}
