//! Tables that are no program are refused, and the row that is wrong is named:
//! each index one past the last row, each run of rows one too long or turned
//! round, each code whose stack does not come out. The largest that is right is
//! taken, so that no bound is too tight either.

use crate::common;

use common::chart;
use g7_engine::{
    Action, Addr, Arith, Block, Builtin, Cmp, Code, Contribution, ControlBlock, Event, Extra, GroupId,
    Limits, LoadError, NONE, Num, Op, Order, Program, Receptivity, Rows, Rules, STACK, Service, Situation,
    StepId, TEXT, Tables, Watch, WatchId,
};

const fn rows(start: u32, end: u32) -> Rows {
    Rows { start, end }
}

/// Adds code and tells where it is.
fn code(t: &mut Tables, ops: &[Op]) -> Code {
    let start = t.code.len() as u32;
    t.code.extend_from_slice(ops);
    Code { start, end: t.code.len() as u32 }
}

/// Two steps with a transition each way, and a row or two of every other table,
/// everything at its largest right value.
fn sound() -> Tables {
    let mut t = chart(Rules::IEC60848, 2, 1, &[1], &[(vec![0], vec![1], Some(0)), (vec![1], vec![0], None)]);
    let (one, nothing) = (code(&mut t, &[Op::Push(1)]), code(&mut t, &[]));
    t.arcs = vec![StepId(1), StepId(0)];
    t.periods = vec![0, 5];
    t.group_lists = vec![GroupId(0)];
    t.actions = vec![Action { condition: one, body: nothing, period: 1 }];
    t.action_lists = vec![0];
    t.periodics = vec![0];
    t.events = vec![Event { event: one, action: 0 }];
    t.contributions = vec![Contribution { block: 0, input: 10, condition: one, time: one, period: 1 }; 1];
    t.blocks = vec![ControlBlock { output: Addr(2), action: 0, plain: false, gate: one, period: 1 }];
    let watch = |watches| Watch { code: one, times: Some((one, one)), always: true, period: 1, watches };
    t.watches = vec![watch(rows(0, 1)), watch(rows(1, 1))];
    t.watch_lists = vec![WatchId(1)];
    t.word_watches = vec![(Addr(0), WatchId(1)), (Addr(0), WatchId(0)), (Addr(2), WatchId(1))];
    t.orders = vec![Order { step: StepId(1), chart: 0, situation: Situation::Steps(rows(0, 2)) }];
    t.drops = vec![(0, StepId(1)), (1, StepId(0)), (1, StepId(1))];
    t.sources = vec![1];
    t.counts = Some((Addr(1), Addr(2)));
    t.limits = Some((Addr(2), Limits { active: 1, enabled: 1 }));
    t.extras = vec![Extra {
        on: rows(0, 1),
        off: rows(0, 1),
        events: rows(0, 1),
        periodics: rows(0, 1),
        contributions: rows(0, 1),
        groups: rows(0, 1),
        orders: rows(0, 1),
        encloses: rows(0, 1),
        links: rows(0, 2),
        watches: rows(0, 1),
        uncounted: false,
    }];
    t.steps[0].extra = 0;
    t.groups[0].initial = rows(0, 2);
    t.groups[0].watches = rows(0, 1);
    t.charts[0].period = 1;
    t.transitions[0].on_clearing = 0;
    t.transitions[0].more_from = rows(0, 2);
    t.transitions[0].more_to = rows(0, 2);
    t.locals = rows(2, 3);
    t
}

/// The verdict on the sound tables after a change.
fn verdict(change: impl FnOnce(&mut Tables)) -> Option<LoadError> {
    let mut t = sound();
    change(&mut t);
    Program::new(t).err()
}

/// The change is refused with this table and row.
macro_rules! refused {
    ($($table:literal $row:literal: $($t:ident => $change:expr),+;)*) => {
        $($(
            let got = verdict(|$t: &mut Tables| { $change; });
            assert_eq!(got, Some(LoadError::Index { table: $table, row: $row }), "{}", stringify!($change));
        )+)*
    };
}

