//! Layout sections: symbols stand where the section says, and links reach them there.

use g7_draw::{End, Extent, Placement, Point, Sizes, layout};
use g7_model::{Chart, Item, Name, PlaceAt, Placed, Span};

use crate::charts::{corpus, random_sizes};
use crate::geometry::{faults, link_faults, runs_through};
use crate::maker::Random;
use crate::random::{chart_of, only};

const BRANCHES: &str = "initial step 1 step 2 step 3 step 4 step 5\n\
    t1: 1 -> (2, 3) when TRUE t2: (2, 3) -> 4 when TRUE 4 -> 5 when TRUE 5 -> 1 when TRUE 4 -> 1 when FALSE\n";

pub(crate) fn plain(chart: &Chart) -> Sizes {
    Sizes {
        steps: chart.steps().map(|_| Extent { left: 250, right: 250, up: 0, down: 500 }).collect(),
        transitions: chart
            .transitions()
            .map(|_| Extent { left: 220, right: 400, up: 70, down: 70 })
            .collect(),
        connectors: vec![200; chart.steps().count()],
    }
}

fn name(text: &str) -> Name {
    Name::new(text, Span::default())
}

fn at(what: Placed, x: i32, y: i32) -> PlaceAt {
    PlaceAt { what, x, y, then: Vec::new(), at: Span::default().into() }
}

fn all_as(p: &Placement, chart: &Chart, shift: i32) -> Vec<PlaceAt> {
    let steps = chart.steps().zip(&p.steps);
    let steps = steps.map(|(s, q)| at(Placed::Step(s.name.clone()), q.x + shift, q.y - shift));
    let transitions = (0..).zip(&p.transitions);
    let transitions = transitions.map(|(n, q)| at(Placed::TransitionNumber(n), q.x + shift, q.y - shift));
    steps.chain(transitions).collect()
}

#[test]
fn a_moved_step_takes_its_links_along() {
    let document = chart_of(BRANCHES);
    let chart = only(&document);
    let sizes = plain(chart);
    let auto = layout(chart, &sizes, &[]);
    let place = Point { x: auto.steps[1].x - 1300, y: auto.steps[1].y + 200 };
    let p = layout(chart, &sizes, &[at(Placed::Step(name("2")), place.x, place.y)]);
    assert_eq!(p.steps[1], place);
    assert_eq!(p.steps[2], auto.steps[2]);
    assert_eq!(p.transitions, auto.transitions);
    let found = faults(chart, &sizes, &p);
    assert!(found.is_empty(), "{found:#?}");
    // The double lines reach the step.
    for join in [false, true] {
        let bar = p.bars.iter().find(|b| b.join == join).expect("a double line");
        assert!(bar.at.x < place.x && bar.at.x + bar.w > p.steps[2].x, "{bar:?}");
    }
    // A link far from it keeps its corners.
    let link = |p: &Placement| p.links.iter().find(|l| l.from == End::Step(4)).map(|l| l.points.clone());
    assert_eq!(link(&p), link(&auto));
}

#[test]
fn transitions_go_by_label_and_by_number() {
    let document = chart_of(BRANCHES);
    let chart = only(&document);
    let sizes = plain(chart);
    let auto = layout(chart, &sizes, &[]);
    let (a, b) = (auto.transitions[0], auto.transitions[2]);
    let places = [
        at(Placed::Transition(name("t1")), a.x + 100, a.y),
        at(Placed::TransitionNumber(2), b.x - 100, b.y),
        at(Placed::Step(name("nobody")), 0, 0),
        at(Placed::TransitionNumber(99), 0, 0),
    ];
    let p = layout(chart, &sizes, &places);
    assert_eq!(p.transitions[0], Point { x: a.x + 100, y: a.y });
    assert_eq!(p.transitions[2], Point { x: b.x - 100, y: b.y });
    assert_eq!(p.transitions[1], auto.transitions[1]);
    assert!(link_faults(chart, &p).is_empty());
}

