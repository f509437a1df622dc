//! A file that is open in an editor.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::{Arc, OnceLock};

use g7_edit::{Edit, History, Splice, spliced};
use g7_model::{Document, FileId, Item, Language, Problem, Said, Severity, Span, say};
use g7_rig::Source;

use crate::positions::Positions;

/// The text of a file, its meaning, and its problems.
pub struct File {
    /// The text, the document and the problems of its syntax.
    pub source: Source,
    /// The places of the text in other units.
    pub positions: Arc<Positions>,
    /// The latest text without syntax errors, if the present one has some.
    clean: Option<Clean>,
    /// All problems, in the order of the text.
    pub problems: Vec<Problem>,
    /// The number of changes since the file was opened.
    pub version: u64,
    /// True if it was imported from a foreign format.
    pub imported: bool,
    /// The changes that can be undone.
    pub history: History,
    /// The language of the reader: of hover, completion and the titles of fixes.
    pub language: Language,
    /// Texts of other files, those that it uses among them.
    texts: Texts,
    /// The paths, from its folder, of the files that it uses and that those use; also of files that are not there.
    pub uses: Vec<String>,
}

/// Texts of files that a file uses, by their paths from its folder. `None`: there is no such file. No entry: nobody has
/// looked yet.
pub type Texts = BTreeMap<String, Option<Arc<str>>>;

/// The number of each open file in its own places. The files that it uses have other numbers.
pub const OWN: FileId = FileId(0);

/// Greatest length of a text that is opened, in bytes.
const MOST: usize = 16 << 20;

impl File {
    /// Reads a text; a file of a foreign format is converted to .g7 text.
    pub fn open(name: &str, text: String) -> Result<File, Said> {
        fits(name, &text)?;
        let source = Source::new(name, text.into_bytes(), 0);
        match source.format {
            Some(_) => converted(source).and_then(|(text, told)| File::imported(name, text, told)),
            None => Ok(File::of(source, false)),
        }
    }

    /// Reads the .g7 text that [`convert`] made of a foreign file, with the problems that it told.
    pub fn imported(name: &str, text: String, told: Vec<Problem>) -> Result<File, Said> {
        fits(name, &text)?;
        let mut file = File::of(Source::native(name, text.into_bytes(), 0), true);
        file.problems.extend(told);
        Ok(file)
    }

    /// Reads a .g7 text, whatever its name is.
    pub fn open_native(name: &str, text: String) -> Result<File, Said> {
        fits(name, &text)?;
        Ok(File::of(Source::native(name, text.into_bytes(), 0), false))
    }

    #[inline(never)]
    fn of(source: Source, imported: bool) -> File {
        let mut file = File {
            positions: Arc::new(Positions::new(&source.text)),
            clean: None,
            problems: Vec::new(),
            version: 0,
            imported,
            history: History::default(),
            language: Language::default(),
            texts: Texts::new(),
            uses: Vec::new(),
            source,
        };
        file.judge();
        file
    }

    /// Makes a change and records it for undo; typed characters are joined to words.
    pub fn change(&mut self, splices: &[Splice], typed: bool) -> Result<(), Said> {
        self.recorded(splices, typed)?;
        self.splice(splices)
    }

    /// Makes a change of somebody else, which undo here does not take back (decision 086).
    pub fn change_of_others(&mut self, splices: &[Splice]) -> Result<(), Said> {
        self.fits(splices)?;
        self.splice(splices)?;
        self.history.others(splices);
        Ok(())
    }

    /// Makes the change of a gesture. What the gesture has read of the new text is not read again.
    #[inline(never)]
    pub fn make(&mut self, edit: &mut Edit) -> Result<(), Said> {
        self.recorded(&edit.splices, false)?;
        match edit.read.take() {
            Some(read) => {
                self.keep_clean();
                self.source.put_tree(*read);
                self.changed();
                Ok(())
            }
            None => self.splice(&edit.splices),
        }
    }

    /// Refuses a change that would make the text too large.
    fn fits(&self, splices: &[Splice]) -> Result<(), Said> {
        let more: usize = splices.iter().map(|s| s.insert.len()).sum();
        let less: usize = splices.iter().map(|s| s.end.saturating_sub(s.start)).sum();
        if (self.text().len() + more).saturating_sub(less) > MOST {
            return Err(too_large());
        }
        Ok(())
    }

    /// Records a change that is about to be made.
    fn recorded(&mut self, splices: &[Splice], typed: bool) -> Result<(), Said> {
        self.fits(splices)?;
        if !self.history.record(&self.source.text, splices, typed) {
            return Err(say!("these places are none of the text"));
        }
        Ok(())
    }

