//! Networks of contacts, coils and blocks: the statements in execution order, and the Boolean value
//! that a network gives to a transition.

use std::collections::HashSet;

use g7_model::codes;
use g7_model::{Arg, Expr, ExprKind, Name, Path, Said, Span, StandardFunction, Stmt, StmtKind, UnaryOp, say};

use super::graph::{Edge, Graph, Input, Object, Slot, Wire};
use super::tree::{Xml, flag, head, place, word};
use crate::nodes;
use crate::report::Report;
use crate::signs;
use crate::st;
use crate::xml::attr::Text;

/// The most objects visited for one drawing; a value that is used twice is computed twice.
const MOST_VISITS: usize = 20_000;
/// The most objects in series.
const DEEPEST: usize = 150;

/// The statements of a drawing.
pub(super) fn statements(body: Xml, report: &mut Report) -> Vec<Stmt> {
    let graph = Graph::read(body, report);
    let mut net = Net::new(&graph, report);
    for index in net.sinks() {
        net.sink(index, 0);
    }
    net.out
}

/// The value at the end of a transition's drawing, with the statements that must run before it.
pub(super) fn value(body: Xml, name: Option<&str>, report: &mut Report) -> (Option<Expr>, Vec<Stmt>) {
    let graph = Graph::read(body, report);
    let mut net = Net::new(&graph, report);
    let ends: Vec<usize> = net
        .sinks()
        .into_iter()
        .filter(|i| {
            graph.get(*i).is_some_and(|o| !is_instance(o) && matches!(&*o.kind, "coil" | "outVariable"))
        })
        .collect();
    let named = ends.iter().find(|i| {
        let text = graph.get(**i).and_then(Object::text);
        text.zip(name).is_some_and(|(t, n)| t.text.trim().eq_ignore_ascii_case(n))
    });
    let end = named.or(ends.last()).copied();
    let result = end.and_then(|i| graph.get(i)).map(|object| {
        let value = net.flow(object, 0);
        let at = value.at.0;
        if flag(object.node, "negated") { nodes::not(value, at) } else { value }
    });
    (result, net.out)
}

/// The value of the network that is wired to a transition's condition.
pub(super) fn condition(graph: &Graph, object: &Object, report: &mut Report) -> (Option<Expr>, Vec<Stmt>) {
    let mut net = Net::new(graph, report);
    let input = object.inputs.iter().find(|i| i.slot == Slot::Condition);
    let value = input.and_then(|i| net.input(i, 0));
    (value, net.out)
}

/// Computes values from a graph.
struct Net<'g, 'a, 'r> {
    graph: &'g Graph<'a>,
    report: &'r mut Report,
    /// Objects whose effect is already in the statements or about to be.
    done: HashSet<usize>,
    /// Blocks without memory on the current path, to detect loops.
    busy: HashSet<usize>,
    out: Vec<Stmt>,
    left: usize,
    full: bool,
}

fn is_instance(object: &Object) -> bool {
    object.kind == "block" && word(object.node, "instanceName").is_some()
}

