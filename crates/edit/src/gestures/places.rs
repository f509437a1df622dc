//! Places of symbols: moving, aligning, and returning to the automatic layout.

use std::collections::BTreeMap;

use g7_model::{Item, Name, PlaceAt, Placed, Span, say};

use super::layout_section::{FARTHEST, layout, point, set, with_layout, without_empty_layout};
use super::nodes::{Node, link, node, one_chart};
use super::notes;
use crate::change::{Refusal, refuse};
use crate::draft::Draft;
use crate::gesture::Alignment;
use crate::id::{End, ItemId, Part};

/// Gives a step, transition or comment a place.
#[inline(never)]
pub(crate) fn place(d: &mut Draft<'_>, id: &ItemId, (x, y): (i32, i32)) -> Result<(), Refusal> {
    if let Part::Note(n) = id.part {
        return notes::shift(d, &id.chart, n, (x, y));
    }
    let what = named(d, id)?;
    set(d, &id.chart, |p| *p == what, Some((what.clone(), vec![(x, y)])));
    Ok(())
}

/// The name of a step or transition in a layout section.
fn named(d: &mut Draft<'_>, id: &ItemId) -> Result<Placed, Refusal> {
    match node(d, id)? {
        Node::Step(name) => Ok(Placed::Step(d.new_name(&name))),
        Node::Transition(at) => placed(d, &id.chart, at),
    }
}

/// The name of a transition in a layout section: its label or its number.
fn placed(d: &Draft<'_>, chart: &str, at: Span) -> Result<Placed, Refusal> {
    if let Some(label) = &d.transition(chart, at)?.label {
        return Ok(Placed::Transition(label.clone()));
    }
    let n = d.chart(chart)?.transitions().position(|t| t.at.0 == at).unwrap_or_default();
    Ok(Placed::TransitionNumber(u32::try_from(n).unwrap_or(u32::MAX)))
}

/// The chart of a link that is there, and its ends as a layout section names them.
pub(super) fn link_ends(
    d: &mut Draft<'_>,
    chart: &str,
    a: &End,
    b: &End,
) -> Result<(String, (Placed, Placed)), Refusal> {
    let (chart, step, at, leaving) = link(d, chart, a, b)?;
    let t = d.transition(&chart, at)?;
    if !(if leaving { &t.from } else { &t.to }).iter().any(|n| *n.text == *step) {
        return refuse(say!("this link is not there"));
    }
    let (step, transition) = (Placed::Step(d.new_name(&step)), placed(d, &chart, at)?);
    Ok((chart, if leaving { (step, transition) } else { (transition, step) }))
}

/// Gives a link bends, or takes them away.
#[inline(never)]
pub(crate) fn bend(d: &mut Draft<'_>, id: &ItemId, points: &[[f64; 2]]) -> Result<(), Refusal> {
    let Part::Link(a, b) = &id.part else { return refuse(say!("this is done with a link; choose one")) };
    let (chart, ends) = link_ends(d, &id.chart, a, b)?;
    let what = Placed::Link(Box::new(ends));
    let points: Vec<(i32, i32)> = points.iter().map(|p| point(*p)).collect::<Result<_, _>>()?;
    set(d, &chart, |p| *p == what, Some((what.clone(), points)));
    d.select(id.clone());
    Ok(())
}

/// Renames the transition in the layout section when its label changes.
#[inline(never)]
pub(crate) fn relabel(
    d: &mut Draft<'_>,
    chart: &str,
    at: Span,
    old: Option<&str>,
    new: Option<&Name>,
) -> Result<(), Refusal> {
    let Some(old) = old else { return Ok(()) };
    let n = d.chart(chart)?.transitions().position(|t| t.at.0 == at).unwrap_or_default();
    for item in &mut d.doc.items {
        let Item::Layout(layout) = item else { continue };
        if *layout.chart.text != *chart {
            continue;
        }
        for symbol in layout.places.iter_mut().flat_map(|p| p.what.symbols_mut()) {
            if matches!(symbol, Placed::Transition(l) if *l.text == *old) {
                *symbol = match new {
                    Some(name) => Placed::Transition(name.clone()),
                    None => Placed::TransitionNumber(u32::try_from(n).unwrap_or(u32::MAX)),
                };
            }
        }
    }
    Ok(())
}

