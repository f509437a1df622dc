//! Files in the page: messages and answers.
#![allow(clippy::disallowed_methods, reason = "the tests read the examples")]

use crate::common;

use std::collections::BTreeSet;

use common::{Asked, Chance, examples};
use serde_json::{Value, json};

const CHART: &str = "input a : BOOL\noutput q : BOOL \"lämp\"\nchart G {\n  initial step 1\n  step 2 { N q }\n  1 -> 2 when aa\n  2 -> 1 when not a\n}\n";

#[test]
fn a_file_at_a_glance() {
    let mut page = Asked::default();
    let look = page.open(CHART);
    assert_eq!(look["charts"][0]["name"], "G");
    assert_eq!(
        (look["charts"][0]["steps"].as_u64(), look["charts"][0]["transitions"].as_u64()),
        (Some(2), Some(2))
    );
    assert_eq!(
        (&look["clean"], &look["profile"], &look["scan_ms"]),
        (&json!(true), &json!("iec60848"), &json!(10.0))
    );
    assert_eq!(look["length"], CHART.encode_utf16().count());
    assert_eq!(page.no(json!({ "do": "look", "file": "b.g7" })), "b.g7 is not open");
}

#[test]
fn a_problem_has_its_place_in_code_units_its_symbol_and_a_fix() {
    let mut page = Asked::default();
    let text = format!("// 😀 ö\n{CHART}");
    let look = page.open(&text);
    let problem = &look["problems"][0];
    let at = text.encode_utf16().collect::<Vec<_>>().windows(2).position(|w| w == [97, 97]).expect("aa");
    assert_eq!((problem["from"].as_u64(), problem["to"].as_u64()), (Some(at as u64), Some(at as u64 + 2)));
    assert_eq!(
        (&problem["code"], &problem["line"], &problem["column"]),
        (&json!("G0202"), &json!(7), &json!(15))
    );
    assert_eq!(problem["items"], json!(["G/t/0"]));
    assert_eq!(problem["fixes"][0]["title"], "write `a`");
    let mended = page.ok(json!({
        "do": "splice", "file": "a.g7", "splices": problem["fixes"][0]["splices"], "unit": true,
    }));
    assert_eq!(mended["problems"], json!([]));
    assert_eq!(page.text(), text.replace("aa", "a"));
}

#[test]
fn a_syntax_error_keeps_the_last_good_drawing() {
    let mut page = Asked::default();
    page.open(CHART);
    let drawing = json!({ "do": "drawing", "file": "a.g7", "chart": "G" });
    let good = page.ok(drawing.clone());
    assert_eq!(good["stale"], false);
    let broken = |from: usize, to: usize| {
        let splices = json!([{ "from": from, "to": to, "insert": "{{{" }]);
        json!({ "do": "splice", "file": "a.g7", "splices": splices })
    };
    // Outside of the chart: it is drawn from the present text.
    page.ok(broken(0, 5));
    assert_eq!(page.ok(drawing.clone())["stale"], false);
    page.ok(json!({ "do": "undo", "file": "a.g7" }));
    let before = CHART.split("-> 2").next().expect("the text before an arrow");
    let at = before.encode_utf16().count();
    let look = page.ok(broken(at, at + 2));
    assert_eq!((&look["clean"], &look["charts"][0]["name"]), (&json!(false), &json!("G")));
    let kept = page.ok(drawing.clone());
    assert_eq!(kept["stale"], true);
    assert_eq!(kept["items"], good["items"]);
    page.ok(json!({ "do": "undo", "file": "a.g7" }));
    assert_eq!(page.ok(drawing), good);
}

#[test]
fn a_drawing_names_what_it_shows() {
    let mut page = Asked::default();
    page.open(CHART);
    let drawing = page.ok(json!({ "do": "drawing", "file": "a.g7", "chart": "G" }));
    let items = drawing["items"].as_array().expect("items");
    let find = |id: &str| items.iter().find(|i| i["id"] == id).unwrap_or_else(|| panic!("{id}"));
    let step = find("G/s/1");
    assert_eq!(
        (&step["part"], &step["initial"], &step["step"]),
        (&json!("step"), &json!(true), &json!("plain"))
    );
    assert_eq!(step["square"][2], 50.0, "a step is 5 u wide, a u is 10 px");
    assert_eq!(find("G/a/2/0")["source"], "N q");
    assert_eq!(find("G/t/1")["source"], "not a");
    let (from, to) = (step["from"].as_u64().expect("a place"), step["to"].as_u64().expect("a place"));
    let units: Vec<u16> = CHART.encode_utf16().collect();
    assert_eq!(String::from_utf16_lossy(&units[from as usize..to as usize]), "initial step 1");
    let links = items.iter().filter(|i| i["part"] == "link");
    for link in links {
        assert!(link["ends"][0].as_str().is_some_and(|e| e.starts_with("G/")), "{link}");
    }
}

