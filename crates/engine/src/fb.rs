//! The standard function blocks (IEC 61131-3:2003, 2.5.2.3). An instance is a run of
//! words: the members in the order of the call, then the memory.

use crate::bits::word;
use crate::fault::FaultKind;
use crate::layout::head;
use crate::memory::{read, write};
use crate::ops::{Addr, Block};
use crate::program::Program;
use crate::state::State;

/// The words of one instance.
struct Words<'a> {
    p: &'a Program,
    s: &'a mut State,
    base: u32,
}

impl Words<'_> {
    fn get(&self, i: u32) -> u64 {
        read(self.s, Addr(self.base + i))
    }

    fn set(&mut self, i: u32, v: u64) {
        write(self.p, self.s, Addr(self.base + i), v);
    }

    /// True if input `i` has risen since the last call; memory `m` keeps it.
    fn rose(&mut self, i: u32, m: u32) -> bool {
        let (now, before) = (self.get(i), self.get(m));
        self.set(m, now);
        now != 0 && before == 0
    }
}

pub(crate) fn call(p: &Program, s: &mut State, block: Block, base: Addr) -> Result<(), FaultKind> {
    let now = word(&s.image, head::NOW) as i64;
    let mut w = Words { p, s, base: base.0 };
    match block {
        Block::Ctu => {
            let up = w.rose(0, 5);
            let (mut cv, pv) = (w.get(4) as i64, w.get(2) as i64);
            if w.get(1) != 0 {
                cv = 0;
            } else if up && cv < i64::from(i16::MAX) {
                cv += 1;
            }
            w.set(4, cv as u64);
            w.set(3, u64::from(cv >= pv));
        }
        Block::Ctd => {
            let down = w.rose(0, 5);
            let (mut cv, pv) = (w.get(4) as i64, w.get(2) as i64);
            if w.get(1) != 0 {
                cv = pv;
            } else if down && cv > i64::from(i16::MIN) {
                cv -= 1;
            }
            w.set(4, cv as u64);
            w.set(3, u64::from(cv <= 0));
        }
        Block::Ctud => {
            let (up, down) = (w.rose(0, 8), w.rose(1, 9));
            let (mut cv, pv) = (w.get(7) as i64, w.get(4) as i64);
            if w.get(2) != 0 {
                cv = 0;
            } else if w.get(3) != 0 {
                cv = pv;
            } else if up != down {
                if up && cv < i64::from(i16::MAX) {
                    cv += 1;
                } else if down && cv > i64::from(i16::MIN) {
                    cv -= 1;
                }
            }
            w.set(7, cv as u64);
            w.set(5, u64::from(cv >= pv));
            w.set(6, u64::from(cv <= 0));
        }
        Block::Ton | Block::Tof | Block::Tp => timer(&mut w, block, now),
        Block::RTrig => {
            let q = w.rose(0, 2);
            w.set(1, u64::from(q));
        }
        Block::FTrig => {
            // The memory holds NOT CLK and starts FALSE, as in the body that the standard
            // gives: a first call with CLK false is an edge.
            let low = w.get(0) == 0;
            let before = w.get(2) != 0;
            w.set(2, u64::from(low));
            w.set(1, u64::from(low && !before));
        }
        Block::Sr => {
            let q = w.get(0) != 0 || (w.get(1) == 0 && w.get(2) != 0);
            w.set(2, u64::from(q));
        }
        Block::Rs => {
            let q = w.get(1) == 0 && (w.get(0) != 0 || w.get(2) != 0);
            w.set(2, u64::from(q));
        }
    }
    Ok(())
}

/// Runs a timer. Its words are IN, PT, Q, ET, start, memory. The memory has IN in bit
/// 0; of TOF and TP, "time runs" in bit 1; of TOF, "time is over" in bit 2.
fn timer(w: &mut Words<'_>, block: Block, now: i64) {
    let input = w.get(0) != 0;
    let pt = (w.get(1) as i64).max(0);
    let memory = w.get(5);
    let before = memory & 1 != 0;
    let mut running = memory & 2 != 0;
    let mut start = w.get(4) as i64;
    let (q, et);
    match block {
        Block::Tof => {
            if before && !input {
                start = now;
                running = true;
            }
            if input {
                running = false;
            }
            let gone = if running { now.wrapping_sub(start).clamp(0, pt) } else { 0 };
            let ended = !input && !running && memory & 4 != 0;
            let done = running && gone >= pt;
            // After the end ET stays at PT until IN is true again.
            q = input || (running && !done);
            et = if input {
                0
            } else if done || ended {
                pt
            } else {
                gone
            };
            let over = done || ended;
            running &= !done;
            w.set(5, u64::from(input) | u64::from(running) << 1 | u64::from(over) << 2);
        }
        Block::Tp => {
            if input && !before && !running {
                start = now;
                running = true;
            }
            let gone = now.wrapping_sub(start).clamp(0, pt);
            q = running && gone < pt;
            // After the pulse ET stays at PT while IN is still true.
            et = if q {
                gone
            } else if input {
                pt
            } else {
                0
            };
            running = q;
            w.set(5, u64::from(input) | u64::from(running) << 1);
        }
        Block::Ton
        | Block::Ctu
        | Block::Ctd
        | Block::Ctud
        | Block::RTrig
        | Block::FTrig
        | Block::Sr
        | Block::Rs => {
            if input && !before {
                start = now;
            }
            let gone = if input { now.wrapping_sub(start).clamp(0, pt) } else { 0 };
            q = input && gone >= pt;
            et = gone;
            w.set(5, u64::from(input));
        }
    }
    w.set(4, start as u64);
    w.set(2, u64::from(q));
    w.set(3, et as u64);
}
