//! The conventions of hand-drawn charts: straight sequences, even branches, loops at the left.

use g7_draw::{End, Placement, layout};

use crate::geometry::faults;
use crate::placed::plain;
use crate::random::{chart_of, only};

fn drawn(body: &str) -> Placement {
    let document = chart_of(body);
    let chart = only(&document);
    let sizes = plain(chart);
    let p = layout(chart, &sizes, &[]);
    let found = faults(chart, &sizes, &p);
    assert!(found.is_empty(), "{found:#?}");
    p
}

/// The height of the longest horizontal segment of a link.
fn row(p: &Placement, from: End, to: End) -> Option<i32> {
    let link = p.links.iter().find(|l| (l.from, l.to) == (from, to))?;
    let pieces = link.points.windows(2).filter(|w| w[0].y == w[1].y);
    pieces.max_by_key(|w| (w[0].x - w[1].x).abs()).map(|w| w[0].y)
}

#[test]
fn a_sequence_is_one_straight_line_on_the_grid() {
    let p = drawn("initial step 1 step 2 step 3 1 -> 2 when TRUE 2 -> 3 when TRUE");
    let all = p.steps.iter().chain(&p.transitions);
    assert!(all.clone().all(|q| q.x == p.steps[0].x), "{p:?}");
    assert_eq!(p.steps[1].y - p.steps[0].y, 1300);
    assert_eq!(p.steps[2].y - p.steps[1].y, 1300);
    assert_eq!(p.transitions[0].y - p.steps[0].y, 900);
    assert!(p.links.iter().all(|l| l.points.len() == 2 && l.arrows.is_empty()));
}

#[test]
fn alternatives_share_their_line_and_stand_evenly() {
    let p = drawn(
        "initial step 1 step 2 step 3 step 4 1 -> 2 when TRUE 1 -> 3 when TRUE 2 -> 4 when TRUE 3 -> 4 when TRUE",
    );
    let (s, t) = (&p.steps, &p.transitions);
    assert_eq!(t[0].y, t[1].y);
    assert_eq!(s[1].y, s[2].y);
    assert_eq!(s[0].x, s[3].x);
    assert_eq!(s[0].x - s[1].x, s[2].x - s[0].x);
    assert!(p.bars.is_empty() && p.connectors.is_empty());
    let parts = [0, 1].map(|n| row(&p, End::Step(0), End::Transition(n)));
    assert!(parts[0].is_some() && parts[0] == parts[1], "{parts:?}");
    let meets = [2, 3].map(|n| row(&p, End::Transition(n), End::Step(3)));
    assert!(meets[0].is_some() && meets[0] == meets[1], "{meets:?}");
}

#[test]
fn a_skip_leaves_the_main_sequence_straight() {
    let p = drawn(
        "initial step 1 step 2 step 3 step 4 1 -> 2 when TRUE 2 -> 3 when TRUE 3 -> 4 when TRUE 1 -> 4 when FALSE",
    );
    assert!(p.steps.iter().all(|q| q.x == p.steps[0].x), "{:?}", p.steps);
    assert!(p.transitions[3].x > p.steps[0].x);
    assert_eq!(p.transitions[3].y, p.transitions[0].y);
}

#[test]
fn double_lines_stand_over_their_branches() {
    let p = drawn("initial step 1 step 2 step 3 step 4 1 -> (2, 3) when TRUE (2, 3) -> 4 when TRUE");
    assert_eq!(p.bars.len(), 2);
    for bar in &p.bars {
        let t = p.transitions[bar.transition as usize];
        let (below, above) = (bar.at.y - t.y, t.y - bar.at.y - 50);
        assert!((150..=200).contains(if bar.join { &above } else { &below }), "{bar:?} at {t:?}");
        assert!(bar.at.x < p.steps[1].x && p.steps[2].x < bar.at.x + bar.w);
        assert_eq!(2 * t.x, 2 * bar.at.x + bar.w);
    }
}

#[test]
fn a_loop_goes_up_at_the_left_with_an_arrow() {
    let p = drawn(
        "initial step 1 step 2 step 3 1 -> 2 when TRUE 2 -> 1 when FALSE 2 -> 3 when TRUE 3 -> 2 when TRUE",
    );
    assert!(p.connectors.is_empty());
    for (from, to) in [(1, 0), (3, 1)] {
        let link = p.links.iter().find(|l| (l.from, l.to) == (End::Transition(from), End::Step(to)));
        let link = link.expect("a link");
        let lane = link.points.iter().map(|q| q.x).min().expect("points");
        assert!(p.steps.iter().all(|s| lane < s.x - 250), "{link:?}");
        assert!(link.arrows.iter().any(|(q, way)| q.x == lane && *way == (0, -1)), "{link:?}");
    }
}

#[test]
fn usual_charts_are_drawn_without_broken_links() {
    let charts = [
        // A choice among several modes, each of which returns to the beginning.
        "initial step 1 step 2 step 3 step 4 step 5 1 -> 2 when TRUE 1 -> 3 when TRUE 1 -> 4 when TRUE \
         2 -> 1 when TRUE 3 -> 5 when TRUE 5 -> 1 when TRUE 4 -> 1 when TRUE",
        // Parallel branches in parallel branches, with an alternative and a loop in one of them.
        "initial step 1 step 2 step 3 step 4 step 5 step 6 step 7 step 8 step 9 \
         1 -> (2, 3, 4) when TRUE 2 -> 5 when TRUE 2 -> 6 when TRUE 5 -> 7 when TRUE 6 -> 7 when TRUE \
         3 -> 8 when TRUE 8 -> 3 when FALSE 8 -> 9 when TRUE (7, 9, 4) -> 1 when TRUE",
        // Several initial steps that meet.
        "initial step 1 initial step 2 initial step 3 step 4 step 5 \
         (1, 2, 3) -> 4 when TRUE 4 -> (5, 1) when TRUE 5 -> (2, 3) when TRUE",
        // A source transition, a sink transition, a self-loop.
        "step 1 step 2 () -> 1 when TRUE 1 -> 2 when TRUE 2 -> 2 when FALSE 2 -> () when TRUE",
        // A return past a skip.
        "initial step 1 step 2 step 3 step 4 1 -> 2 when TRUE 1 -> 3 when TRUE 2 -> 3 when TRUE \
         3 -> 2 when TRUE 3 -> 4 when TRUE 4 -> 1 when TRUE",
    ];
    for body in charts {
        let p = drawn(body);
        assert!(p.connectors.is_empty(), "{body}: {:?}", p.connectors);
    }
}

#[test]
fn parts_without_a_link_stand_beside_one_another() {
    let p = drawn("initial step 1 step 2 initial step 3 step 4 1 -> 2 when TRUE 3 -> 4 when TRUE");
    assert_eq!(p.steps[0].y, p.steps[2].y);
    assert!(p.steps[0].x + 1000 < p.steps[2].x);
}

#[test]
fn a_part_without_a_way_in_stands_behind_the_sequence_that_it_follows_in_the_text() {
    let whole = "initial step 1 step 2 step 3 step 4 1 -> 2 when TRUE 3 -> 4 when TRUE";
    let (apart, joined) = (drawn(whole), drawn(&format!("{whole} 2 -> 3 when TRUE")));
    assert_eq!(apart.steps, joined.steps);
    assert_eq!(apart.transitions, joined.transitions[..2]);
    assert!(apart.links.iter().all(|l| l.from != End::Step(1)), "nothing is drawn in the gap");
}
