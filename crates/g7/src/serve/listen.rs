//! Accepts connections: a limited number in all and from an address, each with time limits, in plain text or
//! by TLS. Where all places are taken, the connection on which nothing has moved for the longest time makes room: so
//! whoever holds places and does nothing locks nobody out.

use std::net::IpAddr;
use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use hyper::Request;
use hyper::body::Incoming;
use hyper::server::conn::http1;
use hyper::service::{Service as _, service_fn};
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use tokio::io::AsyncWriteExt as _;
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::Notify;
use tokio::time::timeout;
use tokio_rustls::TlsAcceptor;

use super::line::{Line, Moved, Stream};
use super::places::{Place, Places};

/// Greatest number of connections without the WebSockets of clients.
const CONNECTIONS: usize = 512;
/// The same from one address.
const FROM_ONE: usize = 64;
/// Longest time for the head of a request, and for an idle connection.
const HEAD: Duration = Duration::from_secs(15);
/// Longest time for an answer to someone who was too slow.
const LAST: Duration = Duration::from_secs(1);
/// Longest time that an answer may stand still because nobody reads it.
const STALL: Duration = Duration::from_secs(20);
/// A connection on which something has moved within this time makes room for nobody.
const QUIET: Duration = Duration::from_secs(1);
/// Time between two looks for the place of a connection that makes room.
const LOOK: Duration = Duration::from_millis(10);
const FULL: &[u8] = b"HTTP/1.1 429 Too Many Requests\r\ncontent-type: text/plain\r\n\
    content-length: 44\r\nconnection: close\r\nretry-after: 5\r\n\r\ntoo many connections at once: try again soon";
const SLOW: &[u8] = b"HTTP/1.1 408 Request Timeout\r\ncontent-type: text/plain\r\n\
    content-length: 30\r\nconnection: close\r\n\r\nthis took too long to arrive\r\n";
const PLAIN: &[u8] = b"HTTP/1.1 400 Bad Request\r\ncontent-type: text/plain\r\n\
    content-length: 55\r\nconnection: close\r\n\r\nthis server is encrypted: its address begins https://\r\n";

/// The address of the other end, as an extension of each request.
#[derive(Clone, Copy, Debug)]
pub(super) struct Peer(pub(super) IpAddr);

/// How connections are let in.
#[derive(Clone)]
pub(crate) struct Door {
    /// By TLS alone, where there is a certificate.
    pub(super) tls: Option<TlsAcceptor>,
    /// Greatest number of connections from one address.
    pub(super) from_one: usize,
    pub(super) all: usize,
    /// Longest time for the head of a request.
    pub(super) head: Duration,
    /// Longest time that an answer may stand still.
    pub(super) stall: Duration,
    /// Where all places are taken, a connection that was quiet for longer makes room.
    pub(super) quiet: Duration,
}

impl Default for Door {
    fn default() -> Door {
        Door { tls: None, from_one: CONNECTIONS, all: CONNECTIONS, head: HEAD, stall: STALL, quiet: QUIET }
    }
}

impl Door {
    /// For an address that others reach: none of them takes all places.
    pub(super) fn for_others(tls: Option<TlsAcceptor>) -> Door {
        Door { tls, from_one: FROM_ONE, ..Door::default() }
    }
}

/// A connection that may have to make room.
struct Guest {
    of: IpAddr,
    moved: Moved,
    /// Ends it.
    leave: Arc<Notify>,
}

/// The connections that have places.
#[derive(Default)]
struct Guests(Vec<Guest>);

impl Guests {
    /// A new connection.
    fn enter(&mut self, of: IpAddr) -> (Moved, Arc<Notify>) {
        // Those that have ended are held by nobody else.
        self.0.retain(|guest| Arc::strong_count(&guest.leave) > 1);
        let (moved, leave) = (Moved::now(), Arc::new(Notify::new()));
        self.0.push(Guest { of, moved: moved.clone(), leave: Arc::clone(&leave) });
        (moved, leave)
    }

