//! Charts for one thing each, beside the engine, and what is known of their systems by count.

use g7_engine::{Arith, FaultKind};
use g7_equations::{Class, Equations, Expr, Machine, Memory, MemoryId, Section, Stmt, Value as Held, What};
use g7_model::Type;

use super::{Count, asked, parsed, side_by_side};
use crate::model::Model;
use crate::sat::{Signal, System, evaluate};
use crate::system::exec::Exec;
use crate::system::value::Value;
use crate::system::word::Word;
use crate::system::{Observed, system, system_until};

/// Compares a chart with the engine, observed in both ways.
pub(super) fn same(text: &str, scans: usize) -> Count {
    let asked = asked(&parsed(text), None).unwrap_or_else(|| panic!("{text}"));
    let mut count = Count::default();
    for observed in [Observed::All, Observed::Asked] {
        for seed in 1..3 {
            match side_by_side(&asked, observed, seed, scans) {
                Ok(done) => count.add(done),
                Err(why) => panic!("{observed:?}: {why}\n{text}"),
            }
        }
    }
    count
}

/// The number of latches of a chart's system.
fn latches(text: &str) -> usize {
    let asked = asked(&parsed(text), None).unwrap_or_else(|| panic!("{text}"));
    let model = Model::new(&asked.compiled, asked.assume.clone());
    system(&model, &asked.questions, Observed::Asked).system.latches.len()
}

/// A caller whose time is over gets no system; one with time gets it whole.
#[test]
fn a_system_is_given_up() {
    let steps: String = (1..300).map(|n| format!("  step {n}\n  {} -> {n} when a\n", n - 1)).collect();
    let asked = asked(&parsed(&format!("input a : BOOL\nchart C {{\n  initial step 0\n{steps}}}\n")), None);
    let asked = asked.unwrap_or_else(|| panic!("{steps}"));
    let model = Model::new(&asked.compiled, asked.assume.clone());
    let until = |stop| system_until(&model, &asked.questions, Observed::Asked, stop);
    assert!(until(&|| true).is_none());
    assert!(until(&|| false).is_some());
}

/// Sums, differences, quotients of each type, with what does not fit and division by 0.
#[test]
fn integers_of_each_type() {
    for ty in ["SINT", "INT", "DINT", "LINT", "USINT", "UINT", "UDINT", "ULINT"] {
        for op in ["+", "-", "*", "/", "mod"] {
            let wide = ty.ends_with("LINT") && ["*", "/", "mod"].contains(&op);
            let text = format!(
                "profile iec61131\ninput a, b : {ty}\nvar x : {ty}\nvar n : BOOL\nchart G {{ initial step 1 {{ each scan: {{ \
                 x := a {op} b; n := x > a or x <= b or a = b or a <> 7; x := MIN(MAX(x, b), a); }} }} }}\n"
            );
            let done = same(&text, 20);
            assert!(wide || done.pairs > 2000 && done.limited == 0, "{text}{done:?}");
        }
    }
}

#[test]
fn conversions_and_functions() {
    let types = ["SINT", "INT", "DINT", "LINT", "USINT", "UINT", "UDINT", "ULINT"];
    for from in types {
        for to in types.into_iter().filter(|to| *to != from) {
            let text = format!(
                "profile iec61131\ninput a : {from}\nvar x : {to}\nchart G {{ initial step 1 {{ each scan: \
                 x := {from}_TO_{to}(a) }} }}\n"
            );
            assert_eq!(same(&text, 8).limited, 0, "{text}");
        }
        let text = format!(
            "profile iec61131\ninput a, b, c : {from}\nvar x, y, z : {from}\nchart G {{ initial step 1 {{ each scan: {{ \
             x := LIMIT(a, b, c); y := SEL(a > b, b, c); z := MUX(SEL(b > c, 2, 0), a, b, c); }} }} }}\n"
        );
        assert_eq!(same(&text, 8).limited, 0, "{text}");
    }
}

