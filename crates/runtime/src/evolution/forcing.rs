//! The first part of a pass: charts that stand still, forcing orders, actions on event.

use super::*;

/// Which charts stand still in this pass: those not due, and those forced.
pub(crate) fn block_charts(s: &mut State) {
    for i in 0..CHARTS {
        s.blocked[i] = false;
        if HAS_PERIODS {
            s.blocked[i] = !s.due[CHART_PERIOD[i] as usize];
        }
    }
    if HAS_ORDERS {
        for i in 0..CHARTS {
            s.forced_by[i] = NO_ORDER as Row;
        }
        s.conflict = false;
        for i in 0..ORDERS {
            if after_orders(s, ORDER_STEP[i] as usize) {
                impose(s, i);
                if HAS_HIERARCHY {
                    cascade(s);
                }
            }
        }
        if s.conflict {
            s.fault = FAULT_FORCING;
        }
    }
}

/// A step is active after the orders so far.
pub(crate) fn after_orders(s: &State, step: usize) -> bool {
    bit(&s.on_mark, step) || (s.m.x[step] && !bit(&s.off_mark, step))
}

/// The chart of an order is in its situation already.
pub(crate) fn is_in(s: &State, order: usize) -> bool {
    let group: usize = CHART_GROUP[ORDER_CHART[order] as usize] as usize;
    let mut same: bool = true;
    for step in GROUP_FIRST[group] as usize..GROUP_END[group] as usize {
        let mut wanted: bool = false;
        let mut i: usize = ORDER_STEPS_AT[order] as usize;
        while i < ORDER_STEPS_AT[order + 1] as usize {
            wanted = wanted || ORDER_STEPS[i] as usize == step;
            i += 1;
        }
        same = same && after_orders(s, step) == wanted;
    }
    same
}

/// Marks what a forcing order imposes.
pub(crate) fn impose(s: &mut State, order: usize) {
    let chart: usize = ORDER_CHART[order] as usize;
    let first: usize = s.forced_by[chart] as usize;
    if first != NO_ORDER {
        // The present situation is number 0, and its orders come first: the others are
        // compared with a situation that no order has touched.
        if ORDER_SITUATION[first] != ORDER_SITUATION[order]
            && (ORDER_SITUATION[first] != 0 || !is_in(s, order))
        {
            s.conflict = true;
        }
        return;
    }
    s.forced_by[chart] = order as Row;
    s.blocked[chart] = true;
    if ORDER_SITUATION[order] == 0 {
        return;
    }
    let mut i: usize = ORDER_STEPS_AT[order] as usize;
    while i < ORDER_STEPS_AT[order + 1] as usize {
        mark_on(s, ORDER_STEPS[i] as usize);
        i += 1;
    }
    let group: usize = CHART_GROUP[chart] as usize;
    mark_range_off(s, GROUP_FIRST[group] as usize, GROUP_END[group] as usize);
    // An imposed step that is active already is neither activated nor deactivated.
    i = ORDER_STEPS_AT[order] as usize;
    while i < ORDER_STEPS_AT[order + 1] as usize {
        let step: usize = ORDER_STEPS[i] as usize;
        i += 1;
        if s.m.x[step] {
            bit_clear(&mut s.on_mark, step);
            bit_clear(&mut s.off_mark, step);
        }
    }
}

/// Actions on event of the steps that are active as the pass begins.
pub(crate) fn events(s: &mut State) {
    let mut i: usize = bit_next(&s.m.events, EVENTS, 0);
    while i < EVENTS && s.fault == 0 {
        event(s, i);
        i = bit_next(&s.m.events, EVENTS, i + 1);
    }
}
