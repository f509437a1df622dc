//! A construct that cannot be carried over is reported, with its line.

use crate::support;
use crate::support::recognise;
use g7_model::{FileId, Severity};

use crate::jgrafchart::show::{actions, bytes, chart, import, problems, step, transitions};

#[test]
fn what_is_not_carried_over_is_reported_where_it_stands() {
    let (document, found) = import("not-carried.xml");
    assert_eq!(
        problems(&bytes("not-carried.xml"), &found),
        [
            "G0604 3: `list` is a `IntegerList`, which is not carried over",
            "G0605 3: an abortive action runs only when an exception transition fires; none does here, and it is left out",
            "G0608 3: `sqrt` is a function or method that is not known here",
            "G0608 3: `list.add` is a function or method that is not known here",
            "G0605 6: a `IntegerList` is left out; each use of it is reported",
            "G0614 7: a `SocketBooleanIn` becomes an input with its identifier as channel; the socket is not there",
            "G0605 8: a `GCRectangle` is drawing only and left out (2 of them)",
            "G0605 10: a `SFCPlotter` is drawing only and left out",
            "G0605 11: a `AssignmentButton` is left out: nothing is set by a click on it",
            "G0604 12: a step fusion set, whose steps are one step, is not carried over: `M` is more than a plain step",
            "G0603 13: `HoloDeck` is no element of a chart that is known here",
            "G0605 14: a procedure that no step calls is left out",
            "G0604 15: a `ProcessStep` starts a procedure and does not wait for it, any number of times; it is read as a step that starts none",
            "G0604 30: a `ProcedureStep` calls `which`, which is the name of no procedure; it is read as a step that calls none",
            "G0604 38: a line to the history port of a macro-step; resuming it is not carried over",
        ]
    );
    // The second rectangle has its place too.
    assert!(found.iter().any(|p| p.related.len() == 1 && p.what.contains("GCRectangle")));
    // Unknown elements are kept as notes.
    assert!(document.notes.iter().any(|n| n.text.contains("<HoloDeck name=\"new\" depth=\"3\"/>")));
    // The rest is there: a lost line leaves no invented source or sink behind it unsaid.
    assert_eq!(
        transitions(chart(&document, "Rest")),
        [
            "a -> b when far",
            "b -> M when TRUE",
            "M -> c when (v = 1)",
            "c ->  when TRUE",
            "M -> a when (M.out.x and not M_abort)",
        ]
    );
}

/// In chart Branches `b` and `c` run side by side; `a` does not, but a chart with parallel branches
/// is not looked into. In chart Turns one step follows the other, but
/// the macro-step is active while the steps in it are. Charts run beside each other.
#[test]
fn an_output_of_two_steps_that_may_be_active_together_is_told() {
    let (_, found) = import("together.xml");
    let rest = "JGrafchart 2.6.1 sets it FALSE when one of the steps ends, here it stays TRUE as long as one of \
                them is active";
    assert_eq!(
        problems(&bytes("together.xml"), &found),
        [
            format!("G0614 8: `lamp` is also driven by `N` of step `a`: {rest}"),
            format!("G0614 9: `horn` is also driven by `N` of step `b`: {rest}"),
            format!("G0614 30: `light` is also driven by `N` of step `third`: {rest}"),
            format!("G0614 48: `pump` is also driven by `N` of step `second`: {rest}"),
        ]
    );
}

