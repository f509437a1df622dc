//! The grammars of other editors: made of the table of words, and read by the programs that use them.
#![allow(clippy::disallowed_methods, reason = "the tests read files and start the programs")]

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use g7_model::words::PLACES;
use g7_syntax::{TokenKind, is_reserved, tokens};
use g7_tests::grammars::{self, Vocabulary};
use g7_tests::house::{none, read, root};
use serde_json::{Value, json};

#[test]
fn the_generated_files_are_up_to_date() {
    let old: Vec<String> = grammars::all()
        .into_iter()
        .filter(|(path, text)| !root().join(path).is_file() || read(path) != *text)
        .map(|(path, _)| path.to_owned())
        .collect();
    none(&old, "generated files that the table of words no longer agrees with (`make grammars`)");
}

#[test]
fn the_grammar_of_tree_sitter_uses_every_word() {
    let grammar = read("editors/tree-sitter-g7/grammar.js");
    let unused: Vec<String> = Vocabulary::new()
        .keywords
        .into_iter()
        .filter(|w| {
            !["kw", "iec"].iter().any(|f| grammar.contains(&format!("{f}(\"{w}\")")))
                && !grammar.contains(&format!("\"{w}\", \"{}\"", w.to_uppercase()))
        })
        .collect();
    none(&unused, "words of the table that no rule of grammar.js has");
}

/// A folder below that of the build, emptied.
fn folder(name: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::remove_dir_all(&path).ok();
    std::fs::create_dir_all(&path).expect("a folder");
    path
}

fn out(command: &mut Command) -> (bool, String) {
    let out = command.output().expect("it starts");
    let text = [&out.stdout[..], &out.stderr].map(|t| String::from_utf8_lossy(t).into_owned()).concat();
    (out.status.success(), text)
}

#[test]
fn tree_sitter_reads_every_chart() {
    let Some(program) = g7_peers::tree_sitter() else { return };
    let folder = folder("tree-sitter-g7");
    let source = root().join("editors/tree-sitter-g7");
    let (copied, told) = out(Command::new("cp").arg("-r").arg(source.join(".")).arg(&folder));
    assert!(copied, "{told}");
    let run = |args: &[&str]| {
        let mut command = Command::new(&program);
        command
            .args(args)
            .current_dir(&folder)
            .env("HOME", &folder)
            .env("XDG_CACHE_HOME", folder.join("cache"));
        command
    };
    let (made, told) = out(&mut run(&["generate"]));
    assert!(made, "{told}");
    let all = grammars::charts();
    let mut paths = String::new();
    for (i, (_, text)) in all.iter().enumerate() {
        std::fs::write(folder.join(format!("{i}.g7")), text).expect("a chart");
        paths.push_str(&format!("{i}.g7\n"));
    }
    std::fs::write(folder.join("paths"), &paths).expect("the list");
    let (_, told) = out(&mut run(&["parse", "--quiet", "--paths", "paths"]));
    let mut wrong = Vec::new();
    for line in told.lines().filter(|l| l.contains("(ERROR") || l.contains("(MISSING")) {
        let number = line.split('.').next().and_then(|n| n.parse::<usize>().ok());
        let name = number.and_then(|n| all.get(n)).map_or("?", |(name, _)| name);
        wrong.push(format!("{name}: {line}"));
    }
    none(&wrong, "charts that the grammar of tree-sitter does not read");
    // A text that is wrong is seen to be.
    std::fs::write(folder.join("wrong.g7"), "chart A {\n  1 -> when\n}\n").expect("a chart");
    let (fine, told) = out(&mut run(&["parse", "--quiet", "wrong.g7"]));
    assert!(!fine && (told.contains("ERROR") || told.contains("MISSING")), "{told}");
    for queries in ["tree-sitter-g7/queries", "zed/languages/g7"] {
        for query in std::fs::read_dir(root().join("editors").join(queries)).expect("queries") {
            let query = query.expect("a query").path();
            if query.extension().is_some_and(|e| e == "scm") {
                let (fine, told) = out(&mut run(&["query", &query.display().to_string(), "0.g7"]));
                assert!(fine, "{}: {told}", query.display());
            }
        }
    }
}