/// Comparisons of floating-point numbers are those of IEEE 754; a sum has a limit with its place.
#[test]
fn floating_point() {
    let text = "profile iec61131\ninput a, b : REAL\nvar x : REAL\nvar n : INT\nchart G { initial step 1 { each scan: { \
                x := -a; IF a < b THEN n := 1; ELSIF a = b THEN n := 2; ELSIF a >= 0.0 THEN n := 3; ELSE n := 4; END_IF \
                IF x < b and not (x <= -1.5) THEN n := n + 10; END_IF x := MAX(ABS(x), b); } } }\n";
    let done = same(text, 20);
    assert!(done.limited == 0 && done.pairs > 2000, "{done:?}");
    let sum = "profile iec61131\ninput a : REAL\nvar x : REAL\noutput q : BOOL\nchart G { initial step 1 step 2 { N q } \
               1 -> 2 when a + 1.5 > 3.0 2 -> 1 when a < 1.0 }\nprove never X1 and X2\n";
    let asked = asked(&parsed(sum), None).expect("a chart");
    let model = Model::new(&asked.compiled, Vec::new());
    let t = system(&model, &asked.questions, Observed::Asked);
    let last = t.asked.last().and_then(|a| a.as_ref().ok()).expect("it is asked");
    let limits = t.limits(&[last.bad]);
    assert_eq!(limits.len(), 1, "{limits:?}");
    assert!(limits[0].part == crate::reason::Part::Floating && limits[0].at.start > 0, "{limits:?}");
}

/// A timer of any length takes the bits of its periods, and nothing beyond its length.
#[test]
fn timers_have_few_bits() {
    let chart = |time: &str| {
        format!(
            "profile iec61131\nscan 10ms\ninput a : BOOL\noutput q : BOOL\nchart G {{ initial step 1 step 2 {{ N q }} \
             1 -> 2 when a 2 -> 1 when X2.t > {time} and a }}\n"
        )
    };
    let count = |time: &str| latches(&chart(time)) as i64;
    // 1 h is 360000 periods; at most one more is told apart.
    assert_eq!(count("1h") - count("10ms"), 19 - 2);
    assert_eq!(count("2d") - count("1h"), 25 - 19);
    assert_eq!(count("15ms"), count("10ms"), "beyond 10 and 15 ms is 20 ms");
    let delay = |time: &str| chart(time).replace(&format!("X2.t > {time}"), &format!("{time}/X2"));
    assert_eq!(latches(&delay("1h")) as i64 - latches(&delay("10ms")) as i64, 19 - 1);
    let block = "profile iec61131\nscan 10ms\ninput a : BOOL\noutput q : BOOL\nfb t : TON\npost { t(IN := a, PT := 1h); q := t.Q; }\n\
                 chart G { initial step 1 }\n";
    if g7_syntax::parse(block, Default::default()).1.is_empty() {
        assert!(latches(block) < 60, "{}", latches(block));
    }
}

/// Times around the period, to the scan: at, below and above a multiple of it.
#[test]
fn times_are_seen_at_the_scan_at_which_they_are_over() {
    for time in ["10ms", "20ms", "25ms", "29ms", "30ms", "31ms", "1ns", "70ms"] {
        for profile in ["iec60848", "iec61131", "pl7", "unity", "jgrafchart"] {
            for wait in [
                "TIME/X2",
                "X2.t >= TIME",
                "X2.t > TIME",
                "X2.t = TIME",
                "not (X2.t < TIME) and a",
                "TIME/b/TIME",
            ] {
                let wait = wait.replace("TIME", time);
                let text = format!(
                    "profile {profile}\nscan 10ms\ninput a, b : BOOL\noutput q, r, s : BOOL\nchart G {{ initial step 1 \
                     step 2 {{ N q }} 1 -> 2 when a 2 -> 1 when {wait} }}\n\
                     prove after X2 within {time} expect X1\nprove after a and not b within {time} expect b\n"
                );
                let (document, problems) = g7_syntax::parse(&text, Default::default());
                if problems.is_empty() && asked(&document, None).is_some() {
                    same(&text, 24);
                }
            }
        }
    }
}

/// The time of a step that was left is still read, where the profile keeps it.
#[test]
fn times_of_steps_that_were_left() {
    for time in ["10ms", "20ms", "29ms", "40ms"] {
        for profile in ["iec60848", "iec61131", "pl7", "unity", "jgrafchart"] {
            for compared in ["X2.t >= TIME", "X2.t > TIME", "X2.t = TIME", "X2.t <> TIME"] {
                let compared = compared.replace("TIME", time);
                let text = format!(
                    "profile {profile}\nscan 10ms\ninput a, b, c : BOOL\noutput q : BOOL\nchart G {{ initial step 1 \
                     step 2 step 3 {{ N q }} 1 -> 2 when a and not b 2 -> 1 when b and not a \
                     1 -> 3 when a and b and {compared} 3 -> 1 when not a and not b and c }}\n"
                );
                let (document, problems) = g7_syntax::parse(&text, Default::default());
                if problems.is_empty() && asked(&document, None).is_some() {
                    same(&text, 24);
                }
            }
        }
    }
}

