//! A chart that is written as PLCopen XML or as IEC 61131-3 text and read again does
//! what it did: situation and variables, scan by scan. Charts are those of the
//! conformance cases and of the examples, under the rules of IEC 61131-3; what has no
//! form there must be told instead.
#![allow(clippy::disallowed_methods, reason = "the tests read charts")]

#[path = "../../../../tests/src/case.rs"]
#[allow(
    dead_code,
    unreachable_pub,
    reason = "the reader of cases is shared; what they expect is looked at elsewhere"
)]
mod case;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use case::Line;
use g7_compile::Compiled;
use g7_compile::ir::VarClass;
use g7_engine::{Addr, State, StepId};
use g7_iec::{Written, plcopen, sfc};
use g7_model::{
    Document, Expr, ExprKind, FileId, Item, Literal, Problem, Profile, ProfileName, Severity, StepKind, Type,
    UnaryOp,
};

/// Writes a document in a form.
type Write = fn(&Document) -> Written;
/// Reads it back.
type Read = fn(&[u8], FileId) -> (Document, Vec<Problem>);

/// The forms, by name.
const FORMS: [(&str, Write, Read); 3] = [
    ("PLCopen XML", whole, plcopen::import),
    ("CODESYS", codesys, plcopen::import),
    ("text", text, sfc::import),
];

/// The project with all that the standard can say. For Beremiz and OpenPLC the actions stand in a step of their own;
/// `tests/tests/foreign/interop.rs` runs those projects.
fn whole(document: &Document) -> Written {
    project(document, plcopen::Dialect::Standard)
}

/// The project for CODESYS: bodies beside steps, and the names of programs before those of their variables.
fn codesys(document: &Document) -> Written {
    project(document, plcopen::Dialect::Codesys)
}

fn project(document: &Document, dialect: plcopen::Dialect) -> Written {
    g7_exchange::named("plcopen").and_then(|f| f.write_in(document, dialect)).expect("a form with dialects")
}

fn text(document: &Document) -> Written {
    g7_exchange::named("sfc").and_then(|f| f.write(document)).expect("a form that is written")
}

/// Cases that run otherwise in a form, which the export tells as a warning: what runs on
/// clearing runs behind the evolution, and in text the initial step stands first.
const OTHERWISE: [(&str, &str); 4] = [
    ("PLCopen XML", "side-by-side/order-clearing"),
    ("CODESYS", "side-by-side/order-clearing"),
    ("text", "side-by-side/order-clearing"),
    ("text", "side-by-side/order-exit-entry"),
];

/// An event: a scan with new inputs, or a start from the beginning.
enum Event {
    Scan(i64, Vec<(String, u64)>),
    Restart { cold: bool },
}

fn errors(problems: &[Problem]) -> Vec<String> {
    let errors = problems.iter().filter(|p| p.severity() == Severity::Error);
    errors.map(|p| format!("{} {}", p.code.id, p.what)).collect()
}

/// The document under the rules of the standard, with switches of its own if it has them.
fn standard(mut document: Document) -> Document {
    if document.profile().map(|p| p.name) != Some(ProfileName::Iec61131) {
        document.items.retain(|i| !matches!(i, Item::Profile(_)));
        let at = g7_model::Place::default();
        let profile = Profile { name: ProfileName::Iec61131, switches: Vec::new(), at };
        document.items.insert(0, Item::Profile(profile));
    }
    document
}

/// The expansion of each macro-step.
type Macros = BTreeMap<String, String>;

/// The name of an element or member as a single variable: `m_1_speed` for `m[1].speed`.
fn single(name: &str) -> String {
    name.replace(['.', '[', ','], "_").replace(']', "").replace('-', "m")
}

/// Its name where the array stays one: `m_speed[1]`.
fn element(name: &str) -> Option<String> {
    let (mut base, mut indexes, mut rest) = (String::new(), Vec::new(), name);
    while let Some((before, behind)) = rest.split_once('[') {
        let (index, after) = behind.split_once(']')?;
        base.push_str(before);
        indexes.push(index);
        rest = after;
    }
    (!indexes.is_empty()).then(|| format!("{}[{}]", (base + rest).replace('.', "_"), indexes.join(",")))
}

/// Its name where the instance that it belongs to stays one: `valve_3.open` for `valve[3].open`.
fn of_instance(name: &str) -> Option<String> {
    let (instance, member) = name.rsplit_once('.')?;
    Some(format!("{}.{member}", single(instance)))
}

