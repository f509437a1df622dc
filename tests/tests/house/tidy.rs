//! The house rules, as tests: which crate may use which, how long a file may be,
//! what each has to have, what none may contain, which licences are fine.
//!
//! To change a rule, change it here in the same commit and say why in its message.
#![allow(clippy::disallowed_methods, reason = "the tests read the sources")]

mod circles;
mod invariants;
mod licences;
mod tongues;

use std::collections::BTreeSet;
use std::path::Path;

use g7_model::codes;
use g7_tests::house::{ends_in, files, none, read, root};

/// A crate, what it may use of ours, and of others (`None`: anything).
type Arrows = (&'static str, &'static [&'static str], Option<&'static [&'static str]>);

/// An arrow that is not here is not allowed.
const ALLOWED: &[Arrows] = &[
    ("say", &[], Some(&[])),
    ("library", &[], Some(&[])),
    ("model", &["g7-say"], Some(&[])),
    // It runs in the plant: nothing it did not bring but the functions of `libm`.
    ("engine", &[], Some(&["libm"])),
    ("syntax", &["g7-model", "g7-iec"], None),
    ("iec", &["g7-model"], Some(&["roxmltree"])),
    ("exchange", &["g7-model", "g7-syntax", "g7-iec", "g7-draw"], Some(&["roxmltree"])),
    // The libraries behind it can be replaced here alone.
    ("sat", &[], Some(&["batsat", "oxidd"])),
    ("compile", &["g7-model", "g7-engine", "g7-sat"], Some(&[])),
    // Its interpreter must give the last bit of a real that the engine gives.
    ("equations", &["g7-model", "g7-engine", "g7-compile"], Some(&["libm"])),
    // It runs in the plant as well; the build of codegen reads it, by `syn`.
    ("runtime", &[], Some(&["libm"])),
    (
        "codegen",
        &["g7-model", "g7-iec", "g7-engine", "g7-compile", "g7-equations", "g7-draw", "g7-runtime"],
        Some(&["syn"]),
    ),
    ("verify", &["g7-model", "g7-engine", "g7-compile", "g7-equations", "g7-rig", "g7-sat"], Some(&[])),
    ("grade", &["g7-model", "g7-syntax", "g7-compile", "g7-host", "g7-rig", "g7-verify"], Some(&[])),
    // Natively alone: it needs sockets, files and threads.
    ("hosts", &["g7-engine", "g7-verify"], Some(&["thiserror", "timely_bytes", "timely_communication"])),
    // It knows nothing of charts; foreign functions are called here alone.
    ("fmi", &[], Some(&["flate2", "libc", "libloading", "roxmltree", "zip"])),
    ("host", &["g7-model", "g7-engine"], None),
    ("why", &["g7-model", "g7-engine", "g7-compile", "g7-host"], Some(&[])),
    ("online", &["g7-model", "g7-engine", "g7-host", "g7-rig"], None),
    ("opcua", &["g7-model", "g7-host", "g7-store", "g7-online"], None),
    ("store", &["g7-model", "g7-host"], None),
    ("draw", &["g7-model"], Some(&[])),
    ("dossier", &["g7-model", "g7-compile", "g7-host", "g7-rig", "g7-ide", "g7-draw"], Some(&["roxmltree"])),
    ("edit", &["g7-model", "g7-syntax", "g7-compile"], Some(&["serde", "ts-rs"])),
    (
        "rig",
        &[
            "g7-library",
            "g7-model",
            "g7-syntax",
            "g7-exchange",
            "g7-engine",
            "g7-compile",
            "g7-host",
            "g7-why",
        ],
        Some(&["thiserror"]),
    ),
    (
        "ide",
        &["g7-model", "g7-syntax", "g7-iec", "g7-exchange", "g7-compile", "g7-draw", "g7-edit", "g7-rig"],
        Some(&[]),
    ),
    (
        "page",
        &[
            "g7-model",
            "g7-syntax",
            "g7-iec",
            "g7-exchange",
            "g7-engine",
            "g7-compile",
            "g7-codegen",
            "g7-host",
            "g7-draw",
            "g7-dossier",
            "g7-edit",
            "g7-ide",
            "g7-rig",
            "g7-verify",
            "g7-grade",
            "g7-why",
        ],
        Some(&["diffy", "serde", "serde_json", "ts-rs"]),
    ),
    (
        "g7",
        &[
            "g7-verify",
            "g7-why",
            "g7-hosts",
            "g7-fmi",
            "g7-model",
            "g7-syntax",
            "g7-exchange",
            "g7-engine",
            "g7-compile",
            "g7-codegen",
            "g7-host",
            "g7-online",
            "g7-opcua",
            "g7-store",
            "g7-draw",
            "g7-dossier",
            "g7-edit",
            "g7-grade",
            "g7-ide",
            "g7-rig",
            "g7-page",
        ],
        None,
    ),
];

/// Longest file, in lines.
const LONGEST: usize = 600;

/// A list that is made of Rust, and read name by name.
const LIST: &str = "web/src/lib/protocol.ts";

/// The keys of the tables of dependencies; dev-dependencies are free.
fn dependencies(manifest: &str) -> Vec<&str> {
    let mut found = Vec::new();
    let mut inside = false;
    for line in manifest.lines().map(str::trim) {
        if let Some(table) = line.strip_prefix('[') {
            let table = table.trim_end_matches(']');
            inside = table == "dependencies"
                || table == "build-dependencies"
                || table.starts_with("target.") && table.ends_with(".dependencies");
            if let Some(name) = table.strip_prefix("dependencies.") {
                found.push(name);
            }
        } else if inside && !line.starts_with('#') && !line.is_empty() {
            found.extend(line.split(['=', '.']).next().map(str::trim));
        }
    }
    found
}

#[test]
fn crates_use_only_what_the_table_allows() {
    let mut found = Vec::new();
    let mut seen = 0;
    for file in files() {
        let parts: Vec<_> = file.iter().map(|p| p.to_string_lossy().into_owned()).collect();
        let [place, name, manifest] = &parts[..] else { continue };
        if place != "crates" || manifest != "Cargo.toml" {
            continue;
        }
        seen += 1;
        let Some((_, ours, others)) = ALLOWED.iter().find(|(listed, ..)| listed == name) else {
            found.push(format!("crate `{name}` is not in the table"));
            continue;
        };
        for dependency in dependencies(&read(&file)) {
            let fine = match dependency.starts_with("g7-") {
                true => ours.contains(&dependency),
                false => others.is_none_or(|o| o.contains(&dependency)),
            };
            if !fine {
                found.push(format!("`{name}` may not depend on `{dependency}`"));
            }
        }
    }
    assert_eq!(seen, ALLOWED.len(), "crates found");
    none(&found, "arrows that are not in the table");
}

#[test]
fn files_of_a_crate_use_each_other_in_one_direction() {
    let mut found = Vec::new();
    for (name, ..) in ALLOWED {
        let source = Path::new("crates").join(name).join("src");
        let all = files();
        let inside = all.iter().filter(|f| ends_in(f, &["rs"])).filter_map(|f| {
            let short = f.strip_prefix(&source).ok()?;
            Some((short, read(f)))
        });
        let circles = circles::circles(&inside.collect::<Vec<_>>());
        found.extend(circles.iter().map(|c| format!("circle in `{name}`: {}", c.join(", "))));
    }
    none(&found, "files that use each other in a circle; move what both need into a file of its own");
}

#[test]
fn files_are_short_enough_to_be_read() {
    let ours = files().into_iter().filter(|f| ends_in(f, &["rs", "ts", "svelte"]));
    let long: Vec<String> = ours
        .map(|f| (read(&f).lines().count(), f))
        .filter(|(lines, f)| *lines > LONGEST && *f != Path::new(LIST))
        .map(|(lines, f)| format!("{}: {lines} lines", f.display()))
        .collect();
    none(&long, "files of more than 600 lines; split them by meaning");
}

/// "What a step holds" and "Whether a step is active" name no subject; "The content of a
/// step" and "True if a step is active" do.
#[test]
fn comments_begin_with_their_subject() {
    let mut found = Vec::new();
    for file in files().into_iter().filter(|f| ends_in(f, &["rs", "ts", "svelte"])) {
        for (i, line) in read(&file).lines().enumerate() {
            let words = line.trim_start().trim_start_matches(['/', '!', '*']).trim_start();
            let is_comment = line.trim_start().starts_with("//");
            if is_comment && (words.starts_with("What ") || words.starts_with("Whether ")) {
                found.push(format!("{}:{}", file.display(), i + 1));
            }
        }
    }
    none(&found, "comments that begin with What or Whether");
}

#[test]
fn modules_say_where_they_stand() {
    let mut found = Vec::new();
    for file in files() {
        let inside = file.starts_with("crates") && file.iter().any(|p| p == "src") && ends_in(&file, &["rs"]);
        let helper = file.starts_with("tests") && ends_in(&file, &["rs"]);
        if (inside || helper) && !read(&file).trim_start().starts_with("//!") {
            found.push(file.display().to_string());
        }
    }
    none(&found, "files without a header `//!`");
}

#[test]
fn crates_forbid_unsafe_code() {
    let mut found = Vec::new();
    for (name, ..) in ALLOWED {
        let main = format!("crates/{name}/src/main.rs");
        let file = if root().join(&main).is_file() { main } else { format!("crates/{name}/src/lib.rs") };
        // The names that a wasm module exports count as unsafe: in one file, and nothing else in it. The functions
        // of an FMU are foreign: they are called in one file.
        let word =
            if ["page", "fmi"].contains(name) { "#![deny(unsafe_code)]" } else { "#![forbid(unsafe_code)]" };
        if !read(&file).contains(word) {
            found.push(file);
        }
    }
    for file in files().into_iter().filter(|f| f.starts_with("crates") && f.iter().any(|p| p == "src")) {
        let text = read(&file);
        let exports = file.ends_with("page/src/wasm.rs") && !text.contains("unsafe {");
        let foreign = file.ends_with("fmi/src/library.rs");
        if ends_in(&file, &["rs"]) && text.contains("allow(unsafe_code") && !exports && !foreign {
            found.push(file.display().to_string());
        }
    }
    none(&found, "crates without `#![forbid(unsafe_code)]`");
}

#[test]
fn nothing_is_left_for_later() {
    // In two parts, so that this file does not hold them.
    let words = [
        ["TO", "DO"].concat(),
        ["FIX", "ME"].concat(),
        ["unimpl", "emented!"].concat(),
        ["to", "do!"].concat(),
        ["#[ig", "nore"].concat(),
    ];
    let mut found = Vec::new();
    for file in files().into_iter().filter(|f| ends_in(f, &["rs"])) {
        for (k, line) in read(&file).lines().enumerate() {
            for word in words.iter().filter(|w| has_word(line, w)) {
                found.push(format!("{}:{}: {word}", file.display(), k + 1));
            }
        }
    }
    none(&found, "words for unfinished work");
}

/// True if a word stands in a line, not as a part of a longer one.
fn has_word(line: &str, word: &str) -> bool {
    line.match_indices(word).any(|(at, _)| {
        let before = line.get(..at).and_then(|s| s.chars().next_back());
        let behind = line.get(at + word.len()..).and_then(|s| s.chars().next());
        let letter = |c: Option<char>| c.is_some_and(|c| c.is_alphanumeric() || c == '_');
        !letter(before) && (!word.ends_with(char::is_alphanumeric) || !letter(behind))
    })
}

/// Spellings of which more than two in one file are a second list of what `model` has in a table.
const TABLED: &[(&str, &[&str])] = &[
    ("types", &["SINT", "INT", "DINT", "LINT", "USINT", "UINT", "UDINT", "ULINT", "REAL", "LREAL"]),
    ("qualifiers", &["P0", "P1", "SD", "DS", "SL"]),
    ("operators", &["xor", "mod", "XOR", "MOD", "<>", "ADD", "SUB", "MUL", "EXPT"]),
];

/// Where such spellings stand for something else, and why.
const NOT_OF_THE_MODEL: &[(&str, &str)] = &[
    ("crates/engine/src/tables.rs", "the engine uses nothing of ours; `compile` tests that its inputs fit"),
    ("crates/codegen/", "names what the engine's numbers and the printed languages have"),
    ("crates/equations/", "names what the engine's numbers have"),
    ("crates/exchange/src/jgrafchart/", "the words of JGrafchart's own language"),
    ("tests/src/broken.rs", "breaks the engine's inputs one by one, by name"),
];

#[test]
fn types_qualifiers_and_operators_stand_in_the_tables_of_model_alone() {
    let mut found = Vec::new();
    for file in files().into_iter().filter(|f| f.extension().is_some_and(|e| e == "rs")) {
        let name = file.display().to_string();
        let product =
            (name.starts_with("crates/") && name.contains("/src/")) || name.starts_with("tests/src/");
        let excepted = NOT_OF_THE_MODEL.iter().any(|(place, _)| name.starts_with(place));
        if !product || excepted || name.starts_with("crates/model/") || name.contains("/tests") {
            continue;
        }
        let text = read(&file);
        let code = text.split("#[cfg(test)]").next().unwrap_or_default();
        for (what, spellings) in TABLED {
            let quoted = |word: &&&str| code.contains(&format!("\"{word}\""));
            let there: Vec<&str> = spellings.iter().filter(quoted).copied().collect();
            if there.len() > 2 {
                found.push(format!("{name}: {what}: {}", there.join(", ")));
            }
        }
    }
    none(&found, "types, qualifiers and operators are spelled in the tables of `model` only");
}

#[test]
fn what_is_missing_is_counted() {
    // In two parts, so that this file does not hold them.
    let words = [["skip", "ped: "].concat(), ["G7_COR", "PUS"].concat(), ["iec", "2c\""].concat()];
    let mut found = Vec::new();
    for file in files().into_iter().filter(|f| ends_in(f, &["rs"]) && !f.starts_with("tests/peers")) {
        for (k, line) in read(&file).lines().enumerate() {
            for word in words.iter().filter(|w| line.contains(*w)) {
                found.push(format!("{}:{}: {word}", file.display(), k + 1));
            }
        }
    }
    none(&found, "tests that look for tools or charts by themselves; `g7_peers` finds them and counts skips");
}

#[test]
fn no_path_of_a_machine() {
    let paths = [["/wo", "rk/"].concat(), ["/tmp", "/t-"].concat(), ["/ho", "me/"].concat()];
    let mut found = Vec::new();
    for file in files() {
        for (k, line) in read(&file).lines().enumerate() {
            for path in paths.iter().filter(|p| line.contains(*p)) {
                found.push(format!("{}:{}: {path}", file.display(), k + 1));
            }
        }
    }
    none(&found, "paths of somebody's machine");
}

/// The problem codes of the pages, each named by its code.
fn pages() -> BTreeSet<String> {
    let pages = files().into_iter().filter(|f| f.starts_with("docs/book/src/problems"));
    let stems = pages.filter_map(|f| Some(f.file_stem()?.to_string_lossy().into_owned()));
    stems.filter(|s| s.starts_with('G')).collect()
}

#[test]
fn each_code_has_a_page_and_each_page_a_code() {
    let codes: BTreeSet<String> = codes::ALL.iter().map(|c| c.id.to_owned()).collect();
    assert_eq!(codes.len(), codes::ALL.len(), "a code stands there twice");
    let pages = pages();
    let missing: Vec<String> = codes.difference(&pages).cloned().collect();
    none(&missing, "codes without a page in docs/book/src/problems");
    let stray: Vec<String> = pages.difference(&codes).cloned().collect();
    none(&stray, "pages without a code");
}

#[test]
fn each_code_has_a_case_and_each_case_a_code() {
    let mut cases = BTreeSet::new();
    let mut tested = String::new();
    for file in files() {
        let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if file.starts_with("tests/check") && ends_in(&file, &["g7"]) {
            cases.insert(name.split('-').next().unwrap_or("").to_uppercase());
        } else if file.starts_with("crates") && file.iter().any(|p| p == "tests") && ends_in(&file, &["rs"]) {
            tested.push_str(&read(&file));
        }
    }
    let codes: BTreeSet<String> = codes::ALL.iter().map(|c| c.id.to_owned()).collect();
    let stray: Vec<String> = cases.difference(&codes).cloned().collect();
    none(&stray, "cases in tests/check without a code");
    // Inputs that are no text of a chart (broken bytes, huge files, XML) are tested beside their readers.
    let missing: Vec<String> = codes.difference(&cases).filter(|c| !tested.contains(*c)).cloned().collect();
    none(&missing, "codes without a case");
}

/// The rows of the table of rules: line, text of the row, cases named in it.
fn rules() -> Vec<(usize, String, Vec<String>)> {
    let mut rows = Vec::new();
    for (k, line) in read("docs/spec/rules.md").lines().enumerate() {
        let cells: Vec<&str> = line.trim().trim_matches('|').split('|').map(str::trim).collect();
        if !line.starts_with('|') || cells.first() == Some(&"rule") || line.starts_with("|---") {
            continue;
        }
        let named = cells.last().unwrap_or(&"").split('`').skip(1).step_by(2);
        rows.push((k + 1, line.to_owned(), named.map(str::to_owned).collect()));
    }
    assert!(rows.len() > 100, "only {} rows of rules", rows.len());
    rows
}

#[test]
fn each_rule_names_cases_that_are_there() {
    let mut found = Vec::new();
    for (line, row, cases) in rules() {
        if cases.is_empty() {
            found.push(format!("{line}: no case: {row}"));
        }
        for case in cases {
            // `tests/check` stands for the cases of the checker.
            let checker = case.starts_with("tests/") && root().join(&case).exists();
            if !checker && !root().join(format!("tests/spec/{case}.md")).is_file() {
                found.push(format!("{line}: `{case}` is not there"));
            }
        }
    }
    none(&found, "rows of docs/spec/rules.md");
}

#[test]
fn each_case_stands_in_a_rule() {
    let named: BTreeSet<String> = rules().into_iter().flat_map(|(_, _, cases)| cases).collect();
    let mut found = Vec::new();
    for file in files() {
        let Ok(case) = file.strip_prefix("tests/spec") else { continue };
        let case = case.with_extension("").display().to_string();
        if ends_in(&file, &["md"]) && case != "README" && !named.contains(&case) {
            found.push(case);
        }
    }
    none(&found, "cases that no row of docs/spec/rules.md names");
}

#[test]
fn licences_are_permissive() {
    let allowed = licences::allowed(&read("deny.toml"));
    assert!(allowed.contains("MIT"), "deny.toml allows {allowed:?}");
    let exceptions = licences::exceptions(&read("deny.toml"));
    assert!(exceptions.contains_key("async-opcua"), "{exceptions:?}");
    let used = licences::used(&root(), |_| true);
    assert!(used.len() > 20, "only {} packages", used.len());
    let excepted = |package: &str, licence: &str| {
        let name = package.split(' ').next().unwrap_or("");
        exceptions.get(name).is_some_and(|fine| fine == licence)
    };
    // The usual build is free of the exceptions.
    let plain = licences::used(&root(), |name| name == "g7");
    assert!(plain.len() > 20 && !plain.iter().any(|(p, l)| excepted(p, l)), "g7 has an exception by default");
    let bad: Vec<String> = used
        .iter()
        .filter(|(package, licence)| !licences::fits(licence, &allowed) && !excepted(package, licence))
        .map(|(name, licence)| format!("{name}: {licence}"))
        .collect();
    none(&bad, "dependencies with a licence that deny.toml does not allow");
}
