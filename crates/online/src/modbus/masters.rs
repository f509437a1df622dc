//! The connections of masters: each is read request by request, and none can take the place of another.
//!
//! A new master always gets in: where there are too many connections, the one goes that was served longest
//! ago, and before it those that were never served. A master that does not read its answers is given up.
//! Without descriptors the listener waits for some; who is connected is served all the while.

use std::collections::BTreeMap;
use std::net::SocketAddr;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use g7_host::{Clock as _, WallClock};
use g7_model::Nanos;
use tokio::io::{AsyncReadExt as _, AsyncWriteExt as _};
use tokio::net::{TcpListener, TcpStream};
use tokio::runtime::{Builder, Runtime};
use tokio::task::AbortHandle;
use tokio::time::{sleep, timeout};

/// Connections at a time.
const MOST: usize = 64;
/// An answer that cannot be sent within this time is not wanted.
const PATIENCE: Duration = Duration::from_secs(1);
/// The pause after a connection that could not be accepted: descriptors have to become free.
const PAUSE: Duration = Duration::from_millis(50);
/// Bytes of the header: transaction, protocol, length, unit (Modbus messaging on TCP/IP 1.0b, 3.1.3).
const HEAD: usize = 7;

/// Answers a request: its function and what follows. The answer begins with the function; an exception
/// is its number.
pub(super) type Answer = dyn Fn(u8, &[u8]) -> Result<Vec<u8>, u8> + Send + Sync;

/// A connection that is open.
struct Open {
    /// The instant of the last request, or of its begin.
    last: Nanos,
    served: bool,
    task: Option<AbortHandle>,
}

#[derive(Default)]
struct Connections {
    open: Mutex<(BTreeMap<u64, Open>, WallClock)>,
}

impl Connections {
    fn lock(&self) -> MutexGuard<'_, (BTreeMap<u64, Open>, WallClock)> {
        // An entry is set whole.
        self.open.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Notes a connection; where there are too many, another one ends for it.
    fn begin(&self, number: u64) {
        let mut open = self.lock();
        let last = open.1.now();
        while open.0.len() >= MOST {
            let oldest = open.0.iter().min_by_key(|(_, o)| (o.served, o.last)).map(|(number, _)| *number);
            let Some(gone) = oldest.and_then(|number| open.0.remove(&number)) else { break };
            gone.task.inspect(AbortHandle::abort);
        }
        open.0.insert(number, Open { last, served: false, task: None });
    }

    fn change(&self, number: u64, change: impl FnOnce(&mut Open, Nanos)) {
        let mut open = self.lock();
        let now = open.1.now();
        if let Some(connection) = open.0.get_mut(&number) {
            change(connection, now);
        }
    }
}

/// Masters that are listened for. Dropping it ends all connections.
pub(super) struct Masters {
    runtime: Option<Runtime>,
}

impl Masters {
    /// Listens at an address. A connection without a request for the time `idle` is ended.
    ///
    /// # Errors
    ///
    /// The address cannot be listened at.
    pub(super) fn listen(
        address: SocketAddr,
        idle: Duration,
        answer: Arc<Answer>,
    ) -> std::io::Result<Masters> {
        let runtime = Builder::new_multi_thread()
            .worker_threads(1)
            .thread_name("modbus server")
            .enable_all()
            .build()?;
        let listener = runtime.block_on(TcpListener::bind(address))?;
        runtime.spawn(accept(listener, idle, answer));
        Ok(Masters { runtime: Some(runtime) })
    }
}

impl Drop for Masters {
    fn drop(&mut self) {
        if let Some(runtime) = self.runtime.take() {
            runtime.shutdown_background();
        }
    }
}

async fn accept(listener: TcpListener, idle: Duration, answer: Arc<Answer>) {
    let connections = Arc::<Connections>::default();
    let mut number = 0;
    loop {
        let Ok((stream, _)) = listener.accept().await else {
            sleep(PAUSE).await;
            continue;
        };
        // Small answers are not held back; a system that cannot say so holds them.
        stream.set_nodelay(true).ok();
        number += 1;
        connections.begin(number);
        let (own, answer) = (Arc::clone(&connections), Arc::clone(&answer));
        let task = tokio::spawn(async move {
            attend(stream, number, idle, &own, &*answer).await;
            own.lock().0.remove(&number);
        });
        connections.change(number, |open, _| open.task = Some(task.abort_handle()));
    }
}

/// Serves a master until it is silent for too long, says what is no request, or does not listen.
async fn attend(
    mut stream: TcpStream,
    number: u64,
    idle: Duration,
    connections: &Connections,
    answer: &Answer,
) {
    while let Ok(Some((mut frame, function, data))) = timeout(idle, request(&mut stream)).await {
        let body = answer(function, &data).unwrap_or_else(|exception| vec![function | 0x80, exception]);
        // Behind the length there is the unit as well; an answer has at most 253 bytes.
        let length = (body.len() + 1) as u16;
        frame[4..6].copy_from_slice(&length.to_be_bytes());
        let whole = [&frame[..], &body].concat();
        connections.change(number, |open, now| (open.last, open.served) = (now, true));
        if !matches!(timeout(PATIENCE, stream.write_all(&whole)).await, Ok(Ok(()))) {
            return;
        }
    }
}

/// The next request: its header, its function and what follows; `None` where there is none.
async fn request(stream: &mut TcpStream) -> Option<([u8; HEAD], u8, Vec<u8>)> {
    let mut head = [0; HEAD];
    stream.read_exact(&mut head).await.ok()?;
    let [_, _, p, q, high, low, _] = head;
    let length = u16::from_be_bytes([high, low]);
    // Unit and function at least, and at most 253 bytes from the function on.
    if (p, q) != (0, 0) || !(2..=254).contains(&length) {
        return None;
    }
    let mut body = vec![0; usize::from(length) - 1];
    stream.read_exact(&mut body).await.ok()?;
    let (function, data) = body.split_first()?;
    Some((head, *function, data.to_vec()))
}
