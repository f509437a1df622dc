//! Expressions, written out as trees: `(or a (and b c))`.

use g7_model::{Arg, BinaryOp, Expr, ExprKind, FileId, Literal, UnaryOp};

/// The tree of an expression, in a notation of this test's own.
pub(crate) fn tree(e: &Expr) -> String {
    match &e.kind {
        ExprKind::Literal(l) => literal(l),
        ExprKind::Path(p) => p.names.iter().map(|n| n.text.to_string()).collect::<Vec<_>>().join("|"),
        ExprKind::Direct(d) => format!("%{d}"),
        ExprKind::Unary(op, a) => {
            let op = match op {
                UnaryOp::Not => "not",
                UnaryOp::Neg => "neg",
                UnaryOp::Rise => "rise",
                UnaryOp::Fall => "fall",
            };
            format!("({op} {})", tree(a))
        }
        ExprKind::Binary(op, a, b) => format!("({} {} {})", binary(*op), tree(a), tree(b)),
        ExprKind::Timer { t1, e, t2 } => {
            let t2 = t2.as_ref().map(|t| format!(" {}", tree(t))).unwrap_or_default();
            format!("(timer {} {}{t2})", tree(t1), tree(e))
        }
        ExprKind::Call(p, args) => {
            let args: String = args.iter().map(arg).collect();
            format!("(call {}{args})", p.text())
        }
        ExprKind::Element(p, index, bit) => {
            let index: String = index.iter().map(|e| format!(" {}", tree(e))).collect();
            let bit = bit.as_ref().map(|b| format!(" .{}", b.text)).unwrap_or_default();
            format!("(element {}{index}{bit})", p.text())
        }
        ExprKind::List(values) => {
            let values: String = values.iter().map(|(n, e)| format!(" {n}*{}", tree(e))).collect();
            format!("(list{values})")
        }
        ExprKind::Bad => "bad".into(),
    }
}

fn binary(op: BinaryOp) -> &'static str {
    match op {
        BinaryOp::Or => "or",
        BinaryOp::Xor => "xor",
        BinaryOp::And => "and",
        BinaryOp::Dot => "dot",
        BinaryOp::Eq => "eq",
        BinaryOp::Ne => "ne",
        BinaryOp::Lt => "lt",
        BinaryOp::Le => "le",
        BinaryOp::Gt => "gt",
        BinaryOp::Ge => "ge",
        BinaryOp::Add => "add",
        BinaryOp::Sub => "sub",
        BinaryOp::Mul => "mul",
        BinaryOp::Div => "div",
        BinaryOp::Mod => "mod",
        BinaryOp::Pow => "pow",
    }
}

fn literal(l: &Literal) -> String {
    match l {
        Literal::Bool(b) => b.to_string(),
        Literal::Int(v, None) => v.to_string(),
        Literal::Int(v, Some(ty)) => format!("{ty}:{v}"),
        Literal::Real(t, None) => format!("r{t}"),
        Literal::Real(t, Some(ty)) => format!("{ty}:r{t}"),
        Literal::Time(time) => format!("{}ns", time.count()),
        Literal::Moment(moment, time) => format!("{}:{}", moment.name(), moment.text(*time)),
        Literal::Str(s) => format!("{s:?}"),
    }
}

fn arg(a: &Arg) -> String {
    let sign = if a.output { "=>" } else { "=" };
    let name = a.name.as_ref().map(|n| format!("{}{sign}", n.text)).unwrap_or_default();
    format!(" {name}{}", tree(&a.value))
}

fn is(cases: &[(&str, &str)]) {
    for (text, wanted) in cases {
        let (e, problems) = g7_syntax::parse_expr(text, FileId(0));
        assert!(problems.is_empty(), "{text}: {problems:?}");
        assert_eq!(tree(&e), *wanted, "{text}");
    }
}

