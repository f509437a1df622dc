//! Writes a random document as .g7 text: declarations, then the skeleton with its conditions and
//! actions.

use g7_model::{Lasting, ProfileName, Qualifier, Type};

use super::Weights;
use super::block_charts::block_charts;
use super::body::{self, Driven, Targets};
use super::composed::composed;
use super::dates::dates;
use super::instances::instances;
use super::named::named;
use super::rng::Rng;
use super::sight::{Sight, duration};
use super::skeleton::{Skeleton, SkeletonChart, skeleton};

/// The parts from which the text is made.
struct World {
    profile: ProfileName,
    stable: bool,
    /// True if at most one of the transitions that share a preceding step clears.
    single: bool,
    sight: Sight,
    targets: Targets,
    driven: Vec<Driven>,
    /// Named actions, with the qualifiers that each may have.
    named: Vec<(String, String)>,
    sections: Vec<String>,
    weights: Weights,
}

pub(super) fn document(rng: &mut Rng, profile: ProfileName, weights: &Weights) -> String {
    let mut out = String::new();
    let mut world = World {
        profile,
        stable: profile == ProfileName::Iec60848,
        single: matches!(profile, ProfileName::Iec61131 | ProfileName::Unity),
        sight: Sight {
            edges: weights.moments,
            timers: weights.moments,
            risk: if rng.percent(weights.risk) { 25 } else { 0 },
            // Drawn from a copy: charts without bits do not depend on it.
            bits: rng.clone().percent(30),
            ..Sight::default()
        },
        targets: Targets::default(),
        driven: Vec::new(),
        named: Vec::new(),
        sections: Vec::new(),
        weights: *weights,
    };
    world.sight.scans = profile == ProfileName::Jgrafchart;
    header(rng, &mut world, weights, &mut out);
    variables(rng, &mut world, &mut out);
    driven(rng, &mut world, &mut out);
    let names: Vec<String> = world.driven.iter().map(|d| d.name.clone()).collect();
    let skeleton = skeleton(rng, weights, &names);
    functions(rng, &mut world, &mut out);
    let outside = outside(&world, &skeleton);
    named_actions(rng, &mut world, &outside, &mut out);
    if rng.percent(25) {
        let name = "Ready".to_owned();
        let value = if world.stable { outside.edge(rng, 1) } else { outside.boolean(rng, 2) };
        out += &format!("transition section {name} := {value}\n");
        world.sections.push(name);
    }
    if rng.percent(weights.sections) {
        out += &format!("pre {}\n", pre(rng, &mut world, &outside, &skeleton));
    }
    if rng.percent(weights.sections) {
        let text = body::block(rng, &outside, &mut world.targets);
        out += &format!("post {text}\n");
    }
    for at in 0..skeleton.charts.len() {
        chart(rng, &mut world, &skeleton, at, &mut out);
    }
    instances(rng, &outside, &mut out);
    composed(rng, &outside, &mut out);
    block_charts(rng, &outside, &mut out);
    named(rng, &outside, &mut out);
    dates(rng, &outside, &mut out);
    out
}

fn header(rng: &mut Rng, world: &mut World, weights: &Weights, out: &mut String) {
    let mut switches: Vec<&str> = Vec::new();
    if rng.percent(weights.switches) {
        let pairs = [
            ["multi-token", "single-token"],
            ["parallel-actions", "ordered-actions"],
            ["final-scan", "no-final-scan"],
            ["keep-step-time", "zero-step-time"],
            ["pulse-first", "text-order"],
            ["simultaneous", "sequential"],
            ["stable", "one-pass"],
        ];
        for pair in pairs {
            if rng.percent(25) {
                let switch = rng.one(pair);
                // Contradictory: actions cannot wait for the end of the pass and also run at once.
                let at_once = switch == "stable" && switches.contains(&"parallel-actions")
                    || switch == "sequential"
                    && matches!(world.profile, ProfileName::Iec60848 | ProfileName::Pl7)
                    || switch == "parallel-actions" && world.profile == ProfileName::Jgrafchart
                    || switch == "sequential" && switches.contains(&"parallel-actions")
                    // In these profiles all actions wait for the end of the scan anyway.
                    || switch == "parallel-actions"
                        && matches!(world.profile, ProfileName::Iec61131 | ProfileName::Unity);
                if at_once {
                    continue;
                }
                switches.push(switch);
                if pair[1] == "single-token" {
                    world.single = switch == "single-token";
                }
                if pair[0] == "stable" {
                    world.stable = switch == "stable";
                }
            }
        }
    }
    if world.stable {
        switches.push("bound 60");
    }
    let all = if switches.is_empty() { String::new() } else { format!(" {{ {} }}", switches.join(", ")) };
    out.push_str(&format!("profile {}{all}\nscan 10ms\n", world.profile.name()));
}

