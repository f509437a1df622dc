//! Beginning, restart, safety, and whether two pictures are the same.

use g7_engine::Num;
use g7_model::{Type, say};

use crate::build::{Gen, s, state};
use crate::operations::differ;
use crate::tree::{Block, Const, Expr, Function, Known, Module, Stmt, Ty};
use crate::vars::{Home, Shape, Slot, literal, members, text_bytes, text_words};

impl Gen<'_> {
    /// The functions round the scan.
    pub(crate) fn frame(&mut self) {
        let slots: Vec<Slot> = self.vars.slots.values().cloned().collect();
        let mut body = vec![Stmt::Clear(Expr::Deref(Box::new(s())), Ty::Named("State".into()))];
        for slot in slots.iter().filter(|s| matches!(s.home, Home::Inputs | Home::Outputs | Home::Variables))
        {
            let words = self.words(slot);
            body.extend(self.given(slot, slot.place(), &words));
        }
        self.offer("init", "Before the first scan, or for a cold restart.", body);
        self.restart(&slots);
        self.safety(&slots);
        for slot in slots.iter().filter(|s| s.home == Home::Constant) {
            let words = self.words(slot);
            let values = self.all_values(slot, &words);
            let value = match slot.shape {
                Shape::One(_) => values.into_iter().next().map(Known::One),
                _ => Some(Known::Many(values)),
            };
            let Some(value) = value else { continue };
            let (name, note, ty) = (slot.field.to_uppercase(), slot.note.clone(), slot.ty());
            if matches!(slot.shape, Shape::Texts(..)) {
                self.cannot(say!("a constant table of texts"));
            }
            self.m.consts.push(Const { public: false, note, name, ty, value });
        }
    }

    /// The functions by which the runtime tells the numbers of steps and transitions.
    pub(crate) fn limits(&mut self) {
        let number = |n: Num, v: Expr| if n == Num::I64 { v } else { v.cast(crate::vars::ty(n)) };
        if let Some((steps, transitions)) = self.t.counts {
            let mut body = self.assign(steps.0, Type::Int, |n| number(n, Expr::name("steps")));
            body.extend(self.assign(transitions.0, Type::Int, |n| number(n, Expr::name("transitions"))));
            let parameters = vec![state(), ("steps".into(), Ty::I64), ("transitions".into(), Ty::I64)];
            self.function("write_counts", "", parameters, body);
        }
        if let Some((flag, _)) = self.t.limits {
            let body = self.assign(flag.0, Type::Bool, |n| literal(n, 1));
            self.function("write_overflow", "", vec![state()], body);
        }
    }

    fn offer(&mut self, name: &str, note: &str, body: Block) {
        self.m.functions.push(Function {
            public: true,
            note: note.into(),
            name: name.into(),
            parameters: vec![state()],
            result: None,
            body,
        });
    }

    fn words(&self, slot: &Slot) -> Vec<u64> {
        let range = slot.start as usize..(slot.start + slot.words) as usize;
        self.t.init.get(range).unwrap_or(&[]).to_vec()
    }

    /// Every value of a slot, in order; of texts their bytes.
    fn all_values(&self, slot: &Slot, words: &[u64]) -> Vec<Expr> {
        match slot.shape {
            Shape::One(n) | Shape::Many(n, _) => words.iter().map(|w| literal(n, *w)).collect(),
            Shape::Text(cap) => words_bytes(words, cap).into_iter().map(|b| Expr::size(b.into())).collect(),
            Shape::Texts(..) | Shape::Fb(_) => Vec::new(),
        }
    }

    /// Gives a variable a value that is not all zero.
    fn given(&self, slot: &Slot, place: Expr, words: &[u64]) -> Block {
        let mut all = Block::new();
        match slot.shape {
            Shape::One(n) => {
                if words.first().is_some_and(|w| *w != 0) {
                    all.push(Stmt::set(place, literal(n, words.first().copied().unwrap_or(0))));
                }
            }
            Shape::Many(n, _) => {
                for (i, w) in words.iter().enumerate().filter(|(_, w)| **w != 0) {
                    all.push(Stmt::set(place.clone().at(Expr::size(i)), literal(n, *w)));
                }
            }
            Shape::Text(cap) => all.extend(text_given(&place, words, cap)),
            Shape::Texts(cap, _) => {
                for (i, words) in words.chunks(text_words(cap) as usize).enumerate() {
                    all.extend(text_given(&place.clone().at(Expr::size(i)), words, cap));
                }
            }
            Shape::Fb(kind) => {
                for ((name, n), w) in members(kind).iter().zip(words).filter(|(_, w)| **w != 0) {
                    all.push(Stmt::set(place.clone().field(*name), literal(*n, *w)));
                }
            }
        }
        all
    }

    /// A restart that keeps what is to be kept.
    fn restart(&mut self, slots: &[Slot]) {
        let mut body = Block::new();
        let mut back = Block::new();
        let homes = [
            (Home::Variables, "v", "Variables"),
            (Home::Outputs, "outputs", "Outputs"),
            (Home::Inputs, "inputs", "Inputs"),
        ];
        for (home, field, ty) in homes {
            let kept: Vec<&Slot> = slots.iter().filter(|s| s.home == home && s.retain).collect();
            if kept.is_empty() {
                continue;
            }
            let name = format!("kept_{field}");
            body.push(Stmt::Let {
                mutable: false,
                name: name.clone(),
                ty: Ty::Named(ty.into()),
                value: s().field(field),
            });
            for slot in kept {
                back.push(Stmt::set(slot.place(), Expr::name(name.clone()).field(slot.field.clone())));
            }
        }
        body.push(Stmt::Do(Expr::call("init", vec![s()])));
        body.extend(back);
        for (addr, on) in [(self.c.symbols.s0, 0), (self.c.symbols.s1, 1)] {
            if let Some(addr) = addr {
                body.extend(self.assign(addr.0, Type::Bool, |n| literal(n, on)));
            }
        }
        self.offer("restart", "A warm restart: retained variables keep their values.", body);
    }

    fn safety(&mut self, slots: &[Slot]) {
        let mut body = vec![Stmt::Clear(s().field("outputs"), Ty::Named("Outputs".into()))];
        for slot in slots.iter().filter(|s| s.home == Home::Outputs) {
            let from = (slot.start - self.t.outputs.start) as usize;
            let words = self.t.safe.get(from..from + slot.words as usize).unwrap_or(&[]).to_vec();
            body.extend(self.given(slot, slot.place(), &words));
        }
        self.function("to_safety", "Outputs to their safe values.", vec![state()], body);
    }
}

