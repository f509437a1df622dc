//! The formatter: the least change that gives a text the form of the printer.

use g7_edit::Splice;

use crate::file::File;

/// The change that formats the text; none if it has syntax errors.
pub fn format(file: &File) -> Option<Vec<Splice>> {
    file.is_clean().then(|| {
        let text = g7_syntax::print(&file.source.document, Some(file.text()));
        difference(file.text(), &text)
    })
}

/// The difference between two texts as one splice, from the first to the last differing character.
fn difference(old: &str, new: &str) -> Vec<Splice> {
    if old == new {
        return Vec::new();
    }
    let common = |a: &mut dyn Iterator<Item = char>, b: &mut dyn Iterator<Item = char>| -> usize {
        a.zip(b).take_while(|(a, b)| a == b).map(|(a, _)| a.len_utf8()).sum()
    };
    let head = common(&mut old.chars(), &mut new.chars());
    let (rest, fresh) = (old.get(head..).unwrap_or(""), new.get(head..).unwrap_or(""));
    let tail = common(&mut rest.chars().rev(), &mut fresh.chars().rev());
    let insert = fresh.get(..fresh.len() - tail).unwrap_or("");
    vec![Splice::new(head, old.len() - tail, insert)]
}
