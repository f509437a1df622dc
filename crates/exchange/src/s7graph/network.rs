//! Networks of contacts, boxes and coils (`FlgNet`): the value at the end of a network, and its
//! statements.

use std::collections::HashMap;
use std::ops::Range;

use g7_model::codes;
use g7_model::{BinaryOp, Expr, ExprKind, Span, Stmt, UnaryOp, say};

use super::read::{Xml, kid, kids};
use g7_iec::nodes::{self, and, assign, binary, boolean, not, or, when};
use g7_iec::report::Report;
use g7_iec::st;
use g7_iec::xml::attr;

/// The most parts visited for one network; a value that is used twice is computed twice.
const MOST_VISITS: usize = 20_000;
/// The most parts in series.
const DEEPEST: usize = 120;

/// The beginning of a wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Source<'a> {
    Rail,
    Access(&'a str),
    Pin(&'a str, &'a str),
    Open,
}

/// A network, by the numbers of its parts.
pub(super) struct Network<'a> {
    parts: HashMap<&'a str, Xml<'a>>,
    order: Vec<&'a str>,
    /// The source of each input pin.
    into: HashMap<(&'a str, &'a str), Source<'a>>,
    /// The accesses that each output pin writes.
    out: HashMap<(&'a str, &'a str), Vec<&'a str>>,
    left: usize,
    pub(super) at: Range<usize>,
}

/// The network within an element, if it has one.
pub(super) fn network<'a>(node: Xml<'a>, report: &mut Report) -> Option<Network<'a>> {
    if let Some(other) =
        node.children().find(|n| matches!(n.tag_name().name(), "StatementList" | "StructuredText"))
    {
        report.say(
            &codes::NOT_CARRIED,
            &attr::head(other),
            say!("a network in STL or SCL is not carried over"),
        );
        return None;
    }
    let net = kid(node, "FlgNet")?;
    let mut network = Network {
        parts: HashMap::new(),
        order: Vec::new(),
        into: HashMap::new(),
        out: HashMap::new(),
        left: MOST_VISITS,
        at: attr::head(net),
    };
    for part in kid(net, "Parts").into_iter().flat_map(|n| n.children()).filter(Xml::is_element) {
        let Some(uid) = part.attribute("UId") else { continue };
        network.parts.insert(uid, part);
        if part.tag_name().name() != "Access" {
            network.order.push(uid);
        }
    }
    for wire in kid(net, "Wires").into_iter().flat_map(|n| kids(n, "Wire")) {
        network.wire(wire);
    }
    Some(network)
}

/// True for pins that give a value.
fn is_output(pin: &str) -> bool {
    matches!(pin, "out" | "out1" | "eno" | "ENO" | "OUT" | "Q" | "ET" | "q" | "QU" | "QD" | "CV")
}

impl<'a> Network<'a> {
    fn wire(&mut self, wire: Xml<'a>) {
        let ends: Vec<Source<'a>> = wire.children().filter(Xml::is_element).filter_map(end).collect();
        let given = ends.iter().copied().find(|s| match s {
            Source::Rail => true,
            Source::Pin(_, pin) => is_output(pin),
            _ => false,
        });
        let source = given
            .or_else(|| ends.iter().copied().find(|s| matches!(s, Source::Access(_))))
            .unwrap_or(Source::Open);
        for end in &ends {
            match (*end, source) {
                (Source::Pin(uid, pin), _) if *end != source => {
                    self.into.insert((uid, pin), source);
                }
                (Source::Access(access), Source::Pin(uid, pin)) => {
                    self.out.entry((uid, pin)).or_default().push(access);
                }
                _ => {}
            }
        }
    }

    fn span(&self, node: Xml, report: &Report) -> Span {
        report.span(&attr::head(node))
    }