#[test]
fn ids_are_unique_in_every_example() {
    let mut page = Asked::default();
    for (path, text) in examples() {
        let look = page.open(&text);
        for chart in look["charts"].as_array().expect("charts") {
            for look in ["iec60848", "sfc"] {
                let drawing =
                    page.ok(json!({ "do": "drawing", "file": "a.g7", "chart": chart["name"], "look": look }));
                let items = drawing["items"].as_array().expect("items");
                let ids: BTreeSet<&str> = items.iter().filter_map(|i| i["id"].as_str()).collect();
                assert_eq!(ids.len(), items.len(), "{path}: {}", chart["name"]);
                let steps = items.iter().filter(|i| i["part"] == "step").count();
                assert_eq!(steps as u64, chart["steps"].as_u64().expect("a number"), "{path}");
            }
        }
    }
}

#[test]
fn undoing_everything_gives_the_first_text() {
    let mut chance = Chance(5);
    let mut changes = 0;
    for (path, text) in examples() {
        let mut page = Asked::default();
        page.open(&text);
        for _ in 0..25 {
            changes += usize::from(change(&mut page, &mut chance));
        }
        while page.ask(json!({ "do": "redo", "file": "a.g7" })).is_ok() {}
        let last = page.text();
        while page.ask(json!({ "do": "undo", "file": "a.g7" })).is_ok() {}
        assert!(page.text() == text, "{path}");
        while page.ask(json!({ "do": "redo", "file": "a.g7" })).is_ok() {}
        assert!(page.text() == last, "{path}");
    }
    assert!(changes > 150, "only {changes} changes were accepted");
}

/// A random gesture or random typing; true if it was accepted.
fn change(page: &mut Asked, chance: &mut Chance) -> bool {
    let look = page.ok(json!({ "do": "look", "file": "a.g7" }));
    let charts = look["charts"].as_array().cloned().unwrap_or_default();
    if chance.below(4) == 0 || charts.is_empty() {
        let length = look["length"].as_u64().unwrap_or(0) as usize;
        let from = chance.below(length + 1);
        let to = (from + chance.below(3)).min(length);
        let insert = *chance.one(&["x", " ", "ö", "1", "}", ""]);
        let splices = json!([{ "from": from, "to": to, "insert": insert }]);
        let done = page.ask(json!({ "do": "splice", "file": "a.g7", "splices": splices }));
        // Most faulty texts are undone, so that gestures find a chart.
        if chance.below(3) > 0 {
            page.ask(json!({ "do": "undo", "file": "a.g7" })).ok();
        }
        return done.is_ok();
    }
    let chart = chance.one(&charts)["name"].clone();
    let drawing = page.ok(json!({ "do": "drawing", "file": "a.g7", "chart": chart }));
    let ids: Vec<Value> =
        drawing["items"].as_array().into_iter().flatten().map(|i| i["id"].clone()).collect();
    let id = if ids.is_empty() { Value::Null } else { chance.one(&ids).clone() };
    let gesture = match chance.below(9) {
        0 => json!({ "g": "next", "id": id }),
        1 => json!({ "g": "before", "id": id }),
        2 => json!({ "g": "delete", "ids": [id], "heal": chance.below(2) == 0 }),
        3 => json!({ "g": "add_step", "chart": chart }),
        4 => json!({ "g": "comment", "id": id, "text": "note" }),
        5 => json!({ "g": "receptivity", "id": id, "text": "TRUE" }),
        6 => json!({ "g": "move", "ids": [id], "dx": 20, "dy": 10 }),
        7 => json!({ "g": "branch", "id": id, "how": "or" }),
        _ => json!({ "g": "initial", "id": id, "on": true }),
    };
    page.ask(json!({ "do": "edit", "file": "a.g7", "gesture": gesture })).is_ok()
}

#[test]
fn splices_of_an_edit_make_the_text_view_the_same_text() {
    let mut page = Asked::default();
    let before = format!("// ö😀\n{}", CHART.replace("aa", "a"));
    page.open(&before);
    let edited = page.ok(json!({ "do": "edit", "file": "a.g7", "gesture": { "g": "next", "id": "G/s/2" } }));
    assert_eq!(replay(&before, &edited["splices"]), page.text());
    assert_ne!(page.text(), before);
    let after = page.text();
    let undone = page.ok(json!({ "do": "undo", "file": "a.g7" }));
    assert_eq!(replay(&after, &undone["splices"]), before);
    page.open("chart  G{\ninitial step 1}\n");
    let formatted = page.ok(json!({ "do": "format", "file": "a.g7" }));
    assert_eq!(replay("chart  G{\ninitial step 1}\n", &formatted["splices"]), page.text());
    assert!(page.text().starts_with("chart G {"), "{}", page.text());
}

