//! `book FOLDER` puts the book together for mdbook. `book pictures` draws the chronograms of
//! the page of function blocks anew; a test fails while they are not those of its charts.
#![allow(clippy::disallowed_methods, reason = "it reads and writes the pages")]

use std::path::Path;
use std::process::ExitCode;

use g7_tests::book::{assemble, blocks, library};

fn main() -> ExitCode {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let done = match std::env::args().nth(1).as_deref() {
        Some("pictures") => pictures(&root),
        Some(folder) => assemble(&root, Path::new(folder)),
        None => Err("a folder, or `pictures`".into()),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(why) => {
            eprintln!("book: {why}");
            ExitCode::FAILURE
        }
    }
}

fn pictures(root: &Path) -> Result<(), String> {
    let page = root.join(blocks::PAGE);
    let text = std::fs::read_to_string(&page).map_err(|e| format!("{}: {e}", page.display()))?;
    for section in blocks::sections(&text)? {
        let file = page.with_file_name(section.picture());
        std::fs::write(&file, section.chronogram()?).map_err(|e| format!("{}: {e}", file.display()))?;
    }
    for part in g7_rig::LIBRARY {
        let page = root.join(library::PAGES).join(format!("{}.md", part.name));
        let text = std::fs::read_to_string(&page).map_err(|e| format!("{}: {e}", page.display()))?;
        let drawn = library::chronogram(root, part.name, library::options(&text, part.name)?)?;
        let file = library::picture(root, part.name);
        std::fs::write(&file, drawn).map_err(|e| format!("{}: {e}", file.display()))?;
    }
    Ok(())
}