fn variables(rng: &mut Rng, world: &mut World, out: &mut String) {
    let (s, t) = (&mut world.sight, &mut world.targets);
    let count = rng.between(2, 4);
    for name in ["a", "b", "c", "d"].into_iter().take(count) {
        s.inputs.push(name.to_owned());
    }
    out.push_str(&format!("input {} : BOOL\n", s.inputs.join(", ")));
    if rng.percent(40) {
        out.push_str("input n : INT\n");
        s.ints.push(("n".to_owned(), Type::Int));
    }
    if rng.percent(10) {
        out.push_str("input r : REAL\n");
        s.reals.push(("r".to_owned(), Type::Real));
    }
    for i in 0..rng.between(1, 3) {
        let word = rng.one(["var", "output", "var"]);
        let init = if rng.percent(20) { " := TRUE" } else { "" };
        let tail = match word {
            "output" if rng.percent(40) => " safe TRUE",
            "var" if rng.percent(25) => " retain",
            _ => "",
        };
        out.push_str(&format!("{word} m{i} : BOOL{init}{tail}\n"));
        s.bools.push(format!("m{i}"));
        t.bools.push(format!("m{i}"));
    }
    for i in 0..rng.between(1, 4) {
        let ty = rng.one([
            Type::Int,
            Type::Int,
            Type::Int,
            Type::Sint,
            Type::Dint,
            Type::Uint,
            Type::Usint,
            Type::Lint,
        ]);
        let word = rng.one(["var", "var", "var", "output"]);
        let init = if rng.percent(30) { format!(" := {}", rng.below(6)) } else { String::new() };
        let tail = if word == "var" && rng.percent(20) { " retain" } else { "" };
        out.push_str(&format!("{word} k{i} : {ty}{init}{tail}\n"));
        s.ints.push((format!("k{i}"), ty));
        t.ints.push((format!("k{i}"), ty));
    }
    if rng.percent(25) {
        let ty = rng.one([Type::Real, Type::Lreal]);
        out.push_str(&format!("var x : {ty} := 1.5\n"));
        s.reals.push(("x".to_owned(), ty));
        t.reals.push(("x".to_owned(), ty));
    }
    if rng.percent(30) {
        out.push_str("var w : TIME := 20ms\n");
        s.times.push("w".to_owned());
        t.times.push("w".to_owned());
    }
    if rng.percent(15) {
        out.push_str("var s : STRING(20) := 'ab'\n");
        s.strings.push("s".to_owned());
        t.strings.push("s".to_owned());
    }
    if rng.percent(20) {
        out.push_str("const K : INT := 4\n");
        s.ints.push(("K".to_owned(), Type::Int));
    }
    for i in 0..rng.weighted(&[60, 25, 15]) {
        let kind = rng.one(["TON", "TOF", "TP", "CTU", "CTD", "CTUD", "R_TRIG", "F_TRIG", "SR", "RS"]);
        out.push_str(&format!("var f{i} : {kind}\n"));
        t.blocks.push((format!("f{i}"), kind));
        s.bools.push(match kind {
            "CTUD" => format!("f{i}.QU"),
            "SR" | "RS" => format!("f{i}.Q1"),
            _ => format!("f{i}.Q"),
        });
        if kind.starts_with("CT") {
            s.ints.push((format!("f{i}.CV"), Type::Int));
        }
    }
    arrays(rng, world, out);
}

