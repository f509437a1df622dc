//! The TextMate grammar, for VS Code and other editors. It sees one line at a time and does not know which names
//! a chart declares. So it colours a word of the language by its position; the language server corrects that.

use serde_json::{Value, json};

use super::Vocabulary;

/// A name, also in back-ticks, and a number as the name of a step.
const NAME: &str = r"[_\p{L}\p{Nl}][_\p{L}\p{Nl}\p{Nd}\p{Pc}\p{Mc}]*";
/// If one of these signs follows, the word is a name and not a word of the language.
const NOT_A_NAME: &str = r"(?!\s*(?::=|->|→|=>|[,.]|:(?!=)))";

/// The grammar as JSON.
pub(super) fn grammar(words: &Vocabulary) -> String {
    let any = |list: &[String]| list.join("|");
    let behind_start = r"(?:^|(?<=[{};]))\s*";
    let name = format!(r"({NAME}|`(?:[^`\\]|\\.)*`|[0-9]+)");
    let word = |list: &[String], scope: &str| json!({ "name": format!("{scope}.g7"), "match": format!(r"(?<![.\w])(?:{})\b", any(list)) });
    let declared = |list: &str, scope: &str| {
        json!({
            "match": format!(r"(?<![.\w])({list})\s+{name}"),
            "captures": { "1": { "name": "keyword.declaration.g7" }, "2": { "name": format!("{scope}.g7") } }
        })
    };
    let patterns: Vec<Value> = [
        "notes",
        "comments",
        "complement",
        "strings",
        "ticked",
        "direct",
        "durations",
        "numbers",
        "declarations",
        "profiles",
        "begins",
        "qualifiers",
        "clauses",
        "words",
        "types",
        "functions",
        "members",
        "signs",
    ]
    .iter()
    .map(|part| json!({ "include": format!("#{part}") }))
    .collect();
    let rules = |list: Vec<Value>| json!({ "patterns": list });
    let block = |open: &str, close: &str| {
        let this = format!("#block{}", if open == r"\(\*" { "-round" } else { "" });
        json!({ "name": "comment.block.g7", "begin": open, "end": close, "patterns": [{ "include": this }] })
    };
    let bracket = json!({ "name": "punctuation.bracket.g7" });
    let grammar = json!({
        "$schema": "https://raw.githubusercontent.com/martinring/tmlanguage/master/tmlanguage.json",
        "comment": "generated from the table of words of G7 by `make grammars`; do not edit",
        "name": "G7",
        "scopeName": "source.g7",
        "fileTypes": ["g7"],
        "patterns": patterns,
        "repository": {
            "notes": rules(vec![
                json!({ "name": "comment.line.double-slash.g7", "match": "//.*$" }),
                json!({ "include": "#block" }),
                json!({ "include": "#block-round" }),
            ]),
            "block": block(r"/\*", r"\*/"),
            "block-round": block(r"\(\*", r"\*\)"),
            "comments": rules(vec![json!({
                "name": "string.quoted.double.comment.g7",
                "match": r#""(?:[^"\\]|\\.)*(?:"|$)"#,
            })]),
            "complement": rules(vec![json!({
                "name": "keyword.operator.complement.g7",
                "match": r"(?<=[\w)\]`])'+|[\x{304}\x{305}]",
            })]),
            "strings": rules(vec![json!({
                "name": "string.quoted.single.g7",
                "match": r"'(?:[^'$]|\$.)*(?:'|$)",
            })]),
            "ticked": rules(vec![json!({
                "name": "variable.other.quoted.g7",
                "match": r"`(?:[^`\\]|\\.)*(?:`|$)",
            })]),
            "direct": rules(vec![json!({
                "name": "variable.other.direct.g7",
                "match": r"%[A-Za-z][A-Za-z0-9_]*(?:\.[A-Za-z0-9]+)*(?::[Xx][0-9]+)?",
            })]),
            "durations": rules(vec![json!({
                "name": "constant.numeric.duration.g7",
                "match": r"(?<!\w)(?<!\w\.)(?:[0-9][0-9_]*(?:\.[0-9][0-9_]*)?(?:d|h|ms|us|ns|m|s|D|H|MS|US|NS|M|S)(?:[0-9_.a-zA-Z]*[0-9a-zA-Z])?|(?i:l?t|l?time)#[+-]?[0-9][0-9_.a-zA-Z]*)",
            }), json!({
                "name": "constant.numeric.date.g7",
                "match": r"(?<!\w)(?<!\w\.)(?i:l?(?:d|date|tod|time_of_day|dt|date_and_time))#[0-9]+(?:-[0-9]+-[0-9]+(?:-[0-9]+:[0-9:]+(?:\.[0-9]+)?)?|:[0-9:]+(?:\.[0-9]+)?)",
            })]),
            "numbers": rules(vec![json!({
                "name": "constant.numeric.g7",
                "match": format!(r"(?<!\w)(?<!\w\.)(?:(?i:{})#[+-]?)?(?:[0-9]+#[0-9A-Za-z_]+|[0-9][0-9_]*(?:\.[0-9][0-9_]*)?(?:[eE][+-]?[0-9]+)?)|(?<![\w.])(?i:bool)#\w+", any(&words.types)),
            })]),
            "declarations": rules(vec![
                declared("chart|macrochart|task|plant", "entity.name.class"),
                declared("step|macro", "entity.name.type.step"),
                declared("function|action|section", "entity.name.function"),
            ]),
            "profiles": rules(vec![json!({
                // A variable can have the same name.
                "begin": r"(?<![.\w])(profile|target)\b(?=\s+\w)(?!\s+(?:AND|MOD|OR|XOR|and|mod|or|xor)\b)",
                "beginCaptures": { "1": { "name": "keyword.other.g7" } },
                "end": r"$|(?<=\})",
                "patterns": [
                    { "include": "#notes" },
                    { "name": "support.constant.profile.g7", "match": format!(r"\b(?:{}|{})\b", any(&words.profiles), any(&words.targets)) },
                    { "include": "#switches" },
                    { "begin": r"\{", "beginCaptures": { "0": bracket }, "end": r"\}", "endCaptures": { "0": bracket },
                        "patterns": [
                        { "include": "#notes" }, { "include": "#switches" }, { "include": "#numbers" }, { "include": "#signs" },
                    ] },
                ],
            })]),
            "switches": rules(vec![json!({
                "name": "support.constant.switch.g7",
                "match": format!(r"\b(?:{}|bound)\b", any(&words.switches)),
            })]),
            "begins": rules(vec![json!({
                "match": format!(r"{behind_start}({})\b{NOT_A_NAME}", any(&words.begins)),
                "captures": { "1": { "name": "keyword.other.g7" } },
            }), json!({
                // On one line, statements of tests and actions follow each other without a sign.
                "name": "keyword.other.g7",
                "match": format!(r"(?<=[\w\s)\]'`}}])(?<![.\w])(?:{})\b(?=\s+[\w`%↑↓(\[{{!/=])(?!\s+(?:{})\b)", any(&words.begins), any(&words.operators)),
            })]),
            "qualifiers": rules(vec![json!({
                "name": "storage.modifier.qualifier.g7",
                "match": format!(r"(?<![.\w%])(?:{})\b(?=\s+[\w`%({{])(?!\s+(?:{}|when|if|do|then|DO|THEN)\b)", any(&words.qualifiers), any(&words.operators)),
            })]),
            "clauses": rules(vec![json!({
                "name": "keyword.other.clause.g7",
                "match": format!(r"(?<=\S)(?<![.\w])(?<!\bvar )(?:{})\b{NOT_A_NAME}(?!\s*\()", any(&words.clauses)),
            }), json!({
                "name": "keyword.other.clause.g7",
                "match": format!(r"(?<=[\s{{])(?<![.\w])(?:{})\b{NOT_A_NAME}(?=\s|[}}:]|$)", any(&words.clauses)),
            }), json!({
                "match": r"(?<![.\w])(each)\s+(scan)\s*(?=:)",
                "captures": { "1": { "name": "keyword.other.g7" }, "2": { "name": "keyword.other.g7" } },
            }), json!({
                "name": "keyword.other.clause.g7",
                "match": r"(?<![.\w])(?:at|of)\b(?=\s*\()",
            })]),
            "words": rules(vec![
                word(&words.constants, "constant.language"),
                word(&words.operators, "keyword.operator.word"),
                word(&words.edges, "keyword.operator.edge"),
                word(&words.reserved, "keyword.control"),
            ]),
            "types": rules(vec![json!({
                "name": "support.type.g7",
                "match": format!(r"(?<![.\w])(?:{0})\b(?!\s*\.)|(?<=:)(?i:{0})\b|(?<=:\s)(?i:{0})\b", any(&words.types)),
            })]),
            "functions": rules(vec![
                json!({ "name": "support.function.g7", "match": format!(r"(?<![.\w])(?:{})\b(?=\s*\()", any(&words.functions)) }),
                json!({ "name": "entity.name.function.call.g7", "match": format!(r"(?<![.\w]){NAME}(?=\()") }),
            ]),
            "members": rules(vec![json!({
                "match": format!(r"(?<=[\w`])(\.)({NAME}|[0-9]+)"),
                "captures": { "1": { "name": "punctuation.accessor.g7" }, "2": { "name": "variable.other.member.g7" } },
            }), json!({ "name": "variable.other.g7", "match": NAME })]),
            "signs": rules(vec![
                json!({ "name": "keyword.operator.arrow.g7", "match": "->|→" }),
                json!({ "name": "keyword.operator.assignment.g7", "match": ":=|=>" }),
                json!({ "name": "keyword.operator.g7", "match": r"<>|<=|>=|!=|==|\*\*|\.\.|[=<>≠≤≥+\-*/&|·⋅!↑↓^#.]" }),
                json!({ "name": "punctuation.separator.g7", "match": "[,;:]" }),
                json!({ "name": "punctuation.bracket.g7", "match": r"[{}()\[\]]" }),
            ]),
        },
    });
    serde_json::to_string_pretty(&grammar).unwrap_or_default() + "\n"
}
