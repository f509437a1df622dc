//! A transition system of bits, as an and-inverter graph.
//!
//! `crate::system` builds it from a chart's equations; the engines of this directory (bounded
//! search, induction, PDR) answer questions about it and read nothing else. Each node but
//! inputs and latches has its operands among the nodes before it, so one pass in the order
//! of the numbers evaluates all.

use std::collections::HashMap;
use std::ops::Not;

/// The value of a node or its negation: node * 2, and 1 more if it is negated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Signal(u32);

impl Signal {
    /// Always 0.
    pub const FALSE: Signal = Signal(0);
    /// Always 1.
    pub const TRUE: Signal = Signal(1);

    /// The value of a node, or its negation.
    pub fn of(node: u32, negated: bool) -> Signal {
        Signal(node * 2 + u32::from(negated))
    }

    /// The node.
    pub fn node(self) -> u32 {
        self.0 / 2
    }

    /// True for the negation of the node's value.
    pub fn is_negated(self) -> bool {
        self.0 & 1 != 0
    }

    /// node * 2, and 1 more if it is negated, as in the AIGER format.
    pub fn code(self) -> u32 {
        self.0
    }

    /// The value that it always has, if it is a constant.
    pub fn constant(self) -> Option<bool> {
        (self.node() == 0).then_some(self.is_negated())
    }

    /// The signal, negated if `negate` is set.
    pub fn negated_if(self, negate: bool) -> Signal {
        Signal(self.0 ^ u32::from(negate))
    }
}

impl Not for Signal {
    type Output = Signal;
    fn not(self) -> Signal {
        Signal(self.0 ^ 1)
    }
}

impl From<bool> for Signal {
    fn from(value: bool) -> Signal {
        Signal(u32::from(value))
    }
}

/// The kind of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Node {
    /// Node 0: the value 0.
    False,
    /// An input, by its place in [`System::inputs`].
    Input(u32),
    /// A latch, by its place in [`System::latches`].
    Latch(u32),
    /// 1 if both are 1.
    And(Signal, Signal),
}

/// An and-inverter graph in which no two nodes are the same conjunction.
#[derive(Clone, Debug)]
pub struct Graph {
    nodes: Vec<Node>,
    known: HashMap<(Signal, Signal), Signal>,
    inputs: u32,
    latches: u32,
}

impl Default for Graph {
    fn default() -> Graph {
        Graph { nodes: vec![Node::False], known: HashMap::new(), inputs: 0, latches: 0 }
    }
}

impl Graph {
    /// All nodes, by number. Operands stand before the nodes that use them.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// The kind of a signal's node.
    pub fn node(&self, s: Signal) -> Node {
        self.nodes.get(s.node() as usize).copied().unwrap_or(Node::False)
    }

    fn add(&mut self, node: Node) -> Signal {
        self.nodes.push(node);
        Signal::of(self.nodes.len() as u32 - 1, false)
    }

    /// A new input; [`System::input`] registers it.
    fn input(&mut self) -> Signal {
        self.inputs += 1;
        self.add(Node::Input(self.inputs - 1))
    }

    /// A new latch; [`System::latch`] registers it.
    fn latch(&mut self) -> Signal {
        self.latches += 1;
        self.add(Node::Latch(self.latches - 1))
    }

    /// 1 if both are 1.
    pub fn and(&mut self, a: Signal, b: Signal) -> Signal {
        let (a, b) = if a <= b { (a, b) } else { (b, a) };
        if a == Signal::FALSE || a == !b {
            return Signal::FALSE;
        }
        if a == Signal::TRUE || a == b {
            return b;
        }
        if let Some(found) = self.shorter(a, b).or_else(|| self.shorter(b, a)) {
            return found;
        }
        if let Some(found) = self.known.get(&(a, b)) {
            return *found;
        }
        let new = self.add(Node::And(a, b));
        self.known.insert((a, b), new);
        new
    }

    /// A shorter form of `a and b`, where the operands of `b` allow one.
    fn shorter(&mut self, a: Signal, b: Signal) -> Option<Signal> {
        let Node::And(c, d) = self.node(b) else { return None };
        if !b.is_negated() {
            if a == c || a == d {
                return Some(b);
            }
            if a == !c || a == !d {
                return Some(Signal::FALSE);
            }
            if let (Node::And(e, f), false) = (self.node(a), a.is_negated())
                && (e == !c || e == !d || f == !c || f == !d)
            {
                return Some(Signal::FALSE);
            }
            return None;
        }
        if a == !c || a == !d {
            return Some(a);
        }
        // a and not (a and d) = a and not d
        if a == c {
            return Some(self.and(a, !d));
        }
        if a == d {
            return Some(self.and(a, !c));
        }
        None
    }

    /// 1 if one of both is 1.
    pub fn or(&mut self, a: Signal, b: Signal) -> Signal {
        !self.and(!a, !b)
    }

    /// 1 if the two differ.
    pub fn xor(&mut self, a: Signal, b: Signal) -> Signal {
        let negate = a.is_negated() != b.is_negated();
        let (a, b) = (Signal::of(a.node(), false), Signal::of(b.node(), false));
        let (first, second) = (self.and(a, !b), self.and(!a, b));
        self.or(first, second).negated_if(negate)
    }

