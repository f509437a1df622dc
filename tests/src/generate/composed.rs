//! A function block of one's own with its instances, and a structure, at the end of some documents.

use super::rng::Rng;
use super::sight::Sight;

/// Adds types, variables of these and a chart that uses them. The random numbers come from a copy of the generator: the
/// rest of the document does not depend on them.
pub(super) fn composed(rng: &Rng, outside: &Sight, out: &mut String) {
    let mut rng = rng.clone();
    rng.bits();
    rng.bits();
    if !rng.percent(20) {
        return;
    }
    let (go, back) = (outside.boolean(&mut rng, 2), outside.boolean(&mut rng, 1));
    let block = outside.boolean(&mut rng, 1);
    let (by, limit, first) = (rng.between(1, 3), rng.between(2, 9), rng.between(0, 5));
    let pause = rng.between(1, 4) * 10;
    let call = rng.one(["held[turn](", "held[1](", "held[turn - 1]("]);
    let copy = rng.one([
        "kept[turn] := last",
        "last := kept[turn]",
        "kept[1] := kept[turn]",
        "kept[turn].seen[1] := last.seen[0]",
    ]);
    out.push_str(&format!(
        "struct Kept {{\n  n : INT := {first}\n  on : BOOL\n  seen : ARRAY[0..1] OF INT\n}}\n\
         function block Inner {{\n  input at : BOOL\n  output rises : INT\n  var edge : R_TRIG\n  body {{\n    edge(CLK := at)\n    \
         IF edge.Q THEN rises := rises + 1 END_IF\n  }}\n}}\n\
         function block Held {{\n  input at : BOOL\n  input more : INT := {by}\n  output long : BOOL\n  output sum : INT\n  \
         inout all : INT\n  input kept : Kept\n  var wait : TON\n  var inner : ARRAY[1..2] OF Inner\n  body {{\n    var k : INT\n    \
         wait(IN := at, PT := {pause}ms)\n    long := wait.Q\n    FOR k := 1 TO 2 DO\n      inner[k](at := at XOR k = 2)\n    END_FOR\n    \
         IF not at or sum > {limit} THEN RETURN END_IF\n    sum := sum + more + inner[1].rises - inner[2].rises\n    \
         all := (all + kept.n + kept.seen[1]) MOD 100\n  }}\n}}\n\
         var held : ARRAY[1..2] OF Held\nvar lone : Held := (more := {limit}, sum := 1)\n\
         var kept : ARRAY[0..2] OF Kept := [(on := TRUE), 2((n := 1, seen := [{by}]))]\nvar last : Kept\nvar total, turn : INT := 2\n\
         output glow : BOOL\noutput lasted : Kept\n"
    ));
    out.push_str(&format!(
        "chart Blocks {{\n  initial step Rest {{\n    each scan: {call}at := ({go}), all := total, kept := kept[1])\n    N lasted.on if held[2].long\n  }}\n  \
         step Work {{\n    each scan: {{\n      lone({block}, all := kept[2].n, sum => turn)\n      turn := turn MOD 2 + 1\n      {copy}\n      \
         lasted.n := kept[turn].n + held[turn].sum\n    }}\n    N glow if lone.long\n  }}\n  \
         Rest -> Work when (held[2].long or held[1].sum > {limit} or ({go})) and not ({back})\n  Work -> Rest when {back}\n}}\n"
    ));
}
