//! Makes room in a layout that comes from another tool, whose symbols have other sizes than ours.
//!
//! ```text
//! importer -> model::Document with layouts -> here -> text
//! ```
//!
//! Afterwards no symbol or text overlaps another because of a layout.

use std::collections::{BTreeMap, HashMap, HashSet};

use g7_model::{Chart, Document, Item, PlaceAt, Placed};

use crate::layout::rooms::{BAR, CLEAR, DOUBLE, LINK, SQUARE};
use crate::layout::section::{FAR, Named};
use crate::symbols::note_area;
use crate::{End, Extent, Options, Rect, Sizes, layout, measure};

/// Layouts with more symbols and comments than this are not spread.
const MOST: usize = 4_000;
/// Least distance between two symbols side by side.
const ASIDE: i64 = 150;

/// Spreads the places of each layout until no symbols overlap: rows move down and columns move
/// right, only as far as necessary, so that symbols in one line stay in one line. If symbols still
/// overlap, the layout is dropped and the chart is laid out automatically, with the comments beside
/// it.
pub fn make_room(document: &mut Document) {
    let mut charts: HashMap<&str, &Chart> = HashMap::new();
    for chart in document.charts() {
        charts.entry(&chart.name.text).or_insert(chart);
    }
    let roomy: Vec<Option<Vec<PlaceAt>>> = document
        .items
        .iter()
        .map(|item| match item {
            Item::Layout(l) => {
                let chart = charts.get(&*l.chart.text)?;
                Some(with_room(document, chart, &l.places))
            }
            _ => None,
        })
        .collect();
    let mut roomy = roomy.into_iter();
    document.items.retain_mut(|item| {
        let places = roomy.next().flatten();
        match (item, places) {
            (Item::Layout(l), Some(places)) => {
                l.places = places;
                !l.places.is_empty()
            }
            (Item::Layout(_), None) => false,
            _ => true,
        }
    });
}

fn with_room(document: &Document, chart: &Chart, places: &[PlaceAt]) -> Vec<PlaceAt> {
    let sizes = measure(document, chart, &Options::default());
    let clear = apart(chart, &sizes, places).filter(|p| is_clear(chart, &sizes, p));
    clear.unwrap_or_else(|| comments_beside(chart, &sizes, places))
}

/// Only the comments, one below the other at the right of the automatic layout.
fn comments_beside(chart: &Chart, sizes: &Sizes, places: &[PlaceAt]) -> Vec<PlaceAt> {
    let area = layout(chart, sizes, &[]).area;
    let mut y = area.y;
    let mut found = Vec::new();
    for p in places {
        let Placed::Comment(text) = &p.what else { continue };
        found.push(PlaceAt { x: area.x + area.w + 2 * LINK, y, ..p.clone() });
        y += note_area(text).h + LINK;
    }
    found
}

/// A symbol or comment at its place.
struct Body {
    at: [i64; 2],
    extent: Extent,
    node: Option<End>,
}

/// The rule that `second` stands at least `by` after `first` along one axis.
struct Apart {
    first: usize,
    second: usize,
    by: i64,
}

fn apart(chart: &Chart, sizes: &Sizes, places: &[PlaceAt]) -> Option<Vec<PlaceAt>> {
    if places.len() > MOST {
        return Some(places.to_vec());
    }
    let bodies = bodies(chart, sizes, places);
    let links = links(chart, &bodies);
    let (columns, mut rows) = overlaps(&bodies, &links)?;
    rows.extend(links.iter().filter_map(|l| l.room(&bodies)));
    let xs = shifted(&bodies, 0, &columns);
    let ys = shifted(&bodies, 1, &rows);
    let mut out = places.to_vec();
    for ((p, x), y) in out.iter_mut().zip(xs).zip(ys) {
        if x.abs().max(y.abs()) > FAR.into() {
            return None;
        }
        p.x = i32::try_from(x).ok()?;
        p.y = i32::try_from(y).ok()?;
    }
    Some(out)
}

fn bodies(chart: &Chart, sizes: &Sizes, places: &[PlaceAt]) -> Vec<Body> {
    let named = Named::new(chart);
    let room = |end: End| {
        let room = match end {
            End::Step(n) => sizes.steps.get(n as usize),
            End::Transition(n) => sizes.transitions.get(n as usize),
        };
        Some((end, *room?))
    };
    let body = |p: &PlaceAt| {
        let found = named.symbol(&p.what).and_then(room);
        let extent = match (&found, &p.what) {
            (Some((_, extent)), _) => *extent,
            (None, Placed::Comment(text)) => {
                let area = note_area(text);
                Extent { left: 0, right: area.w, up: 0, down: area.h }
            }
            (None, _) => Extent::default(),
        };
        Body { at: [p.x, p.y].map(i64::from), extent, node: found.map(|(end, _)| end) }
    };
    places.iter().map(body).collect()
}

/// A link between two places; `parts` and `meets` say that other links leave or arrive at the same
/// place.
struct Linked {
    from: usize,
    to: usize,
    parts: bool,
    meets: bool,
}

