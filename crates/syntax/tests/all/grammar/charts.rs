//! Charts, steps, transitions and actions.

use crate::grammar::expressions::tree;
use crate::grammar::read;
use crate::grammar::statements::lines;
use g7_model::{
    ActionKind, Body, BodyLang, Chart, ChartItem, ChartKind, Nanos, Order, Qualifier, Situation, Step,
    StepKind, Target, Transition, Work,
};

fn chart(items: &str) -> Chart {
    let d = read(&format!("chart G {{ {items} }}"));
    d.charts().next().cloned().expect("a chart")
}

fn step(text: &str) -> Step {
    chart(text).steps().next().cloned().expect("a step")
}

fn transition(text: &str) -> Transition {
    chart(text).transitions().next().cloned().expect("a transition")
}

fn action(text: &str) -> ActionKind {
    let step = step(&format!("step 1 {{ {text} }}"));
    assert_eq!(step.actions.len(), 1, "{text}");
    step.actions[0].kind.clone()
}

fn names(list: &[g7_model::Name]) -> Vec<&str> {
    list.iter().map(|n| &*n.text).collect()
}

#[test]
fn kinds_of_chart() {
    let d = read("chart Main \"all of it\" every 20ms { }\nmacrochart Dose { }\ntask Grip \"x\" { }");
    let kinds: Vec<_> = d.charts().map(|c| (c.kind, &*c.name.text, c.comment.as_deref(), c.every)).collect();
    assert_eq!(
        kinds,
        [
            (ChartKind::Chart, "Main", Some("all of it"), Some(Nanos::from_millis(20))),
            (ChartKind::Expansion, "Dose", None, None),
            (ChartKind::Task, "Grip", Some("x"), None),
        ]
    );
}

#[test]
fn kinds_of_step() {
    let c = chart(
        "step 12 initial step Fill \"c\" entry step E exit step `out 1`* enclosing step 5* {} macro M3 = Dose \
         initial macro M4 = Dose*",
    );
    let dose = || StepKind::Macro(g7_model::Name::new("Dose", Default::default()));
    let seen: Vec<_> =
        c.steps().map(|s| (&*s.name.text, s.kind.clone(), s.initial, s.linked, s.braces)).collect();
    assert_eq!(
        seen,
        [
            ("12", StepKind::Plain, false, false, false),
            ("Fill", StepKind::Plain, true, false, false),
            ("E", StepKind::Entry, false, false, false),
            ("out 1", StepKind::Exit, false, true, false),
            ("5", StepKind::Enclosing, false, true, true),
            ("M3", dose(), false, false, false),
            ("M4", dose(), true, true, false),
        ]
    );
    assert_eq!(c.steps().nth(1).and_then(|s| s.comment.as_deref()), Some("c"));
}

#[test]
fn shapes_of_transition() {
    let t = transition("t7: (3, Fill) -> (4, `x y`) when a priority 2 \"why\" on clearing { n := 0 }");
    assert_eq!(t.label.as_ref().map(|n| &*n.text), Some("t7"));
    assert_eq!((names(&t.from), names(&t.to)), (vec!["3", "Fill"], vec!["4", "x y"]));
    assert_eq!((tree(&t.receptivity), t.priority, t.comment.as_deref()), ("a".into(), Some(2), Some("why")));
    assert_eq!(lines(&t.on_clearing.expect("an action").statements), "n <- 0");

    let source = transition("() -> 1 when =1");
    assert_eq!((names(&source.from), names(&source.to)), (vec![], vec!["1"]));
    assert_eq!(tree(&source.receptivity), "true");
    let sink = transition("4 -> () when y");
    assert_eq!((names(&sink.from), names(&sink.to)), (vec!["4"], vec![]));
    assert_eq!(names(&transition("(1) -> 2 when y").from), ["1"]);
    assert_eq!(names(&transition("1 → 2 when y").to), ["2"]);
}

#[test]
fn transitions_behind_one_another() {
    let c = chart("1 -> 2 when a -> (3, 4) when b priority 1\n -> 5 when c\n 5 -> 1 when d");
    let seen: Vec<_> = c
        .transitions()
        .map(|t| (names(&t.from).join(" "), names(&t.to).join(" "), tree(&t.receptivity), t.chained))
        .collect();
    let row = |from: &str, to: &str, e: &str, chained| (from.into(), to.into(), e.into(), chained);
    assert_eq!(
        seen,
        [
            row("1", "2", "a", false),
            row("2", "3 4", "b", true),
            row("3 4", "5", "c", true),
            row("5", "1", "d", false),
        ]
    );
}

#[test]
fn words_can_be_names_of_steps() {
    let c = chart("step on step at step max\n on -> at when a\n at -> max when b\n pre: max -> on when c");
    let seen: Vec<_> = c.transitions().map(|t| (names(&t.from).join(""), names(&t.to).join(""))).collect();
    assert_eq!(seen, [("on".into(), "at".into()), ("at".into(), "max".into()), ("max".into(), "on".into())]);
}