/// Applies splices like an editor of UTF-16 text.
fn replay(text: &str, splices: &Value) -> String {
    let mut units: Vec<u16> = text.encode_utf16().collect();
    for s in splices.as_array().expect("splices").iter().rev() {
        let at = |key: &str| s[key].as_u64().expect("a place") as usize;
        units.splice(at("from")..at("to"), s["insert"].as_str().expect("a text").encode_utf16());
    }
    String::from_utf16(&units).expect("whole characters")
}

#[test]
fn typing_within_a_word_is_undone_at_once() {
    let mut page = Asked::default();
    page.open("");
    for (k, c) in "input".chars().enumerate() {
        page.ok(json!({ "do": "splice", "file": "a.g7", "splices": [{ "from": k, "to": k, "insert": c }] }));
    }
    page.ok(json!({ "do": "undo", "file": "a.g7" }));
    assert_eq!(page.text(), "");
    assert_eq!(page.no(json!({ "do": "undo", "file": "a.g7" })), "nothing to undo");
}

#[test]
fn completion_knows_where_it_stands() {
    let mut page = Asked::default();
    let labels = |page: &mut Asked, text: &str| -> Vec<String> {
        let at = text.find('|').expect("a place");
        page.open(&text.replace('|', ""));
        let done = page.ok(json!({ "do": "complete", "file": "a.g7", "at": at }));
        let items = done["items"].as_array().expect("items").clone();
        items.iter().filter_map(|i| i["label"].as_str().map(str::to_owned)).collect()
    };
    let has = |list: &[String], word: &str| list.iter().any(|l| l == word);
    let head = "input start : BOOL\nchart G {\n initial step 1\n step 20\n";
    let receptivity = labels(&mut page, &format!("{head} 1 -> 20 when st|\n}}\n"));
    assert_eq!(receptivity.first().map(String::as_str), Some("start"));
    let steps = labels(&mut page, &format!("{head} 1 -> |\n}}\n"));
    assert!(has(&steps, "20") && has(&steps, "1"), "{steps:?}");
    let types = labels(&mut page, &format!("input b : |\n{head}}}\n"));
    assert!(has(&types, "BOOL") && !has(&types, "start"), "{types:?}");
    let actions = labels(&mut page, &format!("{head} step 3 {{ |\n}}\n}}\n"));
    assert!(has(&actions, "N") && has(&actions, "force") && has(&actions, "start"), "{actions:?}");
    let file = labels(&mut page, &format!("ch|\n{head}}}\n"));
    assert_eq!(file.first().map(String::as_str), Some("chart"));
    let members = labels(&mut page, &format!("var c : CTU\n{head} 1 -> 20 when c.|\n}}\n"));
    assert!(has(&members, "Q") && has(&members, "CV") && !has(&members, "start"), "{members:?}");
}

#[test]
fn words_say_what_they_are_and_where_they_are_used() {
    let mut page = Asked::default();
    let text = CHART.replace("aa", "a");
    page.open(&text);
    let at = |what: &str| text.find(what).expect("there");
    let hover = page.ok(json!({ "do": "hover", "file": "a.g7", "at": at("q }") }));
    assert_eq!(hover["markdown"], "`output q : BOOL`  \nlämp");
    let uses = page.ok(json!({ "do": "references", "file": "a.g7", "at": at("a :") }));
    assert_eq!(uses.as_array().map(Vec::len), Some(3), "{uses}");
    let steps = page.ok(json!({ "do": "references", "file": "a.g7", "at": at("2 {") }));
    assert_eq!(steps.as_array().map(Vec::len), Some(3), "declared, led to, left: {steps}");
    let hits = page.ok(json!({ "do": "search", "file": "a.g7", "text": "LÄMP" }));
    assert_eq!((&hits[0]["line"], hits.as_array().map(Vec::len)), (&json!(2), Some(1)));
    let symbols = page.ok(json!({ "do": "symbols", "file": "a.g7" }));
    assert_eq!(symbols["variables"][1]["comment"], "lämp");
    assert_eq!(symbols["steps"][0]["initial"], true);
    let tokens = page.ok(json!({ "do": "tokens", "file": "a.g7" }));
    let classes: Vec<&str> =
        tokens.as_array().expect("tokens").iter().take(4).filter_map(|t| t[2].as_str()).collect();
    assert_eq!(classes, ["keyword", "variable", "punctuation", "type"]);
}

