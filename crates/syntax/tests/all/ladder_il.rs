//! Instruction List and Ladder: what they mean, and that showing and reading keep it.

use std::collections::BTreeMap;

use g7_model::{BinaryOp, Expr, ExprKind, FileId, Literal, Name, Path, Place, Span, Stmt, StmtKind, UnaryOp};
use g7_syntax::{il, ladder, print_statements};
use proptest::prelude::*;

const FILE: FileId = FileId(0);

// Statements over Booleans.

type Values = BTreeMap<String, bool>;

/// How a run of statements went on.
#[derive(PartialEq, Eq)]
enum Went {
    On,
    Exit,
    Return,
}

fn value(e: &Expr, values: &Values) -> bool {
    match &e.kind {
        ExprKind::Literal(Literal::Bool(b)) => *b,
        ExprKind::Path(path) => *values.get(&path.text()).expect("a variable"),
        ExprKind::Unary(UnaryOp::Not, a) => !value(a, values),
        // A stand-in that depends on its operand and differs from it.
        ExprKind::Unary(UnaryOp::Rise, a) => value(a, values) && *values.get("up").expect("up"),
        ExprKind::Unary(UnaryOp::Fall, a) => !value(a, values) && *values.get("up").expect("up"),
        ExprKind::Binary(op, a, b) => {
            let (a, b) = (value(a, values), value(b, values));
            match op {
                BinaryOp::And | BinaryOp::Dot | BinaryOp::Mul => a && b,
                BinaryOp::Or | BinaryOp::Add => a || b,
                BinaryOp::Xor | BinaryOp::Ne => a != b,
                BinaryOp::Eq => a == b,
                other => panic!("no operation of Booleans: {other:?}"),
            }
        }
        other => panic!("{other:?}"),
    }
}

fn run(list: &[Stmt], values: &mut Values, fuel: &mut u32) -> Went {
    for stmt in list {
        *fuel = fuel.checked_sub(1).expect("this ends");
        let went = match &stmt.kind {
            StmtKind::Assign { target, value: e } => {
                let ExprKind::Path(path) = &target.kind else { panic!("{target:?}") };
                let v = value(e, values);
                values.insert(path.text(), v);
                Went::On
            }
            StmtKind::If(arms, otherwise) => {
                let arm = arms.iter().find(|(c, _)| value(c, values)).map_or(otherwise, |(_, body)| body);
                run(arm, values, fuel)
            }
            StmtKind::While(c, body) => {
                let mut went = Went::On;
                while went == Went::On && value(c, values) {
                    *fuel = fuel.checked_sub(1).expect("this ends");
                    went = run(body, values, fuel);
                }
                if went == Went::Exit { Went::On } else { went }
            }
            StmtKind::Repeat(body, c) => loop {
                *fuel = fuel.checked_sub(1).expect("this ends");
                match run(body, values, fuel) {
                    Went::On if value(c, values) => break Went::On,
                    Went::On => {}
                    Went::Exit => break Went::On,
                    Went::Return => break Went::Return,
                }
            },
            StmtKind::Exit => Went::Exit,
            StmtKind::Return => Went::Return,
            other => panic!("{other:?}"),
        };
        if went != Went::On {
            return went;
        }
    }
    Went::On
}

const NAMES: [&str; 5] = ["a", "b", "c", "d", "up"];

/// Every combination of the variables.
fn tables() -> impl Iterator<Item = Values> {
    (0..1u32 << NAMES.len()).map(|bits| {
        NAMES.iter().enumerate().map(|(i, name)| ((*name).to_string(), bits >> i & 1 == 1)).collect()
    })
}

fn same(one: &[Stmt], other: &[Stmt]) -> Result<(), String> {
    for table in tables() {
        let (mut x, mut y) = (table.clone(), table.clone());
        run(one, &mut x, &mut 10_000);
        run(other, &mut y, &mut 10_000);
        if x != y {
            return Err(format!("from {table:?}: {x:?} and {y:?}"));
        }
    }
    Ok(())
}

fn st(text: &str) -> Vec<Stmt> {
    let (list, problems) = g7_syntax::parse_statements(text, FILE);
    assert_eq!(problems, [], "{text}");
    list
}

#[track_caller]
fn list_is(list: &str, text: &str) {
    let (read, problems) = il::statements(list, FILE);
    assert_eq!(problems, [], "{list}");
    if let Err(e) = same(&read, &st(text)) {
        panic!("{list}\n{}\n{e}", print_statements(&read));
    }
}

