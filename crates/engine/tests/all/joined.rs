//! Code does the same whether its instructions are joined into steps or run one at a time.
//!
//! A jump to the next instruction changes nothing, and nothing is joined over it. So code with such
//! a jump behind each instruction runs them one at a time, in the same interpreter.

use crate::common;

use common::{Chance, chart};
use g7_engine::{
    Action, Addr, Arith, Builtin, Cmp, Code, Fault, FaultKind, Num, Op, Program, Rows, Rules, State, StepId,
    WORK, eval, number,
};

/// Words that code reads and writes; those behind them count the rounds of loops.
const WORDS: u32 = 6;
const LOOPS: u32 = 4;

fn program(words: &[u64], code: &[Op]) -> Program {
    let mut t = chart(Rules::IEC61131, 1, 0, &[0], &[]);
    t.init = words.to_vec();
    t.outputs = Rows::default();
    t.safe = Vec::new();
    t.steps[0].direct = Addr(u32::MAX);
    t.code = code.to_vec();
    // The body of an action that never runs, so that the code is checked.
    t.code.push(Op::Drop);
    let body = Code { start: 0, end: t.code.len() as u32 };
    t.actions.push(Action { condition: Code::default(), body, period: 0 });
    Program::new(t).expect("tables are sound")
}

/// The value that code leaves, or its fault, and the words behind it.
fn done(words: &[u64], code: &[Op], range: Code) -> (Result<u64, Fault>, Vec<u64>) {
    let p = program(words, code);
    let mut s = State::new(&p);
    let left = eval(&p, &mut s, range);
    (left, s.words().to_vec())
}

/// The same code, so that no instruction stands right behind another.
fn apart(code: &[Op]) -> Vec<Op> {
    let twice = |op: Op| match op {
        Op::Jump(to) => Op::Jump(2 * to),
        Op::JumpUnless(to) => Op::JumpUnless(2 * to),
        other => other,
    };
    (0u32..).zip(code).flat_map(|(i, op)| [twice(*op), Op::Jump(2 * i + 2)]).collect()
}

/// Runs both forms of some code from these words; `end` is the end of the range that is run.
fn same(words: &[u64], code: &[Op], end: u32) -> Result<u64, Fault> {
    let (joined, words_joined) = done(words, code, Code { start: 0, end });
    let (single, words_single) = done(words, &apart(code), Code { start: 0, end: 2 * end });
    let single = single.map_err(|f| Fault { at: f.at.map(|at| at / 2), ..f });
    assert_eq!(joined, single, "up to {end}: {code:?}");
    assert_eq!(words_joined, words_single, "up to {end}: {code:?}");
    joined
}

/// Random code that is sound.
struct Writer {
    chance: Chance,
    code: Vec<Op>,
    loops: u32,
}

impl Writer {
    fn here(&self) -> u32 {
        self.code.len() as u32
    }

    fn one_of<T: Copy>(&mut self, list: &[T]) -> T {
        list[self.chance.below(list.len() as u32) as usize]
    }

    fn land(&mut self, jump: u32) {
        let here = self.here();
        match &mut self.code[jump as usize] {
            Op::Jump(to) | Op::JumpUnless(to) => *to = here,
            other => panic!("{other:?} is no jump"),
        }
    }

    fn jump(&mut self, op: fn(u32) -> Op) -> u32 {
        self.code.push(op(0));
        self.here() - 1
    }

    fn num(&mut self) -> Num {
        self.one_of(&[Num::I64, Num::I64, Num::F64, Num::F64, Num::F64, Num::F32, Num::I16, Num::U8])
    }

    fn leaf(&mut self) {
        let op = match self.chance.below(8) {
            0 => Op::Active(StepId(0)),
            1..4 => {
                let small = [0, 1, 2, 3, 32_767, u64::MAX, 1.5f64.to_bits(), (-2.0f64).to_bits()];
                Op::Push(self.one_of(&small))
            }
            _ => Op::Load(Addr(self.chance.below(WORDS))),
        };
        self.code.push(op);
    }

