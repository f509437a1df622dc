//! A chart with a clock of its own, about the end of a February, at the end of some documents.

use super::rng::Rng;
use super::sight::Sight;

/// Adds a DT that goes on in each scan, the day and the time that it is, and a chart that waits for them. The random numbers
/// come from a copy of the generator: the rest of the document does not depend on them.
pub(super) fn dates(rng: &Rng, outside: &Sight, out: &mut String) {
    let mut rng = rng.clone();
    for _ in 0..3 {
        rng.bits();
    }
    if !rng.percent(10) {
        return;
    }
    let (go, back) = (outside.boolean(&mut rng, 2), outside.boolean(&mut rng, 1));
    let start = rng.one([
        "2028-02-28-23:59:59.97",
        "2100-02-28-23:59:59.99",
        "1969-12-31-23:59:59.98",
        "2026-11-28-12:00:00",
    ]);
    let step = rng.one(["7ms", "11ms", "13h", "SEL(bell, 9ms, 24h)"]);
    // A time of day that leaves its day is the fault `range` after some scans.
    let alarm = match rng.below(8) {
        0 => "alarm + 5h",
        1 | 2 => "DT_TO_TOD(now + 20ms)",
        3 => "LIMIT(TOD#06:00:00, time, TOD#22:00:00)",
        _ => "SEL(bell, time, alarm)",
    };
    out.push_str(&format!(
        "var now : DT := DT#{start}\nvar day : DATE\nvar time, alarm : TOD\nvar passed : TIME\nvar week : INT\nvar seconds : LINT\n\
         output bell : BOOL\n"
    ));
    out.push_str(&format!(
        "chart Clock {{\n  initial step Tick {{\n    each scan: {{\n      now := now + {step}\n      day := DT_TO_DATE(now)\n      \
         time := DT_TO_TOD(now)\n      week := DAY_OF_WEEK(day)\n      passed := now - CONCAT_DATE_TOD(day, TOD#12:00)\n      \
         seconds := DATE_TO_LINT(day) + DT_TO_LINT(now)\n      alarm := {alarm}\n    }}\n  }}\n  step Ring {{\n    \
         N bell if week <> {}\n    P1 now := now - {}\n  }}\n  Tick -> Ring when time < TOD#00:00:01 and ({go}) or day > D#2100-02-28\n  \
         Ring -> Tick when {back} or time > alarm\n}}\n",
        rng.below(7),
        rng.one(["20ms", "1s", "T#-24h"]),
    ));
}
