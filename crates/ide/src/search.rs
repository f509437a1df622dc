//! Searches a text in a file; each result names the symbol that contains it.

use std::ops::Range;

use g7_model::{FileId, Span};

use crate::file::File;
use crate::ids;

/// A result.
#[derive(Debug)]
pub struct Hit {
    /// The bytes of the result.
    pub range: Range<usize>,
    /// The number of its line, from 1.
    pub line: usize,
    /// The line that contains it.
    pub text: String,
    /// The id of the symbol that contains it.
    pub id: Option<String>,
    /// The chart that contains it.
    pub chart: Option<String>,
}

/// Greatest number of results.
const MOST: usize = 200;

/// Finds a text in a file, regardless of case.
pub fn search(file: &File, what: &str) -> Vec<Hit> {
    let wanted = what.trim().to_lowercase();
    if wanted.is_empty() {
        return Vec::new();
    }
    let mut hits = Vec::new();
    let mut start = 0;
    for (number, line) in file.text().split('\n').enumerate() {
        for at in found(line, &wanted) {
            let (first, last) = (start + at.start, start + at.end);
            let span = Span { file: FileId(0), start: first as u32, end: last as u32 };
            let document = &file.source.document;
            hits.push(Hit {
                range: first..last,
                line: number + 1,
                text: line.trim().chars().take(200).collect(),
                id: ids::at(document, span).map(|t| t.id()),
                chart: document.charts().find(|c| c.at.0.holds(span)).map(|c| c.name.text.to_string()),
            });
            if hits.len() >= MOST {
                return hits;
            }
        }
        start += line.len() + 1;
    }
    hits
}

/// The places of a lower-case text in a line. Letters whose lower-case form has another length are
/// compared one by one.
fn found(line: &str, wanted: &str) -> Vec<std::ops::Range<usize>> {
    let letters: Vec<(usize, char)> = line.char_indices().collect();
    let mut all = Vec::new();
    let mut k = 0;
    while let Some((start, _)) = letters.get(k) {
        let mut rest = wanted;
        let mut end = *start;
        let mut next = k;
        while let Some((at, c)) = letters.get(next).filter(|_| !rest.is_empty()) {
            let small: String = c.to_lowercase().collect();
            let Some(left) = rest.strip_prefix(small.as_str()) else { break };
            (rest, end) = (left, at + c.len_utf8());
            next += 1;
        }
        if rest.is_empty() {
            all.push(*start..end);
            k = next;
        } else {
            k += 1;
        }
    }
    all
}
