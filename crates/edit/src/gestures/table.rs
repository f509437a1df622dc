//! Charts and variables of the file.

use g7_model::{Chart, ChartItem, ChartKind, FileId, Item, Name, StepKind, VarDecl, say};

use crate::change::{Refusal, Source, refuse};
use crate::draft::Draft;
use crate::gesture::{ChartSort, Gesture, Row};
use crate::id::ItemId;

// Charts

/// Adds a chart after the last one of the file.
fn put_chart(d: &mut Draft<'_>, chart: Chart) {
    let behind = d.doc.items.iter().rposition(|i| matches!(i, Item::Chart(_)));
    let behind = behind.or_else(|| d.doc.items.iter().rposition(is_head));
    let k = behind.map_or(0, |k| k + 1);
    d.doc.items.insert(k, Item::Chart(chart));
}

/// True for items that stand before the charts.
fn is_head(item: &Item) -> bool {
    matches!(item, Item::Profile(_) | Item::Cycle(..) | Item::Target(..) | Item::Use(_) | Item::Var(_))
}

fn new_chart(d: &mut Draft<'_>, kind: ChartKind, name: &str) -> Chart {
    let (name, at) = (d.new_name(name), d.fresh());
    Chart { kind, name, params: Vec::new(), block: None, comment: None, every: None, items: Vec::new(), at }
}

/// Adds an expansion with an entry and an exit step; returns its name.
pub(crate) fn add_expansion(d: &mut Draft<'_>, base: &str) -> Result<String, Refusal> {
    let name = d.chart_name(base);
    with_ends(d, ChartKind::Expansion, &name);
    Ok(name)
}

/// Adds a chart that begins with an entry step and ends with an exit step.
fn with_ends(d: &mut Draft<'_>, kind: ChartKind, name: &str) {
    let mut chart = new_chart(d, kind, name);
    let (mut entry, mut exit) = (d.new_step("E"), d.new_step("S"));
    (entry.kind, exit.kind) = (StepKind::Entry, StepKind::Exit);
    let t = d.new_transition(&["E"], &["S"]);
    chart.items = vec![ChartItem::Step(entry), ChartItem::Step(exit), ChartItem::Transition(t)];
    put_chart(d, chart);
}

#[inline(never)]
pub(crate) fn add_chart(d: &mut Draft<'_>, kind: ChartSort, name: Option<&str>) -> Result<(), Refusal> {
    let base = match kind {
        ChartSort::Chart => "Chart",
        ChartSort::Expansion => "Expansion",
        ChartSort::Task => "Task",
    };
    let name = match name.map(str::trim).filter(|n| !n.is_empty()) {
        Some(name) if d.chart(name).is_ok() => {
            return refuse(say!("there is a chart `{name}` already"));
        }
        Some(name) => name.to_owned(),
        None => d.chart_name(base),
    };
    match kind {
        ChartSort::Chart => {
            let mut chart = new_chart(d, ChartKind::Chart, &name);
            let mut step = d.new_step("1");
            step.initial = true;
            chart.items = vec![ChartItem::Step(step)];
            put_chart(d, chart);
            d.select_step(&name, "1");
        }
        ChartSort::Expansion => with_ends(d, ChartKind::Expansion, &name),
        ChartSort::Task => with_ends(d, ChartKind::Task, &name),
    }
    if kind != ChartSort::Chart {
        d.select(ItemId::chart(name));
    }
    Ok(())
}

#[inline(never)]
pub(crate) fn delete_chart(d: &mut Draft<'_>, chart: &str) -> Result<(), Refusal> {
    d.chart(chart)?;
    let mut first = true;
    d.doc.items.retain(|item| match item {
        Item::Chart(c) if *c.name.text == *chart && first => {
            first = false;
            false
        }
        Item::Layout(l) => *l.chart.text != *chart,
        _ => true,
    });
    Ok(())
}

// Variables

