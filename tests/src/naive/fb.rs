//! The standard function blocks of IEC 61131-3:2003, 2.5.2.3, each written like the body in the
//! standard.

use g7_model::{FbKind, Type};

use super::value::{Run, Value, bad, zero};

/// An instance: its members by name, and the values that it keeps between calls.
#[derive(Clone, Debug, PartialEq)]
pub struct FbState {
    /// The kind of block.
    pub kind: FbKind,
    members: Vec<(&'static str, Value)>,
    /// The edge memories of CU, CLK or IN, and of CD.
    last: [bool; 2],
    /// The instant at which a timer was started.
    since: Option<i64>,
}

impl FbState {
    /// An instance before its first call.
    pub fn new(kind: FbKind) -> FbState {
        let members = kind.members().iter().map(|(name, ty, _)| (*name, zero(*ty))).collect();
        // The memory of NOT CLK in F_TRIG starts as FALSE, as if CLK had been TRUE before.
        FbState { kind, members, last: [kind == FbKind::FTrig, false], since: None }
    }

    /// The type of a member; its name may be in upper or lower case.
    pub fn member_type(kind: FbKind, name: &str) -> Option<Type> {
        kind.members().iter().find(|m| m.0.eq_ignore_ascii_case(name)).map(|m| m.1)
    }

    /// The value of a member.
    pub fn get(&self, name: &str) -> Option<&Value> {
        self.members.iter().find(|m| m.0.eq_ignore_ascii_case(name)).map(|m| &m.1)
    }

    /// The members with their values, in the order of the parameters.
    pub fn members(&self) -> impl Iterator<Item = (&'static str, &Value)> {
        self.members.iter().map(|(n, v)| (*n, v))
    }

    pub(super) fn set(&mut self, name: &str, value: Value) -> Run<()> {
        match self.members.iter_mut().find(|m| m.0.eq_ignore_ascii_case(name)) {
            Some(m) => m.1 = value,
            None => return bad(format!("{} has no {name}", self.kind.name())),
        }
        Ok(())
    }

    fn on(&self, name: &str) -> bool {
        matches!(self.get(name), Some(Value::Bool(true)))
    }

    fn number(&self, name: &str) -> i128 {
        if let Some(Value::Int(n)) = self.get(name) { *n } else { 0 }
    }

    fn duration(&self, name: &str) -> i64 {
        if let Some(Value::Time(t)) = self.get(name) { *t } else { 0 }
    }

    /// Calls the block at `now`, after its inputs were set.
    pub(super) fn call(&mut self, now: i64) -> Run<()> {
        match self.kind {
            FbKind::Ctu | FbKind::Ctd | FbKind::Ctud => self.count(),
            FbKind::Ton => self.ton(now),
            FbKind::Tof => self.tof(now),
            FbKind::Tp => self.tp(now),
            FbKind::RTrig => {
                let clk = self.on("CLK");
                let q = clk && !self.last[0];
                self.last[0] = clk;
                self.set("Q", Value::Bool(q))
            }
            FbKind::FTrig => {
                let clk = self.on("CLK");
                let q = !clk && self.last[0];
                self.last[0] = clk;
                self.set("Q", Value::Bool(q))
            }
            FbKind::Sr => {
                let q = self.on("S1") || (!self.on("R") && self.on("Q1"));
                self.set("Q1", Value::Bool(q))
            }
            FbKind::Rs => {
                let q = !self.on("R1") && (self.on("S") || self.on("Q1"));
                self.set("Q1", Value::Bool(q))
            }
        }
    }

    fn count(&mut self) -> Run<()> {
        let (least, most) = (i128::from(i16::MIN), i128::from(i16::MAX));
        let (cu, cd) = (self.on("CU"), self.on("CD"));
        let up = cu && !self.last[0];
        let down = cd && !self.last[1];
        self.last = [cu, cd];
        let (mut cv, pv) = (self.number("CV"), self.number("PV"));
        let reset = self.on("R");
        let load = self.on("LD");
        if reset {
            cv = 0;
        } else if load {
            cv = pv;
        } else if up && !down {
            cv = (cv + 1).min(most);
        } else if down && !up {
            cv = (cv - 1).max(least);
        }
        self.set("CV", Value::Int(cv))?;
        match self.kind {
            FbKind::Ctu => self.set("Q", Value::Bool(cv >= pv)),
            FbKind::Ctd => self.set("Q", Value::Bool(cv <= 0)),
            _ => {
                self.set("QU", Value::Bool(cv >= pv))?;
                self.set("QD", Value::Bool(cv <= 0))
            }
        }
    }

    fn ton(&mut self, now: i64) -> Run<()> {
        let pt = self.duration("PT");
        let (q, et) = if self.on("IN") {
            let run = now - *self.since.get_or_insert(now);
            (run >= pt, run.min(pt))
        } else {
            self.since = None;
            (false, 0)
        };
        self.timed(q, et)
    }

    fn tof(&mut self, now: i64) -> Run<()> {
        let pt = self.duration("PT");
        let (q, et) = if self.on("IN") {
            self.last[0] = true;
            self.since = None;
            (true, 0)
        } else if self.last[0] {
            let run = now - *self.since.get_or_insert(now);
            (run < pt, run.min(pt))
        } else {
            (false, 0)
        };
        self.timed(q, et)
    }

    fn tp(&mut self, now: i64) -> Run<()> {
        let pt = self.duration("PT");
        let input = self.on("IN");
        if input && !self.last[0] && self.since.is_none() {
            self.since = Some(now);
        }
        self.last[0] = input;
        let (q, et) = match self.since {
            Some(start) if now - start < pt => (true, now - start),
            Some(_) if input => (false, pt),
            _ => {
                self.since = None;
                (false, 0)
            }
        };
        self.timed(q, et)
    }

    fn timed(&mut self, q: bool, et: i64) -> Run<()> {
        self.set("Q", Value::Bool(q))?;
        self.set("ET", Value::Time(et))
    }
}
