//! Splits a library in IEC 61131-3 text into its functions, function blocks and types.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// A function or function block.
pub(crate) struct Unit {
    pub(crate) name: String,
    pub(crate) function: bool,
    pub(crate) text: String,
    /// The type of a function's result.
    pub(crate) result: String,
    pub(crate) inputs: Vec<Parameter>,
    pub(crate) inouts: Vec<Parameter>,
    pub(crate) outputs: Vec<Parameter>,
}

/// A parameter or a member with its type, as they are written.
pub(crate) struct Parameter {
    pub(crate) name: String,
    pub(crate) ty: String,
}

/// The units by their names in upper case, and the types: the members of a structure (none for other types), and the
/// text of the declaration.
pub(crate) struct Library {
    pub(crate) units: BTreeMap<String, Unit>,
    pub(crate) types: BTreeMap<String, (Vec<Parameter>, String)>,
}

impl Library {
    /// All files `plc.st` in a folder. Of units with one name the first is taken.
    pub(crate) fn read(folder: &Path) -> Library {
        let mut files = Vec::new();
        find(folder, &mut files);
        files.sort();
        let mut library = Library { units: BTreeMap::new(), types: BTreeMap::new() };
        for file in files {
            let bytes = std::fs::read(&file).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
            library.add(&String::from_utf8_lossy(&bytes));
        }
        library
    }

    fn add(&mut self, text: &str) {
        let mut lines = text.lines();
        while let Some(line) = lines.next() {
            let words: Vec<&str> = line.split_whitespace().collect();
            let end = match words.first() {
                Some(&"FUNCTION") => "END_FUNCTION",
                Some(&"FUNCTION_BLOCK") => "END_FUNCTION_BLOCK",
                Some(&"TYPE") => "END_TYPE",
                _ => continue,
            };
            let body: Vec<&str> = lines.by_ref().take_while(|l| !l.trim_start().starts_with(end)).collect();
            match words.as_slice() {
                ["TYPE"] => self.add_types(&bare(&body.join("\n"))),
                [_, name, rest @ ..] => {
                    let unit = Unit::new(name, rest.last().unwrap_or(&""), line, &body, end);
                    self.units.entry(name.to_uppercase()).or_insert(unit);
                }
                _ => {}
            }
        }
    }

    fn add_types(&mut self, text: &str) {
        let mut rest = text;
        while let Some((name, behind)) = rest.split_once(':') {
            let (members, body, next) = if behind.trim_start().starts_with("STRUCT") {
                let (fields, next) = behind.split_once("END_STRUCT").unwrap_or((behind, ""));
                let fields = fields.trim_start().trim_start_matches("STRUCT");
                let next = next.split_once(';').map_or("", |(_, next)| next);
                (parameters(fields), format!("STRUCT {fields} END_STRUCT"), next)
            } else {
                let (body, next) = behind.split_once(';').unwrap_or((behind, ""));
                (Vec::new(), body.to_owned(), next)
            };
            let name = name.trim();
            self.types.entry(name.to_uppercase()).or_insert((members, format!("{name} : {body};\n")));
            rest = next;
        }
    }

    /// The names of the units that one needs, itself the last.
    pub(crate) fn needs(&self, name: &str) -> Vec<&Unit> {
        let (mut seen, mut order) = (BTreeSet::new(), Vec::new());
        self.collect(name, &mut seen, &mut order);
        order
    }

    fn collect<'l>(&'l self, name: &str, seen: &mut BTreeSet<String>, order: &mut Vec<&'l Unit>) {
        let Some(unit) = self.units.get(name).filter(|_| seen.insert(name.to_owned())) else { return };
        let text = bare(&unit.text).to_uppercase();
        for (word, before, behind) in words(&text) {
            let of_type = before == Some(':') && !matches!(behind, Some('('));
            let fits = |u: &&Unit| if u.function { behind == Some('(') } else { of_type };
            if self.units.get(word).filter(fits).is_some() {
                self.collect(word, seen, order);
            }
        }
        order.push(unit);
    }

    /// The declarations of the types that a text names.
    pub(crate) fn types_of(&self, text: &str) -> String {
        let mut found = Vec::new();
        self.collect_types(text, &mut found);
        found.iter().filter_map(|name| self.types.get(name)).map(|(_, text)| text.as_str()).collect()
    }

    fn collect_types(&self, text: &str, found: &mut Vec<String>) {
        for (word, ..) in words(&bare(text).to_uppercase()) {
            if let Some((_, text)) = self.types.get(word).filter(|_| !found.iter().any(|f| f == word)) {
                let own = text.split_once(':').map_or("", |(_, body)| body);
                self.collect_types(own, found);
                found.push(word.to_owned());
            }
        }
    }
}

fn find(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            find(&path, files);
        } else if path.file_name().is_some_and(|n| n == "plc.st") {
            files.push(path);
        }
    }
}

/// The words of a text with the signs before and behind each.
fn words(text: &str) -> Vec<(&str, Option<char>, Option<char>)> {
    let part = |c: char| c.is_alphanumeric() || c == '_';
    let mut found = Vec::new();
    let mut at = 0;
    while let Some(start) = text.get(at..).and_then(|t| t.find(part)).map(|n| n + at) {
        let rest = text.get(start..).unwrap_or("");
        let end = start + rest.find(|c| !part(c)).unwrap_or(rest.len());
        let before = text.get(..start).unwrap_or("").trim_end().chars().next_back();
        let behind = text.get(end..).unwrap_or("").trim_start().chars().next();
        found.push((text.get(start..end).unwrap_or(""), before, behind));
        at = end;
    }
    found
}

/// A text without its comments.
pub(crate) fn bare(text: &str) -> String {
    let mut bare = String::new();
    let mut rest = text;
    while let Some((before, behind)) = rest.split_once("(*") {
        bare += before;
        bare.push(' ');
        rest = behind.split_once("*)").map_or("", |(_, rest)| rest);
    }
    bare + rest
}

impl Unit {
    fn new(name: &str, result: &str, head: &str, body: &[&str], end: &str) -> Unit {
        let mut text = format!("{head}\n{}", body.join("\n"));
        // A comment that is cut off at the end of a unit.
        if text.rfind("(*") > text.rfind("*)") {
            text.truncate(text.rfind("(*").unwrap_or(text.len()));
        }
        text += &format!("\n{end}\n");
        let plain = bare(&text);
        let section = |word: &str| {
            let parts = plain.split("END_VAR").filter_map(|part| {
                let (_, own) =
                    part.split_once(&format!("{word} ")).or_else(|| part.split_once(&format!("{word}\n")))?;
                Some(parameters(own.trim_start().trim_start_matches("CONSTANT").trim_start_matches("RETAIN")))
            });
            parts.flatten().collect::<Vec<_>>()
        };
        Unit {
            name: name.to_owned(),
            function: end == "END_FUNCTION",
            result: result.to_owned(),
            inputs: section("VAR_INPUT"),
            inouts: section("VAR_IN_OUT"),
            outputs: section("VAR_OUTPUT"),
            text,
        }
    }
}

/// `a, b : INT := 3;`.
fn parameters(text: &str) -> Vec<Parameter> {
    let mut found = Vec::new();
    for declaration in text.split(';') {
        let Some((names, rest)) = declaration.split_once(':') else { continue };
        let ty = rest.split(":=").next().unwrap_or("").trim().to_owned();
        found.extend(names.split(',').map(|n| Parameter { name: n.trim().to_owned(), ty: ty.clone() }));
    }
    found
}
