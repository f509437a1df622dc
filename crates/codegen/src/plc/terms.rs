//! Expressions of the equations as those of IEC 61131-3, with its types.

use g7_engine::{Arith, Builtin, Cmp};
use g7_equations::{Class, Expr, MemoryId, What};
use g7_model::{Nanos, Said, Type, say};

use super::form::{Ex, narrow};
use super::memories::literal;
use super::scan::Scan;
use crate::spare::widens;

/// A tenth of a second.
const TENTH: Nanos = Nanos::from_millis(100);

impl Scan<'_> {
    /// An expression.
    pub(super) fn ex(&mut self, e: &Expr) -> Ex {
        match e {
            Expr::Const(ty, word) => literal(*ty, *word),
            Expr::Text(_) => self.cannot_ex(say!("a text")),
            Expr::Read(m) => self.read(*m),
            Expr::Element(m, index) => {
                let index = narrow(self.ex(index));
                // The only element of a table is a variable.
                match self.elements(*m) {
                    Some(_) => Ex::Index(self.memories.name(*m).to_owned(), Box::new(index)),
                    None => self.read(*m),
                }
            }
            Expr::Not(x) => self.ex(x).not(),
            Expr::And(list) => Ex::all(list.iter().map(|e| self.ex(e)).collect::<Vec<_>>()),
            Expr::Or(list) => Ex::any(list.iter().map(|e| self.ex(e)).collect::<Vec<_>>()),
            Expr::Xor(a, b) => self.ex(a).xor(self.ex(b)),
            Expr::Neg(Type::Time, x) => Ex::op("-", Ex::Time(Nanos::ZERO), self.ex(x)),
            Expr::Neg(_, x) => Ex::Neg(Box::new(self.ex(x))),
            Expr::Arith(op, ty, a, b) => self.arith(*op, *ty, a, b),
            Expr::Compare(c, ty, a, b) => self.compare(*c, *ty, a, b),
            Expr::Differs(ty, a, b) => self.differs(*ty, a, b),
            Expr::Convert(from, to, x) => self.convert(*from, *to, x),
            Expr::Trunc(_, _, x) => Ex::call("TRUNC", vec![self.ex(x)]),
            Expr::Call(f, ty, args) => self.call(*f, *ty, args),
            Expr::Random(_) => self.cannot_ex(say!("a random number")),
            Expr::Fails(_) => self.cannot_ex(say!("a text")),
        }
    }

    /// An expression where a value of a type is wanted: words of the engine carry
    /// no type, those of the standard do.
    pub(super) fn ex_as(&mut self, ty: Type, e: &Expr) -> Ex {
        match self.type_of(e) {
            Some(from) if from != ty && whole(from) && whole(ty) => self.convert(from, ty, e),
            _ => self.ex(e),
        }
    }

    fn cannot_ex(&mut self, what: Said) -> Ex {
        self.cannot(what);
        Ex::Bool(false)
    }

    fn read(&mut self, m: MemoryId) -> Ex {
        let Some(memory) = self.e.memory(m) else { return Ex::Bool(false) };
        match (memory.what, memory.class, memory.ty) {
            (What::Started, ..) => Ex::var("FIRST").not(),
            (_, _, Type::String(_)) => self.cannot_ex(say!("a text")),
            // A constant stands for its value.
            (_, Class::Constant, ty) if memory.elements == 1 => {
                literal(ty, memory.init.first().copied().unwrap_or(0))
            }
            _ => Ex::var(self.memories.name(m)),
        }
    }

    fn type_of(&self, e: &Expr) -> Option<Type> {
        Some(match e {
            Expr::Const(ty, _)
            | Expr::Neg(ty, _)
            | Expr::Arith(_, ty, ..)
            | Expr::Convert(_, ty, _)
            | Expr::Trunc(_, ty, _)
            | Expr::Call(_, ty, _) => *ty,
            Expr::Read(m) | Expr::Element(m, _) => self.e.memory(*m)?.ty,
            Expr::Text(_) => return None,
            Expr::Random(_) => Type::Lreal,
            _ => Type::Bool,
        })
    }

    fn arith(&mut self, op: Arith, ty: Type, a: &Expr, b: &Expr) -> Ex {
        let sign = match op {
            Arith::Add => "+",
            Arith::Sub => "-",
            Arith::Mul => "*",
            Arith::Div => "/",
            Arith::Mod => "MOD",
            Arith::Pow => {
                let args = vec![self.ex(a), self.ex(b)];
                return Ex::call("EXPT", args);
            }
        };
        if ty == Type::Time && matches!(op, Arith::Mul | Arith::Div | Arith::Mod) {
            return self.scaled(op, sign, a, b);
        }
        let (x, y) = self.alike(a, b);
        Ex::op(sign, x, y)
    }

    /// Two operands of one type: the standard has no operator for an INT beside a LINT, which are both words of the
    /// engine.
    fn alike(&mut self, a: &Expr, b: &Expr) -> (Ex, Ex) {
        // A constant is written without a type.
        let typed = |s: &Self, e: &Expr| s.type_of(e).filter(|_| !matches!(e, Expr::Const(..)));
        match (typed(self, a), typed(self, b)) {
            (Some(x), Some(y)) if x != y && whole(x) && whole(y) => {
                let both = if widens(x, y) { y } else { x };
                (self.ex_as(both, a), self.ex_as(both, b))
            }
            _ => (self.ex(a), self.ex(b)),
        }
    }

    /// A TIME times or by a number; the standard has the TIME on the left.
    fn scaled(&mut self, op: Arith, sign: &'static str, a: &Expr, b: &Expr) -> Ex {
        let number = |s: &Self, e: &Expr| match e {
            Expr::Convert(from, Type::Time, x) if *from != Type::Time => Some((**x).clone()),
            Expr::Const(Type::Time, w) => Some(Expr::Const(Type::Lint, *w)),
            e if s.type_of(e) != Some(Type::Time) => Some(e.clone()),
            _ => None,
        };
        let found = match (op, number(self, a), number(self, b)) {
            (Arith::Mul | Arith::Div, _, Some(k)) => Some((a, k)),
            (Arith::Mul, Some(k), _) => Some((b, k)),
            _ => None,
        };
        let Some((time, k)) = found else { return self.cannot_ex(say!("a TIME taken as a number")) };
        Ex::op(sign, self.ex(time), narrow(self.ex(&k)))
    }

    fn compare(&mut self, c: Cmp, ty: Type, a: &Expr, b: &Expr) -> Ex {
        let sign = match c {
            Cmp::Eq => "=",
            Cmp::Ne => "<>",
            Cmp::Lt => "<",
            Cmp::Le => "<=",
            Cmp::Gt => ">",
            Cmp::Ge => ">=",
        };
        if let Some(e) = self.tenths(sign, a, b) {
            return e;
        }
        let (x, mut y) = self.alike(a, b);
        // A TIME is divided by a number, which is asked for 0.
        if let (Type::Time, Ex::Time(n)) = (ty, &y)
            && self.type_of(a).is_some_and(whole)
        {
            y = Ex::Int(n.count().into());
        }
        // A number that was only made wider is compared with a constant as it is.
        let (x, y) = match (a, b) {
            (Expr::Convert(from, to, _), Expr::Const(_, w)) if widens(*from, *to) && fits(*from, *w) => {
                (narrow_from(*from, x), y)
            }
            _ => (x, y),
        };
        // Bit strings are only equal or not; their order is that of numbers.
        let (x, y) = match ty.unsigned().filter(|_| !matches!(sign, "=" | "<>")) {
            Some(number) => (as_number(x, ty, number), as_number(y, ty, number)),
            None => (x, y),
        };
        match (sign, &x, &y) {
            ("=", _, Ex::Bool(true)) | ("<>", _, Ex::Bool(false)) => x,
            ("=", _, Ex::Bool(false)) | ("<>", _, Ex::Bool(true)) => x.not(),
            ("<>", ..) if ty == Type::Bool => x.xor(y),
            ("=", ..) if ty == Type::Bool => x.xor(y).not(),
            // FALSE is below TRUE; Instruction List of matiec does not know that.
            ("<", ..) if ty == Type::Bool => x.not().and(y),
            ("<=", ..) if ty == Type::Bool => x.not().or(y),
            (">", ..) if ty == Type::Bool => x.and(y.not()),
            (">=", ..) if ty == Type::Bool => x.or(y.not()),
            _ => Ex::op(sign, x, y),
        }
    }

    /// The time of a step in tenths of a second, against a number: the TIME against
    /// so many tenths.
    fn tenths(&mut self, sign: &'static str, a: &Expr, b: &Expr) -> Option<Ex> {
        let (time, number, sign) = match (self.in_tenths(a), self.in_tenths(b)) {
            (Some(time), None) => (time, b, sign),
            (None, Some(time)) => {
                let turned = match sign {
                    "<" => ">",
                    "<=" => ">=",
                    ">" => "<",
                    ">=" => "<=",
                    same => same,
                };
                (time, a, turned)
            }
            _ => return None,
        };
        let Expr::Const(_, word) = number else { return None };
        let number = *word as i64;
        if !(0..9998).contains(&number) {
            return None;
        }
        let at = |n: i64| Ex::Time(TENTH * n);
        let time = self.ex(&time);
        let from = |n: i64| Ex::op(">=", time.clone(), at(n));
        let below = |n: i64| Ex::op("<", time.clone(), at(n));
        Some(match sign {
            ">=" => from(number),
            ">" => from(number + 1),
            "<" => below(number),
            "<=" => below(number + 1),
            "=" => from(number).and(below(number + 1)),
            _ => below(number).or(from(number + 1)),
        })
    }

    /// The TIME that an expression gives in tenths of a second, at most 9999.
    fn in_tenths(&self, e: &Expr) -> Option<Expr> {
        match e {
            Expr::Convert(Type::Lint | Type::Int, _, x) => self.in_tenths(x),
            Expr::Call(Builtin::Min, Type::Lint, args) => match args.as_slice() {
                [Expr::Arith(Arith::Div, Type::Lint, x, by), Expr::Const(..)]
                    if **by == Expr::long(TENTH.count()) =>
                {
                    match &**x {
                        Expr::Convert(Type::Time, Type::Lint, time) => Some((**time).clone()),
                        _ => None,
                    }
                }
                _ => None,
            },
            _ => None,
        }
    }

    fn differs(&mut self, ty: Type, a: &Expr, b: &Expr) -> Ex {
        if let (Expr::Read(x), Expr::Read(y)) = (a, b)
            && let Some(n) = self.elements(*x)
        {
            let (x, y) = (self.memories.name(*x).to_owned(), self.memories.name(*y).to_owned());
            let at = |name: &str, i: u32| Ex::Index(name.to_owned(), Box::new(Ex::Int(i.into())));
            let each = (0..n).map(|i| unequal(ty, at(&x, i), at(&y, i))).collect::<Vec<_>>();
            return Ex::any(each);
        }
        let (x, y) = self.alike(a, b);
        unequal(ty, x, y)
    }

    fn convert(&mut self, from: Type, to: Type, x: &Expr) -> Ex {
        let from = self.type_of(x).filter(|ty| whole(*ty) && whole(from)).unwrap_or(from);
        if from == to {
            return self.ex(x);
        }
        if matches!(from, Type::String(_)) || matches!(to, Type::String(_)) {
            return self.cannot_ex(say!("a text"));
        }
        if to == Type::Time
            && let Expr::Arith(op @ (Arith::Mul | Arith::Div), _, time, by) = x
            && let Expr::Convert(Type::Time, _, time) = &**time
            && from.is_real()
        {
            let sign = if *op == Arith::Mul { "*" } else { "/" };
            return Ex::op(sign, self.ex(time), self.ex(by));
        }
        if from == Type::Time || to == Type::Time {
            return match x {
                Expr::Const(..) if to == Type::Time => match self.ex(x) {
                    Ex::Int(n) => Ex::Time(i64::try_from(n).map_or(Nanos::MAX, Nanos::new)),
                    _ => self.cannot_ex(say!("a TIME taken as a number")),
                },
                _ => self.cannot_ex(say!("a TIME taken as a number")),
            };
        }
        let e = self.ex(x);
        match (&e, from, to) {
            (_, _, Type::Bool) => Ex::op("<>", e, literal(from, 0)),
            // Not every system has conversions of constants to all types.
            (Ex::Bool(b), ..) if to.is_real() => Ex::Real(f64::from(u8::from(*b))),
            (Ex::Bool(b), ..) => literal(to, (*b).into()),
            (Ex::Bits(_, word), ..) if to.is_bits() => literal(to, *word),
            (Ex::Int(n), ..) if to.is_real() => Ex::Real(*n as f64),
            (Ex::Int(_), ..) if !to.is_bits() => e,
            _ => Ex::call(format!("{}_TO_{}", from.name(), to.name()), vec![e]),
        }
    }

    fn call(&mut self, f: Builtin, ty: Type, args: &[Expr]) -> Ex {
        if f.is_of_texts() || matches!(ty, Type::String(_)) {
            return self.cannot_ex(say!("a text"));
        }
        if f.shifts()
            && let [bits, count] = args
        {
            return self.shifted(f, ty, bits, count);
        }
        let mut list: Vec<Ex> = args.iter().map(|e| self.ex(e)).collect();
        if f == Builtin::Mux
            && let Some(k) = list.first_mut()
        {
            *k = narrow(std::mem::replace(k, Ex::Bool(false)));
        }
        Ex::call(name(f), list)
    }
}

