//! The moves of a node, as far as a question asks what can still follow.

/// The moves of a part of a node.
#[derive(Default)]
pub(super) struct Moves {
    /// One leads on at once.
    pub(super) on: bool,
    /// One lets time go on in the node.
    pub(super) waits: bool,
    /// The nodes behind the moves, but for that one.
    pub(super) to: Vec<u32>,
}

/// The moves of a node, by its parts.
#[derive(Default)]
pub(super) struct Turn {
    pub(super) parts: Vec<Moves>,
}

impl Turn {
    /// Begins the next part.
    pub(super) fn begin_part(&mut self) {
        self.parts.push(Moves::default());
    }

    /// Adds a move of the part in hand: whether it leads on at once, and the node behind it, with a flag if
    /// it is the same one, in which time has gone on.
    pub(super) fn add(&mut self, on: bool, to: Option<(u32, bool)>) {
        let Some(part) = self.parts.last_mut() else { return };
        part.on |= on;
        match to {
            Some((_, true)) => part.waits = true,
            Some((node, false)) if !part.to.contains(&node) => part.to.push(node),
            _ => {}
        }
    }
}
