//! The graph of situations as a picture.
//!
//! The situations stand one below the other in the order in which they are reached. Each edge is a
//! line of its own with its condition, so that no two texts meet; it runs to the rail of the
//! situation at which it ends. A rail is as long as the edges that join it need.

use std::fmt::Write;

use g7_verify::Kind;

use super::named::Named;

/// Height of an edge, distance of two boxes, margin, distance of two rails; in pixels.
const LINE: f64 = 20.0;
const GAP: f64 = 18.0;
const MARGIN: f64 = 24.0;
const RAIL: f64 = 12.0;
/// Width of a letter, with some room.
const LETTER: f64 = 7.2;
/// Colours of rails, dark enough for thin lines on white.
const COLOURS: [&str; 6] = ["#1f5a99", "#a8480f", "#2b7339", "#8a2a5d", "#5b4ba3", "#666666"];

/// A row: a situation with the edges that begin there.
struct Row {
    top: f64,
    height: f64,
    /// The labels of its edges, with the numbers of the rows at which they end.
    edges: Vec<(String, String, usize)>,
    /// Where the rail comes in, if one does.
    port: Option<f64>,
}

/// A vertical line to which all edges to one situation run.
struct Rail {
    to: usize,
    top: f64,
    bottom: f64,
    place: usize,
}

pub(super) fn svg(graph: &Named<'_>) -> String {
    let names: Vec<String> = graph.graph.nodes.iter().map(|n| graph.node(n)).collect();
    let rows = rows(graph, &names);
    let rails = rails(&rows);
    let wide = |texts: &mut dyn Iterator<Item = &String>| {
        texts.map(|t| t.chars().count()).max().unwrap_or(0) as f64 * LETTER
    };
    let right = MARGIN + (wide(&mut names.iter()) + 20.0).max(48.0);
    let first = right + wide(&mut rows.iter().flat_map(|r| r.edges.iter().map(|e| &e.0))) + 24.0;
    let x_of = |place: usize| first + place as f64 * RAIL;
    let most = rails.iter().map(|r| r.place).max().unwrap_or(0);
    let width = x_of(most) + MARGIN;
    let height = rows.last().map_or(0.0, |r| r.top + r.height) + MARGIN;
    let mut out = String::new();
    // Writing to a text does not fail.
    let _text = writeln!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"g7-graph\" width=\"{width:.0}\" height=\"{height:.0}\" \
         viewBox=\"0 0 {width:.0} {height:.0}\" font-family=\"sans-serif\" font-size=\"12\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>"
    );
    for rail in &rails {
        let (x, colour) = (x_of(rail.place), colour(rail.to));
        let Some(port) = rows.get(rail.to).and_then(|r| r.port) else { continue };
        let (top, bottom) = (rail.top.min(port), rail.bottom.max(port));
        let _text = writeln!(
            out,
            "<path d=\"M{x:.0} {top:.0}V{bottom:.0}M{x:.0} {port:.0}H{right:.0}\" fill=\"none\" stroke=\"{colour}\"/>\
             <path d=\"M{right:.0} {port:.0}l8 -4v8z\" fill=\"{colour}\"/>"
        );
    }
    for (node, (row, name)) in graph.graph.nodes.iter().zip(rows.iter().zip(&names)) {
        boxed(
            &mut out,
            node.kind,
            row,
            name,
            [MARGIN, right],
            &format!("states: {}; scans from the start: {}", node.states, node.scans),
        );
        for (number, (label, tip, to)) in row.edges.iter().enumerate() {
            let y = row.top + (number as f64 + 0.75) * LINE;
            let x = rails.iter().find(|r| r.to == *to).map_or(right, |r| x_of(r.place));
            let colour = colour(*to);
            let _text = writeln!(
                out,
                "<g><title>{}</title><path d=\"M{right:.0} {y:.0}H{x:.0}\" stroke=\"{colour}\"/>\
                 <circle cx=\"{x:.0}\" cy=\"{y:.0}\" r=\"2.5\" fill=\"{colour}\"/>\
                 <text x=\"{:.0}\" y=\"{:.0}\" font-size=\"11\">{}</text></g>",
                escaped(tip),
                right + 12.0,
                y - 4.0,
                escaped(label)
            );
        }
    }
    out.push_str("</svg>\n");
    out
}