    /// Pushes a value.
    fn value(&mut self, depth: u32) {
        if depth == 0 || self.chance.below(4) == 0 {
            return self.leaf();
        }
        self.value(depth - 1);
        let num = self.num();
        match self.chance.below(10) {
            0 => self.code.push(Op::Not),
            1 => self.code.push(Op::Neg(num)),
            2 => {
                let to = self.num();
                self.code.push(Op::Convert(num, to));
            }
            3 => {
                self.code.extend([Op::Drop, Op::Push(u64::from(self.chance.below(WORDS + 1)))]);
                self.code.push(Op::LoadAt { base: Addr(0), len: WORDS });
            }
            4 => {
                self.value(depth - 1);
                self.value(depth - 1);
                let f = self.one_of(&[Builtin::Limit, Builtin::Sel, Builtin::Mux]);
                self.code.push(Op::Call(f, num, 3));
            }
            // One value decides: a jump to behind the other, into whatever follows.
            5 => {
                let decided = self.jump(Op::JumpUnless);
                self.value(depth - 1);
                let end = self.jump(Op::Jump);
                self.land(decided);
                self.leaf();
                self.land(end);
            }
            _ => {
                self.value(depth - 1);
                let cmp = self.one_of(&[Cmp::Eq, Cmp::Ne, Cmp::Lt, Cmp::Le, Cmp::Gt, Cmp::Ge]);
                let arith = self.one_of(&[Arith::Add, Arith::Sub, Arith::Mul, Arith::Div, Arith::Mod]);
                let op = self.one_of(&[
                    Op::And,
                    Op::Or,
                    Op::Xor,
                    Op::Compare(cmp, num),
                    Op::Compare(cmp, num),
                    Op::Arith(arith, num),
                    Op::Arith(arith, num),
                ]);
                self.code.push(op);
            }
        }
    }

    fn statement(&mut self, depth: u32) {
        match self.chance.below(if depth == 0 { 5 } else { 9 }) {
            0 => {
                self.code.push(Op::Push(u64::from(self.chance.below(WORDS + 1))));
                self.value(2);
                self.code.push(Op::StoreAt { base: Addr(0), len: WORDS });
            }
            1..5 => {
                self.value(3);
                let to = Addr(self.chance.below(WORDS));
                self.code.push(Op::Store(to));
            }
            5..8 => {
                self.value(3);
                if self.chance.below(2) == 0 {
                    self.code.push(Op::Not);
                }
                let other = self.jump(Op::JumpUnless);
                self.statements(depth - 1);
                if self.chance.below(2) == 0 {
                    let end = self.jump(Op::Jump);
                    self.land(other);
                    self.statements(depth - 1);
                    self.land(end);
                } else {
                    self.land(other);
                }
            }
            _ => self.repeat(depth),
        }
    }

    /// A loop of some rounds; the jump back asks for a value or for its complement.
    fn repeat(&mut self, depth: u32) {
        if self.loops == LOOPS {
            return;
        }
        let count = Addr(WORDS + self.loops);
        self.loops += 1;
        self.code.extend([Op::Push(u64::from(self.chance.below(4))), Op::Store(count)]);
        let start = self.here();
        self.statements(depth - 1);
        let less = [Op::Load(count), Op::Push(1), Op::Arith(Arith::Sub, Num::I64), Op::Store(count)];
        self.code.extend(less);
        match self.chance.below(2) {
            0 => self.code.extend([Op::Load(count), Op::Push(0), Op::Compare(Cmp::Le, Num::I64)]),
            _ => self.code.extend([Op::Load(count), Op::Push(0), Op::Compare(Cmp::Gt, Num::I64), Op::Not]),
        }
        self.code.push(Op::JumpUnless(start));
    }

    fn statements(&mut self, depth: u32) {
        for _ in 0..=self.chance.below(4) {
            self.statement(depth);
        }
    }
}

