//! Elements of arrays and members of structures: the indexes behind a path, and the names behind these.

use super::Parser;
use crate::lexer::Tok;
use g7_model::{Expr, ExprKind, Name, Path, say};

impl Parser<'_> {
    /// The index behind the name of an array, and the number of a bit behind that, if they stand here.
    pub(super) fn variable_of(&mut self, path: Path) -> ExprKind {
        self.element_of(path).0
    }

    /// The same with the height of the highest index.
    pub(super) fn element_of(&mut self, mut path: Path) -> (ExprKind, u32) {
        let (mut index, mut height, mut member) = (Vec::new(), 0, None);
        while self.at(Tok::LBracket) && self.cur.start == self.prev.end && self.enter() {
            let before = index.len();
            height = height.max(self.indexes(&mut index));
            self.leave();
            if !self.dot_of_member() {
                break;
            }
            let slot = format!("[{}]", ",".repeat((index.len() - before).saturating_sub(1)));
            member = self.members(&mut path, &slot);
            if member.is_some() {
                break;
            }
        }
        match index.as_slice() {
            [] => (ExprKind::Path(path), 0),
            _ => (ExprKind::Element(Box::new(path), index, member.map(Box::new)), height),
        }
    }

    /// Reads the names behind an index, whose place in the path is `slot`; returns the number of a bit.
    fn members(&mut self, path: &mut Path, slot: &str) -> Option<Name> {
        let mut slot = Some(slot);
        loop {
            let bit = self.at(Tok::Int);
            let member = self.member();
            if bit {
                return Some(member);
            }
            if let (Some(last), Some(slot)) = (path.names.last_mut(), slot.take()) {
                last.text = format!("{}{slot}", last.text).into();
            }
            path.names.push(member);
            if !self.eat(Tok::PathDot) {
                return None;
            }
        }
    }

    /// `[i, j]`; the bracket is in hand. Returns the height of the highest index.
    fn indexes(&mut self, index: &mut Vec<Expr>) -> u32 {
        let open = self.here();
        self.bump();
        let mut height = 0;
        loop {
            let tree = self.tree(1);
            height = height.max(tree.height);
            index.push(tree.expr);
            if !self.eat(Tok::Comma) {
                break;
            }
        }
        self.close(Tok::RBracket, say!("`]`"), open);
        height
    }
}
