//! The cells as a model of Stateright.

use std::time::Duration;

use stateright::{Checker, HasDiscoveries, Model, Property};

/// The number of cells, and if a scan moves only one of them. A state has for each cell its step, 0 to 4.
struct Cells {
    count: usize,
    one: bool,
}

impl Model for Cells {
    type State = Vec<u8>;
    type Action = u32;

    fn init_states(&self) -> Vec<Vec<u8>> {
        vec![vec![0; self.count]]
    }

    /// Every set of cells that can move at once.
    fn actions(&self, state: &Vec<u8>, actions: &mut Vec<u32>) {
        let can = (0..self.count).filter(|c| may(state, *c)).fold(0u32, |m, c| m | 1 << c);
        if self.one {
            actions.extend((0..self.count).map(|c| 1 << c).filter(|cell| can & cell != 0));
            return;
        }
        let mut set = can;
        loop {
            if !(0..self.count).any(|c| c % 2 == 1 && both(state, set, c)) {
                actions.push(set);
            }
            if set == 0 {
                break;
            }
            set = (set - 1) & can;
        }
    }

    fn next_state(&self, state: &Vec<u8>, set: u32) -> Option<Vec<u8>> {
        Some(
            state.iter().enumerate().map(|(c, s)| if set >> c & 1 != 0 { (s + 1) % 5 } else { *s }).collect(),
        )
    }

    fn properties(&self) -> Vec<Property<Cells>> {
        vec![Property::always("exclusion", |_, s: &Vec<u8>| {
            s.chunks(2).all(|pair| !pair.iter().all(|p| *p == 2 || *p == 3))
        })]
    }
}

/// The cell's pair holds no resource that it needs.
fn may(state: &[u8], c: usize) -> bool {
    let Some(other) = state.get(c ^ 1).copied() else { return true };
    state[c] != 1 || !(other == 2 || other == 3)
}

/// Both cells of a pair would take the resource.
fn both(state: &[u8], set: u32, c: usize) -> bool {
    set >> (c - 1) & 3 == 3 && state[c] == 1 && state[c - 1] == 1
}

/// The number of states, if all were visited in time.
pub fn search(count: usize, one: bool, time: Duration) -> Option<usize> {
    let checker = Cells { count, one }
        .checker()
        .timeout(time)
        .threads(1)
        .finish_when(HasDiscoveries::All)
        .spawn_bfs()
        .join();
    (checker.discoveries().is_empty() && checker.is_done()).then(|| checker.unique_state_count())
}
