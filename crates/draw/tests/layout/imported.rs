//! Drawings that other tools made: symbols stand where those put them, and the links meet the rules there too.

use g7_draw::{Options, layout, measure};
use g7_model::Item;

use crate::charts::corpus;
use crate::geometry::{link_faults, runs_through, shared};

/// Drawings without room for their links: two joins of the same two steps stand side by side, a fifth of a step under
/// them, so that there is no place for two double lines.
const NO_ROOM: [&str; 2] = ["example_sequential.clp", "example_sequential.clprj"];

#[test]
fn links_of_imported_drawings_share_no_line_and_run_under_no_symbol() {
    let (mut drawings, mut bad) = (0, Vec::new());
    let all = corpus("");
    for (file, document) in &all {
        let sections =
            document.items.iter().filter_map(|i| if let Item::Layout(l) = i { Some(l) } else { None });
        for section in sections {
            for chart in document.charts().filter(|c| c.name.text == section.chart.text) {
                let sizes = measure(document, chart, &Options::default());
                let p = layout(chart, &sizes, &section.places);
                let mut found = link_faults(chart, &p);
                if !NO_ROOM.iter().any(|name| file.ends_with(name)) {
                    found.extend(shared(&p));
                    found.extend(runs_through(&sizes, &p));
                }
                drawings += 1;
                if !found.is_empty() {
                    bad.push(format!("{file}, {}: {found:#?}", chart.name.text));
                }
            }
        }
    }
    assert!(bad.is_empty(), "{} of {drawings} drawings: {}", bad.len(), bad.join("\n"));
    assert!(all.is_empty() || drawings > 20, "only {drawings} drawings");
}
