//! Structures, function blocks of one's own, and paths to the members of their variables.

use super::Printer;
use super::item::starts;
use g7_model::{Body, Composed, Expr, Path, Span, VarDecl, element_parts};

impl Printer<'_> {
    pub(super) fn composed(&mut self, composed: &Composed) {
        let block = composed.block;
        self.push(if block { "function block " } else { "struct " });
        self.name(&composed.name.text);
        self.comment(composed.comment.as_deref());
        self.push(" ");
        let parts = parts(composed);
        let first = starts(parts.first().map(|(at, _)| *at));
        self.braces(composed.at.0, first, |p| {
            for (n, (at, part)) in parts.iter().enumerate() {
                match part {
                    Part::Member(m) if block => p.line(*at, false, |p| p.variable(m)),
                    Part::Member(m) => p.line(*at, false, |p| p.declaration(m)),
                    Part::InOut(m) => p.line(*at, false, |p| {
                        p.push("inout ");
                        p.declaration(m);
                    }),
                    Part::Body(body) => {
                        let apart = n > 0 && p.source.is_none();
                        p.group(*at, apart, |p| {
                            p.push("body ");
                            p.body(body);
                        });
                    }
                }
            }
        });
    }

    /// `m[i].t[j].x`: each index stands behind the name that has it.
    pub(super) fn element(&mut self, path: &Path, index: &[Expr]) {
        for (n, (names, index)) in element_parts(path, index).into_iter().enumerate() {
            self.push(if n > 0 { "." } else { "" });
            self.path(&names);
            if !index.is_empty() {
                self.indexes(index);
            }
        }
    }

    fn indexes(&mut self, index: &[Expr]) {
        self.push("[");
        self.list(index);
        self.push("]");
    }
}

/// A part of a type between its braces.
enum Part<'c> {
    Member(&'c VarDecl),
    InOut(&'c VarDecl),
    Body(&'c Body),
}

/// The parts in the order of the text; those that a program made have none, and keep their order.
fn parts(composed: &Composed) -> Vec<(Span, Part<'_>)> {
    let mut parts: Vec<(Span, Part<'_>)> = Vec::new();
    parts.extend(composed.members.iter().map(|m| (m.at.0, Part::Member(m))));
    parts.extend(composed.inouts.iter().map(|m| (m.at.0, Part::InOut(m))));
    parts.extend(composed.body.iter().map(|b| (b.block().at.0, Part::Body(b))));
    parts.sort_by_key(|(at, _)| at.start);
    parts
}
