//! The gestures: each changes the draft.

mod build;
mod chosen;
mod delete;
mod fields;
mod forms;
mod graph;
mod group;
mod heal;
mod hold;
mod insert;
mod join;
mod layout_section;
mod nodes;
mod notes;
mod paste;
mod places;
mod relink;
mod rename;
mod settings;
mod table;
mod unread;
mod view;

pub(crate) use fields::actions;
pub use heal::Joined;
pub(crate) use heal::joins;
pub(crate) use hold::hold;
pub use rename::Renaming;
pub(crate) use rename::{rename, rename_at};
pub(crate) use table::renamed_row;
pub(crate) use view::binding_at;

use g7_model::say;

use crate::change::{Refusal, refuse};
use crate::draft::Draft;
use crate::gesture::Gesture;

/// Changes the draft; renaming and typing are handled elsewhere.
#[inline(never)]
pub(crate) fn carry_out(d: &mut Draft<'_>, gesture: &Gesture) -> Result<(), Refusal> {
    match gesture {
        Gesture::AddStep { chart, at, kind } => build::add_step(d, chart, *at, *kind),
        Gesture::Next { id } => build::next(d, id),
        Gesture::Before { id } => build::before(d, id),
        Gesture::Connect { from, to } => join::connect(d, from, to),
        Gesture::Relink { link, end, to } => relink::relink(d, link, *end, to),
        Gesture::Insert { link, what } => insert::insert(d, link, *what),
        Gesture::Branch { id, how } => build::branch(d, id, *how),
        Gesture::Converge { ids, how, to } => join::converge(d, ids, *how, to.as_ref()),
        Gesture::Jump { id, to } => join::jump(d, id, to),
        Gesture::Parallel { ids } => insert::parallel(d, ids),
        Gesture::Delete { ids, heal } => delete::delete(d, ids, *heal),
        Gesture::Cut { ids } => delete::delete(d, ids, false),
        Gesture::Receptivity { id, text } => fields::receptivity(d, id, text),
        Gesture::Action { id, index, text } => fields::action(d, id, *index, text),
        Gesture::Comment { id, text } => fields::comment(d, id, text),
        Gesture::CommentAt { chart, text, at } => notes::add(d, chart, text, *at),
        Gesture::Label { id, text } => fields::label(d, id, text),
        Gesture::Priority { id, n } => fields::priority(d, id, *n),
        Gesture::Ends { id, before, after } => fields::ends(d, id, before.as_deref(), after.as_deref()),
        Gesture::Initial { id, on } => fields::initial(d, id, *on),
        Gesture::Kind { id, kind } => fields::kind(d, id, *kind),
        Gesture::Move { ids, dx, dy } => places::shift(d, ids, *dx, *dy),
        Gesture::Align { ids, how } => places::align(d, ids, *how),
        Gesture::Bend { link, points } => places::bend(d, link, points),
        Gesture::LinkForm { link, form } => forms::link(d, link, *form),
        Gesture::ActionForm { id, form } => forms::actions(d, id, *form),
        Gesture::Sheet { chart, at } => forms::sheet(d, chart.as_deref(), *at),
        Gesture::Tidy { chart } => places::tidy(d, chart),
        Gesture::Paste { chart, text, at } => paste::paste(d, chart, text, *at),
        Gesture::Macro { ids } => group::into_macro(d, ids),
        Gesture::AddChart { kind, name } => table::add_chart(d, *kind, name.as_deref()),
        Gesture::DeleteChart { chart } => table::delete_chart(d, chart),
        Gesture::Variable { name, row } => table::variable(d, name.as_deref(), row),
        Gesture::Declare { rows, with } => {
            with.as_ref().map_or(Ok(()), |gesture| carry_out(d, gesture))?;
            rows.iter().try_for_each(|row| table::variable(d, None, row))
        }
        Gesture::DeleteVariable { name } => table::delete_variable(d, name),
        Gesture::Profile { name } => settings::profile(d, name),
        Gesture::Switch { name, on } => settings::switch(d, name, *on),
        Gesture::Bound { n } => settings::bound(d, *n),
        Gesture::Scan { ms } => settings::scan(d, *ms),
        Gesture::View { plant, file, bindings } => view::view(d, plant, file, bindings),
        Gesture::Rename { .. } | Gesture::Text { .. } => {
            refuse(say!("this gesture is not one of the drawing"))
        }
    }
}
