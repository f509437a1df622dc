//! `g7 draw`: charts as pictures, in SVG, PNG or PDF, and as files that draw.io edits.

mod heading;
mod paper;
mod pdf;

pub(crate) use heading::{Heading, PaperName};
pub(crate) use pdf::pdf;

use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use clap::ValueEnum;
use clap::builder::PossibleValue;
use g7_draw::{Look, Options, Page, Paper};
use g7_model::{Chart, FileId, say};

use crate::failure::{Failure, Verdict, raw};
use crate::files;
use crate::message::talk;
use crate::report::{self, Tally};
use crate::sources::{self, Source};
use crate::tongue::language;
use paper::Form;

const EXAMPLES: &str = "\
Examples:
  g7 draw tank -o tank.svg              every chart of the file on one sheet
  g7 draw tank -o tank.pdf --chart Tank  one chart
  g7 draw tank -o pictures/ --as png    a file for each chart
  g7 draw tank > tank.svg               to the standard output
  g7 draw tank -o sfc.svg --look sfc    qualifier boxes, as in IEC 61131-3
  g7 draw tank -o tank.pdf --pages a4   on sheets of paper with a title block
  g7 draw tank -o tank.drawio           a file that draw.io edits
  g7 draw --shapes -o grafcet.xml       the symbols as a library for draw.io

Exit codes:
  0  fine
  1  the chart cannot be read
  2  bad usage, or something outside the chart: no such file, a full disk";

/// The arguments of `g7 draw`.
#[derive(clap::Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Draw {
    /// A .g7 file, a file of another tool, or a folder with a chart.g7.
    #[arg(default_value = ".")]
    file: PathBuf,
    /// The file to write (.svg, .png, .pdf or .drawio), or a folder for one file per chart [default: the
    /// standard output].
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
    /// The format, if the name of the output does not tell it.
    #[arg(long = "as", value_enum, value_name = "FORM")]
    form: Option<Form>,
    /// Draw only this chart, expansion or task; can be given several times.
    #[arg(long = "chart", value_name = "NAME")]
    charts: Vec<String>,
    /// The drawing style.
    #[arg(long, value_enum, default_value_t = Manner::Iec60848)]
    look: Manner,
    /// Divide the drawing into sheets of paper, or into pages like the editor of a PLC.
    #[arg(long, value_enum, value_name = "PAGES")]
    pages: Option<Pages>,
    #[command(flatten)]
    heading: Heading,
    /// Draw light on dark.
    #[arg(long)]
    dark: bool,
    /// Write the symbols of IEC 60848 as a library for draw.io, instead of a chart.
    #[arg(long, conflicts_with_all = ["file", "charts", "form", "pages", "no_actions", "scale"])]
    shapes: bool,
    /// Replace an output that is there and that g7 did not write; never the chart itself.
    #[arg(long)]
    force: bool,
    /// Leave out the actions of the steps.
    #[arg(long)]
    no_actions: bool,
    /// Pixels of a PNG per pixel of the drawing.
    #[arg(long, default_value_t = 2.0, value_parser = scale, value_name = "NUMBER")]
    scale: f32,
}

/// The drawing style.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Manner {
    /// GRAFCET, IEC 60848.
    Iec60848,
    /// Sequential function chart, IEC 61131-3.
    Sfc,
}

/// The pages on which charts stand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Pages {
    /// The pages of PL7's editor.
    Pl7,
    /// Sheets of paper.
    Sheets(PaperName),
}

impl ValueEnum for Pages {
    fn value_variants<'a>() -> &'a [Pages] {
        static ALL: LazyLock<Vec<Pages>> = LazyLock::new(|| {
            let sheets = PaperName::value_variants().iter().map(|paper| Pages::Sheets(*paper));
            std::iter::once(Pages::Pl7).chain(sheets).collect()
        });
        &ALL
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        match self {
            Pages::Pl7 => Some(PossibleValue::new("pl7").help("PL7: 14 lines and 11 columns")),
            Pages::Sheets(paper) => {
                let how = if paper.0.landscape { " on their side" } else { ", upright" };
                Some(paper.to_possible_value()?.help(format!("Sheets of {:?}{how}", paper.0.size)))
            }
        }
    }
}

fn scale(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(n) if (0.1..=16.0).contains(&n) => Ok(n),
        _ => Err("expected a number from 0.1 to 16".to_owned()),
    }
}

/// The chart whose symbols are the library.
const SYMBOLS: &str = include_str!("symbols.g7");

