//! The one table of formats: the names of each, the way to recognise it, its reader and its writer.
//!
//! The command line, the page and the tests use this table; there is no other list.

use g7_iec::plcopen::Dialect;
use g7_iec::{Written, plcopen, sfc, xml};
use g7_model::composed::{as_block, as_document, decomposed, with_blocks};
use g7_model::instances::instantiated;
use g7_model::named::{declared, held};
use g7_model::{Document, FileId, Item, Problem};

use crate::{arrays, classicladder, controlexpert, jgrafchart, l5x, mermaid, s7graph, xmi};

/// Tells whether a file is of a format, from its name, the name of its first XML
/// element (if it has one) and its bytes.
type Fits = fn(name: &str, root: Option<&str>, bytes: &[u8]) -> bool;

/// Returns a document with everything that could be read, and the problems in the order of the
/// file.
type Read = fn(bytes: &[u8], file: FileId) -> (Document, Vec<Problem>);

/// Writes a document that was read without errors.
type Write = fn(&Document) -> Written;

/// The types of the file that a writer takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Keeps {
    /// None of them.
    None,
    /// Arrays, structures, enumerations and function blocks; if `initial`, instances of these with initial values as well.
    Blocks { initial: bool },
}

/// A format of another tool.
#[derive(Debug)]
pub struct Format {
    /// The word for it on the command line.
    pub word: &'static str,
    /// The name for it in messages.
    pub title: &'static str,
    /// The endings of its files, without the dot; the first is that of a file that is written.
    pub endings: &'static [&'static str],
    reader: Option<Read>,
    writer: Option<Write>,
    in_dialect: Option<fn(&Document, Dialect) -> Written>,
    /// The types of the file that its writer takes.
    keeps: Keeps,
}

/// How a file of each format that is read is recognised, by the word of the format, in the order in which a file
/// is asked. It stands apart from the readers, so that a program can tell that a file is foreign without them.
static SIGNS: [(&str, Fits); 8] = [
    ("jgrafchart", jgrafchart::fits),
    ("plcopen", plcopen::fits),
    ("xmi", xmi::fits),
    ("classicladder", classicladder::fits),
    ("controlexpert", controlexpert::fits),
    ("s7graph", s7graph::fits),
    ("l5x", l5x::fits),
    // The last one, because it is recognised by the name's ending too.
    ("sfc", sfc::fits),
];

/// All formats, in the order in which they are shown.
pub static FORMATS: [Format; 9] = [
    // JGrafchart 2.x, `saveVersion` up to 8.
    Format {
        word: "jgrafchart",
        title: "JGrafchart",
        endings: &["xml"],
        reader: Some(jgrafchart::import),
        writer: Some(jgrafchart::export),
        in_dialect: None,
        keeps: Keeps::None,
    },
    // PLCopen TC6 XML and IEC 61131-10 XML; TC6 XML 2.01 is written.
    Format {
        word: "plcopen",
        title: "PLCopen XML",
        endings: &["xml"],
        reader: Some(plcopen::import),
        writer: Some(plcopen::export),
        in_dialect: Some(plcopen::export_for),
        keeps: Keeps::Blocks { initial: Dialect::USUAL.has_initial() },
    },
    // EMF/XMI instances of the AGRAFE meta-model of IEC 60848.
    Format {
        word: "xmi",
        title: "XMI",
        endings: &["grafcet", "xmi"],
        reader: Some(xmi::import),
        writer: Some(xmi::export),
        in_dialect: None,
        keeps: Keeps::None,
    },
    // ClassicLadder 0.7 to 0.9: a project, or its `sequential.csv` alone.
    Format {
        word: "classicladder",
        title: "ClassicLadder",
        endings: &["clp", "clprj"],
        reader: Some(classicladder::import),
        writer: None,
        in_dialect: None,
        keeps: Keeps::None,
    },
    // Control Expert and Unity Pro: a chart (`.XSF`), or an application with charts (`.XEF`); `.XSF` is written.
    Format {
        word: "controlexpert",
        title: "Control Expert",
        endings: &["xsf", "xef"],
        reader: Some(controlexpert::import),
        writer: Some(controlexpert::export),
        in_dialect: None,
        keeps: Keeps::None,
    },
    // S7-GRAPH: a block exported by TIA Portal's Openness.
    Format {
        word: "s7graph",
        title: "S7-GRAPH",
        endings: &["xml"],
        reader: Some(s7graph::import),
        writer: None,
        in_dialect: None,
        keeps: Keeps::None,
    },
    // Studio 5000 Logix Designer: routines in SFC.
    Format {
        word: "l5x",
        title: "Logix L5X",
        endings: &["l5x"],
        reader: Some(l5x::import),
        writer: None,
        in_dialect: None,
        keeps: Keeps::None,
    },
    // IEC 61131-3 in text.
    Format {
        word: "sfc",
        title: "IEC 61131-3 text",
        endings: sfc::ENDINGS,
        reader: Some(sfc::import),
        writer: Some(sfc::export),
        in_dialect: None,
        // The standard has no initial values of a function block in VAR_GLOBAL (2003, B.1.4.3), and matiec refuses them.
        keeps: Keeps::Blocks { initial: false },
    },
    // A flowchart in the text of Mermaid, for documents.
    Format {
        word: "mermaid",
        title: "Mermaid flowchart",
        endings: &["mmd"],
        reader: None,
        writer: Some(mermaid::export),
        in_dialect: None,
        keeps: Keeps::None,
    },
];