/// The place of a symbol: as it is drawn if that is known, otherwise as the layout section says.
#[inline(never)]
fn anchor(d: &Draft<'_>, id: &ItemId) -> Result<(i32, i32), Refusal> {
    if let Part::Note(n) = id.part {
        return notes::at(d, &id.chart, n);
    }
    let known = node(d, id)?;
    if let Some(drawn) = (d.anchors)(id) {
        return Ok(drawn);
    }
    let number = match known {
        Node::Transition(at) => Some((placed(d, &id.chart, at)?, at)),
        Node::Step(_) => None,
    };
    let named = |p: &PlaceAt| match (&p.what, &id.part, &number) {
        (Placed::Step(a), Part::Step(b), _) => *a.text == **b,
        (Placed::TransitionNumber(a), Part::Transition(b), _) => *a as usize == *b,
        (Placed::Transition(_), _, Some((what, _))) => p.what == *what,
        _ => false,
    };
    let layouts = d.doc.items.iter().filter_map(|i| match i {
        Item::Layout(l) if *l.chart.text == id.chart => Some(l),
        _ => None,
    });
    let found = layouts.flat_map(|l| &l.places).find(|p| named(p)).map(|p| (p.x, p.y));
    found.ok_or_else(|| Refusal::new(say!("where this stands on the drawing is not known yet")))
}

/// The places of the steps, transitions and comments among the ids; an action counts as its step.
#[inline(never)]
fn anchors(d: &Draft<'_>, ids: &[ItemId]) -> Result<BTreeMap<ItemId, (i32, i32)>, Refusal> {
    let mut found = BTreeMap::new();
    for id in ids {
        let id = match &id.part {
            Part::Action(step, _) => ItemId::step(id.chart.as_str(), step.as_str()),
            Part::Step(_) | Part::Transition(_) | Part::Note(_) => id.clone(),
            // Links and texts follow the symbols they belong to.
            Part::Chart | Part::Link(..) | Part::Connector(..) | Part::Other(_) => continue,
        };
        let at = anchor(d, &id)?;
        found.insert(id, at);
    }
    if found.is_empty() { refuse(say!("choose steps or transitions to move")) } else { Ok(found) }
}

fn put(d: &mut Draft<'_>, places: &BTreeMap<ItemId, (i32, i32)>) -> Result<(), Refusal> {
    for (id, at) in places {
        place(d, id, *at)?;
        d.select(id.clone());
    }
    Ok(())
}

pub(crate) fn shift(d: &mut Draft<'_>, ids: &[ItemId], dx: f64, dy: f64) -> Result<(), Refusal> {
    let (dx, dy) = point([dx, dy])?;
    let mut places = anchors(d, ids)?;
    for (x, y) in places.values_mut() {
        *x = bounded(i64::from(*x) + i64::from(dx))?;
        *y = bounded(i64::from(*y) + i64::from(dy))?;
    }
    put(d, &places)?;
    shift_bends(d, &places, (dx, dy))
}

