//! Documents as files of JGrafchart: what is read comes back, what runs runs the
//! same, what cannot be said is a problem with its place.

use crate::support;
use std::collections::BTreeMap;
use std::path::PathBuf;

use g7_compile::Compiled;
use g7_engine::State;
use g7_model::{Document, FileId, Item, Severity};

use crate::support::{corpus, errors, lines, own, text_of};

/// Files that are read without errors.
const FILES: [&str; 10] = [
    "bead-sorter.xml",
    "exceptions.xml",
    "fusion.xml",
    "lines.xml",
    "nested.xml",
    "outside.xml",
    "procedures.xml",
    "texts.xml",
    "ways-out.xml",
    "workspaces.xml",
];

fn comes_back(name: &str, bytes: &[u8]) {
    let (document, problems) = support::import("jgrafchart", bytes, FileId(0));
    assert_eq!(errors(&problems), Vec::<&str>::new(), "{name}");
    let written = support::export("jgrafchart", &document);
    assert_eq!(errors(&written.problems), Vec::<&str>::new(), "{name}");
    let (back, problems) = support::import("jgrafchart", written.text.as_bytes(), FileId(0));
    assert_eq!(errors(&problems), Vec::<&str>::new(), "{name}\n{}", written.text);
    // Notes tell of what the first file had beside its charts.
    if back.items != document.items {
        assert_eq!(text_of(&back), text_of(&Document { notes: Vec::new(), ..document }), "{name}");
        panic!("{name}: the same text, not the same document");
    }
}

#[test]
fn what_is_read_comes_back() {
    for name in FILES {
        comes_back(name, &own("jgrafchart", name));
    }
    for (name, bytes) in corpus("jgrafchart-xml", &[".xml"]) {
        comes_back(&name, &bytes);
    }
}

#[test]
fn files_have_the_form_of_jgrafchart_s_own() {
    let (document, _) = support::import("jgrafchart", &own("jgrafchart", "exceptions.xml"), FileId(0));
    let text = support::export("jgrafchart", &document).text;
    let root = "<GCDocument color=\"-1\" dimTicks=\"25\" dpwsInterface=\"\" dpwsPort=\"-1\" horizontalScrollBar=\"1\" modifiable=\"1\" saveVersion=\"8\" simulationMode=\"1\" socketHost=\"\" socketIsServer=\"0\" socketPort=\"-1\" socketSendMode=\"Changed\" tokenLuminance=\"0\" verticalScrollBar=\"1\" name=\"Plant\" threadSpeed=\"40\"";
    for line in [
        "<?xml version=\"1.0\" encoding=\"UTF-8\" standalone=\"yes\"?>",
        root,
        "<DigitalIn value=\"0\" channel=\"0\" cyclic=\"1\" name=\"go\" width=\"80\" height=\"60\"",
        "<IntegerVariable constant=\"0\" exp=\"\" initialValue=\"0\" updated=\"0\" value=\"0\" name=\"log\"",
        "<MacroStep actionText=\"S whole = whole * 10 + 1;&#10;X whole = whole * 10 + 8;&#10;A whole = whole * 10 + 9;\"",
        "<EnterStep actionText=\";\"",
        "<ExitStep actionText=\"S log = log * 10 + 5;\"",
        "<ExceptionTransition actionText=\"alarm\"",
        "<GCTransition actionText=\"!alarm &amp; !stop\"",
        "priority=\"2\"",
        "E\" manAdj=\"0\"",
    ] {
        assert!(text.contains(line), "{line}\n{text}");
    }
    // The variable that this form needs here is not there.
    assert!(!text.contains("_abort"), "{text}");
    // Six corners a line, as JGrafchart saves them.
    assert_eq!(text.matches("<Stroke ").count(), 6 * text.matches("<GCLink ").count());
    // Places are those of the drawing that was read.
    assert!(text.contains("name=\"Pump\" useIcon=\"0\" actionBlockVisible=\"1\" width=\"200\" height=\"70\" x=\"50\" y=\"140\""), "{text}");
}