#[test]
fn a_foreign_file_becomes_a_text_of_ours() {
    let mut page = Asked::default();
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/interchange/jgrafchart");
    let mut seen = 0;
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        let Ok(text) = std::fs::read_to_string(&path) else { continue };
        if path.extension().is_none_or(|e| e != "xml") {
            continue;
        }
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        let Ok(look) = page.ask(json!({ "do": "open", "file": name, "text": text })) else { continue };
        seen += 1;
        assert_eq!((&look["imported"], &look["clean"]), (&json!(true), &json!(true)), "{name}");
        assert_eq!(look["file"], name.replace(".xml", ".g7"));
    }
    assert!(seen > 0, "no foreign file could be read");
}

#[test]
fn tests_are_run_and_a_failure_has_its_place() {
    let mut page = Asked::default();
    let text = format!(
        "{}test \"comes on\" {{\n set a := TRUE\n expect q\n}}\ntest \"fails\" {{\n expect q\n}}\n",
        CHART.replace("aa", "a")
    );
    page.open(&text);
    let report = page.ok(json!({ "do": "test", "file": "a.g7" }));
    assert_eq!((&report["passed"], &report["failed"]), (&json!(1), &json!(1)));
    let failure = &report["tests"][1]["failure"];
    let units: Vec<u16> = text.encode_utf16().collect();
    let at = failure["from"].as_u64().expect("a place") as usize
        ..failure["to"].as_u64().expect("a place") as usize;
    assert_eq!(String::from_utf16_lossy(&units[at]), "q");
    assert_eq!(failure["message"], "expected: q");
    let one = page.ok(json!({ "do": "test", "file": "a.g7", "name": "comes" }));
    assert_eq!(one["tests"].as_array().map(Vec::len), Some(1));

    // Why it failed, with the run up to there; a test that passes has no reasons.
    let why = page.ok(json!({ "do": "test_why", "file": "a.g7", "name": "fails" }));
    assert_eq!(why["lines"][0]["said"], "`q` is FALSE since the start");
    assert_eq!(why["run"].as_array().map(Vec::len), Some(1), "{why}");
    let passed = page.ok(json!({ "do": "test_why", "file": "a.g7", "name": "comes on" }));
    assert_eq!(passed, json!({ "lines": [] }));
    let refused = page.no(json!({ "do": "test_why", "file": "b.g7", "name": "fails" }));
    assert!(refused.contains("b.g7"), "{refused}");
}

#[test]
fn every_fix_mends_its_problem() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/check");
    let (mut tried, mut codes) = (0, BTreeSet::new());
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        let Ok(text) = std::fs::read_to_string(&path) else { continue };
        let mut page = Asked::default();
        let look = page.open(&text);
        let mut version = look["version"].clone();
        for (n, problem) in look["problems"].as_array().expect("problems").iter().enumerate() {
            for (f, fix) in problem["fixes"].as_array().expect("fixes").iter().enumerate() {
                let mended = page.ok(match fix["splices"].as_array() {
                    Some(splices) => {
                        json!({ "do": "splice", "file": "a.g7", "splices": splices, "unit": true })
                    }
                    None => {
                        json!({ "do": "mend", "file": "a.g7", "version": version, "problem": n, "fix": f })
                    }
                });
                let same = |look: &Value| {
                    let all = look["problems"].as_array().expect("problems");
                    all.iter()
                        .filter(|p| p["code"] == problem["code"] && p["what"] == problem["what"])
                        .count()
                };
                let at = format!("{}: {} by {}", path.display(), problem["what"], fix["title"]);
                assert!(same(&mended) < same(&look), "{at}");
                assert!(mended["clean"] == true || look["clean"] == false, "{at}");
                tried += 1;
                codes.insert(problem["code"].to_string());
                version = page.ok(json!({ "do": "undo", "file": "a.g7" }))["version"].clone();
            }
        }
    }
    assert!(tried > 20 && codes.len() > 7, "{tried} fixes of {codes:?}");
}

