//! `web/src/lib/protocol.ts`: the messages between the page and `g7-page`, as TypeScript.

use std::fmt::Write as _;

use g7_page::types::{Row, Types};

/// The file.
pub const PATH: &str = "web/src/lib/protocol.ts";

const HEAD: &str = "\
// The messages between the page and the Rust crate `g7-page`, which answers them in the page's worker (as wasm)
// and in the server. Made by `make types` of the table in `crates/page/src/request.rs`; a test compares it.
// Places in texts are UTF-16 code units; geometry is in px at 100 % zoom.
";

/// Longest line.
const WIDE: usize = 120;

/// The text of the file.
pub fn text() -> String {
    let Types { rows, declared, twice } = g7_page::protocol();
    assert!(twice.is_empty(), "names that two types have: {twice:?}");
    let mut out = String::from(HEAD);
    for declared in declared.values() {
        let (name, body) =
            declared.text.trim_start_matches("type ").split_once(" = ").expect("a declaration");
        out.push('\n');
        out.push_str(&note(&declared.docs, 0));
        let body = body.trim_end_matches(';');
        let start = format!("export type {name} =");
        let shape = shaped(&read(body), 0, start.len() + 1);
        let gap = if shape.starts_with('\n') { "" } else { " " };
        writeln!(out, "{start}{gap}{shape};").expect("a text");
    }
    let asked = |row: &Row| if row.asked == EMPTY { "object".to_owned() } else { row.asked.clone() };
    out.push_str(&table("The contents of each message, beside its name in `do`.", REQUESTS, &rows, asked));
    out.push_str(&table("The answer to each message.", "Answers", &rows, |row| row.answer.clone()));
    out
}

const REQUESTS: &str = "Requests";

/// The type of an object without fields.
const EMPTY: &str = "Record<symbol, never>";

/// An interface with one field for each message.
fn table(docs: &str, name: &str, rows: &[Row], of: impl Fn(&Row) -> String) -> String {
    let mut out = format!("\n/** {docs} */\nexport interface {name} {{\n");
    for row in rows {
        // The comment of a message stands where its contents are.
        if name == REQUESTS {
            out.push_str(&note(row.docs, 1));
        }
        writeln!(out, "  {}: {};", row.name, shaped(&read(&of(row)), 1, row.name.len() + 4)).expect("a text");
    }
    out.push_str("}\n");
    out
}

/// A comment of Rust as JSDoc.
fn note(docs: &str, depth: usize) -> String {
    let bare = |line: &str| {
        let line = line.trim().trim_start_matches("/**").trim_start_matches("*/");
        line.trim_start_matches('*').trim().to_owned()
    };
    let lines: Vec<String> = docs.lines().map(bare).filter(|line| !line.is_empty()).collect();
    let indent = "  ".repeat(depth);
    match lines.as_slice() {
        [] => String::new(),
        lines => format!("{indent}/** {} */\n", lines.join(&format!("\n{indent} * "))),
    }
}

