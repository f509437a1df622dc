//! Tests of the writer for Control Expert: a document that is written and read again is the same, and runs the same.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use g7_compile::Compiled;
use g7_engine::State;
use g7_model::{
    Document, FileId, Item, Name, Place, Profile, ProfileName, Severity, StepKind, Transition, Type, VarKind,
};

use crate::support::{self, corpus, errors, own, text_of};

pub(crate) fn parse(text: &str) -> Document {
    let (document, problems) = g7_syntax::parse(text, FileId(0));
    assert_eq!(errors(&problems), Vec::<&str>::new(), "{text}");
    document
}

/// The file of a document that is written without errors; it is well-formed and has one drawing of each cell.
fn written(name: &str, document: &Document) -> String {
    let written = support::export("controlexpert", document);
    assert_eq!(errors(&written.problems), Vec::<&str>::new(), "{name}");
    one_object_in_each_cell(name, &written.text);
    written.text
}

/// The document that comes back, which has no errors.
fn back(name: &str, text: &str) -> Document {
    let (document, problems) = support::read("controlexpert", text.as_bytes());
    assert_eq!(errors(&problems), Vec::<&str>::new(), "{name}\n{text}");
    document
}

fn one_object_in_each_cell(name: &str, text: &str) {
    let tree = roxmltree::Document::parse(text).unwrap_or_else(|e| panic!("{name}: {e}\n{text}"));
    for network in tree.descendants().filter(|n| n.has_tag_name("networkSFC")) {
        let mut cells = BTreeSet::new();
        for object in network
            .children()
            .filter(|n| ["step", "transition", "jumpSFC", "textBox"].iter().any(|tag| n.has_tag_name(*tag)))
        {
            let place = object.children().find(|n| n.has_tag_name("objPosition")).expect("a place");
            let spot = (place.attribute("posX"), place.attribute("posY"));
            assert!(cells.insert(spot), "{name}: two objects in {spot:?}\n{text}");
        }
    }
}

/// The steps before and behind a transition, and its rank among those behind the same steps.
type Ends = (Vec<usize>, Vec<usize>, usize);

/// Transitions without regard to their order and that of their ends, with the rank among those behind one step.
fn links(document: &Document) -> Vec<BTreeSet<Ends>> {
    let of_chart = |steps: Vec<&str>, transitions: Vec<&Transition>| {
        let numbers = |names: &[Name]| {
            let mut list: Vec<usize> =
                names.iter().filter_map(|n| steps.iter().position(|s| *s == &*n.text)).collect();
            list.sort_unstable();
            list.dedup();
            list
        };
        let mut list: Vec<_> = transitions.iter().enumerate().collect();
        list.sort_by_key(|(i, t)| (t.priority.unwrap_or(u32::MAX), *i));
        let mut seen: BTreeMap<Vec<usize>, usize> = BTreeMap::new();
        let ranked = list.into_iter().map(|(_, t)| {
            let from = numbers(&t.from);
            let rank = seen.entry(from.clone()).or_default();
            *rank += 1;
            (from, numbers(&t.to), *rank)
        });
        ranked.collect::<BTreeSet<_>>()
    };
    let named =
        |c: &g7_model::Chart| of_chart(c.steps().map(|s| &*s.name.text).collect(), c.transitions().collect());
    document.charts().map(named).collect()
}

/// A document that was read from a file goes out, comes in, and goes out again as the same text; its text in
/// our language is the same but for the order of transitions and what a file cannot tell.
fn comes_back(name: &str, document: &Document) -> Document {
    let first = written(name, document);
    let again = back(name, &first);
    assert_eq!(links(document), links(&again), "{name}\n{first}");
    let second = written(name, &again);
    assert_eq!(first, second, "{name}");
    again
}

/// The lines of the text without the drawing, in the order of the alphabet.
fn plain(document: &Document) -> Vec<String> {
    let items = document.items.iter().filter(|i| !matches!(i, Item::Layout(_))).cloned().collect();
    let text = text_of(&Document { items, notes: Vec::new() });
    let mut lines: Vec<String> =
        text.lines().map(str::trim).filter(|l| !l.is_empty()).map(str::to_string).collect();
    lines.sort();
    lines
}

#[test]
fn what_is_read_comes_back() {
    let mut files = vec![("cell.xsf".to_string(), own("controlexpert", "cell.xsf"))];
    files.push(("branches.xsf".to_string(), own("controlexpert", "branches.xsf")));
    files.extend(corpus("control-expert-xsf", &["Robot.xml"]));
    for (name, bytes) in files {
        let (document, problems) = support::import("controlexpert", &bytes, FileId(0));
        assert_eq!(errors(&problems), Vec::<&str>::new(), "{name}");
        let again = comes_back(&name, &document);
        // A member of a structure whose type the file does not have is a variable of its own.
        let flat = |lines: Vec<String>| -> Vec<String> {
            let mut lines: Vec<String> = lines.iter().map(|l| members_as_words(l)).collect();
            lines.sort();
            lines
        };
        assert_eq!(flat(plain(&document)), flat(plain(&again)), "{name}");
        runs_the_same(&name, &document, &again);
    }
}

