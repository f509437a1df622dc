//! Logix (Rockwell): the export of a program with one routine in Structured Text, as L5X.
//!
//! Logix has no TIME: times are DINT, in milliseconds. Its timer in Structured Text is TONR with a tag of type
//! FBD_TIMER. Numbers turn into each other without a call.

use g7_iec::xml::element::Element;
use g7_model::{Problem, Said, Span, say};

use super::rewrite::{self, Refused};
use crate::plc::form::{Block, Declared, Ex, St, not_printed};
use crate::plc::st;

/// Elements of a table of BOOL come in words of so many.
const WORD: u32 = 32;

/// The file.
///
/// # Errors
///
/// Parts that Logix cannot say, at `place`.
pub(crate) fn print(e: &Block, place: Span) -> Result<String, Vec<Problem>> {
    let mut refused = Refused::default();
    let mut own = rewrite::block(e, &mut |e| word(e, &mut refused));
    own.parts.iter_mut().chain(own.safe.as_mut()).for_each(|list| *list = statements(std::mem::take(list)));
    let tags: Vec<Element> = own.variables.iter().map(|v| tag(v, &mut refused)).collect();
    refused.problems(place)?;
    let heads = own.notes.iter().map(|note| format!("(* {} *)", st::plain(note)));
    let body = st::body(&own, "FAULT");
    let lines = heads.chain(body.lines().map(str::to_owned)).zip(0..);
    let lines = lines.map(|(text, n)| Element::with_text("Line", &text).with("Number", n));
    let routine = Element::new("Routine").with("Name", "Scan").with("Type", "ST");
    let routine = routine.child(Element::new("STContent").children(lines));
    let program =
        Element::new("Program").with("Use", "Target").with("Name", &e.name).with("TestEdits", "false");
    let program =
        program.with("MainRoutineName", "Scan").with("Disabled", "false").with("UseAsFolder", "false");
    let program =
        program.child(Element::new("Tags").children(tags)).child(Element::new("Routines").child(routine));
    let controller = Element::new("Controller").with("Use", "Context").with("Name", "G7");
    let controller = controller.child(Element::new("Programs").with("Use", "Context").child(program));
    let root =
        Element::new("RSLogix5000Content").with("SchemaRevision", "1.0").with("SoftwareRevision", "20.01");
    let root = root.with("TargetName", &e.name).with("TargetType", "Program").with("ContainsContext", "true");
    let mut text = "<?xml version=\"1.0\" encoding=\"UTF-8\" standalone=\"yes\"?>\n".to_owned();
    root.child(controller).print(0, &mut text);
    Ok(text)
}

fn type_of(ty: &str) -> Option<&'static str> {
    Some(match ty {
        "BOOL" => "BOOL",
        "SINT" => "SINT",
        "USINT" | "INT" => "INT",
        "UINT" | "DINT" | "TIME" => "DINT",
        "REAL" => "REAL",
        "TON" => "FBD_TIMER",
        _ => return None,
    })
}

/// A tag with its value.
fn tag(v: &Declared, refused: &mut Refused) -> Element {
    let ty = type_of(&v.ty).unwrap_or_else(|| {
        refused.add(not_printed(&v.ty, "Logix"));
        "DINT"
    });
    if v.name.contains("__") {
        refused.add(say!("the name {}: Logix takes no two underlines in a row", Said::foreign(&v.name)));
    }
    let tag = Element::new("Tag").with("Name", &v.name).with("TagType", "Base").with("DataType", ty);
    let size = if ty == "BOOL" { v.elements.next_multiple_of(WORD) } else { v.elements };
    let tag = if v.elements == 1 { tag } else { tag.with("Dimensions", size) };
    let radix = if ty == "REAL" { "Float" } else { "Decimal" };
    let tag = if ty == "FBD_TIMER" { tag } else { tag.with("Radix", radix) };
    let tag = tag.with("Constant", "false").with("ExternalAccess", "Read/Write");
    let tag = if v.note.is_empty() { tag } else { tag.child(Element::with_text("Description", &v.note)) };
    if ty == "FBD_TIMER" {
        return tag.child(Element::new("Data").with("Format", "Decorated").child(timer()));
    }
    let value = |i: u32| v.init.get(i as usize).map_or_else(|| zero(ty).to_owned(), st::expression);
    let data = Element::new("Data").with("Format", "Decorated");
    if v.elements == 1 {
        let one = Element::new("DataValue").with("DataType", ty).with("Radix", radix).with("Value", value(0));
        return tag.child(data.child(one));
    }
    let all =
        (0..size).map(|i| Element::new("Element").with("Index", format!("[{i}]")).with("Value", value(i)));
    let array = Element::new("Array").with("DataType", ty).with("Dimensions", size).with("Radix", radix);
    tag.child(data.child(array.children(all)))
}