fn links(chart: &Chart, bodies: &[Body]) -> Vec<Linked> {
    let mut at: HashMap<End, usize> = HashMap::new();
    bodies.iter().enumerate().filter_map(|(k, b)| Some((b.node?, k))).for_each(|(end, k)| {
        at.entry(end).or_insert(k);
    });
    let mut steps: HashMap<&str, u32> = HashMap::new();
    for (n, s) in (0..).zip(chart.steps()) {
        steps.entry(&s.name.text).or_insert(n);
    }
    let (mut out, mut into) = (HashMap::<usize, u32>::new(), HashMap::<usize, u32>::new());
    let mut found: Vec<(usize, usize)> = Vec::new();
    for (n, t) in (0..).zip(chart.transitions()) {
        let Some(own) = at.get(&End::Transition(n)).copied() else { continue };
        let place = |name: &g7_model::Name| at.get(&End::Step(*steps.get(&*name.text)?)).copied();
        found.extend(t.from.iter().filter_map(place).map(|s| (s, own)));
        found.extend(t.to.iter().filter_map(place).map(|s| (own, s)));
    }
    for (a, b) in &found {
        *out.entry(*a).or_default() += 1;
        *into.entry(*b).or_default() += 1;
    }
    let many = |count: &HashMap<usize, u32>, k: usize| count.get(&k).is_some_and(|n| *n > 1);
    let link =
        |(from, to): (usize, usize)| Linked { from, to, parts: many(&out, from), meets: many(&into, to) };
    found.into_iter().map(link).collect()
}

impl Linked {
    /// The vertical room that the link itself needs, if it runs down.
    fn room(&self, bodies: &[Body]) -> Option<Apart> {
        let (a, b) = (bodies.get(self.from)?, bodies.get(self.to)?);
        if b.at[1] <= a.at[1] {
            return None;
        }
        let step = matches!(a.node, Some(End::Step(_)));
        let port = if step { SQUARE } else { 0 };
        let (double, line) = (BAR + DOUBLE, LINK + CLEAR);
        // Several links from one symbol part below its texts.
        let leave = match (self.parts, step) {
            (true, true) => (port + LINK).max(a.extent.down + CLEAR),
            (true, false) => a.extent.down.max(double) + CLEAR,
            (false, _) => port + LINK / 2,
        };
        let come = match (self.meets, step) {
            (true, true) => b.extent.up.max(double) + CLEAR,
            (true, false) => b.extent.up + line,
            (false, _) => LINK / 2,
        };
        let come = if self.parts { come.max(b.extent.up + CLEAR) } else { come };
        Some(Apart { first: self.from, second: self.to, by: i64::from(leave + come) })
    }
}

/// The pairs that must move apart: side by side, and one below the other. `None` if two of them
/// stand at exactly the same place.
fn overlaps(bodies: &[Body], links: &[Linked]) -> Option<(Vec<Apart>, Vec<Apart>)> {
    let box_of = |b: &Body| {
        let [x, y] = b.at;
        let e = &b.extent;
        [x - i64::from(e.left), y - i64::from(e.up), x + i64::from(e.right), y + i64::from(e.down)]
    };
    let linked: HashSet<(usize, usize)> =
        links.iter().flat_map(|l| [(l.from, l.to), (l.to, l.from)]).collect();
    let mut order: Vec<(usize, [i64; 4])> = bodies.iter().map(box_of).enumerate().collect();
    order.sort_by_key(|(_, b)| b[1]);
    let (mut columns, mut rows) = (Vec::new(), Vec::new());
    for (n, (i, a)) in order.iter().enumerate() {
        for (j, b) in order.iter().skip(n + 1).take_while(|(_, b)| b[1] < a[3] + i64::from(CLEAR)) {
            if a[0] >= b[2] + ASIDE || b[0] >= a[2] + ASIDE {
                continue;
            }
            let (p, q) = (bodies.get(*i)?, bodies.get(*j)?);
            let pair = |axis: usize, margin: i64| {
                let ((f, fb, fp), (s, sb, sp)) = match p.at[axis] <= q.at[axis] {
                    true => ((*i, a, p), (*j, b, q)),
                    false => ((*j, b, q), (*i, a, p)),
                };
                let reach = fb[axis + 2] - fp.at[axis] + sp.at[axis] - sb[axis];
                Apart { first: f, second: s, by: reach + margin }
            };
            let (aside, below) = (pair(0, ASIDE), pair(1, i64::from(CLEAR)));
            let lack = |axis: usize, w: &Apart| w.by - (p.at[axis] - q.at[axis]).abs();
            let (same_x, same_y) = (p.at[0] == q.at[0], p.at[1] == q.at[1]);
            if same_x && same_y {
                return None;
            }
            let down = linked.contains(&(*i, *j)) || lack(1, &below) <= lack(0, &aside);
            if same_x || down && !same_y { rows.push(below) } else { columns.push(aside) }
        }
    }
    Some((columns, rows))
}