#[test]
fn sound_tables_are_taken() {
    assert_eq!(verdict(|_| {}), None);
    // These may be left out.
    assert_eq!(verdict(|t| t.steps[0].direct = Addr(NONE)), None);
    assert_eq!(verdict(|t| t.transitions[1].from = StepId(NONE)), None);
    assert_eq!(verdict(|t| t.transitions[1].to = StepId(NONE)), None);
    assert_eq!(verdict(|t| t.blocks[0].output = Addr(NONE)), None);
    assert_eq!(verdict(|t| t.blocks[0].action = NONE), None);
    assert_eq!(verdict(|t| t.orders[0].situation = Situation::Current), None);
    assert_eq!(verdict(|t| t.locals = Rows::default()), None);
}

#[test]
fn an_index_past_the_last_row_is_refused_in_every_table() {
    refused! {
        "inputs" 0: t => t.inputs = rows(0, 4), t => t.inputs = rows(2, 1);
        "outputs" 0: t => t.outputs = rows(1, 4), t => t.outputs = rows(3, 1);
        "locals" 0: t => t.locals = rows(1, 2);
        "safe" 0: t => t.safe = vec![0], t => t.safe = vec![0; 3];
        "periods" 0: t => t.periods[0] = 1, t => t.periods.clear();
        "steps" 0: t => t.steps[0].out = rows(0, 3), t => t.steps[0].out = rows(2, 1),
            t => t.steps[0].chart = 1, t => t.steps[0].direct = Addr(3), t => t.steps[0].extra = 1;
        "steps" 1: t => t.steps[1].chart = 1;
        "extras" 0: t => t.extras[0].on = rows(0, 2), t => t.extras[0].off = rows(0, 2),
            t => t.extras[0].events = rows(0, 2), t => t.extras[0].periodics = rows(0, 2),
            t => t.extras[0].contributions = rows(0, 2), t => t.extras[0].groups = rows(0, 2),
            t => t.extras[0].orders = rows(0, 2), t => t.extras[0].encloses = rows(0, 2),
            t => t.extras[0].links = rows(0, 3), t => t.extras[0].watches = rows(0, 2),
            t => t.extras[0].links = rows(2, 1);
        "arcs" 1: t => t.arcs[1] = StepId(2);
        "initial" 0: t => t.initial[0] = StepId(2);
        "group_lists" 0: t => t.group_lists[0] = GroupId(1);
        "groups" 0: t => t.groups[0].steps = rows(0, 3), t => t.groups[0].initial = rows(0, 3),
            t => t.groups[0].watches = rows(0, 2);
        "charts" 0: t => t.charts[0].group = GroupId(1), t => t.charts[0].period = 2;
        "transitions" 0: t => t.transitions[0].from = StepId(2), t => t.transitions[0].to = StepId(2),
            t => t.transitions[0].more_from = rows(0, 3), t => t.transitions[0].more_to = rows(0, 3),
            t => t.transitions[0].chart = 1, t => t.transitions[0].on_clearing = 1,
            t => t.transitions[0].receptivity = Receptivity::Word(Addr(3)),
            t => t.transitions[0].receptivity = Receptivity::NotWord(Addr(3));
        "drops" 0: t => t.drops = vec![(2, StepId(0))], t => t.drops = vec![(0, StepId(2))];
        "outs" 1: t => t.outs[1] = 2;
        "sources" 0: t => t.sources[0] = 2;
        "actions" 0: t => t.actions[0].period = 2;
        "action_lists" 0: t => t.action_lists[0] = 1;
        "periodics" 0: t => t.periodics[0] = 1;
        "events" 0: t => t.events[0].action = 1;
        "contributions" 0: t => t.contributions[0].block = 1, t => t.contributions[0].input = 11,
            t => t.contributions[0].period = 2,
            // A plain block has N alone.
            t => { t.blocks[0].plain = true; t.blocks[0].action = NONE };
        "blocks" 0: t => t.blocks[0].output = Addr(3), t => t.blocks[0].action = 1, t => t.blocks[0].period = 2,
            // and no body.
            t => { t.blocks[0].plain = true; t.contributions[0].input = 0 };
        "watches" 1: t => t.watches[1].period = 2, t => t.watches[1].watches = rows(0, 2);
        "watch_lists" 0: t => { t.watch_lists[0] = WatchId(2) };
        "word_watches" 2: t => t.word_watches[2] = (Addr(3), WatchId(0)), t => t.word_watches[2].1 = WatchId(2);
        "orders" 0: t => t.orders[0].step = StepId(2), t => t.orders[0].chart = 1,
            t => t.orders[0].situation = Situation::Steps(rows(0, 3));
        "counts" 0: t => t.counts = Some((Addr(3), Addr(0))), t => t.counts = Some((Addr(0), Addr(3))),
            t => t.limits = Some((Addr(3), Limits { active: 1, enabled: 1 }));
    }
    let plain = |t: &mut Tables| {
        (t.blocks[0].plain, t.blocks[0].action, t.contributions[0].input) = (true, NONE, 0);
    };
    assert_eq!(verdict(plain), None);
}