/// The new form of a name: the same, or one made of it.
fn counterpart<'a>(name: &str, there: &'a BTreeSet<String>, macros: &Macros) -> Option<&'a String> {
    if let Some(same) = there.get(name) {
        return Some(same);
    }
    let mut parts = name.rsplit('.');
    let last = parts.next().unwrap_or(name);
    let home = parts.next().unwrap_or("");
    let digit = last.starts_with(|c: char| c.is_ascii_digit());
    let step = if digit { format!("Step{last}") } else { last.to_string() };
    let letters = last.replace('+', "plus").replace('-', "minus");
    let expansion = macros.get(home).map_or(home, String::as_str);
    let home = &single(home);
    let wanted = [
        of_instance(name).unwrap_or_else(|| single(name)),
        element(name).unwrap_or_else(|| single(name)),
        single(name),
        format!("{home}_{step}"),
        format!("{expansion}_{step}"),
        format!("{home}_{last}"),
        step,
        format!("{last}_2"),
        letters,
    ];
    let own = name.split('.').next().unwrap_or("");
    let near = |found: Vec<&'a String>| {
        found.iter().find(|n| n.split('.').next() == Some(own)).or(found.first()).copied()
    };
    wanted
        .iter()
        .find_map(|w| near(there.iter().filter(|n| n.rsplit('.').next() == Some(w.as_str())).collect()))
}

/// A document at work.
struct Bench {
    compiled: Compiled,
    state: State,
    inputs: Vec<u64>,
    charts: BTreeSet<String>,
    macros: Macros,
}

impl Bench {
    fn new(document: &Document) -> Result<Bench, String> {
        let (compiled, problems) = g7_compile::compile(document);
        let compiled = compiled.ok_or_else(|| errors(&problems).join("; "))?;
        let state = State::new(&compiled.program);
        let table = compiled.program.tables().inputs;
        let inputs = state.words().get(table.start as usize..table.end as usize).unwrap_or(&[]).to_vec();
        let expansion = |s: &g7_model::Step| match &s.kind {
            StepKind::Macro(name) => Some((s.name.text.to_string(), name.text.to_string())),
            _ => None,
        };
        let macros = document.charts().flat_map(|c| c.steps()).filter_map(expansion).collect();
        let charts = document.charts().map(|c| c.name.text.to_string()).collect();
        Ok(Bench { compiled, state, inputs, charts, macros })
    }

    fn restart(&mut self, cold: bool) {
        let old = std::mem::replace(&mut self.state, State::new(&self.compiled.program));
        let kept = self.compiled.symbols.variables.iter().filter(|v| v.retain && !cold);
        for addr in kept.flat_map(|v| (0..v.elements).map(|k| Addr(v.addr.0 + k))) {
            self.state.set_word(&self.compiled.program, addr, old.word(addr));
        }
    }

    fn set(&mut self, name: &str, word: u64) {
        let first = self.compiled.program.tables().inputs.start;
        let variable = self.compiled.symbols.variables.iter().find(|v| &*v.name == name);
        if let Some(place) = variable.and_then(|v| self.inputs.get_mut((v.addr.0 - first) as usize)) {
            *place = word;
        }
    }

    fn scan(&mut self, now: i64) -> Result<(), String> {
        let done = g7_engine::scan(&self.compiled.program, &mut self.state, &self.inputs, now);
        done.map(|_| ()).map_err(|f| format!("{:?}", std::mem::discriminant(&f.kind)))
    }

    fn steps(&self) -> BTreeSet<String> {
        let symbols = &self.compiled.symbols;
        (0..symbols.steps()).map(|i| symbols.step_name(StepId(i)).to_string()).collect()
    }

    fn active(&self) -> BTreeSet<String> {
        self.state.active().map(|s| self.compiled.symbols.step_name(s).to_string()).collect()
    }

    fn inputs(&self) -> Vec<(String, Type)> {
        let all = self.compiled.symbols.variables.iter();
        all.filter(|v| v.class == VarClass::Input).map(|v| (v.name.to_string(), v.ty)).collect()
    }

    /// Variables that hold a value of their own.
    fn variables(&self) -> BTreeMap<String, Vec<u64>> {
        let own = |c: VarClass| matches!(c, VarClass::Input | VarClass::Output | VarClass::Internal);
        let all = self.compiled.symbols.variables.iter();
        all.filter(|v| own(v.class) && !matches!(v.ty, Type::Fb(_)))
            .map(|v| (v.name.to_string(), v.value(&self.state).to_vec()))
            .collect()
    }
}

