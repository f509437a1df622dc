//! Accepts connections: a limited number, each with time limits.

use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};

/// Greatest number of connections without the WebSockets of clients.
const CONNECTIONS: usize = 512;
/// Longest time for the head of a request, and for an idle connection.
const HEAD: Duration = Duration::from_secs(15);
const FULL: &[u8] = b"HTTP/1.1 503 Service Unavailable\r\ncontent-type: text/plain\r\n\
    content-length: 44\r\nconnection: close\r\n\r\ntoo many connections at once: try again soon";

/// Serves until the program ends.
pub(crate) async fn listen(listener: TcpListener, app: Router) {
    let places = Arc::new(Semaphore::new(CONNECTIONS));
    loop {
        let Ok((stream, _)) = listener.accept().await else {
            // Usually too many files are open; this ends when a client leaves.
            tokio::time::sleep(Duration::from_millis(50)).await;
            continue;
        };
        match Arc::clone(&places).try_acquire_owned() {
            Ok(place) => {
                tokio::spawn(serve(stream, app.clone(), place));
            }
            Err(_) => {
                stream.try_write(FULL).ok();
            }
        }
    }
}

async fn serve(stream: TcpStream, app: Router, place: OwnedSemaphorePermit) {
    stream.set_nodelay(true).ok();
    let served = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(HEAD)
        .max_buf_size(64 << 10)
        .serve_connection(TokioIo::new(stream), TowerToHyperService::new(app))
        .with_upgrades();
    // A broken connection is the client's concern.
    served.await.ok();
    drop(place);
}