#[test]
fn tables_that_must_be_sorted_are() {
    let order = |table, row| Some(LoadError::Order { table, row });
    // An order that keeps the situation stands before those that name one.
    let kept = |t: &Tables| Order { situation: Situation::Current, ..t.orders[0] };
    assert_eq!(verdict(|t| t.orders.insert(0, kept(t))), None);
    assert_eq!(verdict(|t| t.orders.push(kept(t))), order("orders", 1));
    assert_eq!(verdict(|t| t.drops.swap(0, 1)), order("drops", 1));
    assert_eq!(verdict(|t| t.word_watches.swap(1, 2)), order("word_watches", 2));
    // A watch is read by later ones alone.
    assert_eq!(verdict(|t| t.watch_lists[0] = WatchId(0)), order("watches", 0));
    assert_eq!(verdict(|t| t.watches[1].watches = rows(0, 1)), order("watches", 1));
}

#[test]
fn tables_are_far_smaller_than_their_indices() {
    let most = 1 << 26;
    assert_eq!(verdict(|t| t.arcs = vec![StepId(1); most]), None);
    assert_eq!(verdict(|t| t.arcs = vec![StepId(1); most + 1]), Some(LoadError::Large { table: "arcs" }));
}

/// Puts code into its place of the tables.
type SetCode = fn(&mut Tables, Code);

/// The verdict on these instructions as PRE.
fn pre(ops: &[Op]) -> Option<LoadError> {
    verdict(|t| {
        // Alone, so that places count from 0.
        *t = Tables { code: Vec::new(), ..chart(Rules::IEC60848, 1, 1, &[0], &[]) };
        t.init = vec![0; 12];
        t.watches = Vec::new();
        t.periods = vec![0, 5];
        t.pre = code(t, ops);
    })
}

#[test]
fn code_leaves_what_it_should_on_every_way() {
    let stack = |at| Some(LoadError::Stack { at });
    let (one, drop) = (Op::Push(1), Op::Drop);
    assert_eq!(pre(&[one, drop]), None);
    assert_eq!(pre(&[one]), stack(1));
    assert_eq!(pre(&[drop]), stack(0));
    assert_eq!(pre(&[one, Op::And, drop]), stack(1));
    // One of two ways leaves a value behind.
    assert_eq!(pre(&[one, Op::JumpUnless(4), one, drop]), None);
    assert_eq!(pre(&[one, Op::JumpUnless(3), one]), stack(3));
    assert_eq!(pre(&[one, Op::JumpUnless(3), one, drop]), stack(3));
    // Jumps stay within their code; to its very end is within.
    assert_eq!(pre(&[Op::Jump(1)]), None);
    assert_eq!(pre(&[Op::Jump(2)]), stack(0));
    assert_eq!(pre(&[Op::Jump(0)]), None);
    let behind = |target| {
        verdict(|t| {
            let start = t.code.len() as u32;
            t.code.extend([Op::Jump(start + 1), Op::Jump(target)]);
            t.pre = Code { start: start + 1, end: start + 2 };
        })
    };
    let start = sound().code.len() as u32;
    assert_eq!(behind(start + 1), None);
    assert_eq!(behind(start), stack(start + 1));
    // The stack at a Return is checked at the end; nothing behind it is checked.
    assert_eq!(pre(&[Op::Return, drop]), None);
    assert_eq!(pre(&[one, Op::Return]), stack(1));
    // Each code by what it has to leave.
    let leaves = |n: usize, set: SetCode| {
        verdict(|t| {
            let c = code(t, &vec![one; n]);
            set(t, c);
        })
    };
    let codes: [(usize, SetCode); 15] = [
        (0, |t, c| t.pre = c),
        (0, |t, c| t.services = c),
        (0, |t, c| t.post = c),
        (0, |t, c| t.tail = c),
        (0, |t, c| t.actions[0].body = c),
        (1, |t, c| t.actions[0].condition = c),
        (1, |t, c| t.events[0].event = c),
        (1, |t, c| t.contributions[0].condition = c),
        (1, |t, c| t.contributions[0].time = c),
        (1, |t, c| t.blocks[0].gate = c),
        (1, |t, c| t.watches[0].code = c),
        (1, |t, c| t.watches[0].times = Some((c, t.watches[0].code))),
        (1, |t, c| t.watches[0].times = Some((t.watches[0].code, c))),
        (1, |t, c| t.transitions[0].receptivity = Receptivity::Code(c)),
        (1, |t, c| t.transitions[1].receptivity = Receptivity::Code(c)),
    ];
    for (row, (n, set)) in codes.into_iter().enumerate() {
        assert_eq!(leaves(n, set), None, "code {row}");
        assert!(matches!(leaves(n + 1, set), Some(LoadError::Stack { .. })), "code {row}");
    }
    // Past the end, or turned round.
    assert_eq!(verdict(|t| t.pre = Code { start: 0, end: 9 }), stack(0));
    assert_eq!(verdict(|t| t.pre = Code { start: 1, end: 0 }), stack(1));
}