impl<'g, 'a, 'r> Net<'g, 'a, 'r> {
    fn new(graph: &'g Graph<'a>, report: &'r mut Report) -> Net<'g, 'a, 'r> {
        let (done, busy) = (HashSet::new(), HashSet::new());
        Net { graph, report, done, busy, out: Vec::new(), left: MOST_VISITS, full: false }
    }

    /// The objects with an effect in execution order: by their numbers, then from top to bottom and
    /// from left to right.
    fn sinks(&self) -> Vec<usize> {
        let mut keys = Vec::new();
        for (index, object) in self.graph.objects.iter().enumerate() {
            let wired = object.inputs.iter().any(|i| !i.wires.is_empty() || i.value.is_some());
            let acts = match object.kind.as_str() {
                "outVariable" | "coil" | "return" | "jump" => true,
                "inOutVariable" => wired,
                "block" => is_instance(object),
                _ => false,
            };
            if acts {
                let order = word(object.node, "executionOrderId").and_then(|w| w.parse::<u64>().ok());
                let (x, y) = place(object.node).unwrap_or_default();
                keys.push((order.filter(|o| *o > 0).unwrap_or(u64::MAX), y, x, index));
            }
        }
        keys.sort_unstable();
        keys.into_iter().map(|k| k.3).collect()
    }

    fn may(&mut self, at: &Object, depth: usize) -> bool {
        if let (Some(left), true) = (self.left.checked_sub(1), depth <= DEEPEST) {
            self.left = left;
            return true;
        }
        if !self.full {
            self.full = true;
            let code = if depth > DEEPEST { &codes::TOO_DEEP } else { &codes::TOO_LARGE };
            self.report.say(code, &head(at.node), say!("a network with too many objects on one way"));
        }
        false
    }

    fn span(&self, object: &Object) -> Span {
        self.report.span(&head(object.node))
    }

    /// Writes the effect of an object, after those that it needs.
    fn sink(&mut self, index: usize, depth: usize) {
        let Some(object) = self.graph.get(index) else { return };
        if !self.done.insert(index) || !self.may(object, depth) {
            return;
        }
        let at = self.span(object);
        match object.kind.as_str() {
            "coil" => self.coil(object, at, depth),
            "outVariable" | "inOutVariable" => {
                let enabled = self.enabled(object, depth);
                let value = self.flow(object, depth);
                let negated = flag(object.node, "negated") || flag(object.node, "negatedIn");
                let value = if negated { nodes::not(value, at) } else { value };
                if let Some(target) = self.target(object) {
                    let assign = nodes::assign(target, value, at);
                    self.put(enabled, assign, at);
                }
            }
            "block" => self.block_call(object, at, depth),
            "return" => {
                let value = self.flow(object, depth);
                let value = if flag(object.node, "negated") { nodes::not(value, at) } else { value };
                let back = Stmt { kind: StmtKind::Return, at: at.into() };
                self.put(Some(value), back, at);
            }
            _ => {
                let what = say!("a jump to a label of the network is not carried over");
                self.report.say(&codes::NOT_CARRIED, &head(object.node), what);
            }
        }
    }

    /// Adds a statement, under its condition if it has one.
    fn put(&mut self, condition: Option<Expr>, statement: Stmt, at: Span) {
        let always = condition.as_ref().and_then(nodes::truth) == Some(true);
        match condition.filter(|_| !always) {
            Some(condition) => self.out.push(nodes::when(condition, vec![statement], Vec::new(), at)),
            None => self.out.push(statement),
        }
    }

    fn coil(&mut self, object: &Object<'a>, at: Span, depth: usize) {
        let value = self.flow(object, depth);
        let Some(target) = self.target(object) else { return };
        let value = match object.edge() {
            Edge::Level => value,
            Edge::Rising => nodes::unary(UnaryOp::Rise, value, at),
            Edge::Falling => nodes::unary(UnaryOp::Fall, value, at),
        };
        let value = if flag(object.node, "negated") { nodes::not(value, at) } else { value };
        let storage = word(object.node, "storage").or_else(|| word(object.node, "latch")).unwrap_or("none");
        match storage {
            "set" | "reset" => {
                let assign = nodes::assign(target, nodes::boolean(storage == "set", at), at);
                self.put(Some(value), assign, at);
            }
            _ => self.out.push(nodes::assign(target, value, at)),
        }
    }

    /// The variable that an object names.
    fn target(&mut self, object: &Object) -> Option<Expr> {
        let Some(text) = object.text().filter(|t| !t.text.trim().is_empty()) else {
            let what = say!("a `{}` without a variable", object.kind);
            self.report.say(&codes::BAD_TEXT, &head(object.node), what);
            return None;
        };
        let expr = self.parse(&text);
        if !matches!(
            expr.kind,
            ExprKind::Path(_) | ExprKind::Direct(_) | ExprKind::Element(..) | ExprKind::Bad
        ) {
            let what = say!("a `{}` writes a variable, not another expression", object.kind);
            self.report.say(&codes::BAD_TEXT, &text.at, what);
            return None;
        }
        Some(expr).filter(|e| e.kind != ExprKind::Bad)
    }

    fn parse(&mut self, text: &Text) -> Expr {
        st::expression(&text.text, &|r| text.place(&r), self.report)
    }

    /// The `EN` input of a block without memory that feeds a variable. The variable is written only
    /// while it is true.
    fn enabled(&mut self, object: &Object, depth: usize) -> Option<Expr> {
        let source = object.flow().next().and_then(|w| self.graph.get(w.from))?;
        if source.kind != "block" || is_instance(source) {
            return None;
        }
        let input = source.inputs.iter().find(|i| matches!(&i.slot, Slot::Pin(p) if p == "EN"))?;
        self.input(input, depth + 1)
    }

    fn block_call(&mut self, object: &Object<'a>, at: Span, depth: usize) {
        let mut args = Vec::new();
        let mut enabled = None;
        for input in &object.inputs {
            let Slot::Pin(pin) = &input.slot else { continue };
            let Some(value) = self.input(input, depth + 1) else { continue };
            if pin == "EN" {
                enabled = Some(value);
            } else {
                args.push(Arg::input(Some(Name::new(pin.as_str(), at)), value));
            }
        }
        let call = StmtKind::Call(Path { names: instance(object, at) }, args);
        self.put(enabled, Stmt { kind: call, at: at.into() }, at);
    }

    /// The power that flows into an object; FALSE with a warning if nothing is connected.
    fn flow(&mut self, object: &Object, depth: usize) -> Expr {
        let at = self.span(object);
        let mut value: Option<Expr> = None;
        for input in object.inputs.iter().filter(|i| i.slot == Slot::Flow) {
            if let Some(more) = self.input(input, depth + 1) {
                value = Some(match value {
                    Some(one) => nodes::or(one, more, at),
                    None => more,
                });
            }
        }
        value.unwrap_or_else(|| {
            let what = say!("nothing is wired to this `{}`; it is taken for FALSE", object.kind);
            self.report.say(&codes::OPEN_LINK, &head(object.node), what);
            nodes::boolean(false, at)
        })
    }

    /// The value at one input; several wires form an OR.
    fn input(&mut self, input: &Input, depth: usize) -> Option<Expr> {
        let at = self.report.span(&input.at);
        let mut value: Option<Expr> = input.value.as_ref().map(|t| self.parse(t));
        for wire in &input.wires {
            let more = self.wire(wire, depth + 1);
            value = Some(match value {
                Some(one) => nodes::or(one, more, at),
                None => more,
            });
        }
        let value = value?;
        let value = match input.edge {
            Edge::Level => value,
            Edge::Rising => nodes::unary(UnaryOp::Rise, value, at),
            Edge::Falling => nodes::unary(UnaryOp::Fall, value, at),
        };
        Some(if input.negated { nodes::not(value, at) } else { value })
    }

    /// The value that a wire carries.
    fn wire(&mut self, wire: &Wire, depth: usize) -> Expr {
        let Some(object) = self.graph.get(wire.from) else { return nodes::bad(Span::default()) };
        let at = self.span(object);
        if !self.may(object, depth) {
            return nodes::bad(at);
        }
        match object.kind.as_str() {
            "leftPowerRail" => nodes::boolean(true, at),
            "inVariable" => {
                let value = self.variable(object);
                if flag(object.node, "negated") { nodes::not(value, at) } else { value }
            }
            "inOutVariable" => {
                if object.inputs.iter().any(|i| !i.wires.is_empty()) {
                    self.sink(wire.from, depth + 1);
                }
                let value = self.variable(object);
                if flag(object.node, "negatedOut") { nodes::not(value, at) } else { value }
            }
            "contact" => {
                let before = self.flow(object, depth);
                let value = self.variable(object);
                let value = match object.edge() {
                    Edge::Level => value,
                    Edge::Rising => nodes::unary(UnaryOp::Rise, value, at),
                    Edge::Falling => nodes::unary(UnaryOp::Fall, value, at),
                };
                let value = if flag(object.node, "negated") { nodes::not(value, at) } else { value };
                nodes::and(before, value, at)
            }
            "coil" => self.flow(object, depth),
            "continuation" => match self.graph.connector(object).and_then(|i| self.graph.get(i)) {
                Some(connector) => self.flow(connector, depth),
                None => self.nothing(object, say!("a continuation without its connector")),
            },
            "connector" => self.flow(object, depth),
            "step" | "macroStep" => {
                let name = word(object.node, "name").unwrap_or("");
                nodes::name(&[name, "X"], at)
            }
            "block" if is_instance(object) => {
                self.sink(wire.from, depth + 1);
                let mut names = instance(object, at);
                names.push(Name::new(wire.pin.as_str(), at));
                self.pin(object, &wire.pin, nodes::expr(ExprKind::Path(Path { names }), at))
            }
            "block" => self.function(object, wire, at, depth),
            other => {
                let what = say!("a value cannot come from a `{other}`");
                self.nothing(object, what)
            }
        }
    }

    /// The value of an output pin, complemented if it is drawn so.
    fn pin(&self, object: &Object, pin: &str, value: Expr) -> Expr {
        let outputs = object.node.descendants().filter(|n| n.is_element());
        let negated = outputs
            .filter(|n| n.parent_element().is_some_and(|p| super::tree::tag(p) == "outputVariables"))
            .filter(|n| {
                word(*n, "formalParameter").or_else(|| word(*n, "parameterName")).unwrap_or("") == pin
            })
            .any(|n| flag(n, "negated"));
        let at = value.at.0;
        if negated { nodes::not(value, at) } else { value }
    }

    fn nothing(&mut self, object: &Object, what: Said) -> Expr {
        let at = self.span(object);
        self.report.say(&codes::BAD_LINK, &head(object.node), what);
        nodes::bad(at)
    }

    fn variable(&mut self, object: &Object) -> Expr {
        match object.text().filter(|t| !t.text.trim().is_empty()) {
            Some(text) => self.parse(&text),
            None => {
                let what = say!("a `{}` without a variable", object.kind);
                self.report.say(&codes::BAD_TEXT, &head(object.node), what);
                nodes::bad(self.span(object))
            }
        }
    }

    /// The result of a function or operator.
    fn function(&mut self, object: &Object<'a>, wire: &Wire, at: Span, depth: usize) -> Expr {
        if !self.busy.insert(wire.from) {
            return self.nothing(object, say!("a value that depends on itself without a variable between"));
        }
        let mut args = Vec::new();
        let mut enable = None;
        for input in &object.inputs {
            let Slot::Pin(pin) = &input.slot else { continue };
            let Some(value) = self.input(input, depth + 1) else { continue };
            if pin == "EN" {
                enable = Some(value);
            } else {
                args.push((pin.clone(), value));
            }
        }
        self.busy.remove(&wire.from);
        if wire.pin == "ENO" {
            return enable.unwrap_or_else(|| nodes::boolean(true, at));
        }
        let value = applied(word(object.node, "typeName").unwrap_or(""), args, at);
        self.pin(object, &wire.pin, value)
    }
}

/// The instance that a block calls.
fn instance(object: &Object, at: Span) -> Vec<Name> {
    let name = word(object.node, "instanceName").unwrap_or("");
    name.split('.').map(|n| Name::new(n.trim(), at)).collect()
}

/// A function applied to its values; an operator if the language has one.
fn applied(function: &str, args: Vec<(String, Expr)>, at: Span) -> Expr {
    if function.eq_ignore_ascii_case("MOVE") && args.len() == 1 {
        return args.into_iter().next().map_or_else(|| nodes::bad(at), |(_, v)| v);
    }
    // Inputs whose names say another order keep them; those of unknown functions keep all but IN1, IN2.
    let by_place = match StandardFunction::named(function).map(StandardFunction::row) {
        Some(row) => {
            let places: Vec<Option<usize>> = args.iter().map(|(n, _)| row.place(n)).collect();
            places.contains(&None) || places.iter().enumerate().all(|(k, p)| *p == Some(k))
        }
        None => args.iter().all(|(n, _)| {
            n.strip_prefix("IN").is_some_and(|rest| rest.chars().all(|c| c.is_ascii_digit())) || n.is_empty()
        }),
    };
    let named = |n: String| (!by_place).then(|| Name::new(n.as_str(), at));
    let args = args.into_iter().map(|(n, value)| Arg::input(named(n), value));
    signs::applied(function, args.collect(), at)
        .unwrap_or_else(|args| nodes::expr(ExprKind::Call(nodes::path(&[function], at), args), at))
}
