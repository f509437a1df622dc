//! The parts of the runtime that a program needs.

use g7_engine::{NONE, Op, Service, Tables};

use crate::room::Room;
use crate::runtime::Facts;

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

pub(crate) fn of(t: &Tables, room: Room) -> Facts {
    let r = t.rules;
    let lists = t.extras.iter().any(|e| !e.on.is_empty() || !e.off.is_empty());
    let clearing = t.transitions.iter().any(|t| t.on_clearing != NONE);
    let stored = !t.events.is_empty() || (clearing && !r.sequential) || (lists && !r.late_actions);
    let hierarchy = t.extras.iter().any(|e| !e.encloses.is_empty() || !e.links.is_empty());
    let comes_and_goes = r.stable && (r.sequential || !r.parallel_actions);
    let full = t.blocks.iter().filter(|b| !b.plain).count();
    let conditional =
        t.contributions.iter().filter(|c| !c.condition.is_empty() || !c.time.is_empty()).count();
    let looks_early = r.late_actions && (conditional > 0 || full > 0);
    let shared = t.transitions.iter().any(|x| {
        let settled = if r.multi_token { x.priority == NONE } else { x.simple };
        x.shares && !settled
    });
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
    let rows = most.into_iter().max().unwrap_or(0);
    let is_line = !hierarchy && t.orders.is_empty() && !asks(t) && t.transitions.iter().all(single);
    let most = if room.small && is_line { of_a_line(t) } else { (transitions, steps, steps) };
    Facts {
        stable: r.stable,
        multi: r.multi_token,
        exclusive: r.numbered_exclusive,
        sequential: r.sequential,
        late: r.late_actions,
        keep: r.keep_step_time,
        scan_clock: r.scan_clock,
        narrow: room.is_narrow(),
        has_times: true,
        few_times: room.small,
        times_apart: true,
        final_scan: r.final_scan,
        periodic_first: r.periodic_first,
        has_orders: !t.orders.is_empty(),
        has_periods: t.periods.iter().any(|p| *p > 0),
        has_hierarchy: hierarchy,
        unmarks: hierarchy || !t.orders.is_empty(),
        has_lists: lists,
        has_stored: stored,
        defers: stored && r.parallel_actions,
        has_clearing: clearing,
        has_contests: shared,
        has_joins: t.transitions.iter().any(|x| !x.more_from.is_empty()),
        one_to_one: t.transitions.iter().all(single),
        bare: !(hierarchy || stored || lists || clearing || r.sequential)
            && t.orders.is_empty()
            && t.group_lists.is_empty()
            && t.drops.is_empty(),
        one_word: words(steps) == 1,
        has_settled: settled && t.transitions.iter().any(|x| x.simple),
        same_receptivities: false,
        has_followers: t.steps.iter().any(|s| s.direct.0 != NONE),
        has_groups: !t.group_lists.is_empty(),
        has_events: !t.events.is_empty(),
        has_periodics: !t.periodics.is_empty(),
        has_blocks: !t.blocks.is_empty(),
        has_full: full > 0,
        has_conditions: conditional > 0,
        has_watches: !t.watches.is_empty(),
        has_requests: asks(t),
        has_counts: t.counts.is_some(),
        has_limits: t.limits.is_some(),
        has_drops: !t.drops.is_empty(),
        has_sources: !t.sources.is_empty(),
        has_pre: !t.pre.is_empty(),
        has_services: !t.services.is_empty(),
        has_post: !t.post.is_empty(),
        has_tail: !t.tail.is_empty(),
        has_late: late,
        has_on: on,
        looks_back: t.code.iter().any(|op| matches!(op, Op::WasActive(_))),
        comes_and_goes,
        notes_steps: comes_and_goes || looks_early,
        looks_early,
        guards_fail: true,
        has_outs: !t.outs.is_empty(),

        row_bits: if rows < 250 {
            8
        } else if rows < 65_000 {
            16
        } else {
            32
        },
        tick_bits: if room.is_narrow() { 32 } else { 64 },
        steps,
        timed: steps,
        tick: room.clock.nanoseconds() as usize,
        words: words(steps),
        top: words(words(steps)),
        transitions,
        fired: most.0,
        marked_on: most.1,
        marked_off: most.2,
        sources: t.sources.len(),
        groups: t.groups.len(),
        group_words: words(t.groups.len()),
        charts: t.charts.len(),
        watches: t.watches.len(),
        events: t.events.len(),
        event_words: words(t.events.len()),
        periodics: t.periodics.len(),
        periodic_words: words(t.periodics.len()),
        conditions: t.contributions.len(),
        condition_words: words(t.contributions.len()),
        blocks: t.blocks.len(),
        block_words: words(t.blocks.len()),
        counts: counts(t).1,
        full,
        full_times: full * 5,
        periods: t.periods.len(),
        actions: t.actions.len(),
        action_words: words(t.actions.len()),
        runs: references.max(1),
        orders: t.orders.len(),
        no_order: t.orders.len(),
        chain: 1 + taken.max(brought),
        entered: 2 * steps + 1,
        bound: t.rules.bound as usize,
        most_active: t.limits.map_or(0, |l| l.1.active as usize),
        most_enabled: t.limits.map_or(0, |l| l.1.enabled as usize),
    }
}

/// Most transitions that clear in a pass, steps that are marked on, and off, in a chart whose
/// transitions have one step on each side: it never has more active steps than initial ones,
/// where no step is left by several transitions at once.
fn of_a_line(t: &Tables) -> (usize, usize, usize) {
    let (steps, transitions) = (t.steps.len(), t.transitions.len());
    let branches = t.steps.iter().map(|s| (s.out.end - s.out.start) as usize).max().unwrap_or(0);
    if t.rules.multi_token && branches > 1 {
        return (transitions, steps, steps);
    }
    let active = t.initial.len();
    (transitions.min(active * branches), active, active)
}

/// Some service that sets, resets, initialises or clears is called.
fn asks(t: &Tables) -> bool {
    t.code.iter().any(|op| matches!(op, Op::Service(s) if *s != Service::ResetTimes))
}