#[test]
fn the_stack_is_as_deep_as_it_is() {
    let deep = |n: usize| {
        let mut ops = vec![Op::Push(1); n];
        ops.extend(vec![Op::Drop; n]);
        pre(&ops)
    };
    assert_eq!(deep(STACK), None);
    assert_eq!(deep(STACK + 1), Some(LoadError::Deep { at: STACK as u32 }));
}

/// Every instruction with what it pops and pushes, at its largest right operand
/// (twelve words, one step, group and watch, two periods), and one past it.
fn instructions() -> Vec<(Op, usize, usize, Option<Op>)> {
    let text = |n: u16| 1 + u32::from(n).div_ceil(8);
    let at = |words: u32| Addr(12 - words);
    let past = |words: u32| Addr(13 - words);
    vec![
        (Op::Push(7), 0, 1, None),
        (Op::Load(at(1)), 0, 1, Some(Op::Load(past(1)))),
        (Op::Store(at(1)), 1, 0, Some(Op::Store(past(1)))),
        (Op::LoadAt { base: at(3), len: 3 }, 1, 1, Some(Op::LoadAt { base: past(3), len: 3 })),
        (Op::StoreAt { base: at(3), len: 3 }, 2, 0, Some(Op::StoreAt { base: past(3), len: 3 })),
        (Op::Active(StepId(0)), 0, 1, Some(Op::Active(StepId(1)))),
        (Op::WasActive(StepId(0)), 0, 1, Some(Op::WasActive(StepId(1)))),
        (Op::GroupActive(GroupId(0)), 0, 1, Some(Op::GroupActive(GroupId(1)))),
        (Op::StepTime(StepId(0)), 0, 1, Some(Op::StepTime(StepId(1)))),
        (Op::StepTenths(StepId(0)), 0, 1, Some(Op::StepTenths(StepId(1)))),
        (Op::StepAge(StepId(0)), 0, 1, Some(Op::StepAge(StepId(1)))),
        (Op::GroupTime(GroupId(0)), 0, 1, Some(Op::GroupTime(GroupId(1)))),
        (Op::GroupAge(GroupId(0)), 0, 1, Some(Op::GroupAge(GroupId(1)))),
        (Op::Due(1), 0, 1, Some(Op::Due(2))),
        (Op::Not, 1, 1, None),
        (Op::And, 2, 1, None),
        (Op::Or, 2, 1, None),
        (Op::Xor, 2, 1, None),
        (Op::Neg(Num::I32), 1, 1, None),
        (Op::Arith(Arith::Add, Num::I32), 2, 1, None),
        (Op::Compare(Cmp::Lt, Num::I32), 2, 1, None),
        (Op::Convert(Num::I32, Num::I16), 1, 1, None),
        (Op::Trunc(Num::F32, Num::I16), 1, 1, None),
        (Op::Call(Builtin::Abs, Num::I32, 1), 1, 1, None),
        (Op::Call(Builtin::Limit, Num::I32, 3), 3, 1, None),
        (Op::CompareText(Cmp::Eq), 2, 1, None),
        (Op::StoreText { to: at(text(9)), cap: 9 }, 1, 0, Some(Op::StoreText { to: past(text(9)), cap: 9 })),
        (Op::FromText(Num::I32), 1, 1, None),
        (Op::Fb(Block::Ctud, at(10)), 0, 0, Some(Op::Fb(Block::Ctud, past(10)))),
        (Op::Fb(Block::Ctu, at(6)), 0, 0, Some(Op::Fb(Block::Ctu, past(6)))),
        (Op::Fb(Block::Sr, at(3)), 0, 0, Some(Op::Fb(Block::Sr, past(3)))),
        (Op::ScanTime, 0, 1, None),
        (Op::Random(at(1)), 0, 1, Some(Op::Random(past(1)))),
        (Op::Drop, 1, 0, None),
        (Op::Service(Service::Init(GroupId(0))), 0, 0, Some(Op::Service(Service::Init(GroupId(1))))),
        (Op::Service(Service::Clear(GroupId(0))), 0, 0, Some(Op::Service(Service::Clear(GroupId(1))))),
        (Op::Service(Service::Set(StepId(0))), 0, 0, Some(Op::Service(Service::Set(StepId(1))))),
        (Op::Service(Service::Reset(StepId(0))), 0, 0, Some(Op::Service(Service::Reset(StepId(1))))),
        (Op::Service(Service::ResetTimes), 0, 0, None),
    ]
}

