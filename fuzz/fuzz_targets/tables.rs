//! Arbitrary tables are either refused or become a program that scans without a panic.
#![no_main]

use arbitrary::{Arbitrary, Unstructured};
use g7_engine::{
    Action, Addr, Chart, Code, Contribution, ControlBlock, Event, Extra, Group, GroupId, Receptivity, NONE, Num, Op, Order,
    Program, Rows, Rules, Service, Situation, State, Step, StepId, Tables, Transition, Watch, WatchId, scan,
};
use libfuzzer_sys::fuzz_target;

/// Draws numbers: mostly small ones, which are likely to be in range, and sometimes large ones,
/// which must be refused.
struct Draw<'a, 'b>(&'a mut Unstructured<'b>);

impl Draw<'_, '_> {
    fn n(&mut self, below: u32) -> u32 {
        if below == 0 { 0 } else { u32::arbitrary(self.0).unwrap_or(0) % below }
    }

    fn flag(&mut self) -> bool {
        self.n(2) == 1
    }

    fn rows(&mut self, len: usize) -> Rows {
        let (a, b) = (self.n(len as u32 + 1), self.n(len as u32 + 1));
        Rows { start: a.min(b), end: a.max(b) }
    }

    fn or_none(&mut self, len: u32) -> u32 {
        if len == 0 || self.flag() { NONE } else { self.n(len) }
    }
}

const STEPS: u32 = 6;
const WORDS: u32 = 12;
const WATCHES: u32 = 3;
const GROUPS: u32 = 2;

fn op(d: &mut Draw<'_, '_>, at: u32) -> Op {
    match d.n(20) {
        0 => Op::Push(u64::from(d.n(3))),
        1 | 2 => Op::Load(Addr(d.n(WORDS))),
        3 | 4 => Op::Store(Addr(d.n(WORDS))),
        5 => Op::Active(StepId(d.n(STEPS))),
        6 => Op::Rise(WatchId(d.n(WATCHES))),
        7 => Op::Timer(WatchId(d.n(WATCHES))),
        8 => Op::Not,
        9 => Op::And,
        10 => Op::Arith(g7_engine::Arith::Div, Num::I16),
        11 => Op::Arith(g7_engine::Arith::Add, Num::I8),
        12 => Op::Jump(at + d.n(4)),
        13 => Op::JumpUnless(at.saturating_sub(d.n(3)) + d.n(5)),
        14 => Op::StepTime(StepId(d.n(STEPS))),
        15 => Op::Service(match d.n(4) {
            0 => Service::Init(GroupId(d.n(GROUPS))),
            1 => Service::Clear(GroupId(d.n(GROUPS))),
            2 => Service::Set(StepId(d.n(STEPS))),
            _ => Service::ResetTimes,
        }),
        16 => Op::LoadAt { base: Addr(d.n(WORDS)), len: d.n(4) },
        17 => Op::GroupActive(GroupId(d.n(GROUPS))),
        18 => Op::Fb(g7_engine::Block::Ton, Addr(d.n(WORDS))),
        _ => Op::Return,
    }
}

fn code(d: &mut Draw<'_, '_>, t: &Tables) -> Code {
    let r = d.rows(t.code.len());
    Code { start: r.start, end: r.end.min(r.start + 6) }
}

/// A short code that pushes one BOOL.
fn truth(d: &mut Draw<'_, '_>, t: &mut Tables) -> Code {
    let start = t.code.len() as u32;
    t.code.push(match d.n(4) {
        0 => Op::Push(1),
        1 => Op::Active(StepId(d.n(STEPS))),
        2 => Op::Rise(WatchId(d.n(WATCHES))),
        _ => Op::Load(Addr(d.n(WORDS))),
    });
    Code { start, end: start + 1 }
}

