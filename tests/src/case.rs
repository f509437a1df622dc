//! Reads a conformance case from its Markdown file; `../spec/README.md` describes the form. A wrong
//! form is an error of the case and never ignored.

use std::path::{Path, PathBuf};

use g7_model::{Document, Expr, ExprKind, FileId, Literal, ProfileName};

/// The files at a path, at all levels of a folder, in the order of their names.
pub fn files(path: &Path) -> Vec<PathBuf> {
    let Ok(entries) = std::fs::read_dir(path) else { return vec![path.to_path_buf()] };
    let mut all: Vec<PathBuf> = entries.flatten().map(|e| e.path()).collect();
    all.sort();
    all.into_iter().flat_map(|p| files(&p)).collect()
}

/// The conformance cases in a folder.
pub fn cases(folder: &Path) -> Vec<PathBuf> {
    let is_case = |p: &PathBuf| p.extension().is_some_and(|e| e == "md") && !p.ends_with("README.md");
    files(folder).into_iter().filter(is_case).collect()
}

/// A case: one file.
#[derive(Debug)]
pub struct Case {
    /// The heading.
    pub title: String,
    /// The rule on which it is based.
    pub source: String,
    /// The codes that the checker must report, and no others.
    pub problems: Vec<String>,
    /// The chart, as .g7 text.
    pub chart: String,
    /// The runs of the chart.
    pub traces: Vec<Trace>,
}

/// One run.
#[derive(Debug)]
pub struct Trace {
    /// The profile named at the head of the trace; `None` for that of the folder.
    pub profile: Option<ProfileName>,
    /// The events of the run.
    pub lines: Vec<Line>,
}

/// A line of a trace.
#[derive(Debug)]
pub enum Line {
    /// A scan.
    Row(Row),
    /// `! restart`, `! restart cold`.
    Restart {
        /// True if retained variables are reset too.
        cold: bool,
    },
}

/// A scan, and the conditions that must hold after it.
#[derive(Debug)]
pub struct Row {
    /// The line in the file, from 1.
    pub line: usize,
    /// Its instant, in nanoseconds.
    pub at: i64,
    /// The inputs that change: a name for TRUE, or a name with a value.
    pub inputs: Vec<(String, Option<String>)>,
    /// The required end of the scan.
    pub end: End,
    /// The required outputs: names of BOOL outputs that are TRUE, others with their values.
    pub out: Option<Vec<String>>,
    /// Expressions that must be true.
    pub vars: Vec<String>,
    /// Variables for which a conflict must be reported in this scan.
    pub conflicts: Vec<String>,
}

/// The end of a scan.
#[derive(Debug)]
pub enum End {
    /// A situation: exactly these active steps.
    Situation(Vec<String>),
    /// A fault of this kind; `unstable` also with its cycle.
    Fault(String, Vec<Vec<String>>),
}

/// Time between the scans of a trace without `at`, in nanoseconds.
const STEP: i64 = 10_000_000;

/// Reads a case.
///
/// # Errors
///
/// The fault in its form.
pub fn read(text: &str) -> Result<Case, String> {
    let mut case = Case {
        title: String::new(),
        source: String::new(),
        problems: Vec::new(),
        chart: String::new(),
        traces: Vec::new(),
    };
    let mut fence: Option<(String, String, usize)> = None;
    for (number, line) in text.lines().enumerate() {
        if let Some(tag) = line.trim_end().strip_prefix("```") {
            match fence.take() {
                None => fence = Some((tag.trim().to_owned(), String::new(), number + 1)),
                Some((tag, body, at)) => close(&mut case, &tag, body, at)?,
            }
        } else if let Some((_, body, _)) = &mut fence {
            body.push_str(line);
            body.push('\n');
        } else if let Some(title) = line.strip_prefix("# ") {
            case.title = title.trim().to_owned();
        } else if let Some(source) = line.strip_prefix("source:") {
            case.source = source.trim().to_owned();
        } else if let Some(codes) = line.strip_prefix("problems:") {
            case.problems = words(codes);
        }
    }
    if fence.is_some() {
        return Err("a block is never closed".into());
    }
    if case.title.is_empty() {
        return Err("a case has a heading".into());
    }
    if case.source.is_empty() {
        return Err("a case must name its source".into());
    }
    if case.chart.is_empty() {
        return Err("a case has a chart".into());
    }
    let empty = case.traces.iter().any(|t| !t.lines.iter().any(|l| matches!(l, Line::Row(_))));
    if empty || (case.traces.is_empty() && case.problems.is_empty()) {
        return Err("a case without a trace checks nothing".into());
    }
    Ok(case)
}

