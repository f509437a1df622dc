//! Tests of resolving whole documents.

use g7_engine::Rules;
use g7_model::{Nanos, ProfileName};

use super::{read, resolved, show};
use crate::ir::{ActionKind, ChartRole, Situation, StepSort, Stmt, StmtKind, Target, Unit, Value, VarClass};
use crate::resolve::resolve;

fn target(unit: &Unit, t: &Target) -> String {
    match t {
        Target::Var(v) => unit.vars[v.index()].name.to_string(),
        Target::Element(all, e) => format!("{}[{}]", unit.vars[all.first.index()].name, show(unit, &e[0])),
        Target::Member(v, m) => format!("{}#{m}", unit.vars[v.index()].name),
    }
}

fn lines(unit: &Unit, statements: &[Stmt]) -> Vec<String> {
    let mut list = Vec::new();
    for s in statements {
        list.push(match &s.kind {
            StmtKind::Assign(t, e) => format!("{} := {}", target(unit, t), show(unit, e)),
            StmtKind::Fb { var, inputs, outputs, .. } => {
                let i = inputs.iter().map(|(m, e)| format!("{m} := {}", show(unit, e)));
                let o = outputs.iter().map(|(m, t)| format!("{m} => {}", target(unit, t)));
                let all: Vec<String> = i.chain(o).collect();
                format!("{}({})", unit.vars[var.index()].name, all.join(", "))
            }
            StmtKind::For { var, from, to, by, body } => format!(
                "for {} := {} to {} by {} {:?}",
                unit.vars[var.index()].name,
                show(unit, from),
                show(unit, to),
                by.as_ref().map_or("-".to_owned(), |b| show(unit, b)),
                lines(unit, body)
            ),
            StmtKind::Case(e, arms, otherwise) => {
                let arms: Vec<String> =
                    arms.iter().map(|(r, s)| format!("{r:?} {:?}", lines(unit, s))).collect();
                format!("case {} {} else {:?}", show(unit, e), arms.join(" "), lines(unit, otherwise))
            }
            other => format!("{other:?}").split(['(', ' ']).next().unwrap_or_default().to_owned(),
        });
    }
    list
}

#[test]
fn profiles_switches_and_overrides() {
    let doc = read("profile iec61131 { multi-token, no-final-scan, bound 50 }\nscan 20ms\ntarget tsx57\n");
    let (unit, problems) = resolve(&doc, None);
    assert!(problems.is_empty());
    let want = Rules { multi_token: true, final_scan: false, bound: 50, ..Rules::IEC61131 };
    assert_eq!((unit.profile, unit.rules, unit.cycle), (ProfileName::Iec61131, want, Nanos::from_millis(20)));
    // Another profile brings its own switches: those of the document are dropped.
    let (unit, _) = resolve(&doc, Some(ProfileName::Iec61131));
    assert_eq!(unit.rules, Rules::IEC61131);
    let (unit, _) = resolve(&doc, Some(ProfileName::Pl7));
    assert_eq!((unit.profile, unit.rules), (ProfileName::Pl7, Rules::PL7));
    let empty = read("");
    let (unit, _) = resolve(&empty, None);
    assert_eq!(
        (unit.profile, unit.rules, unit.cycle),
        (ProfileName::Iec60848, Rules::IEC60848, Nanos::from_millis(10))
    );
}

#[test]
fn variables_have_their_values_and_addresses() {
    let doc = read(
        "const five : INT := 2 + 3
         const ten : INT := five * 2
         input a : BOOL at %I0.0 inverted \"button\"
         output y : INT := 3 safe ten - 1
         output z : REAL := 1 at 'valve'
         var k : DINT := five retain
         var s : STRING(5) := 'abc'
         var t : TIME := 2 * 1500ms
         chart G { var k : BOOL := 1  initial step 1 }",
    );
    let (unit, _) = resolved(&doc);
    let find = |name: &str| unit.vars.iter().find(|v| &*v.name == name).expect(name);
    assert_eq!(find("ten").init, Value::Int(10));
    assert_eq!((find("a").class, find("a").inverted), (VarClass::Input, true));
    assert_eq!(find("a").address.as_deref(), Some("%I0.0"));
    assert_eq!(find("a").comment.as_deref(), Some("button"));
    assert_eq!((&find("y").init, &find("y").safe), (&Value::Int(3), &Value::Int(9)));
    assert_eq!((&find("z").init, find("z").address.as_deref()), (&Value::Real(1.0), Some("valve")));
    assert_eq!((&find("k").init, find("k").retain), (&Value::Int(5), true));
    assert_eq!(find("s").init, Value::Str("abc".into()));
    assert_eq!(find("t").init, Value::Int(3_000_000_000));
    assert_eq!(find("G.k").init, Value::Bool(true));
}