#[track_caller]
fn rungs_are(rungs: &str, text: &str) {
    let (read, problems) = ladder::statements(rungs, FILE);
    assert_eq!(problems, [], "{rungs}");
    if let Err(e) = same(&read, &st(text)) {
        panic!("{rungs}\n{}\n{e}", print_statements(&read));
    }
}

#[track_caller]
fn list_is_wrong(list: &str, what: &str) {
    let (_, problems) = il::statements(list, FILE);
    assert!(problems.iter().any(|p| p.what.contains(what)), "{problems:?}");
}

#[test]
fn loads_operations_and_stores() {
    list_is("LD a\nANDN b\nOR( c\nXOR d\n)\nST d\nSTN c", "d := a and not b or (c xor d) c := not d");
    list_is("LDN a\nNOT\n& b\n&N c\nST d", "d := a and b and not c");
    list_is("ld a or b st d", "d := a or b");
}

#[test]
fn brackets_wait() {
    list_is("LD a\nAND(\n  LD b\n  ORN( c\n  AND d\n  )\n)\nST d", "d := a and (b or not (c and d))");
}

#[test]
fn set_and_reset_hold_what_they_were_given() {
    list_is("LD a\nS b\nR c", "if a then b := TRUE end_if if a then c := FALSE end_if");
    // The result is that from before: `a` is read once.
    list_is("LD a\nR a\nST b\nSTN c", "b := a c := not a a := FALSE");
    list_is("LD a\nAND b\nS a\nAND c\nST d", "d := a and b and c if a and b then a := TRUE end_if");
}

#[test]
fn jumps_forward_are_conditions() {
    list_is("LD a\nJMPC out\nLD b\nST c\nout:", "if not a then c := b end_if");
    list_is(
        "LD a\nJMPCN other\nLD b\nST c\nJMP out\nother:\nLD d\nST c\nout:\nLD c\nST d",
        "if a then c := b else c := d end_if d := c",
    );
    // Two jumps that cross each other.
    list_is(
        "LD a\nJMPC one\nLD b\nJMPC two\nLDN c\nST c\none: LDN d\nST d\ntwo: LD c\nST up",
        "if a then d := not d else if not b then c := not c d := not d end_if end_if up := c",
    );
}

#[test]
fn jumps_back_are_loops() {
    list_is("again: LD a\nST b\nLD FALSE\nST a\nLD a\nJMPC again", "b := a a := FALSE");
    list_is(
        "again: LD a\nJMPCN out\nLD b\nST a\nLD FALSE\nST b\nJMP again\nout: LD TRUE\nST c",
        "while a do a := b b := FALSE end_while c := TRUE",
    );
}

#[test]
fn a_return_ends_the_body() {
    list_is("LD a\nRETC\nLD b\nRETCN\nST c\nRET\nST d", "if a then return end_if if b then c := b end_if");
}

#[test]
fn what_has_no_meaning_is_told() {
    list_is_wrong("ST a", "there is no result here");
    list_is_wrong("LD a\nx:\nST b", "there is no result here");
    list_is_wrong("LD a\nJMP x", "there is no label `x`");
    list_is_wrong("LD a\nAND( b", "never closed");
    list_is_wrong("LD a\n)", "no bracket is open");
    list_is_wrong("x: LD a\nx: ST a", "stands there twice");
    list_is_wrong("LD a\nAND( b\nST c\n)", "between brackets");
    list_is_wrong("LD t.Q\nCAL t(IN := a)\nST b", "store it in a variable first");
    // Into a loop from outside.
    list_is_wrong("LD a\nJMPC in\nx: LD b\nST c\nin: LD d\nST b\nLD c\nJMPC x", "no form");
}

#[test]
fn calls_and_functions() {
    let (read, problems) = il::statements(
        "LD n\nMAX 5\nADD m, 2\nST n\nCAL t(IN := a, PT := 5s)\nLD a\nCU c\nLD a\nCALC t(IN := b)\n",
        FILE,
    );
    assert_eq!(problems, []);
    let text = "n := MAX(n, 5) + m + 2\nt(IN := a, PT := 5s)\nc(CU := a)\nIF a THEN\n  t(IN := b)\nEND_IF\n";
    assert_eq!(print_statements(&read), text);
}

