//! The tables of inputs and outputs, of other variables, and of types and instances.

use g7_ide::tables::declared_type;
use g7_model::words::Told;
use g7_model::{Chart, ChartItem, InstanceNames, Item, Name, Span, VarDecl, VarKind};

use crate::charts::written;
use crate::data::Input;
use crate::flow::Flow;
use crate::table::Table;
use crate::words;

/// A declared name.
pub(crate) struct Declared<'a> {
    pub(crate) name: &'a Name,
    pub(crate) of: &'a VarDecl,
    /// The chart that has it.
    pub(crate) chart: Option<&'a Chart>,
}

/// The variables of the file and of its charts, in the order of the text.
pub(crate) fn declared<'a>(input: &Input<'a>) -> impl Iterator<Item = Declared<'a>> {
    let of = |chart: Option<&'a Chart>, of: &'a VarDecl| {
        of.names.iter().map(move |name| Declared { name, of, chart }).collect::<Vec<_>>()
    };
    input.source.whole().items.iter().flat_map(move |item| match item {
        Item::Var(v) => of(None, v),
        Item::Chart(c) => {
            let own = |i: &'a ChartItem| if let ChartItem::Var(v) = i { of(Some(c), v) } else { Vec::new() };
            c.items.iter().flat_map(own).collect()
        }
        _ => Vec::new(),
    })
}

/// Inputs and outputs.
pub(crate) fn signals(flow: &mut Flow, input: &Input<'_>) {
    let told = |word| input.language.told(word);
    flow.part(told(words::SIGNALS));
    let mut table = Table::new(&[
        (told(words::NAME), 26),
        (told(words::CLASS), 12),
        (told(words::CHANNEL), 18),
        (told(words::TYPE), 16),
        (told(words::SAFE), 14),
        (told(words::COMMENT), 34),
    ]);
    for d in declared(input) {
        let class = match d.of.kind {
            VarKind::Input => words::INPUT,
            VarKind::Output => words::OUTPUT,
            VarKind::Var | VarKind::Const => continue,
        };
        let mut channel = d.of.address.as_ref().map_or(String::new(), |a| a.text.to_string());
        if d.of.inverted {
            channel = format!("{channel} ({})", told(words::INVERTED)).trim_start().to_owned();
        }
        let safe = match (&d.of.safe, d.of.kind) {
            (Some(value), _) => written(input, value.at.0),
            (None, VarKind::Output) => "0".to_owned(),
            (None, _) => String::new(),
        };
        let comment = d.of.comment.as_deref().unwrap_or_default().to_owned();
        let name = d.name.text.to_string();
        table.row(vec![name, told(class).to_owned(), channel, declared_type(d.of), safe, comment]);
    }
    table.write_or(flow, told(words::NONE));
}

/// Other variables and constants, then types and instances.
pub(crate) fn variables(flow: &mut Flow, input: &Input<'_>) {
    let told = |word| input.language.told(word);
    flow.part(told(words::VARIABLES));
    let mut table = Table::new(&[
        (told(words::NAME), 26),
        (told(words::CLASS), 14),
        (told(words::TYPE), 20),
        (told(words::START), 20),
        (told(words::OWNER), 16),
        (told(words::COMMENT), 34),
    ]);
    for d in declared(input) {
        let class = match d.of.kind {
            VarKind::Var => words::VAR,
            VarKind::Const => words::CONST,
            VarKind::Input | VarKind::Output => continue,
        };
        let mut class = told(class).to_owned();
        if d.of.retain {
            class = format!("{class}, {}", told(words::RETAIN));
        }
        if let Some(address) = &d.of.address {
            class = format!("{class}, {}", address.text);
        }
        let owner = d.chart.map_or(told(words::FILE_ITSELF).to_owned(), |c| c.name.text.to_string());
        let init = d.of.init.as_ref().map_or(String::new(), |e| written(input, e.at.0));
        let comment = d.of.comment.as_deref().unwrap_or_default().to_owned();
        table.row(vec![d.name.text.to_string(), class, declared_type(d.of), init, owner, comment]);
    }
    table.write_or(flow, told(words::NONE));
    types(flow, input);
    instances(flow, input);
}

fn types(flow: &mut Flow, input: &Input<'_>) {
    let rows = input.source.whole().items.iter().filter_map(|item| match item {
        Item::Type(t) => Some((t.names.first().map_or("", |n| &*n.text), t.at.0)),
        _ => None,
    });
    as_written(flow, input, words::TYPES, rows);
}

fn instances(flow: &mut Flow, input: &Input<'_>) {
    let rows = input.source.whole().items.iter().filter_map(|item| match item {
        Item::Instance(i) => Some(match &i.names {
            InstanceNames::One(name) => (&*name.text, i.at.0),
            InstanceNames::Range(..) => (&*i.chart.text, i.at.0),
        }),
        _ => None,
    });
    as_written(flow, input, words::INSTANCES, rows);
}

/// A table of declarations as they are written, if there are any.
fn as_written<'n>(
    flow: &mut Flow,
    input: &Input<'_>,
    heading: Told,
    rows: impl Iterator<Item = (&'n str, Span)>,
) {
    let told = |word| input.language.told(word);
    let mut table = Table::new(&[(told(words::NAME), 24), (told(words::DECLARATION), 96)]);
    rows.for_each(|(name, at)| table.row(vec![name.to_owned(), written(input, at)]));
    if !table.is_empty() {
        flow.heading(1, told(heading));
        table.write(flow);
    }
}
