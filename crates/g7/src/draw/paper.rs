//! The formats of pictures, and the conversion of SVG to each.

use std::path::Path;
use std::sync::Arc;

use clap::ValueEnum;
use resvg::{tiny_skia, usvg};

use g7_model::say;

use crate::failure::{Failure, raw};
use crate::files;

/// Greatest number of pixels of a PNG: it takes 400 MB of memory.
const MOST_PIXELS: f64 = 1e8;

/// The format of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Form {
    Svg,
    Png,
    Pdf,
    /// A file that draw.io edits, with a page for each chart.
    Drawio,
}

impl Form {
    pub(super) fn ending(self) -> &'static str {
        match self {
            Form::Svg => "svg",
            Form::Png => "png",
            Form::Pdf => "pdf",
            Form::Drawio => "drawio",
        }
    }

    pub(super) fn of(path: &Path) -> Option<Form> {
        let ending = path.extension()?.to_str()?.to_ascii_lowercase();
        [Form::Svg, Form::Png, Form::Pdf, Form::Drawio].into_iter().find(|f| f.ending() == ending)
    }
}

/// The bytes of a picture in a format.
pub(super) fn print(form: Form, svg: String, scale: f32) -> Result<Vec<u8>, Failure> {
    match form {
        // A file of draw.io is made of the chart, not of its picture.
        Form::Svg | Form::Drawio => Ok(svg.into_bytes()),
        Form::Png => png(&tree(&svg)?, scale),
        Form::Pdf => pdf(&tree(&svg)?),
    }
}

/// Parses the SVG; texts use only the bundled font.
pub(super) fn tree(svg: &str) -> Result<usvg::Tree, Failure> {
    let mut fonts = usvg::fontdb::Database::new();
    fonts.load_font_data(g7_draw::font().to_vec());
    fonts.set_sans_serif_family(g7_draw::FONT_FAMILY);
    let options = usvg::Options {
        font_family: g7_draw::FONT_FAMILY.to_owned(),
        fontdb: Arc::new(fonts),
        ..usvg::Options::default()
    };
    usvg::Tree::from_str(svg, &options)
        .map_err(|e| Failure::Usage(say!("the picture cannot be set: {e}", e = raw(&e))))
}

fn png(tree: &usvg::Tree, scale: f32) -> Result<Vec<u8>, Failure> {
    let size = tree.size();
    let (w, h) = ((size.width() * scale).ceil(), (size.height() * scale).ceil());
    let too_large = || {
        Failure::Usage(say!(
            "a PNG of {w} × {h} pixels is too large; a smaller --scale, one --chart, or .svg and .pdf are not"
        ))
    };
    if f64::from(w) * f64::from(h) > MOST_PIXELS {
        return Err(too_large());
    }
    let mut pixels = tiny_skia::Pixmap::new(w as u32, h as u32).ok_or_else(too_large)?;
    resvg::render(tree, tiny_skia::Transform::from_scale(scale, scale), &mut pixels.as_mut());
    let bytes =
        pixels.encode_png().map_err(|e| Failure::Usage(say!("the PNG cannot be made: {e}", e = raw(&e))))?;
    Ok(signed(bytes))
}

/// Where the first chunk of a PNG, its header, ends.
const HEADER_END: usize = 8 + 4 + 4 + 13 + 4;

/// Adds the chunk that says which program made a PNG, by which g7 knows its own pictures again.
fn signed(png: Vec<u8>) -> Vec<u8> {
    let Some((head, rest)) = png.split_at_checked(HEADER_END) else { return png };
    let chunk = b"tEXtSoftware\0g7";
    let mut check = flate2::Crc::new();
    check.update(chunk);
    // The length is that of the text alone, without the name of the chunk.
    let length = (chunk.len() as u32 - 4).to_be_bytes();
    [head, &length, chunk, &check.sum().to_be_bytes(), rest].concat()
}

fn pdf(tree: &usvg::Tree) -> Result<Vec<u8>, Failure> {
    svg2pdf::to_pdf(tree, svg2pdf::ConversionOptions::default(), svg2pdf::PageOptions::default())
        .map(|bytes| [bytes.as_slice(), files::PDF_MARK].concat())
        .map_err(|e| Failure::Usage(say!("the PDF cannot be made: {e}", e = raw(e))))
}