/// Moves the bends of links whose two ends have moved.
fn shift_bends(
    d: &mut Draft<'_>,
    moved: &BTreeMap<ItemId, (i32, i32)>,
    (dx, dy): (i32, i32),
) -> Result<(), Refusal> {
    let Some(chart) = moved.keys().next().map(|id| id.chart.clone()) else { return Ok(()) };
    if layout(&d.doc, &chart).is_none_or(|l| l.places.iter().all(|p| !matches!(p.what, Placed::Link(_)))) {
        return Ok(());
    }
    let mut symbols = Vec::new();
    for id in moved.keys().filter(|id| id.chart == chart && !matches!(id.part, Part::Note(_))) {
        symbols.push(named(d, id)?);
    }
    let mut far = Ok(());
    with_layout(d, &chart, |layout| {
        for p in &mut layout.places {
            let Placed::Link(ends) = &p.what else { continue };
            if symbols.contains(&ends.0) && symbols.contains(&ends.1) {
                let bends = std::iter::once((&mut p.x, &mut p.y))
                    .chain(p.then.iter_mut().map(|b| (&mut b.0, &mut b.1)));
                for (x, y) in bends {
                    match (bounded(i64::from(*x) + i64::from(dx)), bounded(i64::from(*y) + i64::from(dy))) {
                        (Ok(right), Ok(down)) => (*x, *y) = (right, down),
                        (Err(refusal), _) | (_, Err(refusal)) => far = Err(refusal),
                    }
                }
            }
        }
    });
    far
}

fn bounded(n: i64) -> Result<i32, Refusal> {
    if n.abs() > FARTHEST {
        return refuse(say!("this place is too far away"));
    }
    i32::try_from(n).or_else(|_| refuse(say!("this place is too far away")))
}

#[inline(never)]
pub(crate) fn align(d: &mut Draft<'_>, ids: &[ItemId], how: Alignment) -> Result<(), Refusal> {
    one_chart(ids)?;
    let mut places = anchors(d, ids)?;
    if places.len() < 2 {
        return refuse(say!("choose several steps or transitions to bring into line"));
    }
    let xs: Vec<i32> = places.values().map(|p| p.0).collect();
    let ys: Vec<i32> = places.values().map(|p| p.1).collect();
    let least = |list: &[i32]| list.iter().min().copied().unwrap_or_default();
    match how {
        Alignment::Left => places.values_mut().for_each(|p| p.0 = least(&xs)),
        Alignment::Top => places.values_mut().for_each(|p| p.1 = least(&ys)),
        Alignment::Center => {
            let sum: i64 = xs.iter().map(|x| i64::from(*x)).sum();
            let middle = bounded(sum / i64::try_from(xs.len()).unwrap_or(1))?;
            places.values_mut().for_each(|p| p.0 = middle);
        }
        Alignment::DistributeX => distribute(&mut places, |p| &mut p.0)?,
        Alignment::DistributeY => distribute(&mut places, |p| &mut p.1)?,
    }
    put(d, &places)
}

/// Distributes symbols at equal distances between the first and the last.
#[inline(never)]
fn distribute(
    places: &mut BTreeMap<ItemId, (i32, i32)>,
    part: impl Fn(&mut (i32, i32)) -> &mut i32,
) -> Result<(), Refusal> {
    let mut order: Vec<&mut i32> = places.values_mut().map(&part).collect();
    order.sort();
    let (Some(first), Some(last)) = (order.first().map(|n| **n), order.last().map(|n| **n)) else {
        return Ok(());
    };
    let gaps = i64::try_from(order.len() - 1).unwrap_or(1).max(1);
    for (k, n) in order.into_iter().enumerate() {
        let way = (i64::from(last) - i64::from(first)) * i64::try_from(k).unwrap_or_default() / gaps;
        *n = bounded(i64::from(first) + way)?;
    }
    Ok(())
}

/// Deletes the places of symbols, and the bends and forms of links; comments and the chart itself keep their places.
#[inline(never)]
pub(crate) fn tidy(d: &mut Draft<'_>, chart: &str) -> Result<(), Refusal> {
    d.chart(chart)?;
    for item in &mut d.doc.items {
        if let Item::Layout(l) = item
            && *l.chart.text == *chart
        {
            l.places.retain(|p| matches!(p.what, Placed::Comment(_) | Placed::Actions(..) | Placed::Sheet));
        }
    }
    without_empty_layout(d, chart);
    Ok(())
}
