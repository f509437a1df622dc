//! Problems as annotations of GitHub: commands in the output of a workflow, which GitHub shows at the lines of a
//! change.

use crate::tongue::language;
use g7_model::Problem;

use super::checked::Checked;
use crate::sources::Source;

/// A line for each problem.
pub(super) fn of(all: &[Checked]) -> String {
    let lines = all.iter().flat_map(|c| c.problems.iter().map(|p| line(&c.source, p)));
    lines.collect()
}

fn line(source: &Source, problem: &Problem) -> String {
    // GitHub's words are the same.
    let word = problem.severity().name();
    let source = source.home(problem.at);
    let range = source.range(problem.at);
    let ((line, column), (end_line, end_column)) = (source.position(range.start), source.position(range.end));
    let file = source.name.strip_prefix("./").unwrap_or(&source.name);
    // GitHub takes columns only where they are of one line.
    let columns =
        if line == end_line { format!(",col={column},endColumn={end_column}") } else { String::new() };
    let help =
        problem.help.as_ref().map_or_else(String::new, |help| format!("\n{}", help.in_language(language())));
    format!(
        "::{word} file={},line={line},endLine={end_line}{columns},title={}::{}\n",
        property(file),
        property(&format!("{}: {}", problem.code.id, problem.code.title_in(language()))),
        data(&format!("{}{help}", problem.what.in_language(language())))
    )
}

/// A message, escaped as the commands of a workflow have it.
fn data(text: &str) -> String {
    text.replace('%', "%25").replace('\r', "%0D").replace('\n', "%0A")
}

/// A property, escaped.
fn property(text: &str) -> String {
    data(text).replace(':', "%3A").replace(',', "%2C")
}