impl Format {
    /// True if files of this format are read.
    pub fn is_read(&self) -> bool {
        self.reader.is_some()
    }

    /// True if documents are written in this format.
    pub fn is_written(&self) -> bool {
        self.writer.is_some()
    }

    /// The ending of a written file, without the dot.
    pub fn ending(&self) -> &'static str {
        self.endings.first().copied().unwrap_or_default()
    }

    /// Reads a file; None if the format is not read.
    ///
    /// Always returns a document with everything that could be read, and the problems in the order
    /// of the file.
    pub fn read(&self, bytes: &[u8], file: FileId) -> Option<(Document, Vec<Problem>)> {
        self.reader.map(|read| read(bytes, file))
    }

    /// Writes a document, which must have been read without errors; None if the format is not
    /// written.
    pub fn write(&self, document: &Document) -> Option<Written> {
        self.writer.map(|write| with_plain(document, self.keeps, write))
    }

    /// Writes a document in a dialect; None if the format has no dialects.
    pub fn write_in(&self, document: &Document, dialect: Dialect) -> Option<Written> {
        let keeps = Keeps::Blocks { initial: dialect.has_initial() };
        self.in_dialect.map(|write| with_plain(document, keeps, |plain| write(plain, dialect)))
    }
}

/// Gives a document to a writer as charts and variables: without parameters of charts, and without the arrays, structures
/// and function blocks that its format does not have.
fn with_plain(document: &Document, keeps: Keeps, write: impl FnOnce(&Document) -> Written) -> Written {
    let typed = declared(document).0;
    let charts = instantiated(&typed).0;
    let (plain, mut told) = match keeps {
        Keeps::None => (decomposed(&charts).0, Vec::new()),
        Keeps::Blocks { initial } => with_blocks(&charts, initial),
    };
    let (plain, mut problems) = singled(&plain, keeps);
    problems.append(&mut told);
    let mut written = write(&plain);
    written.problems.append(&mut problems);
    written.problems.sort_by_key(|p| (p.at.start, p.at.end));
    written
}

/// The document with numbers in the place of values of enumerations, and without arrays that the format does not have;
/// its function blocks likewise.
fn singled(document: &Document, keeps: Keeps) -> (Document, Vec<Problem>) {
    let held = held(document).0;
    let (plain, mut problems) = arrays::singled(&held, keeps != Keeps::None);
    let mut plain = plain.into_owned();
    for item in &mut plain.items {
        let Item::Composed(block) = item else { continue };
        if !block.block {
            continue;
        }
        let mut unit = as_document(block);
        unit.items.extend(document.items.iter().filter(|i| matches!(i, Item::Type(_))).cloned());
        let (unit, mut own) = singled(&unit, keeps);
        problems.append(&mut own);
        *block = as_block(block, unit, |name| name);
    }
    (plain, problems)
}

/// The format with this word.
pub fn named(word: &str) -> Option<&'static Format> {
    FORMATS.iter().find(|f| f.word == word)
}

/// Recognises the format of a foreign file by its content, otherwise by the ending of its name.
///
/// A file in UTF-16 is recognised too, so that its reader can report the encoding. None means that
/// the format is unknown, and the file is taken for a .g7 file. `name` may be empty or any path.
pub fn recognise(name: &str, bytes: &[u8]) -> Option<&'static Format> {
    named(word_of(name, bytes)?)
}

/// True if [`recognise`] finds a format. A program that calls this function alone does not contain the readers.
pub fn is_foreign(name: &str, bytes: &[u8]) -> bool {
    word_of(name, bytes).is_some()
}

fn word_of(name: &str, bytes: &[u8]) -> Option<&'static str> {
    let root = xml::root_name(bytes);
    SIGNS.iter().find(|(_, fits)| fits(name, root.as_deref(), bytes)).map(|(word, _)| *word)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_format_that_is_read_has_a_sign_and_no_other_has() {
        let signs: Vec<&str> = SIGNS.iter().map(|(word, _)| *word).collect();
        let read: Vec<&str> = FORMATS.iter().filter(|f| f.is_read()).map(|f| f.word).collect();
        assert_eq!(signs, read);
    }
}
