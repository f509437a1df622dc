//! Tests that are added to the text of a chart: a file that `g7 test` runs.
//!
//! A test of the same title gives way to the new one; all else of the text stays as it is.

use std::collections::BTreeSet;
use std::path::Path;

use g7_host::WallClock;
use g7_model::{Document, Item, ProfileName, Scenario, say};
use g7_rig::Source;
use g7_rig::testing::{self, Coverage, Outcome};

use crate::failure::{Failure, raw};
use crate::files;

/// The text of a chart with these tests behind it.
pub(super) fn text(source: &Source, tests: &[Scenario]) -> String {
    let mut text = match source.format {
        None => source.text.clone(),
        Some(_) => g7_syntax::print(&source.document, None),
    };
    if source.format.is_none() {
        let titles: BTreeSet<&str> = tests.iter().map(|t| &*t.title).collect();
        let old: Vec<_> =
            source.tests().filter(|t| titles.contains(&*t.title)).map(|t| source.range(t.at.0)).collect();
        for range in old.into_iter().rev() {
            // The rest of its last line goes too, if nothing stands there.
            let behind = text.get(range.end..).unwrap_or("");
            let blank = behind.len() - behind.trim_start_matches([' ', '\t', '\r']).len();
            let line_end = usize::from(behind.get(blank..).is_some_and(|t| t.starts_with('\n')));
            text.replace_range(range.start..range.end + line_end * (blank + line_end), "");
        }
    }
    let items = tests.iter().cloned().map(Item::Test).collect();
    let printed = g7_syntax::print(&Document { items, ..Document::default() }, None);
    format!("{}\n\n{}\n", text.trim_end(), printed.trim_end())
}

/// Runs these tests as `g7 test` will run them: their outcomes in the order of the text, and what
/// they cover. Nothing comes of a text with errors.
pub(super) fn run(
    source: &Source,
    tests: &[Scenario],
    profile: Option<ProfileName>,
) -> Result<(Source, Vec<Outcome>, Coverage), Failure> {
    // The name decides where the text does not: it is a .g7 file now.
    let mut made = Source::new(&format!("{}.g7", source.name), text(source, tests).into_bytes(), 0);
    made = made.linked_like(source);
    // Only the new ones are run: they stand last.
    let mut others = made.tests().count().saturating_sub(tests.len());
    made.document.items.retain(|item| {
        let other = matches!(item, Item::Test(_)) && others > 0;
        others -= usize::from(other);
        !other
    });
    let mut coverage = Coverage::default();
    let options = testing::Options { profile, ..testing::Options::default() };
    let (outcomes, _) = testing::file(&made, options, &mut coverage, &mut WallClock::default(), &mut || {})?;
    Ok((made, outcomes, coverage))
}

/// Writes the text of the chart with these tests; the file may be that of the chart itself.
pub(super) fn write(path: &Path, source: &Source, tests: &[Scenario]) -> Result<(), Failure> {
    if source.format.is_some() && files::is_same(path, Path::new(&source.name)) {
        let name = path.display();
        return Err(Failure::Usage(say!(
            "{name} is no .g7 file: name another file for the tests",
            name = raw(&name)
        )));
    }
    files::write(path, text(source, tests).as_bytes())
}