/// The declarations of the file or of one of its charts.
fn declarations<'d>(d: &'d Draft<'_>, chart: Option<&str>) -> Result<Vec<&'d VarDecl>, Refusal> {
    Ok(match chart {
        Some(chart) => d.chart(chart)?.vars().collect(),
        None => {
            d.doc.items.iter().filter_map(|i| if let Item::Var(v) = i { Some(v) } else { None }).collect()
        }
    })
}

/// The chart and the name of a variable, from its name in the table.
pub(crate) fn split<'n>(d: &Draft<'_>, name: &'n str) -> (Option<&'n str>, &'n str) {
    for (k, _) in name.match_indices('.') {
        if let (Some(chart), Some(rest)) = (name.get(..k), name.get(k + 1..))
            && d.chart(chart).is_ok()
        {
            return (Some(chart), rest);
        }
    }
    (None, name)
}

pub(crate) fn declares(v: &VarDecl, name: &str) -> bool {
    v.names.iter().any(|n| *n.text == *name)
}

/// Removes a name from its declaration; true if the declaration still has a name.
fn forget(v: &mut VarDecl, name: &str) -> bool {
    v.names.retain(|n| *n.text != *name);
    !v.names.is_empty()
}

#[inline(never)]
pub(crate) fn delete_variable(d: &mut Draft<'_>, name: &str) -> Result<(), Refusal> {
    let (chart, name) = split(d, name);
    if !declarations(d, chart)?.iter().any(|v| declares(v, name)) {
        return refuse(say!("there is no variable `{name}`"));
    }
    match chart {
        Some(chart) => d.chart_mut(chart)?.items.retain_mut(|i| match i {
            ChartItem::Var(v) => forget(v, name),
            _ => true,
        }),
        None => d.doc.items.retain_mut(|i| match i {
            Item::Var(v) => forget(v, name),
            _ => true,
        }),
    }
    Ok(())
}

/// The change of a row that remains after the variable has got the row's new name; none if the name
/// stays.
pub(crate) fn renamed_row(source: &Source<'_>, name: &str, row: &Row) -> Option<Gesture> {
    let own = source.document.charts().find_map(|c| {
        let own = name.strip_prefix(&*c.name.text)?.strip_prefix('.')?;
        Some((format!("{}.", c.name.text), own))
    });
    let (chart, own) = own.unwrap_or((String::new(), name));
    let to = row.name.trim();
    (own != to).then(|| Gesture::Variable { name: Some(format!("{chart}{to}")), row: row.clone() })
}

#[inline(never)]
pub(crate) fn variable(d: &mut Draft<'_>, name: Option<&str>, row: &Row) -> Result<(), Refusal> {
    let mut new = declared(d, row)?;
    let (home, old) = match name {
        Some(name) => {
            let (chart, name) = split(d, name);
            (chart.map(str::to_owned), Some(name))
        }
        None => (row.chart.clone().filter(|c| !c.is_empty()), None),
    };
    let home = home.as_deref();
    let there = declarations(d, home)?;
    let clash = there.iter().any(|v| declares(v, &row.name)) && old != Some(row.name.as_str());
    if clash {
        return refuse(say!("there is a variable `{}` already", row.name));
    }
    let Some(old) = old else {
        return put_variable(d, home, new);
    };
    let Some(before) = there.into_iter().find(|v| declares(v, old)).cloned() else {
        return refuse(say!("there is no variable `{old}`"));
    };
    if before.names.len() == 1 {
        new.at = before.at;
        return change(d, home, before.at.0, vec![new]);
    }
    // It was declared together with others: it gets its own line after them.
    let mut rest = before.clone();
    rest.names.retain(|n| *n.text != *old);
    change(d, home, before.at.0, vec![rest, new])
}