/// A timer at rest.
fn timer() -> Element {
    let members = [
        ("EnableIn", "BOOL", 1),
        ("TimerEnable", "BOOL", 0),
        ("PRE", "DINT", 0),
        ("Reset", "BOOL", 0),
        ("EnableOut", "BOOL", 0),
        ("ACC", "DINT", 0),
        ("EN", "BOOL", 0),
        ("TT", "BOOL", 0),
        ("DN", "BOOL", 0),
        ("Status", "DINT", 0),
        ("InstructFault", "BOOL", 0),
        ("PresetInv", "BOOL", 0),
    ];
    let member = |(name, ty, value)| {
        let member = Element::new("DataValueMember").with("Name", name).with("DataType", ty);
        let member = if ty == "DINT" { member.with("Radix", "Decimal") } else { member };
        member.with("Value", value)
    };
    Element::new("Structure").with("DataType", "FBD_TIMER").children(members.map(member))
}

fn zero(ty: &str) -> &'static str {
    if ty == "REAL" { "0.0" } else { "0" }
}

/// Timers are called by the instruction, and a loop without a condition has one that never holds.
fn statements(list: Vec<St>) -> Vec<St> {
    let mut out = Vec::new();
    for s in list {
        match s {
            St::If(c, a, b) => out.push(St::If(c, statements(a), statements(b))),
            St::Until(a, c) => out.push(St::Until(statements(a), c)),
            St::Loop(a) => {
                let never = Ex::Op("=", Box::new(Ex::Int(0)), Box::new(Ex::Int(1)));
                out.push(St::Until(statements(a), never));
            }
            St::Call(name, inputs) => {
                for (input, e) in inputs {
                    match input.as_str() {
                        "IN" => {
                            let off = if e == Ex::Int(1) { Ex::Int(0) } else { Ex::Int(1) };
                            out.push(St::set(format!("{name}.TimerEnable"), e));
                            out.push(St::set(format!("{name}.Reset"), off));
                        }
                        _ => out.push(St::set(format!("{name}.PRE"), e)),
                    }
                }
                out.push(St::Call("TONR".into(), vec![(String::new(), Ex::Var(name))]));
            }
            s => out.push(s),
        }
    }
    out
}

/// The words of Logix.
fn word(e: Ex, refused: &mut Refused) -> Ex {
    match e {
        Ex::Bool(b) => Ex::Int(b.into()),
        Ex::Time(_) => match rewrite::millis(&e) {
            Some(n) => Ex::Int(n.into()),
            None => rewrite::timed(e, refused),
        },
        Ex::Int(n) if i32::try_from(n).is_err() => {
            refused.add(say!("a number of more than 32 bits cannot be printed for Logix"));
            e
        }
        Ex::Var(name) => match name.strip_suffix(".ET") {
            Some(timer) => Ex::Var(format!("{timer}.ACC")),
            None => Ex::Var(name),
        },
        Ex::Call(name, mut args) => {
            if ["ABS", "SQRT", "LN", "SIN", "COS", "TAN", "ASIN", "ACOS", "ATAN", "TRUNC"]
                .contains(&name.as_str())
            {
                return Ex::Call(name, args);
            }
            if name == "EXPT" && args.len() == 2 {
                let b = args.pop().unwrap_or(Ex::Int(1));
                return Ex::op("**", args.pop().unwrap_or(Ex::Int(1)), b);
            }
            match (name.split_once("_TO_"), args.len()) {
                (Some((from, to)), 1) if widens(from, to) => args.pop().unwrap_or(Ex::Int(0)),
                _ => {
                    refused.add(say!("the function {} cannot be printed for Logix", Said::foreign(&name)));
                    Ex::Call(name, args)
                }
            }
        }
        e => e,
    }
}

/// True if every value of a type is one of the other.
fn widens(from: &str, to: &str) -> bool {
    let order = ["SINT", "USINT", "INT", "UINT", "DINT"];
    let place = |ty: &str| order.iter().position(|o| *o == ty);
    match (place(from), place(to)) {
        (Some(a), Some(b)) => {
            a <= b && !(from == "SINT" && to.starts_with('U')) && !(from == "INT" && to == "UINT")
        }
        (Some(a), None) => to == "REAL" && a < 3 || to == "LINT",
        _ => false,
    }
}
