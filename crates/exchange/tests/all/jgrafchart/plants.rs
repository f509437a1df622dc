//! Whole charts: structure, names, scopes, positions.

use crate::support;
use g7_model::{ChartKind, Item, Placed, ProfileName, StepKind};

use crate::jgrafchart::show::{actions, bytes, chart, import, problems, step, transitions, var, vars};

#[test]
fn the_bead_sorter_comes_over_whole() {
    let (document, found) = import("bead-sorter.xml");
    assert_eq!(document.profile().map(|p| p.name), Some(ProfileName::Jgrafchart));
    let scan = document.cycle();
    assert_eq!(scan, Some(g7_model::Nanos::from_millis(10)));
    assert_eq!(
        vars(&document),
        [
            // Inverted logic: rests at 1 with nothing on its channel.
            "output Sol1 BOOL := TRUE at 30 inverted",
            "output Sol2 BOOL := TRUE at 31 inverted",
            "output Sol3 BOOL := TRUE at 32 inverted",
            "output Sol4 BOOL := TRUE at 33 inverted",
            "output ResetBead BOOL at 35",
            "output ResetColour BOOL at 36",
            "output LED BOOL at 37",
            "input Tilt BOOL at 30",
            "input AnalogBead REAL at 32",
            "input Col REAL at 33",
            "var SeqReleaseTime DINT := 20",
            "var SeqWaitTime DINT := 100",
            // No initial value: kept when the application stops, here as last saved.
            "var Tries DINT := 3 retain",
            "var Bead BOOL := FALSE",
            "var Colour BOOL := FALSE",
        ]
    );
    let top = chart(&document, "BeadSorter");
    assert_eq!(top.kind, ChartKind::Chart);
    let layout = document.items.iter().find_map(|i| if let Item::Layout(l) = i { Some(l) } else { None });
    let text = Placed::Comment("Select beads in turn,\nthen sort them back".into());
    let at = layout.and_then(|l| l.places.iter().find(|p| p.what == text)).map(|p| (p.x, p.y));
    assert_eq!(at, Some((300, 6000)));
    assert_eq!(
        transitions(top),
        ["Start -> Sequencing, BeadLogic when TRUE", "Sequencing, BeadLogic -> Start when Tilt"]
    );
    let sequencing = step(&document, "BeadSorter", "Sequencing");
    assert!(matches!(&sequencing.kind, StepKind::Macro(name) if &*name.text == "Sequencing"));
    assert_eq!(actions(sequencing), ["P1 LED := FALSE", "P0 LED := TRUE"]);
    assert!(step(&document, "BeadSorter", "Start").initial);
    let inner = chart(&document, "Sequencing");
    assert_eq!(inner.kind, ChartKind::Expansion);
    assert_eq!(step(&document, "Sequencing", "S1").kind, StepKind::Entry);
    assert_eq!(step(&document, "Sequencing", "S2").kind, StepKind::Exit);
    assert_eq!(
        transitions(inner),
        [
            "S1 -> Release when not Tilt",
            "Release -> Wait when (Release.t >= SeqReleaseTime)",
            "Wait -> S2 when Bead priority 1",
            "Wait -> Again when ((Wait.t > SeqWaitTime) and (Tries < 5)) priority 2",
            "Again -> Release when TRUE",
        ]
        .map(|line| line
            .replace("INT_TO_DINT(Release.t)", "Release.t")
            .replace("INT_TO_DINT(Wait.t)", "Wait.t"))
    );
    assert_eq!(
        actions(step(&document, "Sequencing", "Release")),
        ["P1 ResetBead := TRUE", "P1 Sol1 := FALSE", "P0 Sol1 := TRUE", "P0 ResetBead := FALSE"]
    );
    // A macro-step that is never left: an exit step is added and said so.
    let logic = chart(&document, "BeadLogic");
    assert_eq!(logic.vars().map(var).collect::<Vec<_>>(), ["const Level LREAL := 2.5"]);
    assert_eq!(
        actions(step(&document, "BeadLogic", "Watch")),
        ["each scan: Bead := (AnalogBead > Level)", "each scan: Colour := (Col > 1.5)"]
    );
    assert_eq!(step(&document, "BeadLogic", "no exit").kind, StepKind::Exit);
    assert_eq!(
        problems(&bytes("bead-sorter.xml"), &found),
        ["G0614 47: the macro-step `BeadLogic` has no exit step; it gets one that is never reached"]
    );
}

