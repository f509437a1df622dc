//! Rungs as PLCopen XML (TC6 2.01): one function block with a Ladder body.

use std::collections::HashMap;

use g7_iec::xml::element::Element;
use g7_model::FbKind;

use super::form::{Class, Declared};
use super::ladder::{Block, Coil, End, Ladder, Net, Rung};
use super::st::expression;

/// Units wide and high of a contact or coil with the space round it.
const WIDE: usize = 128;
const HIGH: usize = 48;

/// Objects are numbered in the order in which they are drawn.
#[derive(Default)]
struct Drawing {
    objects: Vec<Element>,
    next: usize,
    /// The place of each output, by its object and, if the object has several outputs, by the name of the output.
    outs: HashMap<(usize, Option<String>), (usize, usize)>,
}

/// The whole project.
pub(crate) fn print(name: &str, l: &Ladder) -> String {
    let mut drawing = Drawing::default();
    let mut y = 16;
    for r in &l.rungs {
        y = drawing.rung(r, y) + 32;
    }
    let body = Element::new("body").child(Element::new("LD").children(drawing.objects));
    let unit = Element::new("pou").with("name", name).with("pouType", "functionBlock");
    let unit = unit.child(interface(&l.variables)).child(body);
    let types =
        Element::new("types").child(Element::new("dataTypes")).child(Element::new("pous").child(unit));
    let scaled =
        |tag: &str| Element::new(tag).child(Element::new("scaling").with("x", 8).with("y", 8)).on_one_line();
    let header = Element::new("fileHeader")
        .with("companyName", "G7")
        .with("productName", "G7")
        .with("productVersion", "1")
        .with("creationDateTime", "1970-01-01T00:00:00");
    let scales = Element::new("coordinateInfo").children(["fbd", "ld", "sfc"].map(scaled));
    let project = Element::new("project")
        .with("xmlns", "http://www.plcopen.org/xml/tc6_0201")
        .with("xmlns:xhtml", "http://www.w3.org/1999/xhtml")
        .child(header)
        .child(Element::new("contentHeader").with("name", name).child(scales))
        .child(types)
        .child(Element::new("instances").child(Element::new("configurations")));
    let mut text = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    project.print(0, &mut text);
    text
}

fn interface(variables: &[Declared]) -> Element {
    let classes = [
        (Class::Input, "inputVars"),
        (Class::Output, "outputVars"),
        (Class::Retain, "localVars"),
        (Class::Internal, "localVars"),
    ];
    let mut all = Element::new("interface");
    for (class, tag) in classes {
        let mut own = variables.iter().filter(|v| v.class == class).map(variable).peekable();
        if own.peek().is_none() {
            continue;
        }
        let mut list = Element::new(tag);
        if class == Class::Retain {
            list.set("retain", "true");
        }
        all.push(list.children(own));
    }
    all
}

fn variable(v: &Declared) -> Element {
    let block = FbKind::ALL.iter().any(|kind| kind.name() == v.ty);
    let ty = if block { Element::new("derived").with("name", &v.ty) } else { Element::new(&v.ty) };
    let ty = if v.elements == 1 {
        ty
    } else {
        let dimension = Element::new("dimension").with("lower", 0).with("upper", v.elements - 1);
        Element::new("array").child(dimension).child(Element::new("baseType").child(ty))
    };
    let simple = |text: &str| Element::new("simpleValue").with("value", text);
    let init = match v.init.as_slice() {
        [] => None,
        [one] => Some(simple(&expression(one))),
        many => {
            let values = many.iter().map(|e| Element::new("value").child(simple(&expression(e))));
            Some(Element::new("arrayValue").children(values))
        }
    };
    let mut variable = Element::new("variable").with("name", &v.name).child(Element::new("type").child(ty));
    variable.extend(init.map(|value| Element::new("initialValue").child(value)));
    if !v.note.is_empty() {
        variable.push(Element::new("documentation").child(paragraph(&v.note)));
    }
    variable.on_one_line()
}

fn paragraph(text: &str) -> Element {
    Element::with_text("xhtml:p", &text.replace(|c: char| c.is_control(), " "))
}

/// Columns and rows that a network takes.
pub(crate) fn size(net: &Net) -> (usize, usize) {
    match net {
        Net::Wire => (0, 1),
        Net::Contact { .. } => (1, 1),
        Net::Series(list) => list.iter().map(size).fold((0, 1), |(w, h), (a, b)| (w + a, h.max(b))),
        Net::Parallel(list) => list.iter().map(size).fold((0, 0), |(w, h), (a, b)| (w.max(a), h + b)),
    }
}

