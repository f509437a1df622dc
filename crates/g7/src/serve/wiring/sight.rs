//! A chart and its io file as the page shows them: signals, devices, channels, and what is wrong where.

use g7_host::Kind;
use g7_model::{FileId, Problem, Severity, say};
use g7_online::Wiring;
use g7_online::setup::catalogue::{
    Argument, CONTROLLER, Carries, Form, KINDS, KindRow, Point, Setting, Usual,
};
use g7_online::setup::{self, Entry, Setup};
use g7_rig::{Bench, Options, Role};
use serde::Deserialize;
use serde_json::{Value, json};

use super::super::fingerprint;
use super::super::refusal::Refusal;
use super::super::shared::Shared;
use crate::sources::Source;

/// A chart, whose text may not be saved yet.
#[derive(Clone, Deserialize)]
pub(super) struct Chart {
    pub(super) path: String,
    pub(super) text: Option<String>,
}

/// Greatest number of problems that are told.
const PROBLEMS: usize = 200;

/// A chart and its io file.
pub(super) struct Sight {
    /// The path of the io file in the folder.
    pub(super) io: String,
    /// Its bytes; `None` where there is no file yet.
    pub(super) bytes: Option<Vec<u8>>,
    pub(super) text: String,
    pub(super) setup: Setup,
    /// `None` where the chart has an error.
    pub(super) bench: Option<Bench>,
    pub(super) wiring: Wiring,
    problems: Vec<Problem>,
    /// Errors of the chart.
    chart: Vec<String>,
}

/// The path of the io file of a chart.
fn io_of(chart: &str) -> String {
    let (folder, name) = chart.rsplit_once('/').map_or(("", chart), |(folder, name)| (folder, name));
    let stem = name.rsplit_once('.').map_or(name, |(stem, _)| stem);
    if folder.is_empty() { format!("{stem}.io.toml") } else { format!("{folder}/{stem}.io.toml") }
}

impl Sight {
    /// Reads both files; the text of the chart may be one that is not saved yet.
    pub(super) fn new(shared: &Shared, chart: &Chart) -> Result<Sight, Refusal> {
        let bytes = match &chart.text {
            Some(text) => text.clone().into_bytes(),
            None => shared.folder.read(&chart.path)?,
        };
        let io = io_of(&chart.path);
        let found = match shared.folder.read(&io) {
            Ok(bytes) => Some(bytes),
            Err(refusal) if refusal.status == axum::http::StatusCode::NOT_FOUND => None,
            Err(refusal) => return Err(refusal),
        };
        let text = String::from_utf8(found.clone().unwrap_or_default())
            .map_err(|_| Refusal::bad(say!("`{io}` is not UTF-8 text: mend it in a text editor first")))?;
        let mut source = Source::new(&chart.path, bytes, 0);
        source.link(&mut |path| {
            let read = shared.folder.read(&g7_rig::named(&chart.path, path));
            read.map_err(|refusal| refusal.text)
        });
        let options = Options { plant: Some("none"), ..Options::default() };
        let (bench, of_chart) = g7_rig::build(&source, &options).map_err(|why| Refusal::bad(why.said()))?;
        let (setup, mut problems) = setup::read(&text, FileId(1));
        problems.extend(g7_online::lacking(&setup));
        let mut wiring = Wiring::default();
        if let Some(bench) = &bench {
            let (wired, wrong) = g7_online::wire(bench, &setup);
            problems.extend(wrong);
            wiring = wired;
        }
        let errors = of_chart.iter().filter(|p| p.severity() == Severity::Error);
        let chart = errors.map(|p| format!("{}: {}", source.place(p.at), p.what)).take(10).collect();
        Ok(Sight { io, bytes: found, text, setup, bench, wiring, problems, chart })
    }

    /// All of it for the page.
    pub(super) fn json(&self, shared: &Shared) -> Result<Value, Refusal> {
        let entries = setup::outline(&self.text, FileId(1));
        Ok(json!({
            "io": self.io,
            "hash": self.bytes.as_ref().map(|bytes| fingerprint::hash(bytes)),
            "text": self.text,
            "read_only": shared.folder.is_read_only(),
            "asks": shared.asker.asks(),
            "online": shared.station.is_some(),
            "chart": self.chart,
            "signals": self.bench.as_ref().map(signals).unwrap_or_default(),
            "controller": entries.iter().find(|e| e.path == ["controller"]).map(|e| &e.value),
            "devices": devices(&entries),
            "channels": self.channels(&entries),
            "problems": self.problems.iter().take(PROBLEMS).map(|p| self.problem(p, &entries)).collect::<Vec<_>>(),
            "kinds": KINDS.iter().map(kind).collect::<Vec<_>>(),
            "settings": CONTROLLER.iter().map(setting).collect::<Vec<_>>(),
        }))
    }

    /// The channels of each table, with the variable that each key names.
    fn channels(&self, entries: &[Entry]) -> Value {
        let of = |table: &str| -> Vec<Value> {
            let rows = entries.iter().filter(|e| matches!(e.path.as_slice(), [t, _] if t == table));
            rows.map(|entry| {
                let key = entry.path.last();
                let item = key.and_then(|key| self.bench.as_ref()?.item(key));
                let at = entry.value.get("at").unwrap_or(&entry.value);
                let mut settings = entry.value.as_object().cloned().unwrap_or_default();
                settings.remove("at");
                json!({
                    "key": key,
                    "variable": item.map(|item| &item.name),
                    "at": at.as_str(),
                    "settings": settings,
                    "short": entry.value.is_string(),
                })
            })
            .collect()
        };
        json!({ "inputs": of("inputs"), "outputs": of("outputs"), "shown": of("shown") })
    }

