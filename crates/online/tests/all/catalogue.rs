//! The catalogue of an io file, held against the reader: keys, limits, words and defaults.

use g7_model::{FileId, Problem};
use g7_online::setup::catalogue::{Argument, CONTROLLER, Form, KINDS, KindRow, Point, Setting, Usual};
use g7_online::setup::{Kind, Setup, read, read_point};

fn problems(text: &str) -> Vec<String> {
    read(text, FileId(0)).1.into_iter().map(|Problem { what, .. }| what.to_string()).collect()
}

/// A value as the file writes it.
fn quoted(form: Form, text: &str) -> String {
    match form {
        Form::Text | Form::Duration(..) | Form::Words(_) if !text.starts_with('"') => format!("\"{text}\""),
        _ => text.to_owned(),
    }
}

/// The value of a setting that a file may have.
fn fitting(setting: &Setting) -> String {
    let (Usual::Needed(text) | Usual::Is(text) | Usual::None(text)) = setting.usual;
    match setting.form {
        Form::Table(settings) | Form::FlagOrTable(settings) => {
            let rows: Vec<String> = settings.iter().map(|s| format!("{} = {}", s.key, fitting(s))).collect();
            format!("{{ {} }}", rows.join(", "))
        }
        form => quoted(form, text),
    }
}

/// Values just within and just beyond the limits of a setting.
fn limits(form: Form) -> (Vec<String>, Vec<String>) {
    match form {
        Form::Whole(least, most) => (
            vec![least.to_string(), most.to_string()],
            vec![(least - 1).to_string(), (most + 1).to_string(), "\"1\"".to_owned()],
        ),
        Form::Duration(least, most) => {
            let beyond = |text: &str, by: i64| {
                let time = g7_rig::values::duration(text).expect("a duration").count() + by;
                format!("\"{time}ns\"")
            };
            (
                vec![format!("\"{least}\""), format!("\"{most}\"")],
                vec![beyond(least, -1), beyond(most, 1), "5".to_owned()],
            )
        }
        Form::Words(words) => {
            (words.iter().map(|word| format!("\"{word}\"")).collect(), vec!["\"other\"".to_owned()])
        }
        Form::Flag => (vec!["true".to_owned(), "false".to_owned()], vec!["1".to_owned()]),
        Form::Number => (vec!["2".to_owned(), "-0.5".to_owned()], vec!["\"2\"".to_owned(), "nan".to_owned()]),
        Form::Bad => (
            vec!["\"hold\"".to_owned(), "\"fault\"".to_owned(), "2.5".to_owned(), "true".to_owned()],
            vec!["\"other\"".to_owned()],
        ),
        Form::Text => (Vec::new(), vec!["5".to_owned()]),
        Form::Table(settings) => {
            let text = settings.first().filter(|s| s.key == "topic").map(fitting);
            (text.into_iter().collect(), vec!["5".to_owned()])
        }
        Form::FlagOrTable(_) => {
            (vec!["true".to_owned(), "false".to_owned()], vec!["5".to_owned(), "\"true\"".to_owned()])
        }
    }
}

/// The keys that the reader asks for, as it names them when it meets another one.
fn asked(text: &str) -> Vec<String> {
    let (_, problems) = read(text, FileId(0));
    let help = problems.into_iter().find(|p| p.what.contains("`no-such-key`")).and_then(|p| p.help);
    let help = help.unwrap_or_else(|| panic!("the reader takes `no-such-key`: {text}"));
    let mut keys: Vec<String> =
        help.split('`').skip(1).step_by(2).map(str::to_owned).filter(|k| k != "kind" && k != "at").collect();
    keys.sort();
    keys
}

fn keys(settings: &[&[Setting]]) -> Vec<String> {
    let mut keys: Vec<String> = settings.concat().iter().map(|s| s.key.to_owned()).collect();
    keys.sort();
    keys.dedup();
    keys
}

/// A device with what it needs and some lines more.
fn device(kind: &KindRow, without: &str, more: &str) -> String {
    let needed = kind.settings.concat();
    let needed = needed.iter().filter(|s| matches!(s.usual, Usual::Needed(_)) && s.key != without);
    let rows: Vec<String> = needed.map(|s| format!("{} = {}\n", s.key, fitting(s))).collect();
    format!("[devices.a]\nkind = \"{}\"\n{}{more}\n", kind.word, rows.concat())
}

fn plain(setup: &Setup) -> Vec<String> {
    setup.devices.iter().map(|d| format!("{:?} {:?}", d.kind, d.timing)).map(without_places).collect()
}

/// Without the places of values, which differ with the length of the file.
fn without_places(text: String) -> String {
    let mut parts = text.split("Span {");
    let first = parts.next().unwrap_or("").to_owned();
    parts.fold(first, |all, part| all + part.split_once('}').map_or("", |(_, rest)| rest))
}

