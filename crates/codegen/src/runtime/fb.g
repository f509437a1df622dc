struct Ctu { cu: bool, r: bool, pv: i16, q: bool, cv: i16, cu_before: bool, }
struct Ctd { cd: bool, ld: bool, pv: i16, q: bool, cv: i16, cd_before: bool, }
struct Ctud { cu: bool, cd: bool, r: bool, ld: bool, pv: i16, qu: bool, qd: bool, cv: i16, cu_before: bool, cd_before: bool, }
struct Ton { in_: bool, pt: i64, q: bool, et: i64, start: i64, memory: u8, }
struct Tof { in_: bool, pt: i64, q: bool, et: i64, start: i64, memory: u8, }
struct Tp { in_: bool, pt: i64, q: bool, et: i64, start: i64, memory: u8, }
struct RTrig { clk: bool, q: bool, clk_before: bool, }
struct FTrig { clk: bool, q: bool, low_before: bool, }
struct Sr { s1: bool, r: bool, q1: bool, }
struct Rs { s: bool, r1: bool, q1: bool, }

fn call_ctu(b: &mut Ctu) {
    let up: bool = b.cu && !b.cu_before;
    b.cu_before = b.cu;
    if b.r {
        b.cv = 0;
    } else if up && b.cv < 32767 {
        b.cv += 1;
    }
    b.q = b.cv >= b.pv;
}

fn call_ctd(b: &mut Ctd) {
    let down: bool = b.cd && !b.cd_before;
    b.cd_before = b.cd;
    if b.ld {
        b.cv = b.pv;
    } else if down && b.cv > -32768 {
        b.cv -= 1;
    }
    b.q = b.cv <= 0;
}

fn call_ctud(b: &mut Ctud) {
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

// Time gone by, at least 0 and at most `most`.
fn gone_by(now: i64, start: i64, most: i64) -> i64 {
    let gone: i64 = since(now, start);
    if gone < 0 {
        return 0;
    }
    if gone > most {
        return most;
    }
    return gone;
}

fn not_negative(time: i64) -> i64 {
    if time < 0 {
        return 0;
    }
    return time;
}

fn call_ton(b: &mut Ton, now: i64) {
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

// Memory: IN (1), running (2), ended (4).
fn call_tof(b: &mut Tof, now: i64) {
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

fn call_tp(b: &mut Tp, now: i64) {
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

fn call_r_trig(b: &mut RTrig) {
    b.q = b.clk && !b.clk_before;
    b.clk_before = b.clk;
}

fn call_f_trig(b: &mut FTrig) {
    b.q = !b.clk && !b.low_before;
    b.low_before = !b.clk;
}

fn call_sr(b: &mut Sr) {
    b.q1 = b.s1 || (!b.r && b.q1);
}

fn call_rs(b: &mut Rs) {
    b.q1 = !b.r1 && (b.s || b.q1);
}
