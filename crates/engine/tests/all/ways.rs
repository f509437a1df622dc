//! Plain steps, plain transitions and decisions behave as the general way does, scan by scan.

use crate::common;

use common::{Arc, Chance, chart};
use g7_engine::{
    Addr, Arith, Cmp, Code, Contribution, ControlBlock, Extra, Fault, FaultKind, INPUTS, NONE, Num, Op,
    Program, Receptivity, Report, Rows, Rules, State, StepId, Tables, scan, set_step,
};

/// Up to `n` different steps.
fn some(chance: &mut Chance, n: u32) -> Vec<u32> {
    let mut list: Vec<u32> =
        (0..chance.below(3) + u32::from(chance.below(8) > 0)).map(|_| chance.below(n)).collect();
    list.sort_unstable();
    list.dedup();
    list
}

fn random(chance: &mut Chance, rules: Rules) -> Tables {
    let most = if chance.below(4) == 0 { 200 } else { 9 };
    let steps = 1 + chance.below(most);
    let count = 1 + chance.below(2 * steps);
    let arcs: Vec<Arc> = (0..count)
        .map(|_| {
            let lone = chance.below(2) == 0;
            let (pre, post) = if lone {
                (vec![chance.below(steps)], vec![chance.below(steps)])
            } else {
                (some(chance, steps), some(chance, steps))
            };
            let waits_for = match chance.below(6) {
                0 => None,
                1 => Some(-1 - chance.below(3) as i32),
                _ => Some(chance.below(3) as i32),
            };
            (pre, post, waits_for)
        })
        .collect();
    let initial = some(chance, steps);
    chart(rules, steps, 3, &initial, &arcs)
}

/// A random Boolean expression of inputs, steps and comparisons.
fn expression(chance: &mut Chance, steps: u32, depth: u32, code: &mut Vec<Op>) {
    let leaf = depth == 0 || chance.below(3) == 0;
    if leaf {
        match chance.below(5) {
            0 => code.push(Op::Active(StepId(chance.below(steps)))),
            1 => {
                code.push(Op::StepTime(StepId(chance.below(steps))));
                code.push(Op::Push(u64::from(chance.below(30))));
                code.push(Op::Compare([Cmp::Ge, Cmp::Lt, Cmp::Eq][chance.below(3) as usize], Num::I64));
            }
            _ => code.push(Op::Load(Addr(chance.below(3)))),
        }
        return;
    }
    expression(chance, steps, depth - 1, code);
    if chance.below(4) == 0 {
        code.push(Op::Not);
        return;
    }
    expression(chance, steps, depth - 1, code);
    code.push([Op::And, Op::Or, Op::Xor][chance.below(3) as usize]);
}

/// Gives some transitions an expression, and some steps a row of extras, so that they are not plain.
fn mixed(chance: &mut Chance, mut t: Tables) -> Tables {
    let steps = t.steps.len() as u32;
    let empty = t.extras.len() as u32;
    t.extras.push(Extra::default());
    for step in &mut t.steps {
        if chance.below(6) == 0 {
            step.extra = empty;
        }
    }
    for transition in &mut t.transitions {
        if chance.below(3) == 0 {
            let start = t.code.len() as u32;
            expression(chance, steps, 4, &mut t.code);
            transition.receptivity = Receptivity::Code(Code { start, end: t.code.len() as u32 });
        }
    }
    t
}

/// Gives some outputs a condition, and some of these two steps that they follow.
fn gated(chance: &mut Chance, mut t: Tables) -> Tables {
    let steps = t.steps.len() as u32;
    for i in 0..t.steps.len() {
        let output = t.steps[i].direct;
        if output.0 == NONE || t.steps[i].extra != NONE || chance.below(2) == 0 {
            continue;
        }
        let start = t.code.len() as u32;
        expression(chance, steps, 2, &mut t.code);
        let condition = Code { start, end: t.code.len() as u32 };
        let new = t.blocks.is_empty() || chance.below(4) > 0;
        if new {
            let (gate, action, period) = (Code::default(), NONE, 0);
            t.blocks.push(ControlBlock { output, action, plain: true, gate, period });
        }
        let row = t.contributions.len() as u32;
        let block = t.blocks.len() as u32 - 1;
        t.contributions.push(Contribution { block, input: 0, condition, time: Code::default(), period: 0 });
        t.extras.push(Extra { contributions: Rows { start: row, end: row + 1 }, ..Extra::default() });
        t.steps[i].direct = Addr(NONE);
        t.steps[i].extra = t.extras.len() as u32 - 1;
    }
    t
}