/// The network in a form that Beremiz can generate code for. Beremiz sorts parallel branches and fails if a branch
/// is a single contact beside a series. So a contact `TRUE` is put before the single contact.
fn sortable(net: &Net) -> Net {
    match net {
        Net::Wire | Net::Contact { .. } => net.clone(),
        Net::Series(list) => {
            let first = list.iter().take(1).map(sortable);
            Net::Series(first.chain(list.iter().skip(1).cloned()).collect())
        }
        Net::Parallel(list) => {
            let alone = |net: &Net| matches!(net, Net::Contact { .. });
            if list.iter().all(alone) {
                return net.clone();
            }
            let on = || Net::Contact { name: "TRUE".into(), negated: false };
            let begun =
                |net: &Net| if alone(net) { Net::Series(vec![on(), net.clone()]) } else { net.clone() };
            Net::Parallel(list.iter().map(begun).collect())
        }
    }
}

impl Drawing {
    fn id(&mut self) -> usize {
        self.next += 1;
        self.next
    }

    /// A new object with its number.
    fn object(&mut self, tag: &str) -> (usize, Element) {
        let id = self.id();
        (id, Element::new(tag).with("localId", id))
    }

    fn draw(&mut self, object: Element) {
        self.objects.push(object.on_one_line());
    }

    /// Notes the place of an output.
    fn out(&mut self, object: usize, formal: Option<&str>, place: (usize, usize)) {
        self.outs.insert((object, formal.map(str::to_owned)), place);
    }

    /// A line from an output to the input at `to`, with the points of both, the input first. Beremiz needs the last
    /// point.
    fn connection(&self, from: usize, formal: Option<&str>, to: (usize, usize)) -> Element {
        let mut link = Element::new("connection").with("refLocalId", from);
        if let Some(formal) = formal {
            link.set("formalParameter", formal);
        }
        let out = self.outs.get(&(from, formal.map(str::to_owned)));
        link.children([Some(&to), out].into_iter().flatten().map(|(x, y)| at(*x, *y)))
    }

    fn links(&self, from: &[usize], to: (usize, usize)) -> Vec<Element> {
        from.iter().map(|id| self.connection(*id, None, to)).collect()
    }

    /// One rung from `y` on; where it ends.
    fn rung(&mut self, r: &Rung, mut y: usize) -> usize {
        for note in [&r.title, &r.note].into_iter().filter(|n| !n.is_empty()) {
            let comment = sized(self.object("comment").1, 16, (8 * note.chars().count()).max(64));
            self.draw(comment.child(at(16, y)).child(Element::new("content").child(paragraph(note))));
            y += 24;
        }
        let net = &sortable(&r.net);
        let (columns, rows) = size(net);
        let high = rows * HIGH;
        let (rail, left) = self.object("leftPowerRail");
        let out = point_out(8, 16).with("formalParameter", "");
        self.draw(sized(left, high, 8).child(at(16, y)).child(out));
        self.out(rail, None, (24, y + 16));
        let ends = self.net(net, &[rail], 56, y);
        let x = 56 + columns * WIDE;
        let (last, tall) = match &r.end {
            End::Coil(name, coil) => (self.coil(name, *coil, &ends, x, y), HIGH),
            End::Block(block) => self.block(block, &ends, x, y),
        };
        let right = sized(self.object("rightPowerRail").1, high, 8);
        let formal = match &r.end {
            End::Block(block) if block.behind.is_none() => Some("ENO"),
            End::Coil(..) | End::Block(_) => None,
        };
        let place = (x + 3 * WIDE, y);
        let from = self.connection(last, formal, (place.0, y + 16));
        self.draw(right.child(at(place.0, y)).child(point_in(16, [from])));
        y + high.max(tall)
    }

    /// A network from some ends on; its own ends.
    fn net(&mut self, net: &Net, from: &[usize], x: usize, y: usize) -> Vec<usize> {
        match net {
            Net::Wire => from.to_vec(),
            Net::Contact { name, negated } => {
                let (id, contact) = self.object("contact");
                let contact = sized(contact.with("negated", negated), 16, 24).child(at(x, y));
                let ports = [point_in(8, self.links(from, (x, y + 8))), point_out(24, 8)];
                self.draw(contact.children(ports).child(Element::with_text("variable", name)));
                self.out(id, None, (x + 24, y + 8));
                vec![id]
            }
            Net::Series(list) => {
                let (mut ends, mut x) = (from.to_vec(), x);
                for part in list {
                    ends = self.net(part, &ends, x, y);
                    x += size(part).0 * WIDE;
                }
                ends
            }
            Net::Parallel(list) => {
                let (mut ends, mut y) = (Vec::new(), y);
                for part in list {
                    for end in self.net(part, from, x, y) {
                        if !ends.contains(&end) {
                            ends.push(end);
                        }
                    }
                    y += size(part).1 * HIGH;
                }
                ends
            }
        }
    }

    fn coil(&mut self, name: &str, coil: Coil, from: &[usize], x: usize, y: usize) -> usize {
        let links = self.links(from, (x, y + 8));
        self.coil_behind(name, coil, links, x, y)
    }

