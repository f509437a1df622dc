//! The tree as Rust without the standard library.

use std::collections::HashSet;
use std::fmt::Write as _;

use crate::tree::{Arm, Bin, Block, Const, Expr, Function, Known, Module, Stmt, Struct, Ty, Un};

/// Lints of clippy that printed code does not keep; the book says why.
pub(crate) const ALLOWED: &str = "\
#![allow(
    clippy::cast_lossless, clippy::cast_possible_truncation, clippy::cast_possible_wrap,
    clippy::cast_precision_loss, clippy::cast_sign_loss, clippy::collapsible_if,
    clippy::collapsible_match, clippy::doc_markdown, clippy::float_cmp,
    clippy::if_not_else, clippy::manual_range_contains, clippy::many_single_char_names,
    clippy::match_same_arms, clippy::needless_range_loop, clippy::nonminimal_bool,
    clippy::overly_complex_bool_expr, clippy::similar_names, clippy::single_match,
    clippy::single_match_else, clippy::struct_excessive_bools, clippy::too_many_lines,
    clippy::trivially_copy_pass_by_ref, clippy::unnecessary_cast, clippy::unreadable_literal,
    clippy::useless_conversion
)]
";

/// Prints a module.
pub(crate) fn print(m: &Module, helpers: &str) -> String {
    let mut p = Printer { out: String::new() };
    for numbers in &m.numbers {
        for (name, value, note) in &numbers.rows {
            let about = if note.is_empty() { &numbers.note } else { note };
            p.note(about, "", numbers.public);
            let ty = numbers.ty.as_ref().map_or("usize".into(), |t| p.ty(t));
            let open = if numbers.public { "pub " } else { "" };
            let _ = writeln!(p.out, "{open}const {name}: {ty} = {value};");
        }
        p.out.push('\n');
    }
    m.consts.iter().for_each(|c| p.constant(c));
    m.structs.iter().for_each(|s| p.structure(s));
    p.out.push_str(helpers);
    m.functions.iter().for_each(|f| p.function(f));
    while p.out.ends_with("\n\n") {
        p.out.pop();
    }
    p.out
}

struct Printer {
    out: String,
}

impl Printer {
    fn note(&mut self, text: &str, indent: &str, document: bool) {
        for line in text.lines() {
            let _ = writeln!(self.out, "{indent}{} {line}", if document { "///" } else { "//" });
        }
    }

    fn ty(&self, ty: &Ty) -> String {
        match ty {
            Ty::Bool => "bool".into(),
            Ty::Int { signed, bits } => format!("{}{bits}", if *signed { 'i' } else { 'u' }),
            Ty::Real { bits } => format!("f{bits}"),
            Ty::Size => "usize".into(),
            Ty::Named(n) => n.clone(),
            Ty::Array(of, n) => format!("[{}; {n}]", self.ty(of)),
            Ty::Ref(m, of) => format!("&{}{}", if *m { "mut " } else { "" }, self.ty(of)),
            Ty::Slice(m, of) => format!("&{}[{}]", if *m { "mut " } else { "" }, self.ty(of)),
        }
    }

    fn zero(&self, ty: &Ty) -> String {
        match ty {
            Ty::Bool => "false".into(),
            Ty::Real { .. } => "0.0".into(),
            Ty::Named(n) => format!("{n}::new()"),
            Ty::Array(of, n) => format!("[{}; {n}]", self.zero(of)),
            Ty::Int { .. } | Ty::Size | Ty::Ref(..) | Ty::Slice(..) => "0".into(),
        }
    }

    fn structure(&mut self, s: &Struct) {
        self.note(&s.note, "", true);
        let _ = writeln!(self.out, "#[derive(Clone, Copy, Debug)]\npub struct {} {{", s.name);
        for f in &s.fields {
            self.note(&f.note, "    ", true);
            let ty = self.ty(&f.ty);
            let _ = writeln!(self.out, "    pub {}: {ty},", f.name);
        }
        let _ = writeln!(
            self.out,
            "}}\n\nimpl {0} {{\n    /// All zero and FALSE.\n    #[must_use]\n    pub const fn new() -> {0} {{",
            s.name
        );
        let _ = writeln!(self.out, "        {} {{", s.name);
        for f in &s.fields {
            let zero = self.zero(&f.ty);
            let _ = writeln!(self.out, "            {}: {zero},", f.name);
        }
        self.out.push_str("        }\n    }\n}\n\n");
        let _ = writeln!(
            self.out,
            "impl Default for {0} {{\n    fn default() -> {0} {{\n        {0}::new()\n    }}\n}}\n",
            s.name
        );
    }