    /// Asks the quietest connection to make room: of an address, or else of all. False if none was quiet for so long.
    fn make_room(&mut self, of: IpAddr, quiet: Duration) -> bool {
        self.0.retain(|guest| Arc::strong_count(&guest.leave) > 1);
        let quiet = |guest: &&(usize, Duration, bool)| guest.1 > quiet;
        let all = self.0.iter().enumerate();
        let all: Vec<_> = all.map(|(at, guest)| (at, guest.moved.since(), guest.of == of)).collect();
        let Some((at, ..)) = all.iter().filter(quiet).max_by_key(|(_, since, own)| (*own, *since)) else {
            return false;
        };
        self.0.swap_remove(*at).leave.notify_one();
        true
    }
}

/// Serves until the program ends.
pub(crate) async fn listen(listener: TcpListener, app: Router, door: Door) {
    let places = Places::new(door.all, door.from_one);
    let mut guests = Guests::default();
    loop {
        let Ok((stream, peer)) = listener.accept().await else {
            // Usually too many files are open; this ends when a client leaves.
            tokio::time::sleep(Duration::from_millis(50)).await;
            continue;
        };
        let of = peer.ip().to_canonical();
        let place = match places.take(of) {
            None if guests.make_room(of, door.quiet) => freed(&places, of).await,
            place => place,
        };
        match place {
            Some(place) => {
                let (moved, leave) = guests.enter(of);
                let (app, door) = (app.clone(), door.clone());
                tokio::spawn(async move {
                    tokio::select! {
                        () = serve(stream, app, door, place, moved) => {}
                        () = leave.notified() => {}
                    }
                });
            }
            // Nothing is read: under TLS this is no answer, and the connection just ends.
            None if door.tls.is_none() => {
                stream.try_write(FULL).ok();
            }
            None => {}
        }
    }
}

/// The place of a connection that was asked to make room.
async fn freed(places: &Places, of: IpAddr) -> Option<Place> {
    let place = async {
        loop {
            if let Some(place) = places.take(of) {
                return place;
            }
            tokio::time::sleep(LOOK).await;
        }
    };
    timeout(LAST, place).await.ok()
}

async fn serve(stream: TcpStream, app: Router, door: Door, place: Place, moved: Moved) {
    stream.set_nodelay(true).ok();
    let Some(stream) = opened(stream, &door).await else { return };
    let mut line = Line::new(stream, moved, door.stall);
    let (app, peer) = (TowerToHyperService::new(app), Peer(place.of()));
    let service = service_fn(move |mut request: Request<Incoming>| {
        request.extensions_mut().insert(peer);
        app.call(request)
    });
    let served = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(door.head)
        .max_buf_size(64 << 10)
        .serve_connection(TokioIo::new(line.clone()), service)
        .with_upgrades();
    // A broken connection is the client's concern.
    if served.await.is_err_and(|e| e.is_timeout()) {
        timeout(LAST, line.write_all(SLOW)).await.ok();
        timeout(LAST, line.shutdown()).await.ok();
    }
    drop(place);
}

/// The connection, behind its handshake.
async fn opened(mut stream: TcpStream, door: &Door) -> Option<Stream> {
    let Some(tls) = &door.tls else { return Some(Stream::Plain(stream)) };
    let mut first = [0];
    let said = timeout(door.head, stream.peek(&mut first)).await;
    match said {
        Ok(Ok(1)) if first == [22] => {
            let stream = timeout(door.head, tls.accept(stream)).await.ok()?.ok()?;
            Some(Stream::Tls(Box::new(stream)))
        }
        // Whoever begins with a letter asks in plain text.
        Ok(Ok(1)) if first[0].is_ascii_uppercase() => {
            timeout(LAST, stream.write_all(PLAIN)).await.ok();
            None
        }
        _ => None,
    }
}