pub(crate) fn draw(args: &Draw) -> Result<Verdict, Failure> {
    if args.shapes {
        return shapes(args);
    }
    let path = files::one(&args.file)?;
    let source = sources::load(&path, 0)?;
    if !args.output.as_deref().is_some_and(is_folder) {
        files::refuse_foreign(args.output.as_deref(), &[&path], args.force)?;
    }
    if source.has_errors() || source.others().iter().any(|other| other.source.has_errors()) {
        let problems = source.read_problems();
        talk!("{}", report::text(&source, &problems).trim_end());
        talk!("{}: {}", source.name, Tally::of(&problems));
        return Ok(Verdict::Found);
    }
    let charts = chosen(args, &source)?;
    let options = options(args);
    if let Some(Pages::Sheets(PaperName(paper))) = args.pages {
        on_sheets(args, &source, &charts, &options, paper)?;
        return Ok(Verdict::Fine);
    }
    args.heading.refuse()?;
    match &args.output {
        Some(folder) if is_folder(folder) => each(args, &source, &charts, &options, folder)?,
        output => {
            let form = form(args, output.as_deref())?;
            let bytes = picture(form, &source, &charts, &options, args.scale)?;
            files::deliver(output.as_deref(), &bytes)?;
        }
    }
    Ok(Verdict::Fine)
}

/// Charts in a form: as one picture, or each on a page where the form has pages.
fn picture(
    form: Form,
    source: &Source,
    charts: &[&Chart],
    options: &Options,
    scale: f32,
) -> Result<Vec<u8>, Failure> {
    let charts = charts.iter().copied();
    if form == Form::Drawio {
        if options.pages {
            let why = say!("--pages is for pictures; a file of draw.io has a page for each chart");
            return Err(Failure::Usage(why));
        }
        return Ok(g7_draw::drawio(source.whole(), charts, options).into_bytes());
    }
    let drawings = g7_draw::draw_all(source.whole(), charts, options);
    let svg = match drawings.as_slice() {
        [one] => g7_draw::svg(one, options),
        several => g7_draw::sheet(source.whole(), several, options),
    };
    paper::print(form, svg, scale)
}

/// The symbols of the standard, as a library for draw.io.
fn shapes(args: &Draw) -> Result<Verdict, Failure> {
    let (document, _) = g7_syntax::parse(SYMBOLS, FileId(0));
    files::refuse_foreign(args.output.as_deref(), &[], args.force)?;
    let library = g7_draw::shapes(&document, &options(args));
    files::deliver(args.output.as_deref(), library.as_bytes())?;
    Ok(Verdict::Fine)
}

fn options(args: &Draw) -> Options {
    Options {
        look: match args.look {
            Manner::Iec60848 => Look::Iec60848,
            Manner::Sfc => Look::Sfc,
        },
        actions: !args.no_actions,
        pages: args.pages == Some(Pages::Pl7),
        dark: args.dark,
        font: true,
    }
}

/// The chosen charts of a file and of those that it uses, in the order of the text.
fn chosen<'a>(args: &Draw, source: &'a Source) -> Result<Vec<&'a Chart>, Failure> {
    let named = |c: &Chart| args.charts.iter().any(|n| *c.name.text == **n);
    // The frames of the library are drawn by name alone.
    let all: Vec<&Chart> =
        source.whole().charts().filter(|c| !source.is_of_library(c.at.0) || named(c)).collect();
    if let Some(name) = args.charts.iter().find(|n| !all.iter().any(|c| *c.name.text == ***n)) {
        let names: Vec<&str> = all.iter().map(|c| &*c.name.text).collect();
        let (file, names) = (&source.name, names.join(", "));
        return Err(Failure::Usage(say!(
            "{file} has no chart {name}; it has {names}",
            file = raw(file),
            name = raw(name),
            names = raw(&names)
        )));
    }
    if all.is_empty() {
        return Err(Failure::Usage(say!("{} has no chart to draw", raw(&source.name))));
    }
    Ok(all.into_iter().filter(|c| args.charts.is_empty() || named(c)).collect())
}

/// True for an existing folder, and for a name that only a folder can have.
fn is_folder(path: &Path) -> bool {
    path.is_dir() || path.to_string_lossy().ends_with(std::path::MAIN_SEPARATOR)
}

fn form(args: &Draw, output: Option<&Path>) -> Result<Form, Failure> {
    match (args.form, output) {
        (Some(form), _) => Ok(form),
        (None, None) => Ok(Form::Svg),
        (None, Some(path)) => Form::of(path).ok_or_else(|| {
            let name = path.display();
            Failure::Usage(say!(
                "{name} ends in none of .svg, .png, .pdf, .drawio; --as says the form",
                name = raw(&name)
            ))
        }),
    }
}

