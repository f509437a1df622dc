//! One WebSocket for each client: calls come in, answers, frames and notices go out.
//!
//! A client that never reads, never answers a ping or sends nonsense takes a bounded amount of
//! memory and is disconnected. One call of a client is processed at a time; the others wait in the
//! network.

use std::sync::Arc;

use axum::extract::State;
use axum::extract::ws::{Message, WebSocket, WebSocketUpgrade};
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use serde::Deserialize;
use serde_json::value::RawValue;
use tokio::sync::{OwnedSemaphorePermit, oneshot};
use tokio::time::{Instant, MissedTickBehavior, interval, timeout};

use super::api;
use super::outbox::{Next, Outbox};
use super::refusal::Refusal;
use super::runs::letter;
use super::shared::Shared;
use crate::operator::{NAME, Order, Wish};

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

/// Opens the WebSocket of a client if there is room for it.
pub(super) async fn live(State(shared): State<Shared>, upgrade: WebSocketUpgrade) -> Response {
    let Ok(seat) = Arc::clone(&shared.seats).try_acquire_owned() else {
        let text = format!("all {} places are taken: close a page somewhere", shared.limits.clients);
        return Refusal::new(StatusCode::SERVICE_UNAVAILABLE, text).into_response();
    };
    let most = shared.limits.message;
    upgrade
        .max_message_size(most)
        .max_frame_size(most)
        // The defaults would take a quarter of a megabyte for each client.
        .read_buffer_size(8 << 10)
        .write_buffer_size(0)
        .on_upgrade(move |socket| attend(socket, shared, seat))
}

/// Serves a client until it leaves or is disconnected.
async fn attend(mut socket: WebSocket, shared: Shared, seat: OwnedSemaphorePermit) {
    let outbox = Arc::new(Outbox::default());
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
    // Runs hold the client by a weak reference only, so this frees all waiting messages.
    drop(outbox);
    drop(seat);
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
        what if what.starts_with("operator_") => operate(shared, outbox, id, call).await,
        what if what.starts_with("run_") => runs.call(&head.run, outbox, id, call.get(), text).await,
        _ => Err("the server answers for runs; this is answered in the page".to_owned()),
    }
}

/// Passes a wish on to the attendant of the controller, and waits until it is answered.
async fn operate(shared: &Shared, outbox: &Arc<Outbox>, id: u64, call: &RawValue) -> Result<(), String> {
    let station =
        shared.station.as_ref().ok_or("this server has no controller: `g7 serve --online` has one")?;
    let wish: Wish =
        serde_json::from_str(call.get()).map_err(|e| format!("this message means nothing: {e}"))?;
    let (done, wait) = oneshot::channel();
    let order = Order { by: Arc::clone(outbox), call: Some((id, wish, done)) };
    station.try_send(order).map_err(|_| "the controller is busy: try again")?;
    wait.await.map_err(|_| "the controller has ended".to_owned())
}