/// A scope that a token of this kind must have, one of several.
fn wanted(kind: TokenKind, word: &str) -> &'static [&'static str] {
    match kind {
        TokenKind::Note => &["comment"],
        TokenKind::Str => &["string.quoted.single"],
        TokenKind::Comment => &["string.quoted.double"],
        TokenKind::Time => &["constant.numeric"],
        TokenKind::Number => &["constant.numeric", "entity.name", "variable.other"],
        TokenKind::Direct => &["variable.other.direct"],
        TokenKind::Ticked => &["variable.other", "entity.name"],
        TokenKind::Arrow => &["keyword.operator.arrow"],
        TokenKind::LBrace | TokenKind::RBrace | TokenKind::LParen | TokenKind::RParen => {
            &["punctuation.bracket"]
        }
        TokenKind::Comma | TokenKind::Semi | TokenKind::Colon => &["punctuation.separator"],
        TokenKind::PathDot => &["punctuation.accessor", "keyword.operator"],
        // The words of switches are joined by `-`.
        TokenKind::Star | TokenKind::Sign => &["keyword.operator", "punctuation", "support.constant.switch"],
        TokenKind::Word if is_reserved(word) => &[
            "keyword",
            "constant.language",
            "support.function",
            "support.constant.switch",
            "variable.other.member",
        ],
        TokenKind::Word => &[
            "keyword",
            "variable",
            "entity.name",
            "support",
            "storage.modifier",
            "constant.language",
            "punctuation.accessor",
        ],
    }
}

/// The scopes of parts of texts, by VS Code's own machine for such grammars.
fn scopes(texts: &[(&str, Vec<(usize, usize)>)]) -> Option<Vec<Vec<String>>> {
    let mut command = g7_peers::node("vscode-textmate", "scopes.cjs")?;
    let asked = json!({
        "grammar": root().join("editors/vscode/syntaxes/g7.tmLanguage.json"),
        "texts": texts.iter().map(|(text, asks)| json!({ "text": text, "asks": asks })).collect::<Vec<_>>(),
    });
    let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().expect("node starts");
    child.stdin.take().expect("a pipe").write_all(asked.to_string().as_bytes()).expect("it reads");
    let out = child.wait_with_output().expect("it ends");
    let answer: Value = serde_json::from_slice(&out.stdout).expect("an answer");
    let list = |v: &Value| v.as_array().cloned().unwrap_or_default();
    let text = |v: &Value| v.as_str().unwrap_or_default().to_owned();
    Some(list(&answer).iter().map(|one| list(one).iter().map(text).collect()).collect())
}

/// The places of all tokens, in UTF-16 units.
fn places(text: &str) -> Vec<(usize, usize)> {
    let (mut byte, mut unit) = (0, 0);
    let mut at = |to: usize| {
        unit += text.get(byte..to).unwrap_or("").encode_utf16().count();
        byte = to;
        unit
    };
    tokens(text).map(|t| (at(t.start), at(t.end))).collect()
}

#[test]
fn the_grammar_of_textmate_gives_each_token_a_fitting_scope() {
    let all = grammars::charts();
    let asked: Vec<_> = all.iter().map(|(_, text)| (&**text, places(text))).collect();
    let Some(answer) = scopes(&asked) else { return };
    let mut wrong = Vec::new();
    let mut seen = 0;
    for ((name, text), scopes) in all.iter().zip(&answer) {
        for (token, scopes) in tokens(text).zip(scopes) {
            seen += 1;
            let word = text.get(token.start..token.end).unwrap_or("");
            let fits = wanted(token.kind, word);
            let each = scopes.split('|').all(|s| fits.iter().any(|f| s.contains(f)));
            if !each {
                let line = text.get(..token.start).unwrap_or("").lines().count();
                wrong.push(format!("{name}, line {line}: `{word}` is `{scopes}`"));
            }
        }
    }
    assert!(seen > 50_000, "only {seen} tokens");
    wrong.truncate(40);
    none(&wrong, "tokens with a scope of another kind");
}

/// Where a word of each place of the table stands, with `§` for it.
const FRAMES: &[(&str, &str)] = &[
    ("file", "§ x\n"),
    ("chart", "chart A {\n  § x\n}\n"),
    ("action", "chart A {\n  step 1 {\n    § x\n  }\n}\n"),
    ("plant", "plant P { § x }\n"),
    ("test", "test \"t\" {\n  § x\n}\n"),
    ("layout", "layout A { § x at (0, 0) }\n"),
    ("statement", "pre {\n  § x\n}\n"),
    ("operator", "pre { a := b § c }\n"),
    ("value", "pre { a := § (c) }\n"),
];

