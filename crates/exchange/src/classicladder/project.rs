//! The content of a project, with the numbers of the file.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use g7_model::{codes, say};

use super::read::{Line, Part};
use g7_iec::report::Report;

/// A variable: its type as a number of ClassicLadder's list, and its number.
pub(super) type Key = (u16, u32);

/// The most steps or transitions on one side of a transition.
const ENDS: usize = 10;
/// The size of the largest rung.
const WIDEST: usize = 16;
const HIGHEST: usize = 16;
/// The most sections of a project; each may run its own page.
const MOST_SECTIONS: usize = 500;
/// The most pages with steps or transitions.
const MOST_PAGES: usize = 500;

/// A step of a page.
#[derive(Debug)]
pub(super) struct StepLine {
    pub(super) initial: bool,
    pub(super) number: u32,
    pub(super) page: i64,
    pub(super) x: i32,
    pub(super) y: i32,
    pub(super) at: Range<usize>,
}

/// A transition of a page.
#[derive(Debug)]
pub(super) struct TransitionLine {
    pub(super) to: Vec<u32>,
    pub(super) from: Vec<u32>,
    pub(super) page: i64,
    pub(super) x: i32,
    pub(super) y: i32,
    pub(super) condition: Option<(Key, Range<usize>)>,
    pub(super) at: Range<usize>,
}

/// One element of a rung.
#[derive(Clone, Debug)]
pub(super) struct Cell {
    pub(super) kind: u16,
    pub(super) joined: bool,
    pub(super) var: Key,
    pub(super) index: Option<Key>,
    pub(super) at: Range<usize>,
}

/// A rung: `rows[y][x]`.
#[derive(Debug)]
pub(super) struct Rung {
    pub(super) next: i64,
    pub(super) rows: Vec<Vec<Cell>>,
    pub(super) at: Range<usize>,
}

/// A section of the program.
#[derive(Debug)]
pub(super) struct Section {
    pub(super) name: String,
    pub(super) sequential: bool,
    /// The number of the sub-routine; None for a main section.
    pub(super) routine: Option<i64>,
    pub(super) first: i64,
    pub(super) last: i64,
    pub(super) page: i64,
    pub(super) at: Range<usize>,
}

/// A timer, monostable or counter, with its numbers as written.
#[derive(Clone, Debug, Default)]
pub(super) struct Block {
    /// The milliseconds of one unit of the preset.
    pub(super) base: i64,
    pub(super) preset: i64,
    pub(super) mode: i64,
}

/// A name that the author gave.
#[derive(Clone, Debug)]
pub(super) struct Symbol {
    pub(super) variable: String,
    pub(super) name: String,
    pub(super) comment: String,
    pub(super) at: Range<usize>,
}

impl Symbol {
    /// The number of the step whose activity it names: `%X3` or `%X3.A`.
    pub(super) fn step(&self) -> Option<u32> {
        let number = self.variable.strip_prefix("%X")?;
        number.strip_suffix(".A").unwrap_or(number).parse().ok()
    }
}

/// The whole project.
#[derive(Debug, Default)]
pub(super) struct Plan {
    pub(super) period: Option<i64>,
    /// The number of variables of each kind, where the project gives it.
    pub(super) sizes: BTreeMap<String, u32>,
    pub(super) sections: Vec<Section>,
    pub(super) steps: BTreeMap<u32, StepLine>,
    pub(super) transitions: BTreeMap<u32, TransitionLine>,
    pub(super) pages: BTreeMap<i64, String>,
    /// The pages with a step or a transition.
    pub(super) used: BTreeSet<i64>,
    pub(super) remarks: Vec<(i64, String)>,
    pub(super) rungs: BTreeMap<i64, Rung>,
    pub(super) timers: BTreeMap<u32, Block>,
    pub(super) monostables: BTreeMap<u32, Block>,
    pub(super) counters: BTreeMap<u32, Block>,
    pub(super) iec_timers: BTreeMap<u32, Block>,
    pub(super) expressions: BTreeMap<u32, (String, Range<usize>)>,
    pub(super) symbols: Vec<Symbol>,
}

