//! Where the memories of a chart's code live in the structured style: variables in
//! their structures, steps, edges and times in those of the runtime.

use g7_engine::{Addr, Block as FunctionBlock, GroupId, Num, StepId, WatchId};
use g7_equations::{Memory, MemoryId, What};
use g7_model::{Problem, Said, codes, say};

use crate::body::{Home, Places};
use crate::build::{Gen, memory, s};
use crate::operations::Needs;
use crate::tree::{Block, Const, Expr, Known, Stmt, Ty};
use crate::vars::{Shape, Slot, block_names, members, text_bytes};

impl Gen<'_> {
    fn what(&self, id: MemoryId) -> What {
        self.bodies.memory(id).map_or(What::Temporary(0), |m| m.what)
    }

    /// The variable that a memory is, or a part of, and the place of that part.
    pub(crate) fn slot_of(&mut self, id: MemoryId) -> Option<(Slot, usize)> {
        let memory = self.bodies.memory(id)?.clone();
        let addr = match memory.what {
            What::Variable(Addr(addr)) => addr,
            // Of a timer block the word behind the members says when it started.
            What::BlockClock(Addr(base)) => base + START,
            _ => return None,
        };
        self.vars.reveal(addr, &memory, &mut self.names);
        let slot = self.vars.slot(addr)?.clone();
        let part = (addr - slot.start) as usize;
        Some((slot, part))
    }

    /// A variable, at its own place or at that of a copy.
    fn part(&mut self, slot: &Slot, part: usize, place: Expr) -> Home {
        match slot.shape {
            Shape::One(n) => Home::Number(place, n),
            Shape::Text(cap) => Home::Text(place, cap),
            Shape::Many(n, _) => Home::Table(place, n),
            Shape::Fb(kind) => match members(kind).get(part) {
                Some((name, n)) => Home::Number(place.field(*name), *n),
                None => self.no_home(say!("a table of function blocks")),
            },
            Shape::Texts(..) => self.no_home(say!("a table of texts")),
        }
    }

    fn no_home(&mut self, what: Said) -> Home {
        self.cannot(what);
        Home::Number(Expr::Bool(false), Num::Bool)
    }

    /// The flag that tells of a variable, or of a part of it, that it was written.
    fn flag(&self, slot: &Slot, part: usize, flags: Expr) -> Home {
        let flag = if matches!(slot.shape, Shape::Fb(_)) { flags.at(Expr::size(part)) } else { flags };
        Home::Number(flag, Num::Bool)
    }

    fn step_bit(&self, field: &str, step: StepId) -> Home {
        Home::Number(Expr::call("bit", vec![shared(field), self.step(step)]), Num::Bool)
    }

    fn group_bit(&self, field: &str, group: GroupId) -> Home {
        Home::Number(Expr::call("bit", vec![shared(field), Expr::size(group.0 as usize)]), Num::Bool)
    }
}

/// The word of a timer block that says when it started.
const START: u32 = 4;

fn shared(field: &str) -> Expr {
    Expr::Ref(false, Box::new(memory(field)))
}

fn call(f: &str, arg: Expr) -> Expr {
    Expr::call(f, vec![s(), arg])
}

