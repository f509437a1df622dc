//! The small files that a project consists of, line by line.

use std::ops::Range;

use g7_model::{codes, say};

use g7_iec::report::Report;

/// The first line of a project.
const MARK: &str = "_FILES_CLASSICLADDER";
/// The most lines of a project; each costs memory beyond its text.
const MOST_LINES: usize = 200_000;

/// A line without its end.
#[derive(Clone, Debug)]
pub(super) struct Line<'a> {
    pub(super) text: &'a str,
    pub(super) at: Range<usize>,
}

/// One of the small files.
#[derive(Clone, Debug)]
pub(super) struct Part<'a> {
    /// Its name, for example `sequential.csv`.
    pub(super) name: &'a str,
    /// The place where it begins.
    pub(super) at: Range<usize>,
    /// Its lines, including empty ones and remarks, because rungs and old lists count lines.
    pub(super) lines: Vec<Line<'a>>,
}

/// True if the file is a project or one of its charts alone.
pub(crate) fn fits(_: &str, _: Option<&str>, bytes: &[u8]) -> bool {
    let head = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    let head = head.get(..head.len().min(4096)).unwrap_or(head);
    head.starts_with(MARK.as_bytes()) || sequential(&String::from_utf8_lossy(head))
}

/// True if a text is a `sequential.csv`: remarks, then a page, step or transition with a number.
fn sequential(text: &str) -> bool {
    let mut lines = text.lines().filter(|l| !l.starts_with(';') && !l.starts_with("#VER=")).take(1);
    let first = lines.next().unwrap_or("");
    let number = first.strip_prefix('S').and_then(|rest| rest.split_once(','));
    number.is_some_and(|(n, rest)| {
        let digits = |s: &str| !s.is_empty() && s.bytes().all(|b| b.is_ascii_digit() || b"-, ".contains(&b));
        digits(n) && digits(rest.trim_end())
    })
}

/// Splits a project into its files.
pub(super) fn parts<'a>(text: &'a str, report: &mut Report) -> Option<Vec<Part<'a>>> {
    let lines = lines(text, report)?;
    let first = lines.first().map_or("", |l| l.text);
    if !first.trim_start_matches('\u{feff}').starts_with(MARK) {
        if sequential(text) {
            return Some(vec![Part { name: "sequential.csv", at: 0..0, lines }]);
        }
        report.say(&codes::NOT_JGRAFCHART, &(0..0), say!("this is no project of ClassicLadder"));
        return None;
    }
    let mut parts: Vec<Part> = Vec::new();
    let mut open = false;
    let mut ended = false;
    for line in lines.into_iter().skip(1) {
        if let Some(name) = line.text.strip_prefix("_FILE-") {
            if open {
                report.say(&codes::BAD_TEXT, &line.at, say!("a file inside a file of the project"));
            }
            parts.push(Part { name: name.trim(), at: line.at.clone(), lines: Vec::new() });
            open = true;
        } else if line.text.starts_with("_/FILE-") {
            open = false;
        } else if line.text.starts_with("_/FILES_CLASSICLADDER") {
            ended = true;
            break;
        } else if open && let Some(part) = parts.last_mut() {
            part.lines.push(line);
        } else if !line.is_remark() {
            report.element(
                &codes::UNKNOWN_ELEMENT,
                "line",
                &line.at,
                say!("a line outside the files of the project"),
            );
        }
    }
    if open || !ended {
        report.say(&codes::BAD_TEXT, &(text.len()..text.len()), say!("the project ends in the middle"));
    }
    Some(parts)
}

fn lines<'a>(text: &'a str, report: &mut Report) -> Option<Vec<Line<'a>>> {
    let mut lines = Vec::new();
    let mut start = 0;
    for piece in text.split_inclusive('\n') {
        if lines.len() == MOST_LINES {
            let what = say!("the file has more than {MOST_LINES} lines");
            report.say(&codes::TOO_LARGE, &(0..0), what);
            return None;
        }
        let line = piece.trim_end_matches(['\n', '\r']);
        lines.push(Line { text: line, at: start..start + line.len() });
        start += piece.len();
    }
    Some(lines)
}

impl<'a> Line<'a> {
    /// The numbers of a line, separated by commas; None if one of them is not a number.
    pub(super) fn numbers(&self, from: usize) -> Option<Vec<i64>> {
        self.text.get(from..)?.split(',').map(|n| n.trim().parse().ok()).collect()
    }

    /// The text behind `#NAME=`.
    pub(super) fn value(&self, name: &str) -> Option<&'a str> {
        self.text.strip_prefix('#')?.strip_prefix(name)?.strip_prefix('=')
    }

    /// True if the line is empty or a remark.
    pub(super) fn is_remark(&self) -> bool {
        self.text.trim().is_empty() || self.text.starts_with(';')
    }
}
