//! A function block with charts and its instances, at the end of some documents.

use super::rng::Rng;
use super::sight::Sight;

/// Adds a function block with two charts, and instances of it: in an array, in a structure, in a chart. The random
/// numbers come from a copy of the generator: the rest of the document does not depend on them.
pub(super) fn block_charts(rng: &Rng, outside: &Sight, out: &mut String) {
    let mut rng = rng.clone();
    for _ in 0..4 {
        rng.bits();
    }
    if !rng.percent(10) {
        return;
    }
    let (go, back) = (outside.boolean(&mut rng, 2), outside.boolean(&mut rng, 1));
    let (most, by) = (rng.between(1, 4), rng.between(1, 3));
    let call = rng.one(["twin[1](", "twin[both](", "place.twin("]);
    let other = rng.one(["twin[2].Swing", "place.twin.Swing", "twin[1].Swing"]);
    let body = rng.one(["", "  body {\n    left := left - 1\n    at := at and Swing.Rest.X\n  }\n"]);
    out.push_str(&format!(
        "function block Twin {{\n  input at : BOOL\n  output on : BOOL\n  var left : INT := {most}\n{body}}}\n\
         chart Swing of Twin {{\n  var own : INT\n  initial step Rest\n  step Run {{\n    N on\n    P1 own := own + {by}\n  }}\n  \
         Rest -> Run when at and own < 6\n  Run -> Rest when ({back}) or Count.Many.X\n}}\n\
         chart Count of Twin {{\n  var t : TON\n  initial step Few {{ each scan: t(IN := on, PT := 20ms) }}\n  step Many\n  \
         Few -> Many when t.Q or Swing.own > left\n  Many -> Few when not on and left > 0 or ({go})\n}}\n\
         struct Place {{\n  twin : Twin\n}}\n\
         var twin : ARRAY[1..2] OF Twin := [(left := {by})]\nvar place : Place\nvar both : INT := 1\noutput shine, glare : BOOL\n"
    ));
    out.push_str(&format!(
        "chart Twins {{\n  var lone : Twin\n  initial step Here {{\n    each scan: {call}at := ({go}))\n    N shine if {other}.Run.X\n  }}\n  \
         step There {{\n    each scan: {{\n      lone(at := {back}, on => glare)\n      twin[2](at := lone.Swing.Run.X or {back})\n      \
         both := 3 - both\n    }}\n  }}\n  \
         Here -> There when {other}.own > 1 or ({go})\n  There -> Here when lone.Count.Many.X or ({back})\n}}\n"
    ));
}
