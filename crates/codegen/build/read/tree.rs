//! Functions and structures of the runtime as constants of `src/runtime.rs`.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use g7_runtime::source::File;
use syn::{BinOp, Block, Expr, FnArg, Item, Lit, Member, Pat, RangeLimits, ReturnType, Stmt, Type, UnOp};

use super::chart::{Chart, field, note, word};
use super::{Result, wrong};

/// The items read so far.
#[derive(Debug, Default)]
pub(crate) struct Reader {
    structs: String,
    code: String,
    /// Functions that are there.
    pub(crate) functions: BTreeSet<String>,
    /// Functions that callers of the printed code may use.
    offered: BTreeSet<String>,
    /// Functions that are called.
    pub(crate) calls: BTreeSet<String>,
    /// Facts that are asked for.
    pub(crate) facts: BTreeSet<String>,
    /// Other names: tables and variables.
    pub(crate) names: BTreeSet<String>,
}

/// A comment on a line of its own within a function, as a statement that `syn` keeps.
fn with_notes(text: &str) -> String {
    let mut out = String::new();
    for line in text.lines() {
        let code = line.trim_start();
        match code.strip_prefix("// ").filter(|_| code.len() < line.len()) {
            Some(note) => {
                let _ = writeln!(out, "note!({note:?});");
            }
            None => {
                let _ = writeln!(out, "{line}");
            }
        }
    }
    out
}

/// Names and notes of the faults, by their numbers.
pub(crate) fn faults(file: &File) -> Result<String> {
    let items = match syn::parse_file(file.text) {
        Ok(parsed) => parsed.items,
        Err(e) => return wrong(file, e),
    };
    let mut out = String::from("/// Names and notes of the faults, by their numbers.\n");
    let _ = writeln!(out, "pub(crate) static FAULTS: [(&str, &str); {}] = [", items.len());
    for (i, item) in items.iter().enumerate() {
        let Item::Const(c) = item else { return wrong(file, "no constant") };
        match &*c.expr {
            Expr::Lit(l) if matches!(&l.lit, Lit::Int(n) if n.base10_digits() == i.to_string()) => {}
            _ => return wrong(file, format!("`{}` is not number {i}", c.ident)),
        }
        let _ = writeln!(out, "    ({:?}, {:?}),", c.ident.to_string(), note(&c.attrs));
    }
    Ok(out + "];\n")
}

impl Reader {
    /// Adds a file, whose `pub` functions are for callers of the printed code or not.
    pub(crate) fn file(&mut self, file: &File, chart: &Chart, offers: bool) -> Result<()> {
        let items = match syn::parse_file(&with_notes(file.text)) {
            Ok(parsed) => parsed.items,
            Err(e) => {
                return wrong(file, format!("{e}; or a comment that stands in no place of a statement"));
            }
        };
        let mut one = One { chart, offers, all: self };
        for item in &items {
            let done = match item {
                Item::Use(_) => Ok(()),
                Item::Mod(m) if m.ident == "tests" => Ok(()),
                Item::Fn(f) => one.function(f),
                Item::Struct(s) => one.structure(s),
                _ => Err("neither a function nor a structure".to_owned()),
            };
            if let Err(why) = done {
                return wrong(file, why);
            }
        }
        Ok(())
    }

    /// Checks which functions callers of the printed code may use.
    pub(crate) fn offers(&self, names: &[&str]) -> Result<()> {
        let want: BTreeSet<String> = names.iter().map(|n| (*n).to_owned()).collect();
        if self.offered == want {
            return Ok(());
        }
        Err(format!("crates/runtime: `pub` are {:?}, and offered are {want:?}", self.offered))
    }

    /// The constants, whose names have this in front.
    pub(crate) fn text(&self, front: &str, of: &str) -> String {
        format!(
            "/// The structures of {of}.\npub(crate) static {front}STRUCTS: &[Struct] = &[\n{}];\n\n\
             /// The functions of {of}.\npub(crate) static {front}FUNCTIONS: &[Function] = &[\n{}];\n",
            self.structs, self.code
        )
    }
}

/// A file in hand.
struct One<'a> {
    chart: &'a Chart,
    offers: bool,
    all: &'a mut Reader,
}

fn list(all: &[String]) -> String {
    format!("&[{}]", all.join(", "))
}

