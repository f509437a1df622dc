//! Rungs as PLCopen XML (TC6 2.01): one function block with a Ladder body.

use std::fmt::Write;

use super::form::{Class, Declared};
use super::ladder::{Block, Coil, End, Ladder, Net, Rung};
use super::st::expression;

const HEAD: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<project xmlns="http://www.plcopen.org/xml/tc6_0201" xmlns:xhtml="http://www.w3.org/1999/xhtml">
  <fileHeader companyName="G7" productName="G7" productVersion="1" creationDateTime="1970-01-01T00:00:00"/>
"#;

const SCALING: &str = "<scaling x=\"8\" y=\"8\"/>";

/// The whole project.
pub(crate) fn print(name: &str, l: &Ladder) -> String {
    let mut x = Writer { out: HEAD.to_owned(), next: 0 };
    let _ = writeln!(
        x.out,
        "  <contentHeader name=\"{}\">\n    <coordinateInfo>\n      <fbd>{SCALING}</fbd>\n      <ld>{SCALING}</ld>\n      \
         <sfc>{SCALING}</sfc>\n    </coordinateInfo>\n  </contentHeader>\n  <types>\n    <dataTypes/>\n    <pous>\n      \
         <pou name=\"{0}\" pouType=\"functionBlock\">",
        escape(name)
    );
    x.interface(&l.variables);
    x.out += "        <body>\n          <LD>\n";
    let mut y = 16;
    for r in &l.rungs {
        y = x.rung(r, y) + 32;
    }
    x.out += "          </LD>\n        </body>\n      </pou>\n    </pous>\n  </types>\n  <instances>\n    <configurations/>\n  </instances>\n</project>\n";
    x.out
}

