//! Prints expressions and statements in the spelling of the standard.
//!
//! The printer expects the forms that [`crate::standard`] makes: paths are `name`, `block.member`,
//! `step.X` and `step.T`. The standard has no implicit conversions; where the .g7 language widens a
//! number, a conversion is written.

use g7_model::{
    Arg, BinaryOp, Expr, ExprKind, Function, Holds, Literal, Name, Operands, Path, StandardFunction, Stmt,
    StmtKind, Type, UnaryOp, filled,
};

use super::bits::{self, Bit};
use super::known::Types;

/// The type of an expression, as far as it is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ty {
    Known(Type),
    /// A number without a type of its own.
    Whole,
    Real,
    Unknown,
}

/// A printed expression.
pub(crate) struct Text {
    pub(crate) text: String,
    pub(crate) ty: Ty,
    /// The binding strength of its outermost operator; 9 for an operand.
    strength: u8,
}

/// Prints the texts of one place.
pub struct Writer<'a> {
    /// The types of the names in the texts.
    pub types: &'a Types<'a>,
}

/// A bit as a condition.
fn read(bit: &Bit) -> Text {
    Text { text: bit.read(), ty: Ty::Known(Type::Bool), strength: BinaryOp::Ne.strength() }
}

/// The operator as the standard has it: `·` is an AND.
fn standard(op: BinaryOp) -> BinaryOp {
    if op == BinaryOp::Dot { BinaryOp::And } else { op }
}

/// The wider of two types, by the widening rules of the .g7 language.
fn wider(a: Type, b: Type) -> Type {
    let rank = |t: Type| match t.elementary() {
        Some(row) if counts(t) => (t.is_real(), row.bits, row.holds == Holds::Signed),
        _ => (false, 0, false),
    };
    if rank(a) >= rank(b) { a } else { b }
}

/// A number, or a bit string that stands for one.
fn counts(ty: Type) -> bool {
    ty.is_number() || ty.is_bits()
}

impl Text {
    fn operand(text: String, ty: Ty) -> Text {
        Text { text, ty, strength: BinaryOp::TIGHTEST }
    }

    /// A bit string as a number from 0; anything else as it is.
    fn counted(self) -> Text {
        match self.ty {
            Ty::Known(ty) => self.converted(ty.unsigned().unwrap_or(ty)),
            _ => self,
        }
    }

    fn within(self, least: u8) -> String {
        if self.strength < least { format!("({})", self.text) } else { self.text }
    }

    fn is(&self, ty: Type) -> bool {
        self.ty == Ty::Known(ty)
    }

    /// Converts a number to another type.
    fn converted(self, to: Type) -> Text {
        match self.ty {
            Ty::Known(from) if from != to && counts(from) && counts(to) => {
                Text::operand(format!("{from}_TO_{to}({})", self.text), Ty::Known(to))
            }
            Ty::Whole if to.is_real() => {
                let digits = self.text.trim_start_matches('-').chars().all(|c| c.is_ascii_digit());
                let text =
                    if digits { format!("{}.0", self.text) } else { format!("DINT_TO_{to}({})", self.text) };
                Text { text, ty: Ty::Known(to), strength: self.strength }
            }
            Ty::Whole if to.is_bits() => {
                let text = bits::literal(&self.text, to).unwrap_or(self.text);
                Text::operand(text, Ty::Known(to))
            }
            // A literal used as a condition.
            Ty::Whole if to == Type::Bool => {
                let text = if self.text == "0" { "FALSE" } else { "TRUE" };
                Text::operand(text.into(), Ty::Known(Type::Bool))
            }
            _ => self,
        }
    }
}

