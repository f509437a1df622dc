//! Bends of the layout section: the links follow them where they fit, and go the way of the layout elsewhere.

use g7_draw::{Bends, End, Link, Placement, Point, layout};
use g7_model::{Name, PlaceAt, Placed, Span};

use crate::geometry::{faults, link_faults};
use crate::placed::plain;
use crate::random::{chart_of, only};

/// A selection of two sequences, and a way back.
const SELECTION: &str = "initial step 1 step 2 step 3\n\
    1 -> 2 when TRUE 1 -> 3 when TRUE 2 -> 1 when TRUE 3 -> 1 when TRUE\n";
/// Two simultaneous sequences.
const SIMULTANEOUS: &str = "initial step 1 step 2 step 3\n1 -> (2, 3) when TRUE (2, 3) -> 1 when TRUE\n";

fn step(name: &str) -> Placed {
    Placed::Step(Name::new(name, Span::default()))
}

fn bent(from: Placed, to: Placed, bends: &[(i32, i32)]) -> PlaceAt {
    let (x, y) = bends[0];
    let what = Placed::Link(Box::new((from, to)));
    PlaceAt { what, x, y, then: bends[1..].to_vec(), at: Span::default().into() }
}

fn link(p: &Placement, from: End, to: End) -> &Link {
    p.links.iter().find(|l| (l.from, l.to) == (from, to)).expect("a link")
}

#[test]
fn a_link_goes_sideways_at_the_height_of_its_bend() {
    let document = chart_of(SELECTION);
    let chart = only(&document);
    let sizes = plain(chart);
    let auto = layout(chart, &sizes, &[]);
    let (from, to) = (End::Step(0), End::Transition(1));
    let was = link(&auto, from, to).points.clone();
    assert_eq!(was.len(), 4, "{was:?}");
    let height = was[1].y + 50;
    // The place of the last bend is that of the end, whatever is written.
    let places = [bent(step("1"), Placed::TransitionNumber(1), &[(0, height)])];
    let p = layout(chart, &sizes, &places);
    let now = link(&p, from, to);
    assert_eq!(now.bends, Bends::Followed);
    assert_eq!(
        now.points,
        [was[0], Point { x: was[0].x, y: height }, Point { x: was[3].x, y: height }, was[3]]
    );
    // All else stays.
    assert_eq!((&p.steps, &p.transitions), (&auto.steps, &auto.transitions));
    for l in auto.links.iter().filter(|l| (l.from, l.to) != (from, to)) {
        assert_eq!(&link(&p, l.from, l.to).points, &l.points);
    }
}

#[test]
fn a_way_back_goes_up_where_its_bend_says() {
    let document = chart_of(SELECTION);
    let chart = only(&document);
    let sizes = plain(chart);
    let auto = layout(chart, &sizes, &[]);
    let (from, to) = (End::Transition(2), End::Step(0));
    let was = link(&auto, from, to).points.clone();
    let n = was.len();
    let (row, entry, lane) = (was[n - 4].y, was[n - 3].y, was[n - 3].x - 400);
    let places = [bent(Placed::TransitionNumber(2), step("1"), &[(lane, row), (0, entry)])];
    let p = layout(chart, &sizes, &places);
    let now = link(&p, from, to);
    assert_eq!(now.bends, Bends::Followed);
    assert!(now.points.contains(&Point { x: lane, y: row }), "{now:?}");
    assert!(now.points.contains(&Point { x: lane, y: entry }), "{now:?}");
    // It runs upward there, and the sheet reaches so far.
    assert!(now.arrows.iter().any(|(tip, way)| tip.x == lane && *way == (0, -1)), "{now:?}");
    assert!(p.area.x <= lane, "{:?}", p.area);
    let found = faults(chart, &sizes, &p);
    assert!(found.is_empty(), "{found:#?}");
}

#[test]
fn the_part_along_a_double_line_stays() {
    let document = chart_of(SIMULTANEOUS);
    let chart = only(&document);
    let sizes = plain(chart);
    let moved = PlaceAt { what: step("3"), x: 2500, y: 2000, then: Vec::new(), at: Span::default().into() };
    let auto = layout(chart, &sizes, std::slice::from_ref(&moved));
    let low = |p: &Placement| p.bars.iter().find(|b| !b.join).expect("a double line").at.y;
    for l in auto.links.iter().filter(|l| l.from == End::Transition(0)) {
        if let Some([first, last]) = l.held {
            assert!(l.points[..=first].iter().all(|at| at.y <= low(&auto) + 50) || first == 1, "{l:?}");
            assert_eq!((l.points.len() - 1 - first - last) % 2, 1, "{l:?}");
        }
    }
    // A bend above the double line is none.
    let wrong = bent(Placed::TransitionNumber(0), step("3"), &[(0, low(&auto) - 50)]);
    let p = layout(chart, &sizes, &[moved, wrong]);
    assert_eq!(link(&p, End::Transition(0), End::Step(2)).bends, Bends::Waived);
    assert_eq!(
        link(&p, End::Transition(0), End::Step(2)).points,
        link(&auto, End::Transition(0), End::Step(2)).points
    );
}

#[test]
fn bends_that_do_not_fit_give_way() {
    let document = chart_of(SELECTION);
    let chart = only(&document);
    let sizes = plain(chart);
    let auto = layout(chart, &sizes, &[]);
    let (from, to) = (End::Transition(2), End::Step(0));
    let was = link(&auto, from, to).points.clone();
    let n = was.len();
    let (row, entry) = (was[n - 4].y, was[n - 3].y);
    let through = auto.steps[1].x;
    for bends in [
        // Through a step, above its start, below its end, and far away.
        vec![(through, row), (0, entry)],
        vec![(-2000, was[0].y - 10), (0, entry)],
        vec![(-2000, row), (0, was[n - 1].y + 10)],
        vec![(i32::MIN, i32::MIN), (i32::MAX, i32::MAX)],
    ] {
        let p = layout(chart, &sizes, &[bent(Placed::TransitionNumber(2), step("1"), &bends)]);
        let now = link(&p, from, to);
        assert_eq!((now.bends, &now.points), (Bends::Waived, &was), "{bends:?}");
        assert_eq!(p.area, auto.area);
    }
}

#[test]
fn entries_that_name_no_link_are_without_effect() {
    let document = chart_of(SELECTION);
    let chart = only(&document);
    let sizes = plain(chart);
    let auto = layout(chart, &sizes, &[]);
    let places = [
        bent(step("2"), Placed::TransitionNumber(0), &[(0, 0)]),
        bent(step("nobody"), Placed::TransitionNumber(99), &[(0, 0)]),
        bent(step("1"), step("2"), &[(0, 0)]),
    ];
    let p = layout(chart, &sizes, &places);
    assert_eq!(p, auto);
    assert!(link_faults(chart, &p).is_empty());
}
