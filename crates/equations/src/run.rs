//! A plain interpreter of the equations: they run beside the engine in the tests,
//! and whoever reads them can try what they say.

use g7_compile::tree::transfers;
use g7_engine::{Addr, Arith, FaultKind, number, text};
use g7_model::Type;

use crate::fb::expand;
use crate::form::{Class, Expr, MemoryId, Section, Stmt, What};
use crate::whole::Equations;

/// Passes before a state that comes back is looked for, as in the engine.
const PATIENCE: u32 = 48;

/// The content of a memory.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Value {
    /// A number, as the engine's word for it; of a table, one an element.
    Words(Box<[u64]>),
    /// A text, in bytes.
    Text(Vec<u8>),
}

/// Equations that run.
#[derive(Clone, Debug)]
pub struct Machine {
    e: Equations,
    state: Vec<Value>,
    now: i64,
    stopped: bool,
    started: Option<MemoryId>,
    dt: Option<MemoryId>,
}

/// Control leaves the innermost loop, or the scan.
enum Leaves {
    Loop,
    Scan(FaultKind),
}

type Done = Result<(), Leaves>;

impl Machine {
    /// Equations before their first scan.
    pub fn new(e: Equations) -> Machine {
        let state = e.memories.iter().map(|m| first(m.ty, &m.init)).collect();
        let (started, dt) = (e.find(What::Started), e.find(What::Dt));
        Machine { e, state, now: 0, stopped: false, started, dt }
    }

    /// The equations.
    pub fn equations(&self) -> &Equations {
        &self.e
    }

    /// The content of a memory.
    pub fn value(&self, id: MemoryId) -> Option<&Value> {
        self.state.get(id.0 as usize)
    }

    /// The words of the variable at an address, as the engine has them.
    pub fn words(&self, addr: Addr) -> Option<Vec<u64>> {
        match self.value(self.e.find(What::Variable(addr))?)? {
            Value::Words(w) => Some(w.to_vec()),
            Value::Text(bytes) => {
                let chunks = bytes.chunks(8).map(|c| c.iter().rev().fold(0, |a, b| a << 8 | u64::from(*b)));
                Some([bytes.len() as u64].into_iter().chain(chunks).collect())
            }
        }
    }

    /// Gives a memory another value, in the words of the engine.
    pub fn set(&mut self, id: MemoryId, words: &[u64]) {
        let Some(ty) = self.e.memory(id).map(|m| m.ty) else { return };
        if let Some(slot) = self.state.get_mut(id.0 as usize) {
            *slot = first(ty, words);
        }
    }

    /// True if a BOOL memory holds.
    pub fn holds(&self, id: MemoryId) -> bool {
        self.word(id) != 0
    }

    /// The first scan has begun.
    pub fn is_started(&self) -> bool {
        self.started.is_some_and(|m| self.holds(m))
    }

    fn word(&self, id: MemoryId) -> u64 {
        match self.value(id) {
            Some(Value::Words(w)) => w.first().copied().unwrap_or(0),
            Some(Value::Text(_)) | None => 0,
        }
    }

    /// One scan at a time in nanoseconds; inputs are memories, set before.
    ///
    /// # Errors
    ///
    /// The kind of the fault that ended it; then outputs have their safe values
    /// and every further scan is refused.
    pub fn scan(&mut self, now: i64) -> Result<(), FaultKind> {
        let done = self.try_scan(now);
        if done.is_err() {
            self.stopped = true;
            for (id, words) in self.e.safe.clone() {
                self.set(id, &words);
            }
        }
        done
    }

    fn try_scan(&mut self, now: i64) -> Result<(), FaultKind> {
        if self.stopped {
            return Err(FaultKind::Stopped);
        }
        let started = self.is_started();
        if started && now < self.now {
            return Err(FaultKind::Inputs);
        }
        let dt = if started { now.wrapping_sub(self.now) } else { 0 };
        self.now = now;
        if let Some(m) = self.dt {
            self.set(m, &[dt as u64]);
        }
        self.sections(|e| &e.begin)?;
        self.search()?;
        self.sections(|e| &e.finish)
    }

