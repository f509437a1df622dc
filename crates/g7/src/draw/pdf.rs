//! Sheets as one PDF: a page for each, with an outline and the document's information. Texts are texts.

use std::collections::HashMap;

use g7_dossier::{Dossier, Entry, Head};
use g7_draw::{MM, Options, Paper, Rect as Box};
use g7_model::say;
use pdf_writer::{Chunk, Content, Finish, Name, Pdf, Rect, Ref, TextStr};

use super::paper::tree;
use crate::failure::{Failure, raw};
use crate::files;

/// Points in a millimetre.
const POINTS: f32 = 72.0 / 25.4;

/// Gives each object of the PDF a number of its own.
struct Numbers {
    next: Ref,
}

impl Numbers {
    fn bump(&mut self) -> Ref {
        self.next.bump()
    }

    /// A picture with numbers of this file.
    fn picture(&mut self, svg: &str) -> Result<(Chunk, Ref), Failure> {
        let made = svg2pdf::to_chunk(&tree(svg)?, svg2pdf::ConversionOptions::default());
        let (chunk, root) =
            made.map_err(|e| Failure::Usage(say!("the PDF cannot be made: {e}", e = raw(e))))?;
        let mut known: HashMap<Ref, Ref> = HashMap::new();
        let chunk = chunk.renumber(|old| *known.entry(old).or_insert_with(|| self.next.bump()));
        let root = known.get(&root).copied().unwrap_or(root);
        Ok((chunk, root))
    }
}

/// The bytes of the PDF.
pub(crate) fn pdf(dossier: &Dossier, head: &Head) -> Result<Vec<u8>, Failure> {
    let mut numbers = Numbers { next: Ref::new(1) };
    let (catalog, tree, info) = (numbers.bump(), numbers.bump(), numbers.bump());
    let pages: Vec<Ref> = dossier.pages.iter().map(|_| numbers.bump()).collect();
    let mut pdf = Pdf::new();
    let outline = outline(&mut pdf, &mut numbers, &dossier.outline, &pages);
    let mut root = pdf.catalog(catalog);
    root.pages(tree);
    if let Some(outline) = outline {
        root.outlines(outline).page_mode(pdf_writer::types::PageMode::UseOutlines);
    }
    root.finish();
    pdf.pages(tree).kids(pages.iter().copied()).count(i32::try_from(pages.len()).unwrap_or(i32::MAX));
    let options = Options { font: false, ..Options::default() };
    for ((number, page), at) in (1..).zip(&dossier.pages).zip(&pages) {
        let mut placed: Vec<(String, [f32; 4])> = vec![(page.svg(&options), whole(dossier.paper))];
        for picture in dossier.pictures.iter().filter(|p| p.page == number) {
            let svg = String::from_utf8_lossy(&picture.svg).into_owned();
            placed.push((svg, points(dossier.paper, picture.at)));
        }
        sheet(&mut pdf, &mut numbers, *at, tree, dossier.paper, &placed)?;
    }
    let mut about = pdf.document_info(info);
    about.title(TextStr(&dossier.title)).creator(TextStr("G7")).producer(TextStr("G7"));
    if !head.author.is_empty() {
        about.author(TextStr(&head.author));
    }
    about.finish();
    let mut bytes = pdf.finish();
    in_order(&mut bytes);
    Ok([bytes.as_slice(), files::PDF_MARK].concat())
}

/// Sorts the entries of each list of resources: svg2pdf writes them in the order of a hash. The length of a list stays,
/// so every object stays at its place.
fn in_order(pdf: &mut Vec<u8>) {
    let lines: Vec<&[u8]> = pdf.split(|b| *b == b'\n').collect();
    let is_entry = |line: &&[u8]| {
        line.trim_ascii_start().starts_with(b"/") && line.ends_with(b" 0 R") && line.len() < 40
    };
    let mut out: Vec<&[u8]> = Vec::with_capacity(lines.len());
    for run in lines.chunk_by(|a, b| is_entry(a) && is_entry(b)) {
        let first = out.len();
        out.extend(run);
        // Names of one kind: `/gs1 33 0 R`.
        let numbered = |line: &&[u8]| {
            line.split(|b| *b == b' ').rev().nth(3).is_some_and(|n| n.last().is_some_and(u8::is_ascii_digit))
        };
        if run.len() > 1 && run.iter().all(numbered) {
            out.get_mut(first..).into_iter().for_each(<[&[u8]]>::sort_unstable);
        }
    }
    *pdf = out.join(&b'\n');
}

