//! Properties of an expression's form: its height, its size, the names it reads.

use g7_model::{Expr, ExprKind, Name, Path};

use crate::nodes;

/// The complement of an expression at the same place, without double negation.
pub(crate) fn not(e: Expr) -> Expr {
    let at = e.at.0;
    nodes::not(e, at)
}

/// The height of an expression's tree, which the reader has bounded.
pub(crate) fn height(e: &Expr) -> u32 {
    match &e.kind {
        ExprKind::Unary(_, a) => height(a) + 1,
        ExprKind::Binary(_, a, b) => height(a).max(height(b)) + 1,
        ExprKind::Timer { t1, e, t2 } => {
            height(t1).max(height(e)).max(t2.as_ref().map_or(0, |t| height(t))) + 1
        }
        ExprKind::Call(_, args) => args.iter().map(|a| height(&a.value)).max().unwrap_or(0) + 1,
        ExprKind::Element(_, index, _) => index.iter().map(height).max().unwrap_or(0) + 1,
        ExprKind::List(values) => values.iter().map(|(_, e)| height(e)).max().unwrap_or(0) + 1,
        ExprKind::Literal(_) | ExprKind::Path(_) | ExprKind::Direct(_) | ExprKind::Bad => 1,
    }
}

/// The number of parts of an expression.
pub(crate) fn size(e: &Expr) -> usize {
    match &e.kind {
        ExprKind::Unary(_, a) => size(a) + 1,
        ExprKind::Binary(_, a, b) => size(a) + size(b) + 1,
        ExprKind::Timer { t1, e, t2 } => size(t1) + size(e) + t2.as_ref().map_or(0, |t| size(t)) + 1,
        ExprKind::Call(_, args) => args.iter().map(|a| size(&a.value)).sum::<usize>() + 1,
        ExprKind::Element(_, index, _) => index.iter().map(size).sum::<usize>() + 1,
        ExprKind::List(values) => values.iter().map(|(_, e)| size(e)).sum::<usize>() + 1,
        ExprKind::Literal(_) | ExprKind::Path(_) | ExprKind::Direct(_) | ExprKind::Bad => 1,
    }
}

/// True if an expression reads the variable of a target. A direct name may be any variable.
pub(crate) fn reads(e: &Expr, target: &Expr) -> bool {
    match &e.kind {
        ExprKind::Unary(_, a) => reads(a, target),
        ExprKind::Binary(_, a, b) => reads(a, target) || reads(b, target),
        ExprKind::Timer { t1, e, t2 } => {
            reads(t1, target) || reads(e, target) || t2.as_ref().is_some_and(|t| reads(t, target))
        }
        ExprKind::Call(path, args) => {
            args.iter().any(|a| reads(&a.value, target)) || first_name(path) == target_name(target)
        }
        ExprKind::List(values) => values.iter().any(|(_, e)| reads(e, target)),
        ExprKind::Element(_, index, _) if index.iter().any(|e| reads(e, target)) => true,
        ExprKind::Path(path) => path_reads(path, target),
        ExprKind::Element(path, ..) => path_reads(path, target),
        ExprKind::Direct(name) => match &target.kind {
            ExprKind::Direct(other) => name == other,
            _ => true,
        },
        ExprKind::Literal(_) | ExprKind::Bad => false,
    }
}

/// True if a path may read the variable of a target.
fn path_reads(path: &Path, target: &Expr) -> bool {
    let named = |name: &str| path.names.iter().any(|n| n.text.eq_ignore_ascii_case(name));
    target_name(target).is_none_or(named)
}

fn first_name(path: &Path) -> Option<&str> {
    path.names.first().map(|n: &Name| &*n.text)
}

/// The name by which other paths would refer to the target; None for a direct name.
fn target_name(target: &Expr) -> Option<&str> {
    match &target.kind {
        // `Chart.v` is also `v` inside the chart; a member changes with its instance.
        ExprKind::Path(path) => path.names.last().map(|n| &*n.text),
        ExprKind::Element(path, ..) => path.names.last().map(|n| &*n.text),
        _ => None,
    }
}
