//! Instructions that write, as statements.

use g7_engine::{Addr, Builtin, Num, Op, Service};

use crate::flow::Flow;
use crate::tree::{Expr, Stmt, Ty};
use crate::values::{Entry, suffix};
use crate::vars::{self, Kind, Shape, block_names, written_by};

impl Flow<'_, '_> {
    /// Statements, for instructions that leave nothing on the stack (or a text).
    pub(crate) fn statement(&mut self, op: Op) {
        match op {
            Op::Store(a) => self.store(a),
            Op::StoreAt { base, len } => self.store_at(base, len),
            Op::StoreText { to, cap } => {
                let from = self.pop();
                self.settle();
                let from = self.as_kind(&from, Kind::Text);
                let Some(slot) = self.g.vars.slot(to.0).cloned() else { return };
                let place = self.text_place(to.0, &slot);
                // A text that is given to itself stays.
                if matches!(&from, Expr::Ref(_, e) if **e == place) {
                    return self.wrote(to.0, None);
                }
                let call = Expr::call("text_copy", vec![from, place.passed(), Expr::size(cap.into())]);
                self.out.push(Stmt::Do(call));
                self.wrote(to.0, None);
            }
            Op::Text { function, to, cap } => self.text(function, to, cap),
            Op::ToText { from, time, to, cap } => {
                let a = self.pop();
                self.settle();
                let Some(slot) = self.g.vars.slot(to.0).cloned() else { return };
                let (wide, name) = match from {
                    _ if time => (Num::I64, "time"),
                    Num::Bool => (Num::Bool, "bool"),
                    Num::I8 | Num::I16 | Num::I32 | Num::I64 => (Num::I64, "i64"),
                    Num::U8 | Num::U16 | Num::U32 | Num::U64 => (Num::U64, "u64"),
                    Num::F32 | Num::F64 => (from, suffix(from)),
                };
                if matches!(from, Num::F32 | Num::F64) {
                    self.g.needs_real_text();
                }
                let e = self.as_num(&a, from);
                let e = if wide == from { e } else { e.cast(vars::ty(wide)) };
                let e = if a.fails() {
                    let kept = self.temporary();
                    self.out.push(Stmt::Let {
                        mutable: false,
                        name: kept.clone(),
                        ty: vars::ty(wide),
                        value: e,
                    });
                    self.leave_on_fault();
                    Expr::Name(kept)
                } else {
                    e
                };
                self.print_text(e, format!("text_from_{name}"), to, cap, &slot);
            }
            Op::Fb(block, base) => {
                self.settle();
                let Some(slot) = self.g.vars.slot(base.0).cloned() else { return };
                let Shape::Fb(kind) = slot.shape else {
                    return self.g.cannot("a block without a declaration");
                };
                if base.0 != slot.start {
                    return self.g.cannot("a table of function blocks");
                }
                let place = self.own_place(base.0, slot.place());
                let mut args = vec![place.passed()];
                if matches!(block, g7_engine::Block::Ton | g7_engine::Block::Tof | g7_engine::Block::Tp) {
                    args.push(Expr::name("s").field("now"));
                }
                self.out.push(Stmt::Do(Expr::call(block_names(kind).1, args)));
                for i in written_by(block) {
                    self.wrote(base.0 + i, None);
                }
            }
            Op::Service(service) => self.service(service),
            Op::Random(_) => {
                self.g.cannot("a random number");
                self.stack.push(Entry::Word(0));
            }
            _ => {}
        }
    }

    fn print_text(&mut self, e: Expr, f: String, to: Addr, cap: u16, slot: &vars::Slot) {
        let place = self.text_place(to.0, slot);
        self.out.push(Stmt::Do(Expr::call(f, vec![e, place.passed(), Expr::size(cap.into())])));
        self.wrote(to.0, None);
        self.stack.push(Entry::Word(to.0.into()));
    }

    fn text_place(&mut self, addr: u32, slot: &vars::Slot) -> Expr {
        let place = match slot.shape {
            Shape::Texts(cap, _) => {
                slot.place().at(Expr::size(((addr - slot.start) / vars::text_words(cap)) as usize))
            }
            _ => slot.place(),
        };
        self.own_place(addr, place)
    }

    fn store(&mut self, a: Addr) {
        let entry = self.pop();
        self.settle();
        // A word without a declaration has the kind of what is put into it.
        if !self.g.is_declared(a.0)
            && let Entry::Typed { kind: Kind::Num(n), .. } = &entry
        {
            self.g.vars.hidden.entry(a.0).or_insert(*n);
        }
        let target = self.load(a.0);
        let (place, n) = match target {
            Entry::Typed { e, kind: Kind::Num(n), .. } => (e, n),
            Entry::Hidden(addr, e) => {
                let n = self.g.vars.hidden.get(&addr).copied();
                // Its kind may show elsewhere, in the round to come.
                let from = if let Entry::Hidden(from, _) = &entry {
                    self.g.vars.hidden.get(from).copied()
                } else {
                    None
                };
                let n = n.or(from).unwrap_or(Num::I64);
                if let (Entry::Hidden(..), Some(n)) = (&entry, from) {
                    self.g.vars.hidden.entry(addr).or_insert(n);
                }
                (e, n)
            }
            _ => return,
        };
        let value = match &entry {
            Entry::Hidden(from, e) if !self.g.vars.hidden.contains_key(from) => e.clone(),
            _ => self.as_num(&entry, n),
        };
        self.assign(place, n, value, entry.fails());
        self.wrote(a.0, None);
    }