/// Gives some steps contributions to control blocks, without a condition; several steps may have one
/// block, and a step several.
fn blocked(chance: &mut Chance, mut t: Tables, inputs: &[u8]) -> Tables {
    let mut own = Vec::new();
    for i in 0..t.steps.len() {
        if t.steps[i].direct.0 != NONE && t.steps[i].extra == NONE && chance.below(2) == 0 {
            own.push(i);
            let plain = chance.below(3) == 0;
            let (output, gate) = (t.steps[i].direct, Code::default());
            t.blocks.push(ControlBlock { output, action: NONE, plain, gate, period: 0 });
            t.steps[i].direct = Addr(NONE);
        }
    }
    for i in own {
        let start = t.contributions.len() as u32;
        for _ in 0..=chance.below(3) {
            let block = chance.below(t.blocks.len() as u32);
            let input = if t.blocks[block as usize].plain {
                0
            } else {
                inputs[chance.below(inputs.len() as u32) as usize]
            };
            // A scan is 7 ns long.
            let time = if TIMED.contains(&input) {
                t.code.push(Op::Push(u64::from(chance.below(40))));
                Code { start: t.code.len() as u32 - 1, end: t.code.len() as u32 }
            } else {
                Code::default()
            };
            let condition = Code::default();
            t.contributions.push(Contribution { block, input, condition, time, period: 0 });
        }
        let contributions = Rows { start, end: t.contributions.len() as u32 };
        t.extras.push(Extra { contributions, ..Extra::default() });
        t.steps[i].extra = t.extras.len() as u32 - 1;
    }
    t
}

/// N, S, R, P, P1, P0 and the timed inputs, as places in [`INPUTS`].
const USED: [u8; 11] = [0, 1, 2, 5, 6, 7, 3, 4, 8, 9, 10];
const TIMED: [u8; 5] = [3, 4, 8, 9, 10];

/// The same tables so that no step and no transition is plain and the interpreter evaluates each
/// receptivity and condition: every step has a row of extras, every such code has 0 added to it.
fn roundabout(t: &Tables) -> Tables {
    let mut t = t.clone();
    let plain = t.extras.len() as u32;
    t.extras.push(Extra::default());
    for step in t.steps.iter_mut().filter(|step| step.extra == NONE) {
        step.extra = plain;
    }
    // Nothing counts steps here, so this only takes the short way away from them.
    t.extras.iter_mut().for_each(|e| e.uncounted = true);
    for c in &mut t.contributions {
        for code in [&mut c.condition, &mut c.time].into_iter().filter(|code| !code.is_empty()) {
            let start = t.code.len() as u32;
            t.code.extend_from_within(code.start as usize..code.end as usize);
            t.code.extend([Op::Push(0), Op::Arith(Arith::Add, Num::I64)]);
            *code = Code { start, end: t.code.len() as u32 };
        }
    }
    for transition in &mut t.transitions {
        let start = t.code.len() as u32;
        match transition.receptivity {
            Receptivity::True => t.code.push(Op::Push(1)),
            Receptivity::Word(a) => t.code.push(Op::Load(a)),
            Receptivity::NotWord(a) => t.code.extend([Op::Load(a), Op::Not]),
            Receptivity::Code(code) => t.code.extend_from_within(code.start as usize..code.end as usize),
        }
        t.code.extend([Op::Push(0), Op::Arith(Arith::Add, Num::I64)]);
        transition.receptivity = Receptivity::Code(Code { start, end: t.code.len() as u32 });
    }
    // A block with a gate is evaluated in each scan, not only when a timer ends.
    for c in t.contributions.iter().filter(|c| !c.time.is_empty()) {
        let start = t.code.len() as u32;
        t.code.push(Op::Push(1));
        t.blocks[c.block as usize].gate = Code { start, end: start + 1 };
    }
    let start = t.code.len() as u32;
    t.code.extend([Op::Push(0), Op::Drop]);
    t.pre = Code { start, end: start + 2 };
    t
}

