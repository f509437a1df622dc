//! Forms of links in the layout section: as a line, or as a jump that is broken off.

use g7_draw::{End, Placement, Point, layout};
use g7_model::{Chart, LinkForm, Name, PlaceAt, Placed, Span};

use crate::charts::random_sizes;
use crate::geometry::{faults, link_faults};
use crate::maker::{Random, random_chart};
use crate::placed::plain;
use crate::random::{chart_of, only};

/// A selection of two sequences and a way back from each, a fork and a join.
const LOOPS: &str = "initial step 1 step 2 step 3 step 4 step 5\n\
    1 -> (2, 3) when TRUE (2, 3) -> 4 when TRUE 4 -> 5 when TRUE 5 -> 1 when TRUE 4 -> 1 when FALSE\n";
/// Two sequences, and a link from one into the other. The layout draws this link as a jump.
const ACROSS: &str = "initial step 1 step 2 step 3 step 4 step 5 step 6 step 7\n\
    1 -> 2 when TRUE 1 -> 3 when TRUE 2 -> 4 when TRUE 4 -> 6 when TRUE\n\
    3 -> 5 when TRUE 5 -> 6 when TRUE 6 -> 7 when TRUE 3 -> 4 when FALSE 7 -> 1 when TRUE\n";

fn step(name: &str) -> Placed {
    Placed::Step(Name::new(name, Span::default()))
}

fn entry(what: Placed, at: Point) -> PlaceAt {
    PlaceAt { what, x: at.x, y: at.y, then: Vec::new(), at: Span::default().into() }
}

fn form(from: Placed, to: Placed, form: LinkForm) -> PlaceAt {
    entry(Placed::LinkForm(Box::new((from, to)), form), Point::default())
}

/// The links of a chart as entries name them, with their ends.
fn all_links(chart: &Chart) -> Vec<((Placed, Placed), (End, End))> {
    let mut found = Vec::new();
    let number = |n: &Name| chart.steps().position(|s| s.name == *n).map(|n| End::Step(n as u32));
    for (n, t) in (0u32..).zip(chart.transitions()) {
        let own = (Placed::TransitionNumber(n), End::Transition(n));
        for s in &t.from {
            found.extend(number(s).map(|e| ((Placed::Step(s.clone()), own.0.clone()), (e, own.1))));
        }
        for s in &t.to {
            found.extend(number(s).map(|e| ((own.0.clone(), Placed::Step(s.clone())), (own.1, e))));
        }
    }
    found
}

fn is_broken(p: &Placement, ends: (End, End)) -> bool {
    let parts = p.connectors.iter().filter(|c| (c.from, c.to) == ends).count();
    assert_eq!(p.links.iter().filter(|l| (l.from, l.to) == ends).count() * 2 + parts, 2, "{ends:?}");
    parts == 2
}

#[test]
fn each_link_can_be_a_jump_and_nothing_overlaps() {
    for body in [LOOPS, ACROSS] {
        let document = chart_of(body);
        let chart = only(&document);
        let sizes = plain(chart);
        for ((from, to), ends) in all_links(chart) {
            let p = layout(chart, &sizes, &[form(from, to, LinkForm::Jump)]);
            assert!(is_broken(&p, ends), "{ends:?}");
            let chosen = p.connectors.iter().filter(|c| c.form == Some(LinkForm::Jump));
            assert!(chosen.map(|c| (c.from, c.to)).eq([ends, ends]), "{:?}", p.connectors);
            let found = faults(chart, &sizes, &p);
            assert!(found.is_empty(), "{ends:?}: {found:#?}");
        }
    }
}

#[test]
fn random_charts_with_random_jumps_have_no_faults() {
    for seed in 0..600 {
        let mut random = Random(seed);
        let size = 2 + random.below(60);
        let document = random_chart(seed, size, random.below(4), size);
        let chart = only(&document);
        let sizes = random_sizes(chart, &mut random);
        let mut links = all_links(chart);
        links.retain(|_| random.below(6) == 0);
        let places: Vec<PlaceAt> =
            links.iter().map(|((a, b), _)| form(a.clone(), b.clone(), LinkForm::Jump)).collect();
        let p = layout(chart, &sizes, &places);
        assert!(links.iter().all(|(_, ends)| is_broken(&p, *ends)), "seed {seed}");
        let found = faults(chart, &sizes, &p);
        assert!(found.is_empty(), "seed {seed}: {found:#?}\n{}", g7_syntax::print(&document, None));
    }
}

