//! The charts that are measured, as text, and some of them as models of other checkers.

use std::fmt::Write as _;

/// Cells of five steps, each transition with an input of its own. Two cells share a resource, which they hold from
/// their third to their fourth step: 21^(count / 2) situations. Claims that no pair holds it together.
pub fn cells(count: usize, profile: &str) -> String {
    let mut text = format!("profile {profile}\n");
    ports(&mut text, count, &["q"]);
    let _ = writeln!(text, "chart G {{");
    (1..=count).for_each(|c| cell(&mut text, c, c, "q"));
    let _ = writeln!(text, "}}");
    for c in (1..count).step_by(2) {
        let held = |c: usize| format!("(X{0}3 or X{0}4)", c);
        let _ = writeln!(text, "prove never {} and {}", held(c), held(c + 1));
    }
    text
}

/// The same cells, written from the last to the first, with other numbers of steps.
pub fn renumbered(count: usize) -> String {
    let mut text = String::from("profile iec61131\n");
    ports(&mut text, count, &["q"]);
    let _ = writeln!(text, "chart G {{");
    (1..=count).rev().for_each(|c| cell(&mut text, c, count + c, "q"));
    let _ = writeln!(text, "}}");
    text
}

/// Inputs and outputs of the cells.
fn ports(text: &mut String, count: usize, outputs: &[&str]) {
    for c in 1..=count {
        let names: Vec<String> = outputs.iter().map(|q| format!("{q}{c}")).collect();
        let _ =
            writeln!(text, "input a{c}, b{c}, c{c}, d{c}, e{c} : BOOL\noutput {} : BOOL", names.join(", "));
    }
}

/// Steps and transitions of cell `c`, whose steps begin with the number `n`. The cell of an odd number brings the
/// resource of its pair.
fn cell(text: &mut String, c: usize, n: usize, q: &str) {
    let pair = 90_000 + c.div_ceil(2);
    if c % 2 == 1 {
        let _ = writeln!(text, "  initial step {pair}");
    }
    let _ = writeln!(
        text,
        "  initial step {n}1\n  step {n}2\n  step {n}3 {{ N {q}{c} }}\n  step {n}4\n  step {n}5"
    );
    let _ = writeln!(text, "  {n}1 -> {n}2 when a{c}");
    let _ = writeln!(text, "  ({n}2, {pair}) -> {n}3 when b{c} priority {c}");
    let _ = writeln!(text, "  {n}3 -> {n}4 when c{c}");
    let _ = writeln!(text, "  {n}4 -> ({n}5, {pair}) when d{c}");
    let _ = writeln!(text, "  {n}5 -> {n}1 when e{c}");
}

/// A ring of places, each with a token that moves on when the place before it is free: some token can always move.
pub fn ring(count: usize) -> String {
    let mut text = String::from("profile iec61131\n");
    for c in 1..=count {
        let _ = writeln!(text, "input a{c} : BOOL");
    }
    let _ = writeln!(text, "chart G {{");
    for c in 1..=count {
        let (full, free) = if c % 2 == 1 { ("initial ", "") } else { ("", "initial ") };
        let _ = writeln!(text, "  {full}step {c}1\n  {free}step {c}2");
    }
    for c in 1..=count {
        let next = c % count + 1;
        let _ = writeln!(text, "  ({c}1, {next}2) -> ({c}2, {next}1) when a{c}");
    }
    let _ = writeln!(text, "}}");
    let moves = (1..=count).map(|c| format!("X{c}1 and X{}2", c % count + 1)).collect::<Vec<_>>();
    let _ = writeln!(text, "prove always {}", moves.join(" or "));
    text
}

/// Two charts of cells in one file, with the same inputs; the second is written from the last cell to the first.
/// Claims that their outputs are equal.
pub fn equal(count: usize) -> String {
    let mut text = String::from("profile iec61131\n");
    ports(&mut text, count, &["q", "pq"]);
    let _ = writeln!(text, "chart G {{");
    (1..=count).for_each(|c| cell(&mut text, c, c, "q"));
    let _ = writeln!(text, "}}\nchart H {{");
    (1..=count).rev().for_each(|c| cell(&mut text, c, count + c, "pq"));
    let _ = writeln!(text, "}}");
    let same: Vec<String> = (1..=count).map(|c| format!("q{c} = pq{c}")).collect();
    let _ = writeln!(text, "prove always {}", same.join(" and "));
    text
}

