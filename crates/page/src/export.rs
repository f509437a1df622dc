//! Exports: a chart in the form of another tool, as code for a controller, or as a picture.

use std::collections::BTreeMap;

use g7_codegen::{Language, Parts, plc};
use g7_compile::symbols::Symbols;
use g7_draw::Options;
use g7_engine::StepId;
use g7_exchange::FORMATS;
use g7_ide::File;
use g7_ide::ids::{self, Thing};
use g7_model::{Problem, Said, Severity, Span, say};
use serde::Serialize;

use crate::problems::{Row, row};

/// A form in which a chart can be exported.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
pub(crate) struct Form {
    word: &'static str,
    title: &'static str,
    kind: Sort,
    /// It is read back as a chart.
    read: bool,
}

/// The kinds of forms.
#[derive(Clone, Copy, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "FormSort"))]
#[serde(rename_all = "snake_case")]
enum Sort {
    Chart,
    Code,
    Picture,
}

/// An exported chart.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
pub(crate) struct Out {
    files: Vec<OutFile>,
    /// Problems: parts of the chart that the export does not contain; places are those of the
    /// chart.
    problems: Vec<Row>,
    /// True if the export has another meaning than the chart.
    lossy: bool,
}

/// One exported file.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
pub(crate) struct OutFile {
    name: String,
    text: String,
    /// The lines that belong to each symbol.
    marks: Vec<Mark>,
}

/// The lines of a text, from 0, that belong to a symbol.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
struct Mark {
    id: String,
    lines: Vec<usize>,
}

/// The kind of code that is generated.
#[derive(Clone, Copy)]
enum Code {
    Native(Language),
    /// A form of the equations.
    Plc(plc::Form),
}

impl Code {
    /// All kinds, in the order in which they are shown.
    fn all() -> impl Iterator<Item = Code> {
        let native = [Language::C, Language::Arduino, Language::Rust].map(Code::Native);
        native.into_iter().chain(plc::Form::ALL.map(Code::Plc))
    }

    fn word(self) -> &'static str {
        match self {
            Code::Native(Language::C) => "c",
            Code::Native(Language::Arduino) => "arduino",
            Code::Native(Language::Rust) => "rust",
            Code::Plc(form) => form.word(),
        }
    }

    fn title(self) -> &'static str {
        match self {
            Code::Native(Language::C) => "C99",
            Code::Native(Language::Arduino) => "Arduino sketch",
            Code::Native(Language::Rust) => "Rust module",
            Code::Plc(form) => form.title(),
        }
    }
}

/// All forms, in the order in which they are shown.
pub(crate) fn forms() -> Vec<Form> {
    let chart =
        |f: &g7_exchange::Format| Form { word: f.word, title: f.title, kind: Sort::Chart, read: f.is_read() };
    let code = |code: Code| Form { word: code.word(), title: code.title(), kind: Sort::Code, read: false };
    let picture = Form { word: "svg", title: "SVG", kind: Sort::Picture, read: false };
    FORMATS
        .iter()
        .filter(|f| f.is_written())
        .map(chart)
        .chain(Code::all().map(code))
        .chain([picture])
        .collect()
}

/// Exports a file in another form.
pub(crate) fn export(name: &str, file: &File, to: &str) -> Result<Out, Said> {
    if let Some(first) = file.problems.iter().find(|p| p.severity() == Severity::Error) {
        return Err(say!("the chart has errors: {}", first.what));
    }
    let stem = stem(name);
    if to == "svg" {
        return Ok(out(file, vec![(format!("{stem}.svg"), picture(file))], &[]));
    }
    if let Some(found) = Code::all().find(|code| code.word() == to) {
        return code(file, stem, found);
    }
    let unknown = || say!("there is no form `{to}`");
    let format = g7_exchange::named(to).ok_or_else(unknown)?;
    let written = format.write(file.source.whole()).ok_or_else(unknown)?;
    let name = format!("{stem}.{}", format.ending());
    Ok(out(file, vec![(name, written.text)], &written.problems))
}

