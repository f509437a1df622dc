//! The helpers of printed C. `helpers.c` is followed as a compiler does it: what stands
//! between `#define` and `#undef` is put into the files that it includes there.

use std::collections::BTreeMap;

use g7_runtime::source::File;

use super::helpers::{Helper, link, pieces, put_in};
use super::{Result, wrong};

/// The helpers of printed C: the files that the first one includes.
pub(super) fn helpers(files: &[File]) -> Result<Vec<Helper>> {
    let Some(main) = files.first() else { return Err("no C".into()) };
    let mut defined: BTreeMap<String, String> = BTreeMap::new();
    let mut all: Vec<Helper> = Vec::new();
    for line in main.text.lines() {
        if let Some(rest) = line.strip_prefix("#define ") {
            let (name, value) = rest.split_once(' ').unwrap_or((rest, ""));
            defined.insert(name.to_owned(), value.to_owned());
        } else if let Some(name) = line.strip_prefix("#undef ") {
            defined.remove(name);
        } else if let Some(name) = line.strip_prefix("#include \"").and_then(|r| r.strip_suffix('"')) {
            let Some(found) = files.iter().find(|f| f.path == format!("c/{name}")) else {
                return wrong(main, format!("`{name}` is not there"));
            };
            self::file(found, &defined, &mut all)?;
        }
    }
    link(&mut all);
    Ok(all)
}

fn file(file: &File, defined: &BTreeMap<String, String>, all: &mut Vec<Helper>) -> Result<()> {
    for piece in pieces(file.text) {
        let mut text = piece;
        for (name, value) in defined {
            match name.split_once('(') {
                None => text = put_in(&text, name, value),
                Some((name, argument)) => text = pasted(&text, name, argument.trim_end_matches(')'), value),
            }
        }
        if text.starts_with("enum") {
            continue; // the faults, which each chart prints itself
        }
        let head = text.lines().find(|l| l.starts_with("static ")).and_then(|l| l.split_once('('));
        let Some((head, _)) = head else { return wrong(file, format!("no function:\n{text}")) };
        let name = head.rsplit([' ', '*']).next().unwrap_or("").to_owned();
        if all.iter().any(|h| h.name == name) {
            return wrong(file, format!("`{name}` stands there twice"));
        }
        let mut helper = Helper::new(&name, true, text);
        helper.math = file.path.ends_with("reals.h");
        all.push(helper);
    }
    Ok(())
}

/// `OF(add)` as `add_i16`, where `OF(op)` is `op##_i16`.
fn pasted(text: &str, name: &str, argument: &str, value: &str) -> String {
    let mut out = String::new();
    let mut rest = text;
    let call = format!("{name}(");
    while let Some((before, behind)) = rest.split_once(&call) {
        let (inner, behind) = behind.split_once(')').unwrap_or((behind, ""));
        out += before;
        out += &put_in(&value.replace("##", " ## "), argument, inner).replace(" ## ", "");
        rest = behind;
    }
    out + rest
}
