//! Charts on sheets of paper: a PDF of all sheets, or a file for each.

use std::path::{Path, PathBuf};

use clap::ValueEnum;
use g7_dossier::Head;
use g7_draw::{Options, Page, Paper};
use g7_model::{Chart, say};

use super::paper::{self, Form};
use super::{Draw, file_name, form, is_folder};
use crate::failure::Failure;
use crate::files;
use crate::sources::Source;
use crate::tongue::language;

/// A sheet of paper.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum PaperName {
    /// A4, upright.
    A4,
    /// A4 on its side.
    A4Landscape,
    /// A3, upright.
    A3,
    /// A3 on its side.
    A3Landscape,
}

impl PaperName {
    pub(crate) fn paper(self) -> Paper {
        let [a4, a4_landscape, a3, a3_landscape] = Paper::ALL.map(|(_, paper)| paper);
        match self {
            PaperName::A4 => a4,
            PaperName::A4Landscape => a4_landscape,
            PaperName::A3 => a3,
            PaperName::A3Landscape => a3_landscape,
        }
    }
}

// What a title block says. A comment of documentation here would take the place of the command's own.
#[derive(clap::Args, Clone, Debug, Default)]
pub(crate) struct Heading {
    /// The title in the title block; without it the name of the file.
    #[arg(long, value_name = "TEXT")]
    title: Option<String>,
    /// The author in the title block.
    #[arg(long, value_name = "TEXT")]
    author: Option<String>,
    /// The company in the title block.
    #[arg(long, value_name = "TEXT")]
    company: Option<String>,
    /// The revision in the title block.
    #[arg(long, value_name = "TEXT")]
    revision: Option<String>,
    /// The date in the title block, as it is to be printed.
    #[arg(long, value_name = "TEXT")]
    date: Option<String>,
}

impl Heading {
    pub(crate) fn head(&self) -> Head {
        let text = |given: &Option<String>| given.clone().unwrap_or_default();
        Head {
            title: text(&self.title),
            author: text(&self.author),
            company: text(&self.company),
            revision: text(&self.revision),
            date: text(&self.date),
        }
    }

    /// Refuses texts for a title block where there is none.
    pub(super) fn refuse(&self) -> Result<(), Failure> {
        if self.head() == Head::default() {
            return Ok(());
        }
        Err(Failure::Usage(say!("a title block stands on sheets of paper: add --pages a4 or another sheet")))
    }
}

/// Draws charts on sheets.
pub(super) fn print(
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
        (Form::Pdf, None) => files::deliver(args.output.as_deref(), &super::pdf(&made, &head)?),
        (Form::Pdf, Some(folder)) => {
            let stem = Path::new(&source.name).file_stem().map_or("charts".into(), |s| s.to_string_lossy());
            let path = folder.join(format!("{}.pdf", file_name(&stem)));
            write(args, folder, vec![(path, super::pdf(&made, &head)?)])
        }
        (Form::Svg | Form::Png, _) => each(args, form, &made.pages, options, folder),
    }
}

/// A file for each sheet: `tank-1.svg`, `tank-2.svg`; `tank.svg` if there is one sheet.
fn each(
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
    write(args, output.parent().unwrap_or(Path::new("")), made)
}

/// Writes files of which all were made before, into a folder.
fn write(args: &Draw, folder: &Path, made: Vec<(PathBuf, Vec<u8>)>) -> Result<(), Failure> {
    let from = files::one(&args.file)?;
    made.iter().try_for_each(|(path, _)| files::refuse_foreign(Some(path), &[&from], args.force))?;
    if !folder.as_os_str().is_empty() {
        std::fs::create_dir_all(folder).map_err(|e| Failure::Write(folder.to_path_buf(), e))?;
    }
    made.iter().try_for_each(|(path, bytes)| files::deliver(Some(path), bytes))
}
