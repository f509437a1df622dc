//! Names of the chart as names of the code.

use std::collections::{HashMap, HashSet};

use g7_compile::symbols::Symbols;

/// The longest side of a transition that is named in full, in steps.
const MOST: usize = 12;
/// The steps of a longer side that are named.
const FIRST: usize = 3;

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

/// Names that are given once; a name that is wanted again gets a number behind it.
#[derive(Debug, Default)]
pub(crate) struct Given {
    taken: HashSet<String>,
    /// By a name that is wanted again and again: the number to try next.
    next: HashMap<String, u32>,
}

impl Given {
    /// The name, or the next one that is free; `same` writes those alike that the language takes
    /// for one.
    pub(crate) fn once(&mut self, name: String, same: fn(&str) -> String) -> String {
        if self.taken.insert(same(&name)) {
            return name;
        }
        // No name is given back, so the numbers tried before are still taken.
        let next = self.next.entry(same(&name)).or_insert(2);
        loop {
            let free = format!("{name}_{next}");
            *next += 1;
            if self.taken.insert(same(&free)) {
                return free;
            }
        }
    }
}

/// Names of C and Rust.
#[derive(Debug, Default)]
pub(crate) struct Names {
    given: Given,
}

impl Names {
    /// A field or local name, in small letters.
    pub(crate) fn small(&mut self, name: &str) -> String {
        let mut plain = letters(name).to_lowercase();
        if TAKEN.contains(&plain.as_str()) {
            plain.push('_');
        }
        self.given.once(plain, str::to_owned)
    }

    /// A name of a number, in capitals, behind what it numbers.
    pub(crate) fn capital(&mut self, of: &str, name: &str) -> String {
        let plain = letters(&format!("a{name}")).get(1..).unwrap_or("").to_uppercase();
        self.given.once(format!("{of}_{plain}"), str::to_owned)
    }
}

/// The name of a transition: its label, or from where to where it leads.
pub(crate) fn of_transition(symbols: &Symbols, rank: u32) -> String {
    match symbols.label(rank) {
        Some(label) => label.to_owned(),
        None => symbols.transition_text(rank).split("->").map(side).collect::<Vec<_>>().join("to"),
    }
}

/// The steps on one side of a transition. Of very many only the first are named: each of them has
/// the name of the transition in its own code.
fn side(text: &str) -> String {
    let steps: Vec<&str> = text.split(", ").collect();
    match steps.get(..FIRST) {
        Some(first) if steps.len() > MOST => {
            format!("{} and {} more ", first.join(" "), steps.len() - FIRST)
        }
        _ => text.to_owned(),
    }
}

/// Letters, digits and single underscores; not a digit first. An index below 0 has an `m` before it: `m_0_m1` is
/// the element `m[0,-1]`.
pub(crate) fn letters(name: &str) -> String {
    let mut out = String::new();
    let mut before = ' ';
    for c in name.chars() {
        let below = c == '-' && matches!(before, '[' | ',');
        before = c;
        if below {
            out.push('m');
            continue;
        }
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
