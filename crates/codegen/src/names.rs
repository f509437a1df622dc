//! Names of the chart as names of the code.

use std::collections::{HashMap, HashSet};

/// Words that C, C++ or Rust keep for themselves, and what the code uses.
const TAKEN: &[&str] = &[
    "abstract",
    "alignas",
    "alignof",
    "and",
    "as",
    "asm",
    "async",
    "auto",
    "await",
    "become",
    "bool",
    "box",
    "break",
    "byte",
    "case",
    "catch",
    "char",
    "class",
    "const",
    "constexpr",
    "continue",
    "crate",
    "default",
    "delete",
    "do",
    "double",
    "dyn",
    "else",
    "enum",
    "explicit",
    "export",
    "extern",
    "false",
    "final",
    "float",
    "fn",
    "for",
    "friend",
    "gen",
    "goto",
    "if",
    "impl",
    "in",
    "inline",
    "int",
    "let",
    "long",
    "loop",
    "macro",
    "match",
    "mod",
    "move",
    "mut",
    "mutable",
    "namespace",
    "new",
    "not",
    "operator",
    "or",
    "override",
    "private",
    "priv",
    "protected",
    "pub",
    "public",
    "ref",
    "register",
    "restrict",
    "return",
    "self",
    "short",
    "signed",
    "sizeof",
    "static",
    "struct",
    "super",
    "switch",
    "template",
    "this",
    "throw",
    "trait",
    "true",
    "try",
    "type",
    "typedef",
    "typename",
    "typeof",
    "union",
    "unsafe",
    "unsigned",
    "unsized",
    "use",
    "using",
    "virtual",
    "void",
    "volatile",
    "where",
    "while",
    "xor",
    "yield",
    "none",
    "now",
    "input",
    "output",
];

/// Names that are given once.
#[derive(Debug, Default)]
pub(crate) struct Names {
    given: HashSet<String>,
    /// By a name that is wanted again and again: the number to try next.
    next: HashMap<String, u32>,
}

impl Names {
    /// A field or local name, in small letters.
    pub(crate) fn small(&mut self, name: &str) -> String {
        let mut plain = letters(name).to_lowercase();
        if TAKEN.contains(&plain.as_str()) {
            plain.push('_');
        }
        self.once(plain)
    }

    /// A name of a number, in capitals, behind what it numbers.
    pub(crate) fn capital(&mut self, of: &str, name: &str) -> String {
        self.once(format!("{of}_{}", letters(&format!("a{name}")).get(1..).unwrap_or("").to_uppercase()))
    }

    fn once(&mut self, name: String) -> String {
        if self.given.insert(name.clone()) {
            return name;
        }
        // No name is given back, so the numbers tried before are still taken.
        let next = self.next.entry(name.clone()).or_insert(2);
        loop {
            let free = format!("{name}_{next}");
            *next += 1;
            if self.given.insert(free.clone()) {
                return free;
            }
        }
    }
}

/// Letters, digits and single underscores; not a digit first.
pub(crate) fn letters(name: &str) -> String {
    let mut out = String::new();
    for c in name.chars() {
        let fine = c.is_ascii_alphanumeric();
        if out.is_empty() && (c.is_ascii_digit() || !fine) {
            out.push('n');
        }
        if fine {
            out.push(c);
        } else if !out.ends_with('_') {
            out.push('_');
        }
    }
    let trimmed = out.trim_end_matches('_');
    if trimmed.is_empty() { "n".to_owned() } else { trimmed.to_owned() }
}
