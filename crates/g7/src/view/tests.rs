//! Tests the view without a terminal: keys in, characters out.

use clap::Parser;
use crossterm::event::{KeyCode, KeyEvent, KeyModifiers};
use ratatui::Terminal;
use ratatui::backend::TestBackend;

use super::app::App;
use super::{draw, keys};
use crate::cli::{Cli, Command};
use crate::sources::Source;
use g7_model::Nanos;
use g7_rig::{self as bench, Bench};

const CHART: &str = "\
input a : BOOL \"push button\"
input count : INT
input full : BOOL
output m : BOOL
var n : INT retain
chart G {
  initial step 1
  step 2
  step 3 {
    N m
    P1 n := n + 1
  }
  1 -> 2 when a
  2 -> 3 when a
  3 -> 1 when not a
}
plant P {
  state level : REAL := 0.0 in 0.0 .. 10.0
  rate level := 1.0 when m
  drive full := level > 5.0
}
";

fn bench(chart: &str) -> Bench {
    let source = Source::new("a.g7", chart.as_bytes().to_vec(), 0);
    let (bench, problems) = bench::build(&source, &bench::Options::default()).expect("one plant");
    bench.unwrap_or_else(|| panic!("{problems:?}"))
}

fn app<'b>(bench: &'b Bench, more: &[&str]) -> App<'b> {
    let cli = Cli::parse_from([&["g7", "run"][..], more].concat());
    let Command::Run(args) = cli.command else { panic!("run was asked for") };
    let mut app = App::new(bench, bench.runner(0), "a.g7", &args).expect("good arguments");
    app.pause(true);
    app
}

fn press(app: &mut App<'_>, keys: &str) {
    for c in keys.chars() {
        let code = match c {
            '\n' => KeyCode::Enter,
            '\t' => KeyCode::Tab,
            c => KeyCode::Char(c),
        };
        keys::press(app, KeyEvent::new(code, KeyModifiers::NONE));
    }
}

fn picture(app: &mut App<'_>, width: u16, height: u16) -> String {
    let mut terminal = Terminal::new(TestBackend::new(width, height)).expect("a test backend");
    terminal.draw(|frame| draw::draw(frame, app)).expect("it draws");
    let buffer = terminal.backend().buffer();
    let cell = |x, y| buffer.cell((x, y)).map_or(" ", |c| c.symbol());
    (0..height).map(|y| (0..width).map(|x| cell(x, y)).collect::<String>() + "\n").collect()
}

#[track_caller]
fn shows(app: &mut App<'_>, part: &str) {
    let picture = picture(app, 130, 30);
    assert!(picture.contains(part), "`{part}` in:\n{picture}");
}

#[test]
fn keys_turn_inputs_and_a_dot_makes_a_scan() {
    let bench = bench(CHART);
    let mut app = app(&bench, &[]);
    press(&mut app, ".");
    shows(&mut app, "■ 1");
    shows(&mut app, "[1] ○ a push button");
    press(&mut app, "1");
    shows(&mut app, "[1] ● a");
    shows(&mut app, "■ 1");
    press(&mut app, ".");
    shows(&mut app, "■ 3");
    shows(&mut app, "● m");
    shows(&mut app, "n = 1");
}

#[test]
fn a_comma_makes_a_pass_and_shows_the_situation_in_between() {
    let bench = bench(CHART);
    let mut app = app(&bench, &[]);
    press(&mut app, ".1,");
    shows(&mut app, "WITHIN A SCAN");
    shows(&mut app, "■ 2");
    press(&mut app, ",");
    shows(&mut app, "■ 3");
    press(&mut app, ",");
    shows(&mut app, "the scan is done");
    assert_eq!(app.runner.due(), Nanos::from_millis(20));
}

#[test]
fn values_are_typed_and_refused_with_a_reason() {
    let bench = bench(CHART);
    let mut app = app(&bench, &[]);
    press(&mut app, "2");
    shows(&mut app, "count := _");
    press(&mut app, "70000\n");
    shows(&mut app, "count := 70000_");
    shows(&mut app, "outside -32768 .. 32767");
    // The prompt stays: the next keys correct the value, and operate nothing.
    press(&mut app, "1.R");
    shows(&mut app, "count := 700001.R_   (Enter");
    shows(&mut app, "[1] ○ a");
    shows(&mut app, "scan 0");
    for _ in 0..9 {
        keys::press(&mut app, KeyEvent::new(KeyCode::Backspace, KeyModifiers::NONE));
    }
    press(&mut app, "-5\n.");
    shows(&mut app, "count = -5");
    press(&mut app, "2x\n");
    keys::press(&mut app, KeyEvent::new(KeyCode::Esc, KeyModifiers::NONE));
    assert!(!app.is_over() && app.edit.is_none(), "Esc leaves the prompt, not the view");
    press(&mut app, "1");
    shows(&mut app, "[1] ● a");
}

