//! Variables with an index: `%W11[%W67]`. There are no arrays, so a function selects among all
//! variables of a kind, and an assignment becomes a `CASE` over them.

use std::ops::Range;

use g7_model::{BinaryOp, CaseArm, Expr, Function, Name, Param, Span, Stmt, StmtKind, Type};

use super::project::Key;
use super::variables::{Vars, kind, shown};
use g7_iec::nodes::{self, binary, call, int, name};
use g7_iec::report::Report;

/// The most variables of a kind that an index can reach.
const LONGEST_TABLE: u32 = 1000;

/// The project's name for the number of variables of a kind, and ClassicLadder's default.
fn table_size(kind: u16) -> Option<(&'static str, u32)> {
    Some(match kind {
        kind::BIT => ("BITS", 500),
        kind::INPUT => ("PHYS_INPUTS", 50),
        kind::OUTPUT => ("PHYS_OUTPUTS", 50),
        kind::WORD => ("WORDS", 200),
        kind::WORD_INPUT => ("PHYS_WORDS_INPUTS", 25),
        kind::WORD_OUTPUT => ("PHYS_WORDS_OUTPUTS", 25),
        _ => return None,
    })
}

/// The name of the function that selects a variable of a kind.
pub(super) fn table_name(kind: u16) -> Option<String> {
    table_size(kind)?;
    Some(format!("AT_{}", shown((kind, 0))?.0))
}

impl Vars<'_> {
    /// The variables of a kind that an index can reach.
    fn row(&mut self, kind: u16, at: &Range<usize>, report: &mut Report) -> Option<Vec<String>> {
        let (size, default) = table_size(kind)?;
        let size = self.plan.sizes.get(size).copied().unwrap_or(default).min(LONGEST_TABLE);
        Some((0..size).map(|n| self.declare((kind, n), at, report)).collect())
    }

    /// The index of `%W11[%W67]` within its kind.
    fn place(&mut self, key: Key, index: Key, at: &Range<usize>, report: &mut Report) -> Expr {
        let span = report.span(at);
        let index = self.number(index, at, report);
        if key.1 == 0 { index } else { binary(BinaryOp::Add, int(key.1.into(), span), index, span) }
    }

    /// The value of a variable with an index, selected by a function.
    pub(super) fn indexed(&mut self, key: Key, index: Key, at: &Range<usize>, report: &mut Report) -> Expr {
        let Some(table) = table_name(key.0) else { return self.strange(key, at, report) };
        if self.tables.insert(key.0) {
            self.row(key.0, at, report);
        }
        let place = self.place(key, index, at, report);
        call(&table, vec![place], report.span(at))
    }

    /// The assignment to a variable with an index, with the names that it may write.
    pub(super) fn indexed_target(
        &mut self,
        key: Key,
        index: Key,
        value: &Expr,
        at: &Range<usize>,
        report: &mut Report,
    ) -> Option<(Stmt, Vec<String>)> {
        let span = report.span(at);
        let written = matches!(key.0, kind::BIT | kind::OUTPUT | kind::WORD | kind::WORD_OUTPUT);
        let names = self.row(key.0, at, report).filter(|_| written);
        let Some(mut names) = names else {
            self.target(key, at, report)?;
            return None;
        };
        let place = self.place(key, index, at, report);
        let arms = (0i128..).zip(&names).map(|(n, own)| CaseArm {
            labels: vec![(int(n, span), None)],
            body: vec![nodes::assign(name(&[own], span), value.clone(), span)],
        });
        let stmt = Stmt { kind: StmtKind::Case(place, arms.collect(), Vec::new()), at: span.into() };
        names.extend(table_name(key.0));
        Some((stmt, names))
    }

    /// The functions that select a variable by its number.
    pub(super) fn tables(&self, at: Span) -> Vec<Function> {
        self.tables.iter().filter_map(|kind| self.table(*kind, at)).collect()
    }

    fn table(&self, kind: u16, at: Span) -> Option<Function> {
        let title = table_name(kind)?;
        let own = self
            .names
            .range((kind, 0)..=(kind, LONGEST_TABLE))
            .filter(|(key, _)| self.declared.contains_key(key));
        let arms = own.map(|(key, own)| CaseArm {
            labels: vec![(int(key.1.into(), at), None)],
            body: vec![nodes::assign(name(&[&title], at), name(&[own], at), at)],
        });
        let choice = StmtKind::Case(name(&["n"], at), arms.collect(), Vec::new());
        let body = nodes::block(vec![Stmt { kind: choice, at: at.into() }], at);
        let result = if kind >= kind::FIRST_WORD { Type::Dint } else { Type::Bool };
        let params = vec![Param { name: Name::new("n", at), ty: Type::Dint.into() }];
        Some(Function { name: Name::new(title, at), params, result: result.into(), body, at: at.into() })
    }
}