    /// One pass.
    ///
    /// # Errors
    ///
    /// The kind of the fault that ended it.
    pub fn pass(&mut self) -> Result<(), FaultKind> {
        self.sections(|e| &e.pass)
    }

    /// The value of a query, on the state as it is.
    ///
    /// # Errors
    ///
    /// The fault of its arithmetic; [`FaultKind::Range`] where there is no such query.
    pub fn ask(&mut self, query: usize) -> Result<u64, FaultKind> {
        let e = std::mem::take(&mut self.e);
        let mut run = Run { e: &e, state: &mut self.state };
        let value = match e.questions.get(query) {
            Some((before, value)) => match run.all(before) {
                Ok(()) | Err(Leaves::Loop) => Ok(run.number(value)),
                Err(Leaves::Scan(kind)) => Err(kind),
            },
            None => Err(FaultKind::Range),
        };
        self.e = e;
        value
    }

    fn sections(&mut self, which: fn(&Equations) -> &[Section]) -> Result<(), FaultKind> {
        // The statements are taken out while they run, so that the state is free.
        let e = std::mem::take(&mut self.e);
        let mut run = Run { e: &e, state: &mut self.state };
        let done = which(&e).iter().try_for_each(|s| run.all(&s.body));
        self.e = e;
        match done {
            Ok(()) | Err(Leaves::Loop) => Ok(()),
            Err(Leaves::Scan(kind)) => Err(kind),
        }
    }

    /// Passes until nothing changes. A state that comes back within a scan comes
    /// back for ever (Brent's search, as in the engine).
    fn search(&mut self) -> Result<(), FaultKind> {
        let Some((changed, bound)) = self.e.search else { return self.pass() };
        let (mut power, mut distance, mut made) = (1u32, 0u32, 0u32);
        let mut saved = Vec::new();
        loop {
            self.pass()?;
            if !self.holds(changed) {
                return Ok(());
            }
            made += 1;
            if made >= bound {
                return Err(FaultKind::Bound);
            }
            if made < PATIENCE {
                continue;
            }
            if made > PATIENCE {
                distance += 1;
                if saved == self.image() {
                    return Err(FaultKind::Unstable { cycle: distance });
                }
            }
            if made == PATIENCE || distance == power {
                saved = self.image();
                power = if made == PATIENCE { 1 } else { power.saturating_mul(2) };
                distance = 0;
            }
        }
    }

    /// All that decides the future.
    pub fn image(&self) -> Vec<Value> {
        let lasts = |class| matches!(class, Class::Kept | Class::Output);
        let pairs = self.e.memories.iter().zip(&self.state);
        pairs.filter(|(m, _)| lasts(m.class)).map(|(_, v)| v.clone()).collect()
    }
}

/// A value from the words of the engine.
fn first(ty: Type, words: &[u64]) -> Value {
    match ty {
        Type::String(_) => {
            let len = words.first().map_or(0, |w| *w as usize);
            Value::Text(words.iter().skip(1).flat_map(|w| w.to_le_bytes()).take(len).collect())
        }
        _ => Value::Words(words.into()),
    }
}

/// The value of an expression.
#[derive(Clone, Debug)]
enum Given {
    Word(u64),
    Words(Box<[u64]>),
    Text(Vec<u8>),
}

struct Run<'a> {
    e: &'a Equations,
    state: &'a mut Vec<Value>,
}