#[test]
fn a_chart_leaves_in_every_form_that_is_listed() {
    let mut page = Asked::default();
    // One pass a scan, because Ladder has no search for stability.
    page.open(&format!("profile iec61131\n{}", CHART.replace("when aa", "when a")));
    let forms = page.ok(json!({ "do": "forms" }));
    let words: Vec<&str> =
        forms.as_array().expect("a list").iter().filter_map(|f| f["word"].as_str()).collect();
    assert!(words.contains(&"mermaid") && words.contains(&"svg"), "{words:?}");
    // All that `g7 gen` prints as text.
    for form in g7_codegen::plc::Form::ALL {
        assert!(words.contains(&form.word()), "{}", form.word());
    }
    for word in words {
        let out = page.ok(json!({ "do": "export", "file": "a.g7", "to": word }));
        let file =
            out["files"].as_array().and_then(|files| files.last()).expect("the main file, the last one");
        assert!(file["name"].as_str().is_some_and(|n| n.starts_with("a.")), "{word}: {out}");
        assert!(file["text"].as_str().is_some_and(|t| t.len() > 100), "{word}: {out}");
    }
    for (word, names) in [
        ("c", ["g7.h", "g7.c", "a_run.h", "a.h", "a.c"].as_slice()),
        ("awl", &["a.asc", "a.awl"]),
        ("scl", &["a.tags.xml", "a.scl"]),
    ] {
        let out = page.ok(json!({ "do": "export", "file": "a.g7", "to": word }));
        let files = out["files"].as_array().expect("files").iter();
        let got: Vec<&str> = files.filter_map(|f| f["name"].as_str()).collect();
        assert_eq!(got, names, "as the command line names them");
    }
    let why = page.no(json!({ "do": "export", "file": "a.g7", "to": "nothing" }));
    assert_eq!(why, "there is no form `nothing`");
    page.open(&CHART.replace("when aa", "when a"));
    let out = page.ok(json!({ "do": "export", "file": "a.g7", "to": "ladder" }));
    assert_eq!((&out["files"], &out["lossy"]), (&json!([]), &json!(true)));
    assert!(out["problems"][0]["what"].as_str().is_some_and(|w| w.contains("stability")), "{out}");
    page.open(CHART);
    let why = page.no(json!({ "do": "export", "file": "a.g7", "to": "mermaid" }));
    assert!(why.starts_with("the chart has errors: "), "{why}");
}

#[test]
fn the_code_of_a_step_is_marked() {
    let mut page = Asked::default();
    page.open(&CHART.replace("when aa", "when a"));
    for (word, ending) in [("c", "a.c"), ("rust", ".rs"), ("arduino", "a.c")] {
        let out = page.ok(json!({ "do": "export", "file": "a.g7", "to": word }));
        let files = out["files"].as_array().expect("files");
        let file =
            files.iter().find(|f| f["name"].as_str().is_some_and(|n| n.ends_with(ending))).expect("code");
        let lines: Vec<&str> = file["text"].as_str().expect("text").lines().collect();
        let mark =
            file["marks"].as_array().expect("marks").iter().find(|m| m["id"] == "G/s/2").expect("a mark");
        let marked = mark["lines"].as_array().expect("lines");
        assert!(!marked.is_empty());
        for line in marked {
            let line = lines[line.as_u64().expect("a number") as usize];
            assert!(line.contains("STEP_2"), "{word}: {line}");
        }
        assert!(marked.len() < lines.len() / 4, "{word}: not everything belongs to one step");
    }
}

#[test]
fn a_page_speaks_the_language_of_its_reader() {
    let mut page = Asked::default();
    page.ok(json!({ "do": "speak", "language": "fr" }));
    let look = page.open("input a : BOOL\nchart G {\n  initial step 1\n  1 -> 1 when b and a\n}\n");
    let said = |look: &serde_json::Value| look["problems"][0]["what"].as_str().unwrap_or_default().to_owned();
    assert_eq!(said(&look), "rien ne s’appelle `b`");
    assert_eq!(look["problems"][0]["title"], "un nom que rien ne porte");
    let hover = page.ok(json!({ "do": "hover", "file": "a.g7", "at": 0 }));
    let markdown = hover["markdown"].as_str().unwrap_or_default();
    assert!(markdown.contains("une valeur qui vient du procédé"), "{markdown}");
    let words = page.ok(json!({ "do": "complete", "file": "a.g7", "at": 3 }));
    assert!(words.to_string().contains("une valeur qui vient du procédé"), "{words}");
    page.ok(json!({ "do": "speak", "language": "pt-BR" }));
    assert_eq!(said(&page.ok(json!({ "do": "look", "file": "a.g7" }))), "nada se chama `b`");
    page.ok(json!({ "do": "speak", "language": "nl" }));
    assert_eq!(said(&page.ok(json!({ "do": "look", "file": "a.g7" }))), "nothing is called `b`");
}
