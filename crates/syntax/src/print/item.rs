//! A file and its items, variables among them.

use super::{Printer, is_plain};
use crate::parse::SWITCHES;
use g7_iec::constant;
use g7_model::{
    Array, Document, Expr, Function, Instance, InstanceNames, Item, Limits, Name, NamedAction, Param,
    Profile, Section, Span, StmtKind, Switch, Type, Use, ValueType, VarDecl, VarKind,
};

impl Printer<'_> {
    pub(super) fn document(&mut self, document: &Document) {
        let mut before: Option<&Item> = None;
        for item in &document.items {
            let apart = before.is_some_and(|b| self.stand_apart(b, item));
            self.item(item, apart);
            before = Some(item);
        }
        self.notes_before(u32::MAX, false);
    }

    /// True if a blank line always separates two items, whatever the source has.
    fn stand_apart(&self, a: &Item, b: &Item) -> bool {
        let braces = |item| family(item) == Family::Braces;
        braces(a) || braces(b) || self.source.is_none() && stand_apart(a, b)
    }

    pub(super) fn item(&mut self, item: &Item, apart: bool) {
        match item {
            Item::Profile(p) => self.line(p.at.0, apart, |s| s.profile(p)),
            Item::Cycle(time, at) => self.line(at.0, apart, |s| s.time_clause("scan", Some(*time), at.0)),
            Item::Target(plc, at) => self.line(at.0, apart, |s| {
                s.push("target ");
                s.push(plc.name());
            }),
            Item::Use(u) => self.line(u.at.0, apart, |s| s.using(u)),
            Item::Var(v) => self.line(v.at.0, apart, |s| s.variable(v)),
            Item::Chart(c) => self.group(c.at.0, apart, |s| s.chart(c)),
            Item::Instance(i) => self.line(i.at.0, apart, |s| s.instance(i)),
            Item::Composed(c) => self.group(c.at.0, apart, |s| s.composed(c)),
            Item::Type(t) => self.line(t.at.0, apart, |s| {
                s.push("type ");
                s.declaration(t);
            }),
            Item::Action(a) => self.group(a.at.0, apart, |s| s.named_action(a)),
            Item::Section(x) => self.section_item(x, apart),
            Item::Function(f) => self.group(f.at.0, apart, |s| s.function(f)),
            Item::Pre(body, at) => self.group(at.0, apart, |s| {
                s.push("pre ");
                s.body(body);
            }),
            Item::Post(body, at) => self.group(at.0, apart, |s| {
                s.push("post ");
                s.body(body);
            }),
            Item::Plant(p) => self.group(p.at.0, apart, |s| s.plant(p)),
            Item::Test(t) => self.group(t.at.0, apart, |s| s.test(t)),
            Item::Prove(p) => self.line(p.at.0, apart, |s| s.property(p)),
            Item::Layout(l) => self.group(l.at.0, apart, |s| s.layout(l)),
        }
    }

    fn using(&mut self, used: &Use) {
        self.push("use ");
        if used.library {
            self.name(&used.name.text);
        } else {
            self.push(&constant::quote_st(&used.name.text));
        }
    }

    fn profile(&mut self, profile: &Profile) {
        self.push("profile ");
        self.push(profile.name.name());
        if profile.switches.is_empty() {
            return;
        }
        self.push(" { ");
        for (i, (switch, _)) in profile.switches.iter().enumerate() {
            self.push(if i > 0 { ", " } else { "" });
            match switch {
                Switch::Bound(n) => self.push(&format!("bound {n}")),
                other => {
                    let name = SWITCHES.iter().find(|(_, s)| s == other).map_or("", |(name, _)| *name);
                    self.push(name);
                }
            }
        }
        self.push(" }");
    }

    pub(super) fn variable(&mut self, v: &VarDecl) {
        self.push(match v.kind {
            VarKind::Input => "input ",
            VarKind::Output => "output ",
            VarKind::Var => "var ",
            VarKind::Const => "const ",
        });
        self.declaration(v);
    }

    /// All of a declaration behind its word.
    pub(super) fn declaration(&mut self, v: &VarDecl) {
        self.names(&v.names);
        self.push(" : ");
        if let Some(array) = &v.array {
            self.array(array);
        }
        self.named_type(v.of.as_deref(), v.ty, v.limits.as_deref());
        self.initial(v.init.as_ref());
        if let Some(address) = &v.address {
            self.push(" at ");
            self.address(address);
        }
        self.push(if v.inverted { " inverted" } else { "" });
        self.push(if v.retain { " retain" } else { "" });
        if let Some(safe) = &v.safe {
            self.push(" safe ");
            self.expr(safe);
        }
        self.comment(v.comment.as_deref());
    }

    /// ` : type` of a parameter, of a local variable or of a result.
    pub(super) fn value_type(&mut self, ty: &ValueType) {
        self.push(" : ");
        self.named_type(ty.of.as_deref(), ty.base, ty.limits.as_deref());
    }

    fn named_type(&mut self, of: Option<&Name>, ty: Type, limits: Option<&Limits>) {
        match (of, limits) {
            (_, Some(Limits::Values(values))) => self.enumeration(values),
            (_, Some(Limits::Of(name))) => self.name(&name.text),
            (Some(of), _) => self.name(&of.text),
            (None, limits) => {
                self.push(&ty.to_string());
                if let Some(Limits::Range(least, most)) = limits {
                    self.push("(");
                    self.expr(least);
                    self.push("..");
                    self.expr(most);
                    self.push(")");
                }
            }
        }
    }

    /// `(Manual, Automatic := 5)`.
    fn enumeration(&mut self, values: &[(Name, Option<Expr>)]) {
        self.push("(");
        for (i, (name, number)) in values.iter().enumerate() {
            self.push(if i > 0 { ", " } else { "" });
            self.name(&name.text);
            if let Some(number) = number {
                self.push(" := ");
                self.expr(number);
            }
        }
        self.push(")");
    }

    /// `ARRAY[1..6, 0..3] OF `.
    fn array(&mut self, array: &Array) {
        for (i, (least, most)) in array.dimensions.iter().enumerate() {
            self.push(if i == 0 { "ARRAY[" } else { ", " });
            self.expr(least);
            self.push("..");
            self.expr(most);
        }
        self.push("] OF ");
    }

    fn address(&mut self, address: &Name) {
        if is_direct(&address.text) || is_plain(&address.text) {
            self.push(&address.text);
        } else {
            self.push(&constant::quote_st(&address.text));
        }
    }

    pub(super) fn named_action(&mut self, action: &NamedAction) {
        self.push("action ");
        self.name(&action.name.text);
        self.comment(action.comment.as_deref());
        self.push(" ");
        self.body(&action.body);
    }

    pub(super) fn section_item(&mut self, section: &Section, apart: bool) {
        let value = match section.body.statements.as_slice() {
            [only] if section.short => match &only.kind {
                StmtKind::Assign { value, .. } => Some(value),
                _ => None,
            },
            _ => None,
        };
        let at = section.at.0;
        let Some(value) = value else {
            return self.group(at, apart, |s| {
                s.section_name(section);
                s.push(" ");
                s.block(&section.body);
            });
        };
        self.line(at, apart, |s| {
            s.section_name(section);
            s.push(" := ");
            s.expr(value);
        });
    }

    fn section_name(&mut self, section: &Section) {
        self.push("transition section ");
        self.name(&section.name.text);
    }

    fn instance(&mut self, instance: &Instance) {
        self.push("instance ");
        match &instance.names {
            InstanceNames::One(name) => {
                self.name(&name.text);
                self.push(" : ");
                self.name(&instance.chart.text);
            }
            InstanceNames::Range(least, most) => {
                self.name(&instance.chart.text);
                self.push("[");
                self.expr(least);
                self.push("..");
                self.expr(most);
                self.push("]");
            }
        }
        if !instance.args.is_empty() {
            self.args(&instance.args);
        }
        self.comment(instance.comment.as_deref());
    }

    fn function(&mut self, function: &Function) {
        self.push("function ");
        self.name(&function.name.text);
        self.params(&function.params);
        self.value_type(&function.result);
        self.push(" ");
        self.block(&function.body);
    }

    pub(super) fn params(&mut self, params: &[Param]) {
        self.push("(");
        for (i, param) in params.iter().enumerate() {
            self.push(if i > 0 { ", " } else { "" });
            self.name(&param.name.text);
            self.value_type(&param.ty);
        }
        self.push(")");
    }
}

