//! Checks that nothing overlaps: draws every example and every importable chart of the corpus and
//! compares boxes and lines.

use std::path::{Path, PathBuf};

use g7_model::{Document, FileId, Severity, Span};

use crate::text::width;
use crate::{Bends, Drawing, End, Item, Look, Options, Part, Picture, Rect, draw};

/// The boxes, texts and lines that an item covers.
#[derive(Default)]
struct Seen {
    boxes: Vec<Rect>,
    /// Double lines; they are listed among the boxes too.
    doubles: Vec<Rect>,
    texts: Vec<(Rect, String)>,
    lines: Vec<Rect>,
}

fn attribute<'a>(tag: &'a str, name: &str) -> &'a str {
    let key = format!(" {name}=\"");
    let start = tag.find(&key).unwrap_or_else(|| panic!("{name} in {tag}")) + key.len();
    tag[start..].split('"').next().unwrap_or("")
}

fn number(text: &str) -> i32 {
    (text.parse::<f64>().unwrap_or_else(|_| panic!("{text}")) * 10.0).round() as i32
}

fn plain(text: &str) -> String {
    text.replace("&lt;", "<").replace("&gt;", ">").replace("&quot;", "\"").replace("&amp;", "&")
}

/// The segments of path data, each as the box between its two end points.
fn pieces(d: &str) -> Vec<Rect> {
    let mut out: Vec<Rect> = Vec::new();
    let (mut x, mut y) = (0, 0);
    let starts: Vec<usize> =
        d.char_indices().filter(|(_, c)| c.is_ascii_alphabetic()).map(|(i, _)| i).collect();
    for (k, at) in starts.iter().enumerate() {
        let end = starts.get(k + 1).copied().unwrap_or(d.len());
        let values: Vec<i32> = d[at + 1..end].split(' ').filter(|t| !t.is_empty()).map(number).collect();
        let (px, py) = (x, y);
        match (&d[*at..at + 1], values.as_slice()) {
            ("M" | "L", [a, b]) => (x, y) = (*a, *b),
            ("H", [a]) => x = *a,
            ("V", [b]) => y = *b,
            ("Z", []) => {}
            other => panic!("{other:?}"),
        }
        if &d[*at..at + 1] != "M" {
            out.push(Rect { x: x.min(px), y: y.min(py), w: (x - px).abs(), h: (y - py).abs() });
        }
    }
    out
}

fn seen(item: &Item) -> Seen {
    let mut seen = Seen::default();
    for tag in item.picture.svg().split('<').skip(1) {
        let rect = || {
            let of = |name| number(attribute(tag, name));
            Rect { x: of("x"), y: of("y"), w: of("width"), h: of("height") }
        };
        match tag.split(' ').next().unwrap_or("") {
            "rect" if !tag.contains("g7-frame") => {
                seen.boxes.push(rect());
                seen.doubles.extend(tag.contains("g7-paper").then(rect));
            }
            "text" => {
                let size = number(attribute(tag, "font-size"));
                let text = plain(tag.split_once('>').map_or("", |t| t.1));
                let (x, y) = (number(attribute(tag, "x")), number(attribute(tag, "y")));
                // From the height of capitals to the base line: an accent may touch a line.
                let r = Rect { x, y: y - size * 70 / 100, w: width(&text, size), h: size * 75 / 100 };
                seen.texts.push((r, text));
            }
            "path" if tag.contains("g7-link") || tag.contains("g7-double") => {
                seen.lines.extend(pieces(attribute(tag, "d")));
            }
            _ => {}
        }
    }
    seen
}

/// True if a line runs through the inside of a box and not only along its edge.
fn cuts(line: &Rect, r: &Rect) -> bool {
    line.x < r.x + r.w - 1 && line.x + line.w > r.x + 1 && line.y < r.y + r.h - 1 && line.y + line.h > r.y + 1
}

/// True if a link or connector starts or ends at this transition.
fn belongs(link: &Part, of: &Part) -> bool {
    match (link, of) {
        (
            Part::Link { from, to, .. } | Part::Connector { from, to, .. },
            Part::Transition { transition, .. },
        ) => [from, to].contains(&&End::Transition(*transition)),
        _ => false,
    }
}