fn tables(d: &mut Draw<'_, '_>) -> Tables {
    let mut t = Tables {
        rules: [Rules::IEC60848, Rules::IEC61131, Rules::PL7, Rules::UNITY, Rules::JGRAFCHART][d.n(5) as usize],
        ..Tables::default()
    };
    t.rules.bound = 200;
    t.init = vec![0; WORDS as usize];
    t.inputs = Rows { start: 0, end: 2 };
    t.outputs = Rows { start: 2, end: 5 };
    t.safe = vec![0; 3];
    t.periods = if d.flag() { vec![0] } else { vec![0, 30] };
    let periods = t.periods.len() as u32;
    t.code = (0..d.n(40)).map(|at| op(d, at)).collect();
    t.arcs = (0..8).map(|_| StepId(d.n(STEPS))).collect();
    t.group_lists = (0..3).map(|_| GroupId(d.n(GROUPS))).collect();
    t.groups = vec![
        Group { steps: Rows { start: 0, end: 4 }, initial: d.rows(8), watches: Rows::default() },
        Group { steps: Rows { start: 4, end: STEPS }, initial: d.rows(8), watches: Rows::default() },
    ];
    t.charts = (0..GROUPS).map(|g| Chart { group: GroupId(g), period: d.n(periods) }).collect();
    for _ in 0..WATCHES {
        let code = truth(d, &mut t);
        let times = d.flag().then_some((code, code));
        let row = Watch { code, times, always: d.flag(), period: d.n(periods), watches: Rows::default() };
        t.watches.push(row);
    }
    t.watch_lists = (0..3).map(|_| WatchId(d.n(WATCHES))).collect();
    t.word_watches = (0..WORDS).filter_map(|w| d.flag().then(|| (Addr(w), WatchId(d.n(WATCHES))))).collect();
    for _ in 0..d.n(5) {
        let condition = if d.flag() { Code::default() } else { truth(d, &mut t) };
        let body = code(d, &t);
        t.actions.push(Action { condition, body, period: d.n(periods) });
    }
    let actions = t.actions.len() as u32;
    if actions > 0 {
        t.action_lists = (0..4).map(|_| d.n(actions)).collect();
        t.periodics = (0..2).map(|_| d.n(actions)).collect();
        let event = truth(d, &mut t);
        t.events.push(Event { event, action: d.n(actions) });
    }
    for _ in 0..d.n(3) {
        let plain = d.flag();
        let action = if plain { NONE } else { d.or_none(actions) };
        let gate = if d.flag() { Code::default() } else { truth(d, &mut t) };
        t.blocks.push(ControlBlock { output: Addr(2 + d.n(3)), action, plain, gate, period: d.n(periods) });
    }
    for block in 0..t.blocks.len() as u32 {
        let plain = t.blocks[block as usize].plain;
        let condition = if d.flag() { Code::default() } else { truth(d, &mut t) };
        let input = if plain { 0 } else { d.n(11) as u8 };
        let time = if input > 2 && d.flag() { condition } else { Code::default() };
        t.contributions.push(Contribution { block, input, condition, time, period: d.n(periods) });
    }
    for k in 0..d.n(3) {
        let situation = if d.flag() { Situation::Current } else { Situation::Steps(d.rows(8)) };
        t.orders.push(Order { step: StepId(d.n(STEPS)), chart: k % GROUPS, situation });
    }
    steps(d, &mut t);
    t.pre = code(d, &t);
    t.post = code(d, &t);
    t
}

fn steps(d: &mut Draw<'_, '_>, t: &mut Tables) {
    for _ in 0..d.n(4) {
        t.extras.push(Extra {
            on: d.rows(t.action_lists.len()),
            off: d.rows(t.action_lists.len()),
            events: d.rows(t.events.len()),
            periodics: d.rows(t.periodics.len()),
            contributions: d.rows(t.contributions.len()),
            groups: d.rows(t.group_lists.len()),
            orders: d.rows(t.orders.len()),
            encloses: d.rows(t.group_lists.len()),
            links: d.rows(t.arcs.len()),
            watches: d.rows(t.watch_lists.len()),
            uncounted: d.flag(),
        });
    }
    let transitions = d.n(10);
    for _ in 0..transitions {
        let receptivity = match d.n(4) {
            0 => Receptivity::True,
            1 => Receptivity::Word(Addr(d.n(WORDS))),
            2 => Receptivity::NotWord(Addr(d.n(WORDS))),
            _ => Receptivity::Code(truth(d, t)),
        };
        t.transitions.push(Transition {
            receptivity,
            from: StepId(d.or_none(STEPS)),
            to: StepId(d.or_none(STEPS)),
            more_from: d.rows(2),
            more_to: d.rows(2),
            chart: d.n(GROUPS),
            on_clearing: d.or_none(t.actions.len() as u32),
            shares: d.flag(),
            priority: d.or_none(3),
            simple: d.flag(),
            drops: d.flag(),
            uncounted: d.flag(),
        });
    }
    t.drops = (0..transitions).filter_map(|i| d.flag().then(|| (i, StepId(d.n(STEPS))))).collect();
    t.sources = if transitions > 0 && d.flag() { vec![d.n(transitions)] } else { Vec::new() };
    t.outs = if transitions > 0 { (0..8).map(|_| d.n(transitions)).collect() } else { Vec::new() };
    for _ in 0..STEPS {
        let direct = Addr(if d.n(4) == 0 { d.n(WORDS) } else { NONE });
        let extra = d.or_none(t.extras.len() as u32);
        t.steps.push(Step { out: d.rows(t.outs.len()), direct, extra, chart: d.n(GROUPS) });
    }
    t.initial = (0..d.n(3)).map(|_| StepId(d.n(STEPS))).collect();
}

fuzz_target!(|bytes: &[u8]| {
    let mut u = Unstructured::new(bytes);
    let tables = tables(&mut Draw(&mut u));
    let Ok(program) = Program::new(tables) else { return };
    let mut state = State::new(&program);
    for k in 0..12u64 {
        let _ = scan(&program, &mut state, &[k & 1, (k >> 1) & 1], k as i64 * 13);
    }
    let copy = State::from_bytes(&program, &state.to_bytes()).expect("its own bytes");
    assert_eq!(copy, state);
});
