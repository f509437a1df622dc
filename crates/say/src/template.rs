//! The text of a `say!` taken apart: plain text and holes.

/// A hole of a text.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Hole {
    /// The name in it; empty if the next argument fills it.
    pub name: String,
    /// The form behind the colon.
    pub form: String,
    /// True if it stands in back-ticks.
    pub quoted: bool,
}

/// The holes of a text in their order, and the text without its doubled braces, if it has no hole.
pub(crate) fn holes(text: &str) -> Result<(Vec<Hole>, String), &'static str> {
    let (mut holes, mut plain, mut quoted) = (Vec::new(), String::new(), false);
    let mut chars = text.chars().peekable();
    while let Some(c) = chars.next() {
        match c {
            '{' | '}' if chars.peek() == Some(&c) => {
                chars.next();
                plain.push(c);
            }
            '{' => {
                let inside: String = chars.by_ref().take_while(|c| *c != '}').collect();
                let (name, form) = inside.split_once(':').unwrap_or((&inside, ""));
                if !name.chars().all(|c| c.is_alphanumeric() || c == '_')
                    || name.starts_with(|c: char| c.is_ascii_digit())
                {
                    return Err("a hole holds a name or nothing");
                }
                holes.push(Hole { name: name.to_owned(), form: form.to_owned(), quoted });
            }
            '}' => return Err("a closing brace without its opening one is doubled"),
            '`' => {
                quoted = !quoted;
                plain.push(c);
            }
            _ => plain.push(c),
        }
    }
    Ok((holes, plain))
}

/// The text that a literal of Rust stands for.
pub(crate) fn unquoted(literal: &str) -> Option<String> {
    if let Some(raw) = literal.strip_prefix('r') {
        let inside = raw.trim_matches('#');
        return Some(inside.strip_prefix('"')?.strip_suffix('"')?.to_owned());
    }
    let mut chars = literal.strip_prefix('"')?.strip_suffix('"')?.chars().peekable();
    let mut text = String::new();
    while let Some(c) = chars.next() {
        if c != '\\' {
            text.push(c);
            continue;
        }
        match chars.next()? {
            'n' => text.push('\n'),
            't' => text.push('\t'),
            'r' => text.push('\r'),
            '0' => text.push('\0'),
            '\n' => while chars.next_if(|c| c.is_whitespace()).is_some() {},
            'u' => {
                let code: String = chars.by_ref().skip(1).take_while(|c| *c != '}').collect();
                text.push(u32::from_str_radix(&code, 16).ok().and_then(char::from_u32)?);
            }
            c => text.push(c),
        }
    }
    Some(text)
}

#[cfg(test)]
mod tests {
    use super::{Hole, holes, unquoted};

    fn hole(name: &str, form: &str, quoted: bool) -> Hole {
        Hole { name: name.to_owned(), form: form.to_owned(), quoted }
    }

    #[test]
    fn holes_are_found_with_their_names_and_ticks() {
        let found = holes("{} of `{name}` at {:?}: `{{` and `{a:>3}`").map(|(h, _)| h);
        let wanted =
            [hole("", "", false), hole("name", "", true), hole("", "?", false), hole("a", ">3", true)];
        assert_eq!(found, Ok(wanted.into()));
        assert_eq!(holes("write `{{`").map(|(_, plain)| plain), Ok("write `{`".to_owned()));
        assert!(holes("{0}").is_err() && holes("a }").is_err() && holes("{a.b}").is_err());
    }

    #[test]
    fn literals_are_read_as_rust_reads_them() {
        assert_eq!(unquoted(r#""a \"b\" \\ \u{e9}""#).as_deref(), Some("a \"b\" \\ é"));
        assert_eq!(unquoted("\"a \\\n   b\"").as_deref(), Some("a b"));
        assert_eq!(unquoted("r#\"a \"b\"\"#").as_deref(), Some("a \"b\""));
    }
}
