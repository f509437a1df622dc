//! Sheets of paper for the print preview: charts, or the whole dossier.
//!
//! Tests run here, as the panel *Tests* runs them. Questions about all runs are not asked again: the page hands over the
//! answers that it has.

use g7_dossier::{Answer, Dossier, Head, Input, Known, Missing, Part, Test, Verdict, View, dossier};
use g7_draw::{Look, Paper};
use g7_ide::File;
use g7_model::{Chart, Said, Severity, say};
use g7_rig::testing::{Coverage, Options};
use serde::{Deserialize, Serialize};

use crate::answer::Shelved;
use crate::prove::Found;
use crate::testing::run;

/// Sheets as SVG, all of one size.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
pub(crate) struct Printed {
    /// The width of a sheet in mm.
    width: i32,
    /// The height of a sheet in mm.
    height: i32,
    pages: Vec<String>,
}

/// The page's request for sheets.
#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "SheetsWish", optional_fields = nullable))]
pub(crate) struct Wish {
    /// `a4`, `a4-landscape`, `a3` or `a3-landscape`.
    paper: String,
    /// The names of the charts.
    charts: Vec<String>,
    /// All that is known of the file, whatever `charts` names.
    dossier: bool,
    head: Heading,
    /// The answers to the questions that the page has asked; none if it has asked nothing.
    answers: Option<Vec<Row>>,
    /// The pictures of the plants.
    pictures: Vec<Shelved>,
}

/// The texts of the title block.
#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "SheetsHead"))]
struct Heading {
    title: String,
    author: String,
    company: String,
    revision: String,
    date: String,
}

/// An answer that the page has, in its language.
#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "SheetsAnswer"))]
struct Row {
    claim: String,
    verdict: Found,
    reason: String,
    help: String,
    line: usize,
    /// The author asks it.
    own: bool,
}

/// Makes the sheets.
pub(crate) fn print(file: &File, wish: Wish) -> Result<Printed, Said> {
    let paper =
        Paper::named(&wish.paper).ok_or_else(|| say!("there is no paper {}", Said::foreign(&*wish.paper)))?;
    let made = if wish.dossier { all(file, paper, wish)? } else { charts(file, paper, wish)? };
    let [width, height] = paper.mm();
    // The page has the font.
    let pages = made.svgs(&g7_draw::Options { font: false, ..g7_draw::Options::default() });
    Ok(Printed { width, height, pages })
}

fn head(heading: Heading) -> Head {
    let Heading { title, author, company, revision, date } = heading;
    Head { title, author, company, revision, date }
}

/// The named charts on sheets.
fn charts(file: &File, paper: Paper, wish: Wish) -> Result<Dossier, Said> {
    let named = |c: &&Chart| wish.charts.iter().any(|n| **n == *c.name.text);
    let charts: Vec<&Chart> = file.source.whole().charts().filter(named).collect();
    if charts.is_empty() {
        return Err(say!("there is no chart to print"));
    }
    let head = head(wish.head);
    Ok(g7_dossier::print(&file.source, &charts, &g7_draw::Options::default(), paper, &head, file.language))
}

/// The dossier.
fn all(file: &File, paper: Paper, wish: Wish) -> Result<Dossier, Said> {
    let wrong = file.problems.iter().any(|p| p.severity() == Severity::Error);
    let view = |p: Shelved| View {
        svg: p.text.map(String::into_bytes).ok_or_else(|| say!("there is no such file")),
        file: p.file,
    };
    let views = wish.pictures.into_iter().map(view);
    let input = Input {
        source: &file.source,
        head: head(wish.head),
        paper,
        language: file.language,
        look: Look::default(),
        parts: Part::ALL.to_vec(),
        problems: file.problems.to_vec(),
        tests: if wrong { Known::Missing(Missing::Errors) } else { tests(file)? },
        answers: match wish.answers {
            _ if wrong => Known::Missing(Missing::Errors),
            Some(rows) => Known::Here(rows.into_iter().map(|row| answer(file, row)).collect()),
            None => Known::Missing(Missing::NotRun),
        },
        views: views.collect(),
    };
    Ok(dossier(&input))
}

fn tests(file: &File) -> Result<Known<Test>, Said> {
    let options = Options { record: true, ..Options::default() };
    let (outcomes, _) = run(file, options, &mut Coverage::default())?;
    Ok(Known::Here(outcomes.into_iter().map(Test::from).collect()))
}

fn answer(file: &File, row: Row) -> Answer {
    Answer {
        claim: Said::foreign(row.claim),
        verdict: match row.verdict {
            Found::Proved => Verdict::Proved,
            Found::Refuted => Verdict::Refuted,
            Found::Open => Verdict::Open,
        },
        reason: Said::foreign(row.reason),
        help: Said::foreign(row.help),
        place: format!("{}:{}", file.source.name, row.line),
        own: row.own,
    }
}