    fn coil_behind(&mut self, name: &str, coil: Coil, links: Vec<Element>, x: usize, y: usize) -> usize {
        let (id, element) = self.object("coil");
        let mut element = element.with("negated", false);
        match coil {
            Coil::Plain => {}
            Coil::Set => element.set("storage", "set"),
            Coil::Reset => element.set("storage", "reset"),
        }
        let ports = [point_in(8, links), point_out(24, 8)];
        self.out(id, None, (x + 24, y + 8));
        let element = sized(element, 16, 24).child(at(x, y)).children(ports);
        self.draw(element.child(Element::with_text("variable", name)));
        id
    }

    /// A block with its inputs and output; the number of the last element and the height.
    fn block(&mut self, b: &Block, from: &[usize], x: usize, y: usize) -> (usize, usize) {
        // The block stands behind the column of its operands.
        let left = x + WIDE;
        let links = self.links(from, (left, y + 8));
        let mut inputs = Element::new("inputVariables").child(pin("EN", point_in(8, links)));
        for (i, (formal, operand)) in b.inputs.iter().enumerate() {
            let (id, value) = self.object("inVariable");
            let down = 24 * (i + 1);
            let value = sized(value, 16, 96).child(at(x, y + down)).child(point_out(96, 8));
            self.draw(value.child(Element::with_text("expression", operand)));
            self.out(id, None, (x + 96, y + down + 8));
            let link = self.connection(id, None, (left, y + down + 8));
            inputs.push(pin(formal, point_in(down + 8, [link])));
        }
        let (id, block) = self.object("block");
        let mut block = block.with("typeName", &b.ty);
        if let Some(name) = &b.instance {
            block.set("instanceName", name);
        }
        let high = 24 * (b.inputs.len() + 1) + 8;
        let mut outputs = Element::new("outputVariables").child(pin("ENO", point_out(96, 8)));
        outputs.extend(b.output.iter().map(|(formal, _)| pin(formal, point_out(96, 32))));
        outputs.extend(b.behind.iter().map(|(formal, _)| pin(formal, point_out(96, 32))));
        let ports = [inputs, Element::new("inOutVariables"), outputs];
        self.draw(sized(block, high, 96).child(at(left, y)).children(ports));
        self.out(id, Some("ENO"), (left + 96, y + 8));
        if let Some((formal, to)) = &b.output {
            self.out(id, Some(formal), (left + 96, y + 32));
            let out = sized(self.object("outVariable").1, 16, 96).child(at(left + WIDE, y + 24));
            let from = self.connection(id, Some(formal), (left + WIDE, y + 32));
            self.draw(out.child(point_in(8, [from])).child(Element::with_text("expression", to)));
        }
        if let Some((formal, memory)) = &b.behind {
            self.out(id, Some(formal), (left + 96, y + 32));
            let link = self.connection(id, Some(formal), (left + WIDE, y + 32));
            return (self.coil_behind(memory, Coil::Plain, vec![link], left + WIDE, y + 24), high);
        }
        (id, high)
    }
}

fn sized(element: Element, high: usize, wide: usize) -> Element {
    element.with("height", high).with("width", wide)
}

fn at(x: usize, y: usize) -> Element {
    Element::new("position").with("x", x).with("y", y)
}

/// A pin of a block.
fn pin(formal: &str, point: Element) -> Element {
    Element::new("variable").with("formalParameter", formal).child(point)
}

/// An input at the left side, with what leads to it.
fn point_in(y: usize, from: impl IntoIterator<Item = Element>) -> Element {
    let place = Element::new("relPosition").with("x", 0).with("y", y);
    Element::new("connectionPointIn").child(place).children(from)
}

fn point_out(x: usize, y: usize) -> Element {
    Element::new("connectionPointOut").child(Element::new("relPosition").with("x", x).with("y", y))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lone_contact_beside_a_series_at_the_rail_has_a_contact_before_it() {
        let c = |name: &str| Net::Contact { name: name.into(), negated: false };
        let series = |list: &[Net]| Net::Series(list.to_vec());
        let parallel = |list: &[Net]| Net::Parallel(list.to_vec());
        let mixed = parallel(&[c("a"), series(&[c("b"), c("c")])]);
        let plain = [
            c("a"),
            series(&[c("a"), c("b")]),
            parallel(&[c("a"), c("b")]),
            parallel(&[series(&[c("a"), c("b")]), series(&[c("c"), c("d")])]),
            // The rail is not where these two stand side by side.
            series(&[c("d"), mixed.clone()]),
        ];
        for net in plain {
            assert_eq!(sortable(&net), net);
        }
        let begun = parallel(&[series(&[c("TRUE"), c("a")]), series(&[c("b"), c("c")])]);
        assert_eq!(sortable(&mixed), begun);
        assert_eq!(sortable(&series(&[mixed, c("d")])), series(&[begun, c("d")]));
    }
}
