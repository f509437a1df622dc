//! Packets between processes, by the communication layer of timely over TCP.

use std::net::{Shutdown, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use timely_bytes::arc::Bytes;
use timely_communication::allocator::ProcessBuilder;
use timely_communication::allocator::zero_copy::initialize::{
    CommsGuard, initialize_networking_from_sockets,
};
use timely_communication::{Allocator, Bytesable, Hooks, Pull, Push};

use crate::calm::Calm;
use crate::exchange::Exchange;

/// A packet with its sender in the first word, and [`WHOLE`] in the last.
struct Packet(Vec<u64>);

/// The last word of each packet. One that a broken connection cut ends with a zero.
const WHOLE: u64 = 0x6737_2065_6E64_2E01;

impl Bytesable for Packet {
    fn from_bytes(bytes: Bytes) -> Packet {
        let word = |c: &[u8]| c.try_into().map_or(0, u64::from_le_bytes);
        Packet(bytes.chunks_exact(8).map(word).collect())
    }

    fn length_in_bytes(&self) -> usize {
        self.0.len() * 8
    }

    fn into_bytes<W: std::io::Write>(&self, writer: &mut W) {
        for word in &self.0 {
            // The buffer has the length that was asked for.
            let _all = writer.write_all(&word.to_le_bytes());
        }
    }
}

/// A process among those that are connected with it.
pub(crate) struct Wire {
    me: usize,
    senders: Vec<Box<dyn Push<Packet>>>,
    receiver: Box<dyn Pull<Packet>>,
    allocator: Allocator,
    streams: Vec<TcpStream>,
    /// For each process: its connection has ended.
    gone: Vec<Arc<AtomicBool>>,
    // The last field: its threads end when the channels above are closed.
    _threads: CommsGuard,
}

/// A moment for which a call waits, before the caller looks round.
const MOMENT: Duration = Duration::from_millis(50);
/// A time without a byte after which the others count as gone.
const SILENCE: Duration = Duration::from_secs(120);

impl Wire {
    /// Takes the connections to the other processes, in their order, with none at the place of this one.
    ///
    /// # Errors
    ///
    /// The system has no thread or no handle left.
    pub(crate) fn new(me: usize, sockets: Vec<Option<TcpStream>>) -> std::io::Result<Wire> {
        let gone: Vec<_> = sockets.iter().map(|_| Arc::new(AtomicBool::new(false))).collect();
        let mut streams = Vec::new();
        for socket in sockets.iter().flatten() {
            socket.set_read_timeout(Some(SILENCE))?;
            streams.push(socket.try_clone()?);
        }
        let pairs = sockets.into_iter().zip(&gone);
        let sockets: Vec<_> = pairs.map(|(s, gone)| s.map(|s| Calm::new(me, s, gone.clone()))).collect();
        let hooks = Hooks::default();
        let own = ProcessBuilder::new_typed_vector(1, hooks.refill.clone(), None);
        let (builders, threads) = initialize_networking_from_sockets(own, sockets, me, 1, hooks)?;
        let builder = builders.into_iter().next().ok_or_else(|| std::io::Error::other("no worker"))?;
        let mut allocator = Allocator::Tcp(builder.build());
        let (senders, receiver) = allocator.allocate(0);
        Ok(Wire { me, senders, receiver, allocator, streams, gone, _threads: threads })
    }
}

impl Wire {
    /// Ends all connections, so that every other process sees at once that this phase will not end, and no
    /// thread here waits for them.
    pub(crate) fn cut(self) {
        for stream in &self.streams {
            // One that is broken need not be cut.
            let _broken = stream.shutdown(Shutdown::Both);
        }
    }
}

impl Exchange for Wire {
    fn me(&self) -> usize {
        self.me
    }

    fn peers(&self) -> usize {
        self.senders.len()
    }

    fn send(&mut self, to: usize, mut packet: Vec<u64>) {
        if let Some(sender) = self.senders.get_mut(to) {
            packet.insert(0, self.me as u64);
            packet.push(WHOLE);
            sender.send(Packet(packet));
        }
    }

    fn receive(&mut self, wait: bool) -> Option<(usize, Vec<u64>)> {
        self.allocator.release();
        for wait in [false, wait] {
            if wait {
                self.allocator.await_events(Some(MOMENT));
            }
            self.allocator.receive();
            self.allocator.events().borrow_mut().clear();
            while let Some(Packet(mut packet)) = self.receiver.recv() {
                if packet.pop() == Some(WHOLE) && !packet.is_empty() {
                    let from = packet.remove(0);
                    return Some((usize::try_from(from).unwrap_or(usize::MAX), packet));
                }
            }
        }
        None
    }

    fn is_gone(&self, peer: usize) -> bool {
        peer != self.me && self.gone.get(peer).is_none_or(|g| g.load(Ordering::SeqCst))
    }
}