/// The image without its first word, which tells the two programs apart.
fn memory(s: &State) -> &[u64] {
    &s.image()[1..]
}

#[test]
fn both_ways_reach_the_same_situations() {
    let mut chance = Chance(7);
    let mut moved = 0u64;
    for round in 0..3000 {
        let rules = if round % 3 == 0 { Rules::IEC60848 } else { Rules::IEC61131 };
        let rules =
            Rules { multi_token: chance.below(2) == 0, keep_step_time: chance.below(2) == 0, ..rules };
        let mut tables = random(&mut chance, rules);
        if chance.below(2) == 0 {
            tables = mixed(&mut chance, tables);
        }
        let long = Program::new(roundabout(&tables)).expect("tables are sound");
        let short = Program::new(tables).expect("tables are sound");
        let (mut a, mut b) = (State::new(&short), State::new(&long));
        for k in 0..30 {
            let inputs: Vec<u64> = (0..3).map(|_| u64::from(chance.below(2))).collect();
            let (x, y) = (scan(&short, &mut a, &inputs, k * 7), scan(&long, &mut b, &inputs, k * 7));
            assert_eq!(x.is_ok(), y.is_ok(), "round {round}, scan {k}: {x:?} {y:?}");
            assert_eq!(memory(&a), memory(&b), "round {round}, scan {k}");
            match (x, y) {
                (Ok(x), Ok(y)) => {
                    assert_eq!(x.cleared, y.cleared, "round {round}, scan {k}");
                    // Transitions of one pass clear at once: no order to compare.
                    let sorted = |s: &State| {
                        let mut list = s.cleared().to_vec();
                        list.sort_unstable();
                        list
                    };
                    // A long search cuts the list, in the middle of a pass.
                    if a.cleared().len() == x.cleared as usize {
                        assert_eq!(sorted(&a), sorted(&b), "round {round}, scan {k}");
                    }
                    moved += u64::from(x.cleared);
                }
                (Err(x), Err(y)) => {
                    assert!(matches!(x.kind, FaultKind::Unstable { .. }), "{x:?}");
                    assert_eq!(x, y, "round {round}, scan {k}");
                    break;
                }
                _ => {}
            }
        }
    }
    assert!(moved > 50_000, "only {moved} clearings: the charts stand still and show nothing");
}

/// A chart that one token walks through, near and far; here and there a choice,
/// a fork of two that are joined never, or a step without an output.
fn walk(chance: &mut Chance, rules: Rules) -> Tables {
    let steps = [2, 5, 64, 65, 130, 5000][chance.below(6) as usize];
    let forks = chance.below(8) == 0;
    let mut arcs: Vec<Arc> = Vec::new();
    for from in 0..steps {
        for _ in 0..=u32::from(chance.below(16) == 0) {
            let to = if chance.below(4) == 0 { chance.below(steps) } else { (from + 1) % steps };
            let mut post = vec![to];
            if forks && chance.below(40) == 0 {
                post.push((to + 1) % steps);
            }
            let input = chance.below(3) as i32;
            let waits_for = match chance.below(8) {
                0 => None,
                1 => Some(-1 - input),
                _ => Some(input),
            };
            arcs.push((vec![from], post, waits_for));
        }
    }
    let first = chance.below(steps);
    let mut t = chart(rules, steps, 3, &[first], &arcs);
    for step in &mut t.steps {
        if chance.below(5) == 0 {
            step.direct = Addr(NONE);
        }
    }
    t
}

/// A program that runs by the short ways and by the long one, with the same inputs.
struct Both {
    short: Program,
    long: Program,
    a: State,
    b: State,
    inputs: Vec<u64>,
}

impl Both {
    fn new(short: Tables, long: Tables) -> Both {
        let [short, long] = [short, long].map(|tables| Program::new(tables).expect("tables are sound"));
        let (a, b) = (State::new(&short), State::new(&long));
        Both { short, long, a, b, inputs: vec![0; 3] }
    }

