//! Makes random charts with forks, joins, alternatives, loops and jumps. The tests of the layout
//! and its benchmark (`benches/src/bin/layout.rs`) share this file.

use std::fmt::Write as _;

use g7_model::{Document, FileId};

/// A pseudo-random generator: the same seed gives the same numbers.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % n.max(1)
    }
}

/// A chart under construction.
struct Maker {
    random: Random,
    steps: usize,
    links: String,
}

impl Maker {
    fn step(&mut self) -> usize {
        self.steps += 1;
        self.steps - 1
    }

    fn link(&mut self, from: &[usize], to: &[usize]) {
        let list = |steps: &[usize]| {
            let all: Vec<String> = steps.iter().map(ToString::to_string).collect();
            if all.len() == 1 { all.concat() } else { format!("({})", all.join(", ")) }
        };
        let _ = writeln!(self.links, "  {} -> {} when TRUE", list(from), list(to));
    }

    /// Adds a sequence with branches; returns its first and last step.
    fn sequence(&mut self, depth: usize, size: usize) -> (usize, usize) {
        let first = self.step();
        let (mut last, mut used) = (first, 1);
        while used < size {
            let count = 2 + self.random.below(3);
            let each = ((size - used) / count).min(4 + self.random.below(10));
            match self.random.below(8) {
                0 if depth < 4 && size - used > 6 => {
                    let ends: Vec<_> = (0..count).map(|_| self.sequence(depth + 1, each.max(1))).collect();
                    let (heads, tails): (Vec<_>, Vec<_>) = ends.into_iter().unzip();
                    self.link(&[last], &heads);
                    let next = self.step();
                    self.link(&tails, &[next]);
                    last = next;
                    used += each * count + 1;
                }
                1 if depth < 4 && size - used > 6 => {
                    let next = self.step();
                    for _ in 0..count {
                        if self.random.below(5) == 0 {
                            self.link(&[last], &[next]);
                            continue;
                        }
                        let (head, tail) = self.sequence(depth + 1, each.max(1));
                        self.link(&[last], &[head]);
                        self.link(&[tail], &[next]);
                    }
                    last = next;
                    used += each * count + 1;
                }
                2 if self.random.below(3) == 0 => {
                    // A link back to the start of this sequence.
                    self.link(&[last], &[first]);
                    used += 1;
                }
                _ => {
                    let next = self.step();
                    self.link(&[last], &[next]);
                    last = next;
                    used += 1;
                }
            }
        }
        (first, last)
    }
}

/// A chart of `size` steps with `jumps` links between arbitrary steps; its sequences, of at most
/// `piece` steps each, follow one another in one loop.
pub(crate) fn random_chart(seed: u64, size: usize, jumps: usize, piece: usize) -> Document {
    let mut m = Maker { random: Random(seed), steps: 0, links: String::new() };
    let (first, mut last) = m.sequence(0, size.min(piece));
    while m.steps < size {
        let (a, b) = m.sequence(0, (size - m.steps).min(piece));
        m.link(&[last], &[a]);
        last = b;
    }
    m.link(&[last], &[first]);
    for _ in 0..jumps {
        let (a, b) = (m.random.below(m.steps), m.random.below(m.steps));
        m.link(&[a], &[b]);
    }
    let mut text = String::from("chart G {\n");
    for n in 0..m.steps {
        let initial = if n == 0 || m.random.below(40) == 0 { "initial " } else { "" };
        let _ = writeln!(text, "  {initial}step {n}");
    }
    text.push_str(&m.links);
    text.push_str("}\n");
    let (document, problems) = g7_syntax::parse(&text, FileId(0));
    assert!(problems.is_empty(), "{problems:?}");
    document
}
