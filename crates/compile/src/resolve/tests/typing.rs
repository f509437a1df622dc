//! Decisions 18 and 19: literals adapt, values widen, operators and functions
//! have the types that IEC 61131-3 gives them.

use super::{ask, outcome, read, resolved};

const DOCUMENT: &str = "
input a, b : BOOL
var s : SINT  var n, m : INT  var d : DINT  var l : LINT
var us : USINT  var u : UINT  var ud : UDINT  var ul : ULINT  var bs : BYTE  var wo : WORD
var da, db : DATE  var td : TOD  var dt, du : DT
var x, y : REAL  var z : LREAL  var t : TIME  var w : STRING  var v : STRING(10)
var c : CTU
const five : INT := 5
const half : REAL := 0.5
const on : BOOL := TRUE
function Twice(k : INT) : DINT { Twice := k + k }
function Pick(first : BOOL, p : REAL, q : REAL) : REAL { Pick := SEL(first, p, q) }
chart G { initial step 1  step 2  1 -> 2 when a -> 1 when b }
";

fn check(table: &[(&str, &str)]) {
    let doc = read(DOCUMENT);
    let (mut unit, mut scopes) = resolved(&doc);
    for (text, want) in table {
        let got = ask(&mut unit, &mut scopes, text, None);
        assert_eq!(outcome(&unit, got), *want, "{text}");
    }
}

#[test]
fn literals_take_the_type_of_the_other_side() {
    check(&[
        ("n + 1", "(n Add 1) : INT"),
        ("1 + us", "(1 Add us) : USINT"),
        ("us + 256", "G0211"),
        ("n < 40000", "G0211"),
        ("x + 1", "(x Add 1.0) : REAL"),
        ("z * 0.1", "(z Mul 0.1) : LREAL"),
        ("n * 0.5", "(REAL(n) Mul 0.5) : REAL"),
        ("l * 0.5", "G0210"),
        ("a = 1", "(a Eq true) : BOOL"),
        ("0 <> a", "(false Ne a) : BOOL"),
        ("a = 2", "G0209"),
        ("1", "1 : DINT"),
        ("3000000000", "3000000000 : LINT"),
        ("10000000000000000000", "10000000000000000000 : ULINT"),
        ("2.5", "2.5 : LREAL"),
        ("INT#5 + d", "(5 Add d) : DINT"),
        ("(2 + 3) * n", "(5 Mul n) : INT"),
        ("7 / 2 + n", "(3 Add n) : INT"),
        ("7 / 2.0 + x", "(3.5 Add x) : REAL"),
        ("five + n", "(5 Add n) : INT"),
        ("five + 1", "6 : INT"),
        ("five * 10000", "G0212"),
        ("half + x", "(0.5 Add x) : REAL"),
    ]);
}

#[test]
fn values_widen_where_none_is_lost() {
    check(&[
        ("s + n", "(INT(s) Add n) : INT"),
        ("n + d", "(DINT(n) Add d) : DINT"),
        ("n + u", "(DINT(n) Add DINT(u)) : DINT"),
        ("us + u", "(UINT(us) Add u) : UINT"),
        ("d + ud", "(LINT(d) Add LINT(ud)) : LINT"),
        ("l + ul", "G0210"),
        ("n / x", "(REAL(n) Div x) : REAL"),
        ("x - z", "(LREAL(x) Sub z) : LREAL"),
        ("l + x", "G0210"),
        ("n mod 7", "(n Mod 7) : INT"),
        ("x mod 2.0", "G0210"),
        ("-n", "-n : INT"),
        ("-t", "-t : TIME"),
        ("-us", "G0210"),
        ("-a", "G0210"),
        ("x ** 2", "REAL((LREAL(x) Pow 2.0)) : REAL"),
        ("n ** m", "REAL((LREAL(n) Pow LREAL(m))) : REAL"),
        ("z ** 0.5", "(z Pow 0.5) : LREAL"),
    ]);
}

