//! What of the templates a program needs.

use g7_engine::{NONE, Op, Tables};

use crate::build::Gen;
use crate::template::Facts;

/// Where the inputs of each control block are counted, and how many there are.
pub(crate) fn counts(t: &Tables) -> (Vec<usize>, usize) {
    let mut at = 0;
    let places = t.blocks.iter().map(|b| {
        let here = at;
        at += if b.plain { 1 } else { 11 };
        here
    });
    let places = places.collect();
    (places, at)
}

pub(crate) fn of(t: &Tables, flat: bool) -> Facts {
    let mut f = Facts::default();
    let r = t.rules;
    let lists = t.extras.iter().any(|e| !e.on.is_empty() || !e.off.is_empty());
    let clearing = t.transitions.iter().any(|t| t.on_clearing != NONE);
    let stored = !t.events.is_empty() || (clearing && !r.sequential) || (lists && !r.late_actions);
    let hierarchy = t.extras.iter().any(|e| !e.encloses.is_empty() || !e.links.is_empty());
    let comes_and_goes = r.stable && (r.sequential || !r.parallel_actions);
    let full = t.blocks.iter().filter(|b| !b.plain).count();
    let conditional =
        t.contributions.iter().filter(|c| !c.condition.is_empty() || !c.time.is_empty()).count();
    let shared = t.transitions.iter().any(|x| {
        let settled = if r.multi_token { x.priority == NONE } else { x.simple };
        x.shares && !settled
    });
    // Each step's memory may change by itself, before those of the others do.
    let alone = !(hierarchy || lists || r.parallel_actions && stored)
        && t.orders.is_empty()
        && t.group_lists.is_empty();
    let single = |x: &g7_engine::Transition| {
        let ends = x.from.0 != NONE && x.to.0 != NONE;
        ends && x.more_from.is_empty() && x.more_to.is_empty() && !x.drops
    };
    let settled = !r.multi_token && t.steps.iter().any(|s| s.out.end > s.out.start + 1);
    let late =
        r.late_actions && lists || !t.periodics.is_empty() || t.blocks.iter().any(|b| b.action != NONE);
    let on = t.extras.iter().any(|e| {
        !(e.events.is_empty() && e.periodics.is_empty() && e.contributions.is_empty() && e.groups.is_empty())
            || (e.uncounted && t.counts.is_some())
    });
    f.flags = [
        ("FLAT", flat),
        ("ALONE", alone),
        ("STABLE", r.stable),
        ("MULTI", r.multi_token),
        ("EXCLUSIVE", r.numbered_exclusive),
        ("SEQUENTIAL", r.sequential),
        ("LATE", r.late_actions),
        ("KEEP", r.keep_step_time),
        ("SCAN_CLOCK", r.scan_clock),
        ("FINAL_SCAN", r.final_scan),
        ("PERIODIC_FIRST", r.periodic_first),
        ("HAS_ORDERS", !t.orders.is_empty()),
        ("HAS_PERIODS", t.periods.iter().any(|p| *p > 0)),
        ("HAS_HIERARCHY", hierarchy),
        ("UNMARKS", hierarchy || !t.orders.is_empty()),
        ("HAS_LISTS", lists),
        ("HAS_STORED", stored),
        ("DEFERS", stored && r.parallel_actions),
        ("HAS_CLEARING", clearing),
        ("HAS_CONTESTS", shared),
        ("HAS_JOINS", t.transitions.iter().any(|x| !x.more_from.is_empty())),
        ("ONE_TO_ONE", t.transitions.iter().all(single)),
        ("HAS_SETTLED", settled && t.transitions.iter().any(|x| x.simple)),
        ("SAME_RECEPTIVITIES", false),
        ("HAS_FOLLOWERS", t.steps.iter().any(|s| s.direct.0 != NONE)),
        ("HAS_GROUPS", !t.group_lists.is_empty()),
        ("HAS_EVENTS", !t.events.is_empty()),
        ("HAS_PERIODICS", !t.periodics.is_empty()),
        ("HAS_BLOCKS", !t.blocks.is_empty()),
        ("HAS_FULL", full > 0),
        ("HAS_CONDITIONS", conditional > 0),
        ("HAS_WATCHES", !t.watches.is_empty()),
        ("HAS_REQUESTS", Gen::asks(t)),
        ("HAS_COUNTS", t.counts.is_some()),
        ("HAS_LIMITS", t.limits.is_some()),
        ("HAS_DROPS", !t.drops.is_empty()),
        ("HAS_SOURCES", !t.sources.is_empty()),
        ("HAS_PRE", !t.pre.is_empty()),
        ("HAS_SERVICES", !t.services.is_empty()),
        ("HAS_POST", !t.post.is_empty()),
        ("HAS_TAIL", !t.tail.is_empty()),
        ("HAS_LATE", late),
        ("HAS_ON", on),
        ("LOOKS_BACK", t.code.iter().any(|op| matches!(op, Op::WasActive(_)))),
        ("COMES_AND_GOES", comes_and_goes),
        ("NOTES_STEPS", comes_and_goes || r.late_actions),
        ("LOOKS_EARLY", r.late_actions && (conditional > 0 || full > 0)),
        ("GUARDS_FAIL", true),
        ("HAS_OUTS", !t.outs.is_empty()),
    ]
    .into_iter()
    .collect();
    sizes(t, &mut f, full);
    f
}