#[test]
fn operators_bind_as_the_grammar_says() {
    is(&[
        ("a or b and c", "(or a (and b c))"),
        ("a or b xor c and d", "(or a (xor b (and c d)))"),
        ("a OR b AND NOT c", "(or a (and b (not c)))"),
        ("a & b", "(and a b)"),
        ("a and b = c", "(and a (eq b c))"),
        ("a = b < c", "(eq a (lt b c))"),
        ("a < b + c", "(lt a (add b c))"),
        ("a - b - c", "(sub (sub a b) c)"),
        ("a - (b - c)", "(sub a (sub b c))"),
        ("a + b * c mod d / e", "(add a (div (mod (mul b c) d) e))"),
        ("a * b ** c", "(mul a (pow b c))"),
        ("-a ** b", "(pow (neg a) b)"),
        ("not a = b", "(eq (not a) b)"),
        ("+8.0 - +a", "(sub r8.0 a)"),
        ("a == b", "(eq a b)"),
        ("a != b", "(ne a b)"),
        ("a <> b", "(ne a b)"),
        ("a ≠ b", "(ne a b)"),
        ("a <= b", "(le a b)"),
        ("a ≤ b", "(le a b)"),
        ("a ≥ b", "(ge a b)"),
        ("a >-3", "(gt a (neg 3))"),
        ("[a > 1]", "(gt a 1)"),
        ("((a))", "a"),
    ]);
}

#[test]
fn the_notation_of_grafcet() {
    is(&[
        ("a + b · c", "(add a (dot b c))"),
        ("a · b", "(dot a b)"),
        ("a . b", "(dot a b)"),
        ("a. b", "(dot a b)"),
        ("a .b", "(dot a b)"),
        ("a./b", "(dot a (not b))"),
        ("a . /b", "(dot a (not b))"),
        ("a.↑b", "(dot a (rise b))"),
        ("a.(b + c)", "(dot a (add b c))"),
        ("(a + b).c", "(dot (add a b) c)"),
        ("a.b", "a|b"),
        ("/a", "(not a)"),
        ("!a", "(not a)"),
        ("a'", "(not a)"),
        ("(a + b)'", "(not (add a b))"),
        ("a' . b'", "(dot (not a) (not b))"),
        ("a\u{305} · b\u{304}", "(dot (not a) (not b))"),
        ("a''", "(not (not a))"),
        ("a / b", "(div a b)"),
        ("a / /b", "(div a (not b))"),
        ("↑a", "(rise a)"),
        ("^a", "(rise a)"),
        ("rise(a)", "(rise a)"),
        ("↓a", "(fall a)"),
        ("fall(a or b)", "(fall (or a b))"),
        ("↑a · ↓b", "(dot (rise a) (fall b))"),
        ("not ↑a and b", "(and (not (rise a)) b)"),
        ("=1", "true"),
        ("1", "1"),
        ("a · =1", "(dot a true)"),
    ]);
}

#[test]
fn operators_of_time() {
    is(&[
        ("3s/X2", "(timer 3000000000ns X2)"),
        ("3s/X2/1s", "(timer 3000000000ns X2 1000000000ns)"),
        ("3s / X2 / 1s", "(timer 3000000000ns X2 1000000000ns)"),
        ("not 3s/X2", "(not (timer 3000000000ns X2))"),
        ("3s/↑a", "(timer 3000000000ns (rise a))"),
        ("3s/a and b", "(and (timer 3000000000ns a) b)"),
        ("3s/(a and b)/5s or c", "(or (timer 3000000000ns (and a b) 5000000000ns) c)"),
        ("3s/X2 / n", "(div (timer 3000000000ns X2) n)"),
        ("(3s) / 2", "(div 3000000000ns 2)"),
        ("delay(t, a)", "(timer t a)"),
        ("delay(t + 1s, a or b, 0s)", "(timer (add t 1000000000ns) (or a b) 0ns)"),
        ("X12.t >= 5s", "(ge X12|t 5000000000ns)"),
    ]);
}