impl Writer<'_> {
    /// Prints an expression as a value of a type.
    pub fn value(&self, e: &Expr, ty: Type) -> String {
        self.text(e).converted(ty).text
    }

    /// Prints a condition.
    pub fn condition(&self, e: &Expr) -> String {
        self.value(e, Type::Bool)
    }

    /// Prints an expression of any type.
    pub fn plain(&self, e: &Expr) -> String {
        self.text(e).text
    }

    fn text(&self, e: &Expr) -> Text {
        match &e.kind {
            ExprKind::Literal(literal) => literal_text(literal),
            ExprKind::Path(path) => self.path(path),
            ExprKind::Direct(name) => Text::operand(format!("%{name}"), Ty::Unknown),
            ExprKind::Unary(op, inner) => self.unary(*op, inner),
            ExprKind::Binary(op, a, b) => self.binary(*op, a, b),
            ExprKind::Call(path, args) => self.call(path, args),
            ExprKind::Element(path, index, bit) => self.element(path, index, bit.as_deref()),
            // `standard` has removed these, so they do not occur here.
            ExprKind::Timer { .. } | ExprKind::List(_) | ExprKind::Bad => {
                Text::operand("FALSE".into(), Ty::Unknown)
            }
        }
    }

    fn unary(&self, op: UnaryOp, inner: &Expr) -> Text {
        match op {
            UnaryOp::Not => {
                let inner = self.text(inner);
                let ty = match inner.ty {
                    Ty::Known(ty) if ty.is_bits() => ty,
                    _ => Type::Bool,
                };
                let text = inner.converted(ty).within(8);
                // matiec refuses `NOT NOT a`.
                let text =
                    if text.starts_with("NOT ") { format!("NOT ({text})") } else { format!("NOT {text}") };
                Text { text, ty: Ty::Known(ty), strength: 8 }
            }
            UnaryOp::Neg => {
                let inner = self.text(inner);
                let ty = inner.ty;
                let text = inner.within(BinaryOp::TIGHTEST);
                let text = if text.starts_with('-') { format!("-({text})") } else { format!("-{text}") };
                Text { text, ty, strength: 8 }
            }
            UnaryOp::Rise | UnaryOp::Fall => Text::operand("FALSE".into(), Ty::Known(Type::Bool)),
        }
    }

    fn binary(&self, op: BinaryOp, a: &Expr, b: &Expr) -> Text {
        let (left, right) = (self.text(a), self.text(b));
        if op == BinaryOp::Pow {
            return power(left, right);
        }
        let boolean = left.is(Type::Bool) || right.is(Type::Bool);
        let op = match op {
            BinaryOp::Add if boolean => BinaryOp::Or,
            BinaryOp::Mul if boolean => BinaryOp::And,
            op => standard(op),
        };
        let own = op.strength();
        let operands = op.row().operands;
        let logical = operands == Operands::Logic;
        let compares = operands == Operands::Comparison;
        let strings = [&left, &right].iter().any(|t| matches!(t.ty, Ty::Known(ty) if ty.is_bits()));
        let equal = matches!(op, BinaryOp::Eq | BinaryOp::Ne);
        let (left, right, common) = if strings && (logical || equal) {
            let string = |t: Text| match t.ty {
                Ty::Known(ty) => t.converted(ty.bit_string().filter(|_| logical).unwrap_or(ty)),
                _ => t,
            };
            alike(string(left), string(right), op)
        } else if strings {
            alike(left.counted(), right.counted(), op)
        } else if logical {
            (left.converted(Type::Bool), right.converted(Type::Bool), Ty::Known(Type::Bool))
        } else {
            alike(left, right, op)
        };
        let ty = if logical && !strings || compares { Ty::Known(Type::Bool) } else { common };
        let text = format!("{} {} {}", left.within(own), op.row().standard, right.within(own + 1));
        Text { text, ty, strength: own }
    }

    /// The bit of a variable that a path names.
    fn bit(&self, path: &Path) -> Option<Bit> {
        let (number, variable) = path.names.split_last()?;
        let ty = self.types.of(variable)?;
        Bit::of(&Path { names: variable.to_vec() }.text(), ty, &number.text)
    }

    /// The bit of an element of an array.
    fn bit_of(&self, path: &Path, index: &[Expr], bit: &Name) -> Option<Bit> {
        let element = self.element(path, index, None);
        let Ty::Known(ty) = element.ty else { return None };
        Bit::of(&element.text, ty, &bit.text)
    }

    /// An element of an array, or a bit of one.
    fn element(&self, path: &Path, index: &[Expr], bit: Option<&Name>) -> Text {
        if let Some(bit) = bit.and_then(|b| self.bit_of(path, index, b)) {
            return read(&bit);
        }
        let index: Vec<String> = index.iter().map(|e| self.plain(e)).collect();
        let array = self.path(path);
        let (mut text, within) = filled(&array.text, &index);
        if let Some(behind) = index.get(within..).filter(|rest| !rest.is_empty()) {
            text.push_str(&format!("[{}]", behind.join(", ")));
        }
        Text::operand(text, array.ty)
    }

    fn path(&self, path: &Path) -> Text {
        if let Some(bit) = self.bit(path) {
            return read(&bit);
        }
        let ty = self.types.of(&path.names);
        Text::operand(path.text(), ty.map_or(Ty::Unknown, Ty::Known))
    }

    fn call(&self, path: &Path, args: &[Arg]) -> Text {
        if let Some(shift) = self.shift(path, args) {
            return shift;
        }
        let name = path.text();
        let own = self.types.function(&name);
        let texts: Vec<Text> = args.iter().map(|a| self.text(&a.value)).collect();
        let common = texts.iter().fold(Ty::Whole, |all, t| match (all, t.ty) {
            (Ty::Known(a), Ty::Known(b)) if counts(a) && counts(b) && a.is_bits() == b.is_bits() => {
                Ty::Known(wider(a, b))
            }
            (Ty::Known(a), _) if a != Type::Bool => Ty::Known(a),
            (_, ty) => ty,
        });
        let upper = name.to_ascii_uppercase();
        let alike = matches!(upper.as_str(), "MIN" | "MAX" | "LIMIT" | "SEL");
        let ty = match own {
            Some(own) => Ty::Known(own.result.base),
            None => standard_type(&upper, common),
        };
        let mut parts = Vec::new();
        for (place, (arg, text)) in args.iter().zip(texts).enumerate() {
            let text = match (own.and_then(|f| parameter(f, place, arg)), common) {
                (Some(ty), _) => text.converted(ty).text,
                (None, Ty::Known(t)) if alike && counts(t) => text.converted(t).text,
                _ => text.text,
            };
            parts.push(match &arg.name {
                Some(n) => format!("{} {} {text}", n.text, if arg.output { "=>" } else { ":=" }),
                None => text,
            });
        }
        let name = if own.is_some() { name } else { upper };
        Text::operand(format!("{name}({})", parts.join(", ")), ty)
    }

    /// A shift is one of bit strings in the standard: `WORD_TO_UINT(SHL(UINT_TO_WORD(n), 3))`.
    fn shift(&self, path: &Path, args: &[Arg]) -> Option<Text> {
        let name = path.text().to_ascii_uppercase();
        let standard = StandardFunction::named(&name)?;
        let shifts = matches!(
            standard,
            StandardFunction::Shl | StandardFunction::Shr | StandardFunction::Rol | StandardFunction::Ror
        );
        if !shifts || self.types.function(&path.text()).is_some() {
            return None;
        }
        let place = |a: &Arg, k: usize| a.name.as_ref().map_or(Some(k), |n| standard.row().place(&n.text));
        let at = |want: usize| args.iter().enumerate().find(|(k, a)| place(a, *k) == Some(want));
        let (bits, count) = (self.text(&at(0)?.1.value), self.text(&at(1)?.1.value));
        let Ty::Known(ty) = bits.ty else { return None };
        // A shift of a bit string needs no conversion.
        let string = ty.bit_string()?;
        let text = format!("{string}_TO_{ty}({name}({ty}_TO_{string}({}), {}))", bits.text, count.text);
        Some(Text::operand(text, Ty::Known(ty)))
    }

    /// Prints the statements of a body.
    pub fn body(&self, list: &[Stmt]) -> String {
        let mut text = String::new();
        self.statements(list, 0, &mut text);
        text.truncate(text.trim_end().len());
        text
    }

    /// Prints statements, each line with its indentation.
    pub fn statements(&self, list: &[Stmt], indent: usize, out: &mut String) {
        for stmt in list {
            self.statement(stmt, indent, out);
        }
    }

    fn statement(&self, stmt: &Stmt, indent: usize, out: &mut String) {
        let pad = "  ".repeat(indent);
        let mut line = |text: &str| {
            out.push_str(&pad);
            out.push_str(text);
            out.push('\n');
        };
        match &stmt.kind {
            StmtKind::Assign { target, value } => {
                let bit = match &target.kind {
                    ExprKind::Path(path) => self.bit(path),
                    ExprKind::Element(path, index, Some(bit)) => self.bit_of(path, index, bit),
                    _ => None,
                };
                if let Some(bit) = bit {
                    return line(&bit.write(&self.condition(value)));
                }
                let target = self.text(target);
                let value = self.text(value);
                let value = match target.ty {
                    Ty::Known(ty) => value.converted(ty),
                    _ => value,
                };
                line(&format!("{} := {};", target.text, value.text));
            }
            StmtKind::Call(path, args) => {
                let text = self.block_call(path, args);
                line(&format!("{text};"));
            }
            StmtKind::If(arms, otherwise) => {
                for (i, (condition, body)) in arms.iter().enumerate() {
                    let word = if i == 0 { "IF" } else { "ELSIF" };
                    let condition = self.condition(condition);
                    out.push_str(&format!("{pad}{word} {condition} THEN\n"));
                    self.statements(body, indent + 1, out);
                }
                if !otherwise.is_empty() {
                    out.push_str(&format!("{pad}ELSE\n"));
                    self.statements(otherwise, indent + 1, out);
                }
                out.push_str(&format!("{pad}END_IF;\n"));
            }
            StmtKind::Case(selector, arms, otherwise) => {
                let selector = self.text(selector).counted().text;
                out.push_str(&format!("{pad}CASE {selector} OF\n"));
                for arm in arms {
                    let labels: Vec<String> =
                        arm.labels.iter().map(|(a, b)| self.label(a, b.as_ref())).collect();
                    out.push_str(&format!("{pad}  {}:\n", labels.join(", ")));
                    self.statements(&arm.body, indent + 2, out);
                }
                if !otherwise.is_empty() {
                    out.push_str(&format!("{pad}ELSE\n"));
                    self.statements(otherwise, indent + 1, out);
                }
                out.push_str(&format!("{pad}END_CASE;\n"));
            }
            StmtKind::For { var, from, to, by, body } => {
                let variable = self.path(&Path { names: vec![var.clone()] });
                let ty = match variable.ty {
                    Ty::Known(ty) => ty,
                    _ => Type::Int,
                };
                let (from, to) = (self.value(from, ty), self.value(to, ty));
                let by = by.as_ref().map_or(String::new(), |by| format!(" BY {}", self.value(by, ty)));
                out.push_str(&format!("{pad}FOR {} := {from} TO {to}{by} DO\n", variable.text));
                self.statements(body, indent + 1, out);
                out.push_str(&format!("{pad}END_FOR;\n"));
            }
            StmtKind::While(condition, body) => {
                let condition = self.condition(condition);
                out.push_str(&format!("{pad}WHILE {condition} DO\n"));
                self.statements(body, indent + 1, out);
                out.push_str(&format!("{pad}END_WHILE;\n"));
            }
            StmtKind::Repeat(body, condition) => {
                out.push_str(&format!("{pad}REPEAT\n"));
                self.statements(body, indent + 1, out);
                let condition = self.condition(condition);
                out.push_str(&format!("{pad}UNTIL {condition}\n{pad}END_REPEAT;\n"));
            }
            StmtKind::Exit => line("EXIT;"),
            StmtKind::Return => line("RETURN;"),
        }
    }

    fn label(&self, from: &Expr, to: Option<&Expr>) -> String {
        let from = self.text(from).text;
        match to {
            Some(to) => format!("{from}..{}", self.text(to).text),
            None => from,
        }
    }

    /// A call of a function block.
    fn block_call(&self, path: &Path, args: &[Arg]) -> String {
        let mut parts = Vec::new();
        for arg in args {
            let name = arg.name.as_ref().map_or("", |n: &Name| &n.text);
            let value = match self.types.of_parameter(path, name) {
                Some(ty) if !arg.output => self.value(&arg.value, ty),
                _ => self.text(&arg.value).text,
            };
            parts.push(format!("{name} {} {value}", if arg.output { "=>" } else { ":=" }));
        }
        format!("{}({})", path.text(), parts.join(", "))
    }
}

