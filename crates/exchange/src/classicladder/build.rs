//! Builds the document from the project.

use std::collections::{BTreeMap, BTreeSet, HashSet};

use g7_model::{
    BinaryOp, Block, Body, Chart, ChartItem, ChartKind, Document, Function, Item, Layout, Name, Nanos, Param,
    PlaceAt, Placed, Profile, ProfileName, Step, StepKind, Stmt, StmtKind, Switch, Type, codes, say,
};
use g7_model::{Expr, Local, Span};

use super::arith::Helper;
use super::ladder::Ladder;
use super::project::{Plan, Section};
use super::variables::Vars;
use g7_iec::nodes::{self, Taken, assign, binary, call, int, name, when};
use g7_iec::report::Report;

/// ClassicLadder's default period, in milliseconds.
const DEFAULT_PERIOD: i64 = 50;
/// The most rounds of a page in one scan.
const ROUNDS: u32 = 50;
/// The distance between two columns and between two lines of a page, in hundredths of the drawing's
/// unit.
const COLUMN: i32 = 700;
const LINE: i32 = 600;

/// The document of a project.
pub(super) fn document(plan: &Plan, report: &mut Report) -> Document {
    let at = report.span(&(0..0));
    let mut vars = Vars::new(plan, report);
    let mut helpers = BTreeSet::new();
    let names = step_names(plan, report);
    let words = step_words(plan);
    let pages = pages(plan, report);
    let mut ladder = Ladder::new(plan, &mut vars, &mut helpers, report);
    let charts: Vec<(Chart, Option<Layout>)> =
        pages.iter().map(|(page, title)| chart(plan, *page, title, (&names, &words), &mut ladder)).collect();
    let (pre, post) = sections(plan, &mut ladder);
    let cells = plan.rungs.values().flat_map(|r| r.rows.iter().flatten());
    let called: BTreeSet<i64> = cells.filter(|c| c.kind == 55).map(|c| i64::from(c.var.1)).collect();
    for section in plan.sections.iter().filter(|s| !s.sequential) {
        if section.routine.is_some_and(|number| !called.contains(&number)) {
            let what = say!("nothing calls the sub-routine `{}`; it is left out", section.name);
            report.say(&codes::LEFT_OUT, &section.at, what);
        }
    }
    let switches = [
        Switch::MultiToken(false),
        Switch::Sequential(true),
        Switch::ParallelActions(false),
        Switch::KeepStepTime(false),
        Switch::Bound(ROUNDS),
    ];
    let switches = switches.map(|s| (s, at.into())).to_vec();
    let mut items = vec![
        Item::Profile(Profile { name: ProfileName::Iec60848, switches, at: at.into() }),
        Item::Cycle(Nanos::from_millis(plan.period.unwrap_or(DEFAULT_PERIOD)), at.into()),
    ];
    let tables = vars.tables(at);
    items.extend(vars.finish().into_iter().map(Item::Var));
    items.extend(tables.into_iter().map(Item::Function));
    items.extend(helpers.into_iter().map(|h| Item::Function(helper(h, at))));
    let body = |statements: Vec<Stmt>| Body::St(Block { locals: Vec::new(), statements, at: at.into() });
    if !pre.is_empty() {
        items.push(Item::Pre(body(pre), at.into()));
    }
    let (charts, layouts): (Vec<Chart>, Vec<Option<Layout>>) = charts.into_iter().unzip();
    items.extend(charts.into_iter().map(Item::Chart));
    if !post.is_empty() {
        items.push(Item::Post(body(post), at.into()));
    }
    items.extend(layouts.into_iter().flatten().map(Item::Layout));
    Document { items, notes: report.take_notes() }
}

/// The pages that a section runs, with the names of their charts.
fn pages(plan: &Plan, report: &mut Report) -> Vec<(i64, String)> {
    let mut pages: Vec<(i64, String)> = Vec::new();
    let mut taken = Taken::default();
    let mut add = |page: i64, wanted: &str, pages: &mut Vec<(i64, String)>| {
        let mut title = nodes::line(&wanted.replace('`', "'"));
        if title.is_empty() {
            title = format!("Page{page}");
        }
        pages.push((page, taken.give(&title)));
    };
    for section in plan.sections.iter().filter(|s| s.sequential) {
        if pages.iter().any(|(p, _)| *p == section.page) {
            let what =
                say!("the section `{}` runs a page a second time in a scan; it runs once", section.name);
            report.say(&codes::NOT_CARRIED, &section.at, what);
        } else if plan.used.contains(&section.page) {
            add(section.page, &section.name, &mut pages);
        }
    }
    for &page in &plan.used {
        if pages.iter().any(|(p, _)| *p == page) {
            continue;
        }
        if plan.sections.is_empty() {
            add(page, "", &mut pages);
        } else if let Some(step) = plan.steps.values().find(|s| s.page == page) {
            let what = say!("no section runs page {page}; its chart is left out");
            report.say(&codes::LEFT_OUT, &step.at, what);
        }
    }
    pages
}

