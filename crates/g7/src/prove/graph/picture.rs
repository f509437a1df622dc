//! The graph of situations as a picture.
//!
//! A row has the situations that are reached by as many scans; no scan leads further than to the
//! next row, so only the ways back pass by others. Within a row the order follows the neighbours
//! (barycentres), which leaves few crossings in small graphs.

use std::fmt::Write;

use g7_verify::{Edge, Kind};

use super::Named;

/// Distance of two rows, height of a box, gap between two boxes, margin; in pixels.
const ROW: f64 = 96.0;
const BOX: f64 = 28.0;
const GAP: f64 = 44.0;
const MARGIN: f64 = 24.0;
/// Width of a letter, with some room.
const LETTER: f64 = 7.4;
/// Times that each row is put in order.
const SWEEPS: usize = 12;

struct Spot {
    x: f64,
    y: f64,
    half: f64,
}

pub(super) fn svg(graph: &Named<'_>) -> String {
    let rows = rows(graph);
    let spots = spots(graph, &rows);
    let widest = spots.iter().map(|s| s.x + s.half).fold(0.0, f64::max);
    let (lines, right) = edges(graph, &spots);
    let width = widest.max(right) + MARGIN;
    let height = rows.len() as f64 * ROW - (ROW - BOX) + 2.0 * MARGIN;
    let mut out = String::new();
    // Writing to a text does not fail.
    let _text = writeln!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.0}\" height=\"{height:.0}\" \
         viewBox=\"0 0 {width:.0} {height:.0}\" font-family=\"sans-serif\" font-size=\"12\">\n\
         <defs><marker id=\"tip\" viewBox=\"0 0 8 8\" refX=\"8\" refY=\"4\" markerWidth=\"8\" \
         markerHeight=\"8\" orient=\"auto\"><path d=\"M0 0L8 4L0 8z\"/></marker></defs>\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>"
    );
    out.push_str(&lines);
    for (node, spot) in graph.graph.nodes.iter().zip(&spots) {
        let (x, y) = (spot.x, spot.y);
        if node.kind == Kind::Start {
            let _text = writeln!(out, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"6\"/>");
            continue;
        }
        let fill = if node.kind == Kind::Situation { "#f4f4f4" } else { "#ffd9d0" };
        let (left, top, wide) = (x - spot.half, y - BOX / 2.0, 2.0 * spot.half);
        let _text = writeln!(
            out,
            "<g><title>{}</title><rect x=\"{left:.1}\" y=\"{top:.1}\" width=\"{wide:.1}\" height=\"{BOX}\" \
             fill=\"{fill}\" stroke=\"black\"/><text x=\"{x:.1}\" y=\"{:.1}\" \
             text-anchor=\"middle\">{}</text></g>",
            escaped(&format!("states: {}; scans from the start: {}", node.states, node.scans)),
            y + 4.0,
            escaped(&graph.node(node))
        );
    }
    out.push_str("</svg>\n");
    out
}

/// The nodes of each row, from left to right.
fn rows(graph: &Named<'_>) -> Vec<Vec<usize>> {
    let nodes = &graph.graph.nodes;
    let last = nodes.iter().map(|n| n.scans).max().unwrap_or(0);
    let mut rows = vec![Vec::new(); last + 1];
    for (id, node) in nodes.iter().enumerate() {
        if let Some(row) = rows.get_mut(node.scans) {
            row.push(id);
        }
    }
    let row_of = |id: usize| nodes.get(id).map_or(0, |n| n.scans);
    let mut near: Vec<Vec<usize>> = vec![Vec::new(); nodes.len()];
    for e in graph.graph.edges.iter().filter(|e| row_of(e.from).abs_diff(row_of(e.to)) == 1) {
        near.get_mut(e.from).into_iter().for_each(|n| n.push(e.to));
        near.get_mut(e.to).into_iter().for_each(|n| n.push(e.from));
    }
    let mut place = vec![0.0; nodes.len()];
    let note = |row: &[usize], place: &mut [f64]| {
        for (i, id) in row.iter().enumerate() {
            if let Some(p) = place.get_mut(*id) {
                *p = i as f64 - row.len() as f64 / 2.0;
            }
        }
    };
    rows.iter().for_each(|row| note(row, &mut place));
    for sweep in 0..SWEEPS {
        // Downwards, then upwards.
        let order: Vec<usize> =
            if sweep % 2 == 0 { (0..rows.len()).collect() } else { (0..rows.len()).rev().collect() };
        for at in order {
            let Some(row) = rows.get_mut(at) else { continue };
            let other = if sweep % 2 == 0 { at.checked_sub(1) } else { Some(at + 1) };
            let key = |id: usize| {
                let mine = near.get(id).into_iter().flatten().filter(|n| Some(row_of(**n)) == other);
                let places: Vec<f64> = mine.filter_map(|n| place.get(*n).copied()).collect();
                let own = place.get(id).copied().unwrap_or(0.0);
                if places.is_empty() { own } else { places.iter().sum::<f64>() / places.len() as f64 }
            };
            let mut keyed: Vec<(f64, usize)> = row.iter().map(|id| (key(*id), *id)).collect();
            keyed.sort_by(|a, b| a.0.total_cmp(&b.0));
            *row = keyed.into_iter().map(|(_, id)| id).collect();
            note(row, &mut place);
        }
    }
    rows
}

