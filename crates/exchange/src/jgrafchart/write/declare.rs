//! Writes variables, inputs and outputs as elements.

use g7_model::codes;
use g7_model::{Expr, ExprKind, Literal, Type, UnaryOp, VarDecl, VarKind, say};

use super::Writer;
use super::lookup::VarId;
use super::symbols::{Spot, placed};
use crate::jgrafchart::read::STRING_BYTES;
use g7_iec::xml::element::Element;

/// The size of the symbol of a variable.
const SIZE: (i32, i32) = (80, 60);
/// The distance between two of them, and the number of them in a column.
const ROW: i32 = 90;
const COLUMN: i32 = 110;
const ROWS: i32 = 12;

impl Writer<'_> {
    /// The variables of the file or of a chart, to the right of its drawing.
    pub(super) fn variables(
        &mut self,
        home: Option<usize>,
        beside: i32,
        nth: &mut i32,
        into: &mut Vec<Element>,
    ) {
        for (decl, declared) in self.look.declared(home).into_iter().enumerate() {
            for name in 0..declared.names.len() {
                let var = VarId { chart: home, decl, name };
                if self.guards.is_flag(var) {
                    continue;
                }
                let at = (beside.saturating_add(*nth / ROWS * COLUMN), *nth % ROWS * ROW);
                *nth = nth.saturating_add(1);
                into.extend(self.variable(var, declared, at));
            }
        }
    }

    fn variable(&mut self, var: VarId, decl: &VarDecl, at: Spot) -> Option<Element> {
        let name = self.look.var_name(var).to_string();
        if decl.comment.is_some() {
            self.leave_out(decl.at, say!("a comment"));
        }
        if decl.safe.is_some() {
            self.leave_out(decl.at, say!("a value after a fault"));
        }
        let element = match decl.kind {
            VarKind::Input | VarKind::Output => self.channel(decl)?,
            VarKind::Var | VarKind::Const => self.internal(var, decl)?,
        };
        Some(placed(element.with("name", name), at, SIZE))
    }

    fn channel(&mut self, decl: &VarDecl) -> Option<Element> {
        let input = decl.kind == VarKind::Input;
        let starts = decl.init.as_ref().is_some_and(is_true);
        let tag = match (decl.ty, input) {
            (Type::Bool, true) if decl.inverted => "DigitalIn1",
            (Type::Bool, true) => "DigitalIn",
            (Type::Bool, false) if decl.inverted => "DigitalOut1",
            (Type::Bool, false) => "DigitalOut",
            (Type::Real, true) => "AnalogIn",
            (Type::Real, false) => "AnalogOut",
            (Type::Lreal, true) => "SocketRealIn",
            (Type::Lreal, false) => "SocketRealOut",
            (Type::String(_), true) => "SocketStringIn",
            (Type::String(_), false) => "SocketStringOut",
            (ty, _) if whole(ty) => {
                if input {
                    "SocketIntIn"
                } else {
                    "SocketIntOut"
                }
            }
            (ty, _) => {
                self.cannot(decl.at, say!("an input or output of the type {ty}"));
                return None;
            }
        };
        self.narrow(decl);
        // The inverted output is the only one that begins with TRUE.
        let rests = tag == "DigitalOut1";
        let zero = decl.init.as_ref().is_none_or(is_zero);
        if !(if rests { starts } else { zero }) {
            self.cannot(decl.at, say!("such an initial value of an input or output"));
        }
        if decl.inverted && decl.ty != Type::Bool {
            self.cannot(decl.at, say!("an inverted channel of a number"));
        }
        let address = decl.address.as_ref().map_or("", |a| &*a.text);
        let value = match decl.ty {
            Type::Bool if rests => "1",
            Type::Real | Type::Lreal => "0.0",
            Type::String(_) => "",
            _ => "0",
        };
        let element = Element::new(tag).with("value", value);
        Some(if tag.starts_with("Socket") {
            element.with("identifier", address)
        } else if input {
            element.with("channel", address).with("cyclic", 1)
        } else {
            element.with("channel", address)
        })
    }

    fn internal(&mut self, var: VarId, decl: &VarDecl) -> Option<Element> {
        let (tag, zero) = match decl.ty {
            Type::Bool => ("BooleanVariable", "0"),
            Type::Real | Type::Lreal => ("RealVariable", "0.0"),
            Type::String(_) => ("StringVariable", ""),
            ty if whole(ty) => ("IntegerVariable", "0"),
            ty => {
                self.cannot(decl.at, say!("a variable of the type {ty}"));
                return None;
            }
        };
        self.narrow(decl);
        if decl.address.is_some() {
            self.leave_out(decl.at, say!("the address of a variable"));
        }
        let value = match &decl.init {
            None => zero.to_string(),
            Some(e) => match constant(e) {
                Some(value) => value,
                None => {
                    self.cannot(e.at, say!("an initial value that is worked out"));
                    zero.to_string()
                }
            },
        };
        if decl.retain && self.follows.contains_key(&var) {
            self.leave_out(decl.at, say!("`retain` of a variable that follows an expression"));
        }
        let kept = decl.retain && decl.kind == VarKind::Var;
        let follows = self.follows.get(&var);
        let element = Element::new(tag)
            .with("constant", u8::from(decl.kind == VarKind::Const))
            .with("exp", follows.map_or("", String::as_str))
            .with("initialValue", if kept { "" } else { &value })
            .with("updated", u8::from(follows.is_some()))
            .with("value", &value);
        if matches!(decl.ty, Type::String(_)) && !kept && value.is_empty() && decl.kind == VarKind::Var {
            // An empty initial value means that the last value is kept.
            self.say(
                &codes::DIFFERENT,
                decl.at,
                say!("a text that begins empty is kept over a restart there"),
            );
        }
        Some(element)
    }

    /// Reports types that become wider or narrower.
    fn narrow(&mut self, decl: &VarDecl) {
        let to = match decl.ty {
            Type::Sint | Type::Int | Type::Usint | Type::Uint => say!("DINT"),
            Type::Real if matches!(decl.kind, VarKind::Var | VarKind::Const) => say!("LREAL"),
            Type::String(n) if n != STRING_BYTES => say!("a text of any length"),
            _ => return,
        };
        self.say(&codes::DIFFERENT, decl.at, say!("a variable of the type {} becomes {to}", decl.ty));
    }
}

/// True for whole numbers that fit a signed 32-bit number.
fn whole(ty: Type) -> bool {
    matches!(ty, Type::Sint | Type::Int | Type::Dint | Type::Usint | Type::Uint)
}

fn is_true(e: &Expr) -> bool {
    matches!(e.kind, ExprKind::Literal(Literal::Bool(true) | Literal::Int(1, _)))
}

fn is_zero(e: &Expr) -> bool {
    constant(e).is_some_and(|v| v.is_empty() || v.parse::<f64>() == Ok(0.0))
}

/// A constant, as written in attributes.
fn constant(e: &Expr) -> Option<String> {
    match &e.kind {
        ExprKind::Literal(Literal::Bool(b)) => Some(u8::from(*b).to_string()),
        ExprKind::Literal(Literal::Int(n, _)) => Some(n.to_string()),
        ExprKind::Literal(Literal::Real(text, _)) => Some(text.to_string()),
        ExprKind::Literal(Literal::Str(text)) => Some(text.to_string()),
        ExprKind::Unary(UnaryOp::Neg, inner) => match &inner.kind {
            ExprKind::Literal(Literal::Int(..) | Literal::Real(..)) => Some(format!("-{}", constant(inner)?)),
            _ => None,
        },
        _ => None,
    }
}