/// How the second differs from the first after a scan.
fn difference(one: &Bench, two: &Bench) -> Option<String> {
    let steps = two.steps();
    let mut left = two.active();
    for step in one.active() {
        let there = counterpart(&step, &steps, &one.macros);
        // In text a macro-step is no step: its expansion stands in its place, and its actions with the variables.
        if there.is_none() && step.rsplit('.').next().is_some_and(|last| one.macros.contains_key(last)) {
            continue;
        }
        if !there.is_some_and(|there| left.remove(there)) {
            return Some(format!("step {step} is active, there {:?}", two.active()));
        }
    }
    // Steps that stand before sources and behind sinks.
    let added = |s: &String| {
        ["Source", "Sink"].iter().any(|w| s.rsplit('.').next().is_some_and(|l| l.starts_with(w)))
    };
    left.retain(|s| !added(s));
    if !left.is_empty() {
        return Some(format!("{left:?} are active there, not {:?}", one.active()));
    }
    let theirs = two.variables();
    let names: BTreeSet<String> = theirs.keys().cloned().collect();
    for (name, value) in one.variables() {
        let home = name.split_once('.').map(|(home, _)| home);
        let there = if home.is_some_and(|h| !one.charts.contains(h)) {
            let forms = [Some(name.clone()), element(&name), Some(single(&name))];
            // A member of a block may be called otherwise there.
            let Some(there) = forms.iter().flatten().find_map(|n| names.get(n)) else { continue };
            Some(there)
        } else {
            counterpart(&name, &names, &one.macros)
        };
        let got = there.and_then(|n| theirs.get(n));
        if got != Some(&value) {
            return Some(format!("{name} is {value:?}, there {got:?} in {:?}", one.active()));
        }
    }
    None
}

/// So many scans are the same; none where it has no form there, which is told.
fn returned(
    title: &str,
    document: &Document,
    events: &[Event],
    (form, write, read): (&str, Write, Read),
) -> Result<Option<usize>, String> {
    let written = write(document);
    let switch = |p: &Problem| p.what.starts_with("this switch is not carried over");
    let told = errors(&written.problems);
    if !told.is_empty() || written.problems.iter().any(switch) {
        println!("{title} as {form} is told: {}", told.join("; "));
        return Ok(None);
    }
    let (again, problems) = read(written.text.as_bytes(), FileId(1));
    let fail = |what: String| {
        let (before, after) = (g7_syntax::print(document, None), g7_syntax::print(&again, None));
        format!("{title} as {form}: {what}\n{before}\n{after}")
    };
    if !errors(&problems).is_empty() {
        return Err(fail(errors(&problems).join("; ")));
    }
    let mut one = Bench::new(document).map_err(&fail)?;
    let mut two = Bench::new(&again).map_err(&fail)?;
    let names: BTreeSet<String> = two.variables().into_keys().collect();
    let mut scans = 0;
    for event in events {
        let (now, inputs) = match event {
            Event::Restart { cold } => {
                one.restart(*cold);
                two.restart(*cold);
                continue;
            }
            Event::Scan(now, inputs) => (*now, inputs),
        };
        for (name, word) in inputs {
            one.set(name, *word);
            if let Some(there) = counterpart(name, &names, &one.macros) {
                two.set(there, *word);
            }
        }
        match (one.scan(now), two.scan(now)) {
            (Ok(()), Ok(())) => {}
            (Err(a), Err(b)) if a == b => {
                one.restart(true);
                two.restart(true);
                continue;
            }
            (a, b) => return Err(fail(format!("scan {scans}: {a:?} against {b:?}"))),
        }
        if let Some(what) = difference(&one, &two) {
            return Err(fail(format!("scan {scans}: {what}")));
        }
        scans += 1;
    }
    Ok(Some(scans))
}

fn files(folder: &str, ending: &str) -> Vec<PathBuf> {
    fn collect(folder: &Path, ending: &str, found: &mut Vec<PathBuf>) {
        for path in std::fs::read_dir(folder).into_iter().flatten().filter_map(|e| e.ok().map(|e| e.path())) {
            if path.is_dir() {
                collect(&path, ending, found);
            } else if path.extension().is_some_and(|e| e == ending)
                && path.file_stem().is_some_and(|s| s != "README")
            {
                found.push(path);
            }
        }
    }
    let root: PathBuf = [env!("CARGO_MANIFEST_DIR"), "..", "..", folder].iter().collect();
    let mut found = Vec::new();
    collect(&root, ending, &mut found);
    found.sort();
    found
}

/// A value as the engine has it.
fn word(text: &str, ty: Type) -> u64 {
    fn number(e: &Expr) -> Option<(f64, i128)> {
        Some(match &e.kind {
            ExprKind::Literal(Literal::Bool(b)) => (0.0, i128::from(*b)),
            ExprKind::Literal(Literal::Int(n, _)) => (*n as f64, *n),
            ExprKind::Literal(Literal::Real(text, _)) => (text.parse().ok()?, 0),
            ExprKind::Literal(Literal::Time(t) | Literal::Moment(_, t)) => (0.0, i128::from(t.count())),
            ExprKind::Unary(UnaryOp::Neg, inner) => {
                let (real, whole) = number(inner)?;
                (-real, -whole)
            }
            _ => return None,
        })
    }
    let value = case::expression(text).ok().and_then(|e| number(&e));
    let (real, whole) = value.unwrap_or_else(|| panic!("no value `{text}`"));
    match ty {
        Type::Real => u64::from((real as f32).to_bits()),
        Type::Lreal => real.to_bits(),
        _ => whole as u64,
    }
}

