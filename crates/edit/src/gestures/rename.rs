//! Renames a step, chart, variable or other named part wherever it is used.
//!
//! Each use is written as its place requires: in back-ticks, after the `X` of `X12`, within `%X12`.
//! Afterwards every name of the file must refer to the same part as before; a new name that would
//! hide another, or be hidden by one, is refused. In a text with syntax errors a change that could miss a use is
//! refused as well, with the line of that place (`unread`).

use g7_compile::references::{Use, Written};
use g7_compile::{Definition, References, references};
use g7_model::{Document, FileId, Item, Said, Span, codes, say};
use g7_syntax::{show_name, show_path_name, show_step_name};

use crate::change::{Edit, Refusal, Source, refuse};
use crate::id::{ItemId, Part};
use crate::reading::{mended_first, read, same_problems};
use crate::splice::{Splice, tidied};

use super::unread::unread;

/// Renames a part everywhere.
#[inline(never)]
pub(crate) fn rename(
    source: &Source<'_>,
    id: Option<&ItemId>,
    name: Option<&str>,
    to: &str,
) -> Result<Edit, Refusal> {
    let refs = references(source.document);
    let definition = defined(source, &refs, id, name)?;
    let edit = everywhere(source, &refs, definition, to)?;
    Ok(Edit { select: selected(id, to.trim()), ..edit })
}

/// Renames the part that is named at a byte of the text.
pub(crate) fn rename_at(source: &Source<'_>, at: usize, to: &str) -> Result<Edit, Refusal> {
    let refs = references(source.document);
    match refs.at(u32::try_from(at).unwrap_or(u32::MAX)).cloned() {
        Some(definition) => everywhere(source, &refs, definition, to),
        None => refuse(say!("there is no name here that can be changed")),
    }
}

/// A part under its old and its new name, for a change in the texts of one or more files.
#[derive(Clone, Debug)]
pub struct Renaming {
    old: Definition,
    new: Definition,
    to: String,
}

impl Renaming {
    /// Another name for a part.
    ///
    /// # Errors
    ///
    /// The name is empty.
    pub fn new(old: Definition, to: &str) -> Result<Renaming, Refusal> {
        let to = to.trim();
        if to.is_empty() {
            return refuse(say!("a name cannot be empty"));
        }
        Ok(Renaming { new: renamed(&old, to), old, to: to.to_owned() })
    }

    /// True if the part has this name already.
    pub fn is_nothing(&self) -> bool {
        self.new == self.old
    }

    /// The two names, without what stands before them.
    pub fn names(&self) -> [&str; 2] {
        [last_name(&self.old), last_name(&self.new)]
    }

    /// Refuses if the new name is that of another part.
    ///
    /// # Errors
    ///
    /// It is.
    pub fn free(&self, document: &Document, refs: &References) -> Result<(), Refusal> {
        if refs.declaration(&self.new).is_some() || taken(document, &self.new) {
            return refuse(there_already(&self.old, &self.to));
        }
        Ok(())
    }

    /// The change of the text of one file of a document: each use there, written with the new name.
    ///
    /// # Errors
    ///
    /// A place cannot have the name.
    pub fn splices(&self, refs: &References, file: FileId, text: &str) -> Result<Vec<Splice>, Refusal> {
        let uses = refs.uses_of(&self.old).filter(|found| found.at.file == file);
        let splices = uses.map(|found| written(text, found, &self.to)).collect::<Result<_, _>>()?;
        Ok(tidied(text, splices))
    }

    /// Refuses unless each name of a document refers to the same part after the change as before. `splices(file)` are the
    /// changes of the text of that file.
    ///
    /// # Errors
    ///
    /// A name refers to another part.
    pub fn keeps_the_rest<'s>(
        &self,
        before: &References,
        after: &References,
        splices: impl Fn(FileId) -> &'s [Splice],
    ) -> Result<(), Refusal> {
        let meant =
            |d: &Definition| if *d == self.old { self.new.clone() } else { within(d, &self.old, &self.new) };
        let same = before.all().len() == after.all().len()
            && before.all().iter().zip(after.all()).all(|(a, b)| {
                b.definition == meant(&a.definition)
                    && a.at.file == b.at.file
                    && shifted(splices(a.at.file), a.at) == b.at.start as usize
            });
        if same {
            return Ok(());
        }
        refuse(say!(
            "with this name something would mean another thing than before: `{}` is in use",
            last_name(&self.new)
        ))
    }
}