    /// The kind of a part.
    fn kind(&self, uid: &str) -> &'a str {
        self.parts.get(uid).map_or("", |n| match n.tag_name().name() {
            "Part" => n.attribute("Name").unwrap_or(""),
            other => other,
        })
    }

    fn negated(&self, uid: &str, pin: &str) -> bool {
        let part = self.parts.get(uid);
        part.is_some_and(|n| kids(*n, "Negated").any(|k| k.attribute("Name") == Some(pin)))
    }

    /// The value of the last coil of a kind; `None` if it is connected to the rail alone.
    pub(super) fn value(&mut self, coil: &str, report: &mut Report) -> Option<Expr> {
        let uid = *self.order.iter().find(|uid| self.kind(uid) == coil)?;
        match self.into.get(&(uid, "in")) {
            None | Some(Source::Rail | Source::Open) => None,
            Some(_) => {
                let value = self.input(uid, "in", 0, report);
                Some(value)
            }
        }
    }

    /// The statements of a network.
    pub(super) fn statements(&mut self, report: &mut Report) -> Vec<Stmt> {
        let mut list = Vec::new();
        for uid in self.order.clone() {
            let Some(&node) = self.parts.get(uid) else { continue };
            let at = self.span(node, report);
            let kind = self.kind(uid);
            match kind {
                "Coil" | "SCoil" | "RCoil" | "Assign" => {
                    let value = self.input(uid, "in", 0, report);
                    let Some(target) = self.operand(uid, report) else { continue };
                    let value =
                        if self.negated(uid, "operand") && kind != "SCoil" { not(value, at) } else { value };
                    list.push(match kind {
                        "SCoil" => when(value, vec![assign(target, boolean(true, at), at)], Vec::new(), at),
                        "RCoil" => when(value, vec![assign(target, boolean(false, at), at)], Vec::new(), at),
                        _ => assign(target, value, at),
                    });
                }
                "Move" => {
                    let enabled = self.input(uid, "en", 0, report);
                    let value = self.input(uid, "in", 0, report);
                    for access in self.out.get(&(uid, "out1")).cloned().unwrap_or_default() {
                        let set = assign(self.access(access, report), value.clone(), at);
                        list.push(guarded(enabled.clone(), set, at));
                    }
                }
                "Add" | "Sub" | "Mul" | "Div" | "Mod" => {
                    let enabled = self.input(uid, "en", 0, report);
                    let value = self.output(uid, "out", 0, report);
                    for access in self.out.get(&(uid, "out")).cloned().unwrap_or_default() {
                        let set = assign(self.access(access, report), value.clone(), at);
                        list.push(guarded(enabled.clone(), set, at));
                    }
                }
                "Contact" | "O" | "A" | "X" | "And" | "Or" | "Xor" | "Not" | "Eq" | "Ne" | "Lt" | "Gt"
                | "Le" | "Ge" | "PContact" | "NContact" | "PBox" | "NBox" | "TrCoil" | "SvCoil"
                | "IlCoil" => {}
                _ => self.strange(node, kind, report),
            }
        }
        list
    }

    fn strange(&self, node: Xml, kind: &str, report: &mut Report) {
        let what = say!("`{}` in a network has no counterpart", nodes::line(kind));
        report.say(&codes::NOT_CARRIED, &attr::head(node), what);
    }

    /// The variable at the operand of a contact or coil.
    fn operand(&mut self, uid: &str, report: &mut Report) -> Option<Expr> {
        match self.into.get(&(uid, "operand")).copied() {
            Some(Source::Access(access)) => Some(self.access(access, report)),
            _ => {
                let at = self.parts.get(uid).map_or(self.at.clone(), |n| attr::head(*n));
                report.say(&codes::OPEN_LINK, &at, say!("a contact or coil without its variable"));
                None
            }
        }
    }

    /// The value at an input pin.
    fn input(&mut self, uid: &str, pin: &str, depth: usize, report: &mut Report) -> Expr {
        let node = self.parts.get(uid).copied();
        let range = node.map_or(self.at.clone(), attr::head);
        let at = report.span(&range);
        if self.left == 0 || depth > DEEPEST {
            let code = if depth > DEEPEST { &codes::TOO_DEEP } else { &codes::TOO_LARGE };
            report.element(code, "network", &range, say!("a network with too many parts on one way"));
            return nodes::bad(at);
        }
        self.left -= 1;
        let value = match self.into.get(&(uid, pin)).copied() {
            Some(Source::Rail) => boolean(true, at),
            Some(Source::Access(access)) => self.access(access, report),
            Some(Source::Pin(from, pin)) => self.output(from, pin, depth + 1, report),
            Some(Source::Open) | None => {
                // An unconnected enable input does not block a box.
                boolean(matches!(pin, "en" | "pre"), at)
            }
        };
        if self.negated(uid, pin) { not(value, at) } else { value }
    }

    /// The value at an output of a part.
    fn output(&mut self, uid: &str, pin: &str, depth: usize, report: &mut Report) -> Expr {
        let Some(&node) = self.parts.get(uid) else { return nodes::bad(report.span(&self.at.clone())) };
        let at = self.span(node, report);
        let kind = self.kind(uid);
        let value = match kind {
            "Contact" => {
                let before = self.input(uid, "in", depth, report);
                let Some(operand) = self.operand(uid, report) else { return nodes::bad(at) };
                let operand = if self.negated(uid, "operand") { not(operand, at) } else { operand };
                and(before, operand, at)
            }
            "PContact" | "NContact" => {
                let before = self.input(
                    uid,
                    if self.into.contains_key(&(uid, "pre")) { "pre" } else { "in" },
                    depth,
                    report,
                );
                let Some(operand) = self.operand(uid, report) else { return nodes::bad(at) };
                let op = if kind == "PContact" { UnaryOp::Rise } else { UnaryOp::Fall };
                and(before, nodes::unary(op, operand, at), at)
            }
            "PBox" | "NBox" => {
                let op = if kind == "PBox" { UnaryOp::Rise } else { UnaryOp::Fall };
                let value = self.input(uid, "in", depth, report);
                nodes::unary(op, value, at)
            }
            "Not" => {
                let value = self.input(uid, "in", depth, report);
                not(value, at)
            }
            "O" | "Or" => self.joined(uid, depth, report, or),
            "A" | "And" => self.joined(uid, depth, report, and),
            "X" | "Xor" => self.joined(uid, depth, report, |a, b, at| binary(BinaryOp::Xor, a, b, at)),
            "Eq" | "Ne" | "Lt" | "Gt" | "Le" | "Ge" => {
                let op = match kind {
                    "Eq" => BinaryOp::Eq,
                    "Ne" => BinaryOp::Ne,
                    "Lt" => BinaryOp::Lt,
                    "Gt" => BinaryOp::Gt,
                    "Le" => BinaryOp::Le,
                    _ => BinaryOp::Ge,
                };
                let before = self.input(uid, "pre", depth, report);
                let a = self.input(uid, "in1", depth, report);
                let b = self.input(uid, "in2", depth, report);
                and(before, binary(op, a, b, at), at)
            }
            "Add" | "Sub" | "Mul" | "Div" | "Mod" if pin == "out" => {
                let op = match kind {
                    "Add" => BinaryOp::Add,
                    "Sub" => BinaryOp::Sub,
                    "Mul" => BinaryOp::Mul,
                    "Div" => BinaryOp::Div,
                    _ => BinaryOp::Mod,
                };
                self.joined(uid, depth, report, |a, b, at| binary(op, a, b, at))
            }
            "Move" | "Add" | "Sub" | "Mul" | "Div" | "Mod" => self.input(uid, "en", depth, report),
            "Coil" | "SCoil" | "RCoil" | "Assign" => self.input(uid, "in", depth, report),
            _ => {
                self.strange(node, kind, report);
                nodes::bad(at)
            }
        };
        if self.negated(uid, pin) { not(value, at) } else { value }
    }

    /// All inputs `in1`, `in2`, … of a box, combined.
    fn joined(
        &mut self,
        uid: &str,
        depth: usize,
        report: &mut Report,
        join: impl Fn(Expr, Expr, Span) -> Expr,
    ) -> Expr {
        let at = self.parts.get(uid).map_or(self.at.clone(), |n| attr::head(*n));
        let at = report.span(&at);
        let mut value: Option<Expr> = None;
        for number in 1..=MOST_VISITS {
            let pin = format!("in{number}");
            if !self.into.contains_key(&(uid, pin.as_str())) {
                break;
            }
            let next = self.input(uid, &pin, depth, report);
            value = Some(match value {
                Some(before) => join(before, next, at),
                None => next,
            });
        }
        value.unwrap_or_else(|| nodes::bad(at))
    }

    /// A variable or constant.
    fn access(&self, uid: &str, report: &mut Report) -> Expr {
        match self.parts.get(uid) {
            Some(node) => access(*node, report),
            None => nodes::bad(report.span(&self.at)),
        }
    }
}

