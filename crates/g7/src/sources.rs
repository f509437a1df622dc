//! Reads the files of charts.

use std::path::Path;

use g7_exchange::FORMATS;
use g7_model::{Said, say, words};
pub(crate) use g7_rig::Source;

use crate::failure::{Failure, raw};
use crate::{files, used};

/// Reads a .g7 file or a file of another tool. The content decides which one it is, otherwise the
/// name.
///
/// # Errors
///
/// The file cannot be read, or it is neither of both.
pub(crate) fn load(path: &Path, id: u32) -> Result<Source, Failure> {
    let name = if path == Path::new("-") { "<stdin>".to_owned() } else { path.display().to_string() };
    let mut source = Source::new(&name, files::read(path)?, id);
    if path != Path::new("-")
        && let Err(why) = refuse_formless(&source, path)
    {
        return Err(Failure::Form { name: source.name, why });
    }
    used::link(&mut source, path);
    Ok(source)
}

/// Refuses a file that is neither a .g7 file nor one of another tool.
pub(crate) fn refuse_formless(source: &Source, path: &Path) -> Result<(), Said> {
    if !files::is_chart(path) && is_of_no_form(source) { Err(no_form()) } else { Ok(()) }
}

/// Why a file is of no form, without its name.
fn no_form() -> Said {
    let mut titles: Vec<&str> = FORMATS.iter().filter(|f| f.is_read()).map(|f| f.title).collect();
    titles.dedup();
    say!("this is no .g7 file, and none of a tool that g7 reads ({})", raw(titles.join(", ")))
}

/// True if a file begins with no word of a .g7 file, and has errors as one.
fn is_of_no_form(source: &Source) -> bool {
    let first = first_word(source.text.trim_start_matches('\u{feff}'));
    source.format.is_none() && source.has_errors() && !words::has(words::FILE, first)
}

/// The first word behind blanks and notes; empty if something else stands there.
fn first_word(text: &str) -> &str {
    let mut text = text.trim_start();
    loop {
        let ends = [("//", "\n"), ("/*", "*/"), ("(*", "*)")];
        let Some((_, end)) = ends.into_iter().find(|(begin, _)| text.starts_with(begin)) else { break };
        text = text.split_once(end).map_or("", |(_, rest)| rest).trim_start();
    }
    let end = text.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(text.len());
    text.get(..end).unwrap_or("")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_word_stands_behind_notes() {
        assert_eq!(first_word(" // a\n /* b */ (* c *)\nchart G {"), "chart");
        assert_eq!(first_word("# a title"), "");
        assert_eq!(first_word("// only"), "");
    }

    #[test]
    fn what_begins_as_a_chart_is_one() {
        let of = |text: &str| is_of_no_form(&Source::new("a.txt", text.as_bytes().to_vec(), 0));
        assert!(of("# Notes\n\nto be read") && of("\u{89}PNG\0\0"));
        assert!(!of("chart {") && !of("") && !of("// nothing yet\n"));
    }
}
