//! Calls of standard function blocks.

use g7_model::{Arg, ExprKind as Form, FbKind, Name, Problem, Said, Span, Type, codes, say};

use super::resolver::{Resolver, Role, nearest};
use crate::ir::{Expr, StmtKind, Target, VarId};

/// The index of a member; RESET and LOAD are the long names in the standard.
pub(super) fn member(kind: FbKind, name: &str) -> Option<u8> {
    let find = |n: &str| kind.members().iter().position(|m| m.0.eq_ignore_ascii_case(n));
    let place = find(name).or_else(|| match name.to_ascii_uppercase().as_str() {
        "RESET" => find("R"),
        "LOAD" => find("LD"),
        _ => None,
    })?;
    u8::try_from(place).ok()
}

impl Resolver<'_, '_> {
    /// `c1(CU := x, Q => done)`.
    pub(super) fn fb_call(
        &mut self,
        var: VarId,
        kind: FbKind,
        name: &Name,
        args: &[Arg],
    ) -> Option<StmtKind> {
        let allowed = self.may_call(name);
        let mut inputs: Vec<(u8, Expr)> = Vec::new();
        let mut outputs: Vec<(u8, Target)> = Vec::new();
        let mut given: Vec<Option<Span>> = vec![None; kind.members().len()];
        let mut complete = true;
        for (k, arg) in args.iter().enumerate() {
            let Some(m) = self.argument_member(kind, k, arg) else {
                complete = false;
                continue;
            };
            let place = arg.name.as_ref().map_or(arg.value.at.0, |n| n.at.0);
            match given.get_mut(usize::from(m)) {
                Some(Some(first)) => {
                    let problem =
                        Problem::new(&codes::WRONG_ARGUMENTS, place, say!("given twice in one call"))
                            .related(*first, say!("given here first"));
                    self.problems.push(problem);
                    complete = false;
                    continue;
                }
                Some(slot) => *slot = Some(place),
                None => continue,
            }
            let ty = kind.members().get(usize::from(m)).map_or(Type::Bool, |m| m.1);
            if arg.output {
                match self.output_target(arg, ty) {
                    Some(t) => outputs.push((m, t)),
                    None => complete = false,
                }
            } else {
                match self.value(&arg.value, ty) {
                    Some(e) => inputs.push((m, e)),
                    None => complete = false,
                }
            }
        }
        allowed?;
        complete.then_some(StmtKind::Fb { var, kind, inputs, outputs })
    }

    /// Function blocks have a memory; functions and sections must not have one.
    fn may_call(&mut self, name: &Name) -> Option<()> {
        let place = match self.frame.role {
            Role::Code => return Some(()),
            Role::Function(_) => say!("a function"),
            Role::Section(_) => say!("a transition section"),
            Role::Query | Role::Constant => say!("an expression"),
        };
        let what = say!("the function block `{}` cannot be called in {place}", name.text);
        self.report(
            Problem::new(&codes::NOT_HERE, name.at.0, what)
                .help(say!("call it in an action or in a PRE section and read its outputs here")),
        )
    }

    fn argument_member(&mut self, kind: FbKind, k: usize, arg: &Arg) -> Option<u8> {
        let members = kind.members();
        let Some(name) = &arg.name else {
            if members.get(k).is_some_and(|m| m.2) {
                return u8::try_from(k).ok();
            }
            let inputs: Vec<&str> = members.iter().filter(|m| m.2).map(|m| m.0).collect();
            let what = say!("{} takes {} inputs: {}", kind, inputs.len(), Said::foreign(inputs.join(", ")));
            return self.report(Problem::new(&codes::WRONG_ARGUMENTS, arg.value.at.0, what));
        };
        let side = if arg.output { say!("output") } else { say!("input") };
        let found = member(kind, &name.text)
            .filter(|m| members.get(usize::from(*m)).is_some_and(|m| m.2 != arg.output));
        if found.is_none() {
            let all: Vec<&str> = members.iter().filter(|m| m.2 != arg.output).map(|m| m.0).collect();
            let what = say!("{} has no {side} `{}`", kind, name.text);
            let near = nearest(&name.text, all.iter().copied());
            let help = match near {
                Some(n) => say!("did you mean `{n}`?"),
                None => say!("its {side}s are {}", Said::foreign(all.join(", "))),
            };
            self.problems.push(Problem::new(&codes::WRONG_ARGUMENTS, name.at.0, what).help(help));
        }
        found
    }

    /// `Q => done`: a variable of the same type.
    fn output_target(&mut self, arg: &Arg, ty: Type) -> Option<Target> {
        let (target, of) = match &arg.value.kind {
            Form::Path(_) | Form::Element(..) | Form::Direct(_) => self.target(&arg.value)?,
            _ => {
                let what = say!("an output needs a variable to go to");
                return self.report(Problem::new(&codes::WRONG_ARGUMENTS, arg.value.at.0, what));
            }
        };
        if of != ty {
            let what = say!("the output is {ty}, the variable is {of}");
            return self.report(Problem::new(&codes::WRONG_TYPE, arg.value.at.0, what));
        }
        Some(target)
    }
}