/// Text functions with their arguments.
const TEXT_FUNCTIONS: [(Builtin, usize); 9] = [
    (Builtin::Len, 1),
    (Builtin::Left, 2),
    (Builtin::Right, 2),
    (Builtin::Concat, 2),
    (Builtin::Find, 2),
    (Builtin::Mid, 3),
    (Builtin::Insert, 3),
    (Builtin::Delete, 3),
    (Builtin::Replace, 4),
];

/// An instruction between what it pops and drops for what it pushes.
fn used(op: Op, pops: usize, pushes: usize) -> Option<LoadError> {
    let mut ops = vec![Op::Push(0); pops];
    ops.push(op);
    ops.extend(vec![Op::Drop; pushes]);
    pre(&ops)
}

#[test]
fn instructions_name_what_is_there_and_balance_the_stack() {
    let mut all = instructions();
    let words = 1 + 9u32.div_ceil(8);
    for (function, pops) in TEXT_FUNCTIONS {
        let op = |to| Op::Text { function, to: Addr(to), cap: 9 };
        all.push((op(12 - words), pops, 1, Some(op(13 - words))));
    }
    let op = |to| Op::ToText { from: Num::I32, time: false, to: Addr(to), cap: 9 };
    all.push((op(12 - words), 1, 1, Some(op(13 - words))));
    for (op, pops, pushes, past) in all {
        assert_eq!(used(op, pops, pushes), None, "{op:?}");
        let end = (pops + 1 + pushes) as u32;
        assert_eq!(
            used(op, pops + 1, pushes),
            Some(LoadError::Stack { at: end + 1 }),
            "{op:?} pops too little"
        );
        if pops > 0 {
            let short = Some(LoadError::Stack { at: pops as u32 - 1 });
            assert_eq!(used(op, pops - 1, pushes), short, "{op:?} pops too much");
        }
        if let Some(past) = past {
            let row = pops as u32;
            assert_eq!(used(past, pops, pushes), Some(LoadError::Index { table: "code", row }), "{past:?}");
        }
    }
    // A function that is not one of texts takes more than there is.
    let op = Op::Text { function: Builtin::Abs, to: Addr(0), cap: 9 };
    assert_eq!(used(op, STACK, 1), Some(LoadError::Stack { at: STACK as u32 }));
    // Watches.
    for op in [Op::Rise as fn(WatchId) -> Op, Op::Fall, Op::Timer] {
        let with = |w: u32| verdict(|t| t.pre = code(t, &[op(WatchId(w)), Op::Drop]));
        assert_eq!(with(1), None);
        let row = sound().code.len() as u32;
        assert_eq!(with(2), Some(LoadError::Index { table: "code", row }));
    }
}

#[test]
fn strings_are_no_longer_than_the_room_to_work_in() {
    let with = |cap: u16| {
        verdict(|t| {
            *t = chart(Rules::IEC60848, 1, 1, &[0], &[]);
            t.init = vec![0; 1 + usize::from(TEXT).div_ceil(8)];
            t.pre = code(t, &[Op::Push(0), Op::StoreText { to: Addr(0), cap }]);
        })
    };
    assert_eq!(with(TEXT), None);
    assert_eq!(with(TEXT + 1), Some(LoadError::Index { table: "code", row: 1 }));
}
