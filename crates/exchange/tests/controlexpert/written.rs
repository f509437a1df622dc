//! Documents as sections of Control Expert: what is read comes back, what runs runs the same, what
//! cannot be said is a problem with its place.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use g7_compile::Compiled;
use g7_engine::State;
use g7_model::{
    Document, FileId, Item, Name, Place, Profile, ProfileName, Severity, StepKind, Transition, Type, VarKind,
};

use crate::support::{self, corpus, errors, lines, own, text_of};

fn parse(text: &str) -> Document {
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

/// Transitions without regard to their order and that of their ends, with the rank among those behind one step.
fn links(document: &Document) -> Vec<BTreeSet<(Vec<usize>, Vec<usize>, usize)>> {
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

/// What was read from a file goes out, comes in, and goes out again as the same text; its text in
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

/// A document at work.
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

/// The charts of the conformance cases and of the examples, under the rules of Control Expert unless they are
/// those of IEC 61131-3.
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
        "S0.T >= 20ms",
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

/// The problems of writing a text.
fn said(text: &str) -> Vec<String> {
    lines(text.as_bytes(), &support::export("controlexpert", &parse(text)).problems)
}

#[test]
fn a_file_has_the_form_of_the_tool_s_own() {
    let text = "profile unity
        input go, stop : BOOL at %I0.1.0
        input lid : BOOL
        output motor : BOOL at %Q0.2.0
        var n : INT := -3  var t1 : TON  var s : STRING(20)
        chart Fill {
          initial step 1 \"rest\" { R motor }
          step Run { DS 1s500ms motor  P1 n := n + 1  N { t1(IN := lid, PT := 2s); IF ↓lid AND Run.T >= 3s THEN n := 0; END_IF } }
          1 -> Run when ↑go and not lid
          Run -> 1 when not stop \"why\"
          Run -> 1 when 3s/XRun
        }";
    let file = support::export("controlexpert", &parse(text));
    assert_eq!(
        lines(text.as_bytes(), &file.problems),
        [
            "G0614 3: `lid` has no address such as %I0.1.0: it is a plain variable there",
            "G0611 7: `1` is called `S1` there",
        ]
    );
    let squeezed: String = file.text.split_whitespace().collect::<Vec<_>>().join(" ").replace("> <", "><");
    for part in [
        r#"<SFCExchangeFile><fileHeader company="G7" product="Control Expert" content="SFC source file" DTDVersion="41"/><contentHeader name="Fill" version="0.0.000"/>"#,
        r#"<SFCProgram areaNum="0" operatorCtrl="0"><identProgram name="Fill" type="section" task="MAST"/><chartSource name="Chart"><networkSFC>"#,
        r#"<step stepType="initialStep" stepName="S1"><objPosition posX="0" posY="0"/><action qualifier="R"><actionName><variableName>motor</variableName></actionName><tValue><tLiteral/></tValue></action><literals max="" min="" delay=""/><comment>rest</comment></step>"#,
        r#"<action qualifier="DS"><actionName><variableName>motor</variableName></actionName><tValue><tLiteral>T#1s500ms</tLiteral></tValue></action>"#,
        r#"<action qualifier="P1"><actionName><sectionName>Run_2</sectionName></actionName>"#,
        r#"<altBranch width="2" relativePos="0"><objPosition posX="0" posY="3"/></altBranch>"#,
        r#"<transitionCondition invertLogic="false"><sectionName>T1_2</sectionName></transitionCondition>"#,
        r#"<transitionCondition invertLogic="true"><variableName>stop</variableName></transitionCondition><comment>why</comment></transition>"#,
        r#"<jumpSFC stepName="S1"><objPosition posX="1" posY="4"/></jumpSFC>"#,
        r#"<actionSource name="Run_2"><STSource>n := n + 1;</STSource></actionSource>"#,
        r#"t1(IN := lid, PT := T#2s); IF FE(lid) AND Run.t &gt;= T#3s THEN n := 0; END_IF;"#,
        r#"<STSource>RE(go) AND NOT lid</STSource>"#,
        r#"<STSource>Run.x AND Run.t &gt;= T#3s</STSource>"#,
        r#"<variables name="go" typeName="EBOOL" topologicalAddress="%I0.1.0"/>"#,
        r#"<variables name="lid" typeName="EBOOL"/>"#,
        r#"<variables name="n" typeName="INT"><variableInit value="-3"/></variables>"#,
        r#"<variables name="s" typeName="STRING[20]"/>"#,
    ] {
        assert!(squeezed.contains(part), "{part}\n{squeezed}");
    }
}

#[test]
fn what_cannot_be_said_is_a_problem_with_its_place() {
    let none = |line: u32, what: &str| format!("G0604 {line}: {what}: Control Expert has none");
    let drop =
        |line: u32, what: &str| format!("G0605 {line}: {what}: Control Expert has none; it is left out");
    assert_eq!(
        said(
            "profile unity
             scan 20ms
             target tsx57
             input a : BOOL
             var k : INT  var l : LREAL  var r : BOOL retain  const c : INT := 2 + 1
             function f(x : INT) : INT { f := x }
             pre { k := 1 }
             chart G every 40ms {
               initial step 1 { N k := 1 if r  N r if a  SD 1s r  on ↑a: k := 2 }
               step 2 { force H := {}  D 1500us r  P1 { IF a THEN SETSTEP(X1) END_IF } }
               t7: 1 -> 2 when 2s/a on clearing { k := 0 }
               2 -> () when a
               () -> 2 when a
               post { k := 0 }
             }
             chart H { enclosing step 5 { enclose I } initial step 6 6 -> 5 when a }
             chart I { step 7 * }
             test \"t\" { scan }"
        ),
        [
            "G0605 2: the time of a scan is left out: it belongs to the task MAST there".to_string(),
            drop(3, "a target"),
            "G0614 4: `a` has no address such as %I0.1.0: it is a plain variable there".to_string(),
            none(5, "a variable of the type LREAL"),
            drop(5, "the word `retain`"),
            "G0614 5: the constant `c` is a variable there".to_string(),
            none(5, "an initial value that is worked out"),
            none(6, "a function"),
            "G0604 7: a body before or behind the evolution: a section in SFC has none; write it as a section in Structured Text".to_string(),
            none(8, "a period of such a chart"),
            "G0611 9: `1` is called `S1` there; 4 more names are changed as well".to_string(),
            none(12, "a transition without a step behind it"),
            none(13, "a transition without a step before it"),
            "G0604 14: a body before or behind the evolution: a section in SFC has none; write it as a section in Structured Text".to_string(),
            "G0604 16: a second chart `H`: the file holds one section".to_string(),
            "G0604 17: a second chart `I`: the file holds one section".to_string(),
            drop(18, "a test"),
        ]
    );
    // A chart that has no drawing is not looked at further; this one has.
    assert_eq!(
        said(
            "profile unity
             input a : BOOL at %I0.1.0
             var k : INT  var r : BOOL
             chart G {
               initial step 1 { N k := 1 if r  N r if a  SD 1s r  on ↑a: k := 2 }
               step 2 { force G := {}  D 1500us r  P1 { IF a THEN SETSTEP(X1) END_IF }  P0 k := 0 if a }
               t7: 1 -> 2 when 2s/a on clearing { k := 0 }
               2 -> 1 when ↑(a or r)
               2 -> 1 when LEN('x') = 1
               2 -> 1 when ↑r
             }"
        ),
        [
            "G0611 5: `1` is called `S1` there; 1 more names are changed as well".to_string(),
            none(5, "such a condition of an action"),
            none(5, "a condition of an action"),
            none(5, "the qualifier `SD`"),
            none(5, "an action on event"),
            none(6, "a forcing order"),
            none(6, "a TIME of parts of a millisecond, or above 49 days"),
            none(6, "a call of `SETSTEP` in an action"),
            none(6, "such a condition of an action"),
            "G0605 7: the label of a transition: Control Expert has none; it is left out".to_string(),
            none(7, "a delay of something other than the activity of a step"),
            none(7, "an action on clearing"),
            none(8, "an edge of something other than a variable"),
            none(9, "the function `LEN`"),
            "G0614 10: an edge of `r`, which is no input: it lasts there until the variable is written again"
                .to_string(),
        ]
    );
}

#[test]
fn joints_and_branches_that_the_grid_cannot_have_are_refused() {
    let joint = "on the grid the joint stands directly below its steps";
    let branch = "on the grid the branch stands directly above its steps";
    assert_eq!(
        said(
            "profile unity
             input go : BOOL at %I0.1.0
             chart G { initial step A step B step C step D
               A -> (B, C) when go
               (B, C) -> D when go
               C -> A when go
               D -> (C, A) when go }"
        ),
        [
            format!("G0604 5: a transition behind several steps, where `C` has another one besides: {joint}"),
            format!(
                "G0604 7: a transition before several steps, where `C` begins other branches too: {branch}"
            ),
        ]
    );
}

/// A chart under a profile, with these transitions behind its first step, and these actions in the second.
fn under(profile: &str, transitions: &str, actions: &str) -> Vec<String> {
    let text = format!(
        "{profile} input a, b : BOOL at %I0.1.0 var n : INT
         chart G {{ initial step 1 step 2 {{ {actions} }} step 3 {transitions} 2 -> 1 when b 3 -> 1 when a }}"
    );
    said(&text).into_iter().filter(|t| t.starts_with("G0604")).collect()
}

#[test]
fn other_rules_of_evolution_are_refused_where_they_matter() {
    let fork = "1 -> 2 when a 1 -> 3 when b";
    let apart = "1 -> 2 when a and b 1 -> 3 when not a";
    let one = "1 -> 2 when a";
    let rule = |word: &str| {
        vec![format!(
            "G0604 1: the rule `{word}`, which this chart depends on; Control Expert has those of `unity`"
        )]
    };
    let fine: Vec<String> = Vec::new();
    assert_eq!(under("profile unity", fork, "N n := n + 1"), fine);
    for other in ["iec60848", "pl7", "jgrafchart"] {
        let what =
            format!("G0604 1: the rules of evolution of `{other}`; Control Expert has those of `unity`");
        assert_eq!(under(&format!("profile {other}"), one, ""), [what]);
    }
    assert_eq!(under("profile unity { multi-token }", fork, ""), rule("multi-token"));
    assert_eq!(under("profile unity { multi-token }", apart, ""), fine);
    assert_eq!(under("profile unity { stable }", one, ""), rule("stable"));
    assert_eq!(under("profile unity { sequential }", one, ""), rule("sequential"));
    assert_eq!(under("profile unity { parallel-actions }", one, "P1 n := 1"), rule("parallel-actions"));
    assert_eq!(under("profile unity { parallel-actions }", one, ""), fine);
    assert_eq!(under("profile iec61131", one, "N n := n + 1"), rule("final-scan"));
    assert_eq!(under("profile iec61131", fork, "P1 n := n + 1"), fine);
    assert_eq!(under("profile iec61131 { no-final-scan }", one, "N n := n + 1"), fine);
    assert_eq!(under("profile iec61131", one, "P0 n := 1 P1 n := n + 1"), rule("text-order"));
    assert_eq!(under("profile iec61131", one, "P1 n := 1 P0 n := n + 1"), fine);
    assert_eq!(under("profile unity { zero-step-time }", one, "N n := n + 1"), fine);
    assert_eq!(under("profile unity { zero-step-time }", "1 -> 2 when 1.t > 1s", ""), rule("zero-step-time"));
}

#[test]
fn several_initial_steps_need_branches_that_exclude_each_other() {
    let text = |second: &str| {
        format!(
            "profile unity input a, b : BOOL at %I0.1.0
             chart G {{ initial step A initial step B step C A -> C when a
               A -> B when {second}
               (B, C) -> A when b }}"
        )
    };
    let begins = "a second initial step: Control Expert takes it with the option for several tokens alone";
    let told = said(&text("not a"));
    assert!(
        told.iter().any(|t| t.starts_with(&format!("G0614 2: {begins}, which changes nothing"))),
        "{told:?}"
    );
    let told = said(&text("b"));
    assert!(told.iter().any(|t| t.starts_with(&format!("G0604 2: {begins}, under which"))), "{told:?}");
}