/// A power: its base is a real number in the standard. Here it is computed in LREAL, and the result
/// is REAL unless an operand is LREAL.
fn power(left: Text, right: Text) -> Text {
    let own = BinaryOp::Pow.strength();
    let long = left.is(Type::Lreal) || right.is(Type::Lreal);
    let ty = if long { Type::Lreal } else { Type::Real };
    let whole = matches!(left.ty, Ty::Known(of) if of.is_integer());
    let base = left.converted(if whole { Type::Lreal } else { ty });
    let text = format!("{} {} {}", base.within(own), BinaryOp::Pow.row().standard, right.within(own + 1));
    if whole && !long {
        return Text::operand(format!("LREAL_TO_REAL({text})"), Ty::Known(ty));
    }
    Text { text, ty: Ty::Known(ty), strength: own }
}

/// Converts both operands to a common type.
fn alike(left: Text, right: Text, op: BinaryOp) -> (Text, Text, Ty) {
    let time = left.is(Type::Time) || right.is(Type::Time);
    if time && matches!(op, BinaryOp::Mul | BinaryOp::Div) {
        return (left, right, Ty::Known(Type::Time));
    }
    match (left.ty, right.ty) {
        (Ty::Known(a), Ty::Known(b)) if counts(a) && counts(b) => {
            let ty = wider(a, b);
            (left.converted(ty), right.converted(ty), Ty::Known(ty))
        }
        (Ty::Known(a), Ty::Whole) => (left, right.converted(a), Ty::Known(a)),
        (Ty::Whole, Ty::Known(b)) => (left.converted(b), right, Ty::Known(b)),
        (Ty::Known(a), Ty::Real) if a.is_integer() => {
            (left.converted(Type::Lreal), right, Ty::Known(Type::Lreal))
        }
        (Ty::Real, Ty::Known(b)) if b.is_integer() => {
            (left, right.converted(Type::Lreal), Ty::Known(Type::Lreal))
        }
        (Ty::Known(t), _) | (_, Ty::Known(t)) => (left, right, Ty::Known(t)),
        (a, _) => (left, right, a),
    }
}

