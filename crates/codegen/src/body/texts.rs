//! Texts in a body: as they are passed on to be read, and worked out at their place.

use g7_engine::{Builtin, Num};
use g7_equations::Expr as Term;
use g7_model::{Type, say};

use super::{Body, Home, s, text_ty};
use crate::operations::{self, Needs};
use crate::tree::{Bin, Expr, Stmt};
use crate::vars::num;

impl Body<'_> {
    /// A text, as it is passed on to be read.
    pub(super) fn text(&mut self, e: &Term) -> Expr {
        let shared = |e: Expr| Expr::Ref(false, Box::new(e));
        match e {
            Term::Text(text) => shared(self.places.constant(text)),
            Term::Read(m) => match self.places.home(*m) {
                Home::Local(name) => shared(self.local(*m, name)),
                Home::Text(place, _) => shared(place),
                Home::Number(..) | Home::Table(..) => self.none(say!("a number read as a text")),
            },
            Term::Call(_, Type::String(cap), _) | Term::Convert(_, Type::String(cap), _) => {
                let name = self.fresh();
                let zero = Expr::call("zeroed", Vec::new());
                self.out.push(Stmt::Let {
                    mutable: true,
                    name: name.clone(),
                    ty: text_ty(*cap),
                    value: zero,
                });
                self.text_into(e, Expr::name(name.clone()), *cap);
                shared(Expr::Name(name))
            }
            _ => self.none(say!("a text of this kind")),
        }
    }

    /// Works a text out at a place that it does not read.
    pub(super) fn text_into(&mut self, e: &Term, place: Expr, cap: u16) {
        let to = [place.passed(), Expr::size(cap.into())];
        let copy = |from: Expr| {
            let args = [vec![from], to.to_vec()].concat();
            vec![Stmt::Do(Expr::call("text_copy", args))]
        };
        match e {
            Term::Call(Builtin::Sel, _, list) => {
                let [c, a, b] = list.as_slice() else {
                    return self.places.cannot(say!("SEL without its operands"));
                };
                let (c, a, b) = (self.truth(c), self.text(a), self.text(b));
                self.out.push(Stmt::If(c, copy(b), copy(a)));
            }
            Term::Call(Builtin::Mux, _, list) => {
                let Some((k, rest)) = list.split_first() else {
                    return self.places.cannot(say!("MUX without its operands"));
                };
                let k = self.number(k, Num::I64);
                let texts: Vec<Expr> = rest.iter().map(|e| self.text(e)).collect();
                let chosen = texts.into_iter().enumerate().rev().fold(Vec::new(), |other, (i, from)| {
                    let this = k.clone().bin(Bin::Eq, Expr::size(i));
                    // The last one needs no question: the number was checked before.
                    if other.is_empty() { copy(from) } else { vec![Stmt::If(this, copy(from), other)] }
                });
                self.out.extend(chosen);
            }
            Term::Call(f, _, list) => {
                let texts = match f {
                    Builtin::Concat | Builtin::Insert | Builtin::Replace => 2,
                    _ => 1,
                };
                let mut args = Vec::new();
                for (i, e) in list.iter().enumerate() {
                    args.push(if i < texts { self.text(e) } else { self.number(e, Num::I64) });
                }
                args.extend(to);
                if operations::text_takes_fault(*f) {
                    args.push(s().field("fault").passed());
                }
                self.out.push(Stmt::Do(Expr::Call(format!("text_{}", operations::name(*f)), args)));
            }
            Term::Convert(from, _, x) => {
                let n = num(*from).unwrap_or(Num::I64);
                let x = self.number(x, n);
                let mut needs = Needs::default();
                let (f, x) = operations::write_number(n, *from == Type::Time, x, &mut needs);
                self.places.needs(needs);
                let [place, cap] = to;
                self.out.push(Stmt::Do(Expr::Call(f, vec![x, place, cap])));
            }
            _ => self.places.cannot(say!("a text of this kind")),
        }
    }
}