impl Places for Gen<'_> {
    fn memory(&self, id: MemoryId) -> Option<&Memory> {
        self.bodies.memory(id)
    }

    fn home(&mut self, id: MemoryId) -> Home {
        let bit =
            |field: &str, w: WatchId| Home::Number(memory(field).at(Expr::size(w.0 as usize)), Num::Bool);
        let scans = self.facts.scan_clock;
        let time = |name: &str, arg: Expr| Home::Number(call(name, arg), Num::I64);
        if let What::StepTime(step) | What::StepScans(step) = self.what(id) {
            self.timed.insert(step.0);
        }
        match self.what(id) {
            What::Variable(_) | What::BlockClock(_) => match self.slot_of(id) {
                Some((slot, part)) => self.part(&slot, part, slot.place()),
                None => self.no_home(say!("a variable without a place")),
            },
            What::Own(of) => match self.slot_of(of) {
                Some((slot, part)) if matches!(slot.shape, Shape::Fb(_)) => {
                    self.part(&slot, part, Expr::name(own(&slot)))
                }
                slot => Home::Local(slot.map(|(slot, _)| own(&slot))),
            },
            What::OwnWrote(of) => match self.slot_of(of) {
                Some((slot, part)) if matches!(slot.shape, Shape::Fb(_)) => {
                    self.flag(&slot, part, Expr::name(own_set(&slot)))
                }
                slot => Home::Local(slot.map(|(slot, _)| own_set(&slot))),
            },
            What::Given(of) => match self.slot_of(of) {
                Some((slot, part)) => self.part(&slot, part, s().field("next").field(slot.field.clone())),
                None => self.no_home(say!("a variable without a place")),
            },
            What::Wrote(of) => match self.slot_of(of) {
                Some((slot, part)) => self.flag(&slot, part, s().field("wrote").field(slot.field.clone())),
                None => self.no_home(say!("a variable without a place")),
            },
            What::Step(step) => Home::Number(self.active(step), Num::Bool),
            What::Was(step) => Home::Number(s().field("before").at(self.step(step)), Num::Bool),
            What::GroupActive(g) => Home::Number(call("group_active", Expr::size(g.0 as usize)), Num::Bool),
            What::StepTime(step) => time(if scans { "step_age" } else { "step_time" }, self.step(step)),
            What::StepScans(step) => time("step_time", self.step(step)),
            What::GroupTime(g) => {
                time(if scans { "group_age" } else { "group_time" }, Expr::size(g.0 as usize))
            }
            What::GroupScans(g) => time("group_time", Expr::size(g.0 as usize)),
            What::Rise(w) => bit("rise", w),
            What::Fall(w) => bit("fall", w),
            What::Timer(w) => bit("timer", w),
            What::Due(period) => Home::Number(self.due(period), Num::Bool),
            What::Dt => Home::Number(s().field("dt"), Num::I64),
            What::Work => Home::Number(s().field("work"), Num::I32),
            // Nothing reads it: it is set, and `assign` makes a call of that.
            What::ResetTimes => Home::Number(Expr::Bool(false), Num::Bool),
            What::RequestStart => Home::Number(memory("ask_start"), Num::Bool),
            What::RequestInit(g) => self.group_bit("ask_init", g),
            What::RequestClear(g) => self.group_bit("ask_clear", g),
            What::RequestSet(step) => self.step_bit("ask_set", step),
            What::RequestReset(step) => self.step_bit("ask_reset", step),
            _ => Home::Local(None),
        }
    }

    fn assign(&mut self, id: MemoryId, value: &Expr) -> Option<Block> {
        let on = *value == Expr::Bool(true);
        let change = |field: &str, i: Expr| {
            let f = if on { "bit_set" } else { "bit_clear" };
            Stmt::Do(Expr::call(f, vec![memory(field).passed(), i]))
        };
        let group = |g: GroupId| Expr::size(g.0 as usize);
        let asked = match self.what(id) {
            What::ResetTimes => return Some(vec![Stmt::Do(Expr::call("reset_times", vec![s()]))]),
            What::RequestStart => Stmt::set(memory("ask_start"), value.clone()),
            What::RequestInit(g) => change("ask_init", group(g)),
            What::RequestClear(g) => change("ask_clear", group(g)),
            What::RequestSet(step) => change("ask_set", self.step(step)),
            What::RequestReset(step) => change("ask_reset", self.step(step)),
            // The copy of an instance has been made as a whole.
            What::Own(of) => {
                let (slot, part) = self.slot_of(of)?;
                let Home::Number(place, _) = self.part(&slot, part, slot.place()) else { return None };
                return (matches!(slot.shape, Shape::Fb(_)) && *value == place).then(Vec::new);
            }
            _ => return None,
        };
        let mut all = vec![asked];
        if on {
            all.push(Stmt::set(memory("requests"), Expr::Bool(true)));
        }
        Some(all)
    }

    fn call(&mut self, block: FunctionBlock, memories: &[MemoryId]) -> Option<Block> {
        // An input that the action does not give is no memory of its own, but stands in the copy as well.
        let own_of =
            memories.iter().find_map(|m| if let What::Own(of) = self.what(*m) { Some(of) } else { None });
        let (of, is_own) = (own_of.or(memories.first().copied())?, own_of.is_some());
        let (slot, _) = self.slot_of(of)?;
        let Shape::Fb(kind) = slot.shape else { return None };
        let place = if is_own { Expr::name(own(&slot)) } else { slot.place() };
        let mut args = vec![place.passed()];
        if matches!(block, FunctionBlock::Ton | FunctionBlock::Tof | FunctionBlock::Tp) {
            args.push(s().field("now"));
        }
        Some(vec![Stmt::Do(Expr::call(block_names(kind).1, args))])
    }

    fn constant(&mut self, text: &str) -> Expr {
        if let Some(name) = self.texts.get(text) {
            return Expr::name(name.clone());
        }
        let name = self.names.small("words").to_uppercase();
        self.texts.insert(text.to_owned(), name.clone());
        let bytes: Vec<Expr> =
            text_bytes(text.as_bytes(), text.len()).into_iter().map(|b| Expr::size(b.into())).collect();
        self.m.consts.push(Const {
            public: false,
            note: String::new(),
            name: name.clone(),
            ty: Ty::Array(Box::new(Ty::U8), bytes.len()),
            value: Known::Many(bytes),
        });
        Expr::name(name)
    }

    fn time(&mut self, nanoseconds: i64) {
        self.judge_time(nanoseconds);
    }

    fn needs(&mut self, needs: Needs) {
        if needs.math {
            self.math.get_or_insert(self.at);
        }
        if needs.real_text {
            self.real_text.get_or_insert(self.at);
        }
    }

    fn cannot(&mut self, what: Said) {
        let text = say!("{what} cannot be printed as code");
        if self.problems.iter().all(|p| *p.what != *text) {
            self.problems.push(Problem::new(&codes::NOT_CARRIED, self.at, text));
        }
    }
}

/// The name of an action's own copy of a variable.
pub(crate) fn own(slot: &Slot) -> String {
    format!("own_{}", slot.field)
}

/// The name of what tells that the copy was written.
pub(crate) fn own_set(slot: &Slot) -> String {
    format!("own_{}_set", slot.field)
}
