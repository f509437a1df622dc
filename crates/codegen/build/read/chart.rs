//! The items that the runtime asks of a chart: facts, tables, functions.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use g7_runtime::source::File;
use syn::{Item, Type};

use super::{Result, wrong};

/// The names of `chart.rs`, by what they are.
#[derive(Debug, Default)]
pub(crate) struct Chart {
    /// Truth values and sizes.
    pub(crate) facts: BTreeSet<String>,
    /// Facts that are truth values.
    pub(crate) truths: BTreeSet<String>,
    /// Tables of the chart.
    pub(crate) tables: BTreeSet<String>,
    /// Functions of the chart.
    pub(crate) functions: BTreeSet<String>,
    fields: String,
}

/// The text of a documentation comment.
pub(crate) fn note(attributes: &[syn::Attribute]) -> String {
    let mut lines = Vec::new();
    for a in attributes.iter().filter(|a| a.path().is_ident("doc")) {
        if let syn::Meta::NameValue(v) = &a.meta
            && let syn::Expr::Lit(syn::ExprLit { lit: syn::Lit::Str(s), .. }) = &v.value
        {
            lines.push(s.value().trim().to_owned());
        }
    }
    lines.join("\n")
}

/// The one word that a type is.
pub(crate) fn word(ty: &Type) -> Option<String> {
    match ty {
        Type::Path(p) => p.path.get_ident().map(ToString::to_string),
        _ => None,
    }
}

impl Chart {
    pub(crate) fn read(file: &File) -> Result<Chart> {
        let items = match syn::parse_file(file.text) {
            Ok(parsed) => parsed.items,
            Err(e) => return wrong(file, e),
        };
        let mut chart = Chart::default();
        let (mut has_row, mut has_tick) = (false, false);
        for item in items {
            match item {
                Item::Const(c) => {
                    let name = c.ident.to_string();
                    let ty = match word(&c.ty).as_deref() {
                        Some("bool") => "bool",
                        Some("usize" | "u32") => "usize",
                        _ => return wrong(file, format!("`{name}` is neither a truth value nor a size")),
                    };
                    if ty == "bool" {
                        chart.truths.insert(name.clone());
                    }
                    let note = note(&c.attrs);
                    let _ = writeln!(chart.fields, "    /// {note}\n    pub(crate) {}: {ty},", field(&name));
                    chart.facts.insert(name);
                }
                Item::Static(s) => {
                    chart.tables.insert(s.ident.to_string());
                }
                Item::Fn(f) => {
                    chart.functions.insert(f.sig.ident.to_string());
                }
                Item::Type(t) if t.ident == "Row" => has_row = true,
                Item::Type(t) if t.ident == "Tick" => has_tick = true,
                _ => return wrong(file, "neither a fact nor a table nor a function"),
            }
        }
        if has_row && has_tick { Ok(chart) } else { wrong(file, "no type `Row` or `Tick`") }
    }

    /// The structure in which `codegen` gives every fact its value.
    pub(crate) fn facts(&self) -> String {
        format!(
            "/// The parts of the runtime that a chart needs, and how much room.\n#[derive(Clone, Debug, Default)]\n\
             pub(crate) struct Facts {{\n    /// Bits of a number of a step, a transition, an action.\n    \
             pub(crate) row_bits: u8,\n    /// Bits of a time as the clock gives it.\n    pub(crate) tick_bits: u8,\n{}}}\n\n",
            self.fields
        )
    }
}

/// The field of a fact.
pub(crate) fn field(fact: &str) -> String {
    fact.to_lowercase()
}