/// Words that random code begins with.
fn words(chance: &mut Chance) -> Vec<u64> {
    let some = [0, 1, 2, 5, 300, u64::MAX, 0.5f64.to_bits(), 2.0f64.to_bits()];
    let mut words: Vec<u64> = (0..WORDS).map(|_| some[chance.below(some.len() as u32) as usize]).collect();
    words.resize((WORDS + LOOPS) as usize, 0);
    words
}

#[test]
fn random_code_does_the_same_joined_and_one_instruction_at_a_time() {
    let (mut values, mut faults) = (0, 0);
    for seed in 0..6000 {
        let mut writer = Writer { chance: Chance(seed), code: Vec::new(), loops: 0 };
        let words = words(&mut writer.chance);
        writer.statements(2);
        writer.value(4);
        match same(&words, &writer.code, writer.here()) {
            Ok(_) => values += 1,
            Err(_) => faults += 1,
        }
    }
    assert!(values > 1000 && faults > 1000, "{values} values, {faults} faults");
}

/// The values of every kind that are compared and computed with.
fn values(n: Num) -> Vec<u64> {
    let reals = [f64::NAN, f64::NEG_INFINITY, -2.5, -0.0, 0.0, 1.0, 1e300, f64::INFINITY];
    match n {
        Num::F64 => reals.map(f64::to_bits).to_vec(),
        Num::F32 => reals.map(|r| u64::from((r as f32).to_bits())).to_vec(),
        Num::I8 | Num::I16 | Num::I32 | Num::I64 => [-128i64, -1, 0, 1, 127].map(|v| v as u64).to_vec(),
        Num::Bool => vec![0, 1],
        Num::U8 | Num::U16 | Num::U32 => vec![0, 1, 255],
        Num::U64 => vec![0, 1, u64::MAX],
    }
}

/// The interpreter computes as `number.rs` does, which has tests of its own against the standard.
#[test]
fn instructions_compute_as_the_functions_of_numbers_do() {
    let kinds = [
        Num::Bool,
        Num::I8,
        Num::I16,
        Num::I32,
        Num::I64,
        Num::U8,
        Num::U16,
        Num::U32,
        Num::U64,
        Num::F32,
        Num::F64,
    ];
    let comparisons = [Cmp::Eq, Cmp::Ne, Cmp::Lt, Cmp::Le, Cmp::Gt, Cmp::Ge];
    let operations = [Arith::Add, Arith::Sub, Arith::Mul, Arith::Div, Arith::Mod];
    for n in kinds {
        let values = values(n);
        let pairs = || values.iter().flat_map(|a| values.iter().map(|b| (*a, *b)));
        for c in comparisons {
            let code = [Op::Load(Addr(0)), Op::Load(Addr(1)), Op::Compare(c, n)];
            for (a, b) in pairs() {
                let wanted = Ok(u64::from(number::compare(c, n, a, b)));
                assert_eq!(same(&[a, b], &code, 3), wanted, "{c:?} {n:?} {a:x} {b:x}");
            }
        }
        for op in operations {
            let code = [Op::Load(Addr(0)), Op::Load(Addr(1)), Op::Arith(op, n)];
            for (a, b) in pairs() {
                let wanted = number::arith(op, n, a, b).map_err(|kind| Fault { kind, at: Some(2) });
                assert_eq!(same(&[a, b], &code, 3), wanted, "{op:?} {n:?} {a:x} {b:x}");
            }
        }
        for (f, g) in [(Builtin::Limit, n), (Builtin::Sel, n)] {
            let code = [Op::Load(Addr(0)), Op::Load(Addr(1)), Op::Load(Addr(2)), Op::Call(f, g, 3)];
            for (a, b) in pairs() {
                for c in &values {
                    let words = [a, b, *c];
                    assert_eq!(
                        same(&words, &code, 4).ok(),
                        number::call(f, g, &words).ok(),
                        "{f:?} {g:?} {words:x?}"
                    );
                }
            }
        }
    }
}

