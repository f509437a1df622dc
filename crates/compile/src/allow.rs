//! Warnings that the author has looked at: notes of the form `// allow G0111: the reason`.
//!
//! Such a note stands before an item of the file, or of a chart, and covers that item; at the end of a
//! line it covers the item of that line. `// allow in file G0111: the reason` covers the file. A note without a reason, with a code that does not exist
//! or is an error, and one that silences nothing are problems of their own. The notes are those of the
//! text, so the language and its printer need no form for them (`docs/decisions/050-allow.md`).

use g7_model::codes::{self, Code};
use g7_model::{Chart, ChartItem, Document, Item, Note, Problem, Said, Severity, Span, say};

/// A silence: its note, the code and the bytes that it covers.
struct Silence {
    at: Span,
    code: &'static Code,
    covers: Span,
}

/// Takes out the warnings that the notes of a document allow, and adds what is wrong with the notes.
pub(crate) fn apply(doc: &Document, problems: &mut Vec<Problem>) {
    let mut silences = Vec::new();
    let mut wrong = Vec::new();
    for note in &doc.notes {
        match read(doc, note) {
            Some(Ok(silence)) => silences.push(silence),
            Some(Err(problem)) => wrong.push(problem),
            None => {}
        }
    }
    if silences.is_empty() && wrong.is_empty() {
        return;
    }
    // Where the charts have errors, warnings are missing that a silence may be for.
    let whole = problems.iter().all(|p| p.severity() != Severity::Error);
    for silence in &silences {
        let before = problems.len();
        problems.retain(|p| {
            let inside = silence.covers.start <= p.at.start && p.at.start <= silence.covers.end;
            p.code != silence.code || !inside || p.at.file != silence.covers.file
        });
        if whole && problems.len() == before {
            let what = say!("nothing here reports `{}`", silence.code.id);
            wrong.push(Problem::new(&codes::NEEDLESS_ALLOW, silence.at, what).help(say!("delete this note")));
        }
    }
    problems.extend(wrong);
}

/// A note that allows a code; `None` for any other note.
fn read(doc: &Document, note: &Note) -> Option<Result<Silence, Problem>> {
    let at = note.at;
    let text = note.text.strip_prefix("//")?.trim_start();
    let rest = text.strip_prefix("allow ")?.trim_start();
    let (in_file, rest) = match rest.strip_prefix("in file ") {
        Some(rest) => (true, rest.trim_start()),
        None => (false, rest),
    };
    let (id, reason) = rest.split_once(':').unwrap_or((rest, ""));
    let id = id.trim();
    // Prose can begin with the word as well; a code cannot be meant by it.
    if !id.starts_with(['G', 'g'])
        || !id.get(1..2).is_some_and(|c| c.starts_with(|c: char| c.is_ascii_digit()))
    {
        return None;
    }
    let refused = |what: Said, help: Said| Some(Err(Problem::new(&codes::BAD_ALLOW, at, what).help(help)));
    let Some(code) = codes::find(id) else {
        return refused(
            say!("there is no code `{id}`"),
            say!("write the code of the warning, such as `G0230`"),
        );
    };
    if code.severity == Severity::Error {
        return refused(say!("`{id}` is an error and cannot be allowed"), say!("mend what it is about"));
    }
    if reason.trim().is_empty() {
        let help = say!("write `// allow {id}: ` and why it is meant so");
        return refused(say!("there is no reason why `{id}` is allowed here"), help);
    }
    let covers = match note.behind {
        _ if in_file => Some(Span { start: 0, end: u32::MAX, ..at }),
        Some(line) => Some(before(doc, at, line)),
        None => behind(doc, at),
    };
    let Some(covers) = covers else {
        return refused(
            say!("no item follows this note"),
            say!("write it before an item, or `allow in file`"),
        );
    };
    Some(Ok(Silence { at, code, covers }))
}

/// The items that a note can stand beside: those of its chart, or else those of the file.
fn places(doc: &Document, note: Span) -> (Option<Span>, Vec<Span>) {
    let inside = |c: &&Chart| c.at.0.start < note.start && note.end <= c.at.0.end;
    match doc.charts().find(inside) {
        Some(chart) => (Some(chart.at.0), chart.items.iter().map(ChartItem::at).collect()),
        None => (None, doc.items.iter().map(Item::at).collect()),
    }
}

/// The item that begins next behind a note: the first of a chart if the note stands in that chart.
fn behind(doc: &Document, note: Span) -> Option<Span> {
    let (_, places) = places(doc, note);
    places.into_iter().filter(|at| at.start >= note.end && at.file == note.file).min_by_key(|at| at.start)
}

/// The line of a note that stands at its end, and the item that begins last before the note: on the line of the
/// first brace of a chart that is the chart.
fn before(doc: &Document, note: Span, line: u32) -> Span {
    let (chart, places) = places(doc, note);
    let last = places.into_iter().filter(|at| at.start < note.start && at.file == note.file);
    let item = last.max_by_key(|at| at.start).or(chart).unwrap_or(note);
    Span { start: item.start.min(line), end: item.end.max(note.start), ..note }
}
