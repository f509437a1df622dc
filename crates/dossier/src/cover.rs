//! The cover, and the contents behind it.

use g7_draw::width;
use g7_model::Severity;

use crate::charts::charts;
use crate::data::{Input, Known, Missing, Part, Verdict};
use crate::flow::{Flow, LEADING, TEXT, wrap};
use crate::table::Table;
use crate::variables::declared;
use crate::words;

/// Size of the title.
const TITLE: i32 = 420;

/// The words for each part.
pub(crate) fn name(part: Part) -> g7_model::words::Told {
    match part {
        Part::Charts => words::CHARTS,
        Part::Signals => words::SIGNALS,
        Part::Variables => words::VARIABLES,
        Part::References => words::REFERENCES,
        Part::Bodies => words::BODIES,
        Part::Plants => words::PLANTS,
        Part::Tests => words::TESTS,
        Part::Proofs => words::PROOFS,
        Part::Problems => words::PROBLEMS,
    }
}

/// Writes the cover, and keeps sheets free for the contents.
pub(crate) fn begin(input: &Input<'_>, contents: usize) -> Flow {
    let told = |word| input.language.told(word);
    let mut flow = Flow::new(input, contents);
    flow.next(told(words::COVER));
    flow.skip(flow.inside.h / 8);
    flow.sized(input.title(), TITLE, "g7-title");
    flow.skip(TITLE / 2);
    let head = &input.head;
    let mut rows = Table::new(&[("", 30), ("", 90)]);
    let profile = input.source.whole().profile().map(|p| p.name).unwrap_or_default();
    let profile = format!("{} – {}", profile.name(), input.language.told(profile.does()));
    for (label, value) in [
        (words::COMPANY, &head.company),
        (words::AUTHOR, &head.author),
        (words::REVISION, &head.revision),
        (words::DATE, &head.date),
        (words::FILE, &input.source.name),
        (words::PROFILE, &profile),
    ] {
        if !value.is_empty() {
            rows.row(vec![told(label).to_owned(), value.clone()]);
        }
    }
    for other in input.source.others() {
        rows.row(vec![told(words::FILE).to_owned(), other.path.clone()]);
    }
    rows.write(&mut flow);
    summary(&mut flow, input);
    let left: Vec<&str> =
        Part::ALL.iter().filter(|p| !input.parts.contains(p)).map(|p| told(name(*p))).collect();
    if !left.is_empty() {
        flow.skip(TEXT);
        flow.text(&format!("{}: {}", told(words::LEFT_OUT), left.join(", ")));
    }
    // A long list of files goes on behind the cover.
    (0..contents).for_each(|_| flow.next(told(words::CONTENTS)));
    flow
}

/// Numbers of what the dossier is about.
fn summary(flow: &mut Flow, input: &Input<'_>) {
    let told = |word| input.language.told(word);
    let mut table = Table::new(&[(told(words::IN_SHORT), 60), ("", 60)]);
    let steps: usize = charts(input.source).map(|c| c.steps().count()).sum();
    let transitions: usize = charts(input.source).map(|c| c.transitions().count()).sum();
    let count = |kind| declared(input).filter(|d| d.of.kind == kind).count();
    for (label, n) in [
        (words::CHARTS, charts(input.source).count()),
        (words::STEPS, steps),
        (words::TRANSITIONS, transitions),
        (words::INPUTS, count(g7_model::VarKind::Input)),
        (words::OUTPUTS, count(g7_model::VarKind::Output)),
    ] {
        table.row(vec![told(label).to_owned(), n.to_string()]);
    }
    let mut results = |part: Part, label, value: Result<String, &Missing>| {
        if input.parts.contains(&part) {
            let value = value.unwrap_or_else(|why| missing(input, part, why));
            table.row(vec![format!("{}, {}", told(name(part)), told(label)), value]);
        }
    };
    let tests = match &input.tests {
        Known::Here(all) => {
            let failed = all.iter().filter(|t| t.failure.is_some()).count();
            Ok(format!("{} / {failed}", all.len() - failed))
        }
        Known::Missing(why) => Err(why),
    };
    results(Part::Tests, words::PASSED_FAILED, tests);
    let answers = match &input.answers {
        Known::Here(all) => {
            let of = |v| all.iter().filter(|a| a.verdict == v).count();
            Ok(format!("{} / {} / {}", of(Verdict::Proved), of(Verdict::Refuted), of(Verdict::Open)))
        }
        Known::Missing(why) => Err(why),
    };
    results(Part::Proofs, words::VERDICTS, answers);
    let errors = input.problems.iter().filter(|p| p.severity() == Severity::Error).count();
    let problems = format!("{errors} / {}", input.problems.len() - errors);
    results(Part::Problems, words::ERRORS_WARNINGS, Ok(problems));
    table.write(flow);
}

/// Why results are missing, in words.
pub(crate) fn missing(input: &Input<'_>, part: Part, why: &Missing) -> String {
    match why {
        Missing::NotRun if part == Part::Tests => input.language.told(words::NOT_RUN).to_owned(),
        Missing::NotRun => input.language.told(words::NOT_ASKED).to_owned(),
        Missing::Errors => input.language.told(words::IN_THE_WAY).to_owned(),
        Missing::Because(why) => why.in_language(input.language),
    }
}

/// Distance from the left edge to an entry of a level.
const INDENT: i32 = 300;
/// Height of a line.
const LINE: i32 = TEXT * LEADING / 100;
/// Height of the heading.
const HEADING: i32 = 600;

/// The number of sheets that the contents take.
pub(crate) fn sheets_of_contents(flow: &Flow) -> usize {
    let lines = |e: &crate::data::Entry| {
        let room = flow.inside.w - INDENT * e.level as i32 - width(&e.page.to_string(), TEXT) - 400;
        wrap(&e.title, TEXT, room).len()
    };
    let all: usize = flow.outline.iter().map(lines).sum();
    let of = |height: i32| (height / LINE).max(1) as usize;
    let first = of(flow.inside.h - HEADING);
    1 + all.saturating_sub(first).div_ceil(of(flow.inside.h))
}

/// Writes the contents onto the sheets that were kept free.
pub(crate) fn contents(flow: &mut Flow, input: &Input<'_>) {
    let entries = std::mem::take(&mut flow.outline);
    let at = entries.first().map_or(flow.page(), |e| e.page) - flow.contents;
    flow.turn_to(at);
    flow.heading(0, input.language.told(words::CONTENTS));
    flow.outline = entries;
    for e in flow.outline.clone() {
        flow.between(&e.title, &e.page.to_string(), INDENT * e.level as i32);
    }
}