/// Declares arrays, and offers elements with written and with variable indexes. It draws from a copy of the generator, so
/// that a chart without arrays is the same as before there were arrays.
fn arrays(rng: &Rng, world: &mut World, out: &mut String) {
    let mut rng = rng.clone();
    rng.bits();
    if !rng.percent(30) {
        return;
    }
    let (s, t) = (&mut world.sight, &mut world.targets);
    // Within the bounds of two indexes, whatever its sign.
    let index = format!("{} mod 2", t.ints.first().map_or("1", |(name, _)| name));
    let ty = rng.one([Type::Int, Type::Int, Type::Dint, Type::Usint]);
    let tail = if rng.percent(20) { " retain" } else { "" };
    out.push_str(&format!("var v : ARRAY[1..4] OF {ty} := [{}, 2(3)]{tail}\n", rng.below(5)));
    let mut ints = vec![format!("v[{index} + 2]"), format!("v[{}]", rng.between(1, 4))];
    if ty == Type::Int && rng.percent(50) {
        out.push_str("var z : ARRAY[0..1, -1..1] OF INT := [1, 2, 3, 4]\n");
        ints.push(format!("z[{}, {index}]", rng.below(2)));
        ints.push(format!("z[ABS({index}), 1]"));
        ints.push("z[1, -1]".to_owned());
    }
    for name in ints {
        s.ints.push((name.clone(), ty));
        t.ints.push((name, ty));
    }
    if rng.percent(50) {
        let word = rng.one(["var", "output"]);
        out.push_str(&format!("{word} y : ARRAY[0..2] OF BOOL\n"));
        for name in [format!("y[{index} + 1]"), "y[0]".to_owned(), "y[2]".to_owned()] {
            s.bools.push(name.clone());
            t.bools.push(name);
        }
    }
}

/// The outputs of qualified actions, separated into the classes that each profile distinguishes.
fn driven(rng: &mut Rng, world: &mut World, out: &mut String) {
    use Qualifier::{N, P, P0, P1, R, S};
    for i in 0..rng.between(2, 5) {
        let name = format!("Q{i}");
        let t = duration(rng);
        let timed: Vec<Qualifier> = Qualifier::ALL.into_iter().filter(|q| q.timed()).collect();
        let timed = rng.pick(&timed).copied().unwrap_or(Qualifier::L);
        let text = |list: &[Qualifier]| list.iter().map(|q| q.name().to_owned()).collect::<Vec<_>>();
        let qualifiers = if world.profile == ProfileName::Iec60848 {
            match rng.weighted(&[40, 25, 35]) {
                0 => {
                    let mut all = text(&[N, N]);
                    all.push(format!("L {t}"));
                    all.push(format!("D {}", duration(rng)));
                    all
                }
                1 => text(&[S, R]),
                _ => {
                    let mut all = text(&[P, P1, P0, S, R]);
                    if timed.lasting() == Lasting::UntilReset {
                        all.push(format!("{} {t}", timed.name()));
                    }
                    all
                }
            }
        } else {
            let mut all = text(&[N, N]);
            for q in [S, R, R, P, P1, P0] {
                if rng.percent(35) {
                    all.push(q.name().to_owned());
                }
            }
            if rng.percent(60) {
                all.push(format!("{} {t}", timed.name()));
            }
            all
        };
        let safe = if rng.percent(20) { " safe TRUE" } else { "" };
        out.push_str(&format!("output {name} : BOOL{safe}\n"));
        // A variable that is driven at the end of a scan can be read like any other.
        world.sight.bools.push(name.clone());
        world.driven.push(Driven { name, qualifiers });
    }
}

fn functions(rng: &mut Rng, world: &mut World, out: &mut String) {
    if rng.percent(20) {
        out.push_str("function Sum(p : INT, q : INT) : INT { var h : INT := 1 ");
        out.push_str(rng.one([
            "h := h + p; Sum := h + q; }\n",
            "IF p > q THEN Sum := p - q; RETURN; END_IF; Sum := h; }\n",
            "FOR h := 1 TO 3 DO Sum := Sum + q; END_FOR; }\n",
        ]));
        world.sight.int_functions.push("Sum".to_owned());
    }
    if rng.percent(20) {
        out.push_str("function Odd(p : INT) : BOOL { Odd := p mod 2 = 1; }\n");
        world.sight.bool_functions.push("Odd".to_owned());
    }
}