/// A type with a name: a number, or a structure.
fn scalar(word: &str) -> String {
    let number = |rest: &str| rest.parse::<u8>().ok().filter(|n| [8, 16, 32, 64].contains(n));
    match word {
        "bool" => "Type::Bool".into(),
        "usize" => "Type::Size".into(),
        "Row" => "Type::Row".into(),
        "Tick" => "Type::Tick".into(),
        _ => {
            let (first, rest) = word.split_at_checked(1).unwrap_or(("", word));
            match (first, number(rest)) {
                ("i" | "u", Some(bits)) => format!("Type::Int {{ signed: {}, bits: {bits} }}", first == "i"),
                _ => format!("Type::Named({word:?})"),
            }
        }
    }
}

fn operator(op: &BinOp) -> Option<(&'static str, bool)> {
    Some(match op {
        BinOp::Add(_) => ("Add", false),
        BinOp::Sub(_) => ("Sub", false),
        BinOp::Mul(_) => ("Mul", false),
        BinOp::Div(_) => ("Div", false),
        BinOp::And(_) => ("And", false),
        BinOp::Or(_) => ("Or", false),
        BinOp::BitXor(_) => ("BitXor", false),
        BinOp::BitAnd(_) => ("BitAnd", false),
        BinOp::BitOr(_) => ("BitOr", false),
        BinOp::Shl(_) => ("Shl", false),
        BinOp::Shr(_) => ("Shr", false),
        BinOp::Eq(_) => ("Eq", false),
        BinOp::Lt(_) => ("Lt", false),
        BinOp::Le(_) => ("Le", false),
        BinOp::Ne(_) => ("Ne", false),
        BinOp::Ge(_) => ("Ge", false),
        BinOp::Gt(_) => ("Gt", false),
        BinOp::AddAssign(_) => ("Add", true),
        BinOp::SubAssign(_) => ("Sub", true),
        BinOp::BitXorAssign(_) => ("BitXor", true),
        BinOp::BitAndAssign(_) => ("BitAnd", true),
        BinOp::BitOrAssign(_) => ("BitOr", true),
        BinOp::ShlAssign(_) => ("Shl", true),
        BinOp::ShrAssign(_) => ("Shr", true),
        _ => return None,
    })
}

