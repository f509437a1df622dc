//! Circles of files: files of one crate that use each other in a ring.
//!
//! A file uses another where it imports a name from it or calls it by a path. A name
//! that a `mod.rs` hands on belongs to the file that defines it, so handing it on is
//! no use of that file.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// The path of a module within its crate; empty for the root.
type Module = Vec<String>;

/// A file as far as its imports matter.
#[derive(Default)]
struct File {
    /// The paths by which it names something else.
    paths: Vec<Vec<String>>,
    /// The names that it hands on, with the path of each.
    handed_on: BTreeMap<String, Vec<String>>,
}

/// The groups of files that form circles, each as `a -> b` arrows of the group.
pub(crate) fn circles(files: &[(&Path, String)]) -> Vec<Vec<String>> {
    let mut modules: BTreeMap<Module, Vec<String>> = BTreeMap::new();
    for (path, text) in files {
        if let Some(module) = module(path) {
            modules.insert(module, tokens(&product(text)));
        }
    }
    let names: BTreeSet<Module> = modules.keys().cloned().collect();
    let read: BTreeMap<&Module, File> =
        modules.iter().map(|(module, tokens)| (module, file(module, tokens, &names))).collect();
    let mut arrows: BTreeMap<&Module, BTreeSet<&Module>> = BTreeMap::new();
    for (module, file) in &read {
        let targets = file.paths.iter().filter_map(|path| target(module, path, &read, 0));
        arrows.insert(module, targets.filter(|t| t != module).collect());
    }
    rings(&arrows)
}

/// The module that a file is; none for files of tests.
fn module(path: &Path) -> Option<Module> {
    let mut parts: Module =
        path.with_extension("").iter().map(|p| p.to_string_lossy().into_owned()).collect();
    if parts.last().is_some_and(|last| matches!(last.as_str(), "mod" | "lib" | "main")) {
        parts.pop();
    }
    let test = parts.iter().any(|p| p == "tests" || p.ends_with("_tests"));
    (!test).then_some(parts)
}

/// A text without comments, texts in quotes and the tests at its end.
fn product(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(c) = rest.chars().next() {
        let skipped = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if rest.starts_with("/*") {
            rest.find("*/").map_or(rest.len(), |i| i + 2)
        } else if rest.starts_with("r#\"") {
            rest.find("\"#").map_or(rest.len(), |i| i + 2)
        } else if c == '"' {
            quoted(rest, '"')
        } else if rest.starts_with("'\\") || c == '\'' && rest.chars().nth(2) == Some('\'') {
            quoted(rest, '\'')
        } else {
            out.push(c);
            c.len_utf8()
        };
        rest = rest.get(skipped..).unwrap_or("");
    }
    let tests = out.find("#[cfg(test)]").filter(|i| {
        let behind = out.get(i + 12..).unwrap_or("").trim_start();
        behind.starts_with("mod ") && behind.find('{') < behind.find(';')
    });
    out.truncate(tests.unwrap_or(out.len()));
    out
}

/// The length of a literal that begins with a quote.
fn quoted(text: &str, quote: char) -> usize {
    let mut escaped = false;
    for (i, c) in text.char_indices().skip(1) {
        match c {
            _ if escaped => escaped = false,
            '\\' => escaped = true,
            c if c == quote => return i + c.len_utf8(),
            _ => {}
        }
    }
    text.len()
}

/// Words, `::` and single signs.
fn tokens(text: &str) -> Vec<String> {
    let mut out: Vec<String> = Vec::new();
    let mut open = false;
    for c in text.chars() {
        let word = c.is_alphanumeric() || c == '_';
        match out.last_mut() {
            Some(last) if word && open => last.push(c),
            Some(last) if c == ':' && last == ":" => last.push(c),
            _ if c.is_whitespace() => {}
            _ => out.push(c.to_string()),
        }
        open = word;
    }
    out
}

/// The paths of a file, and what it hands on.
fn file(module: &Module, tokens: &[String], names: &BTreeSet<Module>) -> File {
    let children: BTreeSet<&str> = names
        .iter()
        .filter(|n| n.len() == module.len() + 1 && n.starts_with(module))
        .filter_map(|n| n.last().map(String::as_str))
        .collect();
    let begins = |word: &str| matches!(word, "crate" | "super" | "self") || children.contains(word);
    let mut file = File::default();
    let mut exported = Vec::new();
    let mut words = BTreeSet::new();
    let mut at = 0;
    while let Some(token) = tokens.get(at) {
        if token == "use" {
            let public = at > 0 && tokens.get(at - 1).is_some_and(|t| t == "pub" || t == ")");
            let end = tokens.iter().skip(at).position(|t| t == ";").map_or(tokens.len(), |i| at + i);
            let mut found = Vec::new();
            tree(tokens.get(at + 1..end).unwrap_or(&[]), &[], &mut found);
            if public {
                exported.extend(found)
            } else {
                file.paths.extend(found)
            }
            at = end;
            continue;
        }
        let mut path = vec![token.clone()];
        while tokens.get(at + 1).is_some_and(|t| t == "::")
            && tokens.get(at + 2).is_some_and(|t| t.starts_with(|c: char| c.is_alphabetic() || c == '_'))
        {
            path.extend(tokens.get(at + 2).cloned());
            at += 2;
        }
        words.extend(path.first().cloned());
        if path.len() > 1 && begins(token) {
            file.paths.push(path);
        }
        at += 1;
    }
    for path in exported {
        let Some(name) = path.last().cloned() else { continue };
        // A name that it hands on and uses itself counts as a use.
        if words.contains(&name) {
            file.paths.push(path.clone());
        }
        file.handed_on.insert(name, path);
    }
    file.paths.retain(|p| p.first().is_some_and(|first| begins(first)));
    file
}

