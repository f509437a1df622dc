//! Files over HTTP: listing, reading, writing (with the known hash in `If-Match`).

use std::sync::Arc;

use axum::extract::{Query, Request, State};
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use axum::{Extension, Json, Router};
use g7_model::{Said, say};
use serde::Deserialize;
use serde_json::{Value, json};

use super::aside::aside;
use super::bodies::{body, json_body};
use super::fingerprint;
use super::folder::{Wanted, Written};
use super::refusal::Refusal;
use super::shared::{Inner, Shared};
use crate::who::Who;

pub(super) type Answer = Result<Response, Refusal>;

/// The addresses below `/api`.
pub(super) fn routes() -> Router<Shared> {
    Router::new()
        .route("/api/info", get(info))
        .route("/api/files", get(files))
        .route("/api/file", get(read).put(write))
        .route("/api/new", post(new))
        .route("/api/rename", post(rename))
        .route("/api/delete", post(delete))
}

#[derive(Deserialize)]
struct At {
    path: String,
}

async fn info(State(shared): State<Shared>) -> Json<Value> {
    let mut info = json!({
        "name": "g7",
        "version": env!("CARGO_PKG_VERSION"),
        "read_only": shared.folder.is_read_only(),
        "folder": shared.title,
        "place": shared.place,
        "online": shared.station.is_some(),
    });
    if let (Some(start), Some(info)) = (&shared.start, info.as_object_mut()) {
        info.insert("start".to_owned(), json!(start));
    }
    Json(info)
}

async fn files(State(shared): State<Shared>) -> Answer {
    let rows = aside(move || Ok(shared.watch.rows())).await?;
    Ok(Json(json!({ "files": rows })).into_response())
}

async fn read(State(shared): State<Shared>, Query(at): Query<At>) -> Answer {
    let bytes = aside(move || shared.folder.read(&at.path)).await?;
    Ok(text(StatusCode::OK, bytes))
}

/// The deed of a person at a file, in the log before it is done.
pub(super) fn told(shared: &Inner, who: &Who, kind: &str, data: &Value) -> Result<(), Refusal> {
    let unwritten = |why: String| Refusal::new(StatusCode::INSUFFICIENT_STORAGE, Said::foreign(why));
    shared.audit.must(who, kind, data).map_err(unwritten)
}

async fn write(
    State(shared): State<Shared>,
    Query(at): Query<At>,
    Extension(who): Extension<Who>,
    request: Request,
) -> Answer {
    let wanted = wanted(request.headers())?;
    let bytes = body(request).await?;
    let written = aside(move || {
        told(&shared, &who, "file-write", &json!({ "file": at.path, "bytes": bytes.len() }))?;
        shared.watch.put_off(&at.path);
        shared.folder.write(&at.path, &bytes, &wanted)
    });
    Ok(match written.await? {
        Written::Done(hash) => {
            (StatusCode::NO_CONTENT, [(header::ETAG, format!("\"{hash}\""))]).into_response()
        }
        Written::Other(Some(bytes)) => text(StatusCode::PRECONDITION_FAILED, bytes),
        Written::Other(None) => StatusCode::PRECONDITION_FAILED.into_response(),
    })
}

async fn new(State(shared): State<Shared>, Extension(who): Extension<Who>, request: Request) -> Answer {
    #[derive(Deserialize)]
    struct New {
        path: String,
        #[serde(default)]
        text: String,
    }
    let wish: New = json_body(request).await?;
    let path = wish.path.clone();
    let written = aside(move || {
        told(&shared, &who, "file-new", &json!({ "file": wish.path }))?;
        shared.folder.write(&wish.path, wish.text.as_bytes(), &Wanted::Absent)
    });
    match written.await? {
        Written::Done(hash) => {
            Ok((StatusCode::NO_CONTENT, [(header::ETAG, format!("\"{hash}\""))]).into_response())
        }
        Written::Other(_) => Err(Refusal::io(&path, &std::io::ErrorKind::AlreadyExists.into())),
    }
}

async fn rename(State(shared): State<Shared>, Extension(who): Extension<Who>, request: Request) -> Answer {
    #[derive(Deserialize)]
    struct Rename {
        from: String,
        to: String,
    }
    let wish: Rename = json_body(request).await?;
    aside(move || {
        told(&shared, &who, "file-rename", &json!({ "file": wish.from, "to": wish.to }))?;
        shared.folder.rename(&wish.from, &wish.to)
    })
    .await?;
    Ok(StatusCode::NO_CONTENT.into_response())
}

async fn delete(State(shared): State<Shared>, Extension(who): Extension<Who>, request: Request) -> Answer {
    #[derive(Deserialize)]
    struct Delete {
        path: String,
        hash: Option<String>,
    }
    let wish: Delete = json_body(request).await?;
    aside(move || {
        told(&shared, &who, "file-delete", &json!({ "file": wish.path }))?;
        shared.folder.delete(&wish.path, wish.hash.as_deref())
    })
    .await?;
    Ok(StatusCode::NO_CONTENT.into_response())
}

/// The bytes of a file, declared as plain text so that no browser executes them.
fn text(status: StatusCode, bytes: Vec<u8>) -> Response {
    let head = [
        (header::CONTENT_TYPE, "text/plain; charset=utf-8".to_owned()),
        (header::CACHE_CONTROL, "no-store".to_owned()),
        (header::ETAG, format!("\"{}\"", fingerprint::hash(&bytes))),
    ];
    (status, head, bytes).into_response()
}

/// The required state of the file, from the headers.
fn wanted(headers: &HeaderMap) -> Result<Wanted, Refusal> {
    let of = |name| headers.get(name).and_then(|v| v.to_str().ok()).map(str::trim);
    match (of(header::IF_MATCH), of(header::IF_NONE_MATCH)) {
        (Some("*"), None) => Ok(Wanted::Any),
        (Some(tag), None) => {
            let bare = tag.strip_prefix('"').and_then(|t| t.strip_suffix('"'));
            let bare = bare.ok_or_else(|| Refusal::bad(say!("`If-Match` needs one hash in quotes")))?;
            Ok(Wanted::Hash(bare.to_owned()))
        }
        (None, Some("*")) => Ok(Wanted::Absent),
        _ => Err(Refusal::new(
            StatusCode::PRECONDITION_REQUIRED,
            say!(
                "a file is written with `If-Match` and the hash it was read with, or `If-None-Match: *` for a new one"
            ),
        )),
    }
}

/// The text of a chart, for a run.
pub(super) async fn chart(shared: &Shared, name: &str) -> Result<String, String> {
    let (folder, name) = (Arc::clone(&shared.folder), name.to_owned());
    let bytes = aside(move || folder.read(&name)).await.map_err(|r| r.text.to_string())?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}