/// The name of each step: its number, made unique.
fn step_names(plan: &Plan, report: &mut Report) -> BTreeMap<u32, String> {
    let mut taken = HashSet::new();
    let mut names = BTreeMap::new();
    for (index, step) in &plan.steps {
        let mut title = step.number.to_string();
        if !taken.insert(title.clone()) {
            title = format!("{title}_{index}");
            taken.insert(title.clone());
            let what = say!(
                "a second step {}; it is called `{title}`, and its activity is not %X{}",
                step.number,
                step.number
            );
            report.say(&codes::RENAMED, &step.at, what);
        }
        names.insert(*index, title);
    }
    names
}

fn chart(
    plan: &Plan,
    page: i64,
    title: &str,
    (names, words): (&BTreeMap<u32, String>, &BTreeMap<u32, Box<str>>),
    ladder: &mut Ladder,
) -> (Chart, Option<Layout>) {
    let mut items = Vec::new();
    let mut places = Vec::new();
    let place = |what: Placed, x: i32, y: i32, at: Span| PlaceAt {
        what,
        x: x.saturating_mul(COLUMN),
        y: y.saturating_mul(LINE),
        then: Vec::new(),
        at: at.into(),
    };
    let mut first = None;
    for (index, step) in plan.steps.iter().filter(|(_, s)| s.page == page) {
        let at = ladder.report.span(&step.at);
        first = first.or(Some(at));
        let step_name = Name::new(names.get(index).map_or("", |n| n), at);
        places.push(place(Placed::Step(step_name.clone()), step.x, step.y, at));
        items.push(ChartItem::Step(Step {
            name: step_name,
            kind: StepKind::Plain,
            initial: step.initial,
            linked: false,
            comment: words.get(&step.number).cloned(),
            actions: Vec::new(),
            braces: false,
            at: at.into(),
        }));
    }
    for (number, (index, line)) in (0u32..).zip(plan.transitions.iter().filter(|(_, t)| t.page == page)) {
        let at = ladder.report.span(&line.at);
        first = first.or(Some(at));
        let mut ends = |list: &[u32]| -> Vec<Name> {
            let mut ends = Vec::new();
            for step in list {
                match (names.get(step), plan.steps.get(step)) {
                    (Some(n), Some(s)) if s.page == page => ends.push(Name::new(n.as_str(), at)),
                    _ => {
                        let what =
                            say!("transition {index} leads from or to a step that its page does not have");
                        ladder.report.say(&codes::BAD_LINK, &line.at, what);
                    }
                }
            }
            ends
        };
        let (from, to) = (ends(&line.from), ends(&line.to));
        let receptivity = match &line.condition {
            Some((key, at)) => ladder.condition(*key, at),
            None => {
                let what = say!("transition {index} has no condition; ClassicLadder reads %B0");
                ladder.report.say(&codes::DIFFERENT, &line.at, what);
                ladder.condition((0, 0), &line.at)
            }
        };
        places.push(place(Placed::TransitionNumber(number), line.x, line.y, at));
        items.push(ChartItem::Transition(nodes::transition(from, to, receptivity, at)));
    }
    let at = first.unwrap_or_default();
    let remarks = plan.remarks.iter().filter(|(p, _)| *p == page).map(|(_, text)| text);
    let comment: Vec<String> = plan
        .pages
        .get(&page)
        .into_iter()
        .chain(remarks)
        .map(|t| nodes::line(t))
        .filter(|t| !t.is_empty())
        .collect();
    let chart_name = Name::new(title, at);
    let layout = Layout { chart: chart_name.clone(), places, at: at.into() };
    let chart = Chart {
        params: Vec::new(),
        block: None,
        kind: ChartKind::Chart,
        name: chart_name,
        comment: (!comment.is_empty()).then(|| comment.join(" / ").into()),
        every: None,
        items,
        at: at.into(),
    };
    let layout = (!layout.places.is_empty()).then_some(layout);
    (chart, layout)
}

/// The author's names of steps, by number.
fn step_words(plan: &Plan) -> BTreeMap<u32, Box<str>> {
    let mut all = BTreeMap::new();
    for symbol in &plan.symbols {
        let words = [nodes::line(&symbol.name), nodes::line(&symbol.comment)];
        let words: Vec<&str> = words.iter().map(String::as_str).filter(|w| !w.is_empty()).collect();
        if let Some(step) = symbol.step().filter(|_| !words.is_empty()) {
            all.entry(step).or_insert_with(|| words.join(": ").into());
        }
    }
    all
}