fn parse(text: &str) -> Document {
    let (document, problems) = g7_syntax::parse(text, FileId(0));
    assert_eq!(errors(&problems), Vec::<&str>::new(), "{text}");
    document
}

/// A document at work, and what of it can be compared.
struct Run {
    compiled: Compiled,
    state: State,
    inputs: BTreeMap<String, u64>,
}

impl Run {
    fn new(document: &Document) -> Run {
        let (compiled, problems) = g7_compile::compile(document);
        let compiled = compiled.unwrap_or_else(|| panic!("{problems:#?}\n{}", text_of(document)));
        let state = State::new(&compiled.program);
        Run { compiled, state, inputs: BTreeMap::new() }
    }

    /// One scan; `None` after a fault.
    fn scan(&mut self, now: i64) -> Option<()> {
        let rows = self.compiled.program.tables().inputs;
        let mut words = vec![0; (rows.end - rows.start) as usize];
        for (name, value) in &self.inputs {
            let variable = self.compiled.symbols.variable(name).expect("an input");
            words[(variable.addr.0 - rows.start) as usize] = *value;
        }
        g7_engine::scan(&self.compiled.program, &mut self.state, &words, now).ok().map(|_| ())
    }

    /// The situation; a step that a text names may have got an `S` before its number.
    fn active(&self) -> Vec<String> {
        let plain = |name: &str| {
            let part = |p: &str| match p.strip_prefix('S') {
                Some(n) if n.starts_with(|c: char| c.is_ascii_digit()) => n.to_string(),
                _ => p.to_string(),
            };
            name.split('.').map(part).collect::<Vec<_>>().join(".")
        };
        let mut names: Vec<String> =
            self.state.active().map(|s| plain(self.compiled.symbols.step_name(s))).collect();
        names.sort();
        names
    }

    fn value(&self, name: &str) -> Option<i64> {
        let last = name.rsplit('.').next()?;
        let variable = [name, last].into_iter().find_map(|n| self.compiled.symbols.variable(n))?;
        Some(variable.value(&self.state).first()?.cast_signed())
    }
}

/// The names of all variables, with their charts.
fn variables(document: &Document) -> Vec<String> {
    let mut names = Vec::new();
    for item in &document.items {
        match item {
            Item::Var(v) => names.extend(v.names.iter().map(|n| n.text.to_string())),
            Item::Chart(c) => {
                let of = c.vars().flat_map(|v| &v.names);
                names.extend(of.map(|n| format!("{}.{}", c.name.text, n.text)));
            }
            _ => {}
        }
    }
    names
}

fn inputs(document: &Document) -> Vec<String> {
    let input = |i: &Item| match i {
        Item::Var(v) if v.kind == g7_model::VarKind::Input => {
            v.names.iter().map(|n| n.text.to_string()).collect()
        }
        _ => Vec::new(),
    };
    document.items.iter().flat_map(input).collect()
}

/// Runs a chart and what comes back of it side by side, under inputs at random.
fn runs_the_same(name: &str, document: &Document, back: &Document) {
    let names = variables(document);
    for seed in 1..5u64 {
        let (mut first, mut second) = (Run::new(document), Run::new(back));
        let mut random = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15);
        for scan in 0..60 {
            for input in inputs(document) {
                random =
                    random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                let value = random >> 62 & 1;
                first.inputs.insert(input.clone(), value);
                second.inputs.insert(input, value);
            }
            let now = scan * 10_000_000;
            let (a, b) = (first.scan(now), second.scan(now));
            assert_eq!(a, b, "{name}: scan {scan}");
            if a.is_none() {
                break;
            }
            assert_eq!(first.active(), second.active(), "{name}: scan {scan}\n{}", text_of(back));
            for variable in &names {
                assert_eq!(
                    first.value(variable),
                    second.value(variable),
                    "{name}: {variable} in scan {scan}\n{}",
                    text_of(back)
                );
            }
        }
    }
}

