//! The stack of running code. [`crate::Program::new`] has checked that code never needs more room,
//! and never takes a value that is not there; what goes beyond is 0, or is dropped.

use crate::ops::STACK;

#[derive(Clone, Debug)]
pub(crate) struct Stack {
    words: [u64; STACK],
    /// Number of values.
    len: usize,
}

impl Default for Stack {
    fn default() -> Stack {
        Stack { words: [0; STACK], len: 0 }
    }
}

impl Stack {
    #[inline(always)]
    pub(crate) fn push(&mut self, value: u64) {
        if let Some(word) = self.words.get_mut(self.len) {
            *word = value;
            self.len += 1;
        }
    }

    #[inline(always)]
    pub(crate) fn pop(&mut self) -> u64 {
        self.len = self.len.saturating_sub(1);
        self.words.get(self.len).copied().unwrap_or(0)
    }

    /// The values on top, in the order in which they were pushed.
    pub(crate) fn top(&self, count: usize) -> &[u64] {
        self.words.get(self.len.saturating_sub(count)..self.len).unwrap_or(&[])
    }

    /// Takes the values on top away.
    pub(crate) fn drop(&mut self, count: usize) {
        self.len = self.len.saturating_sub(count);
    }

    pub(crate) fn clear(&mut self) {
        self.len = 0;
    }
}