#[test]
fn charts_nest_and_steps_lie_together() {
    let doc = read(
        "var a : BOOL
         chart G { initial step 1  macro M3 = Dose  enclosing step 4 { enclose H }
           1 -> M3 when a -> 4 when a -> 1 when a }
         macrochart Dose { entry step E  macro M = Deep  exit step S  E -> M when a -> S when a }
         macrochart Deep { entry step E  exit step S  E -> S when a }
         macrochart Spare { entry step E  exit step S  E -> S when a }
         chart H every 50ms { step 11 *  step 12 { call Grip }  11 -> 12 when a -> 11 when a }
         task Grip { entry step 21  exit step 22  21 -> 22 when a }",
    );
    let (unit, scopes) = resolved(&doc);
    let paths: Vec<&str> = unit.charts.iter().map(|c| &*c.path).collect();
    assert_eq!(paths, ["G", "G.M3", "G.M3.M", "Spare", "H", "Grip"]);
    let chart = |name: &str| &unit.charts[scopes.chart(name).expect(name).index()];
    let m3 = scopes.step(scopes.chart("G").expect("G"), "M3").expect("M3");
    assert_eq!(chart("Dose").role, ChartRole::Expansion(m3));
    assert_eq!(unit.steps[m3.index()].sort, StepSort::Macro(scopes.chart("Dose").expect("Dose")));
    assert_eq!(chart("Spare").role, ChartRole::Unused);
    assert_eq!(chart("Grip").role, ChartRole::Task);
    assert_eq!((chart("H").every, chart("H").enclosed_by.is_some()), (Some(Nanos::from_millis(50)), true));
    assert_eq!((chart("Dose").entry.is_some(), chart("Dose").exit.is_some()), (true, true));
    for (k, c) in unit.charts.iter().enumerate() {
        assert!(
            unit.steps[c.steps.start as usize..c.steps.end as usize].iter().all(|s| s.chart.index() == k)
        );
        let own = &unit.transitions[c.transitions.start as usize..c.transitions.end as usize];
        assert!(own.iter().all(|t| t.chart.index() == k));
    }
    assert_eq!(
        unit.steps[scopes.step(scopes.chart("H").expect("H"), "12").expect("12").index()].calls.len(),
        1
    );
}

#[test]
fn orders_and_actions_find_their_targets() {
    let doc = read(
        "input a : BOOL  output y : BOOL  var n : INT
         action Pump { n := n + 1 }
         chart G {
           action Pump { n := 0 }
           initial step 1 { N y  P1 Pump  L 5s y if a  force H := {11}  force H := {}  mask H  mask y  enable H
             on ↑a: n := 1  each scan: n := 2 }
           step 2 1 -> 2 when a -> 1 when a }
         chart H { initial step 11 { N Pump  N G.Pump }  step 12  11 -> 12 when a -> 11 when a }",
    );
    let (unit, scopes) = resolved(&doc);
    let own = unit.bodies.iter().position(|b| &*b.name == "G.Pump").expect("own");
    let kinds: Vec<&ActionKind> = unit.steps[0].actions.iter().map(|a| &a.kind).collect();
    assert!(matches!(kinds[0], ActionKind::Variable { var, .. } if &*unit.vars[var.index()].name == "y"));
    assert!(matches!(kinds[1], ActionKind::Named { body, .. } if body.index() == own));
    assert!(matches!(kinds[2], ActionKind::Variable { time: Some(_), condition: Some(_), .. }));
    let h = scopes.chart("H").expect("H");
    let eleven = scopes.step(h, "11").expect("11");
    assert!(matches!(kinds[3], ActionKind::Force(c, Situation::Steps(s)) if *c == h && *s == [eleven]));
    assert!(matches!(kinds[4], ActionKind::Force(_, Situation::Steps(s)) if s.is_empty()));
    assert!(matches!(kinds[5], ActionKind::MaskChart(c) if *c == h));
    assert!(matches!(kinds[6], ActionKind::MaskVar(_)));
    assert!(matches!(kinds[7], ActionKind::Enable(c) if *c == h));
    assert!(matches!(kinds[8], ActionKind::OnEvent { .. }));
    assert!(matches!(kinds[9], ActionKind::EachScan { .. }));
    let of_h: Vec<usize> = unit.steps[eleven.index()]
        .actions
        .iter()
        .filter_map(|a| match &a.kind {
            ActionKind::Named { body, .. } => Some(body.index()),
            _ => None,
        })
        .collect();
    assert_eq!(of_h, [1 - own, own]);
}