/// A type as it is laid out.
#[derive(Debug)]
enum Type {
    /// Names, lists and tuples: a text without objects.
    Plain(String),
    Object(Vec<Field>),
    /// Types side by side, with the signs between them.
    Joined(Vec<Type>, &'static str),
    /// A type in brackets or as the argument of another, with the texts before and behind it.
    Inside(String, Vec<Type>, String),
}

#[derive(Debug)]
struct Field {
    docs: String,
    name: String,
    of: Type,
}

/// Reads a type as `ts-rs` writes it.
fn read(text: &str) -> Type {
    let text = text.trim();
    for sign in [" | ", " & "] {
        let parts = split(text, sign);
        if parts.len() > 1 {
            return Type::Joined(parts.into_iter().map(read).collect(), sign);
        }
    }
    if let Some(fields) = text.strip_prefix('{').and_then(|t| t.strip_suffix('}')) {
        return Type::Object(split(fields, ",").into_iter().filter_map(field).collect());
    }
    let inner = |head: usize| split(text.get(head..text.len() - 1).unwrap_or(""), ", ").into_iter().map(read);
    if !text.contains('{') {
        return Type::Plain(text.replace('"', "'"));
    }
    match text.find(['(', '[', '<']) {
        Some(at) => {
            let (before, behind) = (&text[..=at], &text[text.len() - 1..]);
            Type::Inside(before.to_owned(), inner(at + 1).collect(), behind.to_owned())
        }
        None => Type::Plain(text.to_owned()),
    }
}

/// Reads a field with its comment.
fn field(text: &str) -> Option<Field> {
    let text = text.trim();
    let (docs, rest) = match text.strip_prefix("/**") {
        Some(rest) => rest.split_once("*/")?,
        None => ("", text),
    };
    let (name, of) = rest.trim().split_once(": ")?;
    Some(Field { docs: docs.to_owned(), name: name.replace('"', ""), of: read(of) })
}

/// Splits a text at signs that stand in no bracket, text or comment.
fn split<'a>(text: &'a str, sign: &str) -> Vec<&'a str> {
    let (mut parts, mut begin, mut depth, mut at) = (Vec::new(), 0, 0usize, 0);
    while let Some(c) = text[at..].chars().next() {
        let rest = &text[at..];
        let skipped = match c {
            '"' => rest[1..].find('"').map(|end| end + 2),
            '/' if rest.starts_with("/*") => rest.find("*/").map(|end| end + 2),
            _ => None,
        };
        if let Some(skipped) = skipped {
            at += skipped;
            continue;
        }
        if depth == 0 && rest.starts_with(sign) {
            parts.push(&text[begin..at]);
            at += sign.len();
            begin = at;
            continue;
        }
        match c {
            '{' | '(' | '[' | '<' => depth += 1,
            '}' | ')' | ']' | '>' => depth = depth.saturating_sub(1),
            _ => {}
        }
        at += c.len_utf8();
    }
    parts.push(&text[begin..]);
    parts
}

/// A type on one line, if it has no comments.
fn flat(of: &Type) -> Option<String> {
    Some(match of {
        Type::Plain(text) => text.clone(),
        Type::Object(fields) => {
            let field =
                |f: &Field| f.docs.is_empty().then(|| Some(format!("{}: {}", f.name, flat(&f.of)?)))?;
            let fields = fields.iter().map(field).collect::<Option<Vec<_>>>()?;
            if fields.is_empty() { "object".to_owned() } else { format!("{{ {} }}", fields.join("; ")) }
        }
        Type::Joined(parts, sign) => parts.iter().map(flat).collect::<Option<Vec<_>>>()?.join(sign),
        Type::Inside(before, parts, behind) => {
            format!("{before}{}{behind}", parts.iter().map(flat).collect::<Option<Vec<_>>>()?.join(", "))
        }
    })
}

/// A type over as many lines as it needs, behind `taken` signs of the first one.
fn shaped(of: &Type, depth: usize, taken: usize) -> String {
    if let Some(flat) = flat(of).filter(|flat| 2 * depth + taken + flat.len() < WIDE) {
        return flat;
    }
    let indent = "  ".repeat(depth + 1);
    match of {
        Type::Plain(text) => text.clone(),
        Type::Object(fields) => {
            let mut out = String::from("{\n");
            for f in fields {
                out.push_str(&note(&f.docs, depth + 1));
                writeln!(out, "{indent}{}: {};", f.name, shaped(&f.of, depth + 1, f.name.len() + 2))
                    .expect("a text");
            }
            out.push_str(&"  ".repeat(depth));
            out.push('}');
            out
        }
        Type::Joined(parts, " | ") => {
            let parts = parts.iter().map(|p| format!("\n{indent}| {}", shaped(p, depth + 1, 2)));
            parts.collect()
        }
        Type::Joined(parts, sign) => parts.iter().map(|p| shaped(p, depth, 0)).collect::<Vec<_>>().join(sign),
        Type::Inside(before, parts, behind) => {
            let parts: Vec<String> = parts.iter().map(|p| shaped(p, depth, 0)).collect();
            format!("{before}{}{behind}", parts.join(", "))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{read, shaped};

    #[test]
    fn types_are_laid_out_by_their_length() {
        let text = r#"{ "g": "move", ids: Array<string>, at?: [number, number] | null, }"#;
        assert_eq!(
            shaped(&read(text), 0, 0),
            "{ g: 'move'; ids: Array<string>; at?: [number, number] | null }"
        );
        let noted = "{ a: number, \n/**\n * A text, with a comma: {.\n */\nb?: string, } | null";
        let laid =
            "\n  | {\n    a: number;\n    /** A text, with a comma: {. */\n    b?: string;\n  }\n  | null";
        assert_eq!(shaped(&read(noted), 0, 0), laid);
    }
}
