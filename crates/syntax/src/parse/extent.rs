//! How far the construct in hand may run on, and the brackets that are open in it.

use crate::lexer::{Tok, Token};
use g7_model::Span;

/// How far a construct may run on.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub(super) enum Extent {
    /// To the bracket or word that closes it.
    #[default]
    Free,
    /// To the end of its line.
    Line,
    /// To the end of its line; over an operator that ends the line only if a `;` ends the statement.
    Statement,
}

/// The state of the lines.
#[derive(Debug, Default)]
pub(super) struct Lines {
    pub(super) extent: Extent,
    /// The extents outside of the open brackets.
    pub(super) outside: Vec<Extent>,
    /// How many of them belong to constructs further out.
    pub(super) base: usize,
    /// The token behind the end of the line that is the current token.
    pub(super) behind: Option<Token>,
    /// Where the statement in hand went over the end of a line in the middle of an expression.
    pub(super) ran_on: Option<Span>,
}

impl Lines {
    /// Follows the brackets: inside them the end of a line means nothing.
    pub(super) fn bracket(&mut self, kind: Tok) {
        match kind {
            Tok::LParen | Tok::LBracket | Tok::LBrace => {
                self.outside.push(self.extent);
                self.extent = Extent::Free;
            }
            Tok::RParen | Tok::RBracket | Tok::RBrace => self.unclosed(),
            _ => {}
        }
    }

    /// Leaves a bracket, also one that is never closed.
    pub(super) fn unclosed(&mut self) {
        if self.outside.len() > self.base
            && let Some(extent) = self.outside.pop()
        {
            self.extent = extent;
        }
    }
}