fn named_actions(rng: &mut Rng, world: &mut World, sight: &Sight, out: &mut String) {
    for i in 0..rng.weighted(&[55, 30, 15]) {
        let name = format!("Act{i}");
        let text = body::block(rng, sight, &mut world.targets);
        out.push_str(&format!("action {name} {text}\n"));
        let t = duration(rng);
        let qualifiers = match rng.below(7) {
            0 => "P1".to_owned(),
            1 => "P0".to_owned(),
            2 => "N,S,R".to_owned(),
            3 => format!("N,L {t},R"),
            4 => format!("N,SD {t},R"),
            5 => format!("P,D {t}"),
            _ => "N".to_owned(),
        };
        world.named.push((name, qualifiers));
    }
}

/// The names that are visible outside of all charts: steps as `Chart.X`.
fn outside(world: &World, skeleton: &Skeleton) -> Sight {
    let mut sight = world.sight.clone();
    for chart in skeleton.charts.iter().filter(|c| c.word == "chart") {
        see_steps(&mut sight, chart, &format!("{}.", chart.name));
    }
    sight
}

fn see_steps(sight: &mut Sight, chart: &SkeletonChart, prefix: &str) {
    for step in &chart.steps {
        sight.steps.push(format!("{prefix}X{}", step.name));
        // In a chart with a period, the time may count other scans than those of the chart.
        if !chart.periodic {
            sight.step_times.push(format!("{prefix}X{}.t", step.name));
        }
    }
}

fn pre(rng: &mut Rng, world: &mut World, sight: &Sight, skeleton: &Skeleton) -> String {
    let mut text = body::block(rng, sight, &mut world.targets);
    let services = match world.profile {
        // A service takes effect at once, even on a chart with a period.
        _ if skeleton.charts.iter().any(|c| c.every.is_some()) => return text,
        ProfileName::Pl7 => pl7(rng, sight),
        ProfileName::Unity => unity(rng, sight, skeleton),
        ProfileName::Iec60848 | ProfileName::Iec61131 | ProfileName::Jgrafchart => return text,
    };
    text.truncate(text.len() - 1);
    format!("{text}{services} }}")
}

fn pl7(rng: &mut Rng, sight: &Sight) -> String {
    let when = sight.boolean(rng, 1);
    match rng.below(7) {
        0 => format!("IF rise({when}) THEN %S21 := TRUE; END_IF"),
        1 => format!("IF rise({when}) THEN %S22 := TRUE; END_IF"),
        2 => format!("%S23 := {when};"),
        3 => format!("IF {when} THEN %SW22 := {}; %S24 := TRUE; END_IF", rng.below(32_000)),
        4 => format!("IF {when} THEN RESET_XIT(); END_IF"),
        5 => format!("IF %SW20 > 3 and {when} THEN %S21 := TRUE; END_IF"),
        _ => String::new(),
    }
}

fn unity(rng: &mut Rng, sight: &Sight, skeleton: &Skeleton) -> String {
    let charts: Vec<&SkeletonChart> =
        skeleton.charts.iter().filter(|c| c.word == "chart" && c.every.is_none() && !c.enclosed).collect();
    let Some(chart) = rng.pick(&charts) else { return String::new() };
    let when = sight.boolean(rng, 1);
    let name = &chart.name;
    let step = rng.pick(&chart.steps).map_or("1", |s| &s.name);
    match rng.below(6) {
        0 => format!("IF rise({when}) THEN INITCHART({name}); END_IF"),
        1 => format!("IF rise({when}) THEN CLEARCHART({name}); END_IF"),
        2 => format!("FREEZECHART({name}, {when});"),
        3 => format!("IF rise({when}) THEN SETSTEP({name}.X{step}); END_IF"),
        4 => format!("IF rise({when}) THEN RESETSTEP({name}.X{step}); END_IF"),
        _ => String::new(),
    }
}