#[test]
fn every_qualifier() {
    for qualifier in Qualifier::ALL {
        let time = if qualifier.timed() { "1.5s" } else { "" };
        let kind = action(&format!("{} {time} V", qualifier.name()));
        let ActionKind::Qualified { qualifier: read, time, target, condition } = kind else {
            panic!("{kind:?}")
        };
        assert_eq!(read, qualifier);
        assert_eq!(time.map(|t| tree(&t)), qualifier.timed().then(|| "1500000000ns".into()));
        assert!(matches!(target, Target::Path(p) if p.text() == "V"));
        assert!(condition.is_none());
    }
}

#[test]
fn targets_times_and_conditions() {
    let ActionKind::Qualified { time, target, condition, .. } = action("L (t * 2) %q0.1 if a or b") else {
        panic!("not qualified")
    };
    assert_eq!(time.map(|t| tree(&t)), Some("(mul t 2)".into()));
    assert!(matches!(target, Target::Direct(d, _) if &*d == "Q0.1"));
    assert_eq!(condition.map(|c| tree(&c)), Some("(or a b)".into()));

    let work = |text: &str| match action(text) {
        ActionKind::Qualified { target: Target::Work(w), .. } => {
            (matches!(w, Work::Block(_)), lines(w.statements()))
        }
        other => panic!("{other:?}"),
    };
    assert_eq!(work("P1 n := n + 1"), (false, "n <- (add n 1)".into()));
    assert_eq!(work("P0 %MW3 := 0"), (false, "%MW3 <- 0".into()));
    assert_eq!(work("P1 INITCHART(H)"), (false, "(call INITCHART H)".into()));
    assert_eq!(work("N { a := b; c := d }"), (true, "a <- b; c <- d".into()));
    assert!(
        matches!(action("S Chart.pump"), ActionKind::Qualified { target: Target::Path(p), .. } if p.names.len() == 2)
    );
}

#[test]
fn stored_actions_on_events_and_scans() {
    let ActionKind::OnEvent { event, work } = action("on ↑bottle: count := count + 1") else {
        panic!("not on event")
    };
    assert_eq!(
        (tree(&event), lines(work.statements())),
        ("(rise bottle)".into(), "count <- (add count 1)".into())
    );
    let ActionKind::EachScan { work, condition } = action("each scan: { a := b } if c") else {
        panic!("not each")
    };
    assert_eq!((lines(work.statements()), condition.map(|c| tree(&c))), ("a <- b".into(), Some("c".into())));
    assert_eq!(action("\"to \\\"see\\\"\""), ActionKind::Comment("to \"see\"".into()));
}

#[test]
fn orders() {
    let name = |s: &str| g7_model::Name::new(s, Default::default());
    let steps = |list: &[&str]| Situation::Steps(list.iter().map(|s| name(s)).collect());
    for (text, wanted) in [
        ("force G1 := {8, 11}", Order::Force(name("G1"), steps(&["8", "11"]))),
        ("force G1 := {}", Order::Force(name("G1"), steps(&[]))),
        ("force G1 := {*}", Order::Force(name("G1"), Situation::Current)),
        ("force G1 := INIT", Order::Force(name("G1"), Situation::Init)),
        ("force G1 := {INIT}", Order::Force(name("G1"), Situation::Init)),
        ("force G1 := {`INIT`}", Order::Force(name("G1"), steps(&["INIT"]))),
        ("enable G1", Order::Enable(name("G1"))),
        ("mask V", Order::Mask(name("V"))),
        ("call Grip", Order::Call(name("Grip"))),
        ("enclose G2", Order::Enclose(name("G2"))),
    ] {
        assert_eq!(action(text), ActionKind::Order(wanted), "{text}");
    }
}

#[test]
fn actions_need_no_separators() {
    let s = step("step 1 { N a N b; P1 n := n - 1 S c if d \"note\" on ↑e: f := g call T }");
    assert_eq!(s.actions.len(), 7);
}

#[test]
fn sections_of_a_chart() {
    let c = chart(
        "var n : INT := 0 pre { a := b } post st { c := d } action Pump \"x\" { e := f } \
         action Old il { LD a ST b } action Rung ld {--{ [a] | [b] }--(c)} \
         transition section Ready := a and b transition section Full { Full := c }",
    );
    let seen: Vec<String> = c
        .items
        .iter()
        .map(|i| match i {
            ChartItem::Var(v) => format!("var {}", v.names[0].text),
            ChartItem::Pre(Body::St(b), _) => format!("pre {}", lines(&b.statements)),
            ChartItem::Post(Body::St(b), _) => format!("post {}", lines(&b.statements)),
            ChartItem::Action(a) => match &a.body {
                Body::St(b) => format!("action {} {}", a.name.text, lines(&b.statements)),
                Body::Other(BodyLang::Il, text, _) => format!("il{text}"),
                Body::Other(BodyLang::Ld, text, _) => format!("ld{text}"),
            },
            ChartItem::Section(s) => {
                format!("section {} {} {}", s.name.text, s.short, lines(&s.body.statements))
            }
            other => panic!("{other:?}"),
        })
        .collect();
    assert_eq!(
        seen,
        [
            "var n",
            "pre a <- b",
            "post c <- d",
            "action Pump e <- f",
            "il LD a ST b ",
            "ld--{ [a] | [b] }--(c)",
            "section Ready true Ready <- (and a b)",
            "section Full false Full <- c",
        ]
    );
}
