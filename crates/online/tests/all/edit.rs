//! Changes of an io file: what is changed is changed, and the rest stays to the byte.

use g7_model::FileId;
use g7_online::setup::{Change, Plain, edit, read};

const FILE: &str = "\
# The mixer of hall 3.   Ask before you change it.
[controller]
period   =   '10ms'     # fast

[devices.line1]   # the left module
kind = \"modbus-tcp\"
host = \"10.0.0.7\"  # by the door
poll = \"10ms\"


# the right one
[devices.line2]
kind = \"modbus-tcp\"
host = \"10.0.0.8\"

[inputs]
start = \"line1.discrete(0)\"     # green button
# the level, in m
level = { at = \"line1.input(4)\",   as = \"f32\" }
\"%I0.3\" = \"line2.discrete(3)\"

[outputs]
valve = \"line1.coil(2)\"
";

fn path(text: &str) -> Vec<String> {
    text.split('/').map(str::to_owned).collect()
}

fn set(at: &str, value: Plain) -> Change {
    Change::Set(path(at), value)
}

fn text(text: &str) -> Plain {
    Plain::Text(text.to_owned())
}

/// The file after one change, which must be the file with one text in place of another.
fn changed(change: Change, from: &str, to: &str) {
    assert_eq!(FILE.matches(from).count(), 1, "{from}");
    for (file, end) in [(FILE.to_owned(), "\n"), (FILE.replace('\n', "\r\n"), "\r\n")] {
        let with = |text: &str| text.replace('\n', end);
        let expected = file.replace(&with(from), &with(to));
        let got = edit(&file, std::slice::from_ref(&change)).expect("it can be changed");
        assert_eq!(got, expected);
        assert_eq!(read(&got, FileId(0)).1.len(), 0);
    }
}

#[test]
fn a_value_is_changed_where_it_stands() {
    changed(set("devices/line1/host", text("10.0.0.9")), "\"10.0.0.7\"", "\"10.0.0.9\"");
    changed(set("inputs/start", text("line2.coil(7)")), "\"line1.discrete(0)\"", "\"line2.coil(7)\"");
    changed(set("inputs/level/as", text("i32")), "\"f32\"", "\"i32\"");
    changed(set("controller/period", text("20ms")), "'10ms'", "\"20ms\"");
}

#[test]
fn a_key_is_added_and_taken_away() {
    changed(
        set("devices/line1/timeout", text("1s")),
        "poll = \"10ms\"\n",
        "poll = \"10ms\"\ntimeout = \"1s\"\n",
    );
    changed(Change::Remove(path("devices/line1/poll")), "poll = \"10ms\"\n", "");
    changed(Change::Remove(path("outputs/valve")), "valve = \"line1.coil(2)\"\n", "");
    changed(
        set("outputs/pump", text("line1.coil(3)")),
        "coil(2)\"\n",
        "coil(2)\"\npump = \"line1.coil(3)\"\n",
    );
    changed(set("inputs/level/scale", Plain::Number(0.5)), "as = \"f32\" }", "as = \"f32\" , scale = 0.5 }");
}

#[test]
fn a_point_becomes_a_table_when_it_is_told_more() {
    changed(
        set("outputs/valve/scale", Plain::Whole(2)),
        "\"line1.coil(2)\"",
        "{ at = \"line1.coil(2)\", scale = 2 }",
    );
}

#[test]
fn a_device_stands_behind_the_others_and_a_table_behind_all() {
    let rows = vec![("kind".to_owned(), text("panel"))];
    changed(
        set("devices/desk", Plain::Table(rows)),
        "host = \"10.0.0.8\"\n",
        "host = \"10.0.0.8\"\n\n[devices.desk]\nkind = \"panel\"\n",
    );
    changed(
        set("shown/X1", text("line1.good()")),
        "valve = \"line1.coil(2)\"\n",
        "valve = \"line1.coil(2)\"\n\n[shown]\nX1 = \"line1.good()\"\n",
    );
}

#[test]
fn a_device_is_renamed_with_all_that_names_it() {
    let got =
        edit(FILE, &[Change::Rename("line1".to_owned(), "left".to_owned())]).expect("it can be changed");
    assert_eq!(got, FILE.replace("line1", "left"));
    let taken = edit(FILE, &[Change::Rename("line1".to_owned(), "line2".to_owned())]);
    assert!(taken.is_err());
    assert!(edit(FILE, &[Change::Rename("line9".to_owned(), "left".to_owned())]).is_err());
}

#[test]
fn a_file_is_begun() {
    let rows = vec![("kind".to_owned(), text("modbus-tcp")), ("host".to_owned(), text("10.0.0.7"))];
    let got = edit(
        "",
        &[
            set("devices/line 1", Plain::Table(rows)),
            set("inputs/%I0.0", text("line 1.discrete(0)")),
            set(
                "outputs/speed",
                Plain::Table(vec![
                    ("at".to_owned(), text("line 1.holding(0)")),
                    ("scale".to_owned(), Plain::Number(0.1)),
                ]),
            ),
        ],
    )
    .expect("it can be begun");
    let (setup, problems) = read(&got, FileId(0));
    assert_eq!(problems.len(), 0, "{got}");
    assert_eq!((setup.devices.len(), setup.inputs.len(), setup.outputs.len()), (1, 1, 1), "{got}");
    assert!(got.starts_with("[devices.\"line 1\"]\nkind = "), "{got}");
}

#[test]
fn a_file_that_is_no_toml_is_left_as_it_is() {
    let wrong = edit("[inputs]\na = \"line1.coil(0)\nb = 1\n", &[set("inputs/c", text("line1.coil(1)"))]);
    assert!(wrong.is_err_and(|e| e.0.contains("line 2")));
    for at in ["other/a", "inputs", "inputs/a/b/c/d"] {
        assert!(edit(FILE, &[set(at, text("x"))]).is_err(), "{at}");
    }
    // A path through a value.
    assert!(edit(FILE, &[set("devices/line1/host/more", text("x"))]).is_err());
    // A setting that is not there is away already.
    assert_eq!(edit(FILE, &[Change::Remove(path("inputs/none"))]).as_deref(), Ok(FILE));
}

#[test]
fn random_files_never_panic_and_what_is_far_away_stays() {
    let changes = [
        set("devices/line1/host", text("x\ny\"z")),
        set("inputs/level/scale", Plain::Number(f64::NAN)),
        Change::Remove(path("devices/line1")),
        Change::Rename("line1".to_owned(), "l.1".to_owned()),
        set("devices/new", Plain::Table(Vec::new())),
    ];
    let mut seed = 11u64;
    let mut next = |below: usize| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) as usize % below
    };
    for _ in 0..300 {
        let mut bytes = FILE.as_bytes().to_vec();
        for _ in 0..next(4) {
            let at = next(bytes.len());
            match next(3) {
                0 => bytes[at] = b"[]{}\"'=.#\n\r x1"[next(13)],
                1 => drop(bytes.remove(at)),
                _ => bytes.insert(at, b"[]{}\"'=.#\n\r x1"[next(13)]),
            }
        }
        let file = String::from_utf8_lossy(&bytes).into_owned();
        for change in &changes {
            if let Ok(got) = edit(&file, std::slice::from_ref(change)) {
                assert!(got.parse::<toml_edit::DocumentMut>().is_ok(), "{file}\n---\n{got}");
            }
        }
    }
}