/// The charts of the conformance cases, by the name of their files.
fn cases(folder: &str) -> Vec<(String, Document)> {
    let path: PathBuf = [env!("CARGO_MANIFEST_DIR"), "..", "..", "tests", "spec", folder].iter().collect();
    let mut cases = Vec::new();
    for entry in std::fs::read_dir(path).expect("a folder of the repository").flatten() {
        let text = String::from_utf8(std::fs::read(entry.path()).expect("a case")).expect("UTF-8");
        let chart = text.split("```g7\n").nth(1).and_then(|t| t.split("\n```").next()).expect("a chart");
        let profile = if chart.contains("profile ") { "" } else { "profile jgrafchart\n" };
        let name = entry.file_name().to_string_lossy().trim_end_matches(".md").to_string();
        let (document, problems) = g7_syntax::parse(&format!("{profile}{chart}"), FileId(0));
        if errors(&problems).is_empty() && g7_compile::compile(&document).0.is_some() {
            cases.push((name, document));
        }
    }
    cases.sort_by(|a, b| a.0.cmp(&b.0));
    cases
}

#[test]
fn conformance_cases_run_as_before() {
    let mut carried = Vec::new();
    for (name, document) in cases("jgrafchart").into_iter().chain(cases("litmus")) {
        let written = support::export("jgrafchart", &document);
        if written.problems.iter().any(|p| p.severity() == Severity::Error) {
            continue;
        }
        let (back, problems) = support::import("jgrafchart", written.text.as_bytes(), FileId(0));
        assert_eq!(errors(&problems), Vec::<&str>::new(), "{name}\n{}", written.text);
        runs_the_same(&name, &document, &back);
        carried.push(name);
    }
    for name in [
        "exit-action-in-active-step",
        "exit-before-entry",
        "macro-step-with-actions",
        "marked-against-the-old-state",
        "order-of-transitions",
        "periodic-in-leaving-step",
        "priorities",
        "receptivities-before-actions",
        "step-scans",
        "stored-actions-write-at-once",
        "transition-after-transition",
        "05-or-divergence-both-true",
        "06-activated-and-deactivated-at-once",
        "08-transient-step",
    ] {
        assert!(carried.iter().any(|c| c == name), "{name} is not carried: {carried:?}");
    }
}

#[test]
fn a_drawing_without_a_layout_is_laid_out() {
    let document = parse(
        "profile jgrafchart input a : BOOL
         chart G { initial step 1 step 2 step 3 1 -> (2, 3) when a
         (2, 3) -> 1 when not a }",
    );
    let written = support::export("jgrafchart", &document);
    assert_eq!(lines(b"", &written.problems), Vec::<String>::new());
    let (back, problems) = support::import("jgrafchart", written.text.as_bytes(), FileId(0));
    assert_eq!(errors(&problems), Vec::<&str>::new());
    runs_the_same("a fork", &document, &back);
    let layout = back.items.iter().find_map(|i| if let Item::Layout(l) = i { Some(l) } else { None });
    let mut places: Vec<(i32, i32)> = layout.expect("places").places.iter().map(|p| (p.x, p.y)).collect();
    places.sort_unstable();
    places.dedup();
    // Three steps and two transitions, each at a place of its own.
    assert_eq!(places.len(), 5);
}

/// The problems of writing a text.
fn said(text: &str) -> Vec<String> {
    lines(text.as_bytes(), &support::export("jgrafchart", &parse(text)).problems)
}