/// Replaces a declaration by others.
#[inline(never)]
fn change(
    d: &mut Draft<'_>,
    home: Option<&str>,
    at: g7_model::Span,
    by: Vec<VarDecl>,
) -> Result<(), Refusal> {
    match home {
        Some(chart) => {
            let items = &mut d.chart_mut(chart)?.items;
            let k = items.iter().position(|i| matches!(i, ChartItem::Var(v) if v.at.0 == at));
            if let Some(k) = k {
                items.splice(k..=k, by.into_iter().map(ChartItem::Var));
            }
        }
        None => {
            let items = &mut d.doc.items;
            let k = items.iter().position(|i| matches!(i, Item::Var(v) if v.at.0 == at));
            if let Some(k) = k {
                items.splice(k..=k, by.into_iter().map(Item::Var));
            }
        }
    }
    Ok(())
}

/// Adds a declaration after the last of its class, otherwise after the last declaration.
#[inline(never)]
pub(crate) fn put_variable(d: &mut Draft<'_>, home: Option<&str>, new: VarDecl) -> Result<(), Refusal> {
    match home {
        Some(chart) => {
            let items = &mut d.chart_mut(chart)?.items;
            let class = |i: &ChartItem| matches!(i, ChartItem::Var(v) if v.kind == new.kind);
            let k = items.iter().rposition(class);
            let k = k.or_else(|| items.iter().rposition(|i| matches!(i, ChartItem::Var(_))));
            items.insert(k.map_or(0, |k| k + 1), ChartItem::Var(new));
        }
        None => {
            let items = &mut d.doc.items;
            let class = |i: &Item| matches!(i, Item::Var(v) if v.kind == new.kind);
            let k = items.iter().rposition(class);
            let before = |i: &Item| matches!(i, Item::Var(_));
            let k = k.or_else(|| items.iter().rposition(before));
            let k = k.or_else(|| items.iter().rposition(is_head));
            items.insert(k.map_or(0, |k| k + 1), Item::Var(new));
        }
    }
    Ok(())
}

/// The declaration that a row describes, with the values as typed.
#[inline(never)]
fn declared(d: &mut Draft<'_>, row: &Row) -> Result<VarDecl, Refusal> {
    if row.name.trim().is_empty() {
        return refuse(say!("a variable has a name"));
    }
    let class = if row.class.is_empty() { "var" } else { row.class.as_str() };
    if !["input", "output", "var", "const"].contains(&class) {
        return refuse(say!("`{class}` is not a class; a variable is input, output, var or const"));
    }
    let ty = if row.ty.trim().is_empty() { "BOOL" } else { row.ty.trim() };
    let mut line = format!("{class} {} : {ty}", g7_syntax::show_name(row.name.trim()));
    let mut part = |word: &str, text: &str| {
        if !text.trim().is_empty() {
            line.push_str(&format!(" {word} {}", text.trim()));
        }
    };
    part(":=", &row.init);
    let address = row.address.trim();
    let channel = address.starts_with('%') || address.starts_with('\'');
    let plain = channel || !address.is_empty() && address.chars().all(|c| c.is_alphanumeric() || c == '_');
    let quoted = format!("'{}'", address.replace('$', "$$").replace('\'', "$'"));
    part("at", if plain || address.is_empty() { address } else { &quoted });
    part("", if row.inverted { "inverted" } else { "" });
    part("", if row.retain { "retain" } else { "" });
    part("safe", &row.safe);
    if !row.comment.trim().is_empty() {
        part("", &g7_syntax::show_comment(row.comment.trim()));
    }
    let (doc, problems) = g7_syntax::parse(&line, FileId(0));
    if let Some(problem) = problems.first() {
        return refuse(say!("this is not a declaration: {}", problem.what));
    }
    let [Item::Var(v)] = doc.items.as_slice() else {
        return refuse(say!("this is more than one declaration"));
    };
    let mut v = v.clone();
    if v.names.len() != 1 || v.names.iter().any(|n| *n.text != *row.name.trim()) {
        return refuse(say!("this is more than one declaration"));
    }
    v.at = d.fresh();
    for (e, typed) in [(&mut v.init, &row.init), (&mut v.safe, &row.safe)] {
        if let Some(e) = e {
            e.at = d.fresh_as(typed.trim());
        }
    }
    v.names.iter_mut().for_each(|n: &mut Name| n.at = d.fresh());
    Ok(v)
}
