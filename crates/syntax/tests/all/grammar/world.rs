//! Files, variables, plants, tests, properties, layouts, and how all is written.

use crate::grammar::expressions::tree;
use crate::grammar::read;
use crate::grammar::statements::lines;
use g7_model::{
    ActionForm, FbKind, FileId, Item, LinkForm, Name, Nanos, Placed, PlantItem, ProfileName, PropertyKind,
    Switch, TargetPlc, TestStmt, TestStmtKind, Type, ValueType, VarKind,
};
use g7_syntax::{LineColumn, LineIndex, parse, print};

#[test]
fn head_of_a_file() {
    let d = read("profile iec61131 { multi-token, no-final-scan bound 50 }\nscan 10ms\ntarget tsx3720");
    let profile = d.profile().expect("a profile");
    assert_eq!(profile.name, ProfileName::Iec61131);
    let switches: Vec<_> = profile.switches.iter().map(|(s, _)| *s).collect();
    assert_eq!(switches, [Switch::MultiToken(true), Switch::FinalScan(false), Switch::Bound(50)]);
    assert!(matches!(d.items[1], Item::Cycle(time, _) if time == Nanos::from_millis(10)));
    assert!(matches!(d.items[2], Item::Target(TargetPlc::Tsx3720, _)));
    for name in ProfileName::ALL {
        assert_eq!(read(&format!("profile {}", name.name())).profile().map(|p| p.name), Some(name));
    }
}

#[test]
fn every_switch() {
    for (word, switch) in [
        ("stable", Switch::Stable(true)),
        ("one-pass", Switch::Stable(false)),
        ("multi-token", Switch::MultiToken(true)),
        ("single-token", Switch::MultiToken(false)),
        ("sequential", Switch::Sequential(true)),
        ("simultaneous", Switch::Sequential(false)),
        ("parallel-actions", Switch::ParallelActions(true)),
        ("ordered-actions", Switch::ParallelActions(false)),
        ("final-scan", Switch::FinalScan(true)),
        ("no-final-scan", Switch::FinalScan(false)),
        ("keep-step-time", Switch::KeepStepTime(true)),
        ("zero-step-time", Switch::KeepStepTime(false)),
        ("scan-clock", Switch::ScanClock(true)),
        ("time-clock", Switch::ScanClock(false)),
        ("pulse-first", Switch::PulseFirst(true)),
        ("text-order", Switch::PulseFirst(false)),
    ] {
        let d = read(&format!("profile pl7 {{ {word} }}"));
        assert_eq!(d.profile().and_then(|p| p.switches.first()).map(|s| s.0), Some(switch), "{word}");
    }
}

#[test]
fn variables() {
    let d = read(
        "input start, stop : BOOL at %i0.0 inverted \"push button\"\noutput y : INT := 3 at 7 safe -1\n\
         var s : STRING[20] := 'x' retain\nconst k : REAL := 2.5\ninput c : BOOL at 'rod limit'\nvar t1 : ton",
    );
    let vars: Vec<_> =
        d.items.iter().filter_map(|i| if let Item::Var(v) = i { Some(v) } else { None }).collect();
    assert_eq!(
        vars.iter().map(|v| v.kind).collect::<Vec<_>>(),
        [VarKind::Input, VarKind::Output, VarKind::Var, VarKind::Const, VarKind::Input, VarKind::Var]
    );
    let start = vars[0];
    assert_eq!(start.names.iter().map(|n| &*n.text).collect::<Vec<_>>(), ["start", "stop"]);
    assert_eq!((start.address.as_ref().map(|n| &*n.text), start.inverted), (Some("%I0.0"), true));
    assert_eq!(start.comment.as_deref(), Some("push button"));
    assert_eq!((vars[1].address.as_ref().map(|n| &*n.text), vars[1].ty), (Some("7"), Type::Int));
    assert_eq!(vars[1].safe.as_ref().map(tree), Some("(neg 1)".into()));
    assert_eq!((vars[2].ty, vars[2].retain), (Type::String(20), true));
    assert_eq!(vars[3].init.as_ref().map(tree), Some("r2.5".into()));
    assert_eq!(vars[4].address.as_ref().map(|n| &*n.text), Some("rod limit"));
    assert_eq!(vars[5].ty, Type::Fb(FbKind::Ton));
}

