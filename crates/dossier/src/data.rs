//! The data of a dossier: its input and its sheets.

use std::ffi::OsStr;
use std::path::Path;

use g7_draw::{Chronogram, Page, Paper, Rect, TitleBlock};
use g7_model::{Language, Problem, Said};
use g7_rig::Source;

use crate::recorded::on_paper;
use crate::words;

/// The texts of cover and title blocks.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Head {
    /// The title; empty for the name of the file.
    pub title: String,
    /// Who made it.
    pub author: String,
    /// Whose it is.
    pub company: String,
    /// The revision.
    pub revision: String,
    /// The date, as it is to be printed.
    pub date: String,
}

/// The parts of a dossier.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Part {
    /// The charts, expansions and tasks, with their steps and transitions.
    Charts,
    /// Inputs and outputs.
    Signals,
    /// Other variables and constants.
    Variables,
    /// Where each name is read and written.
    References,
    /// Named actions, functions, and processing before and after the charts.
    Bodies,
    /// The plants.
    Plants,
    /// The tests.
    Tests,
    /// The questions about all runs.
    Proofs,
    /// The problems of the text.
    Problems,
}

impl Part {
    /// All parts, in their order in the dossier.
    pub const ALL: [Part; 9] = [
        Part::Charts,
        Part::Signals,
        Part::Variables,
        Part::References,
        Part::Bodies,
        Part::Plants,
        Part::Tests,
        Part::Proofs,
        Part::Problems,
    ];
}

/// The result of a test.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Test {
    /// Its title.
    pub title: String,
    /// `path:line:column`.
    pub place: String,
    /// Its failure; none if it passed.
    pub failure: Option<Failure>,
    /// The time in the run, and the scans.
    pub simulated: String,
    /// The number of scans.
    pub scans: u64,
    /// Observations that did not make it fail.
    pub notes: Vec<Said>,
    /// The signals in its run.
    pub chronogram: Option<Chronogram>,
}

/// Why a test failed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Failure {
    /// The sentence.
    pub message: Said,
    /// The place of the statement.
    pub place: String,
    /// The names in the condition, with their values.
    pub got: Vec<(String, String)>,
    /// The active steps.
    pub situation: String,
}

/// The answer to a question.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// It holds in all runs.
    Proved,
    /// A run breaks it.
    Refuted,
    /// The search ended before.
    Open,
}

/// A question with its answer.
#[derive(Clone, Debug)]
pub struct Answer {
    /// The claim in words.
    pub claim: Said,
    /// `path:line:column`.
    pub place: String,
    /// True if the author wrote it.
    pub own: bool,
    /// The answer.
    pub verdict: Verdict,
    /// The evidence.
    pub reason: Said,
    /// The way out; may be empty.
    pub help: Said,
}

/// The knowledge of a part that has to be run: its results, or why there are none.
#[derive(Clone, Debug)]
pub enum Known<T> {
    /// The results.
    Here(Vec<T>),
    /// Why they are not here, as the dossier says it.
    Missing(Missing),
}

/// Why results are missing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Missing {
    /// Nobody asked for them.
    NotRun,
    /// The problems of the text stand in the way.
    Errors,
    /// Another reason.
    Because(Said),
}

/// The picture of a plant.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct View {
    /// Its file, as the text names it.
    pub file: String,
    /// Its SVG; the reason if it cannot be read.
    pub svg: Result<Vec<u8>, Said>,
}

/// All that a dossier is made of.
pub struct Input<'a> {
    /// The file with those that it uses.
    pub source: &'a Source,
    /// The texts of the cover.
    pub head: Head,
    /// The sheets.
    pub paper: Paper,
    /// The language of its words.
    pub language: Language,
    /// The style of the drawings.
    pub look: g7_draw::Look,
    /// The parts that are wanted.
    pub parts: Vec<Part>,
    /// The problems of the text.
    pub problems: Vec<Problem>,
    /// The tests.
    pub tests: Known<Test>,
    /// The answers.
    pub answers: Known<Answer>,
    /// The pictures of plants.
    pub views: Vec<View>,
}

