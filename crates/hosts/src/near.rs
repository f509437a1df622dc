//! Workers as threads of one process, for tests and for a worker alone.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::Duration;

use crate::exchange::Exchange;

/// One end of a net of channels.
pub struct Near {
    me: usize,
    to: Vec<Sender<(usize, Vec<u64>)>>,
    from: Receiver<(usize, Vec<u64>)>,
    gone: Arc<[AtomicBool]>,
}

impl Near {
    /// The ends of a net of so many workers.
    pub fn net(peers: usize) -> Vec<Near> {
        let (to, from): (Vec<_>, Vec<_>) = (0..peers).map(|_| channel()).unzip();
        let gone: Arc<[AtomicBool]> = to.iter().map(|_| AtomicBool::new(false)).collect();
        let end = |(me, from)| Near { me, to: to.clone(), from, gone: gone.clone() };
        from.into_iter().enumerate().map(end).collect()
    }
}

impl Drop for Near {
    fn drop(&mut self) {
        self.gone.get(self.me).into_iter().for_each(|g| g.store(true, Ordering::SeqCst));
    }
}

/// A moment for which a call waits, before the caller looks round.
const MOMENT: Duration = Duration::from_millis(50);

impl Exchange for Near {
    fn me(&self) -> usize {
        self.me
    }

    fn peers(&self) -> usize {
        self.to.len()
    }

    fn send(&mut self, to: usize, packet: Vec<u64>) {
        if let Some(to) = self.to.get(to) {
            // A worker that is gone shows when its packets do not come.
            let _gone = to.send((self.me, packet));
        }
    }

    fn receive(&mut self, wait: bool) -> Option<(usize, Vec<u64>)> {
        if wait { self.from.recv_timeout(MOMENT).ok() } else { self.from.try_recv().ok() }
    }

    fn is_gone(&self, peer: usize) -> bool {
        self.gone.get(peer).is_none_or(|g| g.load(Ordering::SeqCst))
    }
}
