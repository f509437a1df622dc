//! Instances of function blocks of the file: their calls and their members, by the new names.

use g7_model::{Arg, Expr, ExprKind, Path, Span, Stmt, StmtKind, Type, say};

use super::blocks::Renamed;
use super::bodies::{At, named};
use super::lower::Lower;
use crate::nodes;
use crate::scopes::{Ref, VarKey};

impl<'d> Lower<'d> {
    /// The type of an instance.
    fn block_of(&self, key: VarKey<'d>) -> Option<&'d Renamed> {
        let of = self.scopes.decl(key).filter(|d| d.is_own_instance())?.of.as_ref()?;
        self.blocks.get(&of.text)
    }

    /// The names that lead to a member of an instance; in the condition of an action, to its copy if bodies call the
    /// instance.
    pub(super) fn member(
        &mut self,
        key: VarKey<'d>,
        member: &str,
        ty: Option<Type>,
        span: Span,
        at: &At<'d>,
    ) -> Vec<String> {
        if let Some(ty) = ty.filter(|_| at.condition && self.moved.contains(&key))
            && let ExprKind::Path(copy) = self.copy_of(key, Some(member), ty, span).kind
        {
            return copy.names.iter().map(|n| n.text.to_string()).collect();
        }
        let mut names = self.var_names(key, at);
        names.push(member.to_owned());
        names
    }

    /// A member of an instance, or a bit of one; so many names stand behind the instance.
    pub(super) fn inner(
        &mut self,
        key: VarKey<'d>,
        path: &Path,
        rest: usize,
        span: Span,
        at: &At<'d>,
    ) -> Expr {
        let behind: Vec<&str> =
            path.names.iter().skip(path.names.len().saturating_sub(rest)).map(|n| &*n.text).collect();
        let (Some(of), [member, bits @ ..]) = (self.block_of(key), behind.as_slice()) else {
            return self.nothing(span, say!("`{}` has no counterpart", path.text()));
        };
        let member = of.member(member).unwrap_or(member);
        let mut names = self.member(key, member, of.type_of(member), span, at);
        names.extend(bits.iter().map(|bit| (*bit).to_owned()));
        named(&names, span)
    }

    /// The call of a function block of the file; None for another call.
    pub(super) fn own_call(&mut self, path: &Path, args: &[Arg], span: Span, at: &At<'d>) -> Option<Stmt> {
        let Some(Ref::Var(key)) = self.scopes.refer(at.chart, &path.names).filter(|_| !at.function) else {
            return None;
        };
        let of = self.block_of(key)?;
        self.note(path, true, at);
        let mut args = self.args(args, at);
        for name in args.iter_mut().filter_map(|a| a.name.as_mut()) {
            if let Some(new) = of.member(&name.text) {
                name.text = new.into();
            }
        }
        let name = self.var_names(key, at).join(".");
        Some(Stmt { kind: StmtKind::Call(nodes::path(&[&name], span), args), at: span.into() })
    }
}
