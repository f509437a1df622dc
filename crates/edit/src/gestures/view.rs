//! The picture of a plant: its file, and the bindings of what is in it.

use g7_model::{Binding, Expr, FileId, Item, Plant, PlantItem, Span, View, say};

use crate::change::{Refusal, refuse};
use crate::draft::Draft;
use crate::gesture::Bound;

/// Gives a plant a picture with all of its bindings. Those that stay keep their text, and new ones stand behind them.
#[inline(never)]
pub(crate) fn view(d: &mut Draft<'_>, plant: &str, file: &str, bound: &[Bound]) -> Result<(), Refusal> {
    if file.trim().is_empty() {
        return refuse(say!("a picture needs the name of a file"));
    }
    let Some(k) = plant_mut(d, plant).map(|p| p.items.iter().position(|i| matches!(i, PlantItem::View(_))))
    else {
        return refuse(say!("this file has no plant `{plant}`"));
    };
    let before = match k.and_then(|k| plant_mut(d, plant)?.items.get(k)) {
        Some(PlantItem::View(view)) => view.bindings.clone(),
        _ => Vec::new(),
    };
    let bindings = merged(d, before, bound)?;
    let at = d.fresh();
    let Some(plant) = plant_mut(d, plant) else { return Ok(()) };
    match k.and_then(|k| plant.items.get_mut(k)) {
        Some(PlantItem::View(view)) => (view.file, view.bindings) = (file.into(), bindings),
        _ => plant.items.push(PlantItem::View(View { file: file.into(), bindings, at })),
    }
    Ok(())
}

fn plant_mut<'d>(d: &'d mut Draft<'_>, name: &str) -> Option<&'d mut Plant> {
    d.doc.items.iter_mut().find_map(|i| match i {
        Item::Plant(p) if *p.name.text == *name => Some(p),
        _ => None,
    })
}

/// The wished bindings: first those that were there, in their order, then the new ones.
#[inline(never)]
fn merged(d: &mut Draft<'_>, before: Vec<Binding>, bound: &[Bound]) -> Result<Vec<Binding>, Refusal> {
    let same = |b: &Binding, w: &Bound| *b.element.text == *w.element && *b.attribute.text == *w.attribute;
    let mut out = Vec::new();
    for mut binding in before {
        let Some(wish) = bound.iter().find(|w| same(&binding, w)) else { continue };
        let value = value(d, wish)?;
        if value != binding.value {
            binding.value = value;
        }
        out.push(binding);
    }
    for wish in bound {
        if wish.element.trim().is_empty() || wish.attribute.trim().is_empty() {
            return refuse(say!("a binding needs an element and an attribute"));
        }
        if out.iter().any(|b| same(b, wish)) {
            continue;
        }
        let (element, attribute) = (d.new_name(&wish.element), d.new_name(&wish.attribute));
        out.push(Binding { element, attribute, value: value(d, wish)? });
    }
    Ok(out)
}

fn value(d: &mut Draft<'_>, wish: &Bound) -> Result<Expr, Refusal> {
    let typed = wish.value.trim();
    let (mut e, problems) = g7_syntax::parse_expr(typed, FileId(0));
    if let Some(problem) = problems.first() {
        return refuse(say!("this is not a value of a binding: {}", problem.what));
    }
    e.at = d.fresh_as(typed);
    Ok(e)
}

/// The place of a binding: from its element on. A binding that stays begins where it did, even where its value is new.
pub(crate) fn binding_at(binding: &Binding) -> Span {
    let (element, value) = (binding.element.at.0, binding.value.at.0);
    if element.file == value.file { element.to(value) } else { element }
}
