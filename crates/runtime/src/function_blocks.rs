//! The standard function blocks of IEC 61131-3.

use crate::numbers::since;

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ctu {
    pub cu: bool,
    pub r: bool,
    pub pv: i16,
    pub q: bool,
    pub cv: i16,
    pub cu_before: bool,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ctd {
    pub cd: bool,
    pub ld: bool,
    pub pv: i16,
    pub q: bool,
    pub cv: i16,
    pub cd_before: bool,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ctud {
    pub cu: bool,
    pub cd: bool,
    pub r: bool,
    pub ld: bool,
    pub pv: i16,
    pub qu: bool,
    pub qd: bool,
    pub cv: i16,
    pub cu_before: bool,
    pub cd_before: bool,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ton {
    pub in_: bool,
    pub pt: i64,
    pub q: bool,
    pub et: i64,
    pub start: i64,
    pub memory: u8,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tof {
    pub in_: bool,
    pub pt: i64,
    pub q: bool,
    pub et: i64,
    pub start: i64,
    pub memory: u8,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tp {
    pub in_: bool,
    pub pt: i64,
    pub q: bool,
    pub et: i64,
    pub start: i64,
    pub memory: u8,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RTrig {
    pub clk: bool,
    pub q: bool,
    pub clk_before: bool,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FTrig {
    pub clk: bool,
    pub q: bool,
    pub low_before: bool,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sr {
    pub s1: bool,
    pub r: bool,
    pub q1: bool,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rs {
    pub s: bool,
    pub r1: bool,
    pub q1: bool,
}

pub fn call_ctu(b: &mut Ctu) {
    let up: bool = b.cu && !b.cu_before;
    b.cu_before = b.cu;
    if b.r {
        b.cv = 0;
    } else if up && b.cv < 32767 {
        b.cv += 1;
    }
    b.q = b.cv >= b.pv;
}

pub fn call_ctd(b: &mut Ctd) {
    let down: bool = b.cd && !b.cd_before;
    b.cd_before = b.cd;
    if b.ld {
        b.cv = b.pv;
    } else if down && b.cv > -32768 {
        b.cv -= 1;
    }
    b.q = b.cv <= 0;
}

pub fn call_ctud(b: &mut Ctud) {
    let up: bool = b.cu && !b.cu_before;
    let down: bool = b.cd && !b.cd_before;
    b.cu_before = b.cu;
    b.cd_before = b.cd;
    if b.r {
        b.cv = 0;
    } else if b.ld {
        b.cv = b.pv;
    } else if up && !down && b.cv < 32767 {
        b.cv += 1;
    } else if down && !up && b.cv > -32768 {
        b.cv -= 1;
    }
    b.qu = b.cv >= b.pv;
    b.qd = b.cv <= 0;
}

/// Time gone by, at least 0 and at most `most`.
pub fn gone_by(now: i64, start: i64, most: i64) -> i64 {
    let gone: i64 = since(now, start);
    if gone < 0 {
        return 0;
    }
    if gone > most {
        return most;
    }
    gone
}

pub fn not_negative(time: i64) -> i64 {
    if time < 0 {
        return 0;
    }
    time
}

pub fn call_ton(b: &mut Ton, now: i64) {
    let pt: i64 = not_negative(b.pt);
    if b.in_ && b.memory == 0 {
        b.start = now;
    }
    b.et = 0;
    b.memory = 0;
    if b.in_ {
        b.et = gone_by(now, b.start, pt);
        b.memory = 1;
    }
    b.q = b.in_ && b.et >= pt;
}

/// Memory: IN (1), running (2), ended (4).
pub fn call_tof(b: &mut Tof, now: i64) {
    let pt: i64 = not_negative(b.pt);
    let mut running: bool = (b.memory & 2) != 0;
    if (b.memory & 1) != 0 && !b.in_ {
        b.start = now;
        running = true;
    }
    if b.in_ {
        running = false;
    }
    let mut gone: i64 = 0;
    if running {
        gone = gone_by(now, b.start, pt);
    }
    let ended: bool = !b.in_ && !running && (b.memory & 4) != 0;
    let done: bool = running && gone >= pt;
    b.q = b.in_ || (running && !done);
    b.et = gone;
    if b.in_ {
        b.et = 0;
    } else if done || ended {
        b.et = pt;
    }
    let mut memory: u8 = 0;
    if b.in_ {
        memory |= 1;
    }
    if running && !done {
        memory |= 2;
    }
    if done || ended {
        memory |= 4;
    }
    b.memory = memory;
}

pub fn call_tp(b: &mut Tp, now: i64) {
    let pt: i64 = not_negative(b.pt);
    let mut running: bool = (b.memory & 2) != 0;
    if b.in_ && (b.memory & 1) == 0 && !running {
        b.start = now;
        running = true;
    }
    let gone: i64 = gone_by(now, b.start, pt);
    b.q = running && gone < pt;
    b.et = 0;
    if b.q {
        b.et = gone;
    } else if b.in_ {
        b.et = pt;
    }
    let mut memory: u8 = 0;
    if b.in_ {
        memory |= 1;
    }
    if b.q {
        memory |= 2;
    }
    b.memory = memory;
}

pub fn call_r_trig(b: &mut RTrig) {
    b.q = b.clk && !b.clk_before;
    b.clk_before = b.clk;
}

pub fn call_f_trig(b: &mut FTrig) {
    b.q = !b.clk && !b.low_before;
    b.low_before = !b.clk;
}

pub fn call_sr(b: &mut Sr) {
    b.q1 = b.s1 || (!b.r && b.q1);
}

pub fn call_rs(b: &mut Rs) {
    b.q1 = !b.r1 && (b.s || b.q1);
}
