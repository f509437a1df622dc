//! The places of a chart's symbols: from its layout, otherwise in rows.

use std::collections::{HashMap, VecDeque};

use g7_model::{Chart, Document, Item, Layout, Placed};

/// The distance between two rows of steps, in units of the drawing.
const ROW: f64 = 120.0;
/// The distance between two columns.
const COLUMN: f64 = 160.0;

/// The places of a chart's symbols: the middle of their upper side.
pub(super) struct Places {
    steps: HashMap<String, (f64, f64)>,
    transitions: Vec<(f64, f64)>,
}

impl Places {
    pub(super) fn of(document: &Document, chart: &Chart) -> Places {
        let mut places = rows(chart);
        let layouts =
            document.items.iter().filter_map(|i| if let Item::Layout(l) = i { Some(l) } else { None });
        for layout in layouts.filter(|l| l.chart.text == chart.name.text) {
            written(layout, chart, &mut places);
        }
        places
    }

    pub(super) fn step(&self, name: &str) -> (f64, f64) {
        self.steps.get(name).copied().unwrap_or_default()
    }

    pub(super) fn transition(&self, number: usize) -> (f64, f64) {
        self.transitions.get(number).copied().unwrap_or_default()
    }
}

fn written(layout: &Layout, chart: &Chart, places: &mut Places) {
    for place in &layout.places {
        let at = (f64::from(place.x) / 10.0, f64::from(place.y) / 10.0);
        match &place.what {
            Placed::Step(name) => {
                places.steps.insert(name.text.to_string(), at);
            }
            Placed::Transition(label) => {
                let labelled =
                    |t: &g7_model::Transition| t.label.as_ref().is_some_and(|l| l.text == label.text);
                if let Some(number) = chart.transitions().position(labelled)
                    && let Some(slot) = places.transitions.get_mut(number)
                {
                    *slot = at;
                }
            }
            Placed::TransitionNumber(number) => {
                let slot = usize::try_from(*number).ok().and_then(|n| places.transitions.get_mut(n));
                if let Some(slot) = slot {
                    *slot = at;
                }
            }
            _ => {}
        }
    }
}

/// Places steps by their distance from the initial ones, with transitions between the rows.
fn rows(chart: &Chart) -> Places {
    let mut depth: HashMap<&str, u32> = HashMap::new();
    let mut open: VecDeque<&str> = VecDeque::new();
    let first = chart.steps().filter(|s| s.initial).chain(chart.steps());
    for start in first {
        if depth.contains_key(&*start.name.text) {
            continue;
        }
        depth.insert(&start.name.text, 0);
        open.push_back(&start.name.text);
        while let Some(name) = open.pop_front() {
            let row = depth.get(name).copied().unwrap_or(0) + 1;
            for transition in chart.transitions().filter(|t| t.from.iter().any(|n| *n.text == *name)) {
                for to in &transition.to {
                    if !depth.contains_key(&*to.text) {
                        depth.insert(&to.text, row);
                        open.push_back(&to.text);
                    }
                }
            }
        }
    }
    let mut columns: HashMap<u32, u32> = HashMap::new();
    let mut steps = HashMap::new();
    for step in chart.steps() {
        let row = depth.get(&*step.name.text).copied().unwrap_or(0);
        let column = columns.entry(row).or_insert(0);
        steps.insert(
            step.name.text.to_string(),
            (80.0 + f64::from(*column) * COLUMN, 20.0 + f64::from(row) * ROW),
        );
        *column += 1;
    }
    let mut used: HashMap<String, u32> = HashMap::new();
    let transitions = chart.transitions().map(|t| {
        let from = t.from.first().or(t.to.first()).map(|n| n.text.to_string()).unwrap_or_default();
        let (x, y) = steps.get(&from).copied().unwrap_or_default();
        let branch = used.entry(from).or_insert(0);
        let place = (x + f64::from(*branch) * COLUMN / 2.0, y + ROW / 2.0);
        *branch += 1;
        place
    });
    let transitions = transitions.collect();
    Places { steps, transitions }
}