/// Sequences of four steps whose receptivities are levels, under search for stability: with `endless` each comes
/// back while its inputs stay true, else its last transition waits for the first input to fall.
pub fn transients(count: usize, endless: bool) -> String {
    let mut text = String::from("profile iec60848\n");
    for c in 1..=count {
        let _ = writeln!(text, "input a{c}, b{c}, c{c} : BOOL");
    }
    let _ = writeln!(text, "chart G {{");
    for c in 1..=count {
        let _ = writeln!(text, "  initial step {c}1\n  step {c}2\n  step {c}3\n  step {c}4");
        let _ =
            writeln!(text, "  {c}1 -> {c}2 when a{c}\n  {c}2 -> {c}3 when b{c}\n  {c}3 -> {c}4 when c{c}");
        let back = if endless { format!("a{c} and c{c}") } else { format!("not a{c}") };
        let _ = writeln!(text, "  {c}4 -> {c}1 when {back}");
    }
    let _ = writeln!(text, "}}");
    text
}

/// Two steps side by side that wait for so many ticks, each begun by an input of its own: they never end in one scan
/// unless they began in one, `D` ticks before.
pub fn timers(ticks: usize) -> String {
    let time = ticks * 10;
    format!(
        "profile iec61131\nscan 10ms\ninput a, b : BOOL\nchart G {{\n  initial step 1\n  step 2\n  step 3\n  initial step 4\n  \
         step 5\n  step 6\n  1 -> 2 when a\n  2 -> 3 when {time}ms/X2\n  3 -> 1 when not a\n  4 -> 5 when b and X2\n  \
         5 -> 6 when {time}ms/X5\n  6 -> 4 when not b\n}}\nprove never X6 and X2 and X2.t < {time}ms\n"
    )
}

/// The cells as a model of Spin. With `one` a scan moves one cell; else any of them at once.
pub fn promela(count: usize, one: bool) -> String {
    let mut text = String::new();
    for c in 1..=count {
        let _ = writeln!(text, "byte p{c};");
        if c % 2 == 1 {
            let _ = writeln!(text, "bit r{};", c.div_ceil(2));
        }
    }
    (1..=count).for_each(|c| _ = writeln!(text, "bit t{c};"));
    let _ = writeln!(text, "active proctype cells() {{\n  do");
    let rise = |c: usize, r: usize| {
        format!(
            "if :: p{c} == 1 -> p{c} = 2; r{r} = 1 :: p{c} == 3 -> p{c} = 4; r{r} = 0 :: p{c} == 4 -> p{c} = 0 :: else -> p{c}++ fi"
        )
    };
    if one {
        for c in 1..=count {
            let r = c.div_ceil(2);
            let _ = writeln!(text, "  :: d_step {{ !(p{c} == 1 && r{r}) -> {} }}", rise(c, r));
        }
    } else {
        let _ = writeln!(text, "  :: atomic {{");
        for c in 1..=count {
            let r = c.div_ceil(2);
            // Judged before any moves: the first of a pair takes the resource.
            let first = if c % 2 == 0 {
                format!(" || (p{c} == 1 && p{0} == 1 && t{0})", c - 1)
            } else {
                String::new()
            };
            let _ = writeln!(text, "    if :: t{c} = 0 :: !((p{c} == 1 && r{r}){first}) -> t{c} = 1 fi;");
        }
        let _ = writeln!(text, "    d_step {{");
        for c in 1..=count {
            let _ = writeln!(
                text,
                "      if :: t{c} -> {}; t{c} = 0 :: else -> skip fi;",
                rise(c, c.div_ceil(2))
            );
        }
        let _ = writeln!(text, "      skip }} }}");
    }
    let held = |c: usize| format!("(p{c} == 2 || p{c} == 3)");
    let pairs: Vec<String> =
        (1..count).step_by(2).map(|c| format!("!({} && {})", held(c), held(c + 1))).collect();
    let _ =
        writeln!(text, "  od\n}}\nactive proctype watch() {{ !({}) -> assert(false) }}", pairs.join(" && "));
    text
}

/// The cells as a model of LTSmin in its format ETF, of which a step moves one cell.
pub fn etf(count: usize) -> String {
    let pairs = count / 2;
    let list = |of: &dyn Fn(usize) -> String, n: usize| (1..=n).map(of).collect::<Vec<_>>().join(" ");
    let names = [list(&|c| format!("p{c}:cell"), count), list(&|r| format!("r{r}:held"), pairs)].join(" ");
    let mut text = format!("begin state\n{names}\nend state\nbegin edge\nend edge\n");
    let _ = writeln!(text, "begin init\n{}\nend init", list(&|_| "0".to_owned(), count + pairs));
    for c in 1..=count {
        for (from, to, held) in [(0, 1, "*"), (1, 2, "0/1"), (2, 3, "*"), (3, 4, "1/0"), (4, 0, "*")] {
            let cell = |k| if k == c { format!("{from}/{to}") } else { "*".to_owned() };
            let pair = |r| if r == c.div_ceil(2) { held } else { "*" }.to_owned();
            let _ = writeln!(text, "begin trans\n{} {}\nend trans", list(&cell, count), list(&pair, pairs));
        }
    }
    text
}
