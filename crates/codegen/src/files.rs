//! The files of printed C.
//!
//! ```text
//! tree::Module + the helpers that it calls -> c::Printer (texts) -> here: which text stands in which file
//! ```
//!
//! # Where this sits
//!
//! [`crate::print_as`] calls it with a module that is pruned. `Parts::Whole` has two files that need no other,
//! `Parts::One` one, and `Parts::Apart` five: what no chart changes (`fixed`), the evolution of the chart
//! (`NAME_run.h`), and what reads as the chart (`NAME.h`, `NAME.c`).

use crate::c::Printer;
use crate::c_words::FLASH;
use crate::fixed;
use crate::output::{File, Parts};
use crate::room::Room;
use crate::runtime::{self, Helpers};
use crate::tree::{Function, Module};

/// Comparisons that follow from the structures; they say nothing about a chart.
const SAME: &str = "same_";

/// The files of a chart, the main one last.
pub(crate) fn c(module: &Module, helpers: &Helpers, name: &str, room: Room, parts: Parts) -> Vec<File> {
    if parts == Parts::Apart {
        return apart(module, helpers, name, room);
    }
    let header =
        header(&mut Printer::new(module, name), name, room, "#include <stdbool.h>\n#include <stdint.h>");
    let mut p = Printer::new(module, name);
    let includes = if helpers.math { "#include <math.h>\n" } else { "" };
    let flash = if p.has_flash() { FLASH } else { "" };
    let helpers = fixed::with_faults(&helpers.text);
    p.tables();
    let tables = p.taken();
    p.heads();
    let heads = p.taken();
    p.functions(|_| true);
    let rest = [flash, &tables, "\n", &helpers, &heads, "\n", &p.taken()].concat();
    if parts == Parts::One {
        return vec![File { name: format!("{name}.c"), text: format!("{header}\n{includes}\n{rest}") }];
    }
    let text = format!("/* The chart {name}, printed by G7. */\n#include \"{name}.h\"\n{includes}\n{rest}");
    vec![File { name: format!("{name}.h"), text: header }, File { name: format!("{name}.c"), text }]
}

/// The declarations of a chart, guarded.
fn header(p: &mut Printer<'_>, name: &str, room: Room, includes: &str) -> String {
    let guard = format!("{}_H", name.to_uppercase());
    let mut text = format!(
        "/* The chart {name}, printed by G7. Call {name}_init once, then {name}_scan in each cycle. */\n"
    );
    if room.is_narrow() {
        text += &format!("/* {} */\n", room.note());
    }
    p.declarations();
    text += &format!("#ifndef {guard}\n#define {guard}\n\n{includes}\n\n");
    text + "#ifdef __cplusplus\nextern \"C\" {\n#endif\n\n"
        + &p.taken()
        + "\n#ifdef __cplusplus\n}\n#endif\n\n#endif\n"
}

/// The chart apart from what all charts have in common.
fn apart(module: &Module, helpers: &Helpers, name: &str, room: Room) -> Vec<File> {
    let rules = runtime::names();
    let is_rule = |f: &Function| !f.public && (rules.contains(f.name.as_str()) || f.name.starts_with(SAME));
    let printer = || Printer::apart(module, name, fixed::names_for(module));
    let header = header(&mut printer(), name, room, "#include \"g7.h\"");
    let mut p = printer();
    p.tables();
    let tables = p.taken();
    p.heads();
    let heads = p.taken();
    p.functions(is_rule);
    let rules = p.taken();
    p.functions(|f| !is_rule(f));
    let chart = p.taken();
    let guard = format!("{}_RUN_H", name.to_uppercase());
    let gap = if tables.is_empty() { "" } else { "\n" };
    let run = format!(
        "/* The chart {name}, printed by G7: its tables, and how it evolves by the rules of its profile. {name}.c\n * \
         alone includes this. */\n#ifndef {guard}\n#define {guard}\n\n#include \"{name}.h\"\n\n{tables}{gap}{heads}\n\
         {rules}\n#endif\n"
    );
    let math = if helpers.math { "#include \"g7_math.h\"\n" } else { "" };
    let text = format!("/* The chart {name}, printed by G7. */\n#include \"{name}_run.h\"\n{math}\n{chart}");
    let mut files = fixed::files(helpers.math);
    let own = [("_run.h", run), (".h", header), (".c", text)];
    files.extend(own.into_iter().map(|(ending, text)| File { name: format!("{name}{ending}"), text }));
    files
}
