//! The names that a plant declares, for those who follow the names of a document.

use std::collections::HashSet;

use g7_model::{Document, Item, Name, Plant, PlantItem};

/// The plant with this name.
pub(super) fn plant_named<'d>(doc: &'d Document, name: &str) -> Option<&'d Plant> {
    doc.items.iter().find_map(|i| match i {
        Item::Plant(p) if *p.name.text == *name => Some(p),
        _ => None,
    })
}

/// The names that a plant declares itself.
pub(super) fn plant_names(plant: &Plant) -> HashSet<&str> {
    plant.items.iter().flat_map(declared).map(|n| &*n.text).collect()
}

/// The names that an item of a plant declares.
pub(super) fn declared(item: &PlantItem) -> &[Name] {
    match item {
        PlantItem::Const { names, .. } => names,
        PlantItem::State(s) => &s.names,
        PlantItem::Parts(p) => std::slice::from_ref(&p.name),
        PlantItem::Arrivals(a) => std::slice::from_ref(&a.name),
        PlantItem::Rate(_)
        | PlantItem::Drive(_)
        | PlantItem::On(..)
        | PlantItem::Each(..)
        | PlantItem::View(_) => &[],
    }
}
