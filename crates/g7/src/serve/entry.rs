//! Logging in and out, the users, and the log, over HTTP.
//!
//! ```text
//! GET  /api/session              who asks, and what there is
//! POST /api/login                { name, password }
//! POST /api/first                { code, name, password }: the first admin
//! POST /api/logout
//! POST /api/password             { old, new }: one's own
//! GET  /api/users                for an admin, as all below
//! POST /api/users                { do: add | role | password | remove | revoke, name, role, password }
//! GET  /api/guests               the token of guests, for who may write files
//! GET  /api/log                  ?from=&until=&level=&text=&before=
//! ```

use std::sync::Arc;

use axum::extract::{Query, Request, State};
use axum::http::{HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use axum::{Extension, Json, Router};
use g7_host::utc_millis;
use g7_model::say;
use g7_store::log::{Filter, Reader};
use g7_store::users::Role;
use serde::Deserialize;
use serde_json::{Value, json};

use super::access::{Access, refusal};
use super::aside::aside;
use super::bodies::small_json;
use super::guard::{COOKIE, peer};
use super::refusal::Refusal;
use super::shared::Shared;
use crate::failure::raw;
use crate::who::Who;

type Answer = Result<Response, Refusal>;

/// Rows of the log in an answer.
const PAGE: usize = 100;

pub(super) fn routes() -> Router<Shared> {
    Router::new()
        .route("/api/session", get(session))
        .route("/api/login", post(login))
        .route("/api/first", post(first))
        .route("/api/logout", post(logout))
        .route("/api/password", post(password))
        .route("/api/users", get(users).post(change))
        .route("/api/log", get(log))
        .route("/api/guests", get(guests))
}

fn access(shared: &Shared) -> Result<Arc<Access>, Refusal> {
    let none =
        || Refusal::new(StatusCode::NOT_FOUND, say!("this server has no users: `g7 serve --users FILE` has"));
    shared.access.clone().ok_or_else(none)
}

/// Who asks. Without users the one with the token may do everything.
async fn session(State(shared): State<Shared>, who: Option<Extension<Who>>) -> Json<Value> {
    let guest = who.as_ref().is_some_and(|Extension(who)| who.guest);
    let user = who.map(|Extension(who)| json!({ "name": who.name, "role": who.role.word() }));
    let Some(access) = &shared.access else {
        let user = user.filter(|_| guest);
        return Json(json!({ "users": false, "guest": guest, "user": user, "log": shared.audit.is_kept() }));
    };
    Json(json!({
        "users": true,
        "guest": guest,
        "first": access.code().is_some(),
        "user": user,
        "log": shared.audit.is_kept(),
    }))
}

async fn guests(State(shared): State<Shared>) -> Json<Value> {
    Json(json!({ "token": shared.guests.get() }))
}

#[derive(Deserialize)]
struct Login {
    #[serde(default)]
    code: String,
    name: String,
    password: String,
}

/// An answer that gives the browser its session. It has no end of its own: the server knows it.
fn begun(secret: &str) -> Response {
    let mut response = StatusCode::NO_CONTENT.into_response();
    let cookie = format!("{COOKIE}={secret}; Path=/; Secure; HttpOnly; SameSite=Strict");
    if let Ok(cookie) = HeaderValue::from_str(&cookie) {
        response.headers_mut().insert(header::SET_COOKIE, cookie);
    }
    response
}

async fn login(State(shared): State<Shared>, request: Request) -> Answer {
    let (access, from) = (access(&shared)?, peer(&request));
    let Login { name, password, .. } = small_json(request).await?;
    Ok(begun(&access.login(name, password, from).await?))
}

async fn first(State(shared): State<Shared>, request: Request) -> Answer {
    let (access, from) = (access(&shared)?, peer(&request));
    let Login { code, name, password } = small_json(request).await?;
    Ok(begun(&access.first(code, name, password, from).await?))
}

async fn logout(State(shared): State<Shared>, Extension(who): Extension<Who>) -> Answer {
    let access = access(&shared)?;
    aside(move || access.logout(&who)).await?;
    let mut response = StatusCode::NO_CONTENT.into_response();
    let gone = "__Host-g7=; Path=/; Secure; HttpOnly; SameSite=Strict; Max-Age=0";
    response.headers_mut().insert(header::SET_COOKIE, HeaderValue::from_static(gone));
    Ok(response)
}

async fn password(State(shared): State<Shared>, Extension(who): Extension<Who>, request: Request) -> Answer {
    #[derive(Deserialize)]
    struct Both {
        old: String,
        new: String,
    }
    let (access, from) = (access(&shared)?, peer(&request));
    let Both { old, new } = small_json(request).await?;
    Ok(begun(&access.renew(who, old, new, from).await?))
}

async fn users(State(shared): State<Shared>) -> Answer {
    let access = access(&shared)?;
    let all = aside(move || access.users().list().map_err(refusal)).await?;
    let row = |user: &g7_store::users::User| {
        json!({
            "name": user.name,
            "role": user.role.word(),
            "created": user.created,
            "sessions": user.sessions,
        })
    };
    Ok(Json(json!({ "users": all.iter().map(row).collect::<Vec<_>>() })).into_response())
}

#[derive(Deserialize)]
#[serde(tag = "do", rename_all = "lowercase")]
enum Deed {
    Add { name: String, role: String, password: String },
    Role { name: String, role: String },
    Password { name: String, password: String },
    Remove { name: String },
    Revoke { name: String },
}

async fn change(State(shared): State<Shared>, Extension(who): Extension<Who>, request: Request) -> Answer {
    let access = access(&shared)?;
    let deed: Deed = small_json(request).await?;
    let role = |word: &str| word.parse::<Role>().map_err(Refusal::bad);
    aside(move || match deed {
        Deed::Add { name, role: word, password } => {
            let role = role(&word)?;
            access.change(&who, "user-add", &json!({ "user": name, "role": word }), |users| {
                users.add(&name, role, &password, utc_millis(), false)
            })
        }
        Deed::Role { name, role: word } => {
            let role = role(&word)?;
            let data = json!({ "user": name, "role": word });
            access.change(&who, "user-role", &data, |users| users.set_role(&name, role))
        }
        Deed::Password { name, password } => {
            let data = json!({ "user": name });
            access.change(&who, "user-password", &data, |users| users.set_password(&name, &password))
        }
        Deed::Remove { name } => {
            access.change(&who, "user-remove", &json!({ "user": name }), |users| users.remove(&name))
        }
        Deed::Revoke { name } => {
            access.change(&who, "user-revoke", &json!({ "user": name }), |users| users.revoke(&name))
        }
    })
    .await?;
    Ok(StatusCode::NO_CONTENT.into_response())
}

#[derive(Deserialize)]
struct Wanted {
    from: Option<u64>,
    until: Option<u64>,
    #[serde(default)]
    level: String,
    #[serde(default)]
    text: String,
    before: Option<u64>,
}

async fn log(State(shared): State<Shared>, Query(wanted): Query<Wanted>) -> Answer {
    let none = || {
        Refusal::new(
            StatusCode::NOT_FOUND,
            say!("there is no log: `log` in [controller] of the io file names one"),
        )
    };
    let path = shared.log.clone().ok_or_else(none)?;
    let facts = shared.audit.facts();
    let levels = wanted.level.split(',').filter(|word| !word.is_empty()).map(str::to_owned).collect();
    let filter =
        Filter { from: wanted.from, until: wanted.until, levels, text: wanted.text, before: wanted.before };
    let rows = aside(move || {
        let read = || Reader::open(&path)?.rows(&filter, PAGE + 1);
        read().map_err(|e| {
            Refusal::new(StatusCode::INTERNAL_SERVER_ERROR, say!("the log cannot be read: {}", raw(e)))
        })
    })
    .await?;
    let more = rows.len() > PAGE;
    let row = |row: &g7_store::log::Row| {
        let entry = &row.entry;
        // Data that another program wrote into the file is shown as a text.
        let data = serde_json::from_str(&entry.data).unwrap_or_else(|_| json!({ "text": entry.data }));
        json!({
            "n": row.n,
            "wall": entry.wall,
            "at": entry.at.map(|at| at as f64 / 1e9),
            "level": entry.level,
            "kind": entry.kind,
            "who": entry.who,
            "from": entry.from,
            "data": data,
        })
    };
    let rows: Vec<Value> = rows.iter().take(PAGE).map(row).collect();
    Ok(Json(json!({ "rows": rows, "more": more, "log": facts })).into_response())
}
