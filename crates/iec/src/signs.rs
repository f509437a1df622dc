//! The functions of the standard that do what an operator does, as that operator: `ADD(a, b)` as
//! `a + b`. Readers of blocks and lists make readable expressions so, and writers for tools that
//! have no such functions.

use std::collections::HashSet;

use g7_model::visit_mut::{self, Visitor};
use g7_model::{Arg, BinaryOp, Document, Expr, ExprKind, Item, Operands, Path, Span, StandardFunction};

use crate::nodes;

/// A function with its values as an operator.
///
/// # Errors
///
/// The values, if no operator does the same: the function is another one, its inputs are not given
/// in their order, or a comparison would take a long value twice.
pub fn applied(function: &str, args: Vec<Arg>, at: Span) -> Result<Expr, Vec<Arg>> {
    let Some(standard) = StandardFunction::named(function) else { return Err(args) };
    let row = standard.row();
    let in_order = |(k, arg): (usize, &Arg)| {
        !arg.output && arg.name.as_ref().is_none_or(|n| row.place(&n.text) == Some(k))
    };
    let fits = (row.least()..=row.most()).contains(&args.len()) && args.iter().enumerate().all(in_order);
    let op = match standard {
        _ if !fits => return Err(args),
        StandardFunction::Operator(op) => op,
        StandardFunction::Not => {
            let value = args.into_iter().next().map(|a| a.value);
            return Ok(value.map_or_else(|| nodes::bad(at), |e| nodes::not(e, at)));
        }
        _ => return Err(args),
    };
    if op.row().operands == Operands::Comparison && args.len() > 2 {
        return in_turn(op, args, at);
    }
    let joined = args.into_iter().map(|a| a.value).reduce(|all, next| nodes::binary(op, all, next, at));
    Ok(joined.unwrap_or_else(|| nodes::bad(at)))
}

/// `GT(a, b, c)` is `a > b and b > c`. The value between is written twice, so it must be short;
/// values within values would double without bound.
fn in_turn(op: BinaryOp, args: Vec<Arg>, at: Span) -> Result<Expr, Vec<Arg>> {
    let short = |e: &Expr| matches!(e.kind, ExprKind::Path(_) | ExprKind::Direct(_) | ExprKind::Literal(_));
    let between = args.iter().skip(1).take(args.len().saturating_sub(2));
    if !between.into_iter().all(|a| short(&a.value)) {
        return Err(args);
    }
    let pairs = args.windows(2).filter_map(|pair| match pair {
        [a, b] => Some(nodes::binary(op, a.value.clone(), b.value.clone(), at)),
        _ => None,
    });
    Ok(pairs
        .reduce(|all, pair| nodes::binary(BinaryOp::And, all, pair, at))
        .unwrap_or_else(|| nodes::bad(at)))
}

/// The document with operators in place of their functions, but for those that it declares itself.
pub fn in_signs(document: &Document) -> Document {
    let mut document = document.clone();
    let declared = document.items.iter().filter_map(|item| match item {
        Item::Function(f) => Some(f.name.text.clone()),
        _ => None,
    });
    let mut signs = Signs { declared: declared.collect() };
    visit_mut::document(&mut document, &mut signs);
    for item in &mut document.items {
        match item {
            Item::Function(f) => visit_mut::stmts(&mut f.body.statements, &mut signs),
            Item::Var(v) => v.init.iter_mut().for_each(|e| visit_mut::expr(e, &mut signs)),
            _ => {}
        }
    }
    document
}

struct Signs {
    declared: HashSet<Box<str>>,
}

impl Visitor for Signs {
    fn expr(&mut self, e: &mut Expr) {
        let ExprKind::Call(Path { names }, args) = &mut e.kind else { return };
        let [name] = names.as_slice() else { return };
        if self.declared.contains(&name.text) {
            return;
        }
        match applied(&name.text, std::mem::take(args), e.at.0) {
            Ok(operator) => *e = operator,
            Err(same) => *args = same,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::applied;
    use crate::nodes;
    use g7_model::{Arg, BinaryOp, Expr, Name, Span};

    fn at() -> Span {
        Span::default()
    }

    fn var(name: &str) -> Expr {
        nodes::name(&[name], at())
    }

    fn args(names: &[(&str, Expr)]) -> Vec<Arg> {
        let named = |n: &str| (!n.is_empty()).then(|| Name::new(n, at()));
        names.iter().map(|(n, e)| Arg::input(named(n), e.clone())).collect()
    }

    fn join(op: BinaryOp, a: Expr, b: Expr) -> Expr {
        nodes::binary(op, a, b, at())
    }

    #[test]
    fn values_are_joined_from_the_left_and_compared_in_turn() {
        let three = || args(&[("", var("a")), ("", var("b")), ("", var("c"))]);
        let sum = join(BinaryOp::Add, join(BinaryOp::Add, var("a"), var("b")), var("c"));
        assert_eq!(applied("ADD", three(), at()), Ok(sum));
        let (first, second) =
            (join(BinaryOp::Gt, var("a"), var("b")), join(BinaryOp::Gt, var("b"), var("c")));
        assert_eq!(applied("gt", three(), at()), Ok(join(BinaryOp::And, first, second)));
        assert_eq!(applied("SUB", three(), at()), Err(three()), "it has two inputs");
        assert_eq!(applied("ABS", three(), at()), Err(three()));
    }

    #[test]
    fn inputs_in_another_order_stay_a_call() {
        let turned = || args(&[("IN2", var("a")), ("IN1", var("b"))]);
        assert_eq!(applied("SUB", turned(), at()), Err(turned()));
        let ordered = args(&[("IN1", var("a")), ("IN2", var("b"))]);
        assert_eq!(applied("SUB", ordered, at()), Ok(join(BinaryOp::Sub, var("a"), var("b"))));
    }

    #[test]
    fn a_long_value_is_not_written_twice() {
        let long = join(BinaryOp::Add, var("b"), var("b"));
        let three = || args(&[("", var("a")), ("", long.clone()), ("", var("c"))]);
        assert_eq!(applied("EQ", three(), at()), Err(three()));
    }
}
