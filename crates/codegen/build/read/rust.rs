//! The helpers of printed Rust. What is generic is printed for the types of its trait,
//! as `add` for `Whole` becomes `add_i16` and seven more.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use g7_runtime::source::File;

use super::helpers::{Helper, link, pieces, put_in};
use super::{Result, wrong};

fn code(piece: &str) -> &str {
    let mut rest = piece;
    while rest.starts_with("//") || rest.starts_with("#[") {
        rest = rest.split_once('\n').map_or("", |(_, r)| r);
    }
    rest
}

/// The word behind another, at the beginning of a piece's code.
fn word_behind<'a>(code: &'a str, words: &[&str]) -> Option<&'a str> {
    let rest = words.iter().find_map(|w| code.strip_prefix(w))?;
    rest.split(|c: char| !c.is_alphanumeric() && c != '_').next()
}

/// The Rust of a piece as it is printed.
fn printed(piece: &str) -> String {
    let mut out = String::new();
    for line in piece.lines() {
        let line = match line.strip_prefix("///") {
            Some(note) => format!("//{note}"),
            None => line.replacen("pub(crate) ", "", 1),
        };
        let line = line.strip_prefix("pub ").unwrap_or(&line);
        let _ = writeln!(out, "{line}");
    }
    out
}

/// A helper that is written once for several types.
#[derive(Debug)]
struct Generic {
    name: String,
    /// The trait of its types.
    of: String,
    text: String,
}

/// The items read from the files.
#[derive(Debug, Default)]
struct Reader {
    helpers: Vec<Helper>,
    generic: Vec<Generic>,
    /// The types of each trait, in small letters.
    types: BTreeMap<String, Vec<String>>,
    /// Zero of each type.
    zeros: BTreeMap<String, String>,
    /// A trait that is brought in without a name, for the structure behind it.
    unnamed: String,
}

/// The helpers of printed Rust.
pub(super) fn helpers(files: &[File]) -> Result<Vec<Helper>> {
    let mut reader = Reader::default();
    for file in files {
        if let Err(e) = syn::parse_file(file.text) {
            return wrong(file, e);
        }
        for piece in pieces(file.text) {
            reader.piece(file, &piece)?;
        }
    }
    for g in std::mem::take(&mut reader.generic) {
        reader.each_type(&g)?;
    }
    link(&mut reader.helpers);
    Ok(reader.helpers)
}

impl Reader {
    fn piece(&mut self, file: &File, piece: &str) -> Result<()> {
        let code = code(piece);
        let own = code.starts_with("macro_rules!") || code.starts_with("pub trait");
        if own || piece.starts_with("#[cfg(test)]") {
            return Ok(()); // what is generic here is written out there
        }
        if code.starts_with("use ") {
            if code.trim_end().ends_with("as _;") {
                self.unnamed = printed(piece);
            }
        } else if let Some(name) = word_behind(code, &["pub(crate) struct ", "pub struct "]) {
            let text = format!("{}\n{}", std::mem::take(&mut self.unnamed), printed(piece));
            self.helpers.push(Helper::new(name, false, text));
        } else if code.starts_with("impl") {
            match self.helpers.last_mut().filter(|h| code.contains(&format!(" {}<", h.name))) {
                Some(of) => of.text += &format!("\n{}", printed(piece)),
                None => return wrong(file, "methods that do not stand behind their structure"),
            }
        } else if let Some(name) = word_behind(code, &["pub fn ", "pub(crate) fn "]) {
            let text = printed(piece);
            match code.split_once("<T: ").and_then(|(_, r)| r.split_once('>')) {
                Some((of, _)) => self.generic.push(Generic { name: name.into(), of: of.into(), text }),
                None => self.helpers.push(Helper::new(name, code.starts_with("pub fn"), text)),
            }
        } else if let Some((word, list)) = code.split_once("!(") {
            self.list(word, list.trim_end().trim_end_matches(");"));
        } else {
            return wrong(file, format!("neither a function nor a structure:\n{piece}"));
        }
        Ok(())
    }

    /// `whole!(i8 i16)` or, with the zero of the types, `number!(0: i8 i16)`.
    fn list(&mut self, word: &str, list: &str) {
        let (zero, types) = list.split_once(": ").map_or((None, list), |(z, l)| (Some(z), l));
        for t in types.split_whitespace() {
            self.types.entry(word.to_owned()).or_default().push(t.to_owned());
            if let Some(zero) = zero {
                self.zeros.insert(t.to_owned(), zero.to_owned());
            }
        }
    }

    fn each_type(&mut self, g: &Generic) -> Result<()> {
        let Some(types) = self.types.get(&g.of.to_lowercase()) else {
            return Err(format!("crates/runtime: no types of `{}`", g.of));
        };
        for t in types {
            let Some(zero) = self.zeros.get(t) else {
                return Err(format!("crates/runtime: no zero of `{t}`"));
            };
            let name = instance(&g.name, t);
            let own = self.helpers.iter().any(|h| h.name == name);
            if own || name == format!("{t}_from_{t}") {
                continue; // written out for this type, or nothing to do
            }
            let text = g.text.replacen(&format!("fn {}<T: {}>", g.name, g.of), &format!("fn {name}"), 1);
            let text = put_in(&text.replace("T::ZERO", zero), "T", t);
            self.helpers.push(Helper::new(&name, true, text));
        }
        Ok(())
    }
}

/// The name of a generic helper for a type.
fn instance(name: &str, t: &str) -> String {
    match name.strip_prefix("from_") {
        Some(from) => format!("{t}_from_{from}"),
        None => format!("{}_{t}", name.strip_suffix("_real").unwrap_or(name)),
    }
}
