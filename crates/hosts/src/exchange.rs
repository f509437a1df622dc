//! How workers talk: packets of words from one to another, and phases that all of them end together.
//!
//! [`Exchange`] is what a way of transport has to offer: `wire.rs` has that of timely over TCP,
//! `near.rs` that within one process. [`Phases`] builds on either what the search needs. A phase
//! ends for a worker when it has all packets that the others sent it in that phase. So what is
//! under way at one time is what one phase sends, however fast a worker is: timely itself never makes
//! a sender wait.

/// Why a phase cannot end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lost {
    /// A worker is gone, or its packets are no longer of the kind that was agreed.
    Gone,
    /// So many bytes of a phase that has not begun have come from the worker with this number: more than this
    /// process may keep.
    Ahead(usize, usize),
}

/// Sends and receives packets. Packets of one worker arrive in the order in which it sent them.
pub trait Exchange {
    /// The number of this worker.
    fn me(&self) -> usize;

    /// The number of workers.
    fn peers(&self) -> usize;

    /// Sends a packet that is not empty to another worker.
    fn send(&mut self, to: usize, packet: Vec<u64>);

    /// The next packet that has arrived, with its sender. With `wait` the call may take a moment where
    /// there is none yet; the caller asks again.
    fn receive(&mut self, wait: bool) -> Option<(usize, Vec<u64>)>;

    /// True if a worker sends nothing more: [`Exchange::receive`] still gives its packets that have arrived.
    fn is_gone(&self, peer: usize) -> bool;
}

/// Words of a packet that is sent as it is full.
const FULL: usize = 4096;
/// The first word of a packet with data.
const DATA: u64 = 0;
/// The first word of the packet that ends a phase.
const END: u64 = 1;

/// Packets in phases.
pub(crate) struct Phases<'e> {
    wire: &'e mut dyn Exchange,
    /// For each worker, the packet being filled.
    open: Vec<Vec<u64>>,
    /// For each worker, the words with which it ended the phase in hand.
    ended: Vec<Option<Vec<u64>>>,
    /// Packets of the next phase, from workers that have ended this one.
    early: Vec<(usize, Vec<u64>)>,
    /// Words of them, and as many as they may have.
    kept: usize,
    room: usize,
}

impl<'e> Phases<'e> {
    /// Phases that keep so many bytes of packets that come before their phase.
    pub(crate) fn new(wire: &'e mut dyn Exchange, bytes: usize) -> Phases<'e> {
        let peers = wire.peers();
        let (open, ended) = (vec![vec![DATA]; peers], vec![None; peers]);
        Phases { wire, open, ended, early: Vec::new(), kept: 0, room: bytes / 8 }
    }

    pub(crate) fn me(&self) -> usize {
        self.wire.me()
    }

    pub(crate) fn peers(&self) -> usize {
        self.wire.peers()
    }

    /// Sends words to another worker; words of one call stay together.
    pub(crate) fn send(&mut self, to: usize, parts: &[&[u64]]) {
        let Some(open) = self.open.get_mut(to) else { return };
        parts.iter().for_each(|p| open.extend_from_slice(p));
        if open.len() >= FULL {
            let packet = std::mem::replace(open, vec![DATA]);
            self.wire.send(to, packet);
        }
    }

    /// Hands over what has arrived in this phase.
    pub(crate) fn poll(&mut self, take: &mut dyn FnMut(usize, &[u64])) -> Result<(), Lost> {
        self.take_early(take)?;
        while let Some((from, packet)) = self.wire.receive(false) {
            self.sort(from, packet, take)?;
        }
        Ok(())
    }

    /// Looks again at the packets that came before their phase; those that are still early stay.
    fn take_early(&mut self, take: &mut dyn FnMut(usize, &[u64])) -> Result<(), Lost> {
        self.kept = 0;
        for (from, packet) in std::mem::take(&mut self.early) {
            self.sort(from, packet, take)?;
        }
        Ok(())
    }

    /// Ends the phase: sends what is left with these words, waits for all others to do so, and gives the
    /// words of each worker.
    pub(crate) fn end(
        &mut self,
        words: &[u64],
        take: &mut dyn FnMut(usize, &[u64]),
    ) -> Result<Vec<Vec<u64>>, Lost> {
        let me = self.me();
        for to in (0..self.peers()).filter(|to| *to != me) {
            let packet = self.open.get_mut(to).map(|open| std::mem::replace(open, vec![DATA]));
            if let Some(packet) = packet.filter(|p| p.len() > 1) {
                self.wire.send(to, packet);
            }
            let mut packet = vec![END];
            packet.extend_from_slice(words);
            self.wire.send(to, packet);
        }
        if let Some(own) = self.ended.get_mut(me) {
            *own = Some(words.to_vec());
        }
        self.take_early(take)?;
        while self.ended.iter().any(Option::is_none) {
            // Asked first: what such a worker sent before it went is here by now.
            let gone = self.ended.iter().enumerate().any(|(p, e)| e.is_none() && self.wire.is_gone(p));
            match self.wire.receive(true) {
                Some((from, packet)) => self.sort(from, packet, take)?,
                None if gone => return Err(Lost::Gone),
                None => {}
            }
        }
        let words = self.ended.iter_mut().map(|w| w.take().unwrap_or_default()).collect();
        Ok(words)
    }

    /// The same with words alone.
    pub(crate) fn share(&mut self, words: &[u64]) -> Result<Vec<Vec<u64>>, Lost> {
        self.end(words, &mut |_, _| ())
    }

    fn sort(
        &mut self,
        from: usize,
        packet: Vec<u64>,
        take: &mut dyn FnMut(usize, &[u64]),
    ) -> Result<(), Lost> {
        let ended = self.ended.get_mut(from).ok_or(Lost::Gone)?;
        if ended.is_some() {
            self.kept += packet.len();
            if self.kept > self.room {
                return Err(Lost::Ahead(self.kept * 8, from));
            }
            self.early.push((from, packet));
            return Ok(());
        }
        match packet.split_first() {
            Some((&DATA, words)) => take(from, words),
            Some((&END, words)) => *ended = Some(words.to_vec()),
            _ => return Err(Lost::Gone),
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::{DATA, END, Exchange, Lost, Phases};
    use crate::Error;
    use crate::near::Near;

    /// The first of three workers waits for the third, and the second is a phase ahead.
    fn ahead(packets: usize, room: usize) -> Result<Vec<Vec<u64>>, Lost> {
        let mut ends = Near::net(3);
        let (mut third, mut second) = (ends.pop().expect("three"), ends.pop().expect("three"));
        let mut first = ends.pop().expect("three");
        second.send(0, vec![END, 7]);
        (0..packets).for_each(|_| second.send(0, vec![DATA; 100]));
        third.send(0, vec![END, 8]);
        let (mut phases, mut early) = (Phases::new(&mut first, room), 0);
        let words = phases.share(&[6])?;
        second.send(0, vec![END]);
        third.send(0, vec![END]);
        phases.end(&[], &mut |from, words| early += usize::from(from == 1) * words.len())?;
        assert_eq!(early, packets * 99, "they belong to the next phase");
        Ok(words)
    }

    #[test]
    fn packets_of_the_next_phase_have_a_bound() {
        assert_eq!(ahead(10, 8000), Ok(vec![vec![6], vec![7], vec![8]]));
        let lost = ahead(11, 8000).expect_err("it is too much");
        assert_eq!(lost, Lost::Ahead(8800, 1));
        let Error::Usage(told) = Error::from(lost) else { panic!("{lost:?}") };
        assert!(told.contains("process 1") && told.contains("--memory"), "{told}");
    }
}