#[test]
fn boolean_operators_and_their_algebra_signs() {
    check(&[
        ("a + b", "(a Or b) : BOOL"),
        ("a * b", "(a And b) : BOOL"),
        ("a · b", "(a And b) : BOOL"),
        ("a + b * a", "(a Or (b And a)) : BOOL"),
        ("a or b and not a", "(a Or (b And not a)) : BOOL"),
        ("a xor on", "(a Xor true) : BOOL"),
        ("a + 1", "(a Or true) : BOOL"),
        ("0 * a", "(false And a) : BOOL"),
        ("a + 2", "G0209"),
        ("not on", "false : BOOL"),
        ("not n", "G0209"),
        ("a - b", "G0210"),
        ("a / b", "G0210"),
        ("n and m", "G0210"),
        ("n · m", "G0210"),
        ("a and n", "G0209"),
        ("a + n", "G0209"),
        ("a < b", "(a Lt b) : BOOL"),
        ("n = m and a", "((n Eq m) And a) : BOOL"),
        ("a and q and r", "G0202 G0202"),
    ]);
}

#[test]
fn durations() {
    check(&[
        ("t + 5s", "(t Add 5000000000) : TIME"),
        ("5s - 200ms", "4800000000 : TIME"),
        ("t * 2", "(t Mul 2) : TIME"),
        ("n * t", "(t Mul LINT(n)) : TIME"),
        ("t * 0.5", "(t Mul 0.5) : TIME"),
        ("t / x", "(t Div LREAL(x)) : TIME"),
        ("t / (2)", "(t Div 2) : TIME"),
        ("t / (0)", "G0212"),
        ("n / t", "G0210"),
        ("t / t", "G0210"),
        ("t + 5", "G0210"),
        ("t > 5", "G0210"),
        ("t >= 5s", "(t Ge 5000000000) : BOOL"),
        ("ul * t", "G0209"),
        ("t + a", "G0209"),
    ]);
}

#[test]
fn standard_functions() {
    check(&[
        ("ABS(n)", "Abs(n) : INT"),
        ("abs(x)", "Abs(x) : REAL"),
        ("ABS(t)", "Abs(t) : TIME"),
        ("ABS(a)", "G0209"),
        ("SQRT(x)", "Sqrt(x) : REAL"),
        ("SQRT(n)", "Sqrt(REAL(n)) : REAL"),
        ("SQRT(2)", "Sqrt(2.0) : LREAL"),
        ("MIN(n, d)", "Min(DINT(n), d) : DINT"),
        ("MAX(n, 3, m)", "Max(Max(n, 3), m) : INT"),
        ("MIN(t, 5s)", "Min(t, 5000000000) : TIME"),
        ("MIN(a, b)", "G0209"),
        ("MIN(n, t)", "G0209"),
        ("LIMIT(0, n, 10)", "Limit(0, n, 10) : INT"),
        ("LIMIT(IN := n, MN := 0, MX := 10)", "Limit(0, n, 10) : INT"),
        ("SEL(a, n, d)", "Sel(a, DINT(n), d) : DINT"),
        ("SEL(a, w, v)", "Sel(a, w, v) : STRING"),
        ("SEL(1, a, b)", "Sel(true, a, b) : BOOL"),
        ("MUX(n, x, 1, 2.5)", "Mux(LINT(n), x, 1.0, 2.5) : REAL"),
        ("MUX(K := 0, IN1 := x, IN0 := y)", "Mux(0, y, x) : REAL"),
        ("MOVE(n)", "n : INT"),
        ("TRUNC(x)", "trunc DINT(x) : DINT"),
        ("TRUNC(-2.7)", "-2 : DINT"),
        ("TRUNC(a)", "G0209"),
        ("LEN(w)", "Len(w) : INT"),
        ("LEFT(w, n)", "Left(w, LINT(n)) : STRING"),
        ("CONCAT(v, v)", "Concat(v, v) : STRING(20)"),
        ("CONCAT(v, 'ab', v)", "Concat(Concat(v, 'ab'), v) : STRING(22)"),
        ("REPLACE(w, v, 1, 2)", "Replace(w, v, 1, 2) : STRING(90)"),
        ("FIND(w, 'x')", "Find(w, 'x') : INT"),
        ("LEN(n)", "G0209"),
        ("ADD(n, d, 1)", "((DINT(n) Add d) Add 1) : DINT"),
        ("add(IN2 := n, IN1 := d)", "(d Add DINT(n)) : DINT"),
        ("SUB(t, 5s)", "(t Sub 5000000000) : TIME"),
        ("MUL_TIME(t, 2)", "(t Mul 2) : TIME"),
        ("AND(a, b, 1)", "((a And b) And true) : BOOL"),
        ("NOT(a)", "not a : BOOL"),
        ("GT(n, m, d)", "((n Gt m) And (DINT(m) Gt d)) : BOOL"),
        ("EQ(v, w)", "(v Eq w) : BOOL"),
        ("ADD(n, a)", "G0209"),
        ("AND(n, m)", "G0210"),
        ("MOD(x, 2)", "G0210"),
        ("NE(n, m, d)", "G0215"),
        ("SUB(n)", "G0215"),
        ("SHL(ul, n)", "Shl(ul, LINT(n)) : ULINT"),
        ("ROR(N := 3, IN := ul)", "Ror(ul, 3) : ULINT"),
        ("SHL(1, 3)", "Shl(1, 3) : UDINT"),
        ("SHL(n, 3)", "G0209"),
        ("SHL(a, 3)", "G0209"),
        ("SHL(ul, x)", "G0209"),
        ("SHR(ul, -1)", "G0212"),
        ("LIMIT(0, n)", "G0215"),
        ("ABS()", "G0215"),
        ("MIN(1)", "G0215"),
        ("SQRT(OUT => n)", "G0215"),
        ("SINUS(x)", "G0202"),
        ("n(5)", "G0208"),
        ("c(CU := a)", "G0208"),
    ]);
}