/// `` `a.b` `` as `a_b` of at most 32 letters, the name that the file gives to it; an output without an address as a plain variable.
fn members_as_words(line: &str) -> String {
    let line = match line.strip_prefix("output ") {
        Some(rest) if !rest.contains(" at ") => format!("var {rest}"),
        _ => line.to_string(),
    };
    let parts = line.split('`').enumerate();
    let word = |part: &str| part.replace('.', "_").chars().take(32).collect::<String>();
    parts.map(|(i, part)| if i % 2 == 1 { word(part) } else { part.to_string() }).collect()
}

#[test]
fn an_application_is_more_than_a_section() {
    let (mixer, _) = support::import("controlexpert", &own("controlexpert", "mixer.xef"), FileId(0));
    let told = support::export("controlexpert", &mixer).problems;
    let wanted = "a body before or behind the evolution: a section in SFC has none; write it as a section in Structured Text";
    assert_eq!(errors(&told), [wanted, wanted]);
    for (name, bytes) in corpus("control-expert-xsf", &[".XEF"]) {
        let (document, _) = support::import("controlexpert", &bytes, FileId(0));
        let told = support::export("controlexpert", &document).problems;
        let second = errors(&told).iter().filter(|e| e.starts_with("a second chart")).count();
        assert_eq!(second, 2, "{name}: {told:#?}");
        // Each of its charts alone goes out.
        for chart in document.charts().map(|c| c.name.text.clone()).collect::<Vec<_>>() {
            let mut alone = document.clone();
            alone.items.retain(|i| !matches!(i, Item::Chart(c) if c.name.text != chart));
            comes_back(&chart, &alone);
        }
    }
    // Without its text sections the mixer goes out.
    let mut alone = mixer;
    alone.items.retain(|i| !matches!(i, Item::Pre(..) | Item::Post(..)));
    let again = comes_back("mixer", &alone);
    runs_the_same("mixer", &alone, &again);
}

/// A document that runs.
struct Run {
    compiled: Compiled,
    state: State,
    inputs: Vec<u64>,
    /// Steps and variables, in an order that both documents have.
    steps: Vec<u32>,
    variables: Vec<(String, Type, VarKind)>,
}

impl Run {
    fn new(document: &Document) -> Run {
        let (compiled, problems) = g7_compile::compile(document);
        let compiled = compiled.unwrap_or_else(|| panic!("{problems:#?}\n{}", text_of(document)));
        let state = State::new(&compiled.program);
        let rows = compiled.program.tables().inputs;
        let inputs = vec![0; (rows.end - rows.start) as usize];
        let (steps, variables) = (steps(document), variables(document));
        Run { compiled, state, inputs, steps, variables }
    }

    fn set(&mut self, number: usize, value: u64) {
        let first = self.compiled.program.tables().inputs.start;
        let Some(variable) = self.compiled.symbols.variable(&self.variables[number].0) else { return };
        let place = variable.addr.0.checked_sub(first).and_then(|at| self.inputs.get_mut(at as usize));
        place.into_iter().for_each(|word| *word = value);
    }

    /// One scan: the numbers of the active steps and the values; None after a fault.
    fn scan(&mut self, now: i64) -> Option<(Vec<usize>, Vec<Vec<u64>>)> {
        g7_engine::scan(&self.compiled.program, &mut self.state, &self.inputs, now).ok()?;
        // Steps have their numbers in the order of the text.
        let active: BTreeSet<u32> = self.state.active().map(|s| s.0).collect();
        let is_active = |id: &&u32| active.contains(id);
        let numbers: Vec<usize> =
            self.steps.iter().enumerate().filter(|(_, id)| is_active(id)).map(|(i, _)| i).collect();
        let value = |(name, ty, _): &(String, Type, VarKind)| {
            let variable = self.compiled.symbols.variable(name).filter(|_| !matches!(ty, Type::Fb(_)));
            variable.map(|v| v.value(&self.state).to_vec()).unwrap_or_default()
        };
        Some((numbers, self.variables.iter().map(value).collect()))
    }
}