#[test]
fn conformance_cases_come_back() {
    let all = files("tests/spec", "md");
    for form in FORMS {
        let mut same = 0;
        let mut wrong = Vec::new();
        for file in &all {
            let folder = file.parent().and_then(Path::file_name).map(|f| f.to_string_lossy().into_owned());
            let stem = file.file_stem().map(|f| f.to_string_lossy().into_owned()).unwrap_or_default();
            let folder = folder.unwrap_or_default();
            let title = format!("{folder}/{stem}");
            let text = std::fs::read_to_string(file).expect("a case");
            let case = case::read(&text).expect("a case in good form");
            let document = case::document(&case.chart).expect("a chart");
            for trace in &case.traces {
                let profile = trace.profile.or_else(|| case::profile_named(&folder).ok());
                if profile.or(document.profile().map(|p| p.name)) != Some(ProfileName::Iec61131) {
                    continue;
                }
                let document = standard(document.clone());
                let inputs = Bench::new(&document).expect("a chart that runs").inputs();
                let events: Vec<Event> = trace.lines.iter().map(|line| event(line, &inputs)).collect();
                match returned(&title, &document, &events, form) {
                    Ok(scans) => same += usize::from(scans.is_some()),
                    Err(what) if OTHERWISE.contains(&(form.0, title.as_str())) => {
                        println!("otherwise: {what}")
                    }
                    Err(what) => wrong.push(what),
                }
            }
        }
        println!("{}: {same} the same", form.0);
        assert!(wrong.is_empty(), "{} differ\n{}", wrong.len(), wrong.join("\n---\n"));
        assert!(same > 150, "only {same}");
    }
}

fn event(line: &Line, inputs: &[(String, Type)]) -> Event {
    let row = match line {
        Line::Restart { cold } => return Event::Restart { cold: *cold },
        Line::Row(row) => row,
    };
    let bools = inputs.iter().filter(|i| i.1 == Type::Bool);
    let mut values: Vec<(String, u64)> = bools.map(|i| (i.0.clone(), 0)).collect();
    for (name, value) in &row.inputs {
        let meant = |i: &&(String, Type)| i.0 == *name || i.0.ends_with(&format!(".{name}"));
        let (full, ty) = inputs.iter().find(meant).expect("an input of the chart");
        values.push((full.clone(), value.as_ref().map_or(1, |text| word(text, *ty))));
    }
    Event::Scan(row.at, values)
}

#[test]
fn examples_come_back() {
    for form in FORMS {
        let mut same = 0;
        let mut wrong = Vec::new();
        for file in files("examples", "g7") {
            let title = file.display().to_string();
            let text = std::fs::read_to_string(&file).expect("an example");
            let (mut document, problems) = g7_syntax::parse(&text, FileId(0));
            assert!(problems.is_empty(), "{title}: {problems:?}");
            document.items.retain(|i| !matches!(i, Item::Test(_) | Item::Plant(_) | Item::Prove(_)));
            let document = standard(document);
            // Some are of rules that IEC 61131-3 does not have.
            let Ok(bench) = Bench::new(&document) else { continue };
            match returned(&title, &document, &drawn(&bench.inputs(), 400), form) {
                Ok(scans) => same += usize::from(scans.is_some()),
                Err(what) => wrong.push(what),
            }
        }
        println!("{}: {same} the same", form.0);
        assert!(wrong.is_empty(), "{} differ\n{}", wrong.len(), wrong.join("\n---\n"));
        assert!(same >= 8, "only {same}");
    }
}

/// Inputs that change now and then, always the same ones.
fn drawn(inputs: &[(String, Type)], scans: i64) -> Vec<Event> {
    let mut seed: u64 = 7;
    let mut draw = |most: u64| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) % most
    };
    let mut events = Vec::new();
    for scan in 0..scans {
        let mut values = Vec::new();
        for (name, ty) in inputs {
            let word = match ty {
                _ if draw(4) > 0 => continue,
                Type::Bool => draw(2),
                Type::Real => u64::from((draw(100) as f32).to_bits()),
                Type::Lreal => (draw(100) as f64).to_bits(),
                ty if ty.is_integer() => draw(20),
                _ => continue,
            };
            values.push((name.clone(), word));
        }
        events.push(Event::Scan(scan * 250_000_000, values));
    }
    events
}
