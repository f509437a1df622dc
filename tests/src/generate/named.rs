//! An enumeration, types with bounds, and a chart with variables of them, at the end of some documents.

use super::rng::Rng;
use super::sight::Sight;

/// Adds types, variables of these and a chart that uses them. The random numbers come from a copy of the generator: the
/// rest of the document does not depend on them.
pub(super) fn named(rng: &Rng, outside: &Sight, out: &mut String) {
    let mut rng = rng.clone();
    rng.bits();
    if !rng.percent(20) {
        return;
    }
    let (go, back) = (outside.boolean(&mut rng, 2), outside.boolean(&mut rng, 1));
    let (by, limit) = (rng.between(1, 3), rng.between(4, 9));
    // `spin + by` is the fault `range` after some scans. With `SEL` alone, the chart comes to rest.
    let spin = match rng.between(0, 9) {
        0 => format!("spin + {by}"),
        1 => format!("(spin + {by}) MOD {}", limit + 1),
        2..=4 => format!("LIMIT(0, spin + SEL({go}, -1, {by}), {limit})"),
        _ => format!("SEL({go}, {by}, {limit})"),
    };
    let gear = rng.one([
        "SEL(high, Middle, Gear.High)",
        "gears[1 + spin MOD 2]",
        "MUX(spin MOD 3, Low, Middle, High)",
    ]);
    // `Spun := s + n` is the fault `range` after some scans, and `Spun(s + n, …)` at the call.
    let (spun, given) = match rng.between(0, 7) {
        0 => ("s + n".to_owned(), "Spun(n := 1, s := spin)".to_owned()),
        1 => ("s".to_owned(), format!("Spun(spin + {by}, 0)")),
        2..=4 => (format!("LIMIT(0, s + n, {limit})"), format!("Spun(spin, {by})")),
        _ => (format!("SEL(s > {by}, s, last)"), format!("Spun(LIMIT(0, turns[1] + {by}, {limit}), {by})")),
    };
    out.push_str(&format!(
        "type Gear : (Low, Middle := {by}, High) := Middle\ntype Turn : INT(0..{limit}) := {by}\n\
         type Turns : ARRAY[1..2] OF Turn\nvar gear : Gear\nvar gears : ARRAY[1..2] OF Gear := [High]\nvar spin : Turn\n\
         var turns : Turns\nvar rows : ARRAY[0..1] OF Turns\noutput high : BOOL\noutput shown : Gear\n"
    ));
    out.push_str(&format!(
        "function Shift(g : Gear, up : BOOL, plus : Turn) : Gear {{\n  var other : Gear := High\n  \
         IF up and plus > 0 THEN Shift := other ELSIF g <> Low THEN Shift := g END_IF\n}}\n\
         function Spun(s : Turn, n : INT) : Turn {{\n  var last : Turn\n  IF n > 0 THEN Spun := {spun} END_IF\n}}\n"
    ));
    out.push_str(&format!(
        "chart Gears {{\n  initial step Slow {{\n    each scan: {{\n      spin := {spin}\n      CASE gear OF\n        \
         Low: gear := High\n        Gear.Middle, High: gear := {gear}\n      END_CASE\n      turns[1] := spin\n      \
         gears[2] := gear\n    }}\n  }}\n  step Fast {{\n    N high if gear = High or gears[1] <> gear\n    each scan: {{\n      \
         shown := gear\n      turns[2] := {given}\n      gears[1] := Shift(gears[2], {back}, turns[2])\n      turns[2] := spin * Gear_TO_INT(gear) MOD {limit}\n      rows[spin MOD 2, 1] := turns[2]\n    \
         }}\n  }}\n  Slow -> Fast when gear <> Low and ({go}) and not ({back} or rows[1, 1] > 2)\n  Fast -> Slow when {back} or rows[1, 1] > 2\n}}\n"
    ));
}
