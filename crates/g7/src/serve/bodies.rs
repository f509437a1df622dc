//! The bodies of requests: of limited size, in limited time, and all of them together in limited memory.
//!
//! A body takes the room of what has arrived of it, and nothing for what is still under way. So whoever sends slowly keeps
//! nobody waiting.

use std::future::poll_fn;
use std::pin::Pin;
use std::time::Duration;

use axum::body::{Body, HttpBody as _};
use axum::extract::Request;
use axum::http::{StatusCode, header};
use g7_model::say;
use serde::Deserialize;
use tokio::sync::Semaphore;
use tokio::time::timeout;

use super::folder::LARGEST;
use super::refusal::Refusal;
use crate::failure::raw;

/// Greatest size of a small body, and longest time for it.
const SMALL: usize = 8 << 10;
const SMALL_SLOWEST: Duration = Duration::from_secs(5);

/// Longest time that a body may take, and that it may stand still.
const SLOWEST: Duration = Duration::from_secs(30);
const STILL: Duration = Duration::from_secs(5);
/// The unit in which room is taken, in bytes.
const UNIT: usize = 4 << 10;
/// Room for eight of the largest bodies.
static ROOM: Semaphore = Semaphore::const_new(8 * LARGEST / UNIT);

/// Reads a body as JSON.
pub(super) async fn json_body<T: for<'a> Deserialize<'a>>(request: Request) -> Result<T, Refusal> {
    let bytes = body(request).await?;
    serde_json::from_slice(&bytes).map_err(|e| Refusal::bad(say!("this request means nothing: {}", raw(e))))
}

/// Reads a small body, also of someone who is not known yet.
pub(super) async fn small_json<T: for<'a> Deserialize<'a>>(request: Request) -> Result<T, Refusal> {
    let bytes = axum::body::to_bytes(Body::new(request.into_body()), SMALL);
    let bytes = match timeout(SMALL_SLOWEST, bytes).await {
        Ok(Ok(bytes)) => bytes,
        Ok(Err(_)) => return Err(Refusal::new(StatusCode::PAYLOAD_TOO_LARGE, say!("this is too large"))),
        Err(_) => {
            return Err(Refusal::new(StatusCode::REQUEST_TIMEOUT, say!("this took too long to arrive")));
        }
    };
    serde_json::from_slice(&bytes).map_err(|_| Refusal::bad(say!("this request means nothing")))
}

/// Reads a body of limited size in a limited time.
pub(super) async fn body(request: Request) -> Result<Vec<u8>, Refusal> {
    let length =
        request.headers().get(header::CONTENT_LENGTH).and_then(|v| v.to_str().ok()?.parse::<u64>().ok());
    if length.is_some_and(|l| l > LARGEST as u64) {
        return Err(too_large());
    }
    timeout(SLOWEST, arrived(request.into_body())).await.unwrap_or_else(|_| Err(late()))
}

/// The bytes of a body; its room is free again when they are whole.
async fn arrived(mut body: Body) -> Result<Vec<u8>, Refusal> {
    let mut bytes = Vec::new();
    let mut room = None;
    loop {
        let frame = poll_fn(|cx| Pin::new(&mut body).poll_frame(cx));
        let frame = match timeout(STILL, frame).await {
            Ok(Some(Ok(frame))) => frame,
            Ok(None) => return Ok(bytes),
            Ok(Some(Err(_))) | Err(_) => return Err(late()),
        };
        let Ok(data) = frame.into_data() else { continue };
        if bytes.len() + data.len() > LARGEST {
            return Err(too_large());
        }
        let more = (bytes.len() + data.len()).div_ceil(UNIT) - bytes.len().div_ceil(UNIT);
        let more = u32::try_from(more).map_err(|_| too_large())?;
        let more = timeout(STILL, ROOM.acquire_many(more)).await.map_err(|_| late())?.map_err(|_| late())?;
        match &mut room {
            None => room = Some(more),
            Some(room) => tokio::sync::SemaphorePermit::merge(room, more),
        }
        bytes.extend_from_slice(&data);
    }
}

fn too_large() -> Refusal {
    let text = say!("this is larger than {} MB: nothing was written", LARGEST >> 20);
    Refusal::new(StatusCode::PAYLOAD_TOO_LARGE, text)
}

fn late() -> Refusal {
    Refusal::new(StatusCode::REQUEST_TIMEOUT, say!("this took too long to arrive: nothing was written"))
}
