//! Instances of function blocks of the file: their calls and their members, by the new names.

use g7_model::{Arg, Expr, Path, Span, Stmt, StmtKind};

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

    /// A member of an instance, or a bit of one; so many names stand behind the instance.
    pub(super) fn inner(
        &mut self,
        key: VarKey<'d>,
        path: &Path,
        rest: usize,
        span: Span,
        at: &At<'d>,
    ) -> Expr {
        let of = self.block_of(key);
        let mut names = self.var_names(key, at);
        let behind = path.names.len().saturating_sub(rest);
        for (n, name) in path.names.iter().skip(behind).enumerate() {
            let member = of.filter(|_| n == 0).and_then(|of| of.member(&name.text));
            names.push(member.unwrap_or(&name.text).to_owned());
        }
        named(&names, span)
    }

    /// The call of a function block of the file; None for another call.
    pub(super) fn own_call(&mut self, path: &Path, args: &[Arg], span: Span, at: &At<'d>) -> Option<Stmt> {
        let Some(Ref::Var(key)) = self.scopes.refer(at.chart, &path.names).filter(|_| !at.function) else {
            return None;
        };
        let of = self.block_of(key)?;
        self.note(path, true, at);
        let inout = |a: &Arg| a.name.as_ref().is_some_and(|n| of.is_inout(&n.text));
        args.iter().filter(|a| inout(a)).for_each(|a| self.writes(&a.value, at));
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
