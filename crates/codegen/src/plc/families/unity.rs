//! Control Expert and Unity Pro: a section in Structured Text with its variables (`.XST`).

use g7_iec::xml::controlexpert;
use g7_iec::xml::element::Element;
use g7_model::{Problem, Said, Span, say};

use super::rewrite::{self, Refused};
use crate::plc::form::{Block, Declared, Ex, not_printed};
use crate::plc::st;

/// The file.
///
/// # Errors
///
/// Parts that Control Expert cannot say, at `place`.
pub(crate) fn print(e: &Block, place: Span) -> Result<String, Vec<Problem>> {
    let mut refused = Refused::default();
    let own = rewrite::block(e, &mut |e| word(e, &mut refused));
    let variables: Vec<Element> = own.variables.iter().map(|v| variable(v, &mut refused)).collect();
    refused.problems(place)?;
    let notes: String = own.notes.iter().map(|note| format!("(* {} *)\n", st::plain(note))).collect();
    let section =
        Element::new("identProgram").with("name", &e.name).with("type", "section").with("task", "MAST");
    let source = Element::with_text("STSource", &(notes + &st::body(&own, "FAULT")));
    let program = Element::new("program").child(section).child(source);
    Ok(controlexpert::file("STExchangeFile", "Structured source file", &e.name, program, variables))
}

fn type_of(ty: &str) -> Option<&'static str> {
    Some(match ty {
        "BOOL" => "BOOL",
        "SINT" | "USINT" | "INT" => "INT",
        "UINT" => "UINT",
        "DINT" => "DINT",
        "UDINT" => "UDINT",
        "REAL" => "REAL",
        "TIME" => "TIME",
        "TON" => "TON",
        _ => return None,
    })
}

fn variable(v: &Declared, refused: &mut Refused) -> Element {
    let ty = type_of(&v.ty).unwrap_or_else(|| {
        refused.add(not_printed(&v.ty, "Control Expert"));
        "DINT"
    });
    let ty = if v.elements == 1 { ty.to_owned() } else { format!("ARRAY[0..{}] OF {ty}", v.elements - 1) };
    let mut element = Element::new("variables").with("name", &v.name).with("typeName", ty);
    if !v.note.is_empty() {
        element.push(Element::with_text("comment", &v.note));
    }
    match v.init.as_slice() {
        [] => element,
        [one] if v.elements == 1 => {
            element.child(Element::new("variableInit").with("value", st::expression(one)))
        }
        many => element.children(many.iter().zip(0..).map(|(e, i)| {
            let value = Element::with_text("value", &st::expression(e));
            Element::new("instanceElementDesc").with("name", format!("[{i}]")).child(value)
        })),
    }
}

/// The words of Control Expert. Its TIME has no sign.
fn word(e: Ex, refused: &mut Refused) -> Ex {
    match &e {
        Ex::Time(time) if time.count() < 0 => {
            refused.add(say!("a negative TIME: Control Expert has none"));
            e
        }
        Ex::Call(name, _) if ["SINT", "LINT", "LREAL"].iter().any(|ty| name.contains(ty)) => {
            refused.add(say!("the function {} cannot be printed for Control Expert", Said::foreign(name)));
            e
        }
        _ => rewrite::timed(e, refused),
    }
}