#[test]
fn contacts_coils_and_branches() {
    rungs_are("--[a]--[/b]--(c)", "c := a and not b");
    rungs_are("| {[a] [b]|[/c]}--[d]--(/c)  |", "c := not ((a and b or not c) and d)");
    rungs_are(
        "--[P a]--(S b)\n[N c]--(R d)",
        "if rise(a) then b := TRUE end_if if fall(c) then d := FALSE end_if",
    );
    rungs_are("--[a or b]--(c)--(/d)", "c := a or b d := not (a or b)");
    rungs_are("--[a]--{ (b) | [c]--(S d) }", "b := a if a and c then d := TRUE end_if");
    rungs_are("--(a)", "a := TRUE");
    rungs_are("--[a]--(b := c xor d)", "if a then b := c xor d end_if");
}

#[test]
fn power_is_that_from_before_the_coil() {
    rungs_are("--[a]--[b]--(R a)--(c)", "c := a and b if c then a := FALSE end_if");
    let (_, problems) = ladder::statements("--[a]--{ (/a) | (b) }", FILE);
    assert!(problems.iter().any(|p| p.what.contains("write two rungs")), "{problems:?}");
}

#[test]
fn rungs_are_jumped_over() {
    rungs_are("--[a]--(JMP out)\n--[b]--(c)\nout: --[d]--(a)", "if not a then c := b end_if a := d");
    rungs_are("--[a]--(RET)\n--[b]--(c)", "if not a then c := b end_if");
}

#[test]
fn a_block_takes_power_and_gives_it() {
    let (read, problems) = ladder::statements("--[a]--<t(IN, PT := 5s).Q>--[/b]--(c)", FILE);
    assert_eq!(problems, []);
    assert_eq!(print_statements(&read), "t(IN := a, PT := 5s)\nc := t.Q and not b\n");
}

#[test]
fn what_is_wrong_in_a_rung_has_its_place() {
    for (text, what, part) in [
        ("--[a--(b)", "`]` is missing", "["),
        ("--{ [a] | [b]--(c)", "never closed", "{"),
        ("--[a]--", "no coil", "--[a]--"),
        ("--a--(b)", "a contact", "a"),
        ("--[a)]--(b)", "nothing more", ")"),
    ] {
        let (_, problems) = ladder::statements(text, FILE);
        let found = problems.iter().find(|p| p.what.contains(what));
        let found = found.unwrap_or_else(|| panic!("{text}: {problems:?}"));
        assert_eq!(&text[found.at.start as usize..found.at.end as usize], part, "{text}");
    }
}

#[test]
fn what_is_shown_reads_well() {
    let (e, _) = g7_syntax::parse_expr("(a or not b) and not (c and d)", FILE);
    assert_eq!(il::show_expr(&e), "LD a\nORN b\nANDN(\n  LD c\n  AND d\n)\n");
    assert_eq!(ladder::show_expr(&e), "--{ [a] | [/b] }--{ [/c] | [/d] }");
    let list = st("q := rise(a) and n > 5 if c then k := k + 1 end_if");
    assert_eq!(
        il::show(&list).as_deref(),
        Some("LD ↑a\nAND(\n  LD n\n  GT 5\n)\nST q\nLD c\nJMPCN L1\nLD k\nADD 1\nST k\nL1:\n")
    );
    let rungs = ladder::show(&list, &|_| true);
    assert_eq!(rungs.as_deref(), Some("--[P a]--[n > 5]--(q)\n--[c]--(k := k + 1)\n"));
}

// Laws

fn at() -> Place {
    Place(Span::default())
}

fn path(name: &str) -> Expr {
    let names = vec![Name { text: name.into(), at: at() }];
    Expr { kind: ExprKind::Path(Path { names }), at: at() }
}

fn expression() -> impl Strategy<Value = Expr> {
    let leaf = prop_oneof![
        4 => prop::sample::select(&NAMES[..4]).prop_map(path),
        1 => any::<bool>().prop_map(|b| Expr { kind: ExprKind::Literal(Literal::Bool(b)), at: at() }),
    ];
    let ops = [
        BinaryOp::And,
        BinaryOp::Or,
        BinaryOp::Xor,
        BinaryOp::Dot,
        BinaryOp::Eq,
        BinaryOp::Ne,
        BinaryOp::Add,
        BinaryOp::Mul,
    ];
    leaf.prop_recursive(5, 40, 2, move |inner| {
        let unary = prop::sample::select(vec![UnaryOp::Not, UnaryOp::Not, UnaryOp::Rise, UnaryOp::Fall]);
        prop_oneof![
            2 => (unary, inner.clone()).prop_map(|(op, a)| {
                Expr { kind: ExprKind::Unary(op, Box::new(a)), at: at() }
            }),
            5 => (prop::sample::select(ops.to_vec()), inner.clone(), inner).prop_map(|(op, a, b)| {
                Expr { kind: ExprKind::Binary(op, Box::new(a), Box::new(b)), at: at() }
            }),
        ]
    })
}