    fn constant(&mut self, c: &Const) {
        self.note(&c.note, "", false);
        let open = if c.public { "pub " } else { "" };
        let ty = self.ty(&c.ty);
        match &c.value {
            Known::One(e) => {
                let value = self.expr(e);
                let _ = writeln!(self.out, "{open}const {}: {ty} = {value};", c.name);
            }
            Known::Many(all) => {
                let values: Vec<String> = all.iter().map(|e| self.expr(e)).collect();
                let _ = writeln!(self.out, "{open}static {}: {ty} = [", c.name);
                for line in values.chunks(16) {
                    let _ = writeln!(self.out, "    {},", line.join(", "));
                }
                self.out.push_str("];\n");
            }
            Known::Rows(rows) => {
                let _ = writeln!(self.out, "{open}static {}: {ty} = [", c.name);
                for (all, note) in rows.iter().filter(|r| !r.0.is_empty()) {
                    let values: Vec<String> = all.iter().map(|e| self.expr(e)).collect();
                    let _ = writeln!(self.out, "    {}, // {note}", values.join(", "));
                }
                self.out.push_str("];\n");
            }
        }
        self.out.push('\n');
    }

    fn function(&mut self, f: &Function) {
        self.note(&f.note, "", f.public);
        let mut used = HashSet::new();
        for s in &f.body {
            s.walk(&mut |e| {
                if let Expr::Name(n) = e {
                    used.insert(n.clone());
                }
            });
        }
        let parameters: Vec<String> = f
            .parameters
            .iter()
            .map(|(n, t)| format!("{}{n}: {}", if used.contains(n) { "" } else { "_" }, self.ty(t)))
            .collect();
        let result = f.result.as_ref().map_or(String::new(), |t| format!(" -> {}", self.ty(t)));
        let open = if f.public { "pub " } else { "" };
        let changes = f.parameters.iter().any(|(_, t)| matches!(t, Ty::Ref(true, _) | Ty::Slice(true, _)));
        if f.public && f.result.is_some() && !changes {
            self.out.push_str("#[must_use]\n");
        }
        let _ = writeln!(self.out, "{open}fn {}({}){result} {{", f.name, parameters.join(", "));
        let body = f.body.as_slice();
        let (last, body) = match body.split_last() {
            Some((Stmt::Return(Some(e)), rest)) => (Some(e), rest),
            _ => (None, body),
        };
        for s in body {
            self.statement(s, 1);
        }
        if let Some(e) = last {
            let e = self.expr(e);
            let _ = writeln!(self.out, "    {e}");
        }
        self.out.push_str("}\n\n");
    }

    fn block(&mut self, block: &Block, depth: usize) {
        for s in block {
            self.statement(s, depth);
        }
    }

    fn statement(&mut self, s: &Stmt, depth: usize) {
        let indent = "    ".repeat(depth);
        match s {
            Stmt::Note(text) => self.note(text, &indent, false),
            Stmt::Let { mutable, name, ty, value } => {
                let m = if *mutable { "mut " } else { "" };
                let value = match value {
                    Expr::Call(f, _) if f == "zeroed" => self.zero(ty),
                    other => self.expr(other),
                };
                let ty = self.ty(ty);
                let _ = writeln!(self.out, "{indent}let {m}{name}: {ty} = {value};");
            }
            Stmt::Assign(None, to, Expr::Bin(op, a, b)) if **a == *to && op.has_assignment() => {
                let (to, b) = (self.expr(to), self.expr(b));
                let _ = writeln!(self.out, "{indent}{to} {}= {b};", op.text());
            }
            Stmt::Assign(op, to, value) => {
                let (to, value) = (self.expr(to), self.expr(value));
                let _ = writeln!(self.out, "{indent}{to} {}= {value};", op.map_or("", Bin::text));
            }
            Stmt::If(c, then, other) => {
                let _ = write!(self.out, "{indent}");
                self.alternative(c, then, other, depth);
            }
            Stmt::While(c, body) => {
                let c = self.expr(c);
                let head = if c == "true" { "loop".to_owned() } else { format!("while {c}") };
                let _ = writeln!(self.out, "{indent}{head} {{");
                self.block(body, depth + 1);
                let _ = writeln!(self.out, "{indent}}}");
            }
            Stmt::For(name, from, to, body) => {
                let (from, to) = (self.expr(from), self.expr(to));
                let _ = writeln!(self.out, "{indent}for {name} in {from}..{to} {{");
                self.block(body, depth + 1);
                let _ = writeln!(self.out, "{indent}}}");
            }
            Stmt::Match(e, arms) => self.choice(e, arms, depth),
            Stmt::Return(None) => {
                let _ = writeln!(self.out, "{indent}return;");
            }
            Stmt::Return(Some(e)) => {
                let e = self.expr(e);
                let _ = writeln!(self.out, "{indent}return {e};");
            }
            Stmt::Break => {
                let _ = writeln!(self.out, "{indent}break;");
            }
            Stmt::Do(e) => {
                let e = self.expr(e);
                let _ = writeln!(self.out, "{indent}{e};");
            }
            Stmt::Clear(to, ty) => {
                let (to, zero) = (self.expr(to), self.zero(ty));
                let _ = writeln!(self.out, "{indent}{to} = {zero};");
            }
        }
    }

