//! Builds a list of the book's pages on problems, which the editor and `g7 explain` contain.

use std::fmt::Write;
use std::path::Path;
use std::{env, fs};

fn main() {
    let root = env::var("CARGO_MANIFEST_DIR").unwrap_or_default();
    let folder = Path::new(&root).join("../../docs/book/src/problems");
    println!("cargo::rerun-if-changed={}", folder.display());
    let mut names: Vec<String> = fs::read_dir(&folder)
        .into_iter()
        .flatten()
        .flatten()
        .filter_map(|entry| entry.file_name().into_string().ok())
        .filter(|name| name.starts_with('G') && name.ends_with(".md"))
        .collect();
    names.sort();
    let mut table = String::from("&[\n");
    for name in &names {
        let path = folder.join(name);
        println!("cargo::rerun-if-changed={}", path.display());
        let id = name.trim_end_matches(".md");
        writeln!(table, "({id:?}, include_str!({:?})),", path.display().to_string()).unwrap_or(());
    }
    table.push(']');
    let out = env::var("OUT_DIR").unwrap_or_default();
    if let Err(e) = fs::write(Path::new(&out).join("pages.rs"), table) {
        println!("cargo::error=cannot write the list of pages: {e}");
    }
}
