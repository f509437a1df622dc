//! The wiring of a chart, for the page: its io file is shown, changed, and its devices are asked.
//!
//! ```text
//! look:  chart + io file -> sight -> JSON                    nothing is changed
//! edit:  io file + changes -> setup::edit -> folder          whole or not at all, and only the file it knows
//! live:  io file -> asker -> devices                         they are read, never written
//! ```

mod asker;
mod sight;
mod turn;

use axum::extract::{Request, State};
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use axum::routing::post;
use axum::{Extension, Json, Router};
use g7_model::say;
use g7_online::setup::{Change, Plain, edit};
use serde::Deserialize;
use serde_json::{Value, json};

use sight::{Chart, Sight};
pub(super) use turn::Asker;

use super::api::{Answer, told};
use super::aside::aside;
use super::bodies::json_body;
use super::fingerprint;
use super::folder::{Wanted, Written};
use super::refusal::Refusal;
use super::shared::Shared;
use crate::who::Who;

/// Greatest number of changes of one request.
const CHANGES: usize = 1_000;

/// The addresses of the wiring.
pub(super) fn routes() -> Router<Shared> {
    Router::new()
        .route("/api/wiring/look", post(look))
        .route("/api/wiring/edit", post(change))
        .route("/api/wiring/live", post(live))
}

async fn look(State(shared): State<Shared>, request: Request) -> Answer {
    let chart: Chart = json_body(request).await?;
    let sight = aside(move || Sight::new(&shared, &chart)?.json(&shared)).await?;
    Ok(Json(sight).into_response())
}

/// A change as the page asks for it.
#[derive(Deserialize)]
#[serde(tag = "do", rename_all = "lowercase")]
enum Wish {
    Set { path: Vec<String>, value: Value },
    Remove { path: Vec<String> },
    Rename { from: String, to: String },
}

async fn change(State(shared): State<Shared>, Extension(who): Extension<Who>, request: Request) -> Answer {
    #[derive(Deserialize)]
    struct Edit {
        #[serde(flatten)]
        chart: Chart,
        /// That of the io file as the page knows it; none where there was no file.
        hash: Option<String>,
        changes: Vec<Wish>,
    }
    let Edit { chart, hash, changes } = json_body(request).await?;
    if changes.len() > CHANGES {
        return Err(Refusal::bad(say!("at most {CHANGES} changes are made at once")));
    }
    let changes = changes.into_iter().map(read).collect::<Result<Vec<Change>, Refusal>>()?;
    let (done, sight) = aside(move || {
        let before = Sight::new(&shared, &chart)?;
        let wanted = hash.map_or(Wanted::Absent, Wanted::Hash);
        let known = before.bytes.as_ref().map(|bytes| fingerprint::hash(bytes));
        // A file that has changed since is not read for the changes: the page looks first.
        let fits = match &wanted {
            Wanted::Hash(hash) => known.as_ref() == Some(hash),
            Wanted::Absent | Wanted::Any => known.is_none(),
        };
        if !fits {
            return Ok((false, before.json(&shared)?));
        }
        let text = edit(&before.text, &changes).map_err(|why| Refusal::bad(why.0))?;
        told(&shared, &who, "file-write", &json!({ "file": before.io, "bytes": text.len() }))?;
        let done = shared.folder.write(&before.io, text.as_bytes(), &wanted)?;
        Ok((matches!(done, Written::Done(_)), Sight::new(&shared, &chart)?.json(&shared)?))
    })
    .await?;
    let status = if done { StatusCode::OK } else { StatusCode::PRECONDITION_FAILED };
    Ok((status, Json(sight)).into_response())
}

fn read(wish: Wish) -> Result<Change, Refusal> {
    Ok(match wish {
        Wish::Set { path, value } => Change::Set(path, plain(value)?),
        Wish::Remove { path } => Change::Remove(path),
        Wish::Rename { from, to } => Change::Rename(from, to),
    })
}

fn plain(value: Value) -> Result<Plain, Refusal> {
    let none = || Refusal::bad(say!("a setting is a text, a number, true or false, or a table"));
    Ok(match value {
        Value::String(text) => Plain::Text(text),
        Value::Bool(on) => Plain::Flag(on),
        Value::Number(n) => match (n.as_i64(), n.as_f64()) {
            (Some(n), _) => Plain::Whole(n),
            (None, Some(x)) => Plain::Number(x),
            (None, None) => return Err(none()),
        },
        Value::Object(rows) => {
            let rows = rows.into_iter().map(|(key, value)| Ok((key, plain(value)?)));
            Plain::Table(rows.collect::<Result<_, Refusal>>()?)
        }
        Value::Null | Value::Array(_) => return Err(none()),
    })
}

async fn live(State(shared): State<Shared>, request: Request) -> Result<Response, Refusal> {
    let chart: Chart = json_body(request).await?;
    Ok(Json(asker::live(&shared, chart).await?).into_response())
}