    fn assign(&mut self, place: Expr, n: Num, value: Expr, fails: bool) {
        if fails {
            let name = self.temporary();
            self.out.push(Stmt::Let { mutable: false, name: name.clone(), ty: vars::ty(n), value });
            self.leave_on_fault();
            self.out.push(Stmt::set(place, Expr::Name(name)));
        } else {
            self.out.push(Stmt::set(place, value));
        }
    }

    fn store_at(&mut self, base: Addr, len: u32) {
        let (value, i) = (self.pop(), self.pop());
        self.settle();
        let Some(slot) = self.g.vars.slot(base.0).cloned() else {
            return self.g.cannot("a table without a declaration");
        };
        let n = match slot.shape {
            Shape::Many(n, _) | Shape::One(n) => n,
            Shape::Text(_) | Shape::Texts(..) | Shape::Fb(_) => return self.g.cannot("a table of texts"),
        };
        // The value comes first: its index is judged behind it.
        let e = self.as_num(&value, n);
        let i = self.as_num(&i, Num::I64);
        let (index, name) = (self.temporary(), self.temporary());
        let i = {
            // What the index needs may fail before the value does.
            if value.fails() {
                let first = self.temporary();
                let i = match i {
                    Expr::Int(k, _) => Expr::Int(k, Some(Ty::I64)),
                    other => other,
                };
                self.out.push(Stmt::Let { mutable: false, name: first.clone(), ty: Ty::I64, value: i });
                Expr::Name(first)
            } else {
                i
            }
        };
        self.out.push(Stmt::Let { mutable: false, name: name.clone(), ty: vars::ty(n), value: e });
        let i = self.index(i, len);
        self.out.push(Stmt::Let { mutable: false, name: index.clone(), ty: Ty::Size, value: i });
        self.leave_on_fault();
        let place = self.own_place(base.0, slot.place());
        let place =
            if matches!(slot.shape, Shape::One(_)) { place } else { place.at(Expr::name(index.clone())) };
        self.out.push(Stmt::set(place, Expr::Name(name)));
        self.wrote(base.0, Some(Expr::Name(index)));
    }

    fn text(&mut self, function: Builtin, to: Addr, cap: u16) {
        let count = match function {
            Builtin::Len => 1,
            Builtin::Left | Builtin::Right | Builtin::Concat | Builtin::Find => 2,
            Builtin::Replace => 4,
            _ => 3,
        };
        let from = self.stack.len().saturating_sub(count);
        // Numbers that wait are worked out now, in their order.
        let texts = match function {
            Builtin::Concat | Builtin::Find | Builtin::Insert | Builtin::Replace => 2,
            _ => 1,
        };
        if self.stack.iter().skip(from).any(Entry::fails) {
            self.settle();
            self.leave_on_fault();
        }
        let entries = self.stack.split_off(from);
        let mut args = Vec::new();
        for (i, e) in entries.iter().enumerate() {
            args.push(if i < texts { self.as_kind(e, Kind::Text) } else { self.as_num(e, Num::I64) });
        }
        let name = format!("text_{}", format!("{function:?}").to_lowercase());
        if matches!(function, Builtin::Len | Builtin::Find) {
            let e = Expr::Call(name, args);
            self.stack.push(Entry::of(e, Num::I64));
            return;
        }
        self.settle();
        let Some(slot) = self.g.vars.slot(to.0).cloned() else { return };
        let place = self.text_place(to.0, &slot);
        args.extend([place.passed(), Expr::size(cap.into())]);
        let fails = !matches!(function, Builtin::Concat);
        if fails {
            args.push(Expr::name("s").field("fault").passed());
        }
        self.out.push(Stmt::Do(Expr::Call(name, args)));
        if fails {
            self.leave_on_fault();
        }
        self.wrote(to.0, None);
        self.stack.push(Entry::Word(to.0.into()));
    }

    fn service(&mut self, service: Service) {
        self.settle();
        let m = || Expr::name("s").field("m");
        let call = |name, args| Stmt::Do(Expr::call(name, args));
        let bit = |name, field, i| call(name, vec![m().field(field).passed(), i]);
        // A request takes back what was asked for the same steps before.
        let asked = match service {
            Service::ResetTimes => return self.out.push(call("reset_times", vec![Expr::name("s")])),
            Service::Start => vec![Stmt::set(m().field("ask_start"), Expr::Bool(true))],
            Service::Init(g) | Service::Clear(g) => {
                let field = if matches!(service, Service::Init(_)) { "ask_init" } else { "ask_clear" };
                let i = || Expr::size(g.0 as usize);
                vec![bit("bit_set", field, i()), call("forget_sets", vec![Expr::name("s"), i()])]
            }
            Service::Set(step) => {
                let i = || self.g.step(step);
                vec![bit("bit_set", "ask_set", i()), bit("bit_clear", "ask_reset", i())]
            }
            Service::Reset(step) => {
                let i = || self.g.step(step);
                vec![bit("bit_set", "ask_reset", i()), bit("bit_clear", "ask_set", i())]
            }
        };
        self.out.extend(asked);
        self.out.push(Stmt::set(m().field("requests"), Expr::Bool(true)));
    }
}