impl Scan<'_> {
    /// Shifts are those of bit strings. What they do by the width and more differs among systems,
    /// so it is never asked for.
    fn shifted(&mut self, f: Builtin, ty: Type, bits: &Expr, count: &Expr) -> Ex {
        let string = ty.bit_string().unwrap_or(ty);
        let (true, Some(row)) = (string.is_bits(), ty.elementary()) else {
            return self.cannot_ex(say!("a shift of this type"));
        };
        let width = i128::from(row.bits);
        let as_bits = |e: Ex| if ty == string { e } else { Ex::call(format!("{ty}_TO_{string}"), vec![e]) };
        let x = as_bits(self.ex(bits));
        let by = |n: Ex| {
            let shifted = Ex::call(name(f), vec![x, n]);
            if ty == string { shifted } else { Ex::call(format!("{string}_TO_{ty}"), vec![shifted]) }
        };
        let nothing = literal(ty, 0);
        let ring = matches!(f, Builtin::Rol | Builtin::Ror);
        match narrow(self.ex(count)) {
            Ex::Int(n) if ring => by(Ex::Int(n % width)),
            Ex::Int(n) if n >= width => nothing,
            Ex::Int(n) => by(Ex::Int(n)),
            n if ring => by(Ex::op("MOD", n, Ex::Int(width))),
            n => {
                let beyond = Ex::op(">=", n.clone(), Ex::Int(width));
                Ex::call("SEL", vec![beyond, by(Ex::call("MIN", vec![n, Ex::Int(width - 1)])), nothing])
            }
        }
    }
}

