//! The syntax file of Vim.

use super::Vocabulary;

const HEAD: &str = r#"" Vim syntax file
" Language: GRAFCET and SFC charts in the .g7 language
" Generated from the table of words of G7 by `make grammars`; do not edit.

if exists('b:current_syntax')
  finish
endif

let s:save = &cpo
set cpo&vim
syntax case match

"#;

const SIGNS: &str = r#"
syntax match g7Operator /:=\|=>\|<>\|<=\|>=\|!=\|==\|\*\*\|[=<>≠≤≥+*&·!↑↓^]\|\/\%([\/*]\)\@!/
syntax match g7Arrow /->\|→/
syntax match g7Number /\<\d[0-9_]*\%(\.\d[0-9_]*\)\?\%([eE][+-]\?\d\+\)\?\>/
syntax match g7Number /\<\%(\d\+\|[A-Z]\+\)#[+-]\?[0-9A-Za-z_.]\+/
syntax match g7Duration /\<\d[0-9_]*\%(\.\d[0-9_]*\)\?\%(d\|h\|ms\|us\|ns\|m\|s\)[0-9a-z_.]*\>/
syntax match g7Duration /\c\<l\?t\%(ime\)\?#[+-]\?\d[0-9a-z_.]*/
syntax match g7Duration /\c\<l\?\%(d\|date\|dt\|date_and_time\)#\d\+-\d\+-\d\+\%(-\d\+:[0-9:]\+\%(\.\d\+\)\?\)\?/
syntax match g7Duration /\c\<l\?\%(tod\|time_of_day\)#\d\+:[0-9:]\+\%(\.\d\+\)\?/
syntax match g7Direct /%\a\w*\%(\.\w\+\)*\%(:[Xx]\d\+\)\?/
syntax match g7Member /\.\@1<=\w\+/ contained
syntax match g7Path /\%(\w\|`\)\@1<=\.\w\+/ contains=g7Member
syntax match g7Complement /[A-Za-z0-9_)\]`]\@1<='\+/
syntax region g7String start=/[A-Za-z0-9_)\]`']\@1<!'/ skip=/\$./ end=/'\|$/ oneline
syntax region g7Comment start=/"/ skip=/\\./ end=/"\|$/ oneline
syntax region g7Quoted start=/`/ skip=/\\./ end=/`\|$/ oneline
syntax match g7Note /\/\/.*$/ contains=@Spell
syntax region g7Note start=/\/\*/ end=/\*\// contains=g7Note,@Spell fold
syntax region g7Note start=/(\*/ end=/\*)/ contains=g7Note,@Spell fold
syntax region g7Block start=/{/ end=/}/ transparent fold
syntax sync minlines=200

"#;

const LINKS: &[(&str, &str)] = &[
    ("g7Reserved", "Keyword"),
    ("g7Statement", "Keyword"),
    ("g7Clause", "Keyword"),
    ("g7WordOperator", "Operator"),
    ("g7Edge", "Operator"),
    ("g7Boolean", "Boolean"),
    ("g7Qualifier", "StorageClass"),
    ("g7Type", "Type"),
    ("g7Function", "Function"),
    ("g7Profile", "Constant"),
    ("g7Operator", "Operator"),
    ("g7Arrow", "Operator"),
    ("g7Complement", "Operator"),
    ("g7Number", "Number"),
    ("g7Duration", "Number"),
    ("g7Direct", "Identifier"),
    ("g7Member", "Identifier"),
    ("g7Quoted", "Identifier"),
    ("g7String", "String"),
    ("g7Comment", "String"),
    ("g7Note", "Comment"),
];

/// The syntax file.
pub(super) fn syntax(words: &Vocabulary) -> String {
    let mut out = HEAD.to_owned();
    let any = |list: &[String]| list.join(r"\|");
    let mut keywords = |group: &str, list: &[String]| {
        for part in list.chunks(10) {
            out.push_str(&format!("syntax keyword {group} {}\n", part.join(" ")));
        }
    };
    keywords("g7Reserved", &words.reserved);
    keywords("g7WordOperator", &words.operators);
    keywords("g7Edge", &words.edges);
    keywords("g7Boolean", &words.constants);
    keywords("g7Type", &words.types);
    keywords("g7Profile", &words.profiles);
    keywords("g7Profile", &words.targets);
    let switches: Vec<String> = words.switches.iter().cloned().chain(["bound".to_owned()]).collect();
    out.push_str(&format!("syntax match g7Profile /\\<\\%({})\\>/\n", any(&switches) + r"\"));
    // A word that may be a name is none before these signs.
    let no_name = r"\%(\s*\%(:=\|->\|=>\|[,.:]\)\)\@!";
    out.push_str(&format!("syntax match g7Function /\\<\\%({}\\)\\>\\ze\\s*(/\n", any(&words.functions)));
    out.push_str(&format!(
        "syntax match g7Clause /\\%(\\S\\s\\+\\)\\@40<=\\<\\%({}\\)\\>{no_name}/\n",
        any(&words.clauses)
    ));
    out.push_str(
        "syntax match g7Clause /\\%(\\%(pre\\|post\\|each\\)\\s\\+\\)\\@20<=\\%(st\\|il\\|ld\\|scan\\)\\>/\n",
    );
    out.push_str(&format!(
        "syntax match g7Qualifier /\\<\\%({}\\)\\>\\ze\\s\\+[A-Za-z0-9_`%({{]/\n",
        any(&words.qualifiers)
    ));
    out.push_str(&format!(
        "syntax match g7Statement /\\%(\\%(^\\|[{{}};]\\)\\s*\\)\\@80<=\\<\\%({}\\)\\>{no_name}/\n",
        any(&words.begins)
    ));
    out.push_str(SIGNS);
    for (group, link) in LINKS {
        out.push_str(&format!("highlight default link {group} {link}\n"));
    }
    out.push_str("\nlet b:current_syntax = 'g7'\nlet &cpo = s:save\nunlet s:save\n");
    out
}
