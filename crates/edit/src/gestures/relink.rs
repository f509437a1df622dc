//! Takes one end of a link to another symbol; its other end stays where it is.

use g7_model::{Name, say};

use super::graph::{add, has, may_arrive, may_leave, replace, vacant};
use super::nodes::{Node, link as known, node, one_chart};
use crate::change::{Refusal, refuse};
use crate::draft::Draft;
use crate::gesture::LinkEnd;
use crate::id::{End, ItemId, Part};

#[inline(never)]
pub(crate) fn relink(d: &mut Draft<'_>, link: &ItemId, end: LinkEnd, to: &ItemId) -> Result<(), Refusal> {
    let (Part::Link(a, b) | Part::Connector(a, b, _)) = &link.part else {
        return refuse(say!("this is done with a link; choose one"));
    };
    let ids = [link.clone(), to.clone()];
    let chart = one_chart(&ids)?;
    let (_, step, at, leaving) = known(d, chart, a, b)?;
    let side = |t: &g7_model::Transition| if leaving { t.from.clone() } else { t.to.clone() };
    if !has(&side(d.transition(chart, at)?), &step) {
        return refuse(say!("this link is not there"));
    }
    let at_step = leaving == (end == LinkEnd::From);
    let (step, at) = match node(d, to)? {
        Node::Step(new) if at_step => {
            if new != step {
                let there = d.step(chart, &new)?;
                if leaving {
                    may_leave(there)?
                } else {
                    may_arrive(there)?
                }
                vacant(d.transition(chart, at)?, &new, !leaving)?;
                let by = [d.new_name(&new)];
                let t = d.transition_mut(chart, at)?;
                replace(if leaving { &mut t.from } else { &mut t.to }, &step, &by);
            }
            (new, at)
        }
        Node::Transition(new) if !at_step => {
            if new != at {
                add(d, chart, new, &step, !leaving)?;
                let t = d.transition_mut(chart, at)?;
                let list: &mut Vec<Name> = if leaving { &mut t.from } else { &mut t.to };
                list.retain(|n| *n.text != *step);
                if t.from.is_empty() && t.to.is_empty() {
                    return refuse(say!("a transition joins steps: leave it one at least"));
                }
            }
            (step, new)
        }
        Node::Step(_) | Node::Transition(_) => return refuse(say!("a link joins a step and a transition")),
    };
    let number = d.chart(chart)?.transitions().position(|t| t.at.0 == at).unwrap_or_default();
    let (step, transition) = (End::Step(step), End::Transition(number));
    let (from, to) = if leaving { (step, transition) } else { (transition, step) };
    d.select(ItemId::link(chart, from, to));
    Ok(())
}