/// The numbers of the steps, those of the chart before those of expansions.
fn steps(document: &Document) -> Vec<u32> {
    let inner = |c: &g7_model::Chart| c.kind != g7_model::ChartKind::Chart;
    let all = document.charts().flat_map(|c| c.steps().map(move |_| inner(c)));
    let mut numbers: Vec<(bool, u32)> = all.zip(0..).collect();
    numbers.sort_unstable();
    numbers.into_iter().map(|(_, id)| id).collect()
}

fn variables(document: &Document) -> Vec<(String, Type, VarKind)> {
    let mut list = Vec::new();
    for item in &document.items {
        match item {
            Item::Var(v) => list.extend(v.names.iter().map(|n| (n.text.to_string(), v.ty, v.kind))),
            Item::Chart(c) => {
                for v in c.vars() {
                    let name = |n: &Name| (format!("{}.{}", c.name.text, n.text), v.ty, v.kind);
                    list.extend(v.names.iter().map(name));
                }
            }
            _ => {}
        }
    }
    list
}

/// Runs a document and what came back of it side by side, under inputs at random.
fn runs_the_same(name: &str, document: &Document, back: &Document) {
    for seed in 1..9u64 {
        let (mut one, mut two) = (Run::new(document), Run::new(back));
        assert_eq!(one.variables.len(), two.variables.len(), "{name}\n{}", text_of(back));
        let mut random = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15);
        for scan in 0..80 {
            for number in 0..one.variables.len() {
                random =
                    random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                let (_, ty, kind) = one.variables[number];
                let value = match ty {
                    Type::Bool => random >> 63,
                    ty if ty.is_integer() => random >> 61,
                    _ => continue,
                };
                if kind == VarKind::Input {
                    one.set(number, value);
                    two.set(number, value);
                }
            }
            let now = scan * 10_000_000;
            let (mut a, mut b) = (one.scan(now), two.scan(now));
            // An input that nothing reads is a variable there, and has no value from outside.
            for list in [&mut a, &mut b].into_iter().flatten() {
                let given = one.variables.iter().map(|v| v.2 == VarKind::Input);
                list.1.iter_mut().zip(given).filter(|(_, g)| *g).for_each(|(value, _)| value.clear());
            }
            assert_eq!(a, b, "{name}: scan {scan}\n{}\n{}", text_of(document), text_of(back));
            if a.is_none() {
                break;
            }
        }
    }
}

/// The document under the rules of Control Expert.
fn under_unity(mut document: Document) -> Document {
    if document.profile().map(|p| p.name) != Some(ProfileName::Unity) {
        document.items.retain(|i| !matches!(i, Item::Profile(_)));
        let profile = Profile { name: ProfileName::Unity, switches: Vec::new(), at: Place::default() };
        document.items.insert(0, Item::Profile(profile));
    }
    document
}

fn files(folder: &[&str], ending: &str) -> Vec<PathBuf> {
    let root: PathBuf = [env!("CARGO_MANIFEST_DIR"), "..", ".."].iter().chain(folder).collect();
    let mut found = Vec::new();
    let mut folders = vec![root];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).expect("a folder of the repository").flatten() {
            let path = entry.path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == ending) {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

/// The charts of the conformance cases and of the examples. Charts of the profile `iec61131` keep it; all others
/// get the profile `unity`.
fn charts() -> Vec<(String, Document)> {
    let mut charts = Vec::new();
    let folders = ["unity", "side-by-side", "litmus", "iec61131", "iec60848", "pl7"];
    for (folder, path) in
        folders.iter().flat_map(|f| files(&["tests", "spec", f], "md").into_iter().map(move |p| (*f, p)))
    {
        let text = String::from_utf8(std::fs::read(&path).expect("a case")).expect("UTF-8");
        let chart = text.split("```g7\n").nth(1).and_then(|t| t.split("\n```").next()).expect("a chart");
        let (document, problems) = g7_syntax::parse(chart, FileId(0));
        if errors(&problems).is_empty() {
            let name = path.file_stem().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
            let own = document.profile().is_some_and(|p| p.name == ProfileName::Iec61131);
            charts.push((format!("{folder}/{name}"), if own { document } else { under_unity(document) }));
        }
    }
    for path in files(&["examples"], "g7") {
        let text = String::from_utf8(std::fs::read(&path).expect("an example")).expect("UTF-8");
        charts.push((path.display().to_string(), under_unity(parse(&text))));
    }
    // The charts of instances go out, and plain variables.
    let instances = |(name, d): (String, Document)| {
        let charts = g7_model::instances::instantiated(&d).0.into_owned();
        (name, g7_model::composed::decomposed(&charts).0.into_owned())
    };
    let mut charts: Vec<(String, Document)> = charts.into_iter().map(instances).collect();
    charts.retain(|(_, d)| g7_compile::compile(d).0.is_some() && d.charts().next().is_some());
    charts
}

#[test]
fn conformance_cases_and_examples_run_as_before() {
    let mut carried = Vec::new();
    let mut reasons: BTreeMap<String, usize> = BTreeMap::new();
    let all = charts();
    for (name, document) in &all {
        let file = support::export("controlexpert", document);
        if let Some(error) = file.problems.iter().find(|p| p.severity() == Severity::Error) {
            *reasons.entry(error.what.to_string()).or_default() += 1;
            continue;
        }
        one_object_in_each_cell(name, &file.text);
        let again = back(name, &file.text);
        assert_eq!(links(document), links(&again), "{name}\n{}", file.text);
        runs_the_same(name, document, &again);
        comes_back(name, &again);
        carried.push(name.as_str());
    }
    println!("{} of {} charts go out; {reasons:#?}", carried.len(), all.len());
    for name in ["unity/single-token", "unity/switch-pulse-first", "unity/transition-section-short"] {
        assert!(carried.contains(&name), "{name} is not carried: {carried:#?}");
    }
    assert!(carried.len() > 60, "{carried:#?}");
}

/// Numbers at random.
struct Random(u64);

impl Random {
    fn below(&mut self, limit: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % limit
    }

    fn of<'a>(&mut self, list: &[&'a str]) -> &'a str {
        list[self.below(list.len())]
    }
}

