//! The functions of a system as decision diagrams, limited to the care set: the states that satisfy the guesses.
//!
//! Outside the care set every function is 0, and so is its negation. Inside it both are exact, even if a guess is
//! wrong. The caller stops as soon as a state outside is reached.

use std::collections::BTreeMap;

use g7_sat::diagram::{Diagrams, Full, Function};

use super::order::Place;
use crate::sat::cone::Cube;
use crate::sat::graph::{Node, Signal, System};

/// The work ends early: the diagrams need too many nodes or levels, or the caller wants no more work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Stop;

impl From<Full> for Stop {
    fn from(_: Full) -> Stop {
        Stop
    }
}

/// Nodes of the graph between two looks at the clock.
const LOOK: usize = 64;

/// The functions of a system.
pub(super) struct Functions<'s> {
    pub(super) system: &'s System,
    pub(super) diagrams: Diagrams,
    stop: &'s (dyn Fn() -> bool + Sync),
    /// For each latch of the part its variable; the one behind it is that of its next value.
    pub(super) latches: BTreeMap<usize, u32>,
    pub(super) inputs: BTreeMap<usize, u32>,
    /// For each node that is needed its function.
    nodes: BTreeMap<u32, Function>,
    /// The states that satisfy the guesses.
    pub(super) thought: Function,
    /// The care set: these states, with the inputs that may be tried. The constraints of the system do not count here.
    care: Function,
}

impl<'s> Functions<'s> {
    /// Prepares variables in this order; no function is made yet. The guesses are that no state of the cubes `never` is
    /// reached. With `alone`, at most one input is 1 in a scan.
    pub(super) fn new(
        system: &'s System,
        order: &[Place],
        never: &[Cube],
        alone: bool,
        room: usize,
        stop: &'s (dyn Fn() -> bool + Sync),
    ) -> Result<Functions<'s>, Stop> {
        let (mut latches, mut inputs, mut count) = (BTreeMap::new(), BTreeMap::new(), 0);
        for place in order {
            match place {
                Place::Latch(l) => {
                    latches.insert(*l, count);
                    count += 2;
                }
                Place::Input(i) => {
                    inputs.insert(*i, count);
                    count += 1;
                }
            }
        }
        let diagrams = Diagrams::new(count, room);
        let all = diagrams.constant(true);
        let mut made = Functions {
            system,
            diagrams,
            stop,
            latches,
            inputs,
            nodes: BTreeMap::new(),
            thought: all.clone(),
            care: all,
        };
        for cube in never {
            made.thought = made.thought.without(&made.cube(cube)?)?;
        }
        made.care = made.thought.clone();
        if alone {
            made.care = made.care.and(&made.at_most_one()?)?;
        }
        Ok(made)
    }

    /// An error as soon as the caller wants no more work.
    pub(super) fn look(&self) -> Result<(), Stop> {
        if (self.stop)() {
            return Err(Stop);
        }
        self.diagrams.tidy();
        Ok(())
    }

    /// The states in which all of these latches have these values.
    pub(super) fn cube(&self, cube: &[Signal]) -> Result<Function, Stop> {
        let all = self.diagrams.constant(true);
        cube.iter().try_fold(all, |set, s| {
            let Node::Latch(l) = self.system.graph.node(*s) else { return Ok(set) };
            // A cube with a latch outside of the part says nothing about it.
            let Some(place) = self.latches.get(&(l as usize)) else {
                return Ok(self.diagrams.constant(false));
            };
            let variable = self.diagrams.variable(*place)?;
            Ok(if s.is_negated() { set.without(&variable)? } else { set.and(&variable)? })
        })
    }

    fn at_most_one(&self) -> Result<Function, Stop> {
        let (mut none, mut one) = (self.diagrams.constant(true), self.diagrams.constant(false));
        // From the last variable to the first, so that each diagram grows at its top.
        for place in self.inputs.values().rev() {
            let input = self.diagrams.variable(*place)?;
            one = input.choose(&none, &one)?;
            none = none.without(&input)?;
        }
        Ok(none.or(&one)?)
    }

    /// Makes the functions of all nodes `inside`. A function is dropped after its last use, except those of the roots.
    pub(super) fn make(&mut self, inside: &[bool], roots: impl Iterator<Item = Signal>) -> Result<(), Stop> {
        let nodes = self.system.graph.nodes();
        let mut uses = vec![0usize; nodes.len()];
        let mut read = |s: &Signal| uses.get_mut(s.node() as usize).into_iter().for_each(|n| *n += 1);
        roots.for_each(|s| read(&s));
        for (_, node) in nodes.iter().enumerate().filter(|(k, _)| inside.get(*k) == Some(&true)) {
            if let Node::And(a, b) = node {
                read(a);
                read(b);
            }
        }
        for (k, node) in (0u32..).zip(nodes).filter(|(k, _)| inside.get(*k as usize) == Some(&true)) {
            let made = match node {
                Node::False => self.diagrams.constant(false),
                Node::Input(i) => self.own(self.inputs.get(&(*i as usize)))?,
                Node::Latch(l) => self.own(self.latches.get(&(*l as usize)))?,
                Node::And(a, b) => {
                    let made = self.both(*a, *b)?;
                    for s in [a, b] {
                        if let Some(n) = uses.get_mut(s.node() as usize) {
                            *n -= 1;
                            if *n == 0 {
                                self.nodes.remove(&s.node());
                            }
                        }
                    }
                    made
                }
            };
            self.nodes.insert(k, made);
            if (k as usize).is_multiple_of(LOOK) {
                self.look()?;
            }
        }
        Ok(())
    }

    /// The variable of a latch or an input, where it matters.
    fn own(&self, place: Option<&u32>) -> Result<Function, Stop> {
        match place {
            Some(place) => Ok(self.diagrams.variable(*place)?.and(&self.care)?),
            None => Ok(self.diagrams.constant(false)),
        }
    }

    fn both(&self, a: Signal, b: Signal) -> Result<Function, Stop> {
        let (f, g) = (self.plain(a), self.plain(b));
        Ok(match (a.is_negated(), b.is_negated()) {
            (false, false) => f.and(&g)?,
            (true, false) => g.without(&f)?,
            (false, true) => f.without(&g)?,
            (true, true) => self.care.without(&f.or(&g)?)?,
        })
    }

    /// The function of a signal's node.
    fn plain(&self, s: Signal) -> Function {
        self.nodes.get(&s.node()).cloned().unwrap_or_else(|| self.diagrams.constant(false))
    }

    /// The function of a root: states with inputs in which it is 1.
    pub(super) fn get(&self, s: Signal) -> Result<Function, Stop> {
        let plain = self.plain(s);
        Ok(if s.is_negated() { self.care.without(&plain)? } else { plain })
    }

    /// All constraints at once, where it matters.
    pub(super) fn valid(&self) -> Result<Function, Stop> {
        self.system.constraints.iter().try_fold(self.care.clone(), |all, c| Ok(all.and(&self.get(*c)?)?))
    }

    /// The conjunction of some variables, as a list of them.
    pub(super) fn list(&self, variables: impl DoubleEndedIterator<Item = u32>) -> Result<Function, Stop> {
        let none = self.diagrams.constant(true);
        variables.rev().try_fold(none, |list, v| Ok(self.diagrams.variable(v)?.and(&list)?))
    }
}
