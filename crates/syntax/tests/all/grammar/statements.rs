//! Structured Text, written out line by line.

use crate::grammar::expressions::tree;
use g7_model::{FileId, Stmt, StmtKind};

/// Statements in a notation of this test's own.
pub(crate) fn lines(list: &[Stmt]) -> String {
    list.iter().map(line).collect::<Vec<_>>().join("; ")
}

fn line(s: &Stmt) -> String {
    match &s.kind {
        StmtKind::Assign { target, value } => format!("{} <- {}", tree(target), tree(value)),
        StmtKind::Call(p, args) => {
            let e = g7_model::Expr { kind: g7_model::ExprKind::Call(p.clone(), args.clone()), at: s.at };
            tree(&e)
        }
        StmtKind::If(arms, otherwise) => {
            let arms: Vec<_> = arms.iter().map(|(c, b)| format!("{} [{}]", tree(c), lines(b))).collect();
            format!("if {} else [{}]", arms.join(" "), lines(otherwise))
        }
        StmtKind::Case(e, arms, otherwise) => {
            let label = |(a, b): &(g7_model::Expr, Option<g7_model::Expr>)| match b {
                None => tree(a),
                Some(b) => format!("{}..{}", tree(a), tree(b)),
            };
            let arms: Vec<_> = arms
                .iter()
                .map(|a| {
                    let labels: Vec<_> = a.labels.iter().map(label).collect();
                    format!("{} [{}]", labels.join(","), lines(&a.body))
                })
                .collect();
            format!("case {} {} else [{}]", tree(e), arms.join(" "), lines(otherwise))
        }
        StmtKind::For { var, from, to, by, body } => {
            let by = by.as_ref().map(|e| format!(" by {}", tree(e))).unwrap_or_default();
            format!("for {} {} {}{by} [{}]", var.text, tree(from), tree(to), lines(body))
        }
        StmtKind::While(e, body) => format!("while {} [{}]", tree(e), lines(body)),
        StmtKind::Repeat(body, e) => format!("repeat [{}] {}", lines(body), tree(e)),
        StmtKind::Exit => "exit".into(),
        StmtKind::Return => "return".into(),
    }
}

fn is(cases: &[(&str, &str)]) {
    for (text, wanted) in cases {
        let (list, problems) = g7_syntax::parse_statements(text, FileId(0));
        assert!(problems.is_empty(), "{text}: {problems:?}");
        assert_eq!(lines(&list), *wanted, "{text}");
    }
}

#[test]
fn statements() {
    is(&[
        ("a := b", "a <- b"),
        ("a := b c := d", "a <- b; c <- d"),
        ("a := b; c := d;", "a <- b; c <- d"),
        ("%Q0.1 := TRUE", "%Q0.1 <- true"),
        ("c.PV := 3", "c|PV <- 3"),
        ("c1(CU := x, Q => y)", "(call c1 CU=x Q=>y)"),
        ("a := b\n(* note *) c := d // note", "a <- b; c <- d"),
        ("IF a THEN b := 1 END_IF", "if a [b <- 1] else []"),
        ("if a then b := 1 elsif c then b := 2 else b := 3 end_if", "if a [b <- 1] c [b <- 2] else [b <- 3]"),
        ("FOR i := 0 TO 9 DO s := s + i END_FOR", "for i 0 9 [s <- (add s i)]"),
        ("FOR i := 9 TO 0 BY -1 DO EXIT END_FOR", "for i 9 0 by (neg 1) [exit]"),
        ("WHILE a < b DO a := a + 1; END_WHILE;", "while (lt a b) [a <- (add a 1)]"),
        ("REPEAT n := n - 1 UNTIL n = 0 END_REPEAT RETURN", "repeat [n <- (sub n 1)] (eq n 0); return"),
    ]);
}

#[test]
fn the_arms_of_a_case() {
    is(&[
        (
            "CASE n OF 1: a := b 2, 4..6: a := c; d := e ELSE f() END_CASE",
            "case n 1 [a <- b] 2,4..6 [a <- c; d <- e] else [(call f)]",
        ),
        (
            "CASE n OF RED: a := b GREEN, c.BLUE: a := c END_CASE",
            "case n RED [a <- b] GREEN,c|BLUE [a <- c] else []",
        ),
        (
            "CASE n OF -1: a := b; -2..-1: a := c END_CASE",
            "case n (neg 1) [a <- b] (neg 2)..(neg 1) [a <- c] else []",
        ),
        ("CASE n OF 1: (2): a := c END_CASE", "case n 1 [] 2 [a <- c] else []"),
        (
            "CASE n OF 1: CASE m OF 2: a := b END_CASE 3: c := d END_CASE",
            "case n 1 [case m 2 [a <- b] else []] 3 [c <- d] else []",
        ),
    ]);
}