#[test]
fn mistakes_of_the_author_have_their_line() {
    let (document, found) = import("wrong.xml");
    assert_eq!(
        problems(&bytes("wrong.xml"), &found),
        [
            "G0612 2: `threadSpeed` is `soon`, which is no number that fits here",
            "G0606 3: `=` was expected, not `1`",
            "G0606 3: a name, a number or `(` was expected, not `S`",
            "G0606 3: `S`, `P`, `X`, `N` or `A` and then a name was expected, not `v`",
            "G0606 3: `same.x` cannot be written",
            "G0611 4: a second step is called `same`; it is renamed",
            "G0606 4: `N` needs a Boolean; `v` is of type DINT",
            "G0607 4: `nobody` is the name of nothing in the file",
            "G0607 4: `other.thing` is the name of nothing in the file",
            "G0611 5: a back-tick or line end in the name `third's` is written otherwise",
            "G0609 6: a second element has the id `s2`; lines lead to the first",
            "G0612 7: `zero` is no value of type DINT",
            "G0615 8: `v` is declared twice in one workspace",
            "G0606 9: `)` was expected, not the end",
            "G0612 9: `priority` is `first`, which is no number that fits here",
            "G0610 10: a transition without a step behind it",
            "G0606 10: a transition without a condition",
            "G0610 11: a transition without any step",
            "G0610 12: a transition without a step behind it",
            "G0613 13: a macro-step without a workspace inside",
            "G0613 14: the macro-step `noway` has no enter step",
            "G0614 14: the macro-step `noway` has no exit step; it gets one that is never reached",
            "G0614 15: an enter step outside a macro-step; it is a plain step",
            "G0609 16: a line from step `same` to step `same_2` without a transition between",
            "G0610 19: a line leads to `gone`, which is nothing in this workspace",
            "G0610 20: a line comes from ``, which is nothing in this workspace",
            "G0609 21: a line from a transition to a transition without a step between",
        ]
    );
    let warnings = found.iter().filter(|p| p.severity() == Severity::Warning).count();
    assert_eq!(warnings, 9);
    // The readable part is there.
    assert_eq!(actions(step(&document, "Wrong", "same")), ["P1 v := 2", "P1 v := 3"]);
}

/// The bytes under a problem.
fn underlined<'a>(text: &'a str, what: &str) -> &'a str {
    let (_, found) = support::import("jgrafchart", text.as_bytes(), FileId(7));
    let problem = found.iter().find(|p| p.what.contains(what)).unwrap_or_else(|| panic!("{found:?}"));
    assert_eq!(problem.at.file, FileId(7));
    &text[problem.at.start as usize..problem.at.end as usize]
}

#[test]
fn a_place_in_a_text_is_the_place_in_the_file() {
    let with = |actions: &str| {
        format!("<GCDocument name='J'><GCInitialStep id='a' name='å' actionText='{actions}'/></GCDocument>")
    };
    // Entities before and within the word are longer in the file than in the text.
    assert_eq!(underlined(&with("S a&#10;= 1 &lt; ø2;"), "`ø2`"), "ø2");
    assert_eq!(underlined(&with("S no.&#x62;ody = 1"), "`no.body`"), "no.&#x62;ody");
    assert_eq!(underlined(&with("S \u{1D11E}"), "expected"), "\u{1D11E}");
}

#[test]
fn a_file_of_another_sort_is_refused() {
    for (file, what) in [
        ("<Project/>", "G0602 1: the first element is `Project`; JGrafchart's is `GCDocument`"),
        ("", "G0601 1: not well-formed XML: the document does not have a root node"),
        ("step 1 { }", "G0601 1: not well-formed XML: unknown token"),
    ] {
        let (document, found) = support::import("jgrafchart", file.as_bytes(), FileId(0));
        assert_eq!(problems(file.as_bytes(), &found), [what]);
        assert_eq!(document.charts().count(), 0);
        assert_ne!(recognise("", file.as_bytes()), Some("jgrafchart"));
    }
}

#[test]
fn charts_are_told_by_their_first_element() {
    for name in ["bead-sorter.xml", "workspaces.xml", "lines.xml"] {
        assert_eq!(recognise("", &bytes(name)), Some("jgrafchart"), "{name}");
    }
    let marked = b"\xEF\xBB\xBF<?xml version='1.0'?><!-- <x> --> <GCDocument>";
    assert_eq!(recognise("", marked), Some("jgrafchart"));
    assert_eq!(recognise("", b"<GCDocument"), Some("jgrafchart"));
    assert_ne!(recognise("", b"<GCDocumentation/>"), Some("jgrafchart"));
    assert_ne!(recognise("", b"<!-- <GCDocument> -->"), Some("jgrafchart"));
    assert_ne!(recognise("", b"chart G { } // <GCDocument"), Some("jgrafchart"));
}
