//! Times: since when steps and groups are active, and the clock they are read by.

use super::*;

impl Plan<'_> {
    /// The variable that holds the time of a step.
    pub(crate) fn step_time(&mut self, step: StepId) -> Ex {
        self.timed.insert(step.0);
        self.now();
        let name = format!("XT_{}", self.step(step).trim_start_matches("X_"));
        self.declare(&name, "TIME", "since its activation");
        self.declare(
            &format!("XS_{}", self.step(step).trim_start_matches("X_")),
            "TIME",
            "when it was activated",
        );
        Ex::Var(name)
    }

    /// The variable that counts the scans of a step.
    pub(crate) fn step_scans(&mut self, step: StepId) -> Ex {
        self.counted.insert(step.0);
        let name = format!("XN_{}", self.step(step).trim_start_matches("X_"));
        self.declare(&name, "LINT", "scans since its activation");
        Ex::Var(name)
    }

    pub(crate) fn group_time(&mut self, g: GroupId) -> Ex {
        self.timed_groups.insert(g.0);
        self.now();
        let name = format!("GT_{}", g.0 + 1);
        let of = self.c.symbols.macro_steps.iter().find(|m| m.group == g).map_or("", |m| &m.name);
        self.declare(&name, "TIME", &format!("time of the macro-step {of}"));
        self.declare(&format!("GS_{}", g.0 + 1), "TIME", "when it came on");
        Ex::Var(name)
    }

    /// The time of this scan.
    pub(crate) fn now(&mut self) -> Ex {
        if !self.clock {
            self.clock = true;
            self.declare("CLOCK", "TON", "gives the time");
            self.declare("CLOCK_BASE", "TIME", "");
            self.declare("NOW", "TIME", "time of this scan");
        }
        Ex::var("NOW")
    }

    pub(crate) fn scan_time(&mut self) -> Ex {
        self.now();
        self.dt = true;
        self.declare("LAST", "TIME", "time of the scan before");
        self.declare("DT", "TIME", "time since the scan before");
        Ex::var("DT")
    }

    /// The clock and the times of steps, for what turned out to be read.
    pub(super) fn times(&mut self) {
        let mut s = Section::new("Time");
        if self.clock {
            let long = Ex::Time(20 * 86_400_000_000_000);
            let call = |on: bool| {
                St::Call("CLOCK".into(), vec![("IN".into(), Ex::Bool(on)), ("PT".into(), long.clone())])
            };
            let et = Ex::var("CLOCK.ET");
            let now = St::set("NOW", Ex::op("+", et.clone(), Ex::var("CLOCK_BASE")));
            s.act(
                "A timer that runs on gives the time; it begins anew each hour",
                Ex::Bool(true),
                vec![call(true), now],
            );
            let over = Ex::op(">=", et, Ex::Time(3_600_000_000_000));
            s.act("", over, vec![St::set("CLOCK_BASE", Ex::var("NOW")), call(false), call(true)]);
        }
        if self.dt {
            let zero = vec![St::set("LAST", Ex::var("NOW"))];
            s.act("", Ex::var("FIRST"), zero);
            let dt = St::set("DT", Ex::op("-", Ex::var("NOW"), Ex::var("LAST")));
            s.act("", Ex::Bool(true), vec![dt, St::set("LAST", Ex::var("NOW"))]);
        }
        for step in self.timed.clone() {
            let name = self.step(StepId(step)).trim_start_matches("X_").to_owned();
            let time = Ex::op("-", Ex::var("NOW"), Ex::var(format!("XS_{name}")));
            s.act("", self.active(step), vec![St::set(format!("XT_{name}"), time)]);
        }
        for step in self.counted.clone() {
            let name = format!("XN_{}", self.step(StepId(step)).trim_start_matches("X_"));
            let more = Ex::op("+", Ex::var(name.clone()), Ex::Int(1));
            s.act("", self.active(step), vec![St::set(name, more)]);
        }
        for g in self.timed_groups.clone() {
            let on = self.group_active(GroupId(g));
            let time = Ex::op("-", Ex::var("NOW"), Ex::var(format!("GS_{}", g + 1)));
            s.act("", on, vec![St::set(format!("GT_{}", g + 1), time)]);
        }
        // What begins in the first scan begins now.
        let initial: Vec<St> = self
            .timed
            .iter()
            .map(|s| format!("XS_{}", self.step(StepId(*s)).trim_start_matches("X_")))
            .chain(self.timed_groups.iter().map(|g| format!("GS_{}", g + 1)))
            .map(|name| St::set(name, Ex::var("NOW")))
            .collect();
        s.act("", Ex::var("FIRST"), initial);
        self.e.before.insert(0, s);
    }

    /// Rungs that start and stop the times of steps, before their bits change.
    pub(crate) fn stamps(&mut self, s: &mut Section, come: &HashMap<u32, (Ex, Ex)>) {
        let keep = self.t.rules.keep_step_time;
        for (step, scans) in self
            .timed
            .clone()
            .into_iter()
            .map(|s| (s, false))
            .chain(self.counted.clone().into_iter().map(|s| (s, true)))
        {
            let Some((on, off)) = come.get(&step) else { continue };
            let name = self.step(StepId(step)).trim_start_matches("X_").to_owned();
            let zero =
                if scans { (format!("XN_{name}"), Ex::Int(0)) } else { (format!("XT_{name}"), Ex::Time(0)) };
            let mut begin = vec![St::set(zero.0.clone(), zero.1.clone())];
            if !scans {
                begin.push(St::set(format!("XS_{name}"), Ex::var("NOW")));
            }
            s.act("", on.clone(), begin);
            if !keep {
                s.act("", off.clone(), vec![St::set(zero.0, zero.1)]);
            }
        }
    }

    /// The same for groups, with what their steps will be.
    pub(crate) fn group_stamps(&mut self, s: &mut Section, next: impl Fn(u32) -> Ex) {
        for g in self.timed_groups.clone() {
            let now = self.group_active(GroupId(g));
            let then = Ex::any(self.group_steps(GroupId(g)).into_iter().map(&next));
            let (time, start) = (format!("GT_{}", g + 1), format!("GS_{}", g + 1));
            let begin = vec![St::set(time.clone(), Ex::Time(0)), St::set(start, Ex::var("NOW"))];
            s.act("", then.clone().and(now.clone().not()), begin);
            if !self.t.rules.keep_step_time {
                s.act("", then.not().and(now), vec![St::set(time, Ex::Time(0))]);
            }
        }
    }
}
