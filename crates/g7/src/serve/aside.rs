//! Work that waits for the disk, on a thread of its own.

use axum::http::StatusCode;
use g7_model::say;

use super::refusal::Refusal;

/// Runs work that waits for a disk on another thread, so that other requests go on.
pub(super) async fn aside<T: Send + 'static>(
    work: impl FnOnce() -> Result<T, Refusal> + Send + 'static,
) -> Result<T, Refusal> {
    let done = tokio::task::spawn_blocking(work).await;
    done.unwrap_or_else(|_| {
        Err(Refusal::new(StatusCode::INTERNAL_SERVER_ERROR, say!("this failed; nothing was changed")))
    })
}