/// The bytes of a text in the words of the engine, as the code has them.
fn words_bytes(words: &[u64], cap: u16) -> Vec<u8> {
    let len = words.first().copied().unwrap_or(0).min(cap.into());
    let bytes: Vec<u8> = words.iter().skip(1).flat_map(|w| w.to_le_bytes()).take(len as usize).collect();
    text_bytes(&bytes, usize::from(cap))
}

fn text_given(place: &Expr, words: &[u64], cap: u16) -> Block {
    let bytes = words_bytes(words, cap);
    let set = |(i, b): (usize, &u8)| Stmt::set(place.clone().at(Expr::size(i)), Expr::size((*b).into()));
    bytes.iter().enumerate().filter(|(_, b)| **b != 0).map(set).collect()
}

/// Functions that compare structures, where some are called. Steps are compared anyway, so
/// what follows them is not.
pub(crate) fn comparisons(m: &mut Module) {
    let called = |m: &Module, f: &str| {
        let mut found = false;
        for function in &m.functions {
            for stmt in &function.body {
                stmt.walk(&mut |e| found |= matches!(e, Expr::Call(name, _) if name == f));
            }
        }
        found
    };
    let wanted = [("same_memory", "Memory"), ("same_variables", "Variables"), ("same_outputs", "Outputs")];
    let mut new = Vec::new();
    for (f, name) in wanted.into_iter().filter(|(f, _)| called(m, f)) {
        let Some(of) = m.structs.iter().find(|s| s.name == name) else { continue };
        let mut body = Block::new();
        // A field of the memory may have the name of an output.
        let follows = |name: &str| of.name != "Memory" && m.followers.contains(name);
        for field in of.fields.iter().filter(|f| !follows(&f.name)) {
            let (a, b) =
                (Expr::name("a").field(field.name.clone()), Expr::name("b").field(field.name.clone()));
            body.extend(same(m, &field.ty, a, b, 0));
        }
        body.push(Stmt::Return(Some(Expr::Bool(true))));
        let of = || Ty::Ref(false, Box::new(Ty::Named(name.into())));
        new.push(Function {
            public: false,
            note: String::new(),
            name: f.into(),
            parameters: vec![("a".into(), of()), ("b".into(), of())],
            result: Some(Ty::Bool),
            body,
        });
    }
    m.functions.extend(new);
}

fn same(m: &Module, ty: &Ty, a: Expr, b: Expr, depth: usize) -> Block {
    let leave = || vec![Stmt::Return(Some(Expr::Bool(false)))];
    match ty {
        Ty::Array(_, 0) => Block::new(),
        Ty::Array(of, n) => {
            let i = ["i", "j", "k"].get(depth).copied().unwrap_or("l");
            let inner = same(m, of, a.at(Expr::name(i)), b.at(Expr::name(i)), depth + 1);
            vec![Stmt::For(i.into(), Expr::size(0), Expr::size(*n), inner)]
        }
        Ty::Named(name) => {
            let fields =
                m.structs.iter().find(|s| s.name == *name).map(|s| s.fields.clone()).unwrap_or_default();
            let each = |f: &crate::tree::Field| {
                same(m, &f.ty, a.clone().field(f.name.clone()), b.clone().field(f.name.clone()), depth)
            };
            fields.iter().flat_map(each).collect()
        }
        Ty::Real { bits } => {
            let n = if *bits == 32 { Num::F32 } else { Num::F64 };
            Stmt::when(differ(n, a, b), leave())
        }
        _ => Stmt::when(a.bin(crate::tree::Bin::Ne, b), leave()),
    }
}