fn escape(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

/// Units wide and high of a contact or coil with the space round it.
const WIDE: usize = 128;
const HIGH: usize = 48;

struct Writer {
    out: String,
    next: usize,
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

impl Writer {
    fn id(&mut self) -> usize {
        self.next += 1;
        self.next
    }

    fn line(&mut self, text: &str) {
        let _ = writeln!(self.out, "            {text}");
    }

    fn interface(&mut self, variables: &[Declared]) {
        self.out += "        <interface>\n";
        for (class, tag) in [
            (Class::Input, "inputVars"),
            (Class::Output, "outputVars"),
            (Class::Retain, "localVars retain=\"true\""),
            (Class::Internal, "localVars"),
        ] {
            let own: Vec<&Declared> = variables.iter().filter(|v| v.class == class).collect();
            if own.is_empty() {
                continue;
            }
            let _ = writeln!(self.out, "          <{tag}>");
            for v in own {
                self.variable(v);
            }
            let _ = writeln!(self.out, "          </{}>", tag.split(' ').next().unwrap_or(tag));
        }
        self.out += "        </interface>\n";
    }

    fn variable(&mut self, v: &Declared) {
        let standard = ["TON", "TOF", "TP", "CTU", "CTD", "CTUD", "R_TRIG", "F_TRIG", "SR", "RS"];
        let ty = if standard.contains(&v.ty.as_str()) {
            format!("<derived name=\"{}\"/>", v.ty)
        } else {
            format!("<{}/>", v.ty)
        };
        let ty = if v.elements == 1 {
            ty
        } else {
            let last = v.elements - 1;
            format!("<array><dimension lower=\"0\" upper=\"{last}\"/><baseType>{ty}</baseType></array>")
        };
        let simple = |text: &str| format!("<simpleValue value=\"{}\"/>", escape(text));
        let init = match v.init.as_slice() {
            [] => String::new(),
            [one] => format!("<initialValue>{}</initialValue>", simple(&expression(one))),
            many => {
                let values: String =
                    many.iter().map(|e| format!("<value>{}</value>", simple(&expression(e)))).collect();
                format!("<initialValue><arrayValue>{values}</arrayValue></initialValue>")
            }
        };
        let note = if v.note.is_empty() {
            String::new()
        } else {
            format!("<documentation><xhtml:p>{}</xhtml:p></documentation>", escape(&v.note))
        };
        let _ = writeln!(
            self.out,
            "            <variable name=\"{}\"><type>{ty}</type>{init}{note}</variable>",
            escape(&v.name)
        );
    }

    /// One rung from `y` on; where it ends.
    fn rung(&mut self, r: &Rung, mut y: usize) -> usize {
        for note in [&r.title, &r.note].into_iter().filter(|n| !n.is_empty()) {
            let id = self.id();
            self.line(&format!(
                "<comment localId=\"{id}\" height=\"16\" width=\"{}\"><position x=\"16\" y=\"{y}\"/><content>\
                 <xhtml:p>{}</xhtml:p></content></comment>",
                (8 * note.chars().count()).max(64),
                escape(note)
            ));
            y += 24;
        }
        let (columns, rows) = size(&r.net);
        let rail = self.id();
        let high = rows * HIGH;
        self.line(&format!(
            "<leftPowerRail localId=\"{rail}\" height=\"{high}\" width=\"8\"><position x=\"16\" y=\"{y}\"/>\
             <connectionPointOut formalParameter=\"\"><relPosition x=\"8\" y=\"16\"/></connectionPointOut></leftPowerRail>"
        ));
        let ends = self.net(&r.net, &[rail], 56, y);
        let x = 56 + columns * WIDE;
        let (last, tall) = match &r.end {
            End::Coil(name, coil) => (self.coil(name, *coil, &ends, x, y), HIGH),
            End::Block(block) => self.block(block, &ends, x, y),
            End::Return => (self.leave(&ends, x, y), HIGH),
        };
        if r.end == End::Return {
            return y + high.max(tall);
        }
        let right = self.id();
        let from = match &r.end {
            End::Coil(..) | End::Return => format!("<connection refLocalId=\"{last}\"/>"),
            End::Block(_) => format!("<connection refLocalId=\"{last}\" formalParameter=\"ENO\"/>"),
        };
        self.line(&format!(
            "<rightPowerRail localId=\"{right}\" height=\"{high}\" width=\"8\"><position x=\"{}\" y=\"{y}\"/>\
             <connectionPointIn><relPosition x=\"0\" y=\"16\"/>{from}</connectionPointIn></rightPowerRail>",
            x + 3 * WIDE
        ));
        y + high.max(tall)
    }

    /// A network from some ends on; its own ends.
    fn net(&mut self, net: &Net, from: &[usize], x: usize, y: usize) -> Vec<usize> {
        match net {
            Net::Wire => from.to_vec(),
            Net::Contact { name, negated } => {
                let id = self.id();
                let links = links(from);
                self.line(&format!(
                    "<contact localId=\"{id}\" negated=\"{negated}\" height=\"16\" width=\"24\"><position x=\"{x}\" \
                     y=\"{y}\"/><connectionPointIn><relPosition x=\"0\" y=\"8\"/>{links}</connectionPointIn>\
                     <connectionPointOut><relPosition x=\"24\" y=\"8\"/></connectionPointOut>\
                     <variable>{}</variable></contact>",
                    escape(name)
                ));
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

    fn leave(&mut self, from: &[usize], x: usize, y: usize) -> usize {
        let (id, links) = (self.id(), links(from));
        self.line(&format!(
            "<return localId=\"{id}\" height=\"16\" width=\"48\"><position x=\"{x}\" y=\"{y}\"/>\
             <connectionPointIn><relPosition x=\"0\" y=\"8\"/>{links}</connectionPointIn></return>"
        ));
        id
    }

    fn coil(&mut self, name: &str, coil: Coil, from: &[usize], x: usize, y: usize) -> usize {
        let id = self.id();
        let storage = match coil {
            Coil::Plain => "",
            Coil::Set => " storage=\"set\"",
            Coil::Reset => " storage=\"reset\"",
        };
        let links = links(from);
        self.line(&format!(
            "<coil localId=\"{id}\" negated=\"false\"{storage} height=\"16\" width=\"24\"><position x=\"{x}\" y=\"{y}\"/>\
             <connectionPointIn><relPosition x=\"0\" y=\"8\"/>{links}</connectionPointIn>\
             <connectionPointOut><relPosition x=\"24\" y=\"8\"/></connectionPointOut>\
             <variable>{}</variable></coil>",
            escape(name)
        ));
        id
    }

    /// A block with its inputs and output; its number and height.
    fn block(&mut self, b: &Block, from: &[usize], x: usize, y: usize) -> (usize, usize) {
        let mut inputs = String::new();
        for (i, (formal, operand)) in b.inputs.iter().enumerate() {
            let id = self.id();
            let at = y + 24 * (i + 1);
            self.line(&format!(
                "<inVariable localId=\"{id}\" height=\"16\" width=\"96\"><position x=\"{x}\" y=\"{at}\"/>\
                 <connectionPointOut><relPosition x=\"96\" y=\"8\"/></connectionPointOut>\
                 <expression>{}</expression></inVariable>",
                escape(operand)
            ));
            let _ = write!(
                inputs,
                "<variable formalParameter=\"{}\"><connectionPointIn><relPosition x=\"0\" y=\"{}\"/>\
                 <connection refLocalId=\"{id}\"/></connectionPointIn></variable>",
                escape(formal),
                24 * (i + 1) + 8
            );
        }
        let id = self.id();
        let high = 24 * (b.inputs.len() + 1) + 8;
        let instance =
            b.instance.as_ref().map_or(String::new(), |n| format!(" instanceName=\"{}\"", escape(n)));
        let output = b.output.as_ref().map_or(String::new(), |(formal, _)| {
            format!(
                "<variable formalParameter=\"{}\"><connectionPointOut><relPosition x=\"96\" y=\"32\"/>\
                 </connectionPointOut></variable>",
                escape(formal)
            )
        });
        let links = links(from);
        self.line(&format!(
            "<block localId=\"{id}\" typeName=\"{}\"{instance} height=\"{high}\" width=\"96\"><position x=\"{}\" y=\"{y}\"/>\
             <inputVariables><variable formalParameter=\"EN\"><connectionPointIn><relPosition x=\"0\" y=\"8\"/>{links}\
             </connectionPointIn></variable>{inputs}</inputVariables><inOutVariables/><outputVariables>\
             <variable formalParameter=\"ENO\"><connectionPointOut><relPosition x=\"96\" y=\"8\"/></connectionPointOut>\
             </variable>{output}</outputVariables></block>",
            escape(&b.ty),
            x + WIDE
        ));
        if let Some((formal, to)) = &b.output {
            let out = self.id();
            self.line(&format!(
                "<outVariable localId=\"{out}\" height=\"16\" width=\"96\"><position x=\"{}\" y=\"{}\"/>\
                 <connectionPointIn><relPosition x=\"0\" y=\"8\"/><connection refLocalId=\"{id}\" \
                 formalParameter=\"{}\"/></connectionPointIn><expression>{}</expression></outVariable>",
                x + 2 * WIDE,
                y + 24,
                escape(formal),
                escape(to)
            ));
        }
        (id, high)
    }
}

fn links(from: &[usize]) -> String {
    from.iter().map(|id| format!("<connection refLocalId=\"{id}\"/>")).collect()
}