/// The base name of exported files: that of the chart, `tank` for `tank/chart.g7`.
fn stem(name: &str) -> &str {
    let mut parts = name.rsplit('/');
    let own = parts.next().unwrap_or(name);
    match own.strip_suffix(".g7").unwrap_or(own) {
        "chart" => parts.next().unwrap_or("chart"),
        stem => stem,
    }
}

fn out(file: &File, files: Vec<(String, String)>, problems: &[Problem]) -> Out {
    Out {
        files: files.into_iter().map(|(name, text)| OutFile { name, text, marks: Vec::new() }).collect(),
        lossy: problems.iter().any(|p| p.severity() == Severity::Error),
        problems: problems.iter().map(|p| row(file, p)).collect(),
    }
}

/// Generates code for a controller and marks the lines of each step.
fn code(file: &File, name: &str, code: Code) -> Result<Out, Said> {
    let (compiled, _) = g7_compile::compile(file.source.whole());
    let compiled = compiled.ok_or_else(|| say!("the chart has errors"))?;
    let symbols = &compiled.symbols;
    let printed = match code {
        Code::Native(language) => {
            let style = g7_codegen::Style::Structured;
            let options = g7_codegen::Options {
                language,
                style,
                room: g7_codegen::Room::usual(language, style),
                name,
                source: file.text(),
            };
            // The files of the command line: what all charts have in common stands apart.
            g7_codegen::print_as(&compiled, &options, Parts::Apart).map(|p| {
                let steps = words(file, symbols, |step| p.places.step(step).to_owned());
                (p.files.into_iter().map(|f| (f.name, f.text)).collect(), p.problems, steps)
            })
        }
        Code::Plc(form) => plc::print(&compiled, form, name, file.text()).map(|p| {
            let steps = words(file, symbols, |step| p.step(step).to_owned());
            let all = p.beside.into_iter().chain([(form.ending(), p.text)]);
            (all.map(|(ending, text)| (format!("{name}.{ending}"), text)).collect(), p.problems, steps)
        }),
    };
    let (files, problems, steps) = match printed {
        Ok(printed) => printed,
        Err(problems) => return Ok(out(file, Vec::new(), &problems)),
    };
    let mut out = out(file, files, &problems);
    for file in out.files.iter_mut().filter(|f| !f.name.ends_with(".svg")) {
        file.marks = marks(&file.text, &steps);
    }
    Ok(out)
}

/// The ids of steps by the word that stands for each step in the code.
fn words(file: &File, symbols: &Symbols, word: impl Fn(StepId) -> String) -> BTreeMap<String, String> {
    let ids: BTreeMap<Span, String> = ids::things(file.source.whole())
        .filter_map(|(_, thing)| match thing {
            Thing::Step(_, step) => Some((step.name.at.0, thing.id())),
            Thing::Action(..) | Thing::Transition(..) => None,
        })
        .collect();
    let steps = (0..symbols.steps()).map(StepId).filter(|s| symbols.is_listed(*s));
    steps.filter_map(|s| Some((word(s), ids.get(&symbols.step_place(s))?.clone()))).collect()
}

/// Marks the lines that contain the words; public names may carry a prefix.
fn marks(text: &str, words: &BTreeMap<String, String>) -> Vec<Mark> {
    let mut lines: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for (number, line) in text.lines().enumerate() {
        for word in line.split(|c: char| !c.is_alphanumeric() && c != '_') {
            let ends = word.char_indices().map(|(i, _)| i).filter(|i| *i == 0 || word[..*i].ends_with('_'));
            let Some((_, id)) = ends.filter_map(|i| words.get_key_value(&word[i..])).next() else { continue };
            let known = lines.entry(id).or_default();
            if known.last() != Some(&number) {
                known.push(number);
            }
        }
    }
    lines.into_iter().map(|(id, lines)| Mark { id: id.to_owned(), lines }).collect()
}

/// Draws all charts on one sheet.
fn picture(file: &File) -> String {
    let options = Options { font: true, ..Options::default() };
    let document = &file.source.document;
    let drawings = g7_draw::draw_all(document, document.charts(), &options);
    match drawings.as_slice() {
        [one] => g7_draw::svg(one, &options),
        several => g7_draw::sheet(document, several, &options),
    }
}