/// A code may end where another one goes on: a condition within a body, for example.
#[test]
fn code_ends_where_its_range_ends() {
    let code = [
        Op::Load(Addr(0)),
        Op::Push(3),
        Op::Arith(Arith::Add, Num::I64),
        Op::Not,
        Op::Not,
        Op::Push(1),
        Op::Push(0),
        Op::Call(Builtin::Sel, Num::I64, 3),
        Op::Neg(Num::I64),
        Op::Store(Addr(1)),
        Op::Load(Addr(1)),
    ];
    // Where one value is on the stack; 7 + 3 is true, and SEL(TRUE, 1, 0) is 0.
    for (end, value) in [(1, 7), (3, 10), (4, 0), (5, 1), (8, 0), (9, 0), (11, 0)] {
        assert_eq!(same(&[7, 9], &code, end), Ok(value), "up to {end}");
    }
    // A value before the jump is the one that the code leaves where it ends there.
    let jumps =
        [Op::Load(Addr(0)), Op::Push(7), Op::Compare(Cmp::Eq, Num::I64), Op::JumpUnless(4), Op::Push(5)];
    assert_eq!(same(&[7], &jumps, 3), Ok(1));
    assert_eq!(same(&[7], &jumps, 5), Ok(5));
}

#[test]
fn a_fault_names_the_instruction_that_computes_and_nothing_is_stored() {
    let (most, max) = (i64::from(i16::MAX) as u64, i64::MAX as u64);
    let fault = |kind, at| Err(Fault { kind, at: Some(at) });
    let cases = [
        (Op::Arith(Arith::Add, Num::I16), [most, 1], FaultKind::Overflow),
        (Op::Arith(Arith::Div, Num::I64), [1, 0], FaultKind::DivisionByZero),
        (Op::Arith(Arith::Mul, Num::I64), [max, 2], FaultKind::Overflow),
    ];
    for (op, words, kind) in cases {
        let code = [Op::Load(Addr(0)), Op::Load(Addr(1)), op, Op::Store(Addr(0)), Op::Push(0)];
        let (left, after) = done(&words, &code, Code { start: 0, end: 5 });
        assert_eq!((left, after), (fault(kind, 2), words.to_vec()), "{op:?}");
    }
    for op in [Op::Neg(Num::I16), Op::Convert(Num::I64, Num::I8)] {
        let words = [i64::from(i16::MIN) as u64];
        let code = [Op::Load(Addr(0)), op, Op::Store(Addr(0)), Op::Push(0)];
        let (left, after) = done(&words, &code, Code { start: 0, end: 4 });
        assert!(matches!(left, Err(Fault { at: Some(1), .. })), "{op:?}: {left:?}");
        assert_eq!(after, words, "{op:?}");
    }
}

/// As many rounds as there may be end with a value, one more ends with a fault at the jump.
#[test]
fn a_jump_back_is_counted_whatever_it_asks_for() {
    for (not, cmp) in [(false, Cmp::Le), (true, Cmp::Gt)] {
        let mut code = vec![
            Op::Load(Addr(0)),
            Op::Push(1),
            Op::Arith(Arith::Sub, Num::I64),
            Op::Store(Addr(0)),
            Op::Load(Addr(0)),
            Op::Push(0),
            Op::Compare(cmp, Num::I64),
        ];
        if not {
            code.push(Op::Not);
        }
        let jump = code.len() as u32;
        code.extend([Op::JumpUnless(0), Op::Push(5)]);
        let all = Code { start: 0, end: jump + 2 };
        let rounds = u64::from(WORK);
        assert_eq!(done(&[rounds + 1], &code, all).0, Ok(5));
        let fault = Fault { kind: FaultKind::Work, at: Some(jump) };
        assert_eq!(done(&[rounds + 2], &code, all).0, Err(fault));
    }
}