fn chart(rng: &mut Rng, world: &mut World, skeleton: &Skeleton, at: usize, out: &mut String) {
    let chart = &skeleton.charts[at];
    let mut sight = world.sight.clone();
    see_steps(&mut sight, chart, "");
    for (i, other) in skeleton.charts.iter().enumerate() {
        if i != at && other.word == "chart" {
            see_steps(&mut sight, other, &format!("{}.", other.name));
        }
    }
    let every = chart.every.map(|ms| format!(" every {ms}ms")).unwrap_or_default();
    out.push_str(&format!("{} {}{every} {{\n", chart.word, chart.name));
    // A chart with a period drives only outputs of its own.
    let mut driven = world.driven.clone();
    let mut named = world.named.clone();
    if chart.periodic && chart.every.is_none() {
        named.clear();
        driven.clear();
    } else if chart.every.is_some() {
        named.clear();
        driven.clear();
        out.push_str("  var own : BOOL\n");
        sight.bools.push("own".to_owned());
        driven.push(Driven { name: "own".to_owned(), qualifiers: vec!["N".to_owned()] });
    } else if rng.percent(25) {
        out.push_str("  var j : INT\n");
        sight.ints.push(("j".to_owned(), Type::Int));
        world.targets.ints.push(("j".to_owned(), Type::Int));
    }
    for step in &chart.steps {
        let star = if step.linked { " *" } else { "" };
        let expansion = step.expansion.as_ref().map(|e| format!(" = {e}")).unwrap_or_default();
        out.push_str(&format!("  {} {}{expansion}{star} {{\n", step.head, step.name));
        for order in &step.orders {
            out.push_str(&format!("    {order}\n"));
        }
        let actions =
            if step.expansion.is_some() { rng.weighted(&[75, 25]) } else { rng.weighted(&[30, 40, 22, 8]) };
        let (mut driven, mut named) = (driven.clone(), named.clone());
        let mut moments = Vec::new();
        for _ in 0..actions {
            let profile = world.profile;
            if let Some(a) = body::action(rng, profile, &sight, &mut world.targets, &mut driven, &mut named) {
                // A moment assigns one value to a variable.
                let moment = a.split_once(" :=").map(|(m, _)| m.to_owned());
                if moment.is_none() || !moments.contains(&moment) {
                    out.push_str(&format!("    {a}\n"));
                    moments.push(moment);
                }
            }
        }
        out.push_str("  }\n");
    }
    if rng.percent(world.weights.sections / 4) {
        let text = body::block(rng, &sight, &mut world.targets);
        out.push_str(&format!("  {} {text}\n", rng.one(["pre", "post"])));
    }
    for (from, to) in &chart.arcs {
        let names = |list: &[usize]| match list {
            [one] => chart.steps[*one].name.clone(),
            all => {
                let names: Vec<&str> = all.iter().map(|i| &*chart.steps[*i].name).collect();
                format!("({})", names.join(", "))
            }
        };
        let mut sight = sight.clone();
        if world.single {
            sight.risk = 0; // the engine decides which receptivities are evaluated
        }
        let when = receptivity(rng, world, &sight, from.is_empty(), chart.periodic);
        out.push_str(&format!("  {} -> {} when {when}", names(from), names(to)));
        if rng.percent(12) {
            out.push_str(&format!(" priority {}", rng.between(1, 3)));
        }
        if rng.percent(10) {
            out.push_str(&format!(" on clearing {}", body::block(rng, &sight, &mut world.targets)));
        }
        out.push('\n');
    }
    out.push_str("}\n");
    world.targets.ints.retain(|(n, _)| n != "j");
}

/// A random receptivity. While the search for stability goes on, a receptivity that stays true
/// makes most charts unstable, so events are more common.
fn receptivity(rng: &mut Rng, world: &mut World, sight: &Sight, source: bool, periodic: bool) -> String {
    // A section of the file samples its edges in every scan.
    if !periodic
        && rng.percent(30)
        && let Some(section) = world.sections.pop()
    {
        // The section is computed only where its output is the whole receptivity.
        return section;
    }
    let input = rng.pick(&sight.inputs).cloned().unwrap_or_else(|| "TRUE".to_owned());
    if source {
        return format!("↑{input} and {}", sight.boolean(rng, 1));
    }
    let calm = if world.stable { [30, 20, 24, 10, 14, 2] } else { [20, 15, 20, 25, 12, 8] };
    match rng.weighted(&calm) {
        0 => sight.edge(rng, 1),
        1 => format!("({} and {})", sight.edge(rng, 0), sight.boolean(rng, 1)),
        2 if rng.percent(50) => format!("not {input}"),
        2 => input,
        3 => sight.boolean(rng, 2),
        4 => sight.timer(rng, 1),
        _ => "=1".to_owned(),
    }
}
