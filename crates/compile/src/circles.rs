//! Circles among things that call each other: functions, tasks.

use g7_model::Span;

/// The calls that close a circle. `callees` says, for each caller, whom it calls and
/// where; each circle is met at the last of its calls that the search comes to.
pub(crate) fn closing_calls(callees: &[Vec<(usize, Span)>]) -> Vec<(usize, Span)> {
    let mut found = Vec::new();
    let mut visits = vec![Visit::New; callees.len()];
    for start in 0..callees.len() {
        if visits.get(start) == Some(&Visit::New) {
            search(start, callees, &mut visits, &mut found);
        }
    }
    found
}

/// How far the search has come with a caller.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Visit {
    New,
    Open,
    Done,
}

/// Goes down all calls from one caller, without recursion.
fn search(
    start: usize,
    callees: &[Vec<(usize, Span)>],
    visits: &mut [Visit],
    found: &mut Vec<(usize, Span)>,
) {
    let mut way: Vec<(usize, usize)> = vec![(start, 0)];
    set(visits, start, Visit::Open);
    while let Some((caller, next)) = way.last_mut() {
        let Some((callee, at)) = callees.get(*caller).and_then(|list| list.get(*next)).copied() else {
            set(visits, *caller, Visit::Done);
            way.pop();
            continue;
        };
        *next += 1;
        match visits.get(callee).copied() {
            Some(Visit::New) => {
                set(visits, callee, Visit::Open);
                way.push((callee, 0));
            }
            Some(Visit::Open) => found.push((callee, at)),
            Some(Visit::Done) | None => {}
        }
    }
}

fn set(visits: &mut [Visit], who: usize, visit: Visit) {
    if let Some(v) = visits.get_mut(who) {
        *v = visit;
    }
}
