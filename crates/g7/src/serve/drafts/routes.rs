//! Copies of unsaved work over HTTP. Each request names the window of the page that sends it; the person is the user
//! who is logged in.

use std::sync::Arc;
use std::time::Duration;

use axum::extract::{Query, Request, State};
use axum::http::StatusCode;
use axum::response::IntoResponse as _;
use axum::routing::{get, post};
use axum::{Extension, Json, Router};
use g7_model::say;
use serde::Deserialize;
use serde_json::json;

use super::{End, Owner};
use crate::serve::api::Answer;
use crate::serve::aside::aside;
use crate::serve::bodies::body;
use crate::serve::refusal::Refusal;
use crate::serve::shared::{Inner, Shared};
use crate::who::Who;

/// The longest name of a window.
const LONGEST: usize = 64;
/// Time between two looks for windows that come again after a restart.
const LOOK: Duration = Duration::from_millis(200);

/// The addresses of the copies.
pub(crate) fn routes() -> Router<Shared> {
    Router::new()
        .route("/api/draft", get(read).put(keep).delete(drop))
        .route("/api/draft/take", post(take))
        .route("/api/draft/saved", post(saved))
        .route("/api/drafts", get(list))
}

/// The window that asks, and the copy or the file that is meant.
#[derive(Deserialize)]
struct At {
    #[serde(default)]
    window: String,
    #[serde(default)]
    path: String,
    #[serde(default)]
    id: String,
}

/// How a copy is stored.
#[derive(Deserialize)]
struct Kept {
    end: End,
    base: Option<String>,
}

/// The owner of what a window of someone writes.
pub(crate) fn owner(who: &Who, window: &str) -> Result<Owner, Refusal> {
    if window.is_empty() || window.len() > LONGEST || !window.chars().all(|c| c.is_ascii_alphanumeric()) {
        return Err(Refusal::bad(say!("this request means nothing")));
    }
    Ok(Owner { person: who.name.clone(), window: window.to_owned() })
}

fn writable(shared: &Inner) -> Result<(), Refusal> {
    if shared.folder.is_read_only() { Err(Refusal::read_only()) } else { Ok(()) }
}

async fn list(State(shared): State<Shared>, Query(at): Query<At>, Extension(who): Extension<Who>) -> Answer {
    let owner = owner(&who, &at.window)?;
    loop {
        let (of, asks) = (Arc::clone(&shared), owner.clone());
        let rows = aside(move || Ok(of.drafts.list(&asks))).await?;
        if !shared.drafts.may_come(&rows) {
            return Ok(Json(json!({ "drafts": rows })).into_response());
        }
        tokio::time::sleep(LOOK).await;
    }
}

async fn read(State(shared): State<Shared>, Query(at): Query<At>, Extension(who): Extension<Who>) -> Answer {
    let draft = aside(move || shared.drafts.read(&who.name, &at.id)).await?;
    Ok(Json(draft).into_response())
}

async fn keep(
    State(shared): State<Shared>,
    Query(at): Query<At>,
    Query(kept): Query<Kept>,
    Extension(who): Extension<Who>,
    request: Request,
) -> Answer {
    writable(&shared)?;
    let owner = owner(&who, &at.window)?;
    let bytes = body(request).await?;
    let text =
        String::from_utf8(bytes).map_err(|_| Refusal::bad(say!("an unsaved copy must be UTF-8 text")))?;
    aside(move || shared.drafts.keep(&owner, &at.path, kept.end, kept.base, &text)).await?;
    Ok(StatusCode::NO_CONTENT.into_response())
}

async fn take(State(shared): State<Shared>, Query(at): Query<At>, Extension(who): Extension<Who>) -> Answer {
    writable(&shared)?;
    let owner = owner(&who, &at.window)?;
    let draft = aside(move || shared.drafts.take(&owner, &at.id)).await?;
    Ok(Json(draft).into_response())
}

async fn saved(State(shared): State<Shared>, Query(at): Query<At>, Extension(who): Extension<Who>) -> Answer {
    writable(&shared)?;
    let owner = owner(&who, &at.window)?;
    aside(move || shared.drafts.saved(&owner, &at.path)).await?;
    Ok(StatusCode::NO_CONTENT.into_response())
}

async fn drop(State(shared): State<Shared>, Query(at): Query<At>, Extension(who): Extension<Who>) -> Answer {
    writable(&shared)?;
    let owner = owner(&who, &at.window)?;
    aside(move || shared.drafts.drop(&owner, &at.id)).await?;
    Ok(StatusCode::NO_CONTENT.into_response())
}