    /// Inputs that stand still for a while let the scans be quiet.
    fn move_inputs(&mut self, chance: &mut Chance) {
        if chance.below(3) > 0 {
            self.inputs = (0..3).map(|_| u64::from(chance.below(2))).collect();
        }
    }

    /// Now and then a step or an output is written from outside. An output then keeps the value until its
    /// steps or its condition change.
    fn disturb(&mut self, chance: &mut Chance) {
        let Rows { start, end } = self.short.tables().outputs;
        if chance.below(20) == 0 {
            let step = StepId(chance.below(self.short.tables().steps.len() as u32));
            self.set_step(step, chance.below(2) == 0);
        } else if chance.below(10) == 0 {
            let at = Addr(start + chance.below(end - start));
            let value = u64::from(chance.below(2));
            self.a.set_word(&self.short, at, value);
            self.b.set_word(&self.long, at, value);
        }
    }

    fn set_step(&mut self, step: StepId, on: bool) {
        set_step(&self.short, &mut self.a, step, on);
        set_step(&self.long, &mut self.b, step, on);
    }

    fn scan(&mut self, k: i64) -> [Result<Report, Fault>; 2] {
        [
            scan(&self.short, &mut self.a, &self.inputs, k * 7),
            scan(&self.long, &mut self.b, &self.inputs, k * 7),
        ]
    }
}

#[test]
fn a_lone_token_goes_the_same_way() {
    let mut chance = Chance(11);
    let mut lone = 0u64;
    for round in 0..200 {
        let rules = if round % 4 == 0 { Rules::IEC60848 } else { Rules::IEC61131 };
        let rules = Rules { keep_step_time: chance.below(2) == 0, ..rules };
        let mut tables = walk(&mut chance, rules);
        if chance.below(2) == 0 {
            tables = mixed(&mut chance, tables);
        }
        let steps = tables.steps.len() as u32;
        let long = roundabout(&tables);
        let mut both = Both::new(tables, long);
        for k in 0..60 {
            both.move_inputs(&mut chance);
            if chance.below(30) == 0 {
                both.set_step(StepId(chance.below(steps)), chance.below(2) == 0);
            }
            let [x, y] = both.scan(k);
            assert_eq!(
                x.as_ref().map(|r| r.cleared),
                y.as_ref().map(|r| r.cleared),
                "round {round}, scan {k}"
            );
            assert_eq!(memory(&both.a), memory(&both.b), "round {round}, scan {k}");
            let Ok(x) = x else { break };
            lone += u64::from(x.cleared == 1 && both.a.active().count() == 1);
            if x.cleared == 1 {
                assert_eq!(both.a.cleared(), both.b.cleared(), "round {round}, scan {k}");
            }
        }
    }
    assert!(lone > 2_500, "only {lone} moves of a lone token");
}

/// Many steps that are active at once, each with one transition, which waits for an input, a variable that code
/// writes, a variable that is written from outside, or an output that follows a step. An input wakes a third of the
/// steps, which in the largest charts are so many that sleep ends.
fn crowd(chance: &mut Chance, rules: Rules) -> Tables {
    let steps = if chance.below(30) == 0 { 4300 } else { 80 + chance.below(1000) };
    let third = |step: u32| step * 3 / steps;
    let arcs: Vec<Arc> = (0..steps)
        .map(|from| {
            let to = if chance.below(3) == 0 { chance.below(steps) } else { (from + 1) % steps };
            let input = third(from) as i32;
            (vec![from], vec![to], Some(if chance.below(4) == 0 { -1 - input } else { input }))
        })
        .collect();
    let initial: Vec<u32> = (0..steps).filter(|_| chance.below(2) == 0).collect();
    let mut t = chart(rules, steps, 3, &initial, &arcs);
    let variables = t.init.len() as u32;
    t.init.extend([0, 0]);
    for (from, transition) in (0..).zip(&mut t.transitions) {
        let start = t.code.len() as u32;
        let leaf = match chance.below(8) {
            0 => Op::Load(Addr(variables)),
            1 => Op::Load(Addr(variables + 1)),
            2 => Op::Load(Addr(3 + chance.below(steps))),
            _ => continue,
        };
        match leaf {
            Op::Load(a) if chance.below(2) == 0 => transition.receptivity = Receptivity::Word(a),
            leaf => {
                t.code.extend([leaf, Op::Load(Addr(third(from))), Op::Or]);
                transition.receptivity = Receptivity::Code(Code { start, end: start + 3 });
            }
        }
    }
    // POST turns the first variable round while the first input is TRUE.
    if chance.below(2) == 0 {
        let start = t.code.len() as u32;
        let (variable, input) = (Addr(variables), Addr(0));
        t.code.extend([Op::Load(variable), Op::Load(input), Op::Xor, Op::Store(variable)]);
        t.post = Code { start, end: start + 4 };
    }
    t
}