/// Reads all parts.
pub(super) fn plan(parts: &[Part], report: &mut Report) -> Plan {
    let mut plan = Plan::default();
    let mut seen = BTreeSet::new();
    for part in parts {
        if !seen.insert(part.name) {
            let what = say!("a second file `{}` in the project; it is left out", part.name);
            report.say(&codes::LEFT_OUT, &part.at, what);
            continue;
        }
        match part.name {
            "general.txt" => general(part, &mut plan),
            "sections.csv" => sections(part, &mut plan, report),
            "sequential.csv" => sequential(part, &mut plan, report),
            "timers.csv" => plan.timers = blocks(part, 'T', report),
            "monostables.csv" => plan.monostables = blocks(part, 'M', report),
            "counters.csv" => plan.counters = blocks(part, 'C', report),
            "timers_iec.csv" => plan.iec_timers = blocks(part, 'T', report),
            "arithmetic_expressions.csv" => expressions(part, &mut plan),
            "symbols.csv" => symbols(part, &mut plan),
            name => {
                let number = name.strip_prefix("rung_").and_then(|n| n.strip_suffix(".csv"));
                match number.and_then(|n| n.parse().ok()) {
                    Some(number) => {
                        let rung = rung(part, report);
                        plan.rungs.insert(number, rung);
                    }
                    None => other(part, report),
                }
            }
        }
    }
    if !seen.contains("sequential.csv") {
        report.say(
            &codes::LEFT_OUT,
            &(0..0),
            say!("the project has no sequential page, so there is no chart"),
        );
    }
    plan
}

/// Settings of the controller; those with an effect are reported.
fn other(part: &Part, report: &mut Report) {
    let used = part.lines.iter().find(|l| !l.is_remark() && !l.text.starts_with('#'));
    let what = match part.name {
        "ioconf.csv" => say!("which hardware the inputs and outputs are wired to"),
        "modbusioconf.csv" => say!("inputs and outputs behind Modbus"),
        "config_events.csv" => say!("which events are logged"),
        "registers.csv" => say!("the modes of registers"),
        "project_infos.txt"
        | "com_params.txt"
        | "spy_vars.csv"
        | "modem_config.txt"
        | "remote_alarms.txt"
        | "log.csv"
        | "bool_free_vars_spy_list.csv" => return,
        _ => say!("a file that is not known"),
    };
    if let Some(line) = used {
        report.say(&codes::LEFT_OUT, &line.at, say!("`{}`, {what}, is left out", part.name));
    }
}

fn general(part: &Part, plan: &mut Plan) {
    let period = part.lines.iter().find_map(|l| l.text.strip_prefix("PERIODIC_REFRESH="));
    for line in &part.lines {
        let size = line.text.strip_prefix("SIZE_NBR_").and_then(|rest| rest.split_once('='));
        if let Some((name, Ok(number))) = size.map(|(name, number)| (name, number.trim().parse())) {
            plan.sizes.insert(name.to_string(), number);
        }
    }
    plan.period = period.and_then(|p| p.trim().parse().ok()).filter(|p| (1..=3_600_000).contains(p));
}

fn sections(part: &Part, plan: &mut Plan, report: &mut Report) {
    let mut names: BTreeMap<i64, String> = BTreeMap::new();
    for line in part.lines.iter().filter(|l| !l.is_remark()) {
        if let Some((number, name)) = line.text.strip_prefix("#NAME").and_then(|rest| rest.split_once('=')) {
            names.extend(number.parse::<i64>().ok().map(|n| (n, name.trim().to_string())));
        } else if !line.text.starts_with('#') {
            match line.numbers(0).as_deref() {
                Some(_) if plan.sections.len() == MOST_SECTIONS => {
                    let what = say!("the project has more than {MOST_SECTIONS} sections");
                    report.element(&codes::TOO_LARGE, "section", &line.at, what);
                }
                Some(&[number, language, routine, first, last, page, ..]) => plan.sections.push(Section {
                    name: names.get(&number).cloned().unwrap_or_else(|| format!("Section{number}")),
                    sequential: language == 1,
                    // The file has -1 for a main section.
                    routine: Some(routine).filter(|number| *number >= 0),
                    first,
                    last,
                    page,
                    at: line.at.clone(),
                }),
                _ => report.say(&codes::BAD_VALUE, &line.at, say!("a section that cannot be read")),
            }
        }
    }
}

