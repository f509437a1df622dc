//! SCL for TIA Portal (S7-1200, S7-1500): a source with the function block and its instance, and a table of PLC
//! tags for the variables with addresses.

use std::fmt::Write;

use g7_iec::xml::element::Element;
use g7_model::{Problem, Said, Span, say};

use super::rewrite::{self, Refused};
use crate::plc::form::{Block, Declared, Ex};
use crate::plc::st;

/// The source, and the table of tags.
///
/// # Errors
///
/// Parts that SCL cannot say, at `place`.
pub(crate) fn print(e: &Block, place: Span) -> Result<(String, String), Vec<Problem>> {
    let mut refused = Refused::default();
    let own = rewrite::block(e, &mut |e| word(e, &mut refused));
    refused.problems(place)?;
    let mut out = String::new();
    let _ =
        writeln!(out, "FUNCTION_BLOCK \"{}\"\n{{ S7_Optimized_Access := 'TRUE' }}\nVERSION : 0.1", e.name);
    for note in &e.notes {
        let _ = writeln!(out, "// {}", st::plain(note));
    }
    for (head, list) in st::sections(&own.variables) {
        let _ = writeln!(out, "   {head}");
        list.into_iter().for_each(|v| out += &declared(v));
        out += "   END_VAR\n";
    }
    let _ = write!(
        out,
        "BEGIN\n{}END_FUNCTION_BLOCK\n\nDATA_BLOCK \"{name}_data\"\n{{ S7_Optimized_Access := 'TRUE' }}\n\
         VERSION : 0.1\n\"{name}\"\nBEGIN\nEND_DATA_BLOCK\n",
        st::body(&own, "#FAULT"),
        name = e.name
    );
    Ok((out, tags(e)))
}

fn declared(v: &Declared) -> String {
    // The timer of IEC 61131-3 is an instruction of the system there.
    let (pragma, v) = match v.ty.as_str() {
        "TON" => (
            " {InstructionName := 'TON_TIME'; LibVersion := '1.0'}",
            &Declared { ty: "TON_TIME".into(), ..v.clone() },
        ),
        _ => ("", v),
    };
    let note = if v.note.is_empty() { String::new() } else { format!("   // {}", st::plain(&v.note)) };
    format!("      {}{pragma} : {};{note}\n", v.name, st::type_text(v))
}

/// Variables of the block begin with `#`; the inputs of functions are named.
fn word(e: Ex, refused: &mut Refused) -> Ex {
    match e {
        Ex::Var(name) => Ex::Var(format!("#{name}")),
        Ex::Index(name, index) => Ex::Index(format!("#{name}"), index),
        Ex::Call(name, args) => {
            let inputs: Vec<&str> = match name.as_str() {
                "MIN" | "MAX" => (1..=args.len())
                    .map(|i| ["IN1", "IN2", "IN3"].get(i - 1).copied().unwrap_or(""))
                    .collect(),
                "SEL" => vec!["G", "IN0", "IN1"],
                "LIMIT" => vec!["MN", "IN", "MX"],
                "SHL" | "SHR" | "ROL" | "ROR" => vec!["IN", "N"],
                "EXPT" => match <[Ex; 2]>::try_from(args) {
                    Ok([a, b]) => return Ex::op("**", a, b),
                    Err(args) => return Ex::Call(name, args),
                },
                "MUX" => {
                    refused.add(say!("the function MUX cannot be printed as SCL"));
                    Vec::new()
                }
                _ => return Ex::Call(name, args),
            };
            if inputs.len() != args.len() || inputs.contains(&"") {
                refused.add(say!("{} of so many values cannot be printed as SCL", Said::foreign(&name)));
            }
            let given = inputs.into_iter().zip(args).map(|(input, e)| Ex::op(":=", Ex::var(input), e));
            Ex::Call(name, given.collect())
        }
        e => rewrite::timed(e, refused),
    }
}

fn tags(e: &Block) -> String {
    let mut table = Element::new("Tagtable").with("name", &e.name);
    for v in &e.variables {
        let Some((address, note)) = v.addressed() else { continue };
        let tag = Element::with_text("Tag", &v.name).with("type", &v.ty).with("hmiVisible", "True");
        let tag = tag.with("hmiWriteable", "True").with("hmiAccessible", "True").with("retain", "False");
        table.push(tag.with("remark", note).with("addr", format!("%{address}")));
    }
    let mut text = "<?xml version='1.0' encoding='utf-8'?>\n".to_owned();
    table.print(0, &mut text);
    text
}
