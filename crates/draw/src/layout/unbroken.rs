//! Draws as lines the links that the layout has broken off and that the layout section wants as lines (decision 84). It
//! comes when all symbols have their places, and moves none of them. A line runs through no symbol and lies on no other
//! link; where no such way is free the link stays broken off.

use std::collections::HashMap;

use g7_model::LinkForm;

use crate::layout::forms::ends;
use crate::layout::graph::Graph;
use crate::layout::moved::{Moved, symbols};
use crate::layout::rooms::{DOUBLE, OVERHANG, extents};
use crate::layout::route::area;
use crate::{End, Link, Placement, Sizes};

/// Draws the lines that the layout has broken off, and tells each link its form.
#[inline(never)]
pub(crate) fn apply(graph: &Graph, sizes: &Sizes, forms: &[Option<LinkForm>], p: &mut Placement) {
    if forms.is_empty() {
        return;
    }
    let node = |end: End| match end {
        End::Step(n) => n,
        End::Transition(n) => graph.steps as u32 + n,
    };
    let wanted = (0u32..).zip(forms).filter(|(_, f)| **f == Some(LinkForm::Line)).map(|(l, _)| l);
    let broken = |l: &u32| {
        let ends = ends(graph, graph.links[*l as usize]);
        p.connectors.iter().any(|c| (c.from, c.to) == ends)
    };
    let lines: Vec<u32> = wanted.filter(broken).collect();
    if !lines.is_empty() {
        let mut ways = symbols(graph, sizes, p);
        p.links.iter().for_each(|l| ways.draw(&l.points, node(l.from), node(l.to)));
        for l in lines {
            let (from, to) = graph.links[l as usize];
            let link = Moved::settled(graph, sizes, p).link(&ways, from, to);
            if ways.faults(&link.points, from, to) == 0 {
                ways.draw(&link.points, from, to);
                widen(graph, (from, to), &link, p);
                p.connectors.retain(|c| (c.from, c.to) != (link.from, link.to));
                p.links.push(link);
            }
        }
        let number: HashMap<(End, End), usize> =
            graph.links.iter().map(|l| ends(graph, *l)).zip(0..).collect();
        p.links.sort_by_key(|l| number.get(&(l.from, l.to)).copied());
        p.area = p.area.union(&area(p, &extents(graph, sizes)));
    }
    let form: HashMap<(End, End), LinkForm> =
        graph.links.iter().zip(forms).filter_map(|(l, form)| Some((ends(graph, *l), (*form)?))).collect();
    p.links.iter_mut().for_each(|l| l.form = form.get(&(l.from, l.to)).copied());
    p.connectors.iter_mut().for_each(|c| c.form = form.get(&(c.from, c.to)).copied());
}

/// Makes the double lines at the ends of a link as long as its columns need.
fn widen(graph: &Graph, (from, to): (u32, u32), link: &Link, p: &mut Placement) {
    let transition = |n: u32| n.checked_sub(graph.steps as u32);
    for bar in &mut p.bars {
        let own = [(transition(from), false), (transition(to), true)];
        if !own.contains(&(Some(bar.transition), bar.join)) {
            continue;
        }
        let heights = [bar.at.y, bar.at.y + DOUBLE];
        for at in link.points.iter().filter(|at| heights.contains(&at.y)) {
            let right = (bar.at.x + bar.w).max(at.x + OVERHANG);
            bar.at.x = bar.at.x.min(at.x - OVERHANG);
            bar.w = right - bar.at.x;
        }
    }
}
