//! Reduces the graph to a tree: a node with one link in and one link out becomes part of a longer
//! sequence, sequences between the same two nodes become branches, and a sequence that ends or
//! begins by itself hangs at its neighbour. If no rule applies, a link is broken that passes many
//! steps but holds few.

use std::collections::HashMap;

use crate::layout::graph::Graph;
use crate::layout::tree::{Branch, Chain, Item, Tree};

/// A link that skips more rows than this is broken instead of drawn.
const LONGEST_SKIP: u32 = 60;

/// A sequence from one node to another; it acts as one edge of the reduced graph.
#[derive(Clone, Copy, Debug)]
struct Edge {
    from: u32,
    to: u32,
    branch: Branch,
    live: bool,
}

/// A sequence that ends by itself; `back` says to which step its end returns, and by which links.
#[derive(Clone, Debug)]
struct Pendant {
    branch: Branch,
    back: Option<(u32, Vec<u32>)>,
}

struct Reduction<'a> {
    graph: &'a Graph,
    tree: Tree,
    edges: Vec<Edge>,
    out: Vec<Vec<u32>>,
    into: Vec<Vec<u32>>,
    outs: Vec<u32>,
    ins: Vec<u32>,
    between: HashMap<(u32, u32), u32>,
    below: Vec<Vec<Pendant>>,
    above: Vec<Vec<Branch>>,
    work: Vec<u32>,
    done: Vec<bool>,
    live: usize,
}

/// Reduces a graph; the links in `broken` are broken from the start.
#[inline(never)]
pub(crate) fn reduce(graph: &Graph, broken: &[bool]) -> Tree {
    let mut r = Reduction {
        graph,
        tree: Tree::new(graph.nodes),
        edges: Vec::with_capacity(graph.links.len() * 2),
        out: vec![Vec::new(); graph.nodes],
        into: vec![Vec::new(); graph.nodes],
        outs: vec![0; graph.nodes],
        ins: vec![0; graph.nodes],
        between: HashMap::with_capacity(graph.links.len()),
        below: vec![Vec::new(); graph.nodes],
        above: vec![Vec::new(); graph.nodes],
        work: Vec::new(),
        done: vec![false; graph.nodes],
        live: 0,
    };
    for (l, &(from, to)) in (0u32..).zip(&graph.links) {
        let at = l as usize;
        if broken[at] || graph.back[at] && graph.is_step(from) {
            let leave = r.leave(l);
            r.hang(from, Branch { chain: leave, first: Some(l), last: None });
            r.arrive(l, to);
        } else if graph.back[at] {
            let branch = Branch { chain: Chain::EMPTY, first: Some(l), last: None };
            r.below[from as usize].push(Pendant { branch, back: Some((to, vec![l])) });
        } else {
            r.add(from, to, Branch { chain: Chain::EMPTY, first: Some(l), last: Some(l) });
        }
    }
    r.work = (0..graph.nodes as u32).rev().collect();
    r.run();
    r.tree
}