/// An entry of the outline.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Entry {
    /// 0 for a part, 1 for what is in it.
    pub level: usize,
    /// Its title.
    pub title: String,
    /// The number of its sheet, from 1.
    pub page: usize,
}

/// A picture on a sheet that is no drawing of ours.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Placed {
    /// The number of the sheet, from 1.
    pub page: usize,
    /// Where it stands, in hundredths of u; the picture keeps its proportions in it.
    pub at: Rect,
    /// The SVG file.
    pub svg: Vec<u8>,
}

/// A finished dossier.
#[derive(Clone, Debug)]
pub struct Dossier {
    /// Its sheets.
    pub pages: Vec<Page>,
    /// The paper of all sheets.
    pub paper: Paper,
    /// Parts and sections with their sheets.
    pub outline: Vec<Entry>,
    /// Pictures of plants, which stand over the sheets.
    pub pictures: Vec<Placed>,
    /// The title.
    pub title: String,
}

impl Dossier {
    /// Each sheet as an SVG file with its pictures.
    pub fn svgs(&self, options: &g7_draw::Options) -> Vec<String> {
        let one = |(number, page): (usize, &Page)| {
            let mut page = page.clone();
            let mine = self.pictures.iter().filter(|p| p.page == number);
            mine.for_each(|p| page.image(&p.svg, p.at));
            page.svg(options)
        };
        (1..).zip(&self.pages).map(one).collect()
    }
}

impl From<g7_rig::testing::Outcome> for Test {
    fn from(outcome: g7_rig::testing::Outcome) -> Test {
        let failure = outcome.defect.as_ref().map(|d| Failure {
            message: d.sentence(),
            place: d.place.clone(),
            got: d.got.clone(),
            situation: d.situation.clone(),
        });
        Test {
            title: outcome.title,
            place: outcome.place,
            failure,
            simulated: outcome.simulated.to_string(),
            scans: outcome.scans,
            notes: outcome.notes,
            chronogram: outcome.recording.as_ref().map(on_paper),
        }
    }
}

impl Input<'_> {
    /// The title of cover and title blocks.
    pub(crate) fn title(&self) -> &str {
        self.head.title_of(&self.source.name)
    }

    /// A place as it is printed: the file stands in the title block already.
    pub(crate) fn place<'p>(&self, place: &'p str) -> &'p str {
        place.strip_prefix(&*self.source.name).and_then(|rest| rest.strip_prefix(':')).unwrap_or(place)
    }

    /// The title block of a sheet.
    pub(crate) fn block(&self, part: &str, page: usize, of: usize) -> TitleBlock {
        title_block(&self.head, &self.source.name, part, (page, of), self.language)
    }
}

impl Head {
    /// The title; without one the name of the file without its ending, and that of its folder for a `chart.g7`.
    pub(crate) fn title_of<'a>(&'a self, file: &'a str) -> &'a str {
        if !self.title.is_empty() {
            return &self.title;
        }
        let path = Path::new(file);
        let stem = path.file_stem().and_then(OsStr::to_str).unwrap_or(file);
        let folder = path.parent().and_then(Path::file_name).and_then(OsStr::to_str);
        folder.filter(|_| stem == "chart").unwrap_or(stem)
    }
}

/// The title block of a sheet. `page` is its number, `of` the number of all sheets.
pub fn title_block(
    head: &Head,
    file: &str,
    part: &str,
    (page, of): (usize, usize),
    language: Language,
) -> TitleBlock {
    let field = |label, value: &str| g7_draw::Field {
        label: language.told(label).to_owned(),
        value: if value.is_empty() { "–".to_owned() } else { value.to_owned() },
    };
    TitleBlock {
        company: field(words::COMPANY, &head.company),
        title: field(words::TITLE, head.title_of(file)),
        sheet: field(words::SHEET, &format!("{page} / {of}")),
        author: field(words::AUTHOR, &head.author),
        part: field(words::PART, part),
        revision: field(words::REVISION, &head.revision),
        file: field(words::FILE, file),
        program: field(words::PROGRAM, concat!("G7 ", env!("CARGO_PKG_VERSION"))),
        date: field(words::DATE, &head.date),
    }
}