#[inline(never)]
fn everywhere(
    source: &Source<'_>,
    refs: &References,
    definition: Definition,
    to: &str,
) -> Result<Edit, Refusal> {
    let renaming = Renaming::new(definition, to)?;
    if renaming.is_nothing() {
        return Ok(Edit::default());
    }
    renaming.free(source.document, refs)?;
    whole(source, refs, &renaming)?;
    let splices = renaming.splices(refs, FileId(0), source.text)?;
    let tree = read(source, &splices).ok_or_else(|| Refusal::new(say!("the name cannot be written here")))?;
    same_problems(source, &splices, &tree)?;
    renaming.keeps_the_rest(refs, &references(&tree.document), |_| &splices)?;
    Ok(Edit { splices, read: Some(Box::new(tree)), ..Edit::default() })
}

/// Refuses if a place that could not be read may hold the name.
#[inline(never)]
fn whole(source: &Source<'_>, refs: &References, renaming: &Renaming) -> Result<(), Refusal> {
    if source.problems.iter().any(|p| p.code == &codes::TOO_MANY_PROBLEMS) {
        return refuse(mended_first());
    }
    for name in renaming.names() {
        if let Some(place) = unread(source, refs, &renaming.old, name) {
            let line = source.text.get(..place.start).unwrap_or_default().matches('\n').count() + 1;
            return refuse(say!(
                "line {line} may name `{name}`; this is known only when the syntax errors are corrected"
            ));
        }
    }
    Ok(())
}

/// The part to be renamed, under its old and its new name.
#[inline(never)]
fn defined(
    source: &Source<'_>,
    refs: &References,
    id: Option<&ItemId>,
    name: Option<&str>,
) -> Result<Definition, Refusal> {
    let found = match (id, name) {
        (Some(id), _) => match &id.part {
            Part::Chart => Definition::Chart(id.chart.clone()),
            Part::Step(name) | Part::Action(name, _) => {
                Definition::Step { chart: id.chart.clone(), name: name.clone() }
            }
            Part::Transition(n) => {
                let chart = source.document.charts().find(|c| *c.name.text == *id.chart);
                // Transitions are counted, and one that was passed over is not.
                let whole = |c: &g7_model::Chart| {
                    source.reads_cleanly(c.at.0.start as usize + 1..c.at.0.end as usize)
                };
                if chart.is_some_and(|c| !whole(c)) {
                    return refuse(mended_first());
                }
                let label = chart.and_then(|c| c.transitions().nth(*n)).and_then(|t| t.label.as_ref());
                let Some(label) = label else {
                    return refuse(say!("this transition has no label; give it one first"));
                };
                Definition::Transition { chart: id.chart.clone(), label: label.text.to_string() }
            }
            Part::Link(..) | Part::Connector(..) | Part::Note(_) | Part::Other(_) => {
                return refuse(say!("this has no name of its own"));
            }
        },
        (None, Some(name)) => by_name(source, refs, name),
        (None, None) => return refuse(say!("nothing is chosen")),
    };
    if refs.declaration(&found).is_none() {
        return refuse(none_such(&found));
    }
    Ok(found)
}

/// The variable with the name that the table shows (`Chart.name` for one of a chart); otherwise any
/// other part with that name.
#[inline(never)]
fn by_name(source: &Source<'_>, refs: &References, name: &str) -> Definition {
    let split = source.document.charts().find_map(|c| {
        let rest = name.strip_prefix(&*c.name.text)?.strip_prefix('.')?;
        Some((c.name.text.to_string(), rest.to_owned()))
    });
    let whole = name.to_owned();
    let mut candidates = Vec::new();
    if let Some((chart, name)) = split {
        candidates.push(Definition::Variable { chart: Some(chart.clone()), name: name.clone() });
        candidates.push(Definition::Action { chart: Some(chart.clone()), name: name.clone() });
        candidates.push(Definition::Section { chart: Some(chart.clone()), name: name.clone() });
        candidates.push(Definition::Step { chart, name });
    }
    candidates.push(Definition::Action { chart: None, name: whole.clone() });
    candidates.push(Definition::Section { chart: None, name: whole.clone() });
    candidates.push(Definition::Function(whole.clone()));
    candidates.push(Definition::Chart(whole.clone()));
    candidates.push(Definition::Plant(whole.clone()));
    candidates.push(Definition::Type(whole.clone()));
    let first = Definition::Variable { chart: None, name: whole };
    if refs.declaration(&first).is_some() {
        return first;
    }
    candidates.into_iter().find(|c| refs.declaration(c).is_some()).unwrap_or(first)
}