impl One<'_> {
    fn structure(&mut self, s: &syn::ItemStruct) -> Result<()> {
        let mut fields = String::new();
        for f in &s.fields {
            let Some(name) = &f.ident else {
                return Err(format!("`{}` has a field without a name", s.ident));
            };
            let (name, ty) = (name.to_string(), self.ty(&f.ty)?);
            let _ =
                writeln!(fields, "        Field {{ name: {name:?}, ty: {ty}, note: {:?} }},", note(&f.attrs));
        }
        let _ = writeln!(
            self.all.structs,
            "    Struct {{ note: {:?}, name: {:?}, fields: &[\n{fields}    ] }},",
            note(&s.attrs),
            s.ident.to_string()
        );
        Ok(())
    }

    fn function(&mut self, f: &syn::ItemFn) -> Result<()> {
        let name = f.sig.ident.to_string();
        let within = |why: String| format!("`{name}`: {why}");
        let public = self.offers && matches!(f.vis, syn::Visibility::Public(_));
        let mut parameters = Vec::new();
        for input in &f.sig.inputs {
            let FnArg::Typed(p) = input else { return Err(within("a method".into())) };
            let Pat::Ident(n) = &*p.pat else { return Err(within("a parameter without a name".into())) };
            let ty = self.ty(&p.ty).map_err(within)?;
            parameters.push(format!("({:?}, {ty})", n.ident.to_string()));
        }
        let result = match &f.sig.output {
            ReturnType::Default => "None".to_owned(),
            ReturnType::Type(_, ty) => format!("Some({})", self.ty(ty).map_err(within)?),
        };
        let body = self.block(&f.block, true).map_err(within)?;
        let _ = writeln!(
            self.all.code,
            "    Function {{ public: {public}, note: {:?}, name: {name:?}, parameters: {}, result: {result}, body: {body} }},",
            note(&f.attrs),
            list(&parameters)
        );
        if public {
            self.all.offered.insert(name.clone());
        }
        if !self.all.functions.insert(name.clone()) {
            return Err(format!("`{name}` stands there twice"));
        }
        Ok(())
    }

    fn ty(&mut self, ty: &Type) -> Result<String> {
        match ty {
            Type::Reference(r) => {
                let mutable = r.mutability.is_some();
                match &*r.elem {
                    Type::Slice(s) => Ok(format!("Type::Slice({mutable}, &{})", self.ty(&s.elem)?)),
                    other => Ok(format!("Type::Ref({mutable}, &{})", self.ty(other)?)),
                }
            }
            Type::Array(a) => {
                let Expr::Path(length) = &a.len else {
                    return Err("an array whose length is no fact".into());
                };
                let length = length.path.get_ident().map(ToString::to_string).unwrap_or_default();
                let length = self.size(&length)?;
                Ok(format!("Type::Array(&{}, {length})", self.ty(&a.elem)?))
            }
            other => word(other)
                .map(|w| scalar(&w))
                .ok_or_else(|| "a type that the printers do not have".to_owned()),
        }
    }

    fn size(&mut self, name: &str) -> Result<String> {
        if !self.chart.facts.contains(name) || self.chart.truths.contains(name) {
            return Err(format!("`{name}` is no size of a chart"));
        }
        self.all.facts.insert(name.to_owned());
        Ok(format!("|f| f.{}", field(name)))
    }

    fn block(&mut self, block: &Block, whole: bool) -> Result<String> {
        let mut all = Vec::new();
        let last = block.stmts.len().saturating_sub(1);
        for (i, s) in block.stmts.iter().enumerate() {
            all.push(self.statement(s, whole && i == last)?);
        }
        Ok(list(&all))
    }

    /// A statement; the last expression of a function is its result.
    fn statement(&mut self, s: &Stmt, last: bool) -> Result<String> {
        match s {
            Stmt::Local(l) => {
                let Pat::Type(p) = &l.pat else { return Err("`let` without a type".into()) };
                let Pat::Ident(n) = &*p.pat else { return Err("`let` without a name".into()) };
                let Some(init) = l.init.as_ref().filter(|i| i.diverge.is_none()) else {
                    return Err(format!("`{}` without a value", n.ident));
                };
                let (ty, value) = (self.ty(&p.ty)?, self.expr(&init.expr)?);
                let (mutable, name) = (n.mutability.is_some(), n.ident.to_string());
                Ok(format!("Line::Let {{ mutable: {mutable}, name: {name:?}, ty: {ty}, value: {value} }}"))
            }
            Stmt::Macro(m) if m.mac.path.is_ident("note") => {
                let text: syn::LitStr = m.mac.parse_body().map_err(|e| e.to_string())?;
                Ok(format!("Line::Note({:?})", text.value()))
            }
            Stmt::Expr(e, semicolon) => self.line(e, semicolon.is_some(), last),
            Stmt::Item(_) | Stmt::Macro(_) => Err("a statement that the printers do not have".into()),
        }
    }

    fn line(&mut self, e: &Expr, semicolon: bool, last: bool) -> Result<String> {
        match e {
            Expr::If(i) => {
                let (c, then) = (self.expr(&i.cond)?, self.block(&i.then_branch, false)?);
                let other = match i.else_branch.as_ref().map(|(_, e)| &**e) {
                    None => "&[]".to_owned(),
                    Some(Expr::Block(b)) => self.block(&b.block, false)?,
                    Some(e) => list(&[self.line(e, false, false)?]),
                };
                Ok(format!("Line::If({c}, {then}, {other})"))
            }
            Expr::While(w) => {
                Ok(format!("Line::While({}, {})", self.expr(&w.cond)?, self.block(&w.body, false)?))
            }
            Expr::ForLoop(f) => {
                let Pat::Ident(n) = &*f.pat else { return Err("`for` without a name".into()) };
                let (Expr::Range(r), name) = (&*f.expr, n.ident.to_string()) else {
                    return Err("`for` over what is no range".into());
                };
                let (Some(from), RangeLimits::HalfOpen(_), Some(to)) = (&r.start, &r.limits, &r.end) else {
                    return Err("a range without both ends, or with `..=`".into());
                };
                let (from, to) = (self.expr(from)?, self.expr(to)?);
                Ok(format!("Line::For({name:?}, {from}, {to}, {})", self.block(&f.body, false)?))
            }
            Expr::Return(r) => match &r.expr {
                None => Ok("Line::Return(None)".to_owned()),
                Some(e) => Ok(format!("Line::Return(Some({}))", self.expr(e)?)),
            },
            Expr::Assign(a) => {
                Ok(format!("Line::Assign(None, {}, {})", self.expr(&a.left)?, self.expr(&a.right)?))
            }
            Expr::Binary(b) if matches!(operator(&b.op), Some((_, true))) => {
                let (op, _) = operator(&b.op).unwrap_or_default();
                Ok(format!(
                    "Line::Assign(Some(Bin::{op}), {}, {})",
                    self.expr(&b.left)?,
                    self.expr(&b.right)?
                ))
            }
            Expr::Call(_) if semicolon => Ok(format!("Line::Do({})", self.expr(e)?)),
            e if last && !semicolon => Ok(format!("Line::Return(Some({}))", self.expr(e)?)),
            _ => Err("a statement that the printers do not have".into()),
        }
    }

    fn named(&mut self, name: &str) -> Result<String> {
        if self.chart.truths.contains(name) {
            self.all.facts.insert(name.to_owned());
            return Ok(format!("Term::Truth(|f| f.{})", field(name)));
        }
        if self.chart.facts.contains(name) {
            return Ok(format!("Term::Size({})", self.size(name)?));
        }
        let capital = name.chars().all(|c| !c.is_lowercase());
        if capital && !self.chart.tables.contains(name) && !name.starts_with("FAULT_") {
            return Err(format!("`{name}` is no fact and no table of a chart"));
        }
        self.all.names.insert(name.to_owned());
        Ok(format!("Term::Name({name:?})"))
    }

    fn expr(&mut self, e: &Expr) -> Result<String> {
        Ok(match e {
            Expr::Paren(p) => return self.expr(&p.expr),
            Expr::Lit(l) => match &l.lit {
                Lit::Int(n) => {
                    let digits = n.base10_digits();
                    let ty = match n.suffix() {
                        "" => "None".to_owned(),
                        word => format!("Some({})", scalar(word)),
                    };
                    format!("Term::Int({digits}, {ty})")
                }
                Lit::Bool(b) => format!("Term::Bool({})", b.value),
                _ => return Err("a literal that is neither a whole number nor a truth value".into()),
            },
            Expr::Path(p) => match p.path.get_ident() {
                Some(name) => return self.named(&name.to_string()),
                None => return Err("a path".into()),
            },
            Expr::Field(f) => match &f.member {
                Member::Named(n) => format!("Term::Field(&{}, {:?})", self.expr(&f.base)?, n.to_string()),
                Member::Unnamed(_) => return Err("a tuple".into()),
            },
            Expr::Index(i) => format!("Term::Index(&{}, &{})", self.expr(&i.expr)?, self.expr(&i.index)?),
            Expr::Call(c) => {
                let Expr::Path(p) = &*c.func else { return Err("a call of what is no function".into()) };
                let Some(name) = p.path.get_ident().map(ToString::to_string) else {
                    return Err("a call by a path".into());
                };
                let args: Result<Vec<String>> = c.args.iter().map(|a| self.expr(a)).collect();
                self.all.calls.insert(name.clone());
                format!("Term::Call({name:?}, {})", list(&args?))
            }
            Expr::Unary(u) => match u.op {
                UnOp::Not(_) => format!("Term::Not(&{})", self.expr(&u.expr)?),
                UnOp::Neg(_) => format!("Term::Neg(&{})", self.expr(&u.expr)?),
                UnOp::Deref(_) => format!("Term::Deref(&{})", self.expr(&u.expr)?),
                _ => return Err("an operator that the printers do not have".into()),
            },
            Expr::Binary(b) => match operator(&b.op) {
                Some((op, false)) => {
                    format!("Term::Bin(Bin::{op}, &{}, &{})", self.expr(&b.left)?, self.expr(&b.right)?)
                }
                _ => return Err("an operator that the printers do not have".into()),
            },
            Expr::Cast(c) => format!("Term::Cast(&{}, {})", self.expr(&c.expr)?, self.ty(&c.ty)?),
            Expr::Reference(r) => format!("Term::Ref({}, &{})", r.mutability.is_some(), self.expr(&r.expr)?),
            _ => return Err("an expression that the printers do not have".into()),
        })
    }
}
