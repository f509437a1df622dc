//! The part of printed C that is the same for all charts: `g7.h`, `g7.c` and `g7_math.h`.
//!
//! ```text
//! helpers of the runtime (text) + its functions that know no chart (tree) -> here -> files
//! ```
//!
//! # Invariants
//!
//! - Nothing here depends on a chart: the files are the same whatever is printed beside them, so that a program of
//!   several charts has them once. A test links charts of all kinds with one `g7.c`.
//! - What is called in each pass is `static inline`; functions of `<math.h>` stand in a header of their own, so that
//!   a program without them does not need the library.

use std::collections::HashSet;

use crate::c::{FAULT, Printer, SHARED};
use crate::c_words::FLASH;
use crate::output::File;
use crate::runtime::{self, Helper};
use crate::tree::{Module, Numbers};

/// Functions of the runtime that know no chart: bits, and the function blocks of IEC 61131-3.
const FUNCTIONS: [&str; 16] = [
    "bit",
    "bit_set",
    "bit_clear",
    "bit_next",
    "gone_by",
    "not_negative",
    "call_ctu",
    "call_ctd",
    "call_ctud",
    "call_ton",
    "call_tof",
    "call_tp",
    "call_r_trig",
    "call_f_trig",
    "call_sr",
    "call_rs",
];

/// The structures of the function blocks.
const STRUCTS: [&str; 10] = ["Ctu", "Ctd", "Ctud", "Ton", "Tof", "Tp", "RTrig", "FTrig", "Sr", "Rs"];

/// Short functions that are called in each pass.
const INLINE: [&str; 12] = [
    "low_bit",
    "since",
    "ticks_gone",
    "ticks_since",
    "ticks_held",
    "has_turned",
    "is_due_after",
    "fail",
    "bit",
    "bit_set",
    "bit_clear",
    "bit_next",
];

/// The parts of these files that a module can use, by the names of the tree. Function blocks of the flat style remember
/// something else, so they are the chart's own.
pub(crate) fn names_for(of: &Module) -> HashSet<&'static str> {
    let same = |name: &str| {
        let in_chart = of.structs.iter().find(|s| s.name == name);
        in_chart.is_none_or(|s| {
            module().structs.iter().any(|fixed| fixed.name == name && fixed.fields == s.fields)
        })
    };
    names().into_iter().filter(|n| !STRUCTS.contains(n) || same(n)).collect()
}

/// All that stands in these files, by the names of the tree.
fn names() -> HashSet<&'static str> {
    let helpers = runtime::c_helpers().iter().map(|h| h.name);
    helpers.chain(FUNCTIONS).chain(STRUCTS).collect()
}

/// The names of the faults as they are in all files.
pub(crate) fn with_faults(text: &str) -> String {
    text.replace("FAULT_", "G7_FAULT_")
}

/// A helper with the names that it has outside of one file.
fn named(helper: &Helper, names: &HashSet<&str>) -> String {
    let text = with_faults(helper.text);
    let mut out = String::new();
    let mut rest = text.as_str();
    while let Some(at) = rest.find(|c: char| c.is_ascii_alphabetic() || c == '_') {
        let (before, behind) = rest.split_at(at);
        let end = behind.find(|c: char| !(c.is_ascii_alphanumeric() || c == '_')).unwrap_or(behind.len());
        let (word, behind) = behind.split_at(end);
        out += before;
        // Behind a digit, as in `0U`, a letter is no name.
        if names.contains(word) && !before.ends_with(|c: char| c.is_ascii_digit()) {
            out += SHARED;
            out += "_";
        }
        out += word;
        rest = behind;
    }
    out + rest
}

/// The head of a function, as a declaration, from its text.
fn head(text: &str) -> Option<String> {
    let (above, _) = text.split_once("\n{")?;
    Some(format!("{above};\n"))
}

/// The functions that are the same for every chart, as one module.
fn module() -> Module {
    let (structs, functions) = runtime::of(&runtime::Facts::default());
    let mut functions: Vec<_> =
        functions.into_iter().filter(|f| FUNCTIONS.contains(&f.name.as_str())).collect();
    functions.iter_mut().for_each(|f| f.public = true);
    let faults = runtime::FAULTS.iter().enumerate();
    let rows = faults.map(|(i, (name, note))| ((*name).to_owned(), i, (*note).to_owned()));
    let faults = Numbers {
        note: "The faults that stop a scan.".into(),
        name: FAULT.into(),
        public: true,
        ty: None,
        rows: rows.collect(),
    };
    Module {
        numbers: vec![faults],
        structs: structs.into_iter().filter(|s| STRUCTS.contains(&s.name.as_str())).collect(),
        functions,
        ..Module::default()
    }
}