#[inline(never)]
fn renamed(definition: &Definition, to: &str) -> Definition {
    let to = to.to_owned();
    match definition.clone() {
        Definition::Chart(_) => Definition::Chart(to),
        Definition::Step { chart, .. } => Definition::Step { chart, name: to },
        Definition::Variable { chart, .. } => Definition::Variable { chart, name: to },
        Definition::Action { chart, .. } => Definition::Action { chart, name: to },
        Definition::Section { chart, .. } => Definition::Section { chart, name: to },
        Definition::Function(_) => Definition::Function(to),
        Definition::Type(_) => Definition::Type(to),
        Definition::Member { of, .. } => Definition::Member { of, name: to },
        Definition::Value { of, .. } => Definition::Value { of, name: to },
        Definition::Transition { chart, .. } => Definition::Transition { chart, label: to },
        Definition::Plant(_) => Definition::Plant(to),
        Definition::PlantItem { plant, .. } => Definition::PlantItem { plant, name: to },
    }
}

/// A thing of this kind has the name already.
#[inline(never)]
fn there_already(definition: &Definition, to: &str) -> Said {
    match definition {
        Definition::Chart(_) => say!("there is a chart `{to}` already"),
        Definition::Step { .. } => say!("there is a step `{to}` already"),
        Definition::Variable { .. } => say!("there is a variable `{to}` already"),
        Definition::Action { .. } => say!("there is an action `{to}` already"),
        Definition::Section { .. } => say!("there is a section `{to}` already"),
        Definition::Function(_) => say!("there is a function `{to}` already"),
        Definition::Type(_) => say!("there is a type `{to}` already"),
        Definition::Member { of, .. } => say!("there is a member `{to}` of `{of}` already"),
        Definition::Value { of, .. } => say!("there is a value `{to}` of `{of}` already"),
        Definition::Transition { .. } => say!("there is a label `{to}` already"),
        Definition::Plant(_) => say!("there is a plant `{to}` already"),
        Definition::PlantItem { .. } => say!("there is a state of the plant `{to}` already"),
    }
}

/// Nothing of this kind has the name.
#[inline(never)]
fn none_such(definition: &Definition) -> Said {
    match definition {
        Definition::Chart(_) => say!("there is no chart with this name"),
        Definition::Step { .. } => say!("there is no step with this name"),
        Definition::Variable { .. } => say!("there is no variable with this name"),
        Definition::Action { .. } => say!("there is no action with this name"),
        Definition::Section { .. } => say!("there is no section with this name"),
        Definition::Function(_) => say!("there is no function with this name"),
        Definition::Type(_) => say!("there is no type with this name"),
        Definition::Member { .. } => say!("there is no member with this name"),
        Definition::Value { .. } => say!("there is no value with this name"),
        Definition::Transition { .. } => say!("there is no label with this name"),
        Definition::Plant(_) => say!("there is no plant with this name"),
        Definition::PlantItem { .. } => say!("there is no state of the plant with this name"),
    }
}

/// True if a part of another kind in the same name space has the name.
#[inline(never)]
fn taken(document: &Document, new: &Definition) -> bool {
    let (chart, name) = match new {
        Definition::Variable { chart, name }
        | Definition::Action { chart, name }
        | Definition::Section { chart, name } => (chart.as_deref(), name),
        Definition::Function(name) => (None, name),
        _ => return false,
    };
    let is = |n: &g7_model::Name| *n.text == **name;
    match chart {
        Some(chart) => {
            use g7_model::ChartItem;
            let home = document.charts().find(|c| *c.name.text == *chart);
            home.is_some_and(|c| {
                c.items.iter().any(|i| match i {
                    ChartItem::Var(v) => v.names.iter().any(is),
                    ChartItem::Action(a) => is(&a.name),
                    ChartItem::Section(s) => is(&s.name),
                    _ => false,
                })
            })
        }
        None => document.items.iter().any(|i| match i {
            Item::Var(v) => v.names.iter().any(is),
            Item::Action(a) => is(&a.name),
            Item::Section(s) => is(&s.name),
            Item::Function(f) => is(&f.name),
            _ => false,
        }),
    }
}

/// One use of the part, written with the new name.
#[inline(never)]
pub(crate) fn written(text: &str, found: &Use, to: &str) -> Result<Splice, Refusal> {
    let (start, end) = (found.at.start as usize, found.at.end as usize);
    let old = text.get(start..end).unwrap_or_default();
    let text = match found.written {
        Written::Declared if matches!(found.definition, Definition::Transition { .. }) => show_step_name(to),
        Written::Declared | Written::Name => show_name(to),
        Written::Step => show_step_name(to),
        Written::Path { first, only } => {
            let before: String = old.trim_start_matches('`').chars().take(found.before).collect();
            show_path_name(&format!("{before}{to}"), first, only)
        }
        Written::Direct => return direct(found, old, to).map(|t| Splice::new(start, end, t)),
    };
    Ok(Splice::new(start, end, text))
}

