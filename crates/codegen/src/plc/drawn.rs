//! Rungs as a picture.

use g7_draw::{Element, Options, rungs_svg};

use super::ladder::{Block, Coil, End, Ladder, Net, Rung};

/// The whole ladder as SVG.
pub(crate) fn draw(name: &str, l: &Ladder) -> String {
    let rungs: Vec<g7_draw::Rung> = l.rungs.iter().map(rung).collect();
    rungs_svg(name, &rungs, &Options::default())
}

fn rung(r: &Rung) -> g7_draw::Rung {
    let mut elements = way(&r.net);
    elements.push(match &r.end {
        End::Coil(name, coil) => {
            let sign = match coil {
                Coil::Plain => "",
                Coil::Set => "S",
                Coil::Reset => "R",
            };
            Element::Coil { sign, text: name.clone() }
        }
        End::Block(b) => block(b),
    });
    g7_draw::Rung { title: r.title.clone(), note: r.note.clone(), label: String::new(), elements }
}

/// An element of a row.
fn way(net: &Net) -> Vec<Element> {
    match net {
        Net::Wire => Vec::new(),
        Net::Contact { name, negated } => {
            vec![Element::Contact { sign: if *negated { "/" } else { "" }, text: name.clone() }]
        }
        Net::Series(list) => list.iter().flat_map(way).collect(),
        Net::Parallel(list) => vec![Element::Branch(list.iter().map(way).collect())],
    }
}

fn block(b: &Block) -> Element {
    Element::Block {
        title: b.instance.as_ref().map_or_else(|| b.ty.clone(), |i| format!("{i}: {}", b.ty)),
        power: "EN".to_owned(),
        inputs: b.inputs.clone(),
        output: "ENO".to_owned(),
        outputs: b.output.iter().cloned().collect(),
    }
}