fn faults(drawing: &Drawing) -> Vec<String> {
    let all: Vec<Seen> = drawing.items.iter().map(seen).collect();
    let mut faults = Vec::new();
    for (i, a) in all.iter().enumerate() {
        for (j, (r, text)) in a.texts.iter().enumerate() {
            for (k, b) in all.iter().enumerate() {
                let later = |l: usize| k > i || (k == i && l > j);
                for (l, (o, other)) in b.texts.iter().enumerate() {
                    if later(l) && r.overlaps(o) {
                        faults.push(format!("«{text}» over «{other}» at {r:?}"));
                    }
                }
                if k != i && b.boxes.iter().any(|o| o.overlaps(r)) {
                    faults.push(format!("«{text}» over the box of {:?}", drawing.items[k].part));
                }
                if b.lines.iter().any(|o| cuts(o, r)) {
                    faults.push(format!("«{text}» at {r:?} is crossed by {:?}", drawing.items[k].part));
                }
            }
        }
        for (k, b) in all.iter().enumerate().filter(|(k, _)| *k != i) {
            let part = |n: usize| &drawing.items[n].part;
            if k > i && a.boxes.iter().any(|r| b.boxes.iter().any(|o| r.overlaps(o))) {
                faults.push(format!("{:?} over {:?}", part(i), part(k)));
            }
            // A link ends at a double line or keeps its distance from it.
            let through = |l: &Rect, r: &Rect| cuts(l, r) && l.y + 20 < r.y && l.y + l.h > r.y + r.h + 20;
            if !belongs(part(k), part(i)) && a.doubles.iter().any(|r| b.lines.iter().any(|l| through(l, r))) {
                faults.push(format!("the double line of {:?} is crossed by {:?}", part(i), part(k)));
            }
            let square = matches!(part(i), Part::Step { .. } | Part::Action { .. });
            if square && a.boxes.iter().any(|r| b.lines.iter().any(|l| cuts(l, r))) {
                faults.push(format!("{:?} is crossed by {:?}", part(i), part(k)));
            }
        }
    }
    faults
}

/// Collects the files of a folder with this ending, or all its files.
fn files(folder: &Path, ending: Option<&str>, found: &mut Vec<PathBuf>) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    let mut paths: Vec<PathBuf> = entries.filter_map(|e| e.ok().map(|e| e.path())).collect();
    paths.sort();
    for path in paths {
        if path.is_dir() {
            files(&path, ending, found);
        } else if ending.is_none_or(|ending| path.extension().is_some_and(|e| e == ending)) {
            found.push(path);
        }
    }
}

fn document(path: &Path) -> Option<Document> {
    let bytes = std::fs::read(path).ok()?;
    let name = path.to_string_lossy();
    let (document, problems) = if let Some(format) = g7_exchange::recognise(&name, &bytes) {
        format.read(&bytes, FileId(0)).expect("a format that is recognised is read")
    } else if name.ends_with(".g7") {
        g7_syntax::parse_bytes(&bytes, FileId(0))
    } else {
        return None;
    };
    // This test judges automatic layouts, so places that an author chose are removed.
    let mut document = document;
    document.items.retain(|i| !matches!(i, g7_model::Item::Layout(_)));
    problems.iter().all(|p| p.severity() != Severity::Error).then_some(document)
}

/// Draws every chart of every file with each set of options and reports the overlaps.
fn look(paths: &[PathBuf], ways: &[Options]) -> usize {
    let (mut charts, mut bad) = (0, String::new());
    for path in paths {
        let Some(document) = document(path) else { continue };
        for chart in document.charts() {
            for options in ways {
                charts += 1;
                let drawing = draw(&document, chart, options);
                let found = faults(&drawing);
                for fault in found.iter().take(6) {
                    bad.push_str(&format!("{}: {}: {fault}\n", path.display(), chart.name.text));
                }
            }
        }
    }
    assert!(bad.is_empty(), "{bad}");
    charts
}

fn ways() -> [Options; 4] {
    let plain = Options::default();
    [
        plain,
        Options { look: Look::Sfc, ..plain },
        Options { actions: false, ..plain },
        Options { pages: true, ..plain },
    ]
}

#[test]
fn nothing_overlaps_in_the_examples() {
    let mut paths = Vec::new();
    files(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples"), Some("g7"), &mut paths);
    let charts = look(&paths, &ways());
    assert!(charts >= 4 * 40, "{charts}");
}

/// Charts that people drew.
#[test]
fn nothing_overlaps_in_the_corpus() {
    let Some(corpus) = g7_peers::corpus("") else { return };
    let mut paths = Vec::new();
    files(&corpus, None, &mut paths);
    let charts = look(&paths, &ways());
    assert!(charts >= 4 * 100, "only {charts} charts in {} files", paths.len());
}

#[test]
fn what_lies_over_something_is_found() {
    let (document, _) =
        g7_syntax::parse("chart G { initial step 1 { N b } step 2 1 -> 2 when a }", FileId(0));
    let chart = document.charts().next().expect("a chart");
    let mut drawing = draw(&document, chart, &Options::default());
    assert!(faults(&drawing).is_empty());
    let twice = drawing.items.clone();
    drawing.items.extend(twice);
    let through =
        drawing.items.iter().find(|i| matches!(i.part, Part::Step { step: 0, .. })).expect("step 1").area;
    let (y, right) = (through.y + 100, through.x + through.w);
    let mut picture = Picture::default();
    picture.line("g7-link", &[(-9000, y), (right, y)]);
    let link = Item {
        part: Part::Link {
            link: 0,
            from: End::Step(0),
            to: End::Transition(0),
            held: None,
            bends: Bends::None,
            form: None,
        },
        picture,
        area: through,
        at: Span::default(),
    };
    drawing.items.push(link);
    let found = faults(&drawing);
    for what in ["«1» over «1»", "Step { step: 0", "Action { step: 0", "«a» over «a»", "is crossed by Link"]
    {
        assert!(found.iter().any(|f| f.contains(what)), "{what}: {found:?}");
    }
}
