//! The words that the grammar of tree-sitter requires, and the query that colours its trees.

use g7_model::Type;
use serde_json::json;

use super::Vocabulary;

/// `words.json`, which `grammar.js` reads.
pub(super) fn words(words: &Vocabulary) -> String {
    let value = json!({
        "keywords": words.keywords,
        "qualifiers": words.qualifiers,
        // The grammar has a rule for the words of `words::TYPE`.
        "types": words.types.iter().filter(|w| Type::named(w).is_some()).collect::<Vec<_>>(),
        "profiles": words.profiles,
        "targets": words.targets,
        "switches": words.switches,
    });
    serde_json::to_string_pretty(&value).unwrap_or_default() + "\n"
}

const HEAD: &str = "; Generated from the table of words of G7 by `make grammars`; do not edit.

(note) @comment
(comment) @string.special
(string) @string
(number) @number
(duration) @number
(boolean) @boolean
(direct) @variable.builtin
(qualifier) @attribute
(profile_name) @constant
(target_name) @constant
(switch) @constant
(type_name) @type
(member) @variable.member
(identifier) @variable
(ticked) @variable

(chart name: (_) @type)
(plant name: (_) @type)
(step name: (_) @label)
(step expansion: (_) @type)
(steps (_) @label)
(transition label: (_) @label)
(function name: (_) @function)
(named_action name: (_) @function)
(section name: (_) @function)
(call function: (path) @function.call)
(force_order chart: (_) @type)
(layout chart: (_) @type)
(parameter name: (_) @variable.parameter)

[\"->\" \"→\" \":=\" \"=>\" \"=\" \"<>\" \"!=\" \"<\" \">\" \"<=\" \">=\" \"+\" \"-\" \"*\" \"/\" \"**\" \"&\" \"!\" \"↑\" \"↓\" \"^\" \"..\"] @operator
[\"{\" \"}\" \"(\" \")\" \"[\" \"]\"] @punctuation.bracket
[\",\" \";\" \":\"] @punctuation.delimiter

";

/// The query for highlights.
pub(super) fn highlights(words: &Vocabulary) -> String {
    let quoted = |list: &[String]| {
        let mut out = String::from("[\n");
        for part in list.chunks(8) {
            let line: Vec<String> = part.iter().map(|w| format!("\"{w}\"")).collect();
            out.push_str(&format!("  {}\n", line.join(" ")));
        }
        out + "]"
    };
    let operators: Vec<String> = words.operators.iter().chain(&words.edges).cloned().collect();
    let mut keywords: Vec<String> =
        [&words.reserved, &words.begins, &words.clauses].into_iter().flatten().cloned().collect();
    keywords.sort();
    keywords.dedup();
    format!("{HEAD}{} @keyword\n\n{} @keyword.operator\n", quoted(&keywords), quoted(&operators))
}