#[test]
fn what_means_the_same_is_written_with_what_there_is() {
    let text = "profile jgrafchart scan 20ms
         input a, b : BOOL  output y, z : BOOL
         var n : DINT := -3  var r : LREAL  const k : DINT := 7
         chart G {
           initial step 1 { S y  R z  P1 n := n + 1 if a and not b  N y }
           step 2 { P1 { n := n * (k - 1)  r := 2.5 }  P0 r := r / 2.0  each scan: n := SEL(a, n, 0) }
           1 -> 2 when ↑a or (b xor X1) and n <> 4 priority 1
           2 -> 1 when X2 and 2.t > 3 and 2.s >= 0.5
         }
         chart H every 60ms { initial step 9 { P1 n := G.X1.t } }";
    let written = support::export("jgrafchart", &parse(text));
    assert_eq!(
        lines(text.as_bytes(), &written.problems),
        [
            "G0611 5: texts of JGrafchart cannot hold the name `1`; it becomes `S1`",
            "G0611 6: texts of JGrafchart cannot hold the name `2`; it becomes `S2`",
        ]
    );
    for part in [
        "threadSpeed=\"20\"",
        "actionText=\"S y = 1;&#10;S z = 0;&#10;S n = (a &amp; !b) ? (n + 1) : n;&#10;N y;\"",
        "actionText=\"S n = n * (k - 1);&#10;S r = 2.5;&#10;X r = r / 2.0;&#10;P n = a ? 0 : n;\"",
        "actionText=\"/a | b != S1.x &amp; n != 4\"",
        "actionText=\"S2.x &amp; S2.t &gt; 3 &amp; S2.s &gt;= 0.5\"",
        "<WorkspaceObject enabled=\"1\" fileName=\"\" horizontalScrollBar=\"1\" name=\"H\" ownerClass=\"\" scanCycle=\"3\"",
        "actionText=\"S n = S1.t;\"",
        "initialValue=\"-3\"",
    ] {
        assert!(written.text.contains(part), "{part}\n{}", written.text);
    }
}

#[test]
fn what_cannot_be_said_is_a_problem_with_its_place() {
    let none = "JGrafchart has none";
    let want = |line: u32, what: &str| format!("G0604 {line}: {what}: {none}");
    let drop = |line: u32, what: &str| format!("G0605 {line}: {what}: {none}; it is left out");
    assert_eq!(
        said(
            "profile jgrafchart
             scan 1500us
             input a : BOOL \"a button\"
             output y : BOOL := TRUE
             var t : TIME
             var f : TON
             var n : INT
             chart G \"of the tank\" {
               initial step 1 \"rest\" { L 2s y  on ↑a: n := 1  N y if a }
               step 2 { force H := {}  P1 { IF a THEN n := 1; END_IF }  N n := 2 }
               go: 1 -> 2 when 3s/a \"why\" on clearing { n := 0 }
               2 -> 1 when ABS(n) > 3 or ↑(a or y)
             }
             chart H { enclosing step 5 { enclose I enclose K } initial step 6 6 -> 5 when a }
             chart I { step 7 * }
             chart K { step 8 * }
             post { n := 0 }
             test \"t\" { scan }"
        ),
        [
            want(2, "a scan time that is no whole number of milliseconds"),
            drop(3, "a comment"),
            want(4, "such an initial value of an input or output"),
            want(5, "a variable of the type TIME"),
            want(6, "a variable of the type TON"),
            "G0614 7: a variable of the type INT becomes DINT".to_string(),
            drop(9, "the comment of a step"),
            want(9, "the qualifier L"),
            want(9, "an action on an event"),
            want(9, "a condition of a continuous action"),
            want(10, "an order of a step"),
            want(10, "a statement that is no assignment"),
            want(10, "statements with the qualifier N"),
            drop(11, "the label of a transition"),
            drop(11, "the comment of a transition"),
            want(11, "a time operator"),
            want(11, "an action on clearing"),
            want(12, "the function `ABS`"),
            want(14, "an enclosing step"),
            want(17, "processing behind the evolution"),
            drop(18, "a test"),
        ]
    );
    assert_eq!(
        said("chart G { initial step 1 }"),
        ["G0604 1: the rules of evolution of `iec60848`; JGrafchart has its own"]
    );
}

#[test]
fn an_enclosing_step_of_another_form_is_not_taken_for_a_macro_step() {
    // Without the variable, what is inside would fire in the scan of the exception.
    let text = "profile jgrafchart input a, b : BOOL
         chart G { initial step 1 enclosing step 2 { enclose H } 1 -> 2 when a 2 -> 1 when b }
         chart H { step 3 * step 4 3 -> 4 when b }";
    assert_eq!(
        said(text),
        [
            "G0604 2: a transition of such an enclosing step, or of what it encloses: JGrafchart has none",
            "G0611 3: `H` is called as its macro-step there: `2`",
        ]
    );
}
