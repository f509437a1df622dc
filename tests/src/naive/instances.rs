//! Instances of charts with parameters, as charts of the naive engine.

use std::collections::BTreeMap;

use g7_model::{Chart, Document, Expr, ExprKind, InstanceNames, Item, Literal, Name, VarDecl, VarKind};

use super::block_charts::{Home, charts_of_var, charts_within};
use super::value::{Run, bad};

/// A chart that runs: its text, its name, and the values of its parameters.
pub(super) struct Made<'d> {
    pub(super) chart: &'d Chart,
    pub(super) name: String,
    pub(super) constants: Vec<VarDecl>,
    /// For a chart of a function block: the instance.
    pub(super) home: Option<Home>,
}

impl Made<'_> {
    /// The whole numbers among the values, for names such as `Axis[i + 1]`.
    pub(super) fn numbers(&self) -> BTreeMap<String, i128> {
        let number = |v: &VarDecl| Some((v.names[0].text.to_string(), v.init.as_ref()?.kind.whole()?));
        self.constants.iter().filter_map(number).collect()
    }
}

/// The charts that an item of a file stands for, those of the instances in their variables behind them.
pub(super) fn charts_of<'d>(doc: &'d Document, item: &'d Item) -> Run<Vec<Made<'d>>> {
    let mut all = Vec::new();
    for made in own_charts(doc, item)? {
        let within = if made.home.is_some() { Vec::new() } else { charts_within(doc, &made)? };
        all.push(made);
        all.extend(within);
    }
    Ok(all)
}

fn own_charts<'d>(doc: &'d Document, item: &'d Item) -> Run<Vec<Made<'d>>> {
    let i = match item {
        Item::Chart(chart) if chart.params.is_empty() && chart.block.is_none() => {
            let name = chart.name.text.to_string();
            return Ok(vec![Made { chart, name, constants: Vec::new(), home: None }]);
        }
        Item::Var(v) => return charts_of_var(doc, None, v),
        Item::Instance(i) => i,
        _ => return Ok(Vec::new()),
    };
    let Some(chart) = doc.charts().find(|c| c.name == i.chart || c.name.text == i.chart.text) else {
        return bad(format!("no chart {}", i.chart.text));
    };
    let mut all: Vec<(String, Vec<Expr>)> = Vec::new();
    match &i.names {
        InstanceNames::One(name) => all.push((name.text.to_string(), Vec::new())),
        InstanceNames::Range(least, most) => {
            for n in whole(doc, least)?..=whole(doc, most)? {
                let kind = ExprKind::Literal(Literal::Int(n, None));
                all.push((format!("{}[{n}]", chart.name.text), vec![Expr { kind, at: i.at }]));
            }
        }
    }
    all.into_iter()
        .map(|(name, mut values)| {
            for param in &chart.params[values.len()..] {
                let by_name = |n: &Name| n.text == param.name.text;
                let named = i.args.iter().find(|a| a.name.as_ref().is_some_and(by_name));
                let place = values.len() - usize::from(matches!(i.names, InstanceNames::Range(..)));
                let Some(value) = named.or(i.args.get(place).filter(|a| a.name.is_none())) else {
                    return bad(format!("no value of {}", param.name.text));
                };
                values.push(value.value.clone());
            }
            let constants = chart.params.iter().zip(values).map(|(p, value)| VarDecl {
                init: Some(value),
                ..VarDecl::of_type(VarKind::Const, vec![p.name.clone()], &p.ty, i.at)
            });
            Ok(Made { chart, name, constants: constants.collect(), home: None })
        })
        .collect()
}

/// A bound: a number, or a constant of the file.
pub(super) fn whole(doc: &Document, e: &Expr) -> Run<i128> {
    if let Some(n) = e.kind.whole() {
        return Ok(n);
    }
    let name = e.kind.variable().unwrap_or_default();
    let constant = doc.items.iter().find_map(|i| match i {
        Item::Var(v) if v.names.iter().any(|n| *n.text == *name) => v.init.as_ref()?.kind.whole(),
        _ => None,
    });
    constant.map_or_else(|| bad(format!("no number {name}")), Ok)
}

/// The name of a chart as an argument: `G`, `Axis[3]` or `Axis[i]`.
pub(super) fn chart_written(e: &Expr) -> Option<String> {
    match &e.kind {
        ExprKind::Path(path) => Some(path.text()),
        ExprKind::Element(path, index, None) => match index.as_slice() {
            [Expr { kind: ExprKind::Path(parameter), .. }] => {
                Some(format!("{}[{}]", path.text(), parameter.text()))
            }
            _ => e.kind.variable(),
        },
        _ => None,
    }
}

/// `Axis[i + 1]` as the instance whose parameters are these sees it: `Axis[4]`.
pub(super) fn numbered(name: &str, numbers: &BTreeMap<String, i128>) -> String {
    let Some((chart, inner)) = name.strip_suffix(']').and_then(|n| n.split_once('[')) else {
        return name.to_owned();
    };
    let words: Vec<&str> = inner.split(' ').collect();
    let number = |word: &str| numbers.get(word).copied().or_else(|| word.parse().ok());
    let value = match words[..] {
        [one] => number(one),
        [one, "+", n] => number(one).zip(number(n)).map(|(a, b)| a + b),
        [one, "-", n] => number(one).zip(number(n)).map(|(a, b)| a - b),
        _ => None,
    };
    value.map_or_else(|| name.to_owned(), |v| format!("{chart}[{v}]"))
}