fn sequential(part: &Part, plan: &mut Plan, report: &mut Report) {
    for line in part.lines.iter().filter(|l| !l.is_remark() && !l.text.starts_with('#')) {
        let read = match line.text.bytes().next() {
            Some(b'P') => page(line, plan),
            Some(b'S') => step(line, plan, report),
            Some(b'T') => transition(line, plan, report),
            Some(b'C') => condition(line, plan),
            Some(b'N') => remark(line, plan),
            _ => None,
        };
        if read.is_none() {
            report.say(&codes::BAD_VALUE, &line.at, say!("a line of the chart that cannot be read"));
        }
    }
}

/// True if the page is within the limit; otherwise its step or transition is left out.
fn fits(page: i64, at: &Range<usize>, plan: &mut Plan, report: &mut Report) -> bool {
    if plan.used.len() < MOST_PAGES {
        plan.used.insert(page);
    }
    let fits = plan.used.contains(&page);
    if !fits {
        let what = say!("the project has more than {MOST_PAGES} pages");
        report.element(&codes::TOO_LARGE, "page", at, what);
    }
    fits
}

fn page(line: &Line, plan: &mut Plan) -> Option<()> {
    let (number, comment) = line.text.get(1..)?.split_once(',')?;
    plan.pages.insert(number.parse().ok()?, comment.trim().to_string());
    Some(())
}

fn step(line: &Line, plan: &mut Plan, report: &mut Report) -> Option<()> {
    let [index, initial, number, page, x, y] = *line.numbers(1)?.first_chunk()?;
    let step = StepLine {
        initial: initial != 0,
        number: u32::try_from(number).ok()?,
        page,
        x: i32::try_from(x).ok()?,
        y: i32::try_from(y).ok()?,
        at: line.at.clone(),
    };
    if !fits(page, &line.at, plan, report) {
        return Some(());
    }
    if plan.steps.insert(u32::try_from(index).ok()?, step).is_some() {
        report.say(&codes::TWICE, &line.at, say!("the step of index {index} stands there twice"));
    }
    Some(())
}

fn transition(line: &Line, plan: &mut Plan, report: &mut Report) -> Option<()> {
    let numbers = line.numbers(1)?;
    let index = u32::try_from(*numbers.first()?).ok()?;
    // Only the numbers before the first -1 count.
    let ends = |from: usize| -> Option<Vec<u32>> {
        let list = numbers.get(from..from + ENDS)?;
        list.iter().take_while(|n| **n != -1).map(|n| u32::try_from(*n).ok()).collect()
    };
    let place = numbers.get(1 + 4 * ENDS..)?;
    let transition = TransitionLine {
        to: ends(1)?,
        from: ends(1 + ENDS)?,
        page: *place.first()?,
        x: i32::try_from(*place.get(1)?).ok()?,
        y: i32::try_from(*place.get(2)?).ok()?,
        condition: None,
        at: line.at.clone(),
    };
    if !fits(transition.page, &line.at, plan, report) {
        return Some(());
    }
    if plan.transitions.insert(index, transition).is_some() {
        report.say(&codes::TWICE, &line.at, say!("the transition of index {index} stands there twice"));
    }
    Some(())
}

fn condition(line: &Line, plan: &mut Plan) -> Option<()> {
    let (index, rest) = line.text.get(1..)?.split_once(',')?;
    let (_, variable) = rest.split_once(',')?;
    let key = key(variable.trim())?;
    let start = line.at.end - variable.len();
    plan.transitions.get_mut(&index.parse().ok()?)?.condition = Some((key, start..line.at.end));
    Some(())
}

fn remark(line: &Line, plan: &mut Plan) -> Option<()> {
    let mut pieces = line.text.get(1..)?.splitn(5, ',');
    let page = pieces.nth(1)?.trim().parse().ok()?;
    let text = pieces.nth(2)?;
    plan.remarks.push((page, text.trim().to_string()));
    Some(())
}

/// `50/3`.
fn key(text: &str) -> Option<Key> {
    let (kind, number) = text.split_once('/')?;
    Some((kind.trim().parse().ok()?, number.trim().parse().ok()?))
}

