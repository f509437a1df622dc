//! Comparing, calculating, converting, functions and function blocks.

use super::*;

impl Body<'_, '_> {
    pub(super) fn compare(&mut self, c: Cmp, n: Num) {
        let (b, a) = (self.pop(), self.pop());
        let sign = match c {
            Cmp::Eq => "=",
            Cmp::Ne => "<>",
            Cmp::Lt => "<",
            Cmp::Le => "<=",
            Cmp::Gt => ">",
            Cmp::Ge => ">=",
        };
        if a.kind == Kind::Tenths || b.kind == Kind::Tenths {
            let e = self.tenths(&a, &b, sign);
            return self.push(e, Ty::BOOL);
        }
        let ty = self.meet(&a, &b, n);
        let (x, y) = (self.as_ty(&a, ty), self.as_ty(&b, ty));
        let e = match (sign, &x, &y) {
            ("=", _, Ex::Bool(true)) | ("<>", _, Ex::Bool(false)) => x,
            ("=", _, Ex::Bool(false)) | ("<>", _, Ex::Bool(true)) => x.not(),
            ("<>", ..) if ty == Ty::BOOL => x.xor(y),
            ("=", ..) if ty == Ty::BOOL => x.xor(y).not(),
            _ => Ex::op(sign, x, y),
        };
        self.push(e, Ty::BOOL);
    }

    /// Tenths of a second against a number: the TIME against that many of them.
    pub(super) fn tenths(&mut self, a: &Value, b: &Value, sign: &'static str) -> Ex {
        let (time, number, sign) = match (a.kind, b.kind) {
            (Kind::Tenths, Kind::Word(w)) => (a.e.clone(), w as i64, sign),
            (Kind::Word(w), Kind::Tenths) => {
                let turned = match sign {
                    "<" => ">",
                    "<=" => ">=",
                    ">" => "<",
                    ">=" => "<=",
                    same => same,
                };
                (b.e.clone(), w as i64, turned)
            }
            _ => (Ex::Bool(false), -1, sign),
        };
        if !(0..9998).contains(&number) {
            self.cannot("the time of a step in tenths of a second, other than compared with a number,");
            return Ex::Bool(false);
        }
        let at = |n: i64| Ex::Time(n * 100_000_000);
        let from = |n: i64| Ex::op(">=", time.clone(), at(n));
        let below = |n: i64| Ex::op("<", time.clone(), at(n));
        match sign {
            ">=" => from(number),
            ">" => from(number + 1),
            "<" => below(number),
            "<=" => below(number + 1),
            "=" => from(number).and(below(number + 1)),
            _ => below(number).or(from(number + 1)),
        }
    }

    pub(super) fn arith(&mut self, op: Arith, n: Num) {
        let (b, a) = (self.pop(), self.pop());
        let time = |v: &Value| v.kind == Kind::Of(Ty::TIME);
        if op == Arith::Div && time(&a) && b.kind == Kind::Word(100_000_000) {
            return self.stack.push(Value { e: a.e, kind: Kind::Tenths });
        }
        if matches!(op, Arith::Mul | Arith::Div | Arith::Mod) && (time(&a) || time(&b)) {
            if time(&a) && time(&b) || op == Arith::Mod {
                self.cannot("a TIME taken as a number");
            }
            // The standard has the TIME on the left.
            let (t, k) = if time(&a) { (&a, &b) } else { (&b, &a) };
            if op == Arith::Div && !time(&a) {
                self.cannot("a TIME taken as a number");
            }
            let ty = self.meet(k, k, Num::I64);
            let k = narrow(self.as_ty(k, if ty.time { Ty::LINT } else { ty }));
            let sign = if op == Arith::Mul { "*" } else { "/" };
            return self.push(Ex::op(sign, t.e.clone(), k), Ty::TIME);
        }
        let ty = self.meet(&a, &b, n);
        let (x, y) = (self.as_ty(&a, ty), self.as_ty(&b, ty));
        let sign = match op {
            Arith::Add => "+",
            Arith::Sub => "-",
            Arith::Mul => "*",
            Arith::Div => "/",
            Arith::Mod => "MOD",
            Arith::Pow => return self.push(Ex::call("EXPT", vec![x, y]), ty),
        };
        self.push(Ex::op(sign, x, y), ty);
    }

    pub(super) fn convert(&mut self, from: Num, to: Num) {
        let v = self.pop();
        match v.kind {
            Kind::Tenths => self.stack.push(v),
            Kind::Word(w) if !real(from) && !real(to) && to != Num::Bool => {
                self.stack.push(Value { e: v.e, kind: Kind::Word(w) });
            }
            Kind::Of(ty) if ty.time => {
                self.cannot("a TIME taken as a number");
                self.push(v.e, Ty::of(to));
            }
            _ => {
                let e = self.as_ty(&v, Ty::of(from));
                if to == Num::Bool {
                    let zero = if real(from) { Ex::Real(0.0) } else { Ex::Int(0) };
                    return self.push(Ex::op("<>", e, zero), Ty::BOOL);
                }
                let e = self.converted(e, Ty::of(from), Ty::of(to));
                self.push(e, Ty::of(to));
            }
        }
    }

    pub(super) fn call(&mut self, f: Builtin, n: Num, count: usize) {
        let from = self.stack.len().saturating_sub(count);
        let mut args = self.stack.split_off(from);
        if f == Builtin::Min
            && let [Value { e, kind: Kind::Tenths }, _] = args.as_slice()
        {
            let e = e.clone();
            return self.stack.push(Value { e, kind: Kind::Tenths });
        }
        let mut first = Vec::new();
        match f {
            Builtin::Sel => {
                let g = args.remove(0);
                first.push(self.as_ty(&g, Ty::BOOL));
            }
            Builtin::Mux => {
                let k = args.remove(0);
                let ty = self.meet(&k, &k, Num::I64);
                let k = self.as_ty(&k, ty);
                first.push(narrow(k));
            }
            _ => {}
        }
        let mut ty = Ty::of(n);
        for v in &args {
            if let Kind::Of(t) = v.kind {
                ty = t;
            }
        }
        let rest: Vec<Ex> = args.iter().map(|v| self.as_ty(v, ty)).collect();
        first.extend(rest);
        let name = format!("{f:?}").to_uppercase();
        self.push(Ex::call(name, first), ty);
    }

    /// The assignments to its inputs just before become part of the call.
    pub(super) fn instance(&mut self, base: Addr) {
        let Some(slot) = self.p.vars.slot(base.0).cloned() else { return };
        let head = format!("{}.", slot.name);
        let mut inputs = Vec::new();
        while let Some(St::Assign(Ex::Var(to), _)) = self.out.last()
            && let Some(member) = to.strip_prefix(&head).map(str::to_owned)
            && let Some(St::Assign(_, e)) = self.out.pop()
        {
            inputs.insert(0, (member, e));
        }
        self.spill(|e| {
            let mut found = false;
            e.walk(&mut |e| found |= matches!(e, Ex::Var(n) if n.starts_with(&head)));
            found
        });
        self.out.push(St::Call(slot.name, inputs));
    }
}