/// The type of the parameter that gets this argument, in a call of a function of the file.
fn parameter(function: &Function, place: usize, arg: &Arg) -> Option<Type> {
    let found = match &arg.name {
        Some(name) => function.params.iter().find(|p| p.name.text.eq_ignore_ascii_case(&name.text)),
        None => function.params.get(place),
    };
    found.map(|p| p.ty.base)
}

/// The type of the result of a standard function.
fn standard_type(name: &str, common: Ty) -> Ty {
    if let Some((_, to)) = name.split_once("_TO_") {
        return super::elementary(to).map_or(Ty::Unknown, Ty::Known);
    }
    match name {
        "LEN" | "FIND" => Ty::Known(Type::Int),
        "LEFT" | "RIGHT" | "MID" | "CONCAT" | "INSERT" | "DELETE" | "REPLACE" => Ty::Known(Type::STRING),
        "TRUNC" => Ty::Unknown,
        _ => common,
    }
}

fn literal_text(literal: &Literal) -> Text {
    let (text, ty) = match literal {
        Literal::Bool(b) => (if *b { "TRUE" } else { "FALSE" }.to_string(), Ty::Known(Type::Bool)),
        Literal::Int(n, None) => (n.to_string(), Ty::Whole),
        Literal::Int(n, Some(ty)) => (format!("{ty}#{n}"), Ty::Known(*ty)),
        Literal::Real(text, None) => (real(text), Ty::Real),
        Literal::Real(text, Some(ty)) => (format!("{ty}#{}", real(text)), Ty::Known(*ty)),
        Literal::Time(time) => (format!("{time:#}"), Ty::Known(Type::Time)),
        Literal::Moment(moment, time) => (moment.literal(*time), Ty::Known(Type::Moment(*moment))),
        Literal::Str(text) => (string(text), Ty::Known(Type::STRING)),
    };
    let strength = if text.starts_with('-') { 8 } else { BinaryOp::TIGHTEST };
    Text { text, ty, strength }
}

/// A real number with a point.
fn real(text: &str) -> String {
    let (digits, power) = match text.split_once(['e', 'E']) {
        Some((digits, power)) => (digits, format!("E{power}")),
        None => (text, String::new()),
    };
    let point = if digits.contains('.') { "" } else { ".0" };
    format!("{digits}{point}{power}")
}

/// A text in ASCII: some compilers refuse letters outside it, and take `(*` within a text for the
/// beginning of a comment. A letter outside ASCII is written as its bytes in UTF-8.
fn string(text: &str) -> String {
    let mut out = String::from("'");
    let mut before = ' ';
    for c in text.chars() {
        match c {
            '$' => out.push_str("$$"),
            '\'' => out.push_str("$'"),
            '\n' => out.push_str("$N"),
            '\r' => out.push_str("$R"),
            '\t' => out.push_str("$T"),
            '*' if before == '(' => out.push_str("$2A"),
            ' '..='~' => out.push(c),
            c => {
                let mut bytes = [0; 4];
                for byte in c.encode_utf8(&mut bytes).bytes() {
                    out.push_str(&format!("${byte:02X}"));
                }
            }
        }
        before = c;
    }
    out.push('\'');
    out
}