    /// Takes another text, which an editor with an undo of its own has made.
    pub fn take(&mut self, text: String) -> Result<(), Said> {
        if text.len() > MOST {
            return Err(too_large());
        }
        let splice = difference(self.text(), &text);
        self.splice(&[splice])
    }

    /// Undoes the last change, or redoes it; returns the splices.
    pub fn travel(&mut self, back: bool) -> Result<Vec<Splice>, Said> {
        let text = &self.source.text;
        let splices = if back { self.history.undo(text) } else { self.history.redo(text) };
        let nothing = || if back { say!("nothing to undo") } else { say!("nothing to redo") };
        let splices = splices.ok_or_else(nothing)?;
        self.splice(&splices).map_err(|_| say!("the history does not fit the text"))?;
        Ok(splices)
    }

    /// The text before the last change, if there was one.
    pub fn before(&self) -> Option<String> {
        spliced(self.text(), self.history.last()?)
    }

    /// Changes the text. The form was decided when the file was opened: an imported file keeps its name,
    /// but its text is .g7 text now.
    fn splice(&mut self, splices: &[Splice]) -> Result<(), Said> {
        self.keep_clean();
        let edits: Vec<_> = splices.iter().map(|s| (s.start..s.end, s.insert.as_str())).collect();
        if !self.source.change(&edits) {
            return Err(say!("these places are none of the text"));
        }
        self.changed();
        Ok(())
    }

    /// Keeps the present text, if it has no syntax errors, because a change may bring some.
    fn keep_clean(&mut self) {
        if self.is_clean() {
            let text = self.source.text.as_str().into();
            self.clean =
                Some(Clean { text, positions: Arc::clone(&self.positions), document: OnceLock::new() });
        }
    }

    fn changed(&mut self) {
        self.positions = Arc::new(Positions::new(&self.source.text));
        self.version += 1;
        self.judge();
    }

    /// The file in the form that gestures need.
    pub fn as_edited(&self) -> g7_edit::Source<'_> {
        let Source { text, document, problems, marks, .. } = &self.source;
        g7_edit::Source { text, document, problems, marks: Some(marks) }
    }

    /// A place in code units.
    pub fn units(&self, at: Span) -> (usize, usize) {
        let range = self.source.range(at);
        let unit = |byte| self.positions.unit(self.text(), byte);
        (unit(range.start), unit(range.end))
    }

    /// The text.
    pub fn text(&self) -> &str {
        &self.source.text
    }

    /// True if the text has no syntax errors.
    pub fn is_clean(&self) -> bool {
        !self.source.has_errors()
    }

    /// Takes texts of other files. Returns true if that of a used file has changed.
    pub fn lend(&mut self, texts: Texts) -> bool {
        let changed =
            self.uses.iter().any(|path| texts.get(path).is_some_and(|t| self.texts.get(path) != Some(t)));
        self.texts.extend(texts);
        if changed {
            self.version += 1;
            self.judge();
        }
        changed
    }

    /// Forgets the text of another file, so that it is asked for again.
    pub fn forget(&mut self, path: &str) {
        if self.texts.remove(path).is_some() {
            self.judge();
        }
    }

    /// The texts of the files that it uses, as far as it was lent them.
    pub fn lent(&self) -> impl Iterator<Item = (&String, &Option<Arc<str>>)> {
        self.uses.iter().filter_map(|path| self.texts.get_key_value(path))
    }

    /// The paths of the files that it uses, as far as it was not lent their texts.
    pub fn wants(&self) -> impl Iterator<Item = &String> {
        self.uses.iter().filter(|path| !self.texts.contains_key(*path))
    }

    /// Joins the items of the files that it uses with its own.
    fn link(&mut self) {
        self.uses.clear();
        let (texts, uses) = (&self.texts, &mut self.uses);
        self.source.link(&mut |path| {
            uses.push(path.to_owned());
            match texts.get(path) {
                Some(Some(text)) => Ok(text.as_bytes().to_vec()),
                Some(None) => Err(say!("there is no such file")),
                None => Err(say!("it was not read")),
            }
        });
    }

    /// Finds the problems.
    fn judge(&mut self) {
        self.link();
        self.problems = match g7_rig::testing::problems(&self.source, None) {
            Ok(problems) => problems.into_iter().map(|p| self.source.own(p)).collect(),
            Err(_) => self.source.problems.clone(),
        };
        self.problems.sort_by_key(|p| (p.at, p.severity() == Severity::Warning));
    }

    /// The document to draw a chart from: the present one if the chart and its layout can be read in it,
    /// whatever stands in the rest of the file.
    #[inline(never)]
    pub fn drawn_chart(&self, name: &str) -> Readable<'_> {
        let parts = self.source.document.items.iter().filter_map(|item| match item {
            Item::Chart(c) if *c.name.text == *name => Some((true, c.at.0)),
            Item::Layout(l) if *l.chart.text == *name => Some((false, l.at.0)),
            _ => None,
        });
        let (mut found, mut clean) = (false, !self.is_clean());
        for (chart, at) in parts {
            found |= chart;
            // Its first byte also touches the part of the text before it.
            clean &= self.as_edited().reads_cleanly(at.start as usize + 1..at.end as usize);
        }
        if found && clean { self.present() } else { self.drawn() }
    }

    fn present(&self) -> Readable<'_> {
        let Source { document, text, .. } = &self.source;
        Readable { document, text, positions: &self.positions, stale: false }
    }

    /// The document to draw: that of the latest text without syntax errors. If there was never such
    /// a text, it is the readable part of the present one.
    pub fn drawn(&self) -> Readable<'_> {
        match &self.clean {
            Some(clean) if !self.is_clean() => clean.readable(),
            _ => self.present(),
        }
    }

    /// A document of the file with the items of the files that it uses.
    pub fn with_uses<'d>(&'d self, own: Readable<'d>) -> Cow<'d, Document> {
        if !own.stale {
            return Cow::Borrowed(self.source.whole());
        }
        if self.source.others().is_empty() {
            return Cow::Borrowed(own.document);
        }
        let used = self.source.whole().items.iter().filter(|i| i.at().file != OWN);
        let items = own.document.items.iter().chain(used).cloned().collect();
        Cow::Owned(Document { items, notes: Vec::new() })
    }
}