fn sizes(t: &Tables, f: &mut Facts, full: usize) {
    let words = |n: usize| n.div_ceil(32).max(1);
    let references = t.action_lists.len()
        + t.events.len()
        + t.transitions.iter().filter(|t| t.on_clearing != NONE).count();
    let group = |r: &g7_engine::Rows| -> usize {
        let groups = t.group_lists.get(r.start as usize..r.end as usize).unwrap_or(&[]);
        let sizes = groups.iter().filter_map(|g| t.groups.get(g.0 as usize));
        sizes.map(|g| (g.steps.end - g.steps.start) as usize).sum()
    };
    let taken: usize = t.extras.iter().map(|e| group(&e.encloses)).sum();
    let brought: usize = t.extras.iter().map(|e| (e.links.end - e.links.start) as usize).sum();
    let (steps, transitions) = (t.steps.len(), t.transitions.len());
    let most = [
        steps,
        transitions,
        t.actions.len(),
        t.orders.len() + 1,
        t.groups.len(),
        t.contributions.len(),
        t.charts.len(),
    ];
    let most = most.into_iter().max().unwrap_or(0);
    f.sizes = [
        (
            "ROW_BITS",
            if most < 250 {
                8
            } else if most < 65_000 {
                16
            } else {
                32
            },
        ),
        ("STEPS", steps),
        ("WORDS", words(steps)),
        ("TOP", words(words(steps))),
        ("TRANSITIONS", transitions),
        ("SOURCES", t.sources.len()),
        ("GROUPS", t.groups.len()),
        ("GROUP_WORDS", words(t.groups.len())),
        ("CHARTS", t.charts.len()),
        ("WATCHES", t.watches.len()),
        ("EVENTS", t.events.len()),
        ("EVENT_WORDS", words(t.events.len())),
        ("PERIODICS", t.periodics.len()),
        ("PERIODIC_WORDS", words(t.periodics.len())),
        ("CONDITIONS", t.contributions.len()),
        ("CONDITION_WORDS", words(t.contributions.len())),
        ("BLOCKS", t.blocks.len()),
        ("BLOCK_WORDS", words(t.blocks.len())),
        ("COUNTS", counts(t).1),
        ("FULL", full),
        ("FULL_TIMES", full * 5),
        ("PERIODS", t.periods.len()),
        ("ACTIONS", t.actions.len()),
        ("ACTION_WORDS", words(t.actions.len())),
        ("RUNS", references.max(1)),
        ("ORDERS", t.orders.len()),
        ("NO_ORDER", t.orders.len()),
        ("CHAIN", 1 + taken.max(brought)),
        ("ENTERED", 2 * steps + 1),
        ("BOUND", t.rules.bound as usize),
        ("MOST_ACTIVE", t.limits.map_or(0, |l| l.1.active as usize)),
        ("MOST_ENABLED", t.limits.map_or(0, |l| l.1.enabled as usize)),
    ]
    .into_iter()
    .collect();
}
