//! A chart as sequences of symbols with branches beside one another: the result of the
//! series-parallel reduction and the input of the placement.

/// One piece of a sequence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Item {
    /// A step or transition.
    Node(u32),
    /// A group of branches beside one another, by index.
    Par(u32),
    /// A return to a step further up, by index.
    Return(u32),
    /// The start of a broken link.
    Leave(u32),
    /// The end of a broken link.
    Arrive(u32),
}

/// A sequence of items, linked through [`Tree::next`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Chain {
    /// The first item, if there is one.
    pub(crate) first: Option<u32>,
    /// The last item, if there is one.
    pub(crate) last: Option<u32>,
    /// The number of symbols below one another.
    pub(crate) rows: u32,
}

impl Chain {
    /// A sequence without items.
    pub(crate) const EMPTY: Chain = Chain { first: None, last: None, rows: 0 };

    /// True if there is no item.
    pub(crate) fn is_empty(&self) -> bool {
        self.first.is_none()
    }
}

/// A sequence between two nodes, or one that hangs at a single node.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Branch {
    /// Its items.
    pub(crate) chain: Chain,
    /// The link by which it begins, if it hangs at a node above.
    pub(crate) first: Option<u32>,
    /// The link by which it ends, if it leads to a node below.
    pub(crate) last: Option<u32>,
}

/// A group of branches beside one another.
#[derive(Debug, Default)]
pub(crate) struct Par {
    /// The branches, from left to right once they are sorted.
    pub(crate) branches: Vec<Branch>,
    /// True if the branches begin by themselves, without a common link above.
    pub(crate) top_open: bool,
    /// True if the branches end by themselves, without a common link below.
    pub(crate) end_open: bool,
}

/// Links that return to one step and meet on their way.
#[derive(Debug)]
pub(crate) struct Return {
    /// The step to which they return.
    pub(crate) target: u32,
    /// The links.
    pub(crate) links: Vec<u32>,
}

/// The whole chart as a tree.
#[derive(Debug, Default)]
pub(crate) struct Tree {
    /// All items of all sequences.
    pub(crate) items: Vec<Item>,
    /// For each item the one that follows it in its sequence.
    pub(crate) next: Vec<Option<u32>>,
    /// All groups of branches.
    pub(crate) pars: Vec<Par>,
    /// All returns.
    pub(crate) returns: Vec<Return>,
    /// For each node the sequences that leave it beside its main one and end by themselves.
    pub(crate) below: Vec<Vec<Branch>>,
    /// For each node the sequences that begin by themselves and enter it beside its main one.
    pub(crate) above: Vec<Vec<Branch>>,
    /// The broken links that arrive at each step.
    pub(crate) arrivals: Vec<Vec<u32>>,
    /// The links that had to be broken, in any order.
    pub(crate) cuts: Vec<u32>,
    /// The outermost sequences: one for each part that no link connects to the rest.
    pub(crate) roots: Vec<Chain>,
}

impl Tree {
    /// An empty tree for this number of nodes.
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
        self.next.push(None);
        let rows = match item {
            Item::Node(_) => 1,
            Item::Par(p) => self.pars[p as usize].branches.iter().map(|b| b.chain.rows).max().unwrap_or(0),
            Item::Return(_) | Item::Leave(_) | Item::Arrive(_) => 0,
        };
        Chain { first: Some(n), last: Some(n), rows }
    }

    /// Joins two sequences, `b` after `a`.
    pub(crate) fn join(&mut self, a: Chain, b: Chain) -> Chain {
        let Some(end) = a.last else { return b };
        if b.is_empty() {
            return a;
        }
        self.next[end as usize] = b.first;
        Chain { first: a.first, last: b.last, rows: a.rows.saturating_add(b.rows) }
    }

    /// A sequence whose only item is a group of branches.
    pub(crate) fn par(&mut self, branches: Vec<Branch>, top_open: bool, end_open: bool) -> Chain {
        let n = self.pars.len() as u32;
        self.pars.push(Par { branches, top_open, end_open });
        self.one(Item::Par(n))
    }

    /// A sequence whose only item is a return.
    pub(crate) fn back(&mut self, target: u32, links: Vec<u32>) -> Chain {
        let n = self.returns.len() as u32;
        self.returns.push(Return { target, links });
        self.one(Item::Return(n))
    }

    /// The last item of a sequence.
    pub(crate) fn last(&self, c: Chain) -> Option<Item> {
        c.last.and_then(|n| self.items.get(n as usize).copied())
    }

    /// The items of a sequence, from first to last.
    pub(crate) fn walk(&self, c: Chain) -> impl Iterator<Item = Item> + '_ {
        let next = |n: &u32| self.next.get(*n as usize).copied().flatten();
        std::iter::successors(c.first, next).map(|n| self.items[n as usize])
    }
}