/// Converts a foreign file: its .g7 text, and the problems that its reader found.
pub fn convert(name: &str, text: String) -> Result<(String, Vec<Problem>), Said> {
    fits(name, &text)?;
    converted(Source::new(name, text.into_bytes(), 0))
}

#[inline(never)]
fn converted(mut source: Source) -> Result<(String, Vec<Problem>), Said> {
    if source.has_errors() {
        return Err(match source.problems.first() {
            Some(first) => say!("`{}` cannot be imported: {}", source.name, first.what),
            None => say!("`{}` cannot be imported", source.name),
        });
    }
    g7_draw::make_room(&mut source.document);
    let text = g7_syntax::print(&source.document, None);
    // The problems are kept without their places, which do not exist in the new text.
    let at = Span { file: FileId(0), start: 0, end: 0 };
    let placeless = |p: Problem| Problem { at, related: Vec::new(), fixes: Vec::new(), ..p };
    Ok((text, source.problems.into_iter().map(placeless).collect()))
}

fn too_large() -> Said {
    say!("the text would be too large for the editor")
}

/// Refuses a file whose text is too long.
fn fits(name: &str, text: &str) -> Result<(), Said> {
    if text.len() > MOST { Err(say!("`{name}` is too large for the editor")) } else { Ok(()) }
}

/// The one change that leads from a text to another: what lies between their common beginning and their
/// common end.
fn difference(old: &str, new: &str) -> Splice {
    let same = old.bytes().zip(new.bytes()).take_while(|(a, b)| a == b).count();
    let start = floor(old, same);
    let most = old.len().min(new.len()) - start;
    let ends = old.bytes().rev().zip(new.bytes().rev()).take(most);
    let mut tail = ends.take_while(|(a, b)| a == b).count();
    while !old.is_char_boundary(old.len() - tail) {
        tail -= 1;
    }
    Splice::new(start, old.len() - tail, new.get(start..new.len() - tail).unwrap_or_default())
}

/// The nearest byte before a place, or at it, at which a character begins.
pub(crate) fn floor(text: &str, byte: usize) -> usize {
    let mut byte = byte.min(text.len());
    while !text.is_char_boundary(byte) {
        byte -= 1;
    }
    byte
}

/// An earlier text without syntax errors.
struct Clean {
    text: Box<str>,
    positions: Arc<Positions>,
    /// The document of the text. It is read when it is asked for first, because most changes bring no syntax error.
    document: OnceLock<Document>,
}

