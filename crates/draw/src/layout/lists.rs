//! Lists of numbers, one for each node of the graph.

/// A list of numbers for each node, stored as one array.
#[derive(Debug, Default)]
pub(crate) struct Lists {
    starts: Vec<u32>,
    all: Vec<u32>,
}

impl Lists {
    /// The places at which each node occurs in `of`.
    #[inline(never)]
    pub(crate) fn new(count: usize, of: impl Iterator<Item = u32> + Clone) -> Lists {
        let mut starts = vec![0u32; count + 1];
        of.clone().for_each(|n| starts[n as usize + 1] += 1);
        for k in 0..count {
            starts[k + 1] += starts[k];
        }
        let mut next = starts.clone();
        let mut all = vec![0; starts[count] as usize];
        for (item, n) in (0..).zip(of) {
            let at = &mut next[n as usize];
            all[*at as usize] = item;
            *at += 1;
        }
        Lists { starts, all }
    }

    /// The list of one node.
    pub(crate) fn of(&self, n: u32) -> &[u32] {
        let (from, to) = (self.starts[n as usize] as usize, self.starts[n as usize + 1] as usize);
        &self.all[from..to]
    }
}