/// Delays of qualifiers, with times around multiples of the period.
#[test]
fn qualifiers_with_times() {
    let mut compared = 0;
    for profile in ["iec60848", "iec61131", "unity"] {
        for qualifier in ["L", "D", "SD", "DS", "SL"] {
            for time in ["10ms", "35ms", "60ms"] {
                let text = format!(
                    "profile {profile}\nscan 10ms\ninput a, b : BOOL\noutput q : BOOL\nchart G {{ initial step 1 \
                     step 2 {{ {qualifier}({time}) q }} step 3 {{ R q }} 1 -> 2 when a 2 -> 3 when b 3 -> 1 when not a }}\n"
                );
                let text = text.replace(&format!("{qualifier}({time})"), &format!("{qualifier} {time}"));
                let (document, problems) = g7_syntax::parse(&text, Default::default());
                if problems.is_empty() && asked(&document, None).is_some() {
                    compared += same(&text, 30).pairs;
                }
            }
        }
    }
    println!("{compared} pairs");
}

/// Loops whose end is known are made to their end; of others a bound is told.
#[test]
fn loops() {
    let sum = "profile iec61131\ninput a : BOOL\nvar i, s : INT\nchart G { initial step 1 { each scan: { s := 0; \
               FOR i := 1 TO 60 DO s := s + i; IF a and i = 50 THEN EXIT; END_IF END_FOR } } }\n";
    let done = same(sum, 10);
    assert!(done.uncovered == 0 && done.pairs > 2000, "{done:?}");
    let known = sum.replace("IF a and i = 50 THEN EXIT; END_IF", "").replace("60", "300");
    assert!(same(&known, 3).uncovered == 0, "its end is known");
    let open = "profile iec61131\ninput n : USINT\nvar i, s : INT\nchart G { initial step 1 { each scan: { s := 0; i := 0; \
                WHILE i < n DO i := i + 1; s := s + i; END_WHILE } } }\n";
    let (document, problems) = g7_syntax::parse(open, Default::default());
    if problems.is_empty() && asked(&document, None).is_some() {
        let done = same(open, 10);
        assert!(done.uncovered > 100 && done.pairs > 100, "{done:?}");
    }
}

/// A search that comes back is the fault; a long one that ends is followed to its end.
#[test]
fn searches_for_stability() {
    let round = "input a, b, c : BOOL\nchart G { initial step 1 step 2 step 3 1 -> 2 when a 2 -> 3 when b 3 -> 1 when c }\n";
    let done = same(round, 10);
    assert!(done.uncovered == 0 && done.faults > 100, "{done:?}");
    let chain = "input a : BOOL\nvar n : INT\nchart G { initial step 1 step 2 { P1 n := n + 1 } step 3 { P1 n := n + 1 } step 4 step 5 \
                 1 -> 2 when a 2 -> 3 when a 3 -> 4 when a 4 -> 5 when a 5 -> 1 when not a }\nprove never n = 3\n";
    let done = same(chain, 20);
    assert!(done.uncovered == 0 && done.faults == 0, "{done:?}");
    // Forty passes end, but are more than are unrolled; the chart beside it rests.
    let steps: String = (2..=41).map(|i| format!(" step {i}")).collect();
    let ways: String = (1..=40).map(|i| format!(" {i} -> {} when a", i + 1)).collect();
    let long = format!(
        "input a, b : BOOL\nchart G {{ initial step 1{steps}{ways} 41 -> 1 when not a }}\n\
         chart H {{ initial step 1 step 2 1 -> 2 when b 2 -> 1 when not b }}\n"
    );
    let done = same(&long, 6);
    assert!(done.uncovered > 100 && done.faults == 0, "{done:?}");
    // It counts to its overflow, in more passes than are unrolled.
    let counts = "input a : BOOL\nvar n : INT\nchart G { initial step 1 step 2 { P1 n := n + 1 } 1 -> 2 when a 2 -> 1 when a }\n";
    let done = same(counts, 5);
    assert!(done.uncovered > 100, "{done:?}");
}

/// No scan follows a fault, and the first fault is the one that counts.
#[test]
fn a_fault_ends_the_run() {
    let text = "profile iec61131\ninput a, b : BOOL\nvar n, m : INT := 2\noutput q : BOOL safe TRUE\nchart G { initial step 1 { \
                each scan: { IF a THEN m := 10 / n; n := n - 1; END_IF IF b THEN n := n * 20000; END_IF q := a; } } step 2 1 -> 2 when n < 0 and a }\n\
                prove always n > 0\nprove reachable m = 10\n";
    let asked = asked(&parsed(text), None).expect("a chart");
    let model = Model::new(&asked.compiled, Vec::new());
    let t = system(&model, &asked.questions, Observed::All);
    let kinds: Vec<FaultKind> = t.faults.iter().map(|f| f.0).collect();
    assert!(kinds.contains(&FaultKind::DivisionByZero) && kinds.contains(&FaultKind::Overflow), "{kinds:?}");
    assert!(same(text, 30).faults > 50);
}

