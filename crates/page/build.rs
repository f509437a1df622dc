//! Builds a list of the book's pages on problems, which `g7 explain` and the language server print; takes the names of
//! functions out of modules of wasm.
//!
//! They stand in `docs/book` in three languages. The page fetches them itself when they are asked for
//! (`web/src/text/explain.ts`), so its modules of wasm use nothing of the list and do not contain it.

use std::fmt::Write;
use std::path::Path;
use std::{env, fs};

/// The languages of the pages, each with its folder in `docs/book`. English is first.
const LANGUAGES: [(&str, &str); 3] = [("en", "src/problems"), ("fr", "fr/problems"), ("pt", "pt/problems")];

fn main() {
    let root = env::var("CARGO_MANIFEST_DIR").unwrap_or_default();
    let mut table = String::from("&[\n");
    for (language, folder) in LANGUAGES {
        list(language, &Path::new(&root).join("../../docs/book").join(folder), &mut table);
    }
    table.push(']');
    let out = env::var("OUT_DIR").unwrap_or_default();
    if let Err(e) = fs::write(Path::new(&out).join("pages.rs"), table) {
        println!("cargo::error=cannot write the list of pages: {e}");
    }
    // `strip` of a profile does not reach a crate that has settings of its own there, as this one has. `G7_NAMES`
    // keeps the names of functions, for a profiler.
    println!("cargo::rerun-if-env-changed=G7_NAMES");
    let in_browser = env::var("CARGO_CFG_TARGET_ARCH").is_ok_and(|arch| arch == "wasm32");
    if in_browser && env::var_os("G7_NAMES").is_none() {
        println!("cargo::rustc-link-arg-cdylib=--strip-all");
    }
}

/// A row for each page of a folder, in the order of the codes.
fn list(language: &str, folder: &Path, table: &mut String) {
    println!("cargo::rerun-if-changed={}", folder.display());
    let mut names: Vec<String> = fs::read_dir(folder)
        .into_iter()
        .flatten()
        .flatten()
        .filter_map(|entry| entry.file_name().into_string().ok())
        .filter(|name| name.starts_with('G') && name.ends_with(".md"))
        .collect();
    names.sort();
    for name in &names {
        let path = folder.join(name);
        println!("cargo::rerun-if-changed={}", path.display());
        let id = name.trim_end_matches(".md");
        let text = path.display().to_string();
        writeln!(table, "({language:?}, {id:?}, include_str!({text:?})),").unwrap_or(());
    }
}