fn spots(graph: &Named<'_>, rows: &[Vec<usize>]) -> Vec<Spot> {
    let nodes = &graph.graph.nodes;
    let half = |id: usize| match nodes.get(id) {
        Some(node) if node.kind != Kind::Start => {
            (graph.node(node).chars().count() as f64 * LETTER / 2.0 + 8.0).max(24.0)
        }
        _ => 8.0,
    };
    let wide = |row: &[usize]| {
        row.iter().map(|id| 2.0 * half(*id)).sum::<f64>() + GAP * row.len().saturating_sub(1) as f64
    };
    let widest = rows.iter().map(|r| wide(r)).fold(0.0, f64::max);
    let mut spots: Vec<Spot> = nodes.iter().map(|_| Spot { x: 0.0, y: 0.0, half: 0.0 }).collect();
    for (at, row) in rows.iter().enumerate() {
        let mut x = MARGIN + (widest - wide(row)) / 2.0;
        for id in row {
            let half = half(*id);
            let y = MARGIN + BOX / 2.0 + at as f64 * ROW;
            if let Some(spot) = spots.get_mut(*id) {
                *spot = Spot { x: x + half, y, half };
            }
            x += 2.0 * half + GAP;
        }
    }
    spots
}

/// The edges, and the right end of what they need.
fn edges(graph: &Named<'_>, spots: &[Spot]) -> (String, f64) {
    let (mut paths, mut labels, mut right) = (String::new(), String::new(), 0.0f64);
    let mut count = vec![0usize; spots.len()];
    for e in &graph.graph.edges {
        let (Some(a), Some(b)) = (spots.get(e.from), spots.get(e.to)) else { continue };
        let number = count.get_mut(e.from).map_or(0, |n| std::mem::replace(n, *n + 1));
        let [p, q, r, s] = curve(e, a, b);
        // Labels of one node's edges stand at different heights.
        let t = 0.4 + 0.1 * (number % 3) as f64;
        let at = |i: usize| {
            let [p, q, r, s] = [p, q, r, s].map(|p: [f64; 2]| p.get(i).copied().unwrap_or(0.0));
            let u = 1.0 - t;
            u * u * u * p + 3.0 * u * u * t * q + 3.0 * u * t * t * r + t * t * t * s
        };
        let label = graph.label(e);
        let (x, y) = (at(0), at(1));
        right = right.max(x + label.chars().count() as f64 * LETTER / 2.0);
        let point = |p: [f64; 2]| format!("{:.1} {:.1}", p[0], p[1]);
        let _text = writeln!(
            paths,
            "<path d=\"M{} C{}, {}, {}\" fill=\"none\" stroke=\"#555\" marker-end=\"url(#tip)\"/>",
            point(p),
            point(q),
            point(r),
            point(s)
        );
        let _text = writeln!(
            labels,
            "<g><title>{}</title><text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"middle\" font-size=\"11\" \
             stroke=\"white\" stroke-width=\"4\" paint-order=\"stroke\">{}</text></g>",
            escaped(&graph.transitions(e).join(", ")),
            escaped(&label)
        );
    }
    (paths + &labels, right)
}

/// A cubic curve: down to the next row, beside the boxes back, or round from a box to itself.
fn curve(e: &Edge, a: &Spot, b: &Spot) -> [[f64; 2]; 4] {
    let (half, bend) = (BOX / 2.0, ROW / 2.0);
    if e.from == e.to {
        let x = a.x + a.half;
        [[x, a.y - 6.0], [x + 40.0, a.y - 24.0], [x + 40.0, a.y + 24.0], [x, a.y + 6.0]]
    } else if b.y > a.y {
        [[a.x, a.y + half], [a.x, a.y + bend], [b.x, b.y - bend], [b.x, b.y - half]]
    } else if b.y == a.y {
        let below = a.y + half + 34.0;
        [[a.x, a.y + half], [a.x, below], [b.x, below], [b.x, b.y + half]]
    } else {
        let out = (a.x + a.half).max(b.x + b.half) + 24.0 + (a.y - b.y) / 6.0;
        [[a.x + a.half, a.y], [out, a.y], [out, b.y], [b.x + b.half, b.y]]
    }
}

fn escaped(text: &str) -> String {
    crate::testing::escape(text)
}
