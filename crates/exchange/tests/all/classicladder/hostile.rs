//! Projects made to break the reader.

use crate::support::hostile::{changed, refused, survives};
use crate::support::own;
use crate::support::recognise;

const FORMAT: &str = "classicladder";

#[test]
fn what_is_no_project_is_refused_with_words() {
    assert_eq!(refused(FORMAT, b"hello"), ["G0602"]);
    assert_eq!(refused(FORMAT, &vec![b'_'; 9 << 20]), ["G0008"]);
    assert_eq!(refused(FORMAT, b"_FILES_CLASSICLADDER\n\xE9"), ["G0001"]);
    assert_eq!(refused(FORMAT, "_FILES_CLASSICLADDER\n".repeat(300_000).as_bytes()), ["G0008"]);
    assert_eq!(recognise("", b"S0,1,0,0,1,1\n"), Some(FORMAT));
    assert_eq!(recognise("", b"Sum,1\n"), None);
}

#[test]
fn circles_and_depth_come_to_an_end() {
    let project = |inside: &str| format!("_FILES_CLASSICLADDER\n{inside}_/FILES_CLASSICLADDER\n");
    let sections = "_FILE-sections.csv\n000,0,-1,0,9,0\n001,0,3,1,1,0\n002,1,-1,0,0,0\n_/FILE-sections.csv\n\
                    _FILE-sequential.csv\nS0,1,0,0,1,1\n_/FILE-sequential.csv\n";
    // Rungs in a circle, and a sub-routine that calls itself.
    let circle = "_FILE-rung_0.csv\n#NEXTRUNG=0\n9-0-0/0,55-0-0/3\n_/FILE-rung_0.csv\n\
                  _FILE-rung_1.csv\n9-0-0/0,55-0-0/3\n_/FILE-rung_1.csv\n";
    let (_, problems) = survives(FORMAT, project(&format!("{circle}{sections}")).as_bytes());
    assert!(problems.iter().any(|p| p.what.contains("go round in a circle")), "{problems:?}");
    assert!(problems.iter().any(|p| p.what.contains("calls itself")), "{problems:?}");
    // Each sub-routine calls the next one eight times: written out, they would fill the world.
    let mut calls = String::from("_FILE-sections.csv\n000,0,-1,0,0,0\n");
    for n in 1..30 {
        calls += &format!("{n:03},0,{n},{n},{n},0\n");
    }
    calls += "_/FILE-sections.csv\n";
    for n in 0..29 {
        let row = format!("9-0-0/0,55-0-0/{}\n", n + 1);
        calls += &format!("_FILE-rung_{n}.csv\n{}_/FILE-rung_{n}.csv\n", row.repeat(8));
    }
    let (_, problems) = survives(FORMAT, project(&calls).as_bytes());
    assert!(problems.iter().any(|p| p.code.id == "G0008"), "{problems:?}");
    // Brackets without end.
    let deep = format!(
        "_FILE-arithmetic_expressions.csv\n@200/0@:={}1\n_/FILE-arithmetic_expressions.csv\n",
        "(".repeat(900)
    );
    let rung = "_FILE-rung_0.csv\n9-0-0/0,9-0-0/0,9-0-0/0,60-0-0/0\n_/FILE-rung_0.csv\n_FILE-sections.csv\n000,0,-1,0,0,0\n_/FILE-sections.csv\n";
    let (_, problems) = survives(FORMAT, project(&format!("{deep}{rung}")).as_bytes());
    assert!(problems.iter().any(|p| p.what.contains("nested too deeply")), "{problems:?}");
    // A rung whose power would double in each column.
    let row = |n: usize| format!("1-0-50/{n}{}\n", ",1-1-50/9".repeat(40));
    let rows: String = (0..40).map(row).collect();
    let wide = format!(
        "_FILE-rung_0.csv\n{rows}_/FILE-rung_0.csv\n_FILE-sections.csv\n000,0,-1,0,0,0\n_/FILE-sections.csv\n"
    );
    survives(FORMAT, project(&wide).as_bytes());
}

#[test]
fn a_changed_file_never_panics() {
    let files = ["press.clprj", "choices.csv", "jumps.clp", "tables.clprj", "wrong.clprj"]
        .map(|f| own("classicladder", f));
    let words = [
        "-1",
        "99",
        "9",
        "54-0-0/1",
        "55-0-0/5",
        "12-0-0/0",
        "10-0-0/0",
        "@200/0@",
        "[200/1]",
        "(",
        ":=",
        "=",
        "<",
        "99999999999999999999",
        "-9223372036854775808",
        ",",
        "\n",
        "_FILE-",
        "_/FILE-",
        "#VER=2.0",
        "\u{feff}",
        "é",
    ];
    changed(FORMAT, files.to_vec(), &words, 400);
}