fn close(case: &mut Case, tag: &str, body: String, at: usize) -> Result<(), String> {
    match &words(tag)[..] {
        [one] if one == "g7" && case.chart.is_empty() => case.chart = body,
        [one] if one == "g7" => return Err("a case has one chart".into()),
        [one, rest @ ..] if one == "trace" => {
            let profile = match rest {
                [] => None,
                [name] => Some(profile_named(name)?),
                _ => return Err(format!("cannot read `{tag}`")),
            };
            case.traces.push(Trace { profile, lines: trace(&body, at)? });
        }
        _ => {} // an illustration
    }
    Ok(())
}

/// Finds a profile by its name.
///
/// # Errors
///
/// There is no such profile.
pub fn profile_named(name: &str) -> Result<ProfileName, String> {
    let found = ProfileName::ALL.into_iter().find(|p| p.name() == name);
    found.ok_or_else(|| format!("no profile `{name}`"))
}

fn words(text: &str) -> Vec<String> {
    text.split_whitespace().map(str::to_owned).collect()
}

fn trace(body: &str, at: usize) -> Result<Vec<Line>, String> {
    let mut lines: Vec<Line> = Vec::new();
    let mut header: Option<Vec<String>> = None;
    let mut now = -STEP;
    for (i, line) in body.lines().enumerate() {
        let number = at + i + 1;
        let said = |what: String| format!("line {number}: {what}");
        if line.trim().is_empty() {
            continue;
        }
        if let Some(order) = line.trim().strip_prefix('!') {
            order_line(&words(order), &mut lines).map_err(said)?;
            continue;
        }
        let cells = cells(line);
        let Some(header) = &header else {
            let known = ["at", "in", "situation", "out", "vars"];
            if let Some(odd) = cells.iter().find(|c| !known.contains(&c.as_str())) {
                return Err(said(format!("no column `{odd}`")));
            }
            if !cells.iter().any(|c| c == "situation") {
                return Err(said("the column `situation` must be there".into()));
            }
            header = Some(cells);
            continue;
        };
        // Cells at the end may be left out; they are not checked then.
        if cells.len() > header.len() {
            return Err(said("more cells than columns".into()));
        }
        let cell = |name: &str| header.iter().position(|h| h == name).and_then(|i| cells.get(i));
        now = match cell("at") {
            Some(text) => duration(text).ok_or_else(|| said(format!("no duration `{text}`")))?,
            None => now + STEP,
        };
        let list = |name: &str| cell(name).map(|c| items(c));
        let inputs = list("in").unwrap_or_default().into_iter().map(|item| match item.split_once('=') {
            Some((name, value)) => (name.to_owned(), Some(value.to_owned())),
            None => (item, None),
        });
        let situation = cell("situation").ok_or_else(|| said("no situation".into()))?;
        lines.push(Line::Row(Row {
            line: number,
            at: now,
            inputs: inputs.collect(),
            end: end(situation).map_err(said)?,
            out: list("out"),
            vars: list("vars").unwrap_or_default(),
            conflicts: Vec::new(),
        }));
    }
    Ok(lines)
}