/// Timers, monostables and counters: with a number (`TM3,1,5,0`), or one per line in old files.
fn blocks(part: &Part, letter: char, report: &mut Report) -> BTreeMap<u32, Block> {
    let mut blocks = BTreeMap::new();
    let mut next = 0;
    for line in part.lines.iter().filter(|l| !l.is_remark() && !l.text.starts_with('#')) {
        let head = line.text.split(',').next().unwrap_or("");
        let named = head.trim_start_matches(|c: char| c.is_ascii_alphabetic());
        let (number, values) = if head.starts_with(letter) {
            (named.trim().parse().ok(), line.numbers(line.text.len().min(head.len() + 1)))
        } else {
            next += 1;
            (Some(next - 1), line.numbers(0))
        };
        let block = values.and_then(|v| block(&v, letter == 'C'));
        match (number, block) {
            (Some(number), Some(block)) => {
                blocks.insert(number, block);
            }
            _ => report.say(&codes::BAD_VALUE, &line.at, say!("a timer or counter that cannot be read")),
        }
    }
    blocks
}

fn block(values: &[i64], counter: bool) -> Option<Block> {
    if counter {
        return Some(Block { base: 1, preset: *values.first()?, mode: 0 });
    }
    let base = match values.first()? {
        0 => 60_000,
        1 => 1000,
        2 => 100,
        _ => return None,
    };
    Some(Block { base, preset: *values.get(1)?, mode: values.get(2).copied().unwrap_or(0) })
}

fn expressions(part: &Part, plan: &mut Plan) {
    let numbered = part.lines.iter().any(|l| l.value("VER").is_some());
    let mut next = 0;
    for line in part.lines.iter().filter(|l| !l.text.starts_with(';') && !l.text.starts_with('#')) {
        let split = if numbered { line.text.split_once(',') } else { None };
        let (number, text) = match split.and_then(|(n, text)| Some((n.parse().ok()?, text))) {
            Some(found) => found,
            None => {
                next += 1;
                (next - 1, line.text)
            }
        };
        if !text.trim().is_empty() {
            let start = line.at.end - text.len();
            plan.expressions.insert(number, (text.to_string(), start..line.at.end));
        }
    }
}

fn symbols(part: &Part, plan: &mut Plan) {
    for line in part.lines.iter().filter(|l| !l.is_remark() && !l.text.starts_with('#')) {
        let mut pieces = line.text.splitn(3, ',');
        let mut next = || pieces.next().unwrap_or("").trim().to_string();
        let (variable, name, comment) = (next(), next(), next());
        plan.symbols.push(Symbol { variable, name, comment, at: line.at.clone() });
    }
}

fn rung(part: &Part, report: &mut Report) -> Rung {
    let mut rung = Rung { next: -1, rows: Vec::new(), at: part.at.clone() };
    for line in part.lines.iter().filter(|l| !l.is_remark()) {
        if line.text.starts_with('#') {
            let next = line.value("NEXTRUNG").and_then(|n| n.trim().parse().ok());
            rung.next = next.unwrap_or(rung.next);
            continue;
        }
        let row = row(line, report);
        if rung.rows.len() == HIGHEST {
            report.say(&codes::TOO_LARGE, &line.at, say!("a rung of more than {HIGHEST} lines"));
            break;
        }
        rung.rows.push(row);
    }
    rung
}

/// `1-0-50/0 , 9-0-0/0 , …`.
fn row(line: &Line, report: &mut Report) -> Vec<Cell> {
    let mut cells = Vec::new();
    let mut start = line.at.start;
    for piece in line.text.split(',') {
        let lead = piece.len() - piece.trim_start().len();
        let at = start + lead..start + lead + piece.trim().len();
        start += piece.len() + 1;
        if cells.len() == WIDEST {
            report.say(&codes::TOO_LARGE, &at, say!("a rung of more than {WIDEST} columns"));
            break;
        }
        cells.push(cell(piece.trim(), at.clone()).unwrap_or_else(|| {
            report.say(&codes::BAD_VALUE, &at, say!("an element of a rung that cannot be read"));
            Cell { kind: 0, joined: false, var: (0, 0), index: None, at }
        }));
    }
    cells
}

fn cell(text: &str, at: Range<usize>) -> Option<Cell> {
    let (kind, rest) = text.split_once('-')?;
    let (joined, rest) = rest.split_once('-')?;
    let (var, index) = match rest.split_once('[') {
        Some((var, index)) => (var, Some(key(index.trim_end_matches(']'))?)),
        None => (rest, None),
    };
    let joined = joined.trim().parse::<i64>().ok()? != 0;
    Some(Cell { kind: kind.trim().parse().ok()?, joined, var: key(var)?, index, at })
}