#[test]
fn a_chart_placed_as_a_whole_stands_there() {
    let document = chart_of(BRANCHES);
    let chart = only(&document);
    let sizes = plain(chart);
    let auto = layout(chart, &sizes, &[]);
    let p = layout(chart, &sizes, &all_as(&auto, chart, 5000));
    let moved = |q: &Point| Point { x: q.x + 5000, y: q.y - 5000 };
    assert_eq!(p.steps, auto.steps.iter().map(moved).collect::<Vec<_>>());
    assert_eq!(p.transitions, auto.transitions.iter().map(moved).collect::<Vec<_>>());
    assert!(p.connectors.is_empty());
    let found = link_faults(chart, &p);
    assert!(found.is_empty(), "{found:#?}");
    let through = runs_through(&sizes, &p);
    assert!(through.is_empty(), "{through:#?}");
}

#[test]
fn a_new_symbol_in_a_chart_drawn_by_hand_stands_at_its_neighbour() {
    let document = chart_of(BRANCHES);
    let chart = only(&document);
    let sizes = plain(chart);
    let auto = layout(chart, &sizes, &[]);
    let mut places = all_as(&auto, chart, 5000);
    places.retain(|p| p.what != Placed::Step(name("5")));
    let p = layout(chart, &sizes, &places);
    let (step, before) = (p.steps[4], p.transitions[2]);
    assert_eq!(step.x - before.x, auto.steps[4].x - auto.transitions[2].x);
    assert!((step.y - auto.steps[4].y + 5000).abs() < 2000, "{step:?}");
}

#[test]
fn random_places_leave_every_link_whole() {
    let document = chart_of(BRANCHES);
    let chart = only(&document);
    for seed in 0..300 {
        let mut random = Random(seed);
        let sizes = random_sizes(chart, &mut random);
        let mut places = all_as(&layout(chart, &sizes, &[]), chart, 0);
        places.retain(|_| random.below(2) == 0);
        for p in &mut places {
            p.x = random.below(8000) as i32;
            p.y = random.below(8000) as i32;
        }
        let found = link_faults(chart, &layout(chart, &sizes, &places));
        assert!(found.is_empty(), "seed {seed}: {found:#?}");
    }
}

#[test]
fn absurd_sizes_and_places_do_no_harm() {
    let document = chart_of(BRANCHES);
    let chart = only(&document);
    for n in [i32::MIN, -1, i32::MAX] {
        let e = Extent { left: n, right: n, up: n, down: n };
        let sizes = Sizes { steps: vec![e; 5], transitions: vec![e; 5], connectors: vec![n; 5] };
        assert!(link_faults(chart, &layout(chart, &sizes, &[])).is_empty());
        let places: Vec<PlaceAt> = (0..5).map(|t| at(Placed::TransitionNumber(t), n, n)).collect();
        assert!(link_faults(chart, &layout(chart, &sizes, &places)).is_empty());
        assert!(link_faults(chart, &layout(chart, &Sizes::default(), &places)).is_empty());
    }
}

#[test]
fn imported_charts_stand_as_they_were_drawn() {
    for (file, document) in corpus("jgrafchart-xml") {
        let places = document.items.iter().find_map(|i| if let Item::Layout(l) = i { Some(l) } else { None });
        let places = &places.expect("a layout").places;
        let chart = document.charts().next().expect("a chart");
        let sizes = plain(chart);
        let p = layout(chart, &sizes, places);
        let found = link_faults(chart, &p);
        assert!(found.is_empty(), "{file}: {found:#?}");
        for (n, step) in chart.steps().enumerate() {
            let place = places.iter().find(|p| p.what == Placed::Step(step.name.clone())).expect("a place");
            assert_eq!(p.steps[n], Point { x: place.x, y: place.y }, "{file}");
        }
        let through = runs_through(&sizes, &p);
        assert!(through.len() * 20 <= p.links.len(), "{file}: {through:#?}");
    }
}
