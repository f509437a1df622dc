//! All the equations of a chart together, and what is asked of them.

use std::collections::{BTreeSet, HashMap};

use crate::form::{Expr, Memory, MemoryId, Section, Stmt, What};

/// How the equations keep step times.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StepTimes {
    /// A clock for each step whose time something reads.
    #[default]
    Read,
    /// A clock for each step.
    All,
    /// A stamp for each step ([`What::Stamp`]), which costs nothing in a scan that does not
    /// change the step. Memories then hold an absolute time, so states cannot be compared.
    Stamps,
}

/// Options: additions to the equations beyond the needs of the chart.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// Step times.
    pub times: StepTimes,
    /// Stored actions of one pass that give a memory different values are noted.
    pub conflicts: bool,
    /// Each receptivity has a memory of its own (DOLOG80).
    pub receptivities: bool,
    /// Actions that run are noted.
    pub runs: bool,
}

/// One scan of a chart.
#[derive(Clone, Debug, Default)]
pub struct Equations {
    /// All memories.
    pub memories: Vec<Memory>,
    /// Once a scan, before the evolution.
    pub begin: Vec<Section>,
    /// The evolution.
    pub pass: Vec<Section>,
    /// Under search for stability: passes go on while this memory is TRUE, at
    /// most so many.
    pub search: Option<(MemoryId, u32)>,
    /// Once a scan, behind the evolution.
    pub finish: Vec<Section>,
    /// The queries of the compiled chart: statements, then the value.
    pub questions: Vec<(Vec<Stmt>, Expr)>,
    /// Outputs with the words that they take after a fault.
    pub safe: Vec<(MemoryId, Box<[u64]>)>,
}

impl Equations {
    /// A memory.
    pub fn memory(&self, id: MemoryId) -> Option<&Memory> {
        self.memories.get(id.0 as usize)
    }

    /// The memory of something, where it has one.
    pub fn find(&self, what: What) -> Option<MemoryId> {
        let at = self.memories.iter().position(|m| m.what == what)?;
        Some(MemoryId(at as u32))
    }

    /// The memories by what they stand for, for those who look for many of them.
    pub fn by_meaning(&self) -> HashMap<What, MemoryId> {
        let mut found = HashMap::with_capacity(self.memories.len());
        for (id, memory) in (0..).map(MemoryId).zip(&self.memories) {
            found.entry(memory.what).or_insert(id);
        }
        found
    }

    /// All sections in their order.
    pub fn sections(&self) -> impl Iterator<Item = &Section> {
        self.begin.iter().chain(&self.pass).chain(&self.finish)
    }

    /// The memories that some statement reads or writes.
    pub fn used(&self) -> BTreeSet<MemoryId> {
        let mut used = BTreeSet::new();
        for s in self.sections().flat_map(|s| &s.body) {
            s.visit(&mut |s| {
                match s {
                    Stmt::Set(m, _) | Stmt::SetElement(m, _, _) => drop(used.insert(*m)),
                    Stmt::Call(_, list) => used.extend(list),
                    _ => {}
                }
                s.expressions(&mut |e| {
                    e.visit(&mut |e| {
                        if let Expr::Read(m) | Expr::Element(m, _) = e {
                            used.insert(*m);
                        }
                    });
                });
            });
        }
        used
    }
}