/// The paths of a tree of imports.
fn tree(tokens: &[String], before: &[String], found: &mut Vec<Vec<String>>) {
    let mut path = before.to_vec();
    let mut at = 0;
    while let Some(token) = tokens.get(at) {
        match token.as_str() {
            "{" => {
                let mut depth = 0;
                let mut start = at + 1;
                for (i, token) in tokens.iter().enumerate().skip(at) {
                    match token.as_str() {
                        "{" => depth += 1,
                        "}" => depth -= 1,
                        _ => {}
                    }
                    if depth == 0 || depth == 1 && token == "," {
                        let part = tokens.get(start..i).unwrap_or(&[]);
                        if !part.is_empty() {
                            tree(part, &path, found);
                        }
                        start = i + 1;
                    }
                }
                return;
            }
            "as" => break,
            "::" => {}
            // `a::{self}` is `a`.
            "self" if !path.is_empty() => {}
            word => path.push(word.to_owned()),
        }
        at += 1;
    }
    found.push(path);
}

/// The file that a path in a module leads to.
fn target<'a>(
    module: &Module,
    path: &[String],
    read: &BTreeMap<&'a Module, File>,
    depth: usize,
) -> Option<&'a Module> {
    let mut here = if path.first().is_some_and(|p| p == "crate") { Module::new() } else { module.clone() };
    let mut rest = path;
    while let Some((first, behind)) = rest.split_first() {
        match first.as_str() {
            "crate" | "self" => {}
            "super" => drop(here.pop()),
            _ => break,
        }
        rest = behind;
    }
    while let Some((first, behind)) = rest.split_first() {
        let inner: Module = here.iter().chain([first]).cloned().collect();
        if !read.contains_key(&inner) {
            break;
        }
        here = inner;
        rest = behind;
    }
    let (known, file) = read.get_key_value(&here)?;
    let handed_on = rest.first().and_then(|name| file.handed_on.get(name)).filter(|_| depth < 8);
    handed_on.and_then(|path| target(&here, path, read, depth + 1)).or(Some(known))
}

/// The arrows between files that reach each other, group by group.
fn rings(arrows: &BTreeMap<&Module, BTreeSet<&Module>>) -> Vec<Vec<String>> {
    let reached: BTreeMap<&Module, BTreeSet<&Module>> = arrows
        .keys()
        .map(|start| {
            let mut seen = BTreeSet::new();
            let mut open = vec![*start];
            while let Some(at) = open.pop() {
                open.extend(arrows.get(at).into_iter().flatten().filter(|next| seen.insert(**next)));
            }
            (*start, seen)
        })
        .collect();
    let mutual = |a: &Module, b: &Module| {
        reached.get(a).is_some_and(|r| r.contains(b)) && reached.get(b).is_some_and(|r| r.contains(a))
    };
    let name = |m: &Module| if m.is_empty() { "the root".to_owned() } else { m.join("::") };
    let mut groups = Vec::new();
    let mut grouped = BTreeSet::new();
    for first in arrows.keys().filter(|m| mutual(m, m)) {
        if grouped.contains(first) {
            continue;
        }
        let group: BTreeSet<&Module> = arrows.keys().copied().filter(|m| mutual(first, m)).collect();
        let inside = |a: &&Module| arrows.get(*a).into_iter().flatten().filter(|b| group.contains(**b));
        let lines = group.iter().flat_map(|a| inside(a).map(|b| format!("{} -> {}", name(a), name(b))));
        groups.push(lines.collect());
        grouped.extend(group);
    }
    groups
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(files: &[(&str, &str)]) -> Vec<Vec<String>> {
        let files: Vec<(&Path, String)> =
            files.iter().map(|(p, t)| (Path::new(*p), (*t).to_owned())).collect();
        circles(&files)
    }

    #[test]
    fn two_files_that_use_each_other_are_a_circle() {
        let files = [
            ("lib.rs", "mod a; mod b; mod c;"),
            ("a.rs", "use crate::b::B; pub struct A;"),
            ("b.rs", "fn f() -> super::a::A { super::a::A }"),
            ("c.rs", "use crate::{a::A, b::{self, B}};"),
        ];
        assert_eq!(found(&files), [["a -> b", "b -> a"]]);
    }

    #[test]
    fn a_file_and_the_one_that_holds_it_may_be_a_circle() {
        let files = [("lib.rs", "mod a; fn f() { a::f() }"), ("a.rs", "use crate::f;")];
        assert_eq!(found(&files), [["the root -> a", "a -> the root"]]);
    }

    #[test]
    fn a_name_that_is_handed_on_is_that_of_its_file() {
        let files =
            [("lib.rs", "mod a; mod b; pub use a::A;"), ("a.rs", "pub struct A;"), ("b.rs", "use crate::A;")];
        assert_eq!(found(&files), Vec::<Vec<String>>::new());
        let files = [
            ("lib.rs", "mod a; mod b; pub use b::B;"),
            ("a.rs", "use crate::B; pub struct A;"),
            ("b.rs", "use crate::a::A; pub struct B;"),
        ];
        assert_eq!(found(&files), [["a -> b", "b -> a"]]);
    }

    #[test]
    fn comments_texts_and_tests_use_nothing() {
        let files = [
            ("lib.rs", "mod a; mod b;"),
            ("a.rs", "use crate::b::B;"),
            (
                "b.rs",
                "// use crate::a::A;\nconst T: &str = \"use crate::a::A;\"; const C: char = '\"';\n\
                 #[cfg(test)]\nmod tests { use crate::a::A; }",
            ),
        ];
        assert_eq!(found(&files), Vec::<Vec<String>>::new());
    }
}