/// Writes one file per chart into a folder. All pictures are made before the first is written.
fn each(
    args: &Draw,
    source: &Source,
    charts: &[&Chart],
    options: &Options,
    folder: &Path,
) -> Result<(), Failure> {
    let form = args.form.unwrap_or(Form::Svg);
    let mut made: Vec<(PathBuf, Vec<u8>)> = Vec::new();
    let mut taken: HashSet<PathBuf> = HashSet::new();
    for chart in charts {
        let name = &chart.name.text;
        let path = folder.join(format!("{}.{}", file_name(name), form.ending()));
        if !taken.insert(path.clone()) {
            let path = path.display();
            return Err(Failure::Usage(say!(
                "two charts would go to {path}; draw {name} alone",
                path = raw(&path),
                name = raw(name)
            )));
        }
        made.push((path, picture(form, source, &[*chart], options, args.scale)?));
    }
    let from = files::one(&args.file)?;
    made.iter().try_for_each(|(path, _)| files::refuse_foreign(Some(path), &[&from], args.force))?;
    std::fs::create_dir_all(folder).map_err(|e| Failure::Write(folder.to_path_buf(), e))?;
    made.iter().try_for_each(|(path, bytes)| files::deliver(Some(path), bytes))
}

/// A file name for a chart: letters, digits, `-` and `_`.
fn file_name(chart: &str) -> String {
    chart.chars().map(|c| if c.is_alphanumeric() || matches!(c, '-' | '_') { c } else { '_' }).collect()
}

/// Draws charts on sheets.
fn on_sheets(
    args: &Draw,
    source: &Source,
    charts: &[&Chart],
    options: &Options,
    paper: Paper,
) -> Result<(), Failure> {
    let head = args.heading.head();
    let folder = args.output.as_deref().filter(|o| is_folder(o));
    let form = match folder {
        Some(_) => args.form.unwrap_or(Form::Svg),
        None => form(args, args.output.as_deref())?,
    };
    let made = g7_dossier::print(source, charts, options, paper, &head, language());
    match (form, folder) {
        (Form::Drawio, _) => {
            Err(Failure::Usage(say!("--pages is for pictures; a file of draw.io has a page for each chart")))
        }
        (Form::Pdf, None) => files::deliver(args.output.as_deref(), &pdf(&made, &head)?),
        (Form::Pdf, Some(folder)) => {
            let stem = Path::new(&source.name).file_stem().map_or("charts".into(), |s| s.to_string_lossy());
            let path = folder.join(format!("{}.pdf", file_name(&stem)));
            write_all(args, folder, vec![(path, pdf(&made, &head)?)])
        }
        (Form::Svg | Form::Png, _) => each_sheet(args, form, &made.pages, options, folder),
    }
}

/// A file for each sheet: `tank-1.svg`, `tank-2.svg`; `tank.svg` if there is one sheet.
fn each_sheet(
    args: &Draw,
    form: Form,
    pages: &[Page],
    options: &Options,
    folder: Option<&Path>,
) -> Result<(), Failure> {
    let bytes = |page: &Page| paper::print(form, page.svg(options), args.scale);
    let output = match (folder, &args.output) {
        (Some(folder), _) => folder.join(format!("sheet.{}", form.ending())),
        (None, Some(file)) => file.clone(),
        (None, None) => {
            return match pages {
                [page] => files::deliver(None, &bytes(page)?),
                _ => {
                    let n = pages.len();
                    Err(Failure::Usage(say!(
                        "there are {n} sheets, and one fits the standard output: add -o"
                    )))
                }
            };
        }
    };
    if let ([page], None) = (pages, folder) {
        return files::deliver(Some(&output), &bytes(page)?);
    }
    let stem = output.file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned());
    let mut made: Vec<(PathBuf, Vec<u8>)> = Vec::new();
    for (n, page) in (1..).zip(pages) {
        made.push((output.with_file_name(format!("{stem}-{n}.{}", form.ending())), bytes(page)?));
    }
    write_all(args, output.parent().unwrap_or(Path::new("")), made)
}

/// Writes files of which all were made before, into a folder.
fn write_all(args: &Draw, folder: &Path, made: Vec<(PathBuf, Vec<u8>)>) -> Result<(), Failure> {
    let from = files::one(&args.file)?;
    made.iter().try_for_each(|(path, _)| files::refuse_foreign(Some(path), &[&from], args.force))?;
    if !folder.as_os_str().is_empty() {
        std::fs::create_dir_all(folder).map_err(|e| Failure::Write(folder.to_path_buf(), e))?;
    }
    made.iter().try_for_each(|(path, bytes)| files::deliver(Some(path), bytes))
}