impl Run<'_> {
    fn all(&mut self, list: &[Stmt]) -> Done {
        list.iter().try_for_each(|s| self.stmt(s))
    }

    fn stmt(&mut self, s: &Stmt) -> Done {
        match s {
            Stmt::Set(to, e) => {
                let value = self.eval(e);
                self.store(*to, value);
            }
            Stmt::SetElement(to, index, e) => {
                let (index, value) = (self.number(index) as usize, self.number(e));
                if let Some(Value::Words(w)) = self.state.get_mut(to.0 as usize)
                    && let Some(w) = w.get_mut(index)
                {
                    *w = value;
                }
            }
            Stmt::If(e, then, other) => {
                let list = if self.number(e) != 0 { then } else { other };
                self.all(list)?;
            }
            Stmt::Loop(body) => loop {
                match self.all(body) {
                    Ok(()) => {}
                    Err(Leaves::Loop) => break,
                    Err(scan) => return Err(scan),
                }
            },
            Stmt::Exit => return Err(Leaves::Loop),
            Stmt::Fault(kind, _) => return Err(Leaves::Scan(*kind)),
            Stmt::Call(block, memories) => self.all(&expand(*block, memories))?,
            Stmt::About(_) => {}
        }
        Ok(())
    }

    fn store(&mut self, to: MemoryId, value: Given) {
        let cap = match self.e.memory(to).map(|m| m.ty) {
            Some(Type::String(n)) => usize::from(n),
            _ => 0,
        };
        let Some(slot) = self.state.get_mut(to.0 as usize) else { return };
        *slot = match value {
            Given::Word(w) => Value::Words([w].into()),
            Given::Words(w) => Value::Words(w),
            Given::Text(mut bytes) => {
                bytes.truncate(text::cut(&bytes, cap));
                Value::Text(bytes)
            }
        };
    }

    fn number(&self, e: &Expr) -> u64 {
        match self.eval(e) {
            Given::Word(w) => w,
            Given::Words(w) => w.first().copied().unwrap_or(0),
            Given::Text(_) => 0,
        }
    }

    fn bytes(&self, e: &Expr) -> Vec<u8> {
        match self.eval(e) {
            Given::Text(bytes) => bytes,
            Given::Word(_) | Given::Words(_) => Vec::new(),
        }
    }

    fn eval(&self, e: &Expr) -> Given {
        // An operation without a value gives 0, as the form says.
        let zero = |ty: &Type| match ty {
            Type::String(_) => Given::Text(Vec::new()),
            _ => Given::Word(0),
        };
        match e {
            Expr::Const(_, v) => Given::Word(*v),
            Expr::Text(t) => Given::Text(t.as_bytes().to_vec()),
            Expr::Read(m) => match self.state.get(m.0 as usize) {
                Some(Value::Words(w)) if w.len() == 1 => Given::Word(w.first().copied().unwrap_or(0)),
                Some(Value::Words(w)) => Given::Words(w.clone()),
                Some(Value::Text(t)) => Given::Text(t.clone()),
                None => Given::Word(0),
            },
            Expr::Element(m, index) => {
                let i = self.number(index) as usize;
                match self.state.get(m.0 as usize) {
                    Some(Value::Words(w)) => Given::Word(w.get(i).copied().unwrap_or(0)),
                    Some(Value::Text(_)) | None => Given::Word(0),
                }
            }
            Expr::Not(x) => Given::Word(u64::from(self.number(x) == 0)),
            Expr::And(list) => Given::Word(u64::from(list.iter().all(|e| self.number(e) != 0))),
            Expr::Or(list) => Given::Word(u64::from(list.iter().any(|e| self.number(e) != 0))),
            Expr::Xor(a, b) => Given::Word(u64::from((self.number(a) != 0) != (self.number(b) != 0))),
            Expr::Compare(c, Type::String(_), a, b) => {
                let order = self.bytes(a).cmp(&self.bytes(b));
                Given::Word(u64::from(number::ordered(*c, Some(order))))
            }
            Expr::Compare(c, ty, a, b) => {
                let (a, b) = (self.number(a), self.number(b));
                Given::Word(u64::from(number::compare(*c, num(*ty), a, b)))
            }
            Expr::Differs(Type::String(_), a, b) => Given::Word(u64::from(self.bytes(a) != self.bytes(b))),
            Expr::Differs(_, a, b) => {
                let same = match (self.eval(a), self.eval(b)) {
                    (Given::Word(a), Given::Word(b)) => a == b,
                    (Given::Words(a), Given::Words(b)) => a == b,
                    _ => true,
                };
                Given::Word(u64::from(!same))
            }
            Expr::Random(seed) => Given::Word(number::random(self.number(seed))),
            Expr::Fails(operation) => Given::Word(u64::from(self.operate(operation).is_err())),
            Expr::Neg(ty, _)
            | Expr::Arith(_, ty, ..)
            | Expr::Convert(_, ty, _)
            | Expr::Trunc(_, ty, _)
            | Expr::Call(_, ty, _) => match self.operate(e) {
                Ok(value) => value,
                Err(FaultKind::Overflow) => self.wrapped(e).map_or_else(|| zero(ty), Given::Word),
                Err(_) => zero(ty),
            },
        }
    }

    /// The sum, difference or product of 64 bits that does not fit, without what is
    /// beyond; narrower types are asked first whether they overflow.
    fn wrapped(&self, e: &Expr) -> Option<u64> {
        let Expr::Arith(op, Type::Lint | Type::Ulint | Type::Time, a, b) = e else { return None };
        let (a, b) = (self.number(a), self.number(b));
        match op {
            Arith::Add => Some(a.wrapping_add(b)),
            Arith::Sub => Some(a.wrapping_sub(b)),
            Arith::Mul => Some(a.wrapping_mul(b)),
            Arith::Div | Arith::Mod | Arith::Pow => None,
        }
    }

    /// The value of an operation that may have none.
    fn operate(&self, e: &Expr) -> Result<Given, FaultKind> {
        Ok(match e {
            Expr::Neg(ty, x) => Given::Word(number::negate(num(*ty), self.number(x))?),
            Expr::Arith(op, ty, a, b) => {
                Given::Word(number::arith(*op, num(*ty), self.number(a), self.number(b))?)
            }
            Expr::Convert(Type::String(_), to, x) => {
                Given::Word(text::read_number(num(*to), &self.bytes(x))?)
            }
            Expr::Convert(from, Type::String(cap), x) => {
                let mut bytes = text::written(num(*from), *from == Type::Time, self.number(x)).into_bytes();
                bytes.truncate(text::cut(&bytes, usize::from(*cap)));
                Given::Text(bytes)
            }
            Expr::Convert(from, to, x) => {
                let x = self.number(x);
                Given::Word(if num(*from) == num(*to) {
                    x
                } else if transfers(*from, *to) {
                    number::call(g7_engine::Builtin::Transfer, num(*to), &[x])?
                } else {
                    number::convert(num(*from), num(*to), x)?
                })
            }
            Expr::Trunc(from, to, x) => Given::Word(number::truncate(num(*from), num(*to), self.number(x))?),
            Expr::Call(f, ty, args) => self.call(*f, *ty, args)?,
            other => self.eval(other),
        })
    }

    fn call(&self, f: g7_engine::Builtin, ty: Type, args: &[Expr]) -> Result<Given, FaultKind> {
        use g7_engine::Builtin as B;
        let is_text = matches!(
            f,
            B::Len | B::Left | B::Right | B::Mid | B::Concat | B::Insert | B::Delete | B::Replace | B::Find
        );
        if !is_text {
            // SEL and MUX choose among texts as well.
            if let (B::Sel | B::Mux, Type::String(_)) = (f, ty) {
                let k = args.first().map_or(0, |k| self.number(k)) as usize;
                return Ok(args.get(k + 1).map_or(Given::Word(0), |e| self.eval(e)));
            }
            let words: Vec<u64> = args.iter().map(|a| self.number(a)).collect();
            return Ok(Given::Word(number::call(f, num(ty), &words)?));
        }
        let mut texts = Vec::new();
        let mut numbers = Vec::new();
        for a in args {
            match self.eval(a) {
                Given::Text(bytes) => texts.push(bytes),
                Given::Word(n) => numbers.push(n as i64),
                Given::Words(_) => {}
            }
        }
        let text_at = |i: usize| texts.get(i).map_or(&[][..], Vec::as_slice);
        Ok(match text::apply(f, [text_at(0), text_at(1)], &numbers)? {
            text::Applied::Number(n) => Given::Word(n),
            text::Applied::Text(mut bytes) => {
                if let Type::String(cap) = ty {
                    bytes.truncate(text::cut(&bytes, usize::from(cap)));
                }
                Given::Text(bytes)
            }
        })
    }
}

fn num(ty: Type) -> g7_engine::Num {
    g7_compile::lower::num(ty)
}