fn colour(to: usize) -> &'static str {
    COLOURS.get(to % COLOURS.len()).copied().unwrap_or("black")
}

/// A situation; the start is a dot, a fault is red.
fn boxed(out: &mut String, kind: Kind, row: &Row, name: &str, [left, right]: [f64; 2], tip: &str) {
    let middle = row.top + row.height / 2.0;
    let _text = match kind {
        Kind::Start => writeln!(
            out,
            "<path d=\"M{:.0} {middle:.0}H{right:.0}\" stroke=\"black\"/>\
            <circle cx=\"{:.0}\" cy=\"{middle:.0}\" r=\"6\"/>\
            <path d=\"M{right:.0} {:.0}V{:.0}\" stroke=\"black\"/>",
            right - 14.0,
            right - 20.0,
            row.top,
            row.top + row.height
        ),
        Kind::Situation | Kind::Fault(_) => writeln!(
            out,
            "<g><title>{}</title><rect x=\"{left:.0}\" y=\"{:.0}\" width=\"{:.0}\" height=\"{:.0}\" \
             fill=\"{}\" stroke=\"black\"/><text x=\"{:.1}\" y=\"{:.0}\" text-anchor=\"middle\">{}</text></g>",
            escaped(tip),
            row.top,
            right - left,
            row.height,
            if kind == Kind::Situation { "#f4f4f4" } else { "#ffd9d0" },
            (left + right) / 2.0,
            middle + 4.0,
            escaped(name)
        ),
    };
}

fn rows(graph: &Named<'_>, names: &[String]) -> Vec<Row> {
    let edges = &graph.graph.edges;
    let (mut rows, mut top) = (Vec::new(), MARGIN);
    for at in 0..graph.graph.nodes.len() {
        let mine = edges.iter().filter(|e| e.from == at).map(|e| {
            let to = names.get(e.to).map_or("", String::as_str);
            (format!("{} → {to}", graph.label(e)), graph.transitions(e).join(", "), e.to)
        });
        let mine: Vec<_> = mine.collect();
        let comes_in = edges.iter().any(|e| e.to == at);
        let lines = mine.len() + usize::from(comes_in);
        let height = lines.max(1) as f64 * LINE + LINE / 4.0;
        let port = comes_in.then_some(top + (mine.len() as f64 + 0.75) * LINE);
        rows.push(Row { top, height, edges: mine, port });
        top += height + GAP;
    }
    rows
}

/// The rails, each in the first place from the left where it meets no other one; short ones come
/// first.
fn rails(rows: &[Row]) -> Vec<Rail> {
    let mut rails: Vec<Rail> = Vec::new();
    for (to, row) in rows.iter().enumerate() {
        let Some(port) = row.port else { continue };
        let mut rail = Rail { to, top: port, bottom: port, place: 0 };
        for from in rows {
            for (number, _) in from.edges.iter().enumerate().filter(|(_, e)| e.2 == to) {
                let y = from.top + (number as f64 + 0.75) * LINE;
                rail.top = rail.top.min(y);
                rail.bottom = rail.bottom.max(y);
            }
        }
        rails.push(rail);
    }
    rails.sort_by(|a, b| (a.bottom - a.top).total_cmp(&(b.bottom - b.top)));
    let mut placed: Vec<Rail> = Vec::new();
    for mut rail in rails {
        let meets = |place: usize| {
            placed
                .iter()
                .any(|o| o.place == place && o.top < rail.bottom + LINE && rail.top < o.bottom + LINE)
        };
        rail.place = (0..).find(|place| !meets(*place)).unwrap_or(0);
        placed.push(rail);
    }
    placed
}

fn escaped(text: &str) -> String {
    crate::testing::escape(text)
}