/// An integer type.
fn whole(ty: Type) -> bool {
    !ty.is_real() && !matches!(ty, Type::Bool | Type::Time | Type::String(_) | Type::Fb(_))
}

/// The name of a function there.
fn name(f: Builtin) -> String {
    match f {
        Builtin::BitAnd => "AND".to_owned(),
        Builtin::BitOr => "OR".to_owned(),
        Builtin::BitXor => "XOR".to_owned(),
        _ => format!("{f:?}").to_uppercase(),
    }
}

/// A bit string as a number from 0.
fn as_number(e: Ex, ty: Type, number: Type) -> Ex {
    match e {
        Ex::Bits(_, word) => Ex::Int(word.into()),
        e => Ex::call(format!("{ty}_TO_{number}"), vec![e]),
    }
}

fn unequal(ty: Type, a: Ex, b: Ex) -> Ex {
    if ty == Type::Bool { a.xor(b) } else { Ex::op("<>", a, b) }
}

/// A value that a type has.
fn fits(ty: Type, word: u64) -> bool {
    let v = i128::from(word as i64);
    let (low, high): (i128, i128) = match ty {
        Type::Sint => (i8::MIN.into(), i8::MAX.into()),
        Type::Int => (i16::MIN.into(), i16::MAX.into()),
        Type::Dint => (i32::MIN.into(), i32::MAX.into()),
        Type::Usint => (0, u8::MAX.into()),
        Type::Uint => (0, u16::MAX.into()),
        Type::Udint => (0, u32::MAX.into()),
        _ => return false,
    };
    (low..=high).contains(&v)
}

fn narrow_from(from: Type, e: Ex) -> Ex {
    match e {
        Ex::Call(name, mut args) if args.len() == 1 && name.starts_with(&format!("{}_TO_", from.name())) => {
            args.remove(0)
        }
        other => other,
    }
}
