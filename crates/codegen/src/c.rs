//! The tree as C99.

use std::collections::HashSet;
use std::fmt::Write as _;

use crate::c_types::Types;
use crate::c_words::{comment, in_flash, integer, own_name, real, snake};
use crate::tree::{Arm, Bin, Block, Const, Expr, Field, Function, Known, Module, Stmt, Struct, Ty, Un};

/// In front of the names of `g7.h`.
pub(crate) const SHARED: &str = "g7";

/// The name of the faults among the named numbers.
pub(crate) const FAULT: &str = "Fault";

/// The printer of a module, with the meaning of every name.
pub(crate) struct Printer<'a> {
    module: &'a Module,
    /// In front of public names.
    prefix: &'a str,
    types: Types<'a>,
    /// Constants that carry the prefix.
    public: HashSet<&'a str>,
    /// Names of numbers.
    numbered: HashSet<&'a str>,
    /// Functions that carry the prefix.
    offered: HashSet<&'a str>,
    /// Functions and structures that stand in `g7.h`: their names begin with `g7_`.
    shared: HashSet<&'a str>,
    /// Tables that are read element by element alone: they need no place in RAM.
    in_flash: HashSet<&'a str>,
    out: String,
}

impl<'a> Printer<'a> {
    pub(crate) fn new(module: &'a Module, prefix: &'a str) -> Printer<'a> {
        let rows =
            module.numbers.iter().filter(|n| n.public).flat_map(|n| n.rows.iter().map(|r| r.0.as_str()));
        let consts = module.consts.iter().filter(|c| c.public).map(|c| c.name.as_str());
        Printer {
            module,
            prefix,
            types: Types::new(module),
            public: rows.chain(consts).collect(),
            numbered: module.numbers.iter().flat_map(|n| n.rows.iter().map(|r| r.0.as_str())).collect(),
            offered: module.functions.iter().filter(|f| f.public).map(|f| f.name.as_str()).collect(),
            shared: HashSet::new(),
            in_flash: in_flash(module),
            out: String::new(),
        }
    }

    /// The same where these functions and structures stand in `g7.h`.
    pub(crate) fn apart(module: &'a Module, prefix: &'a str, shared: HashSet<&'a str>) -> Printer<'a> {
        Printer { shared, ..Printer::new(module, prefix) }
    }

    /// The text since the last time, with one line break at its end.
    pub(crate) fn taken(&mut self) -> String {
        while self.out.ends_with("\n\n") {
            self.out.pop();
        }
        std::mem::take(&mut self.out)
    }

    /// The named numbers, structures and functions for other files.
    pub(crate) fn declarations(&mut self) {
        self.kinds();
        for f in self.module.functions.iter().filter(|f| f.public) {
            self.note(&f.note, "");
            let head = self.head(f);
            let _ = writeln!(self.out, "{head};\n");
        }
    }

    /// The named numbers and structures for other files.
    pub(crate) fn kinds(&mut self) {
        for numbers in self.module.numbers.iter().filter(|n| n.public) {
            if numbers.name == FAULT {
                if self.shared.is_empty() {
                    self.faults(&numbers.note, &numbers.rows);
                }
                continue;
            }
            self.note(&numbers.note, "");
            self.numbers(&numbers.rows, &format!("{}_{}", self.prefix, snake(&numbers.name)));
        }
        for s in &self.module.structs {
            if !self.shared.contains(s.name.as_str()) {
                self.structure(s);
            }
        }
    }

    /// The faults, which are the same in all charts: a program of several charts meets them several times.
    fn faults(&mut self, note: &str, rows: &[(String, usize, String)]) {
        self.out.push_str("#ifndef G7_FAULTS\n#define G7_FAULTS\n");
        self.note(note, "");
        self.numbers(rows, "g7_fault");
        self.out.push_str("#endif\n\n");
    }

    /// Numbers and tables for this file alone.
    pub(crate) fn tables(&mut self) {
        for numbers in self.module.numbers.iter().filter(|n| !n.public && !n.rows.is_empty()) {
            self.note(&numbers.note, "");
            self.numbers(&numbers.rows, "");
        }
        for c in &self.module.consts {
            self.constant(c);
        }
    }

    /// True if tables stand in the flash of an AVR.
    pub(crate) fn has_flash(&self) -> bool {
        !self.in_flash.is_empty()
    }

    /// The heads of the functions for this file alone.
    pub(crate) fn heads(&mut self) {
        for f in self.module.functions.iter().filter(|f| !f.public) {
            if !self.is_shared(f) {
                let head = self.head(f);
                let _ = writeln!(self.out, "static {head};");
            }
        }
        self.out.push('\n');
    }

    /// The functions of this kind.
    pub(crate) fn functions(&mut self, is_wanted: impl Fn(&Function) -> bool) {
        let module = self.module;
        for f in &module.functions {
            if !self.is_shared(f) && is_wanted(f) {
                self.function(f);
            }
        }
    }

    fn is_shared(&self, f: &Function) -> bool {
        !f.public && self.shared.contains(f.name.as_str())
    }

    /// The functions, each alone, with its name.
    pub(crate) fn each_function(&mut self) -> Vec<(&'a str, String)> {
        let module = self.module;
        let text = |f: &'a Function| {
            self.function(f);
            (f.name.as_str(), self.taken())
        };
        module.functions.iter().map(text).collect()
    }

    fn note(&mut self, text: &str, indent: &str) {
        let lines: Vec<&str> = text.lines().collect();
        match lines.as_slice() {
            [] => {}
            [one] => {
                let _ = writeln!(self.out, "{indent}/* {} */", comment(one));
            }
            many => {
                for (i, line) in many.iter().enumerate() {
                    let start = if i == 0 { "/*" } else { " *" };
                    let end = if i + 1 == many.len() { " */" } else { "" };
                    let _ = writeln!(self.out, "{indent}{start} {}{end}", comment(line));
                }
            }
        }
    }

    fn numbers(&mut self, rows: &[(String, usize, String)], name: &str) {
        if rows.is_empty() {
            return;
        }
        self.out.push_str(if name.is_empty() { "enum {\n" } else { "typedef enum {\n" });
        for (i, (row, value, note)) in rows.iter().enumerate() {
            let comma = if i + 1 == rows.len() { "" } else { "," };
            let row = self.constant_name(row);
            let note = if note.is_empty() { String::new() } else { format!(" /* {} */", comment(note)) };
            let _ = writeln!(self.out, "    {row} = {value}{comma}{note}");
        }
        let _ = writeln!(self.out, "}}{}{name};\n", if name.is_empty() { "" } else { " " });
    }

    fn constant_name(&self, name: &str) -> String {
        if name.starts_with("FAULT_") {
            format!("G7_{name}")
        } else if self.public.contains(name) {
            format!("{}_{name}", self.prefix.to_uppercase())
        } else {
            name.to_owned()
        }
    }

    fn structure(&mut self, s: &Struct) {
        self.note(&s.note, "");
        self.out.push_str("typedef struct {\n");
        for f in &s.fields {
            self.field(f);
        }
        if s.fields.is_empty() {
            self.out.push_str("    uint8_t none; /* C wants a field */\n");
        }
        let _ = writeln!(self.out, "}} {};\n", self.type_name(&s.name));
    }

    fn field(&mut self, f: &Field) {
        let note = if f.note.is_empty() { String::new() } else { format!(" /* {} */", comment(&f.note)) };
        let declared = self.declared(&f.ty, &f.name);
        let _ = writeln!(self.out, "    {declared};{note}");
    }

    fn type_name(&self, name: &str) -> String {
        let prefix = if self.shared.contains(name) { SHARED } else { self.prefix };
        format!("{prefix}_{}", snake(name))
    }

    /// A type with the name that is declared by it.
    fn declared(&self, ty: &Ty, name: &str) -> String {
        match ty {
            Ty::Array(of, n) => self.declared(of, &format!("{name}[{}]", (*n).max(1))),
            Ty::Ref(mutable, of) | Ty::Slice(mutable, of) => {
                let constant = if *mutable { "" } else { "const " };
                format!("{constant}{} *{name}", self.ty(of))
            }
            other => format!("{} {name}", self.ty(other)),
        }
    }

    fn ty(&self, ty: &Ty) -> String {
        match ty {
            Ty::Bool => "bool".into(),
            Ty::Int { signed, bits } => format!("{}int{bits}_t", if *signed { "" } else { "u" }),
            Ty::Real { bits: 32 } => "float".into(),
            Ty::Real { .. } => "double".into(),
            Ty::Size => "uint32_t".into(),
            Ty::Named(n) => self.type_name(n),
            Ty::Array(of, _) | Ty::Ref(_, of) | Ty::Slice(_, of) => self.ty(of),
        }
    }

    fn constant(&mut self, c: &Const) {
        self.note(&c.note, "");
        let declared = self.declared(&c.ty, &c.name);
        let flash = if self.in_flash.contains(c.name.as_str()) { "G7_FLASH " } else { "" };
        match &c.value {
            Known::One(e) => {
                let value = self.literal(e, &c.ty);
                let _ = writeln!(self.out, "static const {declared} = {value};\n");
            }
            Known::Many(all) => {
                let of = if let Ty::Array(of, _) = &c.ty { (**of).clone() } else { c.ty.clone() };
                let values: Vec<String> = all.iter().map(|e| self.literal(e, &of)).collect();
                let _ = writeln!(self.out, "static const {flash}{declared} = {{");
                self.columns(if values.is_empty() { &["0"] } else { &[] });
                self.columns(&values.iter().map(String::as_str).collect::<Vec<_>>());
                self.out.push_str("};\n\n");
            }
            Known::Rows(rows) => {
                let of = if let Ty::Array(of, _) = &c.ty { (**of).clone() } else { c.ty.clone() };
                let last = rows.iter().rposition(|r| !r.0.is_empty()).unwrap_or(0);
                let _ = writeln!(self.out, "static const {flash}{declared} = {{");
                for (i, (all, note)) in rows.iter().enumerate().filter(|(_, r)| !r.0.is_empty()) {
                    let values: Vec<String> = all.iter().map(|e| self.literal(e, &of)).collect();
                    let comma = if i == last { "" } else { "," };
                    let note = comment(note);
                    let _ = writeln!(self.out, "    {}{comma} /* {note} */", values.join(", "));
                }
                self.out.push_str("};\n\n");
            }
        }
    }

    fn columns(&mut self, values: &[&str]) {
        let mut line = String::from("   ");
        for (i, v) in values.iter().enumerate() {
            if line.len() + v.len() > 98 {
                let _ = writeln!(self.out, "{line}");
                line = String::from("   ");
            }
            let _ = write!(line, " {v}{}", if i + 1 == values.len() { "" } else { "," });
        }
        if !values.is_empty() {
            let _ = writeln!(self.out, "{line}");
        }
    }

    fn literal(&self, e: &Expr, ty: &Ty) -> String {
        match (e, ty) {
            (Expr::Int(n, _), Ty::Int { signed, bits }) => integer(*n, *signed, *bits),
            // The number of a step fits as it is.
            (Expr::Cast(e, to), _)
                if to == ty && matches!(&**e, Expr::Name(n) if self.numbered.contains(n.as_str())) =>
            {
                self.expr(e)
            }
            _ => self.expr(e),
        }
    }

    fn head(&self, f: &Function) -> String {
        let name = if f.public { format!("{}_{}", self.prefix, f.name) } else { own_name(&f.name) };
        let parameters: Vec<String> = f.parameters.iter().map(|(n, t)| self.declared(t, n)).collect();
        let parameters = if parameters.is_empty() { "void".to_owned() } else { parameters.join(", ") };
        let result = f.result.as_ref().map_or("void".to_owned(), |t| self.ty(t));
        format!("{result} {name}({parameters})")
    }

    fn function(&mut self, f: &Function) {
        self.note(&f.note, "");
        let head = self.head(f);
        let open = if f.public { "" } else { "static " };
        let _ = writeln!(self.out, "{open}{head}\n{{");
        self.types.scope = f.parameters.iter().cloned().collect();
        let mut used = HashSet::new();
        for s in &f.body {
            s.walk(&mut |e| {
                if let Expr::Name(n) = e {
                    used.insert(n.clone());
                }
            });
        }
        for (name, _) in f.parameters.iter().filter(|(n, _)| !used.contains(n)) {
            let _ = writeln!(self.out, "    (void)({name});");
        }
        self.block(&f.body, 1);
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
            Stmt::Note(text) => self.note(text, &indent),
            Stmt::Let { mutable, name, ty, value } => {
                self.types.scope.insert(name.clone(), ty.clone());
                let constant = if *mutable { "" } else { "const " };
                let declared = self.declared(ty, name);
                match (ty, value) {
                    (Ty::Array(..), Expr::Call(f, _)) if f == "zeroed" => {
                        let _ = writeln!(self.out, "{indent}{declared} = {{0}};");
                    }
                    (Ty::Array(_, n), from) => {
                        let from = self.expr(from);
                        let _ = writeln!(self.out, "{indent}{declared};");
                        let head = format!("for (uint32_t i = 0U; i < {n}U; i++)");
                        let _ = writeln!(
                            self.out,
                            "{indent}{head} {{\n{indent}    {name}[i] = {from}[i];\n{indent}}}"
                        );
                    }
                    _ => {
                        let value = self.literal(value, ty);
                        let _ = writeln!(self.out, "{indent}{constant}{declared} = {value};");
                    }
                }
            }
            Stmt::Assign(op, to, value) => self.assign(*op, to, value, &indent),
            Stmt::If(c, then, other) => {
                let _ = write!(self.out, "{indent}");
                self.alternative(c, then, other, depth);
            }
            Stmt::While(c, body) => {
                let c = self.expr(c);
                let _ = writeln!(self.out, "{indent}while ({c}) {{");
                self.block(body, depth + 1);
                let _ = writeln!(self.out, "{indent}}}");
            }
            Stmt::For(name, from, to, body) => {
                self.types.scope.insert(name.clone(), Ty::Size);
                let counter = Expr::Cast(Box::new(Expr::name(name.as_str())), Ty::Size);
                let (from, to) = (self.beside(from, &counter, Bin::Lt), self.beside(to, &counter, Bin::Lt));
                let _ =
                    writeln!(self.out, "{indent}for (uint32_t {name} = {from}; {name} < {to}; {name}++) {{");
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
                let (to, ty) = (self.expr(to), self.ty(ty));
                let _ = writeln!(self.out, "{indent}{to} = ({ty}){{0}};");
            }
        }
    }

    fn assign(&mut self, op: Option<Bin>, to: &Expr, value: &Expr, indent: &str) {
        let ty = self.types.of(to);
        if let (None, Some(Ty::Array(_, n))) = (op, &ty) {
            let (to, value) = (self.expr(to), self.expr(value));
            let head = format!("for (uint32_t i = 0U; i < {n}U; i++)");
            let _ = writeln!(self.out, "{indent}{head} {{\n{indent}    {to}[i] = {value}[i];\n{indent}}}");
            return;
        }
        let value = match (&ty, op) {
            // The result is brought back into the type, so it may be worked out unsigned.
            (Some(Ty::Size | Ty::Int { signed: false, .. }), Some(_))
                if matches!(value, Expr::Int(_, None)) =>
            {
                self.beside(value, to, Bin::BitOr)
            }
            (Some(ty), _) => self.literal(value, ty),
            (None, _) => self.expr(value),
        };
        let to = self.expr(to);
        let small = matches!(ty, Some(Ty::Int { bits: 8 | 16, .. }));
        match op {
            Some(op) if small => {
                let ty = ty.as_ref().map_or(String::new(), |t| self.ty(t));
                let _ = writeln!(self.out, "{indent}{to} = ({ty})({to} {} {value});", op.text());
            }
            _ => {
                let _ = writeln!(self.out, "{indent}{to} {}= {value};", op.map_or("", Bin::text));
            }
        }
    }

    fn alternative(&mut self, c: &Expr, then: &Block, other: &Block, depth: usize) {
        let indent = "    ".repeat(depth);
        let c = self.expr(c);
        let _ = writeln!(self.out, "if ({c}) {{");
        self.block(then, depth + 1);
        match other.as_slice() {
            [] => {
                let _ = writeln!(self.out, "{indent}}}");
            }
            [Stmt::If(c, then, other)] => {
                let _ = write!(self.out, "{indent}}} else ");
                self.alternative(c, then, other, depth);
                // Rule 15.7: a chain of questions ends with an else.
                if other.is_empty() {
                    self.out.truncate(self.out.trim_end().len());
                    let _ = writeln!(self.out, " else {{\n{indent}    /* nothing else */\n{indent}}}");
                }
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
        let _ = writeln!(self.out, "{indent}switch ({e}) {{");
        for arm in arms {
            let label = self.expr(&arm.label);
            let note =
                if arm.note.is_empty() { String::new() } else { format!(" /* {} */", comment(&arm.note)) };
            let _ = writeln!(self.out, "{indent}case {label}: {{{note}");
            self.block(&arm.body, depth + 1);
            if !matches!(arm.body.last(), Some(Stmt::Return(_))) {
                let _ = writeln!(self.out, "{indent}    break;");
            }
            let _ = writeln!(self.out, "{indent}}}");
        }
        let _ = writeln!(self.out, "{indent}default: {{\n{indent}    break;\n{indent}}}\n{indent}}}");
    }

    fn within(&self, e: &Expr, outer: Bin) -> String {
        let text = self.expr(e);
        let bare = match e {
            Expr::Bin(op, ..) => *op == outer && op.chains(),
            Expr::If(..) => false,
            _ => true,
        };
        if bare { text } else { format!("({text})") }
    }

    /// An operand. A number beside an unsigned one is unsigned (MISRA C:2012, rule 10.4): where they
    /// are compared or joined bit by bit, and where they are as wide as an `int` may be, so that
    /// C gives the same value.
    fn beside(&self, e: &Expr, other: &Expr, op: Bin) -> String {
        let keeps = matches!(
            op,
            Bin::Eq
                | Bin::Ne
                | Bin::Lt
                | Bin::Le
                | Bin::Gt
                | Bin::Ge
                | Bin::BitAnd
                | Bin::BitOr
                | Bin::BitXor
        );
        let shifts = matches!(op, Bin::Shl | Bin::Shr);
        match e {
            Expr::Int(n, None) if *n >= 0 && *n <= i128::from(u32::MAX) && !shifts => {
                match self.types.of_value(other) {
                    Some(Ty::Size | Ty::Int { signed: false, bits: 32 | 64 }) => format!("{n}U"),
                    Some(Ty::Int { signed: false, .. }) if keeps => format!("{n}U"),
                    _ => self.within(e, op),
                }
            }
            _ => self.within(e, op),
        }
    }

    fn expr(&self, e: &Expr) -> String {
        match e {
            Expr::Int(n, None) => integer(*n, true, 32),
            Expr::Int(n, Some(Ty::Int { signed, bits })) => {
                let plain = integer(*n, *signed, *bits);
                if *bits >= 32 && !(*signed && *bits == 32) {
                    plain
                } else {
                    format!("({})({plain})", self.ty(&Ty::Int { signed: *signed, bits: *bits }))
                }
            }
            Expr::Int(n, Some(_)) => integer(*n, true, 32),
            Expr::Real(bits, 32) => real(
                f64::from(f32::from_bits(*bits as u32)),
                &format!("{:?}", f32::from_bits(*bits as u32)),
                "F",
            ),
            Expr::Real(bits, _) => real(f64::from_bits(*bits), &format!("{:?}", f64::from_bits(*bits)), ""),
            Expr::Bool(b) => b.to_string(),
            Expr::Name(n) => self.constant_name(n),
            Expr::Field(of, name) => {
                let pointer = matches!(self.types.of(of), Some(Ty::Ref(..)));
                format!("{}{}{name}", self.expr(of), if pointer { "->" } else { "." })
            }
            Expr::Index(of, i) => format!("{}[{}]", self.expr(of), self.expr(i)),
            Expr::Call(f, args) => self.call(f, args),
            Expr::Un(Un::Not, e) => format!("!{}", self.tight(e)),
            Expr::Un(Un::Neg, e) => format!("-{}", self.tight(e)),
            Expr::Bin(op, a, b) => {
                let (left, right) = (self.beside(a, b, *op), self.beside(b, a, *op));
                format!("{left} {} {right}", op.text())
            }
            Expr::Cast(e, ty) => format!("({}){}", self.ty(ty), self.tight(e)),
            Expr::Ref(_, e) => match (&**e, self.types.of(e)) {
                (_, Some(Ty::Array(..))) => self.expr(e),
                (_, Some(Ty::Ref(..) | Ty::Slice(..))) => self.expr(e),
                (Expr::Name(n), None) if self.module.consts.iter().any(|c| c.name == *n) => self.expr(e),
                _ => format!("&{}", self.expr(e)),
            },
            Expr::Deref(e) => format!("*{}", self.expr(e)),
            Expr::If(c, a, b) => format!("{} ? {} : {}", self.tight(c), self.tight(a), self.tight(b)),
        }
    }

    fn tight(&self, e: &Expr) -> String {
        let text = self.expr(e);
        if matches!(e, Expr::Bin(..) | Expr::If(..)) || text.starts_with('-') {
            format!("({text})")
        } else {
            text
        }
    }

    fn call(&self, f: &str, args: &[Expr]) -> String {
        if f == "inv"
            && let [a] = args
        {
            return format!("~{}", self.tight(a));
        }
        let types = self.types.function(f).map(|f| f.parameters.as_slice()).unwrap_or(&[]);
        let mut all = Vec::new();
        for (i, a) in args.iter().enumerate() {
            all.push(match types.get(i) {
                Some((_, ty)) => self.literal(a, ty),
                None => self.expr(a),
            });
        }
        let name = if self.shared.contains(f) {
            format!("{SHARED}_{f}")
        } else if self.offered.contains(f) {
            format!("{}_{f}", self.prefix)
        } else {
            own_name(f)
        };
        format!("{name}({})", all.join(", "))
    }
}
