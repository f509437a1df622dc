//! The choices of a layout section that are no places of symbols: the form of a link, how actions stand, and where the
//! chart stands on a sheet of several.

use g7_model::{ActionForm, LinkForm, Placed, say};

use super::layout_section::{point, set};
use super::places::link_ends;
use crate::change::{Refusal, refuse};
use crate::draft::Draft;
use crate::gesture::{DrawnAs, StackedAs};
use crate::id::{ItemId, Part};

/// Chooses the form in which a link is drawn; without one the layout decides.
#[inline(never)]
pub(crate) fn link(d: &mut Draft<'_>, id: &ItemId, form: Option<DrawnAs>) -> Result<(), Refusal> {
    let (Part::Link(a, b) | Part::Connector(a, b, _)) = &id.part else {
        return refuse(say!("this is done with a link; choose one"));
    };
    let (chart, ends) = link_ends(d, &id.chart, a, b)?;
    let form: Option<LinkForm> = form.map(DrawnAs::form);
    let entry = form.map(|form| (Placed::LinkForm(Box::new(ends.clone()), form), vec![(0, 0)]));
    set(d, &chart, |p| matches!(p, Placed::LinkForm(e, _) if **e == ends), entry);
    // The page selects the end at the start where the link is broken off.
    d.select(ItemId::link(chart.as_str(), a.clone(), b.clone()));
    Ok(())
}

/// Chooses how the actions of a step stand, or those of a chart.
#[inline(never)]
pub(crate) fn actions(d: &mut Draft<'_>, id: &ItemId, form: Option<StackedAs>) -> Result<(), Refusal> {
    let form: Option<ActionForm> = form.map(StackedAs::form);
    let step = match &id.part {
        Part::Chart => {
            d.chart(&id.chart)?;
            None
        }
        Part::Step(name) | Part::Action(name, _) => {
            d.step(&id.chart, name)?;
            Some(Box::new(Placed::Step(d.new_name(name))))
        }
        Part::Transition(_) | Part::Link(..) | Part::Connector(..) | Part::Note(_) | Part::Other(_) => {
            return refuse(say!("this is done with a step or its chart; choose one"));
        }
    };
    // Without an entry a chart has its actions in a column.
    let form = form.filter(|form| step.is_some() || *form != ActionForm::default());
    let entry = form.map(|form| (Placed::Actions(step.clone(), form), vec![(0, 0)]));
    set(d, &id.chart, |p| matches!(p, Placed::Actions(s, _) if *s == step), entry);
    if step.is_some() {
        d.select(id.clone());
    }
    Ok(())
}

/// Gives a chart its place on the sheet of the file, or takes that away; without a chart, from all.
#[inline(never)]
pub(crate) fn sheet(d: &mut Draft<'_>, chart: Option<&str>, at: Option<[f64; 2]>) -> Result<(), Refusal> {
    let is_place = |p: &Placed| matches!(p, Placed::Sheet);
    match (chart, at.map(point).transpose()?) {
        (Some(chart), at) => {
            d.chart(chart)?;
            set(d, chart, is_place, at.map(|at| (Placed::Sheet, vec![at])));
        }
        (None, None) => {
            let names: Vec<String> = d.doc.charts().map(|c| c.name.text.to_string()).collect();
            names.iter().for_each(|name| set(d, name, is_place, None));
        }
        (None, Some(_)) => return refuse(say!("a place on the sheet is that of one chart")),
    }
    Ok(())
}