fn guarded(enabled: Expr, stmt: Stmt, at: Span) -> Stmt {
    if nodes::truth(&enabled) == Some(true) { stmt } else { when(enabled, vec![stmt], Vec::new(), at) }
}

fn end<'a>(node: Xml<'a>) -> Option<Source<'a>> {
    let uid = node.attribute("UId").unwrap_or("");
    match node.tag_name().name() {
        "Powerrail" => Some(Source::Rail),
        "IdentCon" => Some(Source::Access(uid)),
        "NameCon" => Some(Source::Pin(uid, node.attribute("Name").unwrap_or(""))),
        _ => None,
    }
}

/// The names of an `Access`: one of a structure has several.
pub(super) fn symbol(node: Xml) -> Option<Vec<String>> {
    let symbol = kid(node, "Symbol")?;
    let names = kids(symbol, "Component").map(|n| {
        let index: Vec<String> = n
            .descendants()
            .filter(|d| d.tag_name().name() == "ConstantValue")
            .map(|d| nodes::line(&attr::content(d).text))
            .collect();
        let own = nodes::line(&n.attribute("Name").unwrap_or("").replace('`', "'"));
        if index.is_empty() { own } else { format!("{own}[{}]", index.join(",")) }
    });
    let names: Vec<String> = names.filter(|n| !n.is_empty()).collect();
    (!names.is_empty()).then_some(names)
}