impl Reduction<'_> {
    #[inline(never)]
    fn run(&mut self) {
        let mut ends = Vec::new();
        loop {
            while let Some(n) = self.work.pop() {
                match (self.ins[n as usize], self.outs[n as usize]) {
                    (1, 1) => self.series(n),
                    (0 | 1, 0) | (0, 1) => ends.push(n),
                    _ => {}
                }
            }
            if !ends.is_empty() {
                std::mem::take(&mut ends).into_iter().for_each(|n| self.end(n));
            } else if self.live == 0 {
                return;
            } else {
                self.cut();
            }
        }
    }

    #[inline(never)]
    fn add(&mut self, from: u32, to: u32, branch: Branch) {
        if let Some(&other) = self.between.get(&(from, to)).filter(|e| self.edges[**e as usize].live) {
            self.merge(other, branch);
            return;
        }
        let e = self.edges.len() as u32;
        self.edges.push(Edge { from, to, branch, live: true });
        self.between.insert((from, to), e);
        self.out[from as usize].push(e);
        self.into[to as usize].push(e);
        self.outs[from as usize] += 1;
        self.ins[to as usize] += 1;
        self.live += 1;
    }

    fn remove(&mut self, e: u32) -> Edge {
        let edge = &mut self.edges[e as usize];
        edge.live = false;
        self.outs[edge.from as usize] -= 1;
        self.ins[edge.to as usize] -= 1;
        self.live -= 1;
        *edge
    }

    /// Adds a second sequence between two nodes: both become branches.
    #[inline(never)]
    fn merge(&mut self, other: u32, branch: Branch) {
        let edge = self.edges[other as usize];
        let (from, to) = (edge.from, edge.to);
        let (a, b) = (edge.branch.chain.rows, branch.chain.rows);
        if self.graph.is_step(to) && a.min(b) <= 1 && a.max(b) > LONGEST_SKIP {
            let short = if a < b { edge.branch } else { branch };
            if a < b {
                self.edges[other as usize].branch = branch;
            }
            self.break_end(from, to, short);
            return;
        }
        let pars = [edge.branch, branch].map(|b| self.only_par(b.chain));
        let chain = match pars {
            [Some(p), None] => self.extend_par(p, vec![branch], edge.branch.chain),
            [None, Some(p)] => self.extend_par(p, vec![edge.branch], branch.chain),
            [Some(p), Some(q)] => {
                let more = std::mem::take(&mut self.tree.pars[q as usize].branches);
                self.extend_par(p, more, edge.branch.chain)
            }
            [None, None] => self.tree.par(vec![edge.branch, branch], false, false),
        };
        let first = edge.branch.first.min(branch.first);
        self.edges[other as usize].branch = Branch { chain, first, last: edge.branch.last.min(branch.last) };
    }

    fn only_par(&self, chain: Chain) -> Option<u32> {
        match self.tree.last(chain) {
            Some(Item::Par(p)) if chain.first == chain.last => {
                let par = &self.tree.pars[p as usize];
                Some(p).filter(|_| !par.top_open && !par.end_open)
            }
            _ => None,
        }
    }

    fn extend_par(&mut self, par: u32, more: Vec<Branch>, chain: Chain) -> Chain {
        let rows = more.iter().map(|b| b.chain.rows).max().unwrap_or(0).max(chain.rows);
        self.tree.pars[par as usize].branches.extend(more);
        Chain { rows, ..chain }
    }

    fn only(&mut self, n: u32, leaving: bool) -> Option<u32> {
        let edges = &self.edges;
        let list = if leaving { &mut self.out } else { &mut self.into };
        let list = &mut list[n as usize];
        list.retain(|e| edges[*e as usize].live);
        list.first().copied()
    }

    /// Joins a node that has one link in and one link out to its neighbours.
    #[inline(never)]
    fn series(&mut self, n: u32) {
        let (Some(a), Some(b)) = (self.only(n, false), self.only(n, true)) else { return };
        self.settle(n);
        self.done[n as usize] = true;
        let (a, b) = (self.remove(a), self.remove(b));
        let node = self.tree.one(Item::Node(n));
        let chain = self.tree.join(a.branch.chain, node);
        let chain = self.tree.join(chain, b.branch.chain);
        self.add(a.from, b.to, Branch { chain, first: a.branch.first, last: b.branch.last });
        self.work.extend([a.from, b.to]);
    }

    /// Handles a node that is the only beginning or end of the parts that hang at it.
    #[inline(never)]
    fn end(&mut self, n: u32) {
        let at = n as usize;
        let (ins, outs) = (self.ins[at], self.outs[at]);
        if self.done[at] || ins + outs > 1 {
            return;
        }
        self.done[at] = true;
        let head = if ins == 0 { self.close_above(n) } else { Chain::EMPTY };
        let (tail, back) = if outs == 0 { self.close_below(n) } else { (Chain::EMPTY, None) };
        self.settle(n);
        let node = self.tree.one(Item::Node(n));
        let chain = self.tree.join(head, node);
        let mut chain = self.tree.join(chain, tail);
        if outs == 1
            && let Some(e) = self.only(n, true)
        {
            let e = self.remove(e);
            chain = self.tree.join(chain, e.branch.chain);
            self.above[e.to as usize].push(Branch { chain, first: None, last: e.branch.last });
            self.work.push(e.to);
        } else if ins == 1
            && let Some(e) = self.only(n, false)
        {
            let e = self.remove(e);
            let chain = self.tree.join(e.branch.chain, chain);
            let branch = Branch { chain, first: e.branch.first, last: None };
            self.below[e.from as usize].push(Pendant { branch, back });
            self.work.push(e.from);
        } else {
            let tail = back.map_or(Chain::EMPTY, |(target, links)| self.tree.back(target, links));
            let chain = self.tree.join(chain, tail);
            self.tree.roots.push(chain);
        }
    }

    /// Hangs the remaining parts beside a node that has a main way on or in.
    fn settle(&mut self, n: u32) {
        let groups = self.groups(n, false);
        let closed: Vec<Branch> = groups.into_iter().map(|p| self.closed(p)).collect();
        self.tree.below[n as usize].extend(closed);
        let above = std::mem::take(&mut self.above[n as usize]);
        self.tree.above[n as usize].extend(above);
    }

    /// The branch of a pendant, with its return as the last item.
    fn closed(&mut self, p: Pendant) -> Branch {
        let Some((target, links)) = p.back else { return p.branch };
        let back = self.tree.back(target, links);
        Branch { chain: self.tree.join(p.branch.chain, back), ..p.branch }
    }

    /// The parts that hang below a node; sequences that return to the same step are merged.
    #[inline(never)]
    fn groups(&mut self, n: u32, whole: bool) -> Vec<Pendant> {
        let mut all = std::mem::take(&mut self.below[n as usize]);
        all.sort_by_key(|p| p.branch.first);
        let mut groups: Vec<Pendant> = Vec::with_capacity(all.len());
        let mut targets: Vec<u32> = all.iter().filter_map(|p| p.back.as_ref().map(|b| b.0)).collect();
        targets.sort_unstable();
        let several: Vec<u32> =
            targets.chunk_by(|a, b| a == b).filter(|c| c.len() > 1).map(|c| c[0]).collect();
        let mut met: Vec<(u32, Vec<Pendant>)> = several.iter().map(|t| (*t, Vec::new())).collect();
        for p in all {
            let place = p.back.as_ref().and_then(|b| several.binary_search(&b.0).ok());
            match place {
                Some(k) => met[k].1.push(p),
                None => groups.push(p),
            }
        }
        for (target, together) in met {
            let rows = |p: &Pendant| p.branch.chain.rows;
            let (low, high) =
                (together.iter().map(rows).min().unwrap_or(0), together.iter().map(rows).max().unwrap_or(0));
            // A short return beside a long sequence goes up by itself.
            if whole && together.len() == 2 && low * 3 < high {
                groups.extend(together);
                continue;
            }
            let first = together.first().and_then(|p| p.branch.first);
            let links = together.iter().flat_map(|p| p.back.iter().flat_map(|b| b.1.clone())).collect();
            let branches = together.into_iter().map(|p| p.branch).collect();
            let chain = self.tree.par(branches, false, false);
            let branch = Branch { chain, first, last: None };
            groups.push(Pendant { branch, back: Some((target, links)) });
        }
        groups.sort_by_key(|p| p.branch.first);
        groups
    }

    /// Everything that follows a node without another way on: one main sequence, or sequences of
    /// similar length side by side.
    #[inline(never)]
    fn close_below(&mut self, n: u32) -> (Chain, Option<(u32, Vec<u32>)>) {
        let mut groups = self.groups(n, true);
        let Some(most) = groups.iter().map(|p| p.branch.chain.rows).max() else {
            return (Chain::EMPTY, None);
        };
        if groups.len() == 1
            && let Some(only) = groups.pop()
        {
            return (only.branch.chain, only.back);
        }
        let least = groups.iter().map(|p| p.branch.chain.rows).min().unwrap_or(0);
        if least * 2 >= most || groups.len() > 6 {
            let branches = groups.into_iter().map(|p| self.closed(p)).collect();
            return (self.tree.par(branches, false, true), None);
        }
        let main = groups.iter().position(|p| p.branch.chain.rows == most).unwrap_or(0);
        let main = groups.remove(main);
        let sides: Vec<Branch> = groups.into_iter().map(|p| self.closed(p)).collect();
        self.tree.below[n as usize].extend(sides);
        (main.branch.chain, main.back)
    }

    /// Everything that precedes a node without another way in.
    #[inline(never)]
    fn close_above(&mut self, n: u32) -> Chain {
        let mut all = std::mem::take(&mut self.above[n as usize]);
        all.sort_by_key(|b| b.last);
        match all.len() {
            0 => Chain::EMPTY,
            1 => all[0].chain,
            _ => self.tree.par(all, true, false),
        }
    }

    fn leave(&mut self, l: u32) -> Chain {
        self.tree.cuts.push(l);
        self.tree.one(Item::Leave(l))
    }

    fn hang(&mut self, n: u32, branch: Branch) {
        self.below[n as usize].push(Pendant { branch, back: None });
    }

    fn arrive(&mut self, l: u32, to: u32) {
        if self.graph.is_step(to) {
            self.tree.arrivals[to as usize].push(l);
        } else {
            let chain = self.tree.one(Item::Arrive(l));
            self.above[to as usize].push(Branch { chain, first: None, last: Some(l) });
        }
    }

    /// Breaks links until the reduction can go on.
    #[inline(never)]
    fn cut(&mut self) {
        let mut found: Vec<(u64, u32)> = Vec::new();
        for e in 0..self.edges.len() as u32 {
            let edge = &self.edges[e as usize];
            if edge.live && self.outs[edge.from as usize] > 1 && self.ins[edge.to as usize] > 1 {
                found.push((self.worth(edge), e));
            }
        }
        let most = (found.len() / 128).max(1);
        found.sort_unstable_by_key(|(worth, e)| (std::cmp::Reverse(*worth), *e));
        for &(_, e) in found.iter().take(most) {
            let edge = self.edges[e as usize];
            if self.outs[edge.from as usize] > 1 && self.ins[edge.to as usize] > 1 {
                self.cut_edge(e);
            }
        }
        if found.is_empty() {
            // A graph without loops always has such a link, so this is never reached; any live edge
            // would do.
            if let Some(e) = (0..self.edges.len() as u32).find(|e| self.edges[*e as usize].live) {
                self.cut_edge(e);
            }
        }
    }

    /// The gain from breaking a sequence: the number of steps it skips in the text, divided by its
    /// length.
    #[inline(never)]
    fn worth(&self, e: &Edge) -> u64 {
        let span = u64::from(self.place(e.from).abs_diff(self.place(e.to))) + 1;
        let rows = u64::from(e.branch.chain.rows) + 1;
        let worth = span * 4096 / rows;
        let chain = e.branch.chain;
        let single = |item: Option<&Item>| !matches!(item, Some(Item::Par(_)));
        let item = |n: Option<u32>| n.and_then(|n| self.tree.items.get(n as usize));
        let last = single(item(chain.last));
        let first = single(item(chain.first));
        match (self.graph.is_step(e.from), self.graph.is_step(e.to)) {
            (_, true) if last => worth,
            (false, false) if first => worth,
            (true, false) if self.inner(chain).is_some() => worth,
            _ => worth / 1024,
        }
    }

    /// The position of a node in the text, as the number of a step.
    fn place(&self, n: u32) -> u32 {
        if self.graph.is_step(n) {
            return n;
        }
        let links = &self.graph.links;
        let before = self.graph.into.of(n).first().map(|l| links[*l as usize].0);
        let behind = || self.graph.out.of(n).first().map(|l| links[*l as usize].1);
        before.or_else(behind).unwrap_or(0)
    }

    /// If the chain begins with a transition and a step: the link between them.
    fn inner(&self, chain: Chain) -> Option<u32> {
        let first = chain.first?;
        let second = (*self.tree.next.get(first as usize)?)?;
        match (self.tree.items.get(first as usize)?, self.tree.items.get(second as usize)?) {
            (Item::Node(t), Item::Node(s)) => {
                let links = self.graph.out.of(*t).iter();
                links.copied().find(|l| self.graph.links[*l as usize].1 == *s)
            }
            _ => None,
        }
    }

    #[inline(never)]
    fn cut_edge(&mut self, e: u32) {
        let Edge { from, to, branch, .. } = self.remove(e);
        let chain = branch.chain;
        let head = chain.first.and_then(|n| Some((n, *self.tree.items.get(n as usize)?)));
        let inner = self.inner(chain);
        match (self.graph.is_step(from), self.graph.is_step(to), head, branch.first, inner) {
            // Both ends are transitions: break the link to the first step.
            (false, false, Some((_, Item::Node(s))), Some(first), _) => {
                let leave = self.leave(first);
                self.hang(from, Branch { chain: leave, first: Some(first), last: None });
                self.arrive(first, s);
                self.above[to as usize].push(Branch { first: None, ..branch });
            }
            (true, false, Some((head, _)), _, Some(l)) => {
                let second = self.tree.next[head as usize].take();
                let leave = self.leave(l);
                let short = Chain { last: chain.first, rows: 1, ..chain };
                let short = self.tree.join(short, leave);
                self.hang(from, Branch { chain: short, first: branch.first, last: None });
                self.arrive(l, self.graph.links[l as usize].1);
                let rest = Chain { first: second, rows: chain.rows.saturating_sub(1), ..chain };
                self.above[to as usize].push(Branch { chain: rest, first: None, last: branch.last });
            }
            _ => self.break_end(from, to, branch),
        }
        self.work.extend([from, to]);
    }

    /// Breaks a sequence before the node it leads to; each branch that ends there is broken too.
    #[inline(never)]
    fn break_end(&mut self, from: u32, to: u32, branch: Branch) {
        let mut open: Vec<u32> = Vec::new();
        let mut branch = branch;
        match self.tree.last(branch.chain) {
            Some(Item::Par(p)) => open.push(p),
            _ => branch = self.broken(branch, to),
        }
        self.hang(from, Branch { last: None, ..branch });
        while let Some(p) = open.pop() {
            self.tree.pars[p as usize].end_open = true;
            let mut branches = std::mem::take(&mut self.tree.pars[p as usize].branches);
            for b in &mut branches {
                match self.tree.last(b.chain) {
                    Some(Item::Par(q)) => open.push(q),
                    _ => *b = self.broken(*b, to),
                }
            }
            self.tree.pars[p as usize].branches = branches;
        }
        self.work.extend([from, to]);
    }

    fn broken(&mut self, b: Branch, to: u32) -> Branch {
        let Some(last) = b.last else { return b };
        let leave = self.leave(last);
        self.arrive(last, to);
        Branch { chain: self.tree.join(b.chain, leave), ..b }
    }
}
