//! One WebSocket for each client: calls come in, answers, frames and notices go out.
//!
//! A client that never reads, never answers a ping or sends nonsense takes a bounded amount of
//! memory and is disconnected. One call of a client is processed at a time; the others wait in the
//! network.

use std::sync::Arc;

use axum::Extension;
use axum::extract::ws::{CloseFrame, Message, WebSocket, WebSocketUpgrade};
use axum::extract::{Query, State};
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use g7_model::{Language, say};
use g7_store::users::Role;
use serde::Deserialize;
use serde_json::value::RawValue;
use tokio::sync::{oneshot, watch};
use tokio::time::{Instant, MissedTickBehavior, interval, timeout};

use super::api;
use super::aside::aside;
use super::drafts::routes;
use super::listen::Peer;
use super::outbox::{Next, Outbox};
use super::places::Place;
use super::refusal::Refusal;
use super::runs::letter;
use super::shared::{Limits, Shared};
use super::together::talk;
use crate::operator::{NAME, Order, Wish};
use crate::who::Who;

/// The code with which a socket is closed whose session is over.
const OVER: u16 = 4401;

/// The parts of a message that the server needs to know.
#[derive(Deserialize)]
struct Incoming<'a> {
    id: u64,
    #[serde(borrow)]
    call: &'a RawValue,
}

/// The parts of a call that the server needs to know: its kind and its run.
#[derive(Deserialize)]
struct Head {
    r#do: String,
    #[serde(default)]
    run: String,
    file: Option<String>,
    text: Option<String>,
    speed: Option<f64>,
}

/// The name that a client has for its window.
#[derive(Deserialize)]
pub(super) struct Asks {
    #[serde(default)]
    window: String,
    /// The language of the page.
    #[serde(default)]
    language: String,
}

/// Opens the WebSocket of a client if there is room for it.
pub(super) async fn live(
    State(shared): State<Shared>,
    Query(asks): Query<Asks>,
    Extension(who): Extension<Who>,
    Extension(Peer(from)): Extension<Peer>,
    upgrade: WebSocketUpgrade,
) -> Response {
    let Some(seat) = shared.seats.take(from) else {
        let Limits { clients, from_one, .. } = shared.limits;
        let text =
            say!("all {clients} places are taken, or the {from_one} of this address: close a page somewhere");
        return Refusal::new(StatusCode::TOO_MANY_REQUESTS, text).into_response();
    };
    // A client without a name has no unsaved work.
    let owner = routes::owner(&who, &asks.window).ok().map(|owner| shared.drafts.owners.enter(owner));
    let language = Language::of(&asks.language).unwrap_or_default();
    let most = shared.limits.message;
    upgrade
        .max_message_size(most)
        .max_frame_size(most)
        // The defaults would take a quarter of a megabyte for each client.
        .read_buffer_size(8 << 10)
        .write_buffer_size(0)
        .on_upgrade(move |socket| async move {
            attend(socket, shared, Outbox::of(who, language), seat).await;
            drop(owner);
        })
}

/// Serves a client until it leaves or is disconnected.
async fn attend(mut socket: WebSocket, shared: Shared, outbox: Outbox, seat: Place) {
    let outbox = Arc::new(outbox);
    let mut sessions = shared.access.as_ref().map(|access| access.hear());
    shared.clients.enter(&outbox);
    let limits = shared.limits;
    let mut ping = interval(limits.ping);
    ping.set_missed_tick_behavior(MissedTickBehavior::Delay);
    let mut heard = Instant::now();
    loop {
        let out = tokio::select! {
            // A client that does not read its answers is not read from.
            said = socket.recv(), if !outbox.owes() => match said {
                Some(Ok(Message::Text(text))) => {
                    heard = Instant::now();
                    take(&shared, &outbox, &text).await;
                    continue;
                }
                Some(Ok(Message::Ping(_) | Message::Pong(_))) => {
                    heard = Instant::now();
                    continue;
                }
                Some(Ok(Message::Binary(_))) => {
                    outbox.put(letter(&serde_json::json!({ "no": "messages are texts" })));
                    continue;
                }
                Some(Ok(Message::Close(_)) | Err(_)) | None => break,
            },
            next = outbox.next() => match next {
                Next::Text(text) => Message::Text(text),
                Next::Behind(run) => {
                    match &shared.station {
                        // If it is too busy, the next dropped frame asks again.
                        Some(station) if *run == *NAME => {
                            station.try_send(Order { by: Arc::clone(&outbox), call: None }).ok();
                        }
                        Some(_) | None => shared.runs.catch_up(&run, &outbox),
                    }
                    continue;
                }
                Next::Closed => break,
            },
            () = changed(&mut sessions) => {
                if now(&shared, &outbox, false).is_none() {
                    let close = CloseFrame { code: OVER, reason: "the session is over".into() };
                    timeout(limits.send, socket.send(Message::Close(Some(close)))).await.ok();
                    break;
                }
                continue;
            }
            _ = ping.tick() => {
                if heard.elapsed() > limits.silence {
                    break;
                }
                Message::Ping(Default::default())
            }
        };
        if !matches!(timeout(limits.send, socket.send(out)).await, Ok(Ok(()))) {
            break;
        }
    }
    talk::gone(&shared, &outbox);
    // Runs hold the client by a weak reference only, so this frees all waiting messages.
    drop(outbox);
    drop(seat);
}