/// The functions as text: those for `g7.h`, and those for `g7.c`.
fn functions() -> (String, String, Vec<String>) {
    let names = names();
    let (mut inline, mut rest, mut heads) = (String::new(), String::new(), Vec::new());
    let mut put = |name: &str, text: &str| {
        if INLINE.contains(&name) {
            let at = text.find("static ").map_or(0, |at| at + "static ".len());
            let (above, below) = text.split_at(at);
            inline += &format!("{above}inline {below}\n\n");
        } else {
            let text = text.replacen("static ", "", 1);
            heads.extend(head(&text));
            rest += &format!("{text}\n\n");
        }
    };
    for helper in runtime::c_helpers().iter().filter(|h| !h.math) {
        put(helper.name, &named(helper, &names));
    }
    let module = module();
    for (name, text) in Printer::apart(&module, SHARED, names.clone()).each_function() {
        let text = text.trim_end();
        let line = text.lines().position(|l| !l.starts_with("/*") && !l.starts_with(" *")).unwrap_or(0);
        let start = text.split_inclusive('\n').take(line).map(str::len).sum();
        let (above, below) = text.split_at(start);
        put(name, &format!("{above}static {below}"));
    }
    (inline, rest, heads)
}

/// `g7.h` and `g7.c`; `g7_math.h` where a chart has functions of `<math.h>`.
pub(crate) fn files(math: bool) -> Vec<File> {
    let module = module();
    let (inline, rest, heads) = functions();
    let mut p = Printer::new(&module, SHARED);
    p.kinds();
    let kinds = p.taken();
    let open = "#ifdef __cplusplus\nextern \"C\" {\n#endif\n";
    let close = "#ifdef __cplusplus\n}\n#endif\n";
    let header = format!(
        "/* What all charts have in common, printed by G7; it is the same for each of them. */\n#ifndef G7_H\n#define \
         G7_H\n\n#include <stdbool.h>\n#include <stdint.h>\n\n{open}\n{FLASH}{kinds}\n{inline}{}\n{close}\n#endif\n",
        heads.join("\n")
    );
    let source = format!(
        "/* What all charts have in common, printed by G7: a program has it once, however many charts it has. */\n\
         #include \"g7.h\"\n\n{}\n",
        rest.trim_end()
    );
    let mut files = Vec::new();
    if math {
        let names = names();
        let texts = runtime::c_helpers().iter().filter(|h| h.math);
        let texts: Vec<String> =
            texts.map(|h| named(h, &names).replacen("static ", "static inline ", 1)).collect();
        let text = format!(
            "/* Functions of reals, printed by G7: they need <math.h> and its library. */\n#ifndef G7_MATH_H\n#define \
             G7_MATH_H\n\n#include <math.h>\n\n{}\n\n#endif\n",
            texts.join("\n\n")
        );
        files.push(File { name: "g7_math.h".into(), text });
    }
    files.push(File { name: "g7.h".into(), text: header });
    files.push(File { name: "g7.c".into(), text: source });
    files
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::runtime::Facts;

    #[test]
    fn what_stands_here_is_the_same_for_all_charts() {
        let pick = |facts: &Facts| {
            let (structs, functions) = runtime::of(facts);
            let functions: Vec<_> =
                functions.into_iter().filter(|f| FUNCTIONS.contains(&f.name.as_str())).collect();
            let structs: Vec<_> =
                structs.into_iter().filter(|s| STRUCTS.contains(&s.name.as_str())).collect();
            assert_eq!((functions.len(), structs.len()), (FUNCTIONS.len(), STRUCTS.len()));
            (structs, functions)
        };
        let other = Facts { row_bits: 16, tick_bits: 32, narrow: true, stable: true, ..Facts::default() };
        assert_eq!(pick(&Facts::default()), pick(&other));
    }

    #[test]
    fn every_helper_stands_in_one_file() {
        let files = files(true);
        for name in names().into_iter().filter(|n| !STRUCTS.contains(n)) {
            let defined = format!(" {SHARED}_{name}(");
            // A head begins its line; behind it stands a body, behind a declaration a semicolon.
            let is_body = |part: &&str| {
                let head = part.lines().find(|l| !l.starts_with("/*") && !l.starts_with(" *"));
                head.is_some_and(|l| l.contains(&defined)) && part.contains("\n{")
            };
            let count = files.iter().flat_map(|f| f.text.split("\n\n")).filter(is_body).count();
            assert_eq!(count, 1, "{name}");
        }
    }
}
