//! A plain placement until something better comes: one column, in the order of the text.

use crate::{End, Link, Placement, Point, Rect, Sizes};
use g7_model::{Chart, PlaceAt};
use std::collections::HashMap;

pub(crate) fn layout(chart: &Chart, sizes: &Sizes, _: &[PlaceAt]) -> Placement {
    let mut p = Placement::default();
    let numbers: HashMap<&str, usize> = chart.steps().map(|s| &*s.name.text).zip(0..).collect();
    let mut y = 0;
    p.steps = vec![Point::default(); sizes.steps.len()];
    let mut done = vec![false; sizes.steps.len()];
    p.transitions = Vec::new();
    for (n, s) in chart.steps().enumerate() {
        let _ = s;
        done[n] = true;
        y += sizes.steps[n].up;
        p.steps[n] = Point { x: 0, y };
        y += sizes.steps[n].down.max(500) + 100;
    }
    for (n, t) in chart.transitions().enumerate() {
        y += sizes.transitions[n].up + 100;
        let at = Point { x: 0, y };
        p.transitions.push(at);
        y += sizes.transitions[n].down + 100;
        for f in &t.from {
            if let Some(s) = numbers.get(&*f.text) {
                let q = p.steps[*s];
                let x = -600 - 40 * n as i32;
                p.links.push(Link {
                    from: End::Step(*s as u32),
                    to: End::Transition(n as u32),
                    points: vec![
                        Point { x: q.x, y: q.y + 500 },
                        Point { x: q.x, y: q.y + 550 },
                        Point { x, y: q.y + 550 },
                        Point { x, y: at.y - 60 },
                        Point { x: 0, y: at.y - 60 },
                        at,
                    ],
                    arrows: vec![],
                });
            }
        }
    }
    p.area = Rect { x: -1000, y: 0, w: 2000, h: y };
    p
}