#[test]
fn every_type() {
    use Type::{Bool, Dint, Int, Lint, Lreal, Real, Sint, Time, Udint, Uint, Ulint, Usint};
    let plain = [Bool, Sint, Int, Dint, Lint, Usint, Uint, Udint, Ulint, Real, Lreal, Time, Type::String(80)];
    let blocks = FbKind::ALL.map(Type::Fb);
    for ty in plain.into_iter().chain([Type::String(7)]).chain(blocks) {
        for word in [ty.to_string(), ty.to_string().to_lowercase()] {
            let d = read(&format!("var x : {word}"));
            assert!(matches!(&d.items[0], Item::Var(v) if v.ty == ty), "{word}");
        }
    }
}

#[test]
fn functions_have_parameters_and_locals() {
    let d = read("function Full(level : REAL, n : INT) : BOOL { var k, m : INT := 1; Full := level > k }");
    let Item::Function(f) = &d.items[0] else { panic!("{d:?}") };
    assert_eq!((f.params.len(), &f.params[1].ty, &f.result), (2, &Type::Int.into(), &Type::Bool.into()));
    assert_eq!((f.body.locals[0].names.len(), &f.body.locals[0].ty), (2, &Type::Int.into()));
    assert_eq!(lines(&f.body.statements), "Full <- (gt level k)");
}

#[test]
fn a_parameter_a_local_variable_and_a_result_can_have_a_type_of_the_file() {
    let d = read("function Next(m : Mode, plus : INT(0..9)) : Mode { var last : `step`; Next := m }");
    let Item::Function(f) = &d.items[0] else { panic!("{d:?}") };
    let named = |ty: &ValueType| ty.of.as_ref().map(|of| of.text.to_string());
    let types = [&f.params[0].ty, &f.params[1].ty, &f.result, &f.body.locals[0].ty];
    assert_eq!(types.map(named), [Some("Mode".into()), None, Some("Mode".into()), Some("step".into())]);
    assert_eq!((f.params[1].ty.base, f.params[1].ty.range()), (Type::Int, Some((0, 9))));
}

#[test]
fn plants() {
    let d = read(
        "plant Tank \"water\" {\n const a : REAL := 2.0\n state level, x : REAL := 0.0 in 0.0 .. 100.0 \"m\"\n\
         rate level := +8.0 when V1\n rate level := -5.0\n drive b1 := level > 2.0\n on ↑a { x := 1.0 }\n each { x := 2.0 }\n\
         parts Path(colour : INT) max 20 length 3.0 := (1), (0)\n arrivals B every 1s .. 3s when m { Path.add(1) }\n\
         view 'tank.svg' { water.height := level  lamp.on := V1 }\n}",
    );
    let Item::Plant(p) = &d.items[0] else { panic!("{d:?}") };
    assert_eq!((&*p.name.text, p.comment.as_deref(), p.items.len()), ("Tank", Some("water"), 10));
    let PlantItem::State(s) = &p.items[1] else { panic!("{p:?}") };
    assert_eq!(s.limits.as_ref().map(|(a, b)| (tree(a), tree(b))), Some(("r0.0".into(), "r100.0".into())));
    let PlantItem::Rate(r) = &p.items[2] else { panic!("{p:?}") };
    assert_eq!((tree(&r.value), r.when.as_ref().map(tree)), ("r8.0".into(), Some("V1".into())));
    assert!(matches!(&p.items[4], PlantItem::Drive(d) if d.input.kind.variable().as_deref() == Some("b1")));
    assert!(
        matches!(&p.items[5], PlantItem::On(e, b, _) if tree(e) == "(rise a)" && b.statements.len() == 1)
    );
    let PlantItem::Parts(parts) = &p.items[7] else { panic!("{p:?}") };
    assert_eq!((parts.max, parts.init.len(), parts.attributes.len()), (20, 2, 1));
    assert_eq!(parts.length.as_ref().map(tree), Some("r3.0".into()));
    let PlantItem::Arrivals(a) = &p.items[8] else { panic!("{p:?}") };
    assert_eq!(
        (tree(&a.least), a.most.as_ref().map(tree)),
        ("1000000000ns".into(), Some("3000000000ns".into()))
    );
    let PlantItem::View(v) = &p.items[9] else { panic!("{p:?}") };
    assert_eq!(
        (&*v.file, &*v.bindings[1].element.text, &*v.bindings[1].attribute.text),
        ("tank.svg", "lamp", "on")
    );
}