fn whole(paper: Paper) -> [f32; 4] {
    let [w, h] = paper.mm().map(|side| side as f32 * POINTS);
    [w, h, 0.0, 0.0]
}

/// Width, height, left and lower edge of a box of a sheet, in points.
fn points(paper: Paper, at: Box) -> [f32; 4] {
    let point = |n: i32| n as f32 / MM as f32 * POINTS;
    let [_, h, ..] = whole(paper);
    [point(at.w), point(at.h), point(at.x), h - point(at.y + at.h)]
}

/// Writes a page with pictures, each at its place.
fn sheet(
    pdf: &mut Pdf,
    numbers: &mut Numbers,
    at: Ref,
    tree: Ref,
    paper: Paper,
    placed: &[(String, [f32; 4])],
) -> Result<(), Failure> {
    let mut content = Content::new();
    let mut chunks: Vec<(String, Chunk, Ref)> = Vec::new();
    for (n, (svg, [w, h, x, y])) in placed.iter().enumerate() {
        let (chunk, root) = numbers.picture(svg)?;
        let name = format!("P{n}");
        content.save_state();
        content.transform([*w, 0.0, 0.0, *h, *x, *y]).x_object(Name(name.as_bytes()));
        content.restore_state();
        chunks.push((name, chunk, root));
    }
    let text = numbers.bump();
    let [w, h, ..] = whole(paper);
    let mut page = pdf.page(at);
    page.media_box(Rect::new(0.0, 0.0, w, h)).parent(tree).contents(text);
    let mut resources = page.resources();
    let mut objects = resources.x_objects();
    for (name, _, root) in &chunks {
        objects.pair(Name(name.as_bytes()), root);
    }
    objects.finish();
    resources.finish();
    page.finish();
    pdf.stream(text, &content.finish());
    chunks.iter().for_each(|(_, chunk, _)| pdf.extend(chunk));
    Ok(())
}

/// Writes the outline; a section stands under the part before it.
fn outline(pdf: &mut Pdf, numbers: &mut Numbers, entries: &[Entry], pages: &[Ref]) -> Option<Ref> {
    let root = (!entries.is_empty()).then(|| numbers.bump())?;
    let ids: Vec<Ref> = entries.iter().map(|_| numbers.bump()).collect();
    let mut parent: Vec<Option<usize>> = Vec::new();
    let mut part = None;
    for (n, e) in entries.iter().enumerate() {
        parent.push(part.filter(|_| e.level > 0));
        if e.level == 0 {
            part = Some(n);
        }
    }
    let children = |of: Option<usize>| -> Vec<usize> {
        parent.iter().enumerate().filter(|(_, p)| **p == of).map(|(n, _)| n).collect()
    };
    let id = |n: Option<&usize>| n.and_then(|n| ids.get(*n)).copied();
    let top = children(None);
    let mut outline = pdf.outline(root);
    outline.first(id(top.first()).unwrap_or(root)).last(id(top.last()).unwrap_or(root));
    outline.count(i32::try_from(top.len()).unwrap_or(i32::MAX));
    outline.finish();
    let mut under: Vec<(Option<usize>, Vec<usize>)> = vec![(None, top.clone())];
    under.extend(top.iter().map(|n| (Some(*n), children(Some(*n)))));
    for (of, list) in &under {
        for (k, n) in list.iter().enumerate() {
            let (Some(entry), Some(at)) = (entries.get(*n), id(Some(n))) else { continue };
            let mut item = pdf.outline_item(at);
            item.title(TextStr(&entry.title)).parent(of.and_then(|of| id(Some(&of))).unwrap_or(root));
            if let Some(before) = k.checked_sub(1).and_then(|k| id(list.get(k))) {
                item.prev(before);
            }
            if let Some(next) = id(list.get(k + 1)) {
                item.next(next);
            }
            let below = under.iter().find(|(of, _)| *of == Some(*n)).map(|(_, list)| list);
            if let Some((first, last)) = below.and_then(|l| Some((id(l.first())?, id(l.last())?))) {
                // Closed: the number of what would appear is negative.
                let count = below.map_or(0, |l| i32::try_from(l.len()).unwrap_or(i32::MAX));
                item.first(first).last(last).count(-count);
            }
            if let Some(page) = pages.get(entry.page.saturating_sub(1)) {
                item.dest().page(*page).fit();
            }
        }
    }
    Some(root)
}