#[test]
fn what_the_plant_drives_is_held_when_turned_and_let_go_again() {
    let bench = bench(CHART);
    let mut app = app(&bench, &[]);
    shows(&mut app, "[3] ○ full plant");
    press(&mut app, "3.");
    shows(&mut app, "[3] ● full held");
    app.select(2);
    press(&mut app, "F.");
    shows(&mut app, "[3] ○ full plant");
}

#[test]
fn lists_are_gone_through_and_changed() {
    let bench = bench(CHART);
    let mut app = app(&bench, &[]);
    press(&mut app, ".\t\n");
    shows(&mut app, "● m held");
    press(&mut app, "\t\n5\n");
    shows(&mut app, "n = 5");
    press(&mut app, "\t\n2.5\n");
    shows(&mut app, "level = 2.5");
    press(&mut app, "F");
    shows(&mut app, "can be set (Enter), not held");
}

#[test]
fn the_terminal_has_the_system_bits_of_pl7() {
    let bench =
        bench("profile pl7\ninput a : BOOL\nchart G {\n  initial step 1\n  step 2\n  1 -> 2 when a\n}\n");
    let mut app = app(&bench, &[]);
    press(&mut app, ".1.1");
    shows(&mut app, "■ 2");
    shows(&mut app, "○ %S21");
    // Behind the inputs stand the variables: %S0 comes first, %S21 second.
    press(&mut app, "\t");
    app.select(1);
    press(&mut app, "\n");
    shows(&mut app, "● %S21");
    shows(&mut app, "■ 2");
    press(&mut app, ".");
    shows(&mut app, "■ 1");
    shows(&mut app, "○ %S21");
}

#[test]
fn a_restart_keeps_what_is_retained_and_a_cold_one_nothing() {
    let bench = bench(CHART);
    let mut app = app(&bench, &[]);
    press(&mut app, ".1..1.R.");
    shows(&mut app, "n = 1");
    press(&mut app, "C.");
    shows(&mut app, "n = 0");
}

#[test]
fn a_fault_is_shown_with_its_cycle_and_restarts() {
    let bench = bench("input a : BOOL\nchart G { initial step 1 step 2 1 -> 2 when a 2 -> 1 when a }");
    let mut app = app(&bench, &[]);
    press(&mut app, ".1.");
    shows(&mut app, " FAULT ");
    shows(&mut app, "unstable");
    press(&mut app, "1R.");
    shows(&mut app, "■ 1");
}

#[test]
fn a_script_and_an_end_work_as_headless() {
    let bench = bench(CHART);
    let mut app = app(&bench, &["--set", "a=1@20ms", "--for", "50ms"]);
    press(&mut app, "..");
    shows(&mut app, "■ 1");
    press(&mut app, ".");
    shows(&mut app, "■ 3");
    press(&mut app, "++++++ ");
    for _ in 0..200 {
        app.advance();
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    shows(&mut app, "50ms are over");
    assert_eq!(app.runner.state().now(), 50_000_000);
}

#[test]
fn the_chronogram_follows_goes_back_and_zooms() {
    let bench = bench(CHART);
    let mut app = app(&bench, &[]);
    press(&mut app, ".1.1.");
    shows(&mut app, "Chronogram");
    shows(&mut app, "╳");
    press(&mut app, "[[[[[[[");
    assert_eq!(app.span(), Nanos::from_millis(100));
    for _ in 0..50 {
        press(&mut app, ".");
    }
    app.move_time(-4);
    shows(&mut app, "100ms ago");
    app.move_time(9);
    assert_eq!(app.back, Nanos::ZERO);
}

const PARTS: &str = "\
input a : BOOL \"a very long comment that goes on and on and on to the end of the world and back\"
output m : BOOL
var n : INT
chart G {
  initial step Wait
  macro M = D
  Wait -> M when a -> Wait when not a
}
macrochart D {
  entry step E \"dosing, with a comment that is a good deal longer than the panel\" {
    N m
    P1 n := n + 1
  }
  exit step S
  E -> S when E.t > 1s
}
plant P {
  parts One(kind : INT) max 4 := (7), (8)
  parts Belt(kind : INT, big : BOOL) max 3 length 1.0
  parts Rail() max 2 length 1.0
  state x : REAL := 0.0
  rate x := 1.0 when m
  on m {
    Belt.enter(5, TRUE)
    Rail.enter()
    One.enter(9)
    One.enter(3)
    One.enter(4)
  }
}
";

#[test]
fn a_queue_of_parts_is_one_line_without_the_places_that_are_empty() {
    let bench = bench(PARTS);
    let mut app = app(&bench, &[]);
    press(&mut app, ".");
    for part in ["│One  2: 7 8", "│Belt  0 ", "│Rail  0 "] {
        shows(&mut app, part);
    }
    let picture = picture(&mut app, 130, 30);
    assert!(!picture.contains("One.") && !picture.contains("Belt."), "no line a cell:\n{picture}");
    press(&mut app, "1...");
    for part in ["│One  4: 7 8 9 3 (1 lost)", "│Belt  1: 5/1@0 ", "│Rail  1: 0 "] {
        shows(&mut app, part);
    }
}