/// An assumption holds at each scan; inputs that break it are not tried.
#[test]
fn assumptions() {
    let text = "profile iec61131\ninput a, b : BOOL\nvar n : INT\noutput q : BOOL\nchart G { initial step 1 step 2 { N q } 1 -> 2 when a 2 -> 1 when b }\n\
                assume not (a and b)\nassume b or not X2 or a\nprove never a and b\nprove at most 1 of (X1, X2, q)\n";
    let done = same(text, 40);
    assert!(done.forbidden > 100 && done.pairs > 500, "{done:?}");
    // The output of the initial step is on before the first evolution.
    let first = "profile iec61131\ninput a, b : BOOL\noutput q : BOOL\nchart G { initial step 1 { N q } step 2 1 -> 2 when a 2 -> 1 when b }\n\
                 assume a or not q\n";
    assert!(same(first, 10).forbidden > 100);
}

/// All claims about scans one after the other, on charts in which each of them is hit.
#[test]
fn monitors() {
    let base = "profile iec61131\nscan 10ms\ninput a, b : BOOL\noutput q : BOOL\nvar n : INT := 1\nchart G { initial step 1 step 2 { N q } \
                step 3 1 -> 2 when a 2 -> 3 when b 3 -> 1 when not a }\n";
    let mut text = base.to_owned();
    for (x, y, z) in
        [("X1", "X2", "q"), ("a", "b", "X3"), ("q", "X1", "b"), ("a and X2", "a and X3", "n / n = 1 and b")]
    {
        text += &format!(
            "prove always {x} or {y}\nprove never {x} and {z}\nprove reachable {y} and {z}\nprove at most 1 of ({x}, {y}, {z})\n\
             prove at most 2 of ({x}, {y}, {z})\nprove after {x} until {y} expect {z}\nprove between {x} and {y} never {z}\n\
             prove after {x} within 0ms expect {y}\nprove after {x} within 10ms expect {y}\nprove after {x} within 19ms expect {y}\n\
             prove after {x} within 45ms expect {z}\n"
        );
    }
    let done = same(&text, 60);
    assert!(done.shown > 10_000, "{done:?}");
}

/// Tables, which only plants have, beside the interpreter of the equations.
#[test]
fn tables() {
    let memory = |n, ty, init: &[u64]| Memory {
        what: What::Temporary(n),
        class: Class::Kept,
        ty,
        elements: init.len() as u32,
        init: init.into(),
        retain: false,
    };
    let [table, index, read, sum] = [0, 1, 2, 3].map(MemoryId);
    let element = |e| Expr::Element(table, Box::new(e));
    let body = vec![
        Stmt::Set(read, element(Expr::Read(index))),
        Stmt::SetElement(table, Expr::Read(index), Expr::Const(Type::Int, 9)),
        Stmt::Set(sum, element(Expr::long(1)).arith(Arith::Add, Type::Int, element(Expr::Read(index)))),
    ];
    let e = Equations {
        memories: vec![
            memory(1, Type::Int, &[5, 6, 7]),
            memory(2, Type::Lint, &[0]),
            memory(3, Type::Int, &[0]),
            memory(4, Type::Int, &[0]),
        ],
        begin: vec![Section { title: "", body }],
        ..Equations::default()
    };
    let asked = asked(&parsed("chart G { initial step 1 }\n"), None).expect("a chart");
    let model = Model::new(&asked.compiled, Vec::new());
    let cells =
        e.memories.iter().map(|m| m.init.iter().map(|w| Value::of_word(m.ty, *w)).collect()).collect();
    let mut x = Exec::new(&e, &model, cells, System::default());
    let bits = vec![x.system.input(), x.system.input(), Signal::FALSE];
    x.put(index, vec![Value::Whole(Word::of(bits, 1, 0, 3))]);
    e.begin.iter().for_each(|s| x.all(&s.body));
    for k in 0..4u64 {
        let mut machine = Machine::new(e.clone());
        machine.set(index, &[k]);
        machine.scan(0).expect("no fault");
        let values = evaluate(&x.system.graph, &[], &[k & 1, k >> 1]);
        for m in [table, read, sum] {
            let mine = x.cell(m).iter().map(|v| v.whole().read(|s| values.bit(s)) as u64).collect();
            assert_eq!(Some(&Held::Words(mine)), machine.value(m), "{m:?} at {k}");
        }
    }
}