/// An `Access` as an expression.
pub(super) fn access(node: Xml, report: &mut Report) -> Expr {
    let range = attr::head(node);
    let at = report.span(&range);
    let variable_index = node
        .descendants()
        .filter(|n| n.tag_name().name() == "Access")
        .nth(1)
        .filter(|n| kid(*n, "Symbol").is_some());
    if let Some(index) = variable_index {
        let what = say!("an element of an array by a variable index; there are no arrays");
        report.say(&codes::NOT_CARRIED, &attr::head(index), what);
        return nodes::bad(at);
    }
    if let Some(names) = symbol(node) {
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        return nodes::name(&names, at);
    }
    let value = node.descendants().find(|n| n.tag_name().name() == "ConstantValue");
    if let Some(value) = value {
        let text = attr::content(value);
        let place = |part: Range<usize>| text.place(&part);
        return st::single::expression(&text.text, &place, report);
    }
    if let Some(address) = kid(node, "Address")
        && let Some(name) = direct(address)
    {
        return nodes::expr(ExprKind::Path(nodes::path(&[&name], at)), at);
    }
    report.say(&codes::NOT_CARRIED, &range, say!("an operand that has no counterpart"));
    nodes::bad(at)
}

/// `%M10.3` of an absolute address.
fn direct(node: Xml) -> Option<String> {
    let area = match node.attribute("Area")? {
        "Input" => "I",
        "Output" => "Q",
        "Memory" => "M",
        _ => return None,
    };
    let offset: u32 = node.attribute("BitOffset")?.trim().parse().ok()?;
    let size = match node.attribute("Type")? {
        "Bool" => return Some(format!("%{area}{}.{}", offset / 8, offset % 8)),
        "Byte" | "SInt" | "USInt" => "B",
        "Word" | "Int" | "UInt" => "W",
        "DWord" | "DInt" | "UDInt" | "Real" | "Time" => "D",
        _ => return None,
    };
    Some(format!("%{area}{size}{}", offset / 8))
}