/// IEC 61131-3:2013, 6.6.2.5.8 and 6.6.2.5.2; decision 57.
#[test]
fn bit_strings() {
    check(&[
        ("bs and wo", "BitAnd(WORD(bs), wo) : WORD"),
        ("wo or 16#FF", "BitOr(wo, 255) : WORD"),
        ("16#FF xor wo", "BitXor(255, wo) : WORD"),
        ("not bs", "BitXor(bs, 255) : BYTE"),
        ("WORD#16#F0 and WORD#16#3C", "48 : WORD"),
        ("AND(wo, bs, wo)", "BitAnd(BitAnd(wo, WORD(bs)), wo) : WORD"),
        ("NOT(wo)", "BitXor(wo, 65535) : WORD"),
        ("SHL(wo, 2)", "Shl(wo, 2) : WORD"),
        ("ul and wo", "BitAnd(LWORD(ul), LWORD(wo)) : LWORD"),
        ("wo + 1", "(UINT(wo) Add 1) : UINT"),
        ("wo = 16#FF", "(wo Eq 255) : BOOL"),
        ("WORD_TO_INT(16#FFFF)", "-1 : INT"),
        ("WORD_TO_BYTE(wo)", "BYTE(wo) : BYTE"),
        ("BOOL_TO_WORD(a)", "WORD(a) : WORD"),
        ("wo.3", "(BitAnd(wo, 8) Ne 0) : BOOL"),
        ("n.15", "(BitAnd(WORD(n), 32768) Ne 0) : BOOL"),
        ("wo.16", "G0211"),
        ("wo and a", "G0210"),
        ("wo and n", "G0210"),
        ("wo and 16#1_0000", "G0211"),
        ("wo . bs", "G0210"),
        ("WORD_TO_REAL(wo)", "G0202"),
        ("STRING_TO_WORD(v)", "@STRING_TO_WORD(v) : WORD"),
        ("a.3", "G0206"),
    ]);
}

