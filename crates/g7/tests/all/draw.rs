//! `g7 draw`: complete pictures in the requested format, or none.
#![allow(missing_docs, reason = "a test")]
#![allow(clippy::disallowed_methods, reason = "tests look at what was written")]

use crate::common;

use common::Folder;

const TWO: &str = "\
chart Fill \"the upper one\" {
  initial step 1
  step 2 { N pump }

  1 -> 2 when start
  2 -> 1 when not start
}

chart Drain {
  initial step 1
}
";

#[test]
fn a_picture_goes_to_the_standard_output_as_svg() {
    let folder = Folder::with(TWO);
    let svg = folder.g7(&["draw"]).is(0).out.clone();
    assert!(svg.starts_with("<svg") && svg.ends_with("</svg>\n"));
    for text in [">Fill<", ">Drain<", ">the upper one<", ">pump<", "font/ttf;base64,"] {
        assert!(svg.contains(text), "{text}");
    }
    assert_eq!(folder.g7(&["draw", "chart.g7"]).is(0).out, svg, "the same again, byte for byte");
}

#[test]
fn one_chart_alone_has_no_title_and_nothing_of_the_other() {
    let folder = Folder::with(TWO);
    let svg = folder.g7(&["draw", "--chart", "Drain"]).is(0).out.clone();
    assert!(!svg.contains(">pump<") && !svg.contains("g7-title\" x"));
    folder.g7(&["draw", "--chart", "Nowhere"]).is_refused(&["Nowhere", "Fill, Drain"]);
}

#[test]
fn charts_of_files_that_are_used_are_drawn_as_well() {
    let folder = Folder::with("use 'lib/drain.g7'\nuse gemma\n\nchart Fill {\n  initial step 1\n}\n");
    folder.write("lib/drain.g7", "chart Drain {\n  initial step 7\n}\n");
    folder.g7(&["draw", "-o", "pictures/"]).is(0);
    let mut names: Vec<String> = std::fs::read_dir(folder.path("pictures"))
        .expect("the folder")
        .map(|entry| entry.expect("a file").file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    assert_eq!(names, ["Drain.svg", "Fill.svg"], "and none of the library");
    assert!(folder.g7(&["draw", "--chart", "Gemma"]).is(0).out.contains(">F1"));
    folder.write("lib/drain.g7", "chart Drain {\n  initial step\n}\n");
    let run = folder.g7(&["draw"]);
    assert!(run.is(1).err.contains("drain.g7:2"), "{}", run.err);
}

#[test]
fn the_name_of_the_output_says_the_form() {
    let folder = Folder::with(TWO);
    for (name, magic) in
        [("a.png", &b"\x89PNG\r\n"[..]), ("a.pdf", b"%PDF-"), ("a.svg", b"<svg"), ("b.SVG", b"<svg")]
    {
        folder.g7(&["draw", "-o", name]).is(0);
        let bytes = std::fs::read(folder.path(name)).expect("the picture");
        assert!(bytes.starts_with(magic), "{name}");
    }
    folder.g7(&["draw", "-o", "a.bmp"]).is_refused(&["a.bmp", ".svg", "--as"]);
    folder.g7(&["draw", "-o", "picture", "--as", "pdf"]).is(0);
    assert!(std::fs::read(folder.path("picture")).expect("the picture").starts_with(b"%PDF-"));
}

#[test]
fn a_png_is_as_large_as_the_scale_says() {
    let folder = Folder::with(TWO);
    let width = |scale: &str| {
        folder.g7(&["draw", "-o", "a.png", "--scale", scale]).is(0);
        let bytes = std::fs::read(folder.path("a.png")).expect("the picture");
        u32::from_be_bytes(bytes[16..20].try_into().expect("four bytes"))
    };
    let (one, three) = (width("1"), width("3"));
    assert!(three.abs_diff(3 * one) <= 3, "{one} {three}");
    let refused = folder.g7(&["draw", "--scale", "0"]);
    assert!(refused.is(2).err.contains("a number from 0.1 to 16"));
}

#[test]
fn a_folder_takes_a_file_for_each_chart() {
    let folder = Folder::with(TWO);
    folder.g7(&["draw", "-o", "pictures/"]).is(0);
    folder.g7(&["draw", "-o", "pictures", "--as", "png"]).is(0);
    let mut names: Vec<String> = std::fs::read_dir(folder.path("pictures"))
        .expect("the folder")
        .map(|e| e.expect("an entry").file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    assert_eq!(names, ["Drain.png", "Drain.svg", "Fill.png", "Fill.svg"]);
}

#[test]
fn two_charts_never_go_to_one_file() {
    let folder = Folder::with("chart `a b` { initial step 1 } chart `a.b` { initial step 1 }");
    folder.g7(&["draw", "-o", "out/"]).is_refused(&["a_b.svg"]);
    assert_eq!(folder.names(), ["chart.g7"], "nothing is written");
}

#[test]
fn a_file_that_cannot_be_read_is_not_drawn() {
    let folder = Folder::with("chart G { initial step 1 1 -> 1 when ( }");
    let ran = folder.g7(&["draw", "-o", "a.svg"]);
    assert!(ran.is(1).err.contains("error[G0"));
    assert_eq!(folder.names(), ["chart.g7"]);
    let folder = Folder::with("input a : BOOL");
    folder.g7(&["draw"]).is_refused(&["no chart"]);
}

#[test]
fn options_change_what_is_drawn() {
    let folder = Folder::with(TWO);
    let svg = |options: &[&str]| folder.g7(&[&["draw"], options].concat()).is(0).out.clone();
    assert!(!svg(&["--no-actions"]).contains(">pump<"));
    assert!(svg(&["--look", "sfc"]).contains(">N</text>"));
    assert!(svg(&["--pages", "pl7"]).contains(">1 / 1<"));
    assert_ne!(svg(&["--dark"]), svg(&[]));
}

/// The texts of a picture, sorted, wherever they stand.
fn texts(svg: &str) -> Vec<&str> {
    let pieces = svg.split("<text").skip(1);
    let mut texts: Vec<&str> = pieces.filter_map(|p| p.split_once('>')?.1.split('<').next()).collect();
    texts.sort_unstable();
    texts
}

#[test]
fn the_picture_in_the_book_shows_the_chart_beside_it() {
    let book = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/book/src/drawing/");
    let drawn = Folder::new().g7(&["draw", &format!("{book}symbols.g7")]).is(0).out.clone();
    let kept = std::fs::read_to_string(format!("{book}symbols.svg")).expect("the picture in the book");
    assert_eq!(texts(&kept), texts(&drawn), "make it again: g7 draw symbols.g7 -o symbols.svg");
    assert!(texts(&kept).len() > 60);
}