#[test]
fn steps_that_sleep_are_woken() {
    let mut chance = Chance(23);
    let (mut moved, mut still) = (0u64, 0u64);
    for round in 0..300 {
        let rules = if round % 3 == 0 { Rules::IEC60848 } else { Rules::IEC61131 };
        let rules = Rules { multi_token: chance.below(2) == 0, ..rules };
        let tables = crowd(&mut chance, rules);
        let outside = Addr(tables.init.len() as u32 - 1);
        let long = roundabout(&tables);
        let mut both = Both::new(tables, long);
        let mut earlier = [&both.a, &both.b].map(|s| s.image().to_vec());
        for k in 0..100 {
            if chance.below(3) == 0 {
                both.inputs[chance.below(3) as usize] ^= 1;
            }
            both.disturb(&mut chance);
            if chance.below(30) == 0 {
                let value = u64::from(chance.below(2));
                both.a.set_word(&both.short, outside, value);
                both.b.set_word(&both.long, outside, value);
            }
            // A state that goes back to an earlier image forgets what it has seen since.
            if chance.below(30) == 0 {
                both.a.restore(&both.short, &earlier[0]).expect("the image is of this program");
                both.b.restore(&both.long, &earlier[1]).expect("the image is of this program");
            } else if chance.below(4) == 0 {
                earlier = [&both.a, &both.b].map(|s| s.image().to_vec());
            }
            let [x, y] = both.scan(k);
            assert_eq!(x.is_ok(), y.is_ok(), "round {round}, scan {k}: {x:?} {y:?}");
            let Ok(x) = x else { break };
            assert_eq!(memory(&both.a), memory(&both.b), "round {round}, scan {k}");
            moved += u64::from(x.cleared);
            still += u64::from(x.cleared == 0);
        }
    }
    assert!(moved > 50_000 && still > 1_000, "{moved} clearings, {still} scans without");
}

/// Many steps sleep; then all their tokens meet in one step, and go on alone round a ring of other steps. A step
/// that is activated from outside finds the token where it is.
#[test]
fn sleep_ends_with_the_last_token() {
    let (many, ring) = (700, 200);
    let mut arcs: Vec<Arc> = (0..many).map(|from| (vec![from], vec![many], Some(0))).collect();
    arcs.extend((0..ring).map(|k| (vec![many + k], vec![many + (k + 1) % ring], Some(1))));
    let initial: Vec<u32> = (0..many).collect();
    let tables = chart(Rules::IEC61131, many + ring, 3, &initial, &arcs);
    let long = roundabout(&tables);
    let mut both = Both::new(tables, long);
    let mut tokens = Vec::new();
    for k in 0..170 {
        both.inputs = [k == 5, k > 5, false].map(u64::from).to_vec();
        if k == 155 {
            both.set_step(StepId(3), true);
        }
        let [x, y] = both.scan(k);
        assert_eq!(x, y, "scan {k}");
        assert_eq!(memory(&both.a), memory(&both.b), "scan {k}");
        tokens.push(both.a.active().count());
    }
    assert_eq!([tokens[4], tokens[5], tokens[154], tokens[169]], [700, 1, 1, 2]);
}

