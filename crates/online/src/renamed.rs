//! The names of an io file after a chart has given one of its parts another name.

use std::ops::Range;

use g7_model::FileId;
use g7_rig::{Bench, Item, Role};

use crate::names::{Named, named};
use crate::setup::{self, At};

/// The places of an io file that name what is called otherwise in the changed chart, each with its new text.
///
/// Names that the old chart does not have are left alone.
pub fn renamed(text: &str, old: &Bench, new: &Bench) -> Vec<(Range<usize>, String)> {
    let mut changes: Vec<(Range<usize>, String)> = names(text)
        .iter()
        .filter_map(|name| {
            let (to, same) = match (named(old, name).ok()?, named(new, name).ok()) {
                (Named::Item(item), now) => {
                    let to = other(item, new)?;
                    (to.name.clone(), matches!(now, Some(Named::Item(now)) if now.addr == to.addr))
                }
                (Named::Step(step), now) => {
                    let to = new.steps.iter().find(|s| s.id == step.id)?;
                    (to.activity(), matches!(now, Some(Named::Step(now)) if now.id == to.id))
                }
            };
            let place = name.at.bytes();
            let raw = text.get(place.clone())?;
            (!same).then(|| (place, as_key(raw, &to)))
        })
        .collect();
    changes.sort_by_key(|(place, _)| place.start);
    changes
}

/// The variable of the other chart that has the words of this one.
fn other<'b>(item: &Item, bench: &'b Bench) -> Option<&'b Item> {
    let same =
        |i: &&Item| i.role != Role::Plant && (i.addr, i.words, i.kind) == (item.addr, item.words, item.kind);
    bench.items.iter().find(same)
}

/// All names of variables and steps, those of channels that cannot be read among them.
fn names(text: &str) -> Vec<At<String>> {
    let mut names: Vec<At<String>> = Vec::new();
    for entry in setup::outline(text, FileId(0)) {
        let path: Vec<&str> = entry.path.iter().map(String::as_str).collect();
        if let ["inputs" | "outputs" | "shown", name] | ["history", "deadband", name] = path.as_slice() {
            names.push(At { value: (*name).to_owned(), at: entry.key });
        }
    }
    let history = setup::read(text, FileId(0)).0.history;
    names.extend(history.and_then(|h| h.signals).unwrap_or_default());
    names
}

/// A name as the text writes it at a place: in its quotes, if it has some or needs some.
fn as_key(raw: &str, name: &str) -> String {
    let bare = |c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '-');
    match raw.chars().next() {
        // Nothing is escaped between single quotes.
        Some('\'') if !name.contains('\'') => format!("'{name}'"),
        Some('\'' | '"') => quoted(name),
        _ if name.chars().all(bare) => name.to_owned(),
        _ => quoted(name),
    }
}

/// A name in double quotes, with the escapes of TOML.
fn quoted(name: &str) -> String {
    format!("\"{}\"", name.replace('\\', "\\\\").replace('"', "\\\""))
}

#[cfg(test)]
mod tests {
    use super::*;
    use g7_rig::{Options, Source};

    fn bench(text: &str) -> Bench {
        let source = Source::native("chart.g7", text.as_bytes().to_vec(), 0);
        g7_rig::build(&source, &Options::default()).expect("a plant").0.expect("a bench")
    }

    const CHART: &str = "input go : BOOL\noutput V : BOOL\nvar num : INT\nchart G {\n  var k : INT\n  \
        initial step 0\n  step 1 {\n    N V\n    P1 num := num + 1\n    P1 k := k + num\n  }\n  \
        0 -> 1 when go\n  1 -> 0 when not go\n}\n";

    fn changed(io: &str, from: &str, to: &str) -> String {
        let mut text = io.to_owned();
        let new =
            CHART.replace(from, to).replace("0 -> 1", if to == "step 9 {" { "0 -> 9" } else { "0 -> 1" });
        let new = new.replace("1 -> 0", if to == "step 9 {" { "9 -> 0" } else { "1 -> 0" });
        for (place, name) in renamed(io, &bench(CHART), &bench(&new)).into_iter().rev() {
            text.replace_range(place, &name);
        }
        text
    }

    #[test]
    fn a_name_with_quotes_in_it_is_escaped() {
        assert_eq!(as_key("'go'", "it's"), "\"it's\"");
        for raw in ["go", "\"go\"", "'go'"] {
            let text = format!("{} = 1", as_key(raw, "it's a \"\\\""));
            let table = toml::de::DeTable::parse(&text).expect("TOML").into_inner();
            let names: Vec<&str> = table.keys().map(|key| &**key.get_ref()).collect();
            assert_eq!(names, ["it's a \"\\\""], "{text}");
        }
    }

    #[test]
    fn each_name_of_an_io_file_follows_the_chart_in_its_own_quotes() {
        let io = "[devices.d]\nkind = 'modbus-tcp'\nhost = 'go'\n[inputs]\ngo = 'd.coil(0)' # go\n\
            [outputs]\n'V' = 'd.coil(1)'\n[shown]\nX1 = 'd.nothing'\n\"G.k\" = { at = 'd.input(3)' }\n\
            [history]\nfile = 'h'\nsignals = ['go', \"X1\", 'num']\ndeadband = { num = 2 }\n";
        let start = io.replace("\ngo = 'd.coil", "\nstart = 'd.coil").replace("['go'", "['start'");
        assert_eq!(changed(io, "go", "start"), start);
        assert_eq!(
            changed(io, "go", "démarrer"),
            start.replace("\nstart", "\n\"démarrer\"").replace("'start'", "'démarrer'")
        );
        assert_eq!(changed(io, "V", "W"), io.replace("'V'", "'W'"));
        assert_eq!(changed(io, "num", "count"), io.replace("num", "count"));
        assert_eq!(changed(io, "step 1 {", "step 9 {").replace("X9", "X1"), io);
        assert_eq!(changed(io, "G", "H"), io.replace("G.k", "H.k"));
        assert_eq!(changed(io, "none", "of it"), io);
    }
}