/// True if a blank line separates two items that a program made.
pub(super) fn stand_apart(a: &Item, b: &Item) -> bool {
    let (a, b) = (family(a), family(b));
    a == Family::Braces || a != b
}

/// Items that stand together without a blank line when a program made them.
#[derive(PartialEq, Eq, Clone, Copy)]
enum Family {
    Head,
    Uses,
    Types,
    Variables,
    Properties,
    Instances,
    Braces,
}

fn family(item: &Item) -> Family {
    match item {
        Item::Profile(_) | Item::Cycle(..) | Item::Target(..) => Family::Head,
        Item::Use(_) => Family::Uses,
        Item::Var(_) => Family::Variables,
        Item::Type(_) => Family::Types,
        Item::Prove(_) => Family::Properties,
        Item::Instance(_) => Family::Instances,
        Item::Section(s) if s.short => Family::Variables,
        Item::Chart(_)
        | Item::Action(_)
        | Item::Section(_)
        | Item::Function(_)
        | Item::Composed(_)
        | Item::Pre(..)
        | Item::Post(..)
        | Item::Plant(_)
        | Item::Test(_)
        | Item::Layout(_) => Family::Braces,
    }
}

/// True if a text is a direct name such as `%I0.1`, in upper case.
fn is_direct(text: &str) -> bool {
    let Some(rest) = text.strip_prefix('%') else { return false };
    let fits = |c: char| c.is_ascii_uppercase() || c.is_ascii_digit() || c == '_';
    rest.starts_with(|c: char| c.is_ascii_uppercase())
        && rest.split('.').enumerate().all(|(i, part)| {
            let starts = part.starts_with(|c: char| c.is_ascii_alphanumeric());
            part.chars().all(fits) && (i == 0 || starts)
        })
}

/// The place of an item of a plant or chart that has one field for it.
pub(super) fn starts(at: Option<Span>) -> Option<u32> {
    at.map(|s| s.start)
}