    fn alternative(&mut self, c: &Expr, then: &Block, other: &Block, depth: usize) {
        let indent = "    ".repeat(depth);
        let c = self.expr(c);
        let _ = writeln!(self.out, "if {c} {{");
        self.block(then, depth + 1);
        match other.as_slice() {
            [] => {
                let _ = writeln!(self.out, "{indent}}}");
            }
            [Stmt::If(c, then, other)] => {
                let _ = write!(self.out, "{indent}}} else ");
                self.alternative(c, then, other, depth);
            }
            _ => {
                let _ = writeln!(self.out, "{indent}}} else {{");
                self.block(other, depth + 1);
                let _ = writeln!(self.out, "{indent}}}");
            }
        }
    }

    fn choice(&mut self, e: &Expr, arms: &[Arm], depth: usize) {
        let indent = "    ".repeat(depth);
        let e = self.expr(e);
        if arms.is_empty() {
            let _ = writeln!(self.out, "{indent}let _ = {e};");
            return;
        }
        let _ = writeln!(self.out, "{indent}match {e} {{");
        for arm in arms {
            self.note(&arm.note, &format!("{indent}    "), false);
            let label = self.expr(&arm.label);
            let _ = writeln!(self.out, "{indent}    {label} => {{");
            self.block(&arm.body, depth + 2);
            let _ = writeln!(self.out, "{indent}    }}");
        }
        let _ = writeln!(self.out, "{indent}    _ => {{}}\n{indent}}}");
    }

    fn within(&self, e: &Expr, outer: Bin, right: bool) -> String {
        if let (Bin::BitAnd | Bin::BitOr | Bin::BitXor, Expr::Int(n @ 0.., Some(ty))) = (outer, e) {
            return format!("0x{n:x}_{}", self.ty(ty));
        }
        let text = self.expr(e);
        let bare = match e {
            Expr::Bin(op, ..) => {
                let (inner, around) = (op.tightness(), outer.tightness());
                // Comparisons do not follow one another.
                let beside = *op == outer && matches!(op, Bin::And | Bin::Or) || inner != 3 && !right;
                inner > around || inner == around && beside
            }
            Expr::Cast(..) => !matches!(outer, Bin::Lt | Bin::Shl),
            Expr::If(..) => false,
            _ => true,
        };
        if bare { text } else { format!("({text})") }
    }

    fn tight(&self, e: &Expr) -> String {
        let text = self.expr(e);
        if matches!(e, Expr::Bin(..) | Expr::If(..) | Expr::Cast(..)) { format!("({text})") } else { text }
    }

    fn expr(&self, e: &Expr) -> String {
        match e {
            Expr::Int(n, None) => n.to_string(),
            Expr::Int(n, Some(ty)) => format!("{n}{}", self.ty(ty)),
            Expr::Real(bits, 32) => real(
                f32::from_bits(*bits as u32).into(),
                &format!("{:?}", f32::from_bits(*bits as u32)),
                "f32",
            ),
            Expr::Real(bits, _) => {
                real(f64::from_bits(*bits), &format!("{:?}", f64::from_bits(*bits)), "f64")
            }
            Expr::Bool(b) => b.to_string(),
            Expr::Name(n) => n.clone(),
            Expr::Field(of, name) => format!("{}.{name}", self.expr(of)),
            Expr::Index(of, i) => format!("{}[{}]", self.expr(of), self.expr(i)),
            Expr::Call(f, args) => {
                let args: Vec<String> = args.iter().map(|a| self.expr(a)).collect();
                match (f.as_str(), args.as_slice()) {
                    ("inv", [a]) => format!("!({a})"),
                    _ => format!("{f}({})", args.join(", ")),
                }
            }
            Expr::Un(Un::Not, e) => format!("!{}", self.tight(e)),
            Expr::Un(Un::Neg, e) => format!("-{}", self.tight(e)),
            Expr::Bin(op, a, b) => {
                format!("{} {} {}", self.within(a, *op, false), op.text(), self.within(b, *op, true))
            }
            Expr::Cast(e, ty) => {
                let inner = match &**e {
                    Expr::Int(n, None) if *n < 0 => format!("({n})"),
                    Expr::Cast(..) => self.expr(e),
                    _ => self.tight(e),
                };
                format!("{inner} as {}", self.ty(ty))
            }
            Expr::Ref(m, e) => format!("&{}{}", if *m { "mut " } else { "" }, self.expr(e)),
            Expr::Deref(e) => format!("*{}", self.expr(e)),
            Expr::If(c, a, b) => {
                let other = self.expr(b);
                let other = if matches!(**b, Expr::If(..)) { other } else { format!("{{ {other} }}") };
                format!("if {} {{ {} }} else {other}", self.expr(c), self.expr(a))
            }
        }
    }
}

fn real(v: f64, text: &str, ty: &str) -> String {
    if v.is_nan() {
        format!("{ty}::NAN")
    } else if v.is_infinite() {
        format!("{ty}::{}INFINITY", if v < 0.0 { "NEG_" } else { "" })
    } else if v < 0.0 || text.starts_with('-') {
        format!("({text})")
    } else {
        text.to_owned()
    }
}