impl Clean {
    fn readable(&self) -> Readable<'_> {
        let read = || g7_syntax::parse(&self.text, FileId(0)).0;
        let document = self.document.get_or_init(read);
        Readable { document, text: &self.text, positions: &self.positions, stale: true }
    }
}

/// A readable document, with the text from which it was parsed.
#[derive(Clone, Copy)]
pub struct Readable<'a> {
    /// The document.
    pub document: &'a Document,
    /// The text.
    pub text: &'a str,
    /// The places of the text in other units.
    pub positions: &'a Positions,
    /// True if it is an earlier text, because the present one has syntax errors.
    pub stale: bool,
}

impl Readable<'_> {
    /// A place in code units of the text.
    pub fn units(&self, at: Span) -> (usize, usize) {
        let unit = |byte: u32| self.positions.unit(self.text, byte as usize);
        (unit(at.start), unit(at.end))
    }

    /// The words at a place.
    pub fn words(&self, at: Span) -> String {
        self.text.get(at.start as usize..at.end as usize).unwrap_or("").to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CHARTS: &str = "input a : BOOL\n\nchart G {\n  initial step 1\n  1 -> 1 when a\n}\n\nchart H {\n  initial step 1\n}\n";

    /// The file is what a new one with its text is.
    fn same(file: &File) {
        let new = File::open_native("a.g7", file.text().to_owned()).expect("it opens");
        let shown = |f: &File| format!("{:?}", (&f.source.bytes, &f.source.document, &f.problems));
        assert_eq!(shown(file), shown(&new), "{}", file.text());
    }

    #[test]
    fn each_way_to_change_a_file_gives_the_file_of_the_new_text() {
        let mut file = File::open_native("a.g7", CHARTS.to_owned()).expect("it opens");
        let at = CHARTS.find("when a").expect("it is there");
        file.change(&[Splice::new(at, at + 6, "wen"), Splice::new(at + 8, at + 8, "// é\n")], true)
            .expect("it fits");
        same(&file);
        file.travel(true).expect("there is a change");
        assert_eq!(file.text(), CHARTS);
        same(&file);
        let mut edit = crate::gestures::draft(
            &file,
            &g7_edit::Gesture::AddStep { chart: "H".into(), at: None, kind: None },
        )
        .expect("a step is added");
        assert!(edit.read.is_some(), "the gesture has read the text");
        file.make(&mut edit).expect("it fits");
        same(&file);
        for text in ["", "chart é {}", "chart è {}", "chart è {}\n", &CHARTS.replace("chart", "task"), CHARTS]
        {
            file.take(text.to_owned()).expect("it fits");
            assert_eq!(file.text(), text);
            same(&file);
        }
        assert!(file.change(&[Splice::new(9_999, 9_999, "")], false).is_err());
        assert!(file.change(&[Splice::new(4, 2, "")], false).is_err());
        assert_eq!(file.text(), CHARTS);
    }

    #[test]
    fn a_key_reads_a_few_lines() {
        let mut text = String::from("chart G {\n  initial step 0\n");
        (1..1000).for_each(|n| text.push_str(&format!("  {} -> {n} when =1\n  step {n}\n", n - 1)));
        text.push_str("  999 -> 0 when =1\n}\n");
        let at = text.find("step 500").expect("it is there");
        let mut file = File::open_native("a.g7", text).expect("it opens");
        file.take(file.text().replace("step 7\n", "step 7 \n")).expect("it fits");
        file.change(&[Splice::new(at, at, " ")], true).expect("it fits");
        assert!(file.source.marks.reread() < 300, "{} bytes", file.source.marks.reread());
        file.take(file.text().replace("step 700\n", "step 700 \n")).expect("it fits");
        assert!(file.source.marks.reread() < 300, "{} bytes", file.source.marks.reread());
    }

    #[test]
    fn a_chart_is_drawn_from_the_present_text_if_the_error_is_elsewhere() {
        let mut file = File::open_native("a.g7", CHARTS.to_owned()).expect("it opens");
        let at = CHARTS.find(" a\n}").expect("it is there");
        file.change(
            &[Splice::new(at, at + 2, ""), Splice::new(CHARTS.len() - 2, CHARTS.len() - 2, "  step 2\n")],
            false,
        )
        .expect("it fits");
        assert!(!file.is_clean());
        let (g, h) = (file.drawn_chart("G"), file.drawn_chart("H"));
        assert_eq!((g.stale, g.text), (true, CHARTS));
        assert_eq!((h.stale, h.text), (false, file.text()));
        assert!(file.drawn_chart("Nothing").stale);
    }
}