#[test]
fn a_step_keeps_its_place_on_the_drawing() {
    let (document, _) = import("texts.xml");
    let layout = document.items.iter().find_map(|i| if let Item::Layout(l) = i { Some(l) } else { None });
    let places = &layout.expect("a layout").places;
    let at = |wanted: &Placed| places.iter().find(|p| p.what == *wanted).map(|p| (p.x, p.y));
    let work = step(&document, "Texts", "work").name.clone();
    // A step at 10 has its axis at 40, as the transition at 15 with half its width of 30 less.
    assert_eq!(at(&Placed::Step(work)), Some((400, 200)));
    assert_eq!(at(&Placed::TransitionNumber(0)), Some((300, 1000)));
}

#[test]
fn lines_lead_through_splits_joins_posts_and_groups() {
    let (document, found) = import("lines.xml");
    assert_eq!(
        transitions(chart(&document, "Lines")),
        [
            "#0 -> #1 when TRUE",
            "zero -> one, two, three when TRUE priority 2",
            "one, two, three -> #0 when TRUE",
            "#1 -> zero when TRUE",
        ]
    );
    assert_eq!(problems(&bytes("lines.xml"), &found), Vec::<String>::new());
}

#[test]
fn names_are_looked_up_from_the_inside_out() {
    let (document, found) = import("workspaces.xml");
    let names: Vec<(&str, ChartKind)> = document.charts().map(|c| (&*c.name.text, c.kind)).collect();
    assert_eq!(
        names,
        [
            ("W1", ChartKind::Chart),
            ("M", ChartKind::Expansion),
            ("inner", ChartKind::Expansion),
            ("Box", ChartKind::Chart),
            ("W2", ChartKind::Chart),
            // A second macro-step `M`: its expansion needs a name of its own.
            ("W2_M", ChartKind::Expansion),
        ]
    );
    assert!(matches!(&step(&document, "W2", "M").kind, StepKind::Macro(name) if &*name.text == "W2_M"));
    // `only` is the one of its name and goes to the file; the three `X1` stay in their charts.
    assert_eq!(vars(&document), ["var only BOOL := FALSE"]);
    assert_eq!(actions(step(&document, "W1", "Vänta på start")), ["P1 X1 := W2.X1", "P1 W2.X1 := only"]);
    assert_eq!(
        transitions(chart(&document, "W1")),
        [
            "Vänta på start -> M when ((((W2.Go.x and inner.deep) and (M.Enter.t > 3)) and M.x) and Box.flag)",
            "M -> Vänta på start when TRUE",
        ]
    );
    assert_eq!(
        actions(step(&document, "M", "Enter")),
        ["P1 X1 := TRUE", "P1 only := TRUE", "P1 W1.X1 := TRUE"]
    );
    assert_eq!(
        transitions(chart(&document, "M")),
        ["Enter -> inner when (W1.M.x and X1)", "inner -> Exit when TRUE"]
    );
    assert_eq!(actions(step(&document, "inner", "Enter")), ["P1 deep := M.X1"]);
    assert_eq!(actions(step(&document, "Box", "In the box")), ["each scan: flag := not flag"]);
    assert_eq!(transitions(chart(&document, "W2_M")), ["#0 -> #1 when W2.X1"]);
    // The file scans as the faster one; the other keeps its pace.
    assert_eq!(chart(&document, "W1").every, None);
    assert_eq!(chart(&document, "W2").every, Some(g7_model::Nanos::from_millis(40)));
    assert_eq!(problems(&bytes("workspaces.xml"), &found), Vec::<String>::new());
}

#[test]
fn what_is_read_can_be_written_as_text_and_read_again() {
    for name in ["bead-sorter.xml", "lines.xml", "texts.xml", "workspaces.xml"] {
        let (document, _) = import(name);
        let text = g7_syntax::print(&document, None);
        let (again, found) = g7_syntax::parse(&text, g7_model::FileId(0));
        assert!(found.is_empty(), "{name}: {found:?}\n{text}");
        assert_eq!(again, document, "{name}:\n{text}");
    }
}

#[test]
fn notes_on_what_is_left_out_stand_at_the_head_of_the_text() {
    let file = "<GCDocument name='J1'><GCInitialStep id='a' name='Idle'/><GCRectangle name='*/ frame'/></GCDocument>";
    let (document, _) = support::import("jgrafchart", file.as_bytes(), g7_model::FileId(0));
    let text = g7_syntax::print(&document, None);
    assert!(text.starts_with("// not carried over: <GCRectangle name='*/ frame'/>\n"), "{text}");
    let (again, found) = g7_syntax::parse(&text, g7_model::FileId(0));
    assert!(found.is_empty(), "{found:?}");
    assert_eq!(again, document, "{text}");
}
