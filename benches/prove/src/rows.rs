//! The rows of the table: a chart, what is asked of it, and the models of it for others.

use g7_verify::{Claim, Tried};

use crate::charts;

/// The layers that a row measures.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Layers {
    /// The solver alone, beside others that solve.
    Solver,
    /// All that `g7 prove` has.
    All,
}

/// The search that visits the states.
#[derive(Clone, Copy)]
pub enum By {
    /// The engine, scan by scan.
    Engine,
    /// The system of bits, state by state, by so many threads.
    Bits(usize),
    /// The system of bits, as sets.
    Sets,
}

/// The thing that is measured.
pub enum Task {
    /// All states of so many cells are visited.
    States { cells: usize, tried: Tried, by: By },
    /// Some of the questions of a chart are answered.
    Claims { text: String, layers: Layers, wants: fn(&Claim) -> bool },
    /// Two charts are compared, as `g7 compare` does.
    Compare([String; 2]),
}

/// A row with its name.
pub struct Row {
    pub name: &'static str,
    pub task: Task,
}

/// All rows, in their order.
pub fn rows() -> Vec<Row> {
    let states = |name, cells, tried, by| Row { name, task: Task::States { cells, tried, by } };
    let claims = |name, text, layers, wants| Row { name, task: Task::Claims { text, layers, wants } };
    let own = |name, text| claims(name, text, Layers::Solver, |c| c.is_own());
    let ends = |name, count, endless| {
        let text = charts::transients(count, endless);
        claims(name, text, Layers::Solver, |c| *c == Claim::NoInstability)
    };
    let timers = |name, ticks| claims(name, charts::timers(ticks), Layers::All, |c| c.is_own());
    let compare = |name, count| Row {
        name,
        task: Task::Compare([charts::cells(count, "iec61131"), charts::renumbered(count)]),
    };
    vec![
        states("states: P = 8, one input at a time", 8, Tried::One, By::Sets),
        states("states: P = 10, one input at a time", 10, Tried::One, By::Sets),
        states("states: P = 10, one input at a time, one by one", 10, Tried::One, By::Bits(1)),
        states("states: P = 10, one input at a time, one by one, 2 threads", 10, Tried::One, By::Bits(2)),
        states("states: P = 10, one input at a time, by the engine", 10, Tried::One, By::Engine),
        states("states: P = 11, one input at a time", 11, Tried::One, By::Sets),
        states("states: P = 8, any inputs at once", 8, Tried::Classes, By::Sets),
        states("states: P = 10, any inputs at once", 10, Tried::Classes, By::Sets),
        states("states: P = 50, any inputs at once", 50, Tried::Classes, By::Sets),
        own("mutual exclusion, P = 10", charts::cells(10, "iec61131")),
        own("mutual exclusion, P = 50", charts::cells(50, "iec61131")),
        own("no deadlock, ring of 10", charts::ring(10)),
        own("no deadlock, ring of 50", charts::ring(50)),
        own("equivalence in one file, 10 cells", charts::equal(10)),
        own("equivalence in one file, 50 cells", charts::equal(50)),
        compare("`g7 compare`, two charts of 10 cells", 10),
        compare("`g7 compare`, two charts of 50 cells", 50),
        ends("transients end, 10", 10, false),
        ends("transients end, 20", 20, false),
        ends("endless transient found, 10", 10, true),
        ends("endless transient found, 20", 20, true),
        timers("two timers, D = 10", 10),
        timers("two timers, D = 100", 100),
        timers("two timers, D = 1000", 1000),
        timers("two timers, D = 10000", 10_000),
    ]
}
