//! A document as authors write it: cells of twenty steps, each a chart with a selection, an AND
//! divergence, timers, edges, comparisons, stored and continuous actions and comments. A cell has
//! inputs and outputs of its own, like a station of a machine.

/// Steps of one cell.
const STEPS: usize = 20;

/// The declarations of a cell; `%` stands for its number.
const DECLARED: &str = r#"
input start%, stop%, auto%, fault% : BOOL "panel of the cell"
input a%, b% : BOOL "part on belt A, on belt B"
input shut%, open% : BOOL "clamp"
input up%, down%, out%, back% : BOOL "platform and pusher"
input level% : REAL "tank"
input recipe% : INT
output right%, left%, clamp%, lift%, lower%, push%, pull%, fill%, lamp%, horn% : BOOL
var count% : INT := 0 "parts of this batch"
var dose% : REAL := 0.0
"#;

/// The chart of a cell.
const CHART: &str = r#"
chart Cell% "cell %" {
  initial step 1 "ready" { N lamp% if auto% · not fault% }
  step 2 "over the belts" {
    N right%
    P1 count% := 0
    P1 dose% := SEL(recipe% > 2, 4.5, 7.5)
  }
  step 3 "on to B" { N right% }
  step 4 "grab" {
    N clamp%
    on ↑shut%: count% := count% + 1
  }
  step 5 "carry" {
    N clamp%
    N left% if not stop%
  }
  step 6 "platform up" { N lift% if not down% }
  step 7 "platform waits"
  step 8 "platform down" { N lower% if not up% }
  step 9 "pusher out" { N push% }
  step 10 "pusher back" { N pull% }
  step 11 "pusher ready"
  step 12 "fill" { N fill% if level% < dose% and not fault% }
  step 13 "settle"
  step 14 "filled"
  step 15 "batch full?" { P1 { IF count% > 100 THEN count% := 100 END_IF } }
  step 16 "empty" { N pull% }
  step 17 "next part"
  step 18 "stopped" { N horn% if fault% or 5s/X18 }
  step 19 "rest"
  step 20 "again" {
    N lamp%
    N clamp% if shut% · not open%
  }

  1 -> 2 when ↑start% · auto% · not stop% · not fault%
  2 -> 4 when a% and (not b% or recipe% = 1) and not stop%
  2 -> 3 when b% and not a% and recipe% <> 1 and not stop%
  2 -> 18 when stop%
  3 -> 4 when b% · not shut% · 200ms/X3
  4 -> 5 when shut% · not open% · not fault%
  // Platform, pusher and tank work at the same time.
  5 -> (6, 9, 12) when 500ms/X5 · not fault%
  6 -> 7 when up% · not down%
  7 -> 8 when 200ms/X7 · not fault% · not stop%
  9 -> 10 when out% · not back%
  10 -> 11 when back% and not out%
  12 -> 13 when level% >= dose% and (auto% or start%)
  13 -> 14 when 2s/X13 and level% > 4.0 and level% < 9.0
  (8, 11, 14) -> 15 when down% and not up% and not fault%
  15 -> 16 when count% >= 5 and not stop%
  15 -> 17 when count% < 5 and not stop% and recipe% < 3
  15 -> 20 when count% < 5 and not stop% and recipe% >= 3
  15 -> 18 when stop%
  16 -> 19 when level% < 0.5 and back% and not out%
  17 -> 20 when (a% or b%) and auto% and not fault%
  18 -> 19 when ↑start% and not stop% and not fault%
  19 -> 1 when 1s/X19 and not stop%
  20 -> 2 when not stop% and not fault% and level% < 9.0
}
"#;

/// Cells with so many steps in all.
pub fn cells(steps: usize) -> String {
    let numbers = 1..=steps.div_ceil(STEPS);
    let parts = numbers.clone().map(|k| (DECLARED, k)).chain(numbers.map(|k| (CHART, k)));
    let mut text = String::from("profile iec60848\n");
    text.extend(parts.map(|(part, k)| part.replace('%', &k.to_string())));
    text
}