    /// 1 if the two agree.
    pub fn equal(&mut self, a: Signal, b: Signal) -> Signal {
        !self.xor(a, b)
    }

    /// 0 only if `a` is 1 and `b` is 0.
    pub fn implies(&mut self, a: Signal, b: Signal) -> Signal {
        !self.and(a, !b)
    }

    /// `then` where the condition is 1, else `other`.
    pub fn mux(&mut self, condition: Signal, then: Signal, other: Signal) -> Signal {
        if then == other {
            return then;
        }
        if then == !other {
            return self.equal(condition, then);
        }
        let (first, second) = (self.and(condition, then), self.and(!condition, other));
        self.or(first, second)
    }

    /// 1 if all are 1; so without any.
    pub fn all(&mut self, signals: impl IntoIterator<Item = Signal>) -> Signal {
        let mut list: Vec<Signal> = signals.into_iter().collect();
        list.sort_unstable();
        list.dedup();
        // In pairs, so that the graph stays flat.
        while list.len() > 1 {
            list =
                list.chunks(2).map(|pair| pair.iter().fold(Signal::TRUE, |a, b| self.and(a, *b))).collect();
        }
        list.first().copied().unwrap_or(Signal::TRUE)
    }

    /// 1 if any is 1; 0 without any.
    pub fn any(&mut self, signals: impl IntoIterator<Item = Signal>) -> Signal {
        !self.all(signals.into_iter().map(|s| !s))
    }
}

/// The value of a latch at the first step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Init {
    /// 0.
    Zero,
    /// 1.
    One,
    /// Either.
    Free,
}

impl Init {
    /// The value, if it is given.
    pub fn value(self) -> Option<bool> {
        match self {
            Init::Zero => Some(false),
            Init::One => Some(true),
            Init::Free => None,
        }
    }
}

impl From<bool> for Init {
    fn from(value: bool) -> Init {
        if value { Init::One } else { Init::Zero }
    }
}

/// A bit that is kept from one step to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Latch {
    /// Its value in this step.
    pub signal: Signal,
    /// Its value in the first step.
    pub init: Init,
    /// Its value in the next step, over latches and inputs of this one.
    pub next: Signal,
}

/// A transition system: one step is one scan.
///
/// At each step the latches have their values, the inputs take any for which all constraints
/// are 1; then the latches take their next values. A run ends where no inputs satisfy the
/// constraints. A bad signal is reached if it is 1 at a step of some run, with the inputs of
/// that step.
#[derive(Clone, Debug, Default)]
pub struct System {
    /// The functions of inputs and latches.
    pub graph: Graph,
    /// The latches.
    pub latches: Vec<Latch>,
    /// The inputs.
    pub inputs: Vec<Signal>,
    /// 1 at each step of a run, the last included.
    pub constraints: Vec<Signal>,
    /// Each asked for by itself: can it be 1?
    pub bad: Vec<Signal>,
}

impl System {
    /// A new input.
    pub fn input(&mut self) -> Signal {
        let signal = self.graph.input();
        self.inputs.push(signal);
        signal
    }

    /// A new latch, which keeps its value until [`System::set_next`] says otherwise.
    pub fn latch(&mut self, init: Init) -> Signal {
        let signal = self.graph.latch();
        self.latches.push(Latch { signal, init, next: signal });
        signal
    }

    /// Gives a latch its next value. Signals that are no latch are left alone.
    pub fn set_next(&mut self, latch: Signal, next: Signal) {
        if let Node::Latch(place) = self.graph.node(latch)
            && let Some(row) = self.latches.get_mut(place as usize)
        {
            row.next = next.negated_if(latch.is_negated());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn constants_and_repetitions_fold() {
        let mut s = System::default();
        let (a, b) = (s.input(), s.input());
        let g = &mut s.graph;
        assert_eq!(g.and(a, Signal::TRUE), a);
        assert_eq!(g.and(Signal::FALSE, a), Signal::FALSE);
        assert_eq!(g.and(a, !a), Signal::FALSE);
        assert_eq!(g.or(a, !a), Signal::TRUE);
        let ab = g.and(a, b);
        assert_eq!(g.and(b, a), ab);
        assert_eq!(g.and(ab, a), ab);
        assert_eq!(g.and(ab, !b), Signal::FALSE);
        assert_eq!(g.and(!a, !ab), !a);
        assert_eq!(g.and(a, !ab), g.and(a, !b));
        assert_eq!(g.xor(a, a), Signal::FALSE);
        assert_eq!(g.equal(a, !a), Signal::FALSE);
        assert_eq!(g.xor(!a, b), !g.xor(a, b));
        assert_eq!(g.mux(a, b, b), b);
        assert_eq!(g.mux(Signal::TRUE, a, b), a);
        assert_eq!(g.mux(a, Signal::TRUE, Signal::FALSE), a);
        assert_eq!(g.all([]), Signal::TRUE);
        assert_eq!(g.any([]), Signal::FALSE);
    }
}