#[test]
fn the_chronogram_begins_with_what_comes_in_and_goes_out() {
    let bench = bench(PARTS);
    let mut app = app(&bench, &[]);
    press(&mut app, ".1.1..");
    let picture = picture(&mut app, 130, 40);
    let chronogram = picture.split("Chronogram").nth(1).expect("it is drawn");
    let lanes: Vec<&str> = chronogram
        .lines()
        .filter_map(|l| l.trim_start_matches('│').split_whitespace().next())
        .filter(|w| w.starts_with(char::is_alphabetic))
        .collect();
    assert_eq!(lanes[..5], ["a", "m", "n", "Wait.X", "M.X"], "{picture}");
    assert_eq!(lanes.last(), Some(&"M.E.X"), "{picture}");
}

#[test]
fn names_and_times_are_seen_whole_and_comments_go_first() {
    let bench = bench(PARTS);
    for (width, lists) in [(80, 3), (130, 5), (200, 5)] {
        let mut app = app(&bench, &[]);
        press(&mut app, ".1");
        for _ in 0..7 {
            press(&mut app, "..........");
        }
        let picture = picture(&mut app, width, 30);
        assert!(picture.contains("■ M.E 690ms dosing"), "{picture}");
        let top = picture.lines().nth(1).expect("a line of titles");
        let widths: Vec<usize> = top.split('┐').map(|p| p.chars().count()).filter(|w| *w > 0).collect();
        assert!(widths.len() >= lists, "{widths:?}\n{picture}");
        assert!(widths[1..].iter().all(|w| *w < widths[0]), "{widths:?}\n{picture}");
    }
}

#[test]
fn any_size_of_window_can_be_drawn() {
    let bench = bench(CHART);
    let mut app = app(&bench, &[]);
    press(&mut app, ".1.?");
    for width in [0, 1, 5, 23, 24, 39, 40, 80, 300] {
        for height in [0, 1, 3, 5, 6, 7, 10, 40, 100] {
            for help in [false, true] {
                app.help = help;
                picture(&mut app, width, height);
            }
        }
    }
}

#[test]
fn any_key_in_any_order_does_no_harm() {
    let bench = bench(CHART);
    let mut app = app(&bench, &[]);
    let codes = [
        KeyCode::Enter,
        KeyCode::Backspace,
        KeyCode::Up,
        KeyCode::Down,
        KeyCode::PageDown,
        KeyCode::Left,
        KeyCode::End,
        KeyCode::BackTab,
        KeyCode::Char('F'),
        KeyCode::Char('9'),
        KeyCode::Char('2'),
        KeyCode::Char('ø'),
        KeyCode::Char(','),
        KeyCode::Char('R'),
        KeyCode::F(1),
        KeyCode::Delete,
    ];
    let mut chance = 1u32;
    for _ in 0..3000 {
        chance = chance.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let code = codes[(chance >> 16) as usize % codes.len()];
        keys::press(&mut app, KeyEvent::new(code, KeyModifiers::NONE));
    }
    picture(&mut app, 100, 30);
    keys::press(&mut app, KeyEvent::new(KeyCode::Char('c'), KeyModifiers::CONTROL));
    assert!(app.is_over());
}

#[test]
fn eighty_columns_show_keys_and_plant() {
    let bench = bench(include_str!("../new/chart.g7"));
    let mut app = app(&bench, &[]);
    press(&mut app, "..");
    let shown = picture(&mut app, 80, 24);
    let last = shown.lines().last().expect("a line").trim_end();
    for part in ["1-9 a-z inputs", "Space run/pause", "? help", "q quit"] {
        assert!(last.contains(part), "{part}: {shown}");
    }
    for part in
        ["Steps", "Inputs", "Outputs", "Variables", "Plant", "level = 0", "[1] ○ start", "fill", "Chronogram"]
    {
        assert!(shown.contains(part), "{part}: {shown}");
    }
    let wide = picture(&mut app, 120, 30);
    assert!(
        wide.lines().last().is_some_and(|l| l.contains(", pass  + - speed") && l.contains("F hold")),
        "{wide}"
    );
}

#[test]
fn a_narrow_list_cuts_names_and_shows_values() {
    let long = "var time_until_the_next_release : INT := 1234\nvar level_of_the_second_tank : INT := -77\n\
                input a_long_name_of_an_input, another_long_name_of_one : INT\noutput valve_of_the_tank : BOOL\n";
    let bench = bench(&format!("{long}{}", CHART.replace("var n", "var m2, n")));
    let mut app = app(&bench, &[]);
    press(&mut app, ".");
    let shown = picture(&mut app, 80, 24);
    for value in ["… = 1234", "… = -77"] {
        assert!(shown.contains(value), "{shown}");
    }
}