/// The ladder sections before the first page and behind it.
fn sections<'b>(plan: &'b Plan, ladder: &mut Ladder<'_, 'b>) -> (Vec<Stmt>, Vec<Stmt>) {
    let main: Vec<&Section> = plan.sections.iter().filter(|s| s.routine.is_none()).collect();
    let first = main.iter().position(|s| s.sequential).unwrap_or(main.len());
    let last = main.iter().rposition(|s| s.sequential).unwrap_or(0);
    let (mut pre, mut post) = (Vec::new(), Vec::new());
    for (index, section) in main.into_iter().enumerate().filter(|(_, s)| !s.sequential) {
        let statements = ladder.section(section);
        if index < first {
            pre.extend(statements);
            continue;
        }
        if index < last && !statements.is_empty() {
            let what =
                say!("the section `{}` stands between two pages; it runs behind the last", section.name);
            ladder.report.say(&codes::DIFFERENT, &section.at, what);
        }
        post.extend(statements);
    }
    (pre, post)
}

/// Declares a function that a project needs and the language lacks.
fn helper(helper: Helper, at: Span) -> Function {
    let n = |text: &str| name(&[text], at);
    let number = |value: i128| int(value, at);
    let set = |to: &str, value: Expr| assign(n(to), value, at);
    let op = |kind: BinaryOp, a: Expr, b: Expr| binary(kind, a, b, at);
    let local = |name: &str, ty: Type, init: Option<i128>| Local {
        names: vec![Name::new(name, at)],
        ty: ty.into(),
        init: init.map(number),
        at: at.into(),
    };
    let repeat = |from: i128, to: Expr, body: Vec<Stmt>| Stmt {
        kind: StmtKind::For { var: Name::new("n", at), from: number(from), to, by: None, body },
        at: at.into(),
    };
    let (title, locals, statements) = match helper {
        Helper::Power => {
            let body = vec![set("r", op(BinaryOp::Mul, n("r"), n("a")))];
            let zero = op(BinaryOp::Eq, n("b"), number(0));
            let otherwise = vec![set("r", n("a")), repeat(2, n("b"), body)];
            let statements = vec![when(zero, vec![set("r", number(1))], otherwise, at), set("POWER", n("r"))];
            ("POWER", vec![local("r", Type::Dint, None), local("n", Type::Dint, None)], statements)
        }
        Helper::And | Helper::Or | Helper::Xor => {
            let (title, kind, ones) = match helper {
                Helper::And => ("BITS_AND", BinaryOp::Eq, 2),
                Helper::Or => ("BITS_OR", BinaryOp::Ge, 1),
                _ => ("BITS_XOR", BinaryOp::Eq, 1),
            };
            let bit = |word: &str| op(BinaryOp::Mod, n(word), number(2));
            let half = |word: &str| set(word, op(BinaryOp::Div, n(word), number(2)));
            let whole = |word: &str, by: BinaryOp| set(word, op(by, n(word), number(1 << 32)));
            let below = |word: &str| {
                when(op(BinaryOp::Lt, n(word), number(0)), vec![whole(word, BinaryOp::Add)], Vec::new(), at)
            };
            let both = op(kind, op(BinaryOp::Add, bit("x"), bit("y")), number(ones));
            let add = when(both, vec![set("r", op(BinaryOp::Add, n("r"), n("bit")))], Vec::new(), at);
            let next = set("bit", op(BinaryOp::Mul, n("bit"), number(2)));
            let high = op(BinaryOp::Ge, n("r"), number(1 << 31));
            let statements = vec![
                set("x", n("a")),
                set("y", n("b")),
                below("x"),
                below("y"),
                repeat(1, number(32), vec![add, half("x"), half("y"), next]),
                when(high, vec![whole("r", BinaryOp::Sub)], Vec::new(), at),
                set(title, call("LINT_TO_DINT", vec![n("r")], at)),
            ];
            let word = |name: &str, init| local(name, Type::Lint, init);
            let locals = vec![
                word("x", None),
                word("y", None),
                word("r", None),
                word("bit", Some(1)),
                local("n", Type::Dint, None),
            ];
            (title, locals, statements)
        }
    };
    let param = |name: &str| Param { name: Name::new(name, at), ty: Type::Dint.into() };
    Function {
        name: Name::new(title, at),
        params: vec![param("a"), param("b")],
        result: Type::Dint.into(),
        body: Block { locals, statements, at: at.into() },
        at: at.into(),
    }
}
