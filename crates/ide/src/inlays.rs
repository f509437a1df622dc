//! The values of a running chart beside the names that have them.
//!
//! A value stands behind each variable where it is declared and in receptivities, and the time of an active step
//! behind its declaration. Names decide, not places: the text may have changed since the run began.

use std::collections::BTreeMap;
use std::ops::Range;

use g7_compile::Definition;
use g7_compile::references::Written;
use g7_model::Chart;

use crate::file::File;

/// The state of a run at one moment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Present {
    /// The values by name, as the language writes the name outside of all charts: `go`, `G.k`.
    pub values: BTreeMap<String, String>,
    /// The active steps by chart and name, with the milliseconds since their activation.
    pub active: BTreeMap<(String, String), f64>,
}

/// A few letters behind a place of the text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Inlay {
    /// The byte before which they stand.
    pub at: usize,
    /// The letters.
    pub label: String,
}

/// The values in a part of the text, in its order.
pub fn inlays(file: &File, within: &Range<usize>, present: &Present) -> Vec<Inlay> {
    let document = &file.source.document;
    let receptivities: Vec<Range<usize>> =
        document.charts().flat_map(Chart::transitions).map(|t| t.receptivity.at.0.bytes()).collect();
    let known = g7_compile::references(document);
    let near =
        known.all().iter().filter(|u| within.start <= u.at.bytes().end && u.at.bytes().end <= within.end);
    let mut found: Vec<Inlay> = near
        .filter_map(|used| {
            let at = used.at.bytes().end;
            let declared = used.written == Written::Declared;
            let label = match &used.definition {
                Definition::Variable { chart, name } => {
                    let read = receptivities.iter().any(|r| r.start < at && at <= r.end);
                    let name = chart.as_ref().map_or_else(|| name.clone(), |chart| format!("{chart}.{name}"));
                    let value = present.values.get(&name).filter(|_| declared || read)?;
                    format!("= {value}")
                }
                Definition::Step { chart, name } if declared => {
                    let ms = present.active.get(&(chart.clone(), name.clone()))?;
                    format!("active {:.1}s", ms / 1000.0)
                }
                _ => return None,
            };
            Some(Inlay { at, label })
        })
        .collect();
    found.dedup();
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_stand_behind_declarations_and_in_receptivities() {
        let text = "input go : BOOL\nchart G {\n  var k : INT\n  initial step 0\n  step 1 { P1 k := k + 1 }\n  \
            0 -> 1 when go and k < 5\n  1 -> 0 when not go\n}\nchart H {\n  initial step 0\n}\n";
        let file = File::open_native("x.g7", text.to_owned()).expect("a file");
        let values = [("go", "TRUE"), ("G.k", "3")].map(|(name, value)| (name.to_owned(), value.to_owned()));
        let active = [(("H".to_owned(), "0".to_owned()), 1234.0)];
        let present = Present { values: values.into(), active: active.into() };
        let shown = |within: Range<usize>| {
            let mut text = text.to_owned();
            for Inlay { at, label } in inlays(&file, &within, &present).into_iter().rev() {
                text.insert_str(at, &format!("‹{label}›"));
            }
            text
        };
        let all = shown(0..text.len());
        let wanted = "input go‹= TRUE› : BOOL\nchart G {\n  var k‹= 3› : INT\n  initial step 0\n  \
            step 1 { P1 k := k + 1 }\n  0 -> 1 when go‹= TRUE› and k‹= 3› < 5\n  1 -> 0 when not go‹= TRUE›\n}\n\
            chart H {\n  initial step 0‹active 1.2s›\n}\n";
        assert_eq!(all, wanted);
        assert_eq!(shown(0..20).matches('‹').count(), 1);
        assert!(inlays(&file, &(0..text.len()), &Present::default()).is_empty());
    }
}