    /// A problem, with the path of the key at which it stands.
    fn problem(&self, problem: &Problem, entries: &[Entry]) -> Value {
        let at = problem.at.start;
        let of = |entry: &&Entry| {
            let within = |span: g7_model::Span| (span.start..span.end).contains(&at);
            within(entry.key) || within(entry.at)
        };
        let path = entries.iter().filter(of).map(|e| &e.path).max_by_key(|path| path.len());
        let above = self.text.get(..at as usize).unwrap_or("");
        json!({
            "code": problem.code.id,
            "path": path,
            "line": 1 + above.matches('\n').count(),
            "what": problem.what.as_str(),
            "help": problem.help.as_deref(),
            "related": problem.related.iter().map(|(_, what)| what.as_str()).collect::<Vec<_>>(),
            "error": problem.severity() == Severity::Error,
        })
    }
}

/// The inputs and outputs of a chart, and what can be shown to others.
fn signals(bench: &Bench) -> Vec<Value> {
    let items = bench.items.iter().filter(|item| item.role != Role::Plant).map(|item| {
        let variable = bench.compiled.symbols.variable(&item.name);
        let role = match item.role {
            Role::Input(_) => "input",
            Role::Output => "output",
            Role::Variable | Role::Plant => "variable",
        };
        json!({
            "name": item.name,
            "role": role,
            "carries": carries(item.kind),
            "type": item.ty.to_string(),
            "comment": item.comment,
            "address": variable.and_then(|v| v.address.as_deref()),
            "inverted": variable.is_some_and(|v| v.inverted),
            "safe": bench.safe(item).map(|word| item.show(&g7_host::Value::Word(word))),
        })
    });
    let steps = bench.steps.iter().map(|step| {
        json!({ "name": step.activity(), "role": "step", "carries": "bit", "type": "BOOL", "comment": step.comment })
    });
    items.chain(steps).collect()
}

fn carries(kind: Kind) -> &'static str {
    match kind {
        Kind::Bool => "bit",
        Kind::Int { .. } => "whole",
        Kind::Real | Kind::Lreal | Kind::Time | Kind::Moment(_) => "number",
        Kind::Text => "text",
    }
}

/// The devices in the order of the file.
fn devices(entries: &[Entry]) -> Vec<Value> {
    let rows = entries.iter().filter(|e| matches!(e.path.as_slice(), [t, _] if t == "devices"));
    rows.map(|entry| {
        let mut settings = entry.value.as_object().cloned().unwrap_or_default();
        let kind = settings.remove("kind");
        json!({ "name": entry.path.last(), "kind": kind, "settings": settings })
    })
    .collect()
}

/// A kind of device as data of the page.
fn kind(row: &KindRow) -> Value {
    json!({
        "word": row.word,
        "about": row.about,
        "there": g7_online::has(row.word),
        "shows": row.shows,
        "settings": row.settings.concat().iter().map(setting).collect::<Vec<_>>(),
        "points": row.points.iter().map(point).collect::<Vec<_>>(),
    })
}

fn setting(row: &Setting) -> Value {
    let form = match row.form {
        Form::Text => json!({ "is": "text" }),
        Form::Whole(least, most) => json!({ "is": "whole", "least": least, "most": most }),
        Form::Number => json!({ "is": "number" }),
        Form::Duration(least, most) => json!({ "is": "duration", "least": least, "most": most }),
        Form::Words(words) => json!({ "is": "words", "words": words }),
        Form::Flag => json!({ "is": "flag" }),
        Form::Bad => json!({ "is": "bad" }),
        Form::Table(rows) => {
            json!({ "is": "table", "settings": rows.iter().map(setting).collect::<Vec<_>>() })
        }
        Form::FlagOrTable(rows) => {
            json!({ "is": "flag-or-table", "settings": rows.iter().map(setting).collect::<Vec<_>>() })
        }
    };
    let (usual, text) = match row.usual {
        Usual::Needed(text) => ("needed", text),
        Usual::Is(text) => ("is", text.trim_matches('"')),
        Usual::None(text) => ("none", text),
    };
    json!({ "key": row.key, "form": form, "usual": usual, "example": text, "about": row.about })
}

fn point(row: &Point) -> Value {
    let argument = match row.argument {
        Argument::Nothing => json!({ "is": "nothing" }),
        Argument::Address(most) => json!({ "is": "address", "most": most }),
        Argument::Bit(most) => json!({ "is": "bit", "most": most }),
        Argument::Text(text) => json!({ "is": "text", "example": text }),
        Argument::TextOrName(text) => json!({ "is": "name", "example": text }),
        Argument::Word(words) => json!({ "is": "word", "words": words }),
        Argument::List(text) => json!({ "is": "list", "example": text }),
        Argument::Alone(text) => json!({ "is": "alone", "example": text }),
    };
    let carries = match row.carries {
        Carries::Bit => "bit",
        Carries::Number => "number",
        Carries::Whole => "whole",
        Carries::Any => "any",
    };
    let settings = |list: &[&[Setting]]| list.concat().iter().map(setting).collect::<Vec<_>>();
    json!({
        "word": row.word,
        "argument": argument,
        "carries": carries,
        "input": row.input,
        "output": row.output,
        "of_input": settings(row.of_input),
        "of_output": settings(row.of_output),
        "about": row.about,
    })
}