/// IEC 61131-3:2003, table 22; decision 57.
#[test]
fn decimal_digits() {
    check(&[
        ("WORD_BCD_TO_UINT(wo)", "@WORD_BCD_TO_UINT(wo) : UINT"),
        ("BCD_TO_INT(bs)", "@BYTE_BCD_TO_INT(bs) : INT"),
        ("BCD_TO_INT(16#1987)", "1987 : INT"),
        ("bcd_to_sint(BYTE#16#99)", "99 : SINT"),
        ("INT_TO_BCD(n)", "@INT_TO_BCD_WORD(n) : WORD"),
        ("INT_TO_BCD_BYTE(n)", "@INT_TO_BCD_BYTE(n) : BYTE"),
        ("UINT_TO_BCD_WORD(1987)", "6535 : WORD"),
        ("BCD_TO_INT(16#1A)", "G0212"),
        ("WORD_BCD_TO_SINT(16#128)", "G0212"),
        ("INT_TO_BCD_BYTE(100)", "G0212"),
        ("INT_TO_BCD_BYTE(-1)", "G0212"),
        ("BCD_TO_INT(n)", "G0209"),
        ("WORD_BCD_TO_UINT()", "G0215"),
        ("INT_BCD_TO_INT(n)", "G0202"),
    ]);
}

/// IEC 61131-3:2003, tables 22 and 30; 2013, table 36; decision 65.
#[test]
fn dates_and_times_of_day() {
    check(&[
        ("da - db", "(TIME(da) Sub TIME(db)) : TIME"),
        ("td - TOD#12:00:00", "(TIME(td) Sub 43200000000000) : TIME"),
        ("SUB_DT_DT(dt, du)", "(TIME(dt) Sub TIME(du)) : TIME"),
        ("dt + 5s", "DT((TIME(dt) Add 5000000000)) : DT"),
        ("ADD_DT_TIME(dt, t)", "DT((TIME(dt) Add t)) : DT"),
        ("td - t", "@TIME_within_a_day((TIME(td) Sub t)) : TOD"),
        ("TOD#12:00:00 + 5h", "61200000000000 : TOD"),
        ("D#1970-01-02", "86400000000000 : DATE"),
        ("da < D#1970-01-02", "(da Lt 86400000000000) : BOOL"),
        ("dt = du", "(dt Eq du) : BOOL"),
        ("MAX(dt, du)", "Max(dt, du) : DT"),
        ("LIMIT(TOD#6:00, td, TOD#22:00)", "Limit(21600000000000, td, 79200000000000) : TOD"),
        ("SEL(a, da, db)", "Sel(a, da, db) : DATE"),
        ("MOVE(td)", "td : TOD"),
        ("DT_TO_DATE(dt)", "@DT_TO_DATE(TIME(dt)) : DATE"),
        ("DATE_AND_TIME_TO_TIME_OF_DAY(dt)", "@DT_TO_TOD(TIME(dt)) : TOD"),
        ("DT_TO_DATE(DT#1969-12-31-23:00:00)", "-86400000000000 : DATE"),
        ("DT_TO_TOD(DT#1969-12-31-23:00:00)", "82800000000000 : TOD"),
        ("CONCAT_DATE_TOD(da, td)", "DT((TIME(da) Add TIME(td))) : DT"),
        ("CONCAT_DATE_TOD(D#1970-01-02, TOD#0:00:01)", "86401000000000 : DT"),
        ("DAY_OF_WEEK(D#2026-11-29)", "0 : INT"),
        ("DAY_OF_WEEK(D#1969-12-31)", "3 : INT"),
        ("DAY_OF_WEEK(da)", "@DAY_OF_WEEK(TIME(da)) : INT"),
        ("DT_TO_UDINT(dt)", "UDINT((TIME(dt) Div 1000000000)) : UDINT"),
        ("TOD_TO_UDINT(td)", "UDINT((TIME(td) Div 1000000)) : UDINT"),
        ("UDINT_TO_DT(ud)", "DT((1000000000 Mul LINT(ud))) : DT"),
        ("UDINT_TO_DATE(86401)", "86400000000000 : DATE"),
        ("LTOD_TO_LTOD(td)", "td : TOD"),
        ("UDINT_TO_TOD(86400000)", "G0212"),
        ("TOD#23:00:00 + 1h", "G0212"),
        ("DT#2262-04-11-00:00:00 + 24h", "G0212"),
        ("da + db", "G0210"),
        ("da + 24h", "G0210"),
        ("t + dt", "G0210"),
        ("dt * 2", "G0210"),
        ("dt - td", "G0210"),
        ("-dt", "G0210"),
        ("da = dt", "G0210"),
        ("da = 0", "G0210"),
        ("ABS(dt)", "G0209"),
        ("DATE_TO_STRING(da)", "Concat('D#', @day_text(TIME(da))) : STRING(66)"),
        ("STRING_TO_TOD(w)", "TOD(TIME(@text_clock(@behind_TOD(w)))) : TOD"),
        ("DATE_TO_DT(da)", "G0202"),
        ("DATE_TO_WORD(da)", "G0202"),
        ("DAY_OF_WEEK(dt)", "G0209"),
        ("DAY_OF_WEEK(5)", "G0209"),
    ]);
}

