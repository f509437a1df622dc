//! A chart as sequences of symbols with branches beside one another: what the
//! series-parallel reduction makes of the graph and the placing reads.

/// No item, no link.
pub(crate) const NONE: u32 = u32::MAX;

/// A piece of a sequence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Item {
    /// A step or transition.
    Node(u32),
    /// Branches beside one another, by index.
    Par(u32),
    /// A way back up, by index.
    Return(u32),
    /// A link that is broken off here.
    Leave(u32),
    /// A link that goes on here.
    Arrive(u32),
}

/// A sequence of items, linked through [`Tree::next`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Chain {
    /// The first item, [`NONE`] if there is none.
    pub(crate) first: u32,
    /// The last item.
    pub(crate) last: u32,
    /// How many symbols stand one below the other.
    pub(crate) rows: u32,
}

impl Chain {
    /// Without items.
    pub(crate) const EMPTY: Chain = Chain { first: NONE, last: NONE, rows: 0 };

    /// Whether there is no item.
    pub(crate) fn is_empty(&self) -> bool {
        self.first == NONE
    }
}

/// A sequence that hangs between two nodes or at one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Branch {
    /// What is in it.
    pub(crate) chain: Chain,
    /// The link by which it begins, or [`NONE`].
    pub(crate) first: u32,
    /// The link by which it ends, or [`NONE`].
    pub(crate) last: u32,
}

/// Branches beside one another.
#[derive(Debug, Default)]
pub(crate) struct Par {
    /// From left to right, once sorted.
    pub(crate) branches: Vec<Branch>,
    /// They begin by themselves.
    pub(crate) top_open: bool,
    /// They end by themselves.
    pub(crate) end_open: bool,
}

/// Links that lead back to one step and meet before they do.
#[derive(Debug)]
pub(crate) struct Return {
    /// The step.
    pub(crate) target: u32,
    /// The links.
    pub(crate) links: Vec<u32>,
}

/// The chart taken to pieces.
#[derive(Debug, Default)]
pub(crate) struct Tree {
    /// All items.
    pub(crate) items: Vec<Item>,
    /// The item behind each.
    pub(crate) next: Vec<u32>,
    /// All groups of branches.
    pub(crate) pars: Vec<Par>,
    /// All ways back.
    pub(crate) returns: Vec<Return>,
    /// Sequences that leave a node beside its main one and end by themselves.
    pub(crate) below: Vec<Vec<Branch>>,
    /// Sequences that begin by themselves and enter a node beside its main one.
    pub(crate) above: Vec<Vec<Branch>>,
    /// Broken links that arrive at each step.
    pub(crate) arrivals: Vec<Vec<u32>>,
    /// The links that had to be broken, in any order.
    pub(crate) cuts: Vec<u32>,
    /// The sequences that nothing connects.
    pub(crate) roots: Vec<Chain>,
}

impl Tree {
    /// Without anything, for so many nodes.
    pub(crate) fn new(nodes: usize) -> Tree {
        Tree {
            below: vec![Vec::new(); nodes],
            above: vec![Vec::new(); nodes],
            arrivals: vec![Vec::new(); nodes],
            ..Tree::default()
        }
    }

    /// A sequence of one item.
    pub(crate) fn one(&mut self, item: Item) -> Chain {
        let n = self.items.len() as u32;
        self.items.push(item);
        self.next.push(NONE);
        let rows = match item {
            Item::Node(_) => 1,
            Item::Par(p) => self.pars[p as usize].branches.iter().map(|b| b.chain.rows).max().unwrap_or(0),
            Item::Return(_) | Item::Leave(_) | Item::Arrive(_) => 0,
        };
        Chain { first: n, last: n, rows }
    }

    /// Two sequences, one behind the other.
    pub(crate) fn join(&mut self, a: Chain, b: Chain) -> Chain {
        if a.is_empty() {
            return b;
        }
        if b.is_empty() {
            return a;
        }
        self.next[a.last as usize] = b.first;
        Chain { first: a.first, last: b.last, rows: a.rows.saturating_add(b.rows) }
    }

    /// Branches as one item.
    pub(crate) fn par(&mut self, branches: Vec<Branch>, top_open: bool, end_open: bool) -> Chain {
        let n = self.pars.len() as u32;
        self.pars.push(Par { branches, top_open, end_open });
        self.one(Item::Par(n))
    }

    /// A way back as one item.
    pub(crate) fn back(&mut self, target: u32, links: Vec<u32>) -> Chain {
        let n = self.returns.len() as u32;
        self.returns.push(Return { target, links });
        self.one(Item::Return(n))
    }

    /// The item at the end of a sequence.
    pub(crate) fn last(&self, c: Chain) -> Option<Item> {
        self.items.get(c.last as usize).copied()
    }

    /// The items of a sequence, first to last.
    pub(crate) fn walk(&self, c: Chain) -> impl Iterator<Item = Item> + '_ {
        let next = |n: &u32| self.next.get(*n as usize).copied().filter(|n| *n != NONE);
        let first = Some(c.first).filter(|n| *n != NONE);
        std::iter::successors(first, next).map(|n| self.items[n as usize])
    }
}
