//! Files for draw.io: of every example and conformance case each step, transition and link is a cell, tied together as
//! in the chart, and nothing points to a cell that is not there.
#![allow(clippy::disallowed_methods, reason = "the tests read charts")]

use std::collections::{BTreeMap, BTreeSet};

use g7_draw::Options;
use g7_model::{Chart, Document};
use g7_tests::case;
use g7_tests::house::{ends_in, files, read};
use roxmltree::{Document as Xml, Node};

/// A cell by its attributes.
type Cell<'x> = Node<'x, 'x>;

fn attribute<'x>(cell: &Cell<'x>, name: &str) -> &'x str {
    cell.attribute(name).unwrap_or("")
}

/// The cells of a model by their ids. Checks that each parent, source and target exists, and that sizes are numbers.
fn cells<'x>(model: Node<'x, 'x>, what: &str) -> BTreeMap<&'x str, Cell<'x>> {
    let mut known: BTreeMap<&str, Cell<'_>> = BTreeMap::new();
    let all: Vec<Cell<'_>> = model.descendants().filter(|n| n.has_tag_name("mxCell")).collect();
    for cell in &all {
        let (id, parent) = (attribute(cell, "id"), attribute(cell, "parent"));
        assert!(id == "0" || known.contains_key(parent), "{what}: the parent of {id} stands before it");
        assert!(known.insert(id, *cell).is_none(), "{what}: {id} is there once");
        if cell.attribute("vertex").is_some() {
            let geometry = cell.first_element_child().expect("a geometry");
            for side in ["x", "y", "width", "height"] {
                let value: f64 = geometry.attribute(side).and_then(|v| v.parse().ok()).expect("a number");
                assert!(
                    value.abs() < 1e6 && (value >= 0.0 || side.len() == 1),
                    "{what}: {id} {side} {value}"
                );
            }
        }
    }
    for cell in &all {
        for end in ["source", "target"] {
            if let Some(name) = cell.attribute(end) {
                let at = known.get(name).unwrap_or_else(|| panic!("{what}: no cell {name}"));
                assert_eq!(attribute(at, "vertex"), "1", "{what}: {name}");
            }
        }
    }
    known
}

/// The pairs of a step and a transition that links tie, with what the drawing leaves to connectors left out.
fn tied(cells: &BTreeMap<&str, Cell<'_>>) -> BTreeSet<(String, String)> {
    let ends = |c: &Cell<'_>| (attribute(c, "source").to_owned(), attribute(c, "target").to_owned());
    cells.values().map(ends).filter(|(a, _)| !a.is_empty()).collect()
}

fn compare(chart: &Chart, cells: &BTreeMap<&str, Cell<'_>>, what: &str) {
    let steps: Vec<_> = chart.steps().collect();
    let place = |name: &str| steps.iter().position(|s| *s.name.text == *name);
    for (n, step) in steps.iter().enumerate() {
        let cell =
            cells.get(format!("s{n}").as_str()).unwrap_or_else(|| panic!("{what}: step {}", step.name.text));
        let shown: String = attribute(cell, "value").chars().filter(|c| !c.is_whitespace()).collect();
        let name: String = step.name.text.chars().filter(|c| !c.is_whitespace()).collect();
        assert!(
            shown == name || shown.contains('…') || name.contains(|c: char| c.is_control()),
            "{what}: {shown}"
        );
    }
    let mut asked = BTreeSet::new();
    for (n, t) in chart.transitions().enumerate() {
        assert!(cells.contains_key(format!("t{n}").as_str()), "{what}: transition {n}");
        let known =
            |names: &[g7_model::Name]| names.iter().filter_map(|s| place(&s.text)).collect::<Vec<_>>();
        asked.extend(known(&t.from).into_iter().map(|s| (format!("s{s}"), format!("t{n}"))));
        asked.extend(known(&t.to).into_iter().map(|s| (format!("t{n}"), format!("s{s}"))));
    }
    let tied = tied(cells);
    let foreign: Vec<_> = tied.difference(&asked).collect();
    assert!(foreign.is_empty(), "{what}: {foreign:?}");
    let connectors =
        cells.values().filter(|c| !attribute(c, "value").is_empty() && attribute(c, "parent") == "1").count();
    let left = asked.difference(&tied).count();
    assert!(left == 0 || connectors > steps.len(), "{what}: {left} links are missing");
}

fn check(document: &Document, what: &str) -> usize {
    let text = g7_draw::drawio(document, document.charts(), &Options::default());
    let xml = Xml::parse(&text).unwrap_or_else(|e| panic!("{what}: {e}"));
    let pages: Vec<Node<'_, '_>> = xml.descendants().filter(|n| n.has_tag_name("diagram")).collect();
    assert_eq!(pages.len(), document.charts().count(), "{what}");
    for (chart, page) in document.charts().zip(pages) {
        compare(chart, &cells(page, what), what);
    }
    document.charts().count()
}

#[test]
fn every_symbol_and_link_is_a_cell() {
    let mut charts = 0;
    for file in files().iter().filter(|f| f.starts_with("examples") && ends_in(f, &["g7"])) {
        let (document, _) = g7_syntax::parse(&read(file), g7_model::FileId(0));
        charts += check(&document, &file.display().to_string());
    }
    assert!(charts > 40, "{charts}");
    let root = g7_tests::house::root();
    for file in case::cases(&root.join("tests/spec")) {
        let Ok(read) = case::read(&read(&file)) else { continue };
        let (document, _) = g7_syntax::parse(&read.chart, g7_model::FileId(0));
        charts += check(&document, &file.display().to_string());
    }
    assert!(charts > 300, "{charts}");
}

/// Names that mean something in XML or in the form itself.
#[test]
fn no_text_leaves_its_cell() {
    let text = "chart G { initial step `<b>\"&]` \"a \\n & <i>\" 1 -> 1 when `x<y` }\ninput `x<y` : BOOL\n";
    let (document, _) = g7_syntax::parse(text, g7_model::FileId(0));
    check(&document, "strange names");
}

#[test]
fn the_library_has_each_step_and_each_transition() {
    let text = read("crates/g7/src/draw/symbols.g7");
    let (document, problems) = g7_syntax::parse(&text, g7_model::FileId(0));
    assert!(problems.is_empty(), "{problems:?}");
    let library = g7_draw::shapes(&document, &Options::default());
    let xml = Xml::parse(&library).expect("XML");
    assert!(xml.root_element().has_tag_name("mxlibrary"));
    let entries: serde_json::Value =
        serde_json::from_str(xml.root_element().text().expect("a list")).expect("JSON");
    let entries = entries.as_array().expect("a list");
    let symbols = document.charts().map(|c| c.steps().count() + c.transitions().count()).sum::<usize>();
    assert_eq!(entries.len(), symbols);
    let titles: BTreeSet<&str> = entries.iter().filter_map(|e| e["title"].as_str()).collect();
    assert!(titles.contains("macro-step") && titles.contains("divergence in AND"), "{titles:?}");
    for entry in entries {
        let model = Xml::parse(entry["xml"].as_str().expect("a model")).expect("XML");
        assert!(cells(model.root_element(), "the library").len() > 2);
        assert!(entry["w"].as_i64() > Some(0) && entry["h"].as_i64() > Some(0));
    }
}