fn test_statements(text: &str) -> Vec<TestStmt> {
    let d = read(&format!("test \"t\" {{ {text} }}"));
    match &d.items[0] {
        Item::Test(t) => t.body.clone(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn tests() {
    let d = read("test \"stops\" with Belt seed 3 { pulse a }");
    let Item::Test(t) = &d.items[0] else { panic!("{d:?}") };
    assert_eq!((&*t.title, t.plant.as_ref().map(|n| &*n.text), t.seed), ("stops", Some("Belt"), Some(3)));

    let shown: Vec<String> = test_statements(
        "set a := TRUE, P.n := 3 pulse a pulse b for 1s wait 1s wait until a within 5s wait until b scan scan 3 \
         expect a, not b expect fault expect fault unstable expect fault `wait` expect (fault) \
         always a, b { pulse c } force m := FALSE release m restart restart cold repeat 4 { scan } \"note\"",
    )
    .iter()
    .map(test_line)
    .collect();
    assert_eq!(
        shown,
        [
            "set a=true P|n=3",
            "pulse a None",
            "pulse b Some(1000000000)",
            "wait 1000000000",
            "until a Some(5000000000)",
            "until b None",
            "scan 1",
            "scan 3",
            "expect a (not b)",
            "fault None",
            "fault Some(\"unstable\")",
            "fault Some(\"wait\")",
            "expect fault",
            "always a b [pulse c None]",
            "force m=false",
            "release m",
            "restart false",
            "restart true",
            "repeat 4 [scan 1]",
            "\"note\"",
        ]
    );
}

fn test_line(s: &TestStmt) -> String {
    let list = |list: &[g7_model::Expr]| list.iter().map(tree).collect::<Vec<_>>().join(" ");
    let body = |body: &[TestStmt]| body.iter().map(test_line).collect::<Vec<_>>().join("; ");
    match &s.kind {
        TestStmtKind::Set(l) => {
            let l: Vec<_> = l.iter().map(|(p, e)| format!("{}={}", tree(p), tree(e))).collect();
            format!("set {}", l.join(" "))
        }
        TestStmtKind::Pulse(p, t) => format!("pulse {} {:?}", tree(p), t.map(Nanos::count)),
        TestStmtKind::Wait(t) => format!("wait {}", t.count()),
        TestStmtKind::WaitUntil(e, t) => format!("until {} {:?}", tree(e), t.map(Nanos::count)),
        TestStmtKind::Scan(n) => format!("scan {n}"),
        TestStmtKind::Expect(l) => format!("expect {}", list(l)),
        TestStmtKind::ExpectFault(n) => format!("fault {:?}", n.as_ref().map(|n: &Name| n.text.to_string())),
        TestStmtKind::Always(l, b) => format!("always {} [{}]", list(l), body(b)),
        TestStmtKind::Force(p, e) => format!("force {}={}", tree(p), tree(e)),
        TestStmtKind::Release(p) => format!("release {}", tree(p)),
        TestStmtKind::Restart { cold } => format!("restart {cold}"),
        TestStmtKind::Repeat(n, b) => format!("repeat {n} [{}]", body(b)),
        TestStmtKind::Comment(c) => format!("{c:?}"),
    }
}

#[test]
fn properties_and_layouts() {
    let d = read(
        "prove always not (X0 and motor)\nprove never a\nprove reachable X1 \"c\"\nprove after a within 10ms expect b\n\
         prove after a until b or c expect X1\nprove between (a and b) and c never X1 and d\n\
         prove a and b leads to c \"at last\"\nprove at most 2 of (a, b, c)\n\
         prove never a and b with Tank \"closed\"\nassume not (a and b)\n\
         layout G { step 1 at (0, 1.5) transition t7 at (-2.25, 3) transition #0 at (0,0) comment \"x\" at (1, 1)\n\
         link transition #0 -> step 1 at (-5, 12.5), (0, -3) link step 1 -> transition t7 at (3, 4)
         link transition #0 -> step 1 as jump link step 1 -> transition t7 as line
         actions in row actions of step 1 in column sheet at (120, -4.5) }",
    );
    let properties: Vec<String> = d
        .items
        .iter()
        .filter_map(|i| if let Item::Prove(p) = i { Some(p) } else { None })
        .map(|p| match &p.kind {
            PropertyKind::Always(e) => format!("always {}", tree(e)),
            PropertyKind::Never(e) => {
                let plant = p.plant.as_ref().map_or(String::new(), |plant| format!(" with {}", plant.text));
                format!("never {}{plant}", tree(e))
            }
            PropertyKind::Reachable(e) => format!("reachable {} {:?}", tree(e), p.comment.as_deref()),
            PropertyKind::After(a, t, b) => format!("after {} {} {}", tree(a), t.count(), tree(b)),
            PropertyKind::Until(a, b, e) => format!("after {} until {} {}", tree(a), tree(b), tree(e)),
            PropertyKind::Between(a, b, e) => format!("between {} {} {}", tree(a), tree(b), tree(e)),
            PropertyKind::LeadsTo(a, b) => format!("{} leads to {}", tree(a), tree(b)),
            PropertyKind::AtMost(n, list) => {
                format!("{n} of {}", list.iter().map(tree).collect::<Vec<_>>().join(" "))
            }
            PropertyKind::Assume(e) => format!("assume {}", tree(e)),
        })
        .collect();
    assert_eq!(
        properties,
        [
            "always (not (and X0 motor))",
            "never a",
            "reachable X1 Some(\"c\")",
            "after a 10000000 b",
            "after a until (or b c) X1",
            "between (and a b) c (and X1 d)",
            "(and a b) leads to c",
            "2 of a b c",
            "never (and a b) with Tank",
            "assume (not (and a b))",
        ]
    );
    let Some(Item::Layout(layout)) = d.items.last() else { panic!("{d:?}") };
    let places: Vec<_> = layout.places.iter().map(|p| (p.x, p.y)).collect();
    assert_eq!(
        places,
        [
            (0, 150),
            (-225, 300),
            (0, 0),
            (100, 100),
            (-500, 1250),
            (300, 400),
            (0, 0),
            (0, 0),
            (0, 0),
            (0, 0),
            (12000, -450)
        ]
    );
    let bends: Vec<_> = layout.places.iter().flat_map(|p| &p.then).collect();
    assert_eq!(bends, [&(0, -300)]);
    assert!(matches!(&layout.places[1].what, Placed::Transition(n) if &*n.text == "t7"));
    assert!(matches!(&layout.places[2].what, Placed::TransitionNumber(0)));
    assert!(matches!(&layout.places[3].what, Placed::Comment(c) if &**c == "x"));
    let Placed::Link(back) = &layout.places[4].what else { panic!("{layout:?}") };
    assert!(matches!(&**back, (Placed::TransitionNumber(0), Placed::Step(n)) if &*n.text == "1"));
    let Placed::Link(on) = &layout.places[5].what else { panic!("{layout:?}") };
    assert!(matches!(&**on, (Placed::Step(_), Placed::Transition(n)) if &*n.text == "t7"));
    let Placed::LinkForm(back, LinkForm::Jump) = &layout.places[6].what else { panic!("{layout:?}") };
    assert!(matches!(&**back, (Placed::TransitionNumber(0), Placed::Step(n)) if &*n.text == "1"));
    assert_eq!(layout.places[8].what, Placed::Actions(None, ActionForm::Row));
    let Placed::Actions(Some(step), ActionForm::Column) = &layout.places[9].what else {
        panic!("{layout:?}")
    };
    assert!(matches!(&**step, Placed::Step(n) if &*n.text == "1"));
    assert_eq!(layout.places[10].what, Placed::Sheet);
    let Placed::LinkForm(on, LinkForm::Line) = &layout.places[7].what else { panic!("{layout:?}") };
    assert!(matches!(&**on, (Placed::Step(_), Placed::Transition(n)) if &*n.text == "t7"));
}

#[test]
fn the_canonical_form() {
    let text = "// head\nprofile pl7{bound 5}\n\n\n\nvar   mask:INT:=16#FF // bits\nchart G{initial step 0 // rest\n\
                step 1 \"count\" {N motor; P1 n:=0 // zero\n\n\n on ↑b: {n:=n+1; m:=n} }\nstep 2{ N V }\n\
                0->1 when a&!b.c ->2 when (1.5s/X1)\n/* last */}\ntest \"t\" {}\n// end\n";
    let wanted = "// head\nprofile pl7 { bound 5 }\n\nvar mask : INT := 16#FF // bits\n\nchart G {\n  initial step 0 // rest\n  \
                  step 1 \"count\" {\n    N motor\n    P1 n := 0 // zero\n\n    on ↑b: {\n      n := n + 1\n      m := n\n    }\n  }\n  \
                  step 2 { N V }\n  0 -> 1 when a and not b.c\n    -> 2 when 1.5s/X1\n  /* last */\n}\n\ntest \"t\" {}\n// end\n";
    let (d, problems) = parse(text, FileId(0));
    assert!(problems.is_empty(), "{problems:?}");
    assert_eq!(print(&d, Some(text)), wanted);
}

#[test]
fn a_document_made_by_a_program_is_spaced() {
    let text = "profile pl7 scan 5ms input a : BOOL output b : BOOL chart G { var n : INT step 1 step 2 { N b } 1 -> 2 when a } \
                prove always a prove never b";
    let printed = print(&read(text), None);
    assert_eq!(
        printed,
        "profile pl7\nscan 5ms\n\ninput a : BOOL\noutput b : BOOL\n\nchart G {\n  var n : INT\n\n  step 1\n  step 2 { N b }\n\n  \
         1 -> 2 when a\n}\n\nprove always a\nprove never b\n"
    );
}

#[test]
fn lines_and_columns_count_characters() {
    let index = LineIndex::new("aé\r\n↑b\n\nx");
    let at = |offset| index.place(offset);
    assert_eq!(at(0), LineColumn { line: 1, column: 1 });
    assert_eq!(at(3), LineColumn { line: 1, column: 3 });
    assert_eq!(at(5), LineColumn { line: 2, column: 1 });
    assert_eq!(at(8), LineColumn { line: 2, column: 2 });
    assert_eq!(at(99), LineColumn { line: 4, column: 2 });
    assert_eq!(
        (index.count(), index.line_text(1), index.line_text(2), index.line_text(3)),
        (4, "aé", "↑b", "")
    );
    assert_eq!((index.line_text(4), index.line_text(5)), ("x", ""));
}