#[test]
fn each_kind_has_a_row_and_each_row_a_kind() {
    let rows: Vec<&str> = KINDS.iter().map(|kind| kind.word).collect();
    assert_eq!(rows, Kind::WORDS);
}

#[test]
fn the_settings_of_a_device_are_those_that_the_reader_asks_for() {
    for kind in KINDS {
        assert_eq!(problems(&device(kind, "", "")), [""; 0], "{}", kind.word);
        assert_eq!(asked(&device(kind, "", "no-such-key = 1")), keys(kind.settings), "{}", kind.word);
    }
    let keys: Vec<String> = keys(&[CONTROLLER]);
    assert_eq!(asked("[controller]\nno-such-key = 1\n"), keys);
}

/// True for a password without its user, or a user without a password: each row stands alone here.
fn is_half(problem: &str) -> bool {
    problem.contains("without a `user`") || problem.contains("user without a password")
}

#[test]
fn a_setting_has_the_limits_the_words_and_the_default_of_its_row() {
    for kind in KINDS {
        let bare = read(&device(kind, "", ""), FileId(0)).0;
        for setting in kind.settings.concat() {
            let with = |value: &str| device(kind, setting.key, &format!("{} = {value}", setting.key));
            let (within, beyond) = limits(setting.form);
            for value in within.iter().chain([&fitting(&setting)]) {
                let wrong: Vec<String> = problems(&with(value)).into_iter().filter(|p| !is_half(p)).collect();
                assert_eq!(wrong, [""; 0], "{} {} = {value}", kind.word, setting.key);
            }
            for value in &beyond {
                let wrong = problems(&with(value));
                assert!(!wrong.is_empty(), "{} takes {} = {value}", kind.word, setting.key);
            }
            match setting.usual {
                Usual::Is(usual) => {
                    let same = plain(&read(&with(usual), FileId(0)).0);
                    assert_eq!(same, plain(&bare), "{} {} is {usual}", kind.word, setting.key);
                }
                Usual::Needed(_) => {
                    let wrong = problems(&device(kind, setting.key, ""));
                    assert!(wrong.iter().any(|p| p.contains(setting.key)), "{}: {wrong:?}", setting.key);
                }
                Usual::None(_) => {}
            }
        }
    }
    for setting in CONTROLLER {
        // A setting of the log needs a log.
        let log = if setting.key.starts_with("log-") { "log = 'a.log'\n" } else { "" };
        let with = |value: &str| format!("[controller]\n{log}{} = {value}\n", setting.key);
        let (within, beyond) = limits(setting.form);
        for value in within.iter().chain([&fitting(setting)]) {
            assert_eq!(problems(&with(value)), [""; 0], "{} = {value}", setting.key);
        }
        assert!(beyond.iter().all(|value| !problems(&with(value)).is_empty()), "{}", setting.key);
    }
}

/// A point as a file writes it.
fn example(point: &Point) -> String {
    let argument = match point.argument {
        Argument::Nothing => String::new(),
        Argument::Address(most) => most.to_string(),
        Argument::Bit(most) => format!("{most}.15"),
        Argument::Text(text) | Argument::TextOrName(text) | Argument::List(text) | Argument::Alone(text) => {
            text.to_owned()
        }
        Argument::Word(words) => words.last().copied().unwrap_or("").to_owned(),
    };
    if matches!(point.argument, Argument::Alone(_)) {
        argument
    } else {
        format!("{}({argument})", point.word)
    }
}

#[test]
fn each_point_is_read_and_no_channel_says_what_has_no_row() {
    let mut of_input: Vec<String> = Vec::new();
    let mut of_output: Vec<String> = Vec::new();
    for point in KINDS.iter().flat_map(|kind| kind.points) {
        let text = example(point);
        assert!(read_point(&text).is_ok(), "{text}: {:?}", read_point(&text));
        assert!(read_point(&text.replace("65535", "65536")).is_err() == text.contains("65535"), "{text}");
        of_input.extend(keys(point.of_input));
        of_output.extend(keys(point.of_output));
        for (table, settings) in [("inputs", point.of_input), ("outputs", point.of_output)] {
            for setting in settings.concat() {
                let file = |value: &str| {
                    format!("[{table}]\nx = {{ at = \"a.{text}\", {} = {value} }}\n", setting.key)
                };
                let (within, beyond) = limits(setting.form);
                for value in within.iter().chain([&fitting(&setting)]) {
                    assert_eq!(problems(&file(value)), [""; 0], "{}", file(value));
                }
                for value in &beyond {
                    assert!(!problems(&file(value)).is_empty(), "{}", file(value));
                }
            }
        }
    }
    for (table, mut keys) in [("inputs", of_input), ("outputs", of_output)] {
        keys.sort();
        keys.dedup();
        let text = format!("[{table}]\nx = {{ at = \"a.coil(0)\", no-such-key = 1 }}\n");
        assert_eq!(asked(&text), keys, "{table}");
    }
}