/// Writes `%X12`, `%XM3` or `%X3.12` with another number.
#[inline(never)]
fn direct(found: &Use, old: &str, to: &str) -> Result<String, Refusal> {
    let Definition::Step { name, .. } = &found.definition else { return Ok(old.to_owned()) };
    let number = to.strip_prefix('M').filter(|_| name.starts_with('M')).unwrap_or(to);
    let no = || Refusal::new(say!("`{old}` names this step, so its name must stay a number"));
    if number.is_empty() || !number.bytes().all(|b| b.is_ascii_digit()) {
        return Err(no());
    }
    let digits = name.trim_start_matches('M');
    let (head, rest) = old.split_at(2.min(old.len()));
    let mut parts: Vec<String> = rest.split('.').map(str::to_owned).collect();
    let inner = parts.len() > 1 && parts.get(1).is_some_and(|p| p != "T" && p != "t");
    let named = |part: &String| part.trim_start_matches(['M', 'm']) == digits;
    // `%X3.12` refers to the macro-step or to the step in it; the definition says to which.
    let k = match (inner, parts.get(1).is_some_and(named)) {
        (true, true) => 1,
        (true, false)
            if parts.get(1).is_some_and(|p| p == "IN" || p == "OUT") && !parts.first().is_some_and(named) =>
        {
            return Ok(old.to_owned());
        }
        _ => 0,
    };
    let part = parts.get_mut(k).ok_or_else(no)?;
    let letters: String = part.chars().take_while(|c| c.is_ascii_alphabetic()).collect();
    *part = format!("{letters}{number}");
    Ok(format!("{head}{}", parts.join(".")))
}

/// The definition of a part under the new name of the chart, type or plant that contains it.
#[inline(never)]
fn within(d: &Definition, old: &Definition, new: &Definition) -> Definition {
    let mut d = d.clone();
    match (old, new, &mut d) {
        (
            Definition::Chart(a),
            Definition::Chart(b),
            Definition::Step { chart, .. } | Definition::Transition { chart, .. },
        ) if chart == a => {
            chart.clone_from(b);
        }
        (
            Definition::Chart(a),
            Definition::Chart(b),
            Definition::Variable { chart: Some(chart), .. }
            | Definition::Action { chart: Some(chart), .. }
            | Definition::Section { chart: Some(chart), .. },
        ) if chart == a => chart.clone_from(b),
        (Definition::Plant(a), Definition::Plant(b), Definition::PlantItem { plant, .. }) if plant == a => {
            plant.clone_from(b);
        }
        (
            Definition::Type(a),
            Definition::Type(b),
            Definition::Member { of, .. } | Definition::Value { of, .. },
        ) if of == a => of.clone_from(b),
        _ => {}
    }
    d
}

/// Where a place of the old text begins in the new text.
fn shifted(splices: &[Splice], at: Span) -> usize {
    let start = at.start as usize;
    let mut shift = 0isize;
    for s in splices.iter().take_while(|s| s.start < start && s.end <= start) {
        shift += s.insert.len() as isize - (s.end - s.start) as isize;
    }
    start.saturating_add_signed(shift)
}

pub(super) fn last_name(definition: &Definition) -> &str {
    match definition {
        Definition::Chart(n) | Definition::Function(n) | Definition::Type(n) | Definition::Plant(n) => n,
        Definition::Step { name, .. }
        | Definition::Variable { name, .. }
        | Definition::Action { name, .. }
        | Definition::Section { name, .. }
        | Definition::Member { name, .. }
        | Definition::Value { name, .. }
        | Definition::PlantItem { name, .. } => name,
        Definition::Transition { label, .. } => label,
    }
}

fn selected(id: Option<&ItemId>, to: &str) -> Vec<ItemId> {
    let Some(id) = id else { return Vec::new() };
    let mut id = id.clone();
    match &mut id.part {
        Part::Chart => to.clone_into(&mut id.chart),
        Part::Step(_) | Part::Action(..) => id.part = Part::Step(to.to_owned()),
        Part::Transition(_) | Part::Link(..) | Part::Connector(..) | Part::Note(_) | Part::Other(_) => {}
    }
    vec![id]
}
