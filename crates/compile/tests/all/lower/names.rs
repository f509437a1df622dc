//! Symbols: what rows are called.

use g7_compile::symbols::{Names, Symbols};
use g7_engine::StepId;
use g7_model::Type;

use super::support::{Look, compiled};

#[test]
fn names_lie_in_one_text() {
    let mut names = Names::default();
    for n in ["one", "", "drei"] {
        names.push(n);
    }
    assert_eq!(names.iter().collect::<Vec<_>>(), ["one", "", "drei"]);
    assert_eq!((names.len(), names.get(3)), (3, ""));
}

#[test]
fn steps_are_called_as_short_as_they_are_unique() {
    let c = compiled(
        "input a : BOOL
         chart G { initial step 1  step 2  macro M = E1  1 -> 2 when a  2 -> M when a }
         chart H { initial step 2  macro K = E2  macro M = E3  2 -> K when a  K -> M when a }
         macrochart E1 { entry step E  exit step S  E -> S when a }
         macrochart E2 { entry step E  exit step S  E -> S when a }
         macrochart E3 { entry step E  exit step S  E -> S when a }",
    );
    let s = &c.symbols;
    let names: Vec<&str> = (0..s.steps()).map(|i| s.step_name(StepId(i))).collect();
    assert_eq!(names, ["1", "G.2", "G.M.E", "G.M.S", "H.2", "K.E", "K.S", "H.M.E", "H.M.S"]);
    assert_eq!(s.step_path(StepId(5)), "H.K.E");
    assert_eq!(s.step("K.S"), Some(StepId(6)));
    assert_eq!(s.step("H.K.S"), Some(StepId(6)));
    assert_eq!(s.step("G.1"), Some(StepId(0)));
    assert_eq!(s.step("2"), None, "two charts have it");
    assert_eq!(s.step("9"), None);
    let macros: Vec<&str> = s.macro_steps.iter().map(|m| &*m.name).collect();
    assert_eq!(macros, ["G.M", "K", "H.M"]);
}

#[test]
fn transitions_read_as_written() {
    let text = "input a : BOOL
        chart G { initial step 1  step 2  go: 1 -> (1, 2) when a
        (1, 2) -> () when a priority 1 }";
    let c = compiled(text);
    assert_eq!(c.symbols.transition_text(0), "(1, 2) -> ()");
    assert_eq!(c.symbols.transition_text(1), "1 -> (1, 2)");
    assert_eq!((c.symbols.label(0), c.symbols.label(1)), (None, Some("go")));
    let at = c.symbols.transition_place(1);
    assert!(text[at.start as usize..at.end as usize].starts_with("go:"));
    assert!(c.symbols.is_written(0));
}

#[test]
fn variables_carry_what_their_declaration_says() {
    let c = compiled(
        "output V : BOOL at %Q0.1 inverted safe TRUE \"valve\"
         chart G { var n : INT := 3 retain  initial step 1 }",
    );
    let v = c.symbols.variable("V").expect("V");
    assert_eq!(
        (v.inverted, v.address.as_deref(), v.comment.as_deref()),
        (true, Some("%Q0.1"), Some("valve"))
    );
    assert_eq!(*v.safe, [1]);
    let n = c.symbols.variable("G.n").expect("G.n");
    assert!(n.retain);
    assert_eq!(c.symbols.variable_at(n.addr).map(|v| &*v.name), Some("G.n"));
    assert_eq!(n.value(&c.start().state), [3]);
}

#[test]
fn values_print_as_literals() {
    let text = |ty, words: &[u64]| Symbols::value_text(ty, words);
    assert_eq!(text(Type::Bool, &[1]), "TRUE");
    assert_eq!(text(Type::Int, &[-5i64 as u64]), "-5");
    assert_eq!(text(Type::Ulint, &[u64::MAX]), "18446744073709551615");
    assert_eq!(text(Type::Real, &[u64::from(2.5f32.to_bits())]), "2.5");
    assert_eq!(text(Type::Lreal, &[2.0f64.to_bits()]), "2.0");
    assert_eq!(text(Type::Time, &[1_500_000_000]), "T#1s500ms");
    assert_eq!(text(Type::Time, &[0]), "T#0s");
    assert_eq!(text(Type::String(8), &[4, u64::from_le_bytes(*b"a'$\n\0\0\0\0")]), "'a$'$$$n'");
}

#[test]
fn the_inputs_of_a_control_block_are_the_qualifiers() {
    let mut inputs = g7_engine::INPUTS.to_vec();
    let mut qualifiers = g7_model::Qualifier::ALL.map(g7_model::Qualifier::name).to_vec();
    inputs.sort_unstable();
    qualifiers.sort_unstable();
    assert_eq!(inputs, qualifiers);
}