/// The new places along one axis, in their order: each line of symbols moves as far as it must, and
/// everything after it moves by at least as much.
fn shifted(bodies: &[Body], axis: usize, wanted: &[Apart]) -> Vec<i64> {
    let at = |k: usize| bodies.get(k).map_or(0, |b| b.at[axis]);
    let mut by_line: BTreeMap<i64, Vec<&Apart>> = bodies.iter().map(|b| (b.at[axis], Vec::new())).collect();
    for w in wanted {
        if let Some(list) = by_line.get_mut(&at(w.second)) {
            list.push(w);
        }
    }
    let mut shift: BTreeMap<i64, i64> = BTreeMap::new();
    let mut most = 0;
    for (line, list) in by_line {
        for w in list {
            let first = at(w.first) + shift.get(&at(w.first)).copied().unwrap_or(0);
            most = most.max(first + w.by - line);
        }
        // The editor moves symbols in half units too.
        most = (most + 49) / 50 * 50;
        shift.insert(line, most);
    }
    bodies.iter().map(|b| b.at[axis] + shift.get(&b.at[axis]).copied().unwrap_or(0)).collect()
}

/// True if no symbol with its texts overlaps another.
fn is_clear(chart: &Chart, sizes: &Sizes, places: &[PlaceAt]) -> bool {
    let placed = layout(chart, sizes, places);
    let steps = placed.steps.iter().zip(&sizes.steps);
    let transitions = placed.transitions.iter().zip(&sizes.transitions);
    let mut boxes: Vec<Rect> = steps.chain(transitions).map(|(at, e)| Rect::around(*at, *e)).collect();
    boxes.sort_by_key(|r| r.y);
    boxes
        .iter()
        .enumerate()
        .all(|(n, r)| boxes.iter().skip(n + 1).take_while(|o| o.y < r.y + r.h).all(|o| !r.overlaps(o)))
}

#[cfg(test)]
mod tests {
    use g7_model::{Document, FileId, Item};

    use super::make_room;

    fn document(places: &str) -> Document {
        let text = format!(
            "input a : BOOL\nchart G {{ initial step 0 step 1 0 -> 1 when a }}\nlayout G {{ {places} }}\n"
        );
        let (document, problems) = g7_syntax::parse(&text, FileId(0));
        assert!(problems.is_empty(), "{problems:?}");
        document
    }

    fn places(document: &Document) -> Option<Vec<(i32, i32)>> {
        document.items.iter().find_map(|i| match i {
            Item::Layout(l) => Some(l.places.iter().map(|p| (p.x, p.y)).collect()),
            _ => None,
        })
    }

    #[test]
    fn places_with_room_stay() {
        let mut roomy = document("step 0 at (10, 10) transition #0 at (10, 20) step 1 at (10, 30)");
        make_room(&mut roomy);
        assert_eq!(places(&roomy), Some(vec![(1000, 1000), (1000, 2000), (1000, 3000)]));
    }

    #[test]
    fn places_too_near_are_drawn_apart() {
        let mut near = document("step 0 at (10, 4) transition #0 at (30, 4) step 1 at (10, 8)");
        make_room(&mut near);
        let found = places(&near).expect("they come clear");
        assert!(found[2].1 - found[0].1 > 400, "{found:?}");
    }

    #[test]
    fn what_stood_in_line_still_does_and_only_what_must_moves() {
        let mut near = document("step 0 at (10, 10) transition #0 at (10, 12) step 1 at (14, 10)");
        make_room(&mut near);
        let found = places(&near).expect("they come clear");
        assert_eq!((found[0], found[1].0), ((1000, 1000), 1000), "{found:?}");
        assert_eq!(found[2].1, 1000, "the second step stays beside the first: {found:?}");
        assert!(found[2].0 >= 1500, "and clear of it: {found:?}");
        assert!(found[1].1 >= 1000 + 500, "the transition stands below: {found:?}");
    }

    #[test]
    fn comments_are_kept_clear_of_symbols_or_beside_a_new_layout() {
        let mut over = document(
            "comment \"on it\" at (9, 11) step 0 at (10, 10) transition #0 at (10, 20) step 1 at (10, 30)",
        );
        make_room(&mut over);
        let found = places(&over).expect("a layout");
        assert!(found[0].1 >= found[1].1 + 500 || found[0].0 >= found[1].0 + 250, "{found:?}");
        let mut same = document("step 0 at (1, 1) step 1 at (1, 1) comment \"kept\" at (1, 1)");
        make_room(&mut same);
        let found = places(&same).expect("the comment's");
        assert_eq!(found.len(), 1, "the symbols are laid out anew");
        assert!(found[0].0 > 500, "{found:?}");
    }

    #[test]
    fn places_on_one_another_are_left_out() {
        let mut same = document("step 0 at (10, 10) transition #0 at (10, 30) step 1 at (10, 10)");
        make_room(&mut same);
        assert_eq!(places(&same), None);
    }
}