fn stmt(kind: StmtKind) -> Stmt {
    Stmt { kind, at: at() }
}

fn statements() -> impl Strategy<Value = Vec<Stmt>> {
    let simple = prop_oneof![
        6 => (prop::sample::select(&NAMES[..4]), expression())
            .prop_map(|(name, value)| stmt(StmtKind::Assign { target: path(name), value })),
        1 => Just(stmt(StmtKind::Return)),
    ];
    let one = simple.prop_recursive(3, 12, 4, |inner| {
        let list = || prop::collection::vec(inner.clone(), 0..3);
        prop_oneof![
            (prop::collection::vec((expression(), list()), 1..3), list())
                .prop_map(|(arms, otherwise)| stmt(StmtKind::If(arms, otherwise))),
            // A loop that ends: its condition goes away.
            (prop::sample::select(&NAMES[..4]), list()).prop_map(|(name, mut body)| {
                let no = Expr { kind: ExprKind::Literal(Literal::Bool(false)), at: at() };
                body.push(stmt(StmtKind::Assign { target: path(name), value: no }));
                stmt(StmtKind::While(path(name), body))
            }),
        ]
    });
    prop::collection::vec(one, 0..4)
}

fn tells(e: &Expr, other: &Expr) -> Result<(), String> {
    for table in tables() {
        if value(e, &table) != value(other, &table) {
            return Err(format!("differs at {table:?}"));
        }
    }
    Ok(())
}

proptest! {
    #[test]
    fn a_list_shown_means_the_same(e in expression()) {
        let text = il::show_expr(&e);
        let (read, problems) = il::expression(&text, FILE);
        prop_assert_eq!(problems, vec![], "{}", text);
        prop_assert_eq!(tells(&e, &read), Ok(()), "{}", text);
    }

    #[test]
    fn a_rung_shown_means_the_same(e in expression()) {
        let text = ladder::show_expr(&e);
        let (read, problems) = ladder::expression(&text, FILE);
        prop_assert_eq!(problems, vec![], "{}", text);
        prop_assert_eq!(tells(&e, &read), Ok(()), "{}", text);
    }

    #[test]
    fn statements_shown_as_a_list_do_the_same(list in statements()) {
        let text = il::show(&list).expect("all of these have a form");
        let (read, problems) = il::statements(&text, FILE);
        prop_assert_eq!(problems, vec![], "{}", text);
        prop_assert_eq!(same(&list, &read), Ok(()), "{}", text);
    }

    #[test]
    fn statements_shown_as_rungs_do_the_same(list in statements()) {
        let Some(text) = ladder::show(&list, &|_| true) else { return Ok(()) };
        let (read, problems) = ladder::statements(&text, FILE);
        prop_assert_eq!(problems, vec![], "{}", text);
        prop_assert_eq!(same(&list, &read), Ok(()), "{}", text);
    }

    #[test]
    fn no_text_breaks_a_reader(text in "[-a-dA-Z ()\\[\\]{}|<>:;=/.,0-9'`↑\\n]{0,60}") {
        let _ = il::statements(&text, FILE);
        let _ = ladder::statements(&text, FILE);
    }

    #[test]
    fn no_words_break_a_reader(words in prop::collection::vec(prop::sample::select(vec![
        "LD", "a", "AND(", ")", "ST", "x:", "JMP", "x", "JMPC", "y:", "y", "RET", "S", "R", "CAL", "\n", "[", "]", "--", "(", "{", "|", "}",
    ]), 0..60)) {
        let text = words.join(" ");
        let _ = il::statements(&text, FILE);
        let _ = ladder::statements(&text, FILE);
    }
}

/// Words of the language stand where instructions and rungs should: each is told, and the reading ends.
#[test]
fn words_of_the_language_in_a_body_are_told_and_passed() {
    for language in ["il", "ld"] {
        for body in [
            "chart motor",
            "step",
            "JMP step",
            "CAL chart",
            "LD chart",
            "ST step",
            "LD (",
            "AND ,",
            ",",
            "{",
            "-> 1",
        ] {
            let text = format!("action P {language} {{\n  {body}\n}}\n");
            let (_, problems) = g7_syntax::parse(&text, g7_model::FileId(0));
            assert!(problems.len() < 20, "{language} {body}: {}", problems.len());
            if language == "il" {
                assert!(!problems.is_empty(), "{body} is no instruction");
            }
        }
    }
}