#[test]
fn conversions() {
    check(&[
        ("DINT_TO_INT(d)", "INT(d) : INT"),
        ("DINT_TO_INT(n)", "INT(DINT(n)) : INT"),
        ("INT_TO_INT(n)", "n : INT"),
        ("REAL_TO_INT(2.5)", "2 : INT"),
        ("REAL_TO_INT(3.5)", "4 : INT"),
        ("BOOL_TO_INT(a)", "INT(a) : INT"),
        ("INT_TO_BOOL(n)", "BOOL(n) : BOOL"),
        ("INT_TO_STRING(n)", "STRING(n) : STRING"),
        ("STRING_TO_REAL(w)", "REAL(w) : REAL"),
        ("TIME_TO_DINT(t)", "DINT((t Div 1000000)) : DINT"),
        ("TIME_TO_INT(1500ms)", "1500 : INT"),
        ("DINT_TO_TIME(d)", "(1000000 Mul LINT(d)) : TIME"),
        ("INT_TO_TIME(5)", "5000000 : TIME"),
        ("TIME_TO_STRING(t)", "STRING(t) : STRING"),
        ("STRING_TO_TIME(w)", "@STRING_TO_TIME(@behind_T(w)) : TIME"),
        ("BOOL_TO_TIME(a)", "G0202"),
        ("DINT_TO_INT(x)", "G0209"),
        ("DINT_TO_INT(70000)", "G0212"),
        ("DINT_TO_WORD(d)", "WORD(d) : WORD"),
        ("dint_to_int(d)", "INT(d) : INT"),
    ]);
}

#[test]
fn functions_of_the_document() {
    check(&[
        ("Twice(n)", "Twice(n) : DINT"),
        ("Twice(s) + 1", "(Twice(INT(s)) Add 1) : DINT"),
        ("Twice(d)", "G0209"),
        ("Pick(a, 1, x)", "Pick(a, 1.0, x) : REAL"),
        ("Pick(q := x, first := a, p := n)", "Pick(a, REAL(n), x) : REAL"),
        ("Pick(a, q := x)", "G0215"),
        ("Pick(a, x, y, x)", "G0215"),
        ("Pick(a, x, r := y)", "G0215"),
        ("Twice", "G0208"),
    ]);
}

#[test]
fn questions_have_no_memory() {
    check(&[("↑a", "G0217"), ("5s/a", "G0217"), ("not ↓a or b", "G0217")]);
}

#[test]
fn what_is_needed_reaches_functions_that_ask_for_it() {
    let doc = read(
        "var n : INT  var x : REAL  var us : USINT
         chart G { initial step 1 { P1 n := 1 + TRUNC(x)  P1 us := MAX(TRUNC(x), 2)  P1 x := 2 * SQRT(2) }
         step 2  1 -> 2 when =1 -> 1 when n > 2 }",
    );
    let (unit, _) = resolved(&doc);
    let crate::ir::ActionKind::Work { work, .. } = &unit.steps[0].actions[0].kind else { panic!() };
    let crate::ir::StmtKind::Assign(_, value) = &work[0].kind else { panic!() };
    assert_eq!(super::show(&unit, value), "(1 Add trunc INT(x))");
}

#[test]
fn the_longest_row_and_the_deepest_nesting_are_resolved() {
    let row = vec!["a"; 400].join(" or ");
    let nest = format!("{}a{}", "(".repeat(100), ")".repeat(100));
    let not = format!("{}a", "not ".repeat(100));
    let doc = read(DOCUMENT);
    let (mut unit, mut scopes) = resolved(&doc);
    for text in [row, nest, not] {
        assert!(ask(&mut unit, &mut scopes, &text, None).is_ok());
    }
}