/// Waits until sessions may have ended; for ever where there are none.
async fn changed(sessions: &mut Option<watch::Receiver<u64>>) {
    if let Some(sessions) = sessions
        && sessions.changed().await.is_ok()
    {
        return;
    }
    std::future::pending().await
}

/// Who a client is now; `None` once its session is over. A message counts as use, a page that is open does not.
fn now(shared: &Shared, outbox: &Outbox, used: bool) -> Option<Who> {
    let who = outbox.who();
    match (&shared.access, &who.session) {
        (Some(access), Some(session)) => access.again(session, who.from.parse().ok()?, used),
        // A guest has no session; it may look as long as the page is open.
        (Some(_), None) => who.guest.then(|| who.clone()),
        (None, _) => Some(who.clone()),
    }
}

/// Processes one message of a client.
async fn take(shared: &Shared, outbox: &Arc<Outbox>, text: &str) {
    let Ok(Incoming { id, call }) = serde_json::from_str(text) else {
        outbox.put(letter(&serde_json::json!({ "no": "this message means nothing" })));
        return;
    };
    if let Err(no) = call_of(shared, outbox, id, call).await {
        outbox.put(letter(&serde_json::json!({ "id": id, "answer": { "no": no } })));
    }
}

/// Passes a call to its receiver, which puts the answer into the outbox; or says why this is
/// impossible.
async fn call_of(shared: &Shared, outbox: &Arc<Outbox>, id: u64, call: &RawValue) -> Result<(), String> {
    let head: Head =
        serde_json::from_str(call.get()).map_err(|e| format!("this message means nothing: {e}"))?;
    let who = now(shared, outbox, true).ok_or("the session is over: log in again")?;
    if head.r#do.starts_with("together_") {
        return talk::call(shared, &who, outbox, id, call.get())
            .map_err(|no| no.in_language(outbox.language()));
    }
    if !matches!(head.r#do.as_str(), "runs" | "watch" | "unwatch") && !head.r#do.starts_with("operator_") {
        // Runs of a simulation touch no machine; they are shared with others all the same.
        who.needs(Role::Operator).map_err(|why| why.to_string())?;
    }
    let runs = &shared.runs;
    let text = match (head.r#do.as_str(), &head.file, head.text) {
        ("run_start" | "run_swap", Some(_), Some(text)) => Some(text),
        ("run_start" | "run_swap", Some(file), None) => Some(api::chart(shared, file).await?),
        ("run_start" | "run_swap", None, _) => return Err("this names no file".to_owned()),
        _ => None,
    };
    match head.r#do.as_str() {
        "runs" => {
            outbox.put(letter(&serde_json::json!({ "id": id, "answer": { "ok": { "runs": runs.list() } } })));
            Ok(())
        }
        "run_start" => runs.start(&head.run, outbox, id, call.get(), text).await,
        "watch" => runs.watch(&head.run, outbox, id).await,
        "unwatch" => runs.unwatch(&head.run, outbox, id).await,
        "pace" => runs.pace(&head.run, outbox, id, head.speed.unwrap_or(0.0)).await,
        what if what.starts_with("operator_") => operate(shared, &who, outbox, id, call).await,
        what if what.starts_with("run_") => runs.call(&head.run, outbox, id, call.get(), text).await,
        _ => Err("the server answers for runs; this is answered in the page".to_owned()),
    }
}

/// Passes a wish on to the attendant of the controller, and waits until it is answered.
async fn operate(
    shared: &Shared,
    who: &Who,
    outbox: &Arc<Outbox>,
    id: u64,
    call: &RawValue,
) -> Result<(), String> {
    let station =
        shared.station.as_ref().ok_or("this server has no controller: `g7 serve --online` has one")?;
    let wish: Wish =
        serde_json::from_str(call.get()).map_err(|e| format!("this message means nothing: {e}"))?;
    if let Err(why) = who.needs(wish.role()) {
        shared.audit.event("warning", "refused", None, &wish.refused(who));
        return Err(why.to_string());
    }
    if let Some((kind, data)) = wish.deed() {
        if wish.waits_for_log() {
            let (audit, who) = (shared.audit.clone(), who.clone());
            let row = aside(move || Ok(audit.must(&who, &kind, &data)));
            row.await.map_err(|refusal| refusal.text.to_string())??;
        } else {
            shared.audit.note(who, &kind, None, &data);
        }
    }
    let (done, wait) = oneshot::channel();
    let order = Order { by: Arc::clone(outbox), call: Some((id, wish, done)) };
    station.try_send(order).map_err(|_| "the controller is busy: try again")?;
    wait.await.map_err(|_| "the controller has ended".to_owned())
}