#[test]
fn literals() {
    is(&[
        ("1_000", "1000"),
        ("16#FF", "255"),
        ("8#17", "15"),
        ("2#1010", "10"),
        ("18446744073709551615", "18446744073709551615"),
        ("INT#5", "INT:5"),
        ("SINT#-128", "SINT:-128"),
        ("UINT#16#FF", "UINT:255"),
        ("1.5", "r1.5"),
        ("2.0e-3", "r2.0e-3"),
        ("1_0.5", "r10.5"),
        ("1e3", "r1e3"),
        ("REAL#2", "REAL:r2"),
        ("BOOL#1", "true"),
        ("TRUE", "true"),
        ("false", "false"),
        ("5s", "5000000000ns"),
        ("500ms", "500000000ns"),
        ("1h30m", "5400000000000ns"),
        ("2.5s", "2500000000ns"),
        ("10us", "10000ns"),
        ("40ns", "40ns"),
        ("1d", "86400000000000ns"),
        ("T#5s", "5000000000ns"),
        ("t#5s", "5000000000ns"),
        ("TIME#1m_30s", "90000000000ns"),
        ("T#-5ms", "-5000000ns"),
        ("LT#5s", "5000000000ns"),
        ("D#2026-11-28", "DATE:2026-11-28"),
        ("date#2026-1-2", "DATE:2026-01-02"),
        ("LDATE#2026-11-28", "DATE:2026-11-28"),
        ("TOD#15:36:55.36", "TOD:15:36:55.36"),
        ("TIME_OF_DAY#7:05", "TOD:07:05:00"),
        ("DT#2026-11-28-15:36:55.360", "DT:2026-11-28-15:36:55.36"),
        ("ldate_and_time#2026-11-28-0:0:0", "DT:2026-11-28-00:00:00"),
        ("D#2026-11-28-D#2026-11-27", "(sub DATE:2026-11-28 DATE:2026-11-27)"),
        ("TOD#12:00:00-1s", "(sub TOD:12:00:00 1000000000ns)"),
        ("DT#2026-11-28-12:00:00-1s", "(sub DT:2026-11-28-12:00:00 1000000000ns)"),
        ("'text'", "\"text\""),
        ("'it$'s $$1$n$t$r$41'", "\"it's $1\\n\\t\\rA\""),
        ("x = 'a'", "(eq x \"a\")"),
        ("x='a'", "(eq x \"a\")"),
    ]);
}

#[test]
fn names_and_calls() {
    is(&[
        ("Chart.X12", "Chart|X12"),
        ("G.3.12", "G|3|12"),
        ("12.t", "12|t"),
        ("M3.X12.t", "M3|X12|t"),
        ("`Vent på start`.X", "Vent på start|X"),
        ("`a\\`b\\\\`", "a`b\\"),
        ("æble and ψ", "(and æble ψ)"),
        ("%I0.1", "%I0.1"),
        ("%x3.in", "%X3.IN"),
        ("%X12.T > 5", "(gt %X12.T 5)"),
        ("%M1 . %M2", "(dot %M1 %M2)"),
        ("ABS(x)", "(call ABS x)"),
        ("LIMIT(MN := 0, IN := x, MX := 9)", "(call LIMIT MN=0 IN=x MX=9)"),
        ("AND(a, or(b, c)) and (d)", "(and (call AND a (call or b c)) d)"),
        ("MOD(n, 3) mod (2)", "(mod (call MOD n 3) 2)"),
        ("2s/XOR(a, b)", "(timer 2000000000ns (call XOR a b))"),
        ("NOT(a)", "(not a)"),
        ("c.f(a, q => b.c)", "(call c.f a q=>b|c)"),
        ("f()", "(call f)"),
        ("f(LEN('abc'), 'd')", "(call f (call LEN \"abc\") \"d\")"),
        ("at or max or scan", "(or (or at max) scan)"),
    ]);
}

#[test]
fn a_bracket_on_the_next_line_is_no_call() {
    let d = crate::grammar::read("chart G {\n  1 -> 2 when a\n  (2, 3) -> 1 when b\n}");
    let texts: Vec<String> = d.charts().flat_map(|c| c.transitions()).map(|t| tree(&t.receptivity)).collect();
    assert_eq!(texts, ["a", "b"]);
}

#[test]
fn places_are_those_of_the_text() {
    let (e, _) = g7_syntax::parse_expr("a or (b and c)", FileId(3));
    let ExprKind::Binary(_, left, right) = &e.kind else { panic!("{e:?}") };
    let range = |e: &Expr| (e.at.0.file.0, e.at.0.start, e.at.0.end);
    assert_eq!([range(&e), range(left), range(right)], [(3, 0, 14), (3, 0, 1), (3, 5, 14)]);
}