fn order_line(order: &[String], lines: &mut Vec<Line>) -> Result<(), String> {
    let order: Vec<&str> = order.iter().map(String::as_str).collect();
    match (&order[..], lines.last_mut()) {
        (["restart"], _) => lines.push(Line::Restart { cold: false }),
        (["restart", "cold"], _) => lines.push(Line::Restart { cold: true }),
        (["diagnostic", "conflicting", name], Some(Line::Row(row))) => row.conflicts.push((*name).to_owned()),
        _ => return Err(format!("cannot read `! {}`", order.join(" "))),
    }
    Ok(())
}

/// The cells between bars; a bar within back-ticks is text.
fn cells(line: &str) -> Vec<String> {
    let mut cells = vec![String::new()];
    let mut quoted = false;
    for c in line.chars() {
        quoted ^= c == '`';
        if c == '|' && !quoted {
            cells.push(String::new());
        } else if let Some(last) = cells.last_mut() {
            last.push(c);
        }
    }
    cells.iter().map(|c| c.trim().to_owned()).collect()
}

/// The items of a cell, separated by blanks; back-ticks and quotes keep blanks together.
fn items(cell: &str) -> Vec<String> {
    let mut all = vec![String::new()];
    let mut within: Option<char> = None;
    for c in cell.chars() {
        match within {
            Some(w) if c == w => within = None,
            None if c == '`' || c == '\'' => within = Some(c),
            None if c.is_whitespace() => {
                all.push(String::new());
                continue;
            }
            _ => {}
        }
        if let Some(last) = all.last_mut() {
            last.push(c);
        }
    }
    all.into_iter().filter(|i| !i.is_empty() && i != "-").collect()
}

fn end(cell: &str) -> Result<End, String> {
    let Some(fault) = cell.strip_prefix("fault") else { return Ok(End::Situation(items(cell))) };
    let (kind, cycle) = match fault.split_once('{') {
        Some((kind, cycle)) => (kind.trim(), Some(cycle)),
        None => (fault.trim(), None),
    };
    if !["unstable", "forcing", "overflow", "division", "bound", "range", "table"].contains(&kind) {
        return Err(format!("no fault `{kind}`"));
    }
    let cycle = match cycle {
        Some(rest) => rest.split('{').map(|s| words(s.trim().trim_end_matches('}'))).collect(),
        None => Vec::new(),
    };
    Ok(End::Fault(kind.to_owned(), cycle))
}

/// Reads a duration such as `10ms`, `1.5s`, `1h30m`.
fn duration(text: &str) -> Option<i64> {
    match expression(text).ok()?.kind {
        ExprKind::Literal(Literal::Time(time)) => Some(time.count()),
        ExprKind::Literal(Literal::Int(0, None)) => Some(0),
        _ => None,
    }
}

/// Reads an item of a `vars` or `out` cell as an expression: `k=3`, `m`, `X12.t=1.5s`, or any
/// expression in back-ticks.
///
/// # Errors
///
/// It is not an expression.
pub fn demand(item: &str) -> Result<Expr, String> {
    if let Some(free) = item.strip_prefix('`').and_then(|i| i.strip_suffix('`')) {
        return expression(free);
    }
    match item.split_once('=') {
        Some((name, value)) => expression(&format!("({name}) = ({value})")),
        None => expression(item),
    }
}

/// Reads an expression of the language.
///
/// # Errors
///
/// It is not an expression.
pub fn expression(text: &str) -> Result<Expr, String> {
    let (e, problems) = g7_syntax::parse_expr(text, FileId(0));
    match problems.first() {
        None => Ok(e),
        Some(p) => Err(format!("`{text}`: {}", p.what)),
    }
}

/// Reads the chart of a case.
///
/// # Errors
///
/// The first problem of its text.
pub fn document(text: &str) -> Result<Document, String> {
    let (doc, problems) = g7_syntax::parse(text, FileId(0));
    match problems.first() {
        None => Ok(doc),
        Some(p) => {
            let at = (p.at.start as usize).min(text.len());
            let line = text.as_bytes()[..at].iter().filter(|b| **b == b'\n').count() + 1;
            Err(format!("{} {} (line {line} of the chart)", p.code.id, p.what))
        }
    }
}