/// A chart at random: steps with actions, and transitions between one or several of them.
fn chart(seed: u64) -> String {
    let mut random = Random(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15));
    let actions = [
        "N v",
        "S w",
        "R w",
        "D 20ms v",
        "L 30ms u",
        "DS 20ms w",
        "P u",
        "P1 n := n + 1",
        "P0 n := n * 2",
        "N m := n",
        "N m := m + 1 if a",
    ];
    let conditions = [
        "a",
        "b",
        "not c",
        "a and not b",
        "↑a",
        "↓b or c",
        "S0.t >= 20ms",
        "S1.X and c",
        "n < 5",
        "TRUE",
        "30ms/XS1",
    ];
    let steps = 2 + random.below(7);
    let mut text = String::from(
        "profile unity input a, b, c : BOOL output u, v : BOOL var w : BOOL var n, m : INT\nchart G {\n",
    );
    for step in 0..steps {
        let list: Vec<&str> = (0..random.below(3)).map(|_| random.of(&actions)).collect();
        let word = if step == 0 { "initial step" } else { "step" };
        text += &format!("{word} S{step} {{\n{}\n}}\n", list.join("\n"));
    }
    for _ in 0..steps + random.below(6) {
        let mut ends = || {
            let count = if random.below(5) == 0 { 2 } else { 1 };
            let set: BTreeSet<usize> = (0..count).map(|_| random.below(steps)).collect();
            format!("({})", set.iter().map(|s| format!("S{s}")).collect::<Vec<_>>().join(", "))
        };
        let (from, to) = (ends(), ends());
        text += &format!("{from} -> {to} when {}\n", random.of(&conditions));
    }
    text + "}\n"
}

#[test]
fn charts_at_random_run_as_before() {
    let mut carried = 0;
    for seed in 1..600 {
        let (document, problems) = g7_syntax::parse(&chart(seed), FileId(0));
        if !errors(&problems).is_empty() || g7_compile::compile(&document).0.is_none() {
            continue;
        }
        let file = support::export("controlexpert", &document);
        if !errors(&file.problems).is_empty() {
            continue;
        }
        let name = format!("seed {seed}");
        one_object_in_each_cell(&name, &file.text);
        let again = back(&name, &file.text);
        assert_eq!(links(&document), links(&again), "{name}\n{}", file.text);
        runs_the_same(&name, &document, &again);
        carried += 1;
    }
    assert!(carried > 150, "{carried}");
}

#[test]
fn macro_steps_go_out_with_their_expansions() {
    let document = parse(
        "profile unity input a, b : BOOL
         chart G { initial step 1 macro M = Inside 1 -> M when a -> 1 when b and Inside.X3 }
         macrochart Inside { entry step 2 exit step 3 2 -> 3 when a }",
    );
    let file = support::export("controlexpert", &document);
    assert_eq!(errors(&file.problems), Vec::<&str>::new());
    let again = back("a macro-step", &file.text);
    let kinds: Vec<StepKind> = again.charts().flat_map(|c| c.steps()).map(|s| s.kind.clone()).collect();
    let inner = StepKind::Macro(Name { text: "M".into(), at: Place::default() });
    assert_eq!(kinds, [StepKind::Plain, inner, StepKind::Entry, StepKind::Exit]);
    runs_the_same("a macro-step", &document, &again);
}
