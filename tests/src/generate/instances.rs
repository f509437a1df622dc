//! A chart with parameters and its instances, at the end of some documents.

use super::rng::Rng;
use super::sight::Sight;

/// Adds a chart with parameters and its instances. `outside` has the names that are seen outside of all charts. The
/// random numbers come from a copy of the generator: the rest of the document does not depend on them.
pub(super) fn instances(rng: &Rng, outside: &Sight, out: &mut String) {
    let mut rng = rng.clone();
    rng.bits();
    if !rng.percent(20) {
        return;
    }
    let (go, back) = (outside.boolean(&mut rng, 2), outside.boolean(&mut rng, 1));
    let other = rng.one(["Many[1]", "Many[2]", "Many[k]", "Lone"]);
    // `Many[k]` is there for each value.
    let (most, of_lone) = (rng.between(1, 4), rng.between(1, 2));
    out.push_str("output lamp : ARRAY[0..3] OF BOOL\n");
    out.push_str(&format!(
        "chart Many(k : INT, most : INT) {{\n  var counted : INT\n  initial step Idle\n  step Busy {{\n    \
         N lamp[k]\n    P1 counted := counted + k\n  }}\n  step Done\n  Idle -> Busy when ({go}) and counted < most\n  \
         Busy -> Done when {other}.Busy.X or counted > k\n  Done -> Idle when ({back}) or {other}.counted > most\n}}\n\
         instance Many[1..2](most := {most})\ninstance Lone : Many({of_lone}, {most} + 1)\n"
    ));
}