/// Each word of the table in its frame, with the byte at which it stands.
fn framed() -> Vec<(&'static str, &'static str, String, usize)> {
    let mut all = Vec::new();
    for (place, frame) in FRAMES {
        let (_, list) = PLACES.iter().find(|(name, _)| name == place).expect("a place");
        for word in *list {
            let at = frame.find('§').expect("a place for the word");
            all.push((*place, word.text, frame.replace('§', word.text), at));
        }
    }
    all
}

#[test]
fn the_grammar_of_textmate_knows_each_word_at_its_place() {
    let all = framed();
    let asked: Vec<(&str, Vec<(usize, usize)>)> =
        all.iter().map(|(_, word, text, at)| (&**text, vec![(*at, at + word.len())])).collect();
    let Some(answer) = scopes(&asked) else { return };
    let mut wrong = Vec::new();
    for ((place, word, ..), scopes) in all.iter().zip(&answer) {
        let scope = scopes.first().map_or("", String::as_str);
        if !scope.contains("keyword") && !scope.contains("constant.language") {
            wrong.push(format!("{place}: `{word}` is `{scope}`"));
        }
    }
    none(&wrong, "words that are not coloured as words of the language");
}

#[test]
fn vim_knows_each_word_at_its_place() {
    if !g7_peers::tool("vim") {
        return;
    }
    let folder = folder("vim");
    let mut script = format!(
        "set runtimepath^={}\nfiletype plugin on\nsyntax on\nlet s:out = []\n",
        root().join("editors/vim").canonicalize().expect("a folder").display()
    );
    let all = framed();
    for (i, (_, _, text, at)) in all.iter().enumerate() {
        std::fs::write(folder.join(format!("{i}.g7")), text).expect("a chart");
        let line = text.get(..*at).unwrap_or("").matches('\n').count() + 1;
        let column = at - text.get(..*at).unwrap_or("").rfind('\n').map_or(0, |n| n + 1) + 1;
        script.push_str(&format!(
            "edit {i}.g7\ncall add(s:out, &filetype . ' ' . synIDattr(synID({line}, {column}, 1), 'name'))\n"
        ));
    }
    // Other tokens have a group as well: a note, a comment, a text, a number and a duration.
    let other =
        "// note\ninput a : BOOL at %I0.1 \"comment\"\nvar t : TIME := 5s\nvar s : STRING := 'text'\n";
    std::fs::write(folder.join("other.g7"), other).expect("a chart");
    script.push_str("edit other.g7\n");
    let wanted = [
        (1, 4, "g7Note"),
        (2, 1, "g7Reserved"),
        (2, 11, "g7Type"),
        (2, 16, "g7Clause"),
        (2, 20, "g7Direct"),
        (2, 28, "g7Comment"),
        (3, 17, "g7Duration"),
        (4, 21, "g7String"),
    ];
    for (line, column, _) in wanted {
        script.push_str(&format!(
            "call add(s:out, &filetype . ' ' . synIDattr(synID({line}, {column}, 1), 'name'))\n"
        ));
    }
    script.push_str("call writefile(s:out, 'out')\nqa!\n");
    std::fs::write(folder.join("script.vim"), script).expect("a script");
    out(Command::new("vim")
        .args(["-es", "-u", "NONE", "-i", "NONE", "-S", "script.vim"])
        .current_dir(&folder));
    let answer = std::fs::read_to_string(folder.join("out")).expect("Vim's answer");
    let answer: Vec<&str> = answer.lines().collect();
    assert_eq!(answer.len(), all.len() + wanted.len());
    let mut wrong = Vec::new();
    for ((place, word, ..), said) in all.iter().zip(&answer) {
        let groups = ["g7Reserved", "g7Statement", "g7Clause", "g7WordOperator", "g7Edge", "g7Boolean"]
            .map(|g| format!("g7 {g}"));
        if !groups.iter().any(|g| g == said) {
            wrong.push(format!("{place}: `{word}` is `{said}`"));
        }
    }
    for ((line, column, group), said) in wanted.iter().zip(answer.iter().skip(all.len())) {
        if *said != format!("g7 {group}") {
            wrong.push(format!("line {line}, column {column}: `{said}` instead of `{group}`"));
        }
    }
    none(&wrong, "places that Vim colours as something else");
}