/// The active steps, their times where these are read, and the outputs.
fn shown(p: &Program, s: &State) -> (Vec<(StepId, i64)>, Vec<u64>) {
    let read = |step| p.tables().code.contains(&Op::StepTime(step));
    let steps = s.active().map(|step| (step, if read(step) { s.step_time(p, step) } else { 0 })).collect();
    let Rows { start, end } = p.tables().outputs;
    (steps, (start..end).map(|a| s.word(Addr(a))).collect())
}

#[test]
fn outputs_with_a_condition_have_the_same_values() {
    assert_eq!(INPUTS[0], "N");
    let mut chance = Chance(13);
    let mut changes = 0u64;
    for round in 0..1500 {
        let rules = if round % 3 == 0 { Rules::IEC60848 } else { Rules::IEC61131 };
        let rules =
            Rules { multi_token: chance.below(2) == 0, keep_step_time: chance.below(2) == 0, ..rules };
        let tables = if chance.below(4) == 0 { walk(&mut chance, rules) } else { random(&mut chance, rules) };
        let tables = if chance.below(2) == 0 { mixed(&mut chance, tables) } else { tables };
        let mut tables = gated(&mut chance, tables);
        let long = roundabout(&tables);
        // Times that no code reads make no difference.
        tables.lean = chance.below(2) == 0;
        let mut both = Both::new(tables, long);
        for k in 0..40 {
            both.move_inputs(&mut chance);
            both.disturb(&mut chance);
            let before = shown(&both.long, &both.b).1;
            let [x, y] = both.scan(k);
            assert_eq!(x.is_ok(), y.is_ok(), "round {round}, scan {k}: {x:?} {y:?}");
            if x.is_err() {
                break;
            }
            let (now, general) = (shown(&both.short, &both.a), shown(&both.long, &both.b));
            assert_eq!(now, general, "round {round}, scan {k}");
            changes += u64::from(now.1 != before);
        }
    }
    assert!(changes > 10_000, "only {changes} scans changed an output");
}

#[test]
fn control_blocks_follow_plain_steps() {
    assert_eq!(
        USED.map(|input| INPUTS[usize::from(input)]),
        ["N", "S", "R", "P", "P1", "P0", "L", "D", "SD", "DS", "SL"]
    );
    let mut chance = Chance(17);
    let (mut changes, mut lone) = (0u64, 0u64);
    for round in 0..1000 {
        let rules = match round % 4 {
            0 => Rules::IEC60848,
            1 => Rules { final_scan: true, ..Rules::IEC61131 },
            _ => Rules::IEC61131,
        };
        let rules =
            Rules { multi_token: chance.below(2) == 0, keep_step_time: chance.below(2) == 0, ..rules };
        let tables = if chance.below(4) == 0 { walk(&mut chance, rules) } else { random(&mut chance, rules) };
        let inputs = if chance.below(2) == 0 { &USED[..6] } else { &USED };
        let tables = blocked(&mut chance, tables, inputs);
        // The long way notes for itself which contributions with a time count at present.
        let timed = tables.contributions.iter().any(|c| !c.time.is_empty());
        let tables = if chance.below(3) == 0 { mixed(&mut chance, tables) } else { tables };
        let long = roundabout(&tables);
        let mut both = Both::new(tables, long);
        for k in 0..40 {
            both.move_inputs(&mut chance);
            both.disturb(&mut chance);
            let before = shown(&both.long, &both.b).1;
            let [x, y] = both.scan(k);
            assert_eq!(x.is_ok(), y.is_ok(), "round {round}, scan {k}: {x:?} {y:?}");
            if timed {
                assert_eq!(both.a.words(), both.b.words(), "round {round}, scan {k}");
                assert!(both.a.active().eq(both.b.active()), "round {round}, scan {k}");
            } else {
                assert_eq!(memory(&both.a), memory(&both.b), "round {round}, scan {k}");
            }
            let (Ok(x), Ok(y)) = (x, y) else { break };
            assert_eq!(x, y, "round {round}, scan {k}");
            changes += u64::from(shown(&both.short, &both.a).1 != before);
            lone += u64::from(x.cleared > 0 && both.a.active().count() == 1);
        }
    }
    assert!(changes > 8_000 && lone > 2_000, "{changes} scans changed an output, {lone} moves alone");
}
