//! The inputs that are tried in a state, as the explicit search tries them.

use crate::model::Model;
use crate::reason::Reason;

/// Most combinations of inputs that are tried in one state.
const MOST: usize = 1 << 16;

/// The reason why the combinations are not all that matter.
pub(super) type Gap = Option<Reason>;

/// All values of the inputs at these places, the others as they were. The present value comes first, so
/// that a run changes an input only where it must.
pub(super) fn vectors(model: &Model<'_>, places: &[usize], last: &[u64]) -> (Vec<Vec<u64>>, Gap) {
    let tried = |i: usize| model.inputs.get(i).map_or(&[][..], |v| &v.tried);
    let count = places.iter().fold(1usize, |n, i| n.saturating_mul(tried(*i).len().max(1)));
    let set = |old: &[u64], i: usize, value: u64| {
        let mut new = old.to_vec();
        new.get_mut(i).into_iter().for_each(|w| *w = value);
        new
    };
    let values = |i: usize| {
        let now = last.get(i).copied();
        let others = tried(i).iter().copied().filter(move |v| Some(*v) != now);
        now.filter(|v| tried(i).contains(v)).into_iter().chain(others)
    };
    let mut list = vec![last.to_vec()];
    for i in places {
        if count > MOST {
            list.extend(tried(*i).iter().map(|v| set(last, *i, *v)).filter(|v| v != last));
        } else {
            list = list.iter().flat_map(|old| values(*i).map(|v| set(old, *i, v))).collect();
        }
    }
    (list, gap(model, places, count))
}

fn gap(model: &Model<'_>, places: &[usize], count: usize) -> Gap {
    if count > MOST {
        return Some(Reason::Combinations(places.len()));
    }
    let open = places.iter().find(|i| model.inputs.get(**i).is_some_and(|v| !v.whole))?;
    let addr = g7_engine::Addr(model.compiled.program.tables().inputs.start + *open as u32);
    let name = model.compiled.symbols.variable_at(addr).map_or("", |v| &v.name);
    Some(Reason::Values(name.to_owned()))
}