#[test]
fn statements_and_locals() {
    let doc = read(
        "var n, k : INT  var d : DINT  var c : CTU  var done : BOOL
         action Work {
           var i, j : INT := k
           var sum : DINT
           FOR i := 1 TO 10 BY 2 DO sum := sum + i; END_FOR
           CASE n OF 1, 3 .. 5: d := 1; -1: d := n; ELSE d := 0; END_CASE
           c(CU := done, PV := 7, Q => done)
           c.PV := n
         }
         chart G { initial step 1 { N Work } step 2 1 -> 2 when done -> 1 when done }",
    );
    let (unit, _) = resolved(&doc);
    assert_eq!(
        lines(&unit, &unit.bodies[0].statements),
        [
            "Work.i := k",
            "Work.j := k",
            "Work.sum := 0",
            "for Work.i := 1 to 10 by 2 [\"Work.sum := (Work.sum Add DINT(Work.i))\"]",
            "case LINT(n) [(1, 1), (3, 5)] [\"d := 1\"] [(-1, -1)] [\"d := DINT(n)\"] else [\"d := 0\"]",
            "c(0 := done, 2 := 7, 3 => done)",
            "c#2 := n",
        ]
    );
}

#[test]
fn pre_and_post_keep_their_bodies_in_text_order() {
    let doc = read(
        "var n : INT
         chart G { pre { n := 1; RETURN } initial step 1 }
         pre { n := 2 }
         post { n := 3 }",
    );
    let (unit, _) = resolved(&doc);
    let pre: Vec<(&str, usize)> = unit.pre.iter().map(|b| (&*b.name, b.statements.len())).collect();
    assert_eq!(pre, [("G.pre", 2), ("pre", 1)]);
    assert_eq!(unit.post.len(), 1);
}

#[test]
fn a_function_starts_with_its_locals_and_assigns_its_name() {
    let doc = read(
        "function Sum(up : INT) : DINT { var i : INT  FOR i := 1 TO up DO Sum := Sum + i; END_FOR }
         var d : DINT  var n : INT
         chart G { initial step 1 { P1 d := Sum(n) } step 2 1 -> 2 when =1 -> 1 when =1 }",
    );
    let (unit, _) = resolved(&doc);
    let f = &unit.functions[0];
    assert_eq!(unit.vars[f.result.index()].class, VarClass::Local);
    assert_eq!(
        lines(&unit, &f.statements),
        ["Sum.i := 0", "for Sum.i := 1 to Sum.up by - [\"Sum := (Sum Add DINT(Sum.i))\"]"]
    );
}

#[test]
fn a_section_is_a_receptivity_and_a_variable() {
    let doc = read(
        "input a : BOOL
         transition section Ready { var k : BOOL  k := a  Ready := k }
         chart G { initial step 1 step 2 { N y if Ready } output y : BOOL
           1 -> 2 when Ready  2 -> 1 when not Ready }",
    );
    let (unit, _) = resolved(&doc);
    assert_eq!(show(&unit, &unit.transitions[0].receptivity), "section Ready");
    assert_eq!(show(&unit, &unit.transitions[1].receptivity), "not Ready");
    assert_eq!(
        lines(&unit, &unit.sections[0].statements),
        ["Ready.k := false", "Ready.k := a", "Ready := Ready.k"]
    );
}

#[test]
fn what_is_wrong_is_left_out_and_the_rest_stays() {
    let doc = read(
        "input a : BOOL  output y : BOOL
         chart G { initial step 1 { N nothing  N y  P1 y := 5 } step 2
           1 -> 2 when nothing  2 -> 3 when a  2 -> 1 when a }",
    );
    let (unit, problems) = resolve(&doc, None);
    let codes: Vec<&str> = problems.iter().map(|p| p.code.id).collect();
    assert_eq!(codes, ["G0202", "G0209", "G0202", "G0204"]);
    assert_eq!(unit.steps[0].actions.len(), 2);
    assert_eq!(unit.transitions.len(), 2);
    assert_eq!(show(&unit, &unit.transitions[0].receptivity), "false");
}

#[test]
fn circles_of_charts_end() {
    let doc = read(
        "var a : BOOL
         macrochart A { entry step E macro M = B exit step S E -> M when a -> S when a }
         macrochart B { entry step E macro M = C exit step S E -> M when a -> S when a }
         macrochart C { entry step E macro M = A exit step S E -> M when a -> S when a }",
    );
    let (unit, problems) = resolve(&doc, None);
    assert_eq!(problems.iter().map(|p| p.code.id).collect::<Vec<_>>(), ["G0219"]);
    let paths: Vec<&str> = unit.charts.iter().map(|c| &*c.path).collect();
    assert_eq!(paths, ["A", "A.M", "A.M.M"]);
}