#[test]
fn a_link_that_the_layout_breaks_off_is_drawn_as_a_line_where_a_way_is_free() {
    let document = chart_of(ACROSS);
    let chart = only(&document);
    let sizes = plain(chart);
    let auto = layout(chart, &sizes, &[]);
    let ends = (auto.connectors[0].from, auto.connectors[0].to);
    assert!(is_broken(&auto, ends));
    let name = all_links(chart).into_iter().find(|l| l.1 == ends).expect("a link").0;
    let p = layout(chart, &sizes, &[form(name.0, name.1, LinkForm::Line)]);
    assert!(!is_broken(&p, ends));
    let line = p.links.iter().find(|l| (l.from, l.to) == ends).expect("a line");
    assert_eq!(line.form, Some(LinkForm::Line));
    let found = faults(chart, &sizes, &p);
    assert!(found.is_empty(), "{found:#?}");
    // The symbols stay.
    assert_eq!((&p.steps, &p.transitions), (&auto.steps, &auto.transitions));
}

#[test]
fn random_lines_have_no_faults_in_their_links() {
    let mut drawn = 0;
    for seed in 0..600 {
        let mut random = Random(seed);
        let size = 2 + random.below(60);
        let document = random_chart(seed, size, 3 + random.below(6), size);
        let chart = only(&document);
        let sizes = random_sizes(chart, &mut random);
        let auto = layout(chart, &sizes, &[]);
        let places: Vec<PlaceAt> =
            all_links(chart).into_iter().map(|((a, b), _)| form(a, b, LinkForm::Line)).collect();
        let p = layout(chart, &sizes, &places);
        assert!(p.connectors.len() <= auto.connectors.len(), "seed {seed}");
        drawn += (auto.connectors.len() - p.connectors.len()) / 2;
        let found = link_faults(chart, &p);
        assert!(found.is_empty(), "seed {seed}: {found:#?}\n{}", g7_syntax::print(&document, None));
        for l in &auto.links {
            let same = p.links.iter().find(|o| (o.from, o.to) == (l.from, l.to)).expect("the link");
            assert_eq!(same.points, l.points, "seed {seed}: a line that was there stays");
        }
    }
    assert!(drawn > 50, "{drawn}");
}

#[test]
fn a_jump_stays_broken_off_where_its_symbols_are_placed() {
    let document = chart_of(LOOPS);
    let chart = only(&document);
    let sizes = plain(chart);
    for ((from, to), ends) in all_links(chart) {
        let jump = form(from, to, LinkForm::Jump);
        let auto = layout(chart, &sizes, std::slice::from_ref(&jump));
        let by = Point { x: 700, y: 900 };
        let moved = |at: &Point| Point { x: at.x + by.x, y: at.y + by.y };
        let steps = chart.steps().zip(&auto.steps);
        let steps = steps.map(|(s, at)| entry(Placed::Step(s.name.clone()), moved(at)));
        let transitions = (0..).zip(&auto.transitions);
        let transitions = transitions.map(|(n, at)| entry(Placed::TransitionNumber(n), moved(at)));
        let mut places: Vec<PlaceAt> = steps.chain(transitions).collect();
        places.push(jump);
        let p = layout(chart, &sizes, &places);
        assert!(is_broken(&p, ends), "{ends:?}");
        for (c, was) in p.connectors.iter().zip(&auto.connectors) {
            assert_eq!((c.from, c.to, c.leaving), (was.from, was.to, was.leaving));
            assert_eq!(c.at.x, was.at.x + by.x, "{ends:?}");
            assert!((c.at.y - was.at.y - by.y).abs() < 200, "{ends:?} {c:?} {was:?}");
            // It hangs together: it begins at its symbol.
            if c.leaving {
                let port = match c.from {
                    End::Step(n) => Point { y: p.steps[n as usize].y + 500, ..p.steps[n as usize] },
                    End::Transition(n) => p.transitions[n as usize],
                };
                assert_eq!((c.points[0], c.points.last()), (port, Some(&c.at)), "{ends:?}");
            }
        }
    }
    // A step that goes far away takes the end of its jump along.
    let jump = form(Placed::TransitionNumber(3), step("1"), LinkForm::Jump);
    let auto = layout(chart, &sizes, std::slice::from_ref(&jump));
    let far = Point { x: auto.steps[4].x + 3000, y: auto.steps[4].y + 500 };
    let p = layout(chart, &sizes, &[jump, entry(step("5"), far)]);
    assert!(is_broken(&p, (End::Transition(3), End::Step(0))));
}

#[test]
fn forms_that_name_no_link_are_without_effect() {
    let document = chart_of(LOOPS);
    let chart = only(&document);
    let sizes = plain(chart);
    let wrong = [
        form(step("2"), Placed::TransitionNumber(0), LinkForm::Jump),
        form(step("nobody"), Placed::TransitionNumber(99), LinkForm::Jump),
        form(step("1"), step("2"), LinkForm::Jump),
    ];
    assert_eq!(layout(chart, &sizes, &wrong), layout(chart, &sizes, &[]));
}
