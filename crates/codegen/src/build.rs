//! From the engine's tables to the tree: what of the runtime a program needs,
//! and the functions that only it has.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use g7_compile::Compiled;
use g7_engine::{Addr, Code, NONE, Num, Receptivity, Rows, StepId, Tables};
use g7_equations::{Bodies, Expr as Term, Stmt as Line};
use g7_model::{Problem, Said, Span, Type, codes, say};

use crate::body::{self, Code as Translated};
use crate::names::{Names, of_transition};
use crate::pack;
use crate::room::Room;
use crate::runtime::{self, Facts};
use crate::tree::{Arm, Bin, Block, Expr, Function, Module, Numbers, Stmt, Struct, Ty};
use crate::vars::{Home, Vars, num};

/// Arms up to which a choice is one function: compilers take more than their share of time for
/// longer ones.
const LONG: usize = 400;

/// The arms of a longer choice stand in functions, one for so many bits of the number.
const PART: usize = 7;

/// The work in hand.
pub(crate) struct Gen<'a> {
    pub(crate) c: &'a Compiled,
    pub(crate) t: &'a Tables,
    /// The text of the chart, for comments.
    source: &'a str,
    pub(crate) vars: Vars,
    pub(crate) names: Names,
    /// The chart's code, piece by piece.
    pub(crate) bodies: Bodies<'a>,
    /// Names of texts that never change.
    pub(crate) texts: HashMap<String, String>,
    pub(crate) m: Module,
    pub(crate) facts: Facts,
    /// How much room the code may take.
    pub(crate) room: Room,
    /// Steps whose time the chart reads.
    pub(crate) timed: BTreeSet<u32>,
    pub(crate) steps: Vec<String>,
    pub(crate) transitions: Vec<String>,
    pub(crate) problems: Vec<Problem>,
    /// The place in the chart of the code in hand.
    pub(crate) at: Span,
    /// The first function that C and Rust have from elsewhere.
    pub(crate) math: Option<Span>,
    /// The first real that becomes a text or comes from one.
    pub(crate) real_text: Option<Span>,
}

/// A parameter that every function of the state has.
pub(crate) fn state() -> (String, Ty) {
    ("s".into(), Ty::Ref(true, Box::new(Ty::Named("State".into()))))
}

pub(crate) fn s() -> Expr {
    Expr::name("s")
}

pub(crate) fn memory(field: &str) -> Expr {
    s().field("m").field(field)
}

impl<'a> Gen<'a> {
    pub(crate) fn new(c: &'a Compiled, source: &'a str, room: Room) -> Gen<'a> {
        let t = c.program.tables();
        let mut names = Names::default();
        let vars = Vars::new(&c.symbols, &mut names);
        let mut g = Gen {
            c,
            t,
            source,
            vars,
            names,
            bodies: Bodies::new(c),
            texts: HashMap::new(),
            m: Module::default(),
            facts: Facts::default(),
            room,
            timed: BTreeSet::new(),
            steps: Vec::new(),
            transitions: Vec::new(),
            problems: Vec::new(),
            at: Span::default(),
            math: None,
            real_text: None,
        };
        g.number();
        g.facts = crate::facts::of(t, room);
        g
    }

    /// Names for steps, transitions and faults.
    fn number(&mut self) {
        let mut steps =
            Numbers { note: "The steps.".into(), name: "Step".into(), public: true, ..Numbers::default() };
        for i in 0..self.t.steps.len() {
            let id = StepId(i as u32);
            let symbols = &self.c.symbols;
            let name = self.names.capital("STEP", symbols.step_name(id));
            let note = symbols.step_path(id).to_owned();
            let note =
                if symbols.is_listed(id) { note } else { format!("{note} (stands for the macro-step)") };
            steps.rows.push((name.clone(), i, note));
            self.steps.push(name);
        }
        let mut rows = Numbers {
            note: "The transitions, in order of rank.".into(),
            name: "Transition".into(),
            ..Numbers::default()
        };
        for i in 0..self.t.transitions.len() {
            let name = self.names.capital("T", &of_transition(&self.c.symbols, i as u32));
            rows.rows.push((name.clone(), i, String::new()));
            self.transitions.push(name);
        }
        let faults = runtime::FAULTS
            .iter()
            .enumerate()
            .map(|(i, (name, note))| ((*name).to_owned(), i, (*note).to_owned()));
        let faults = Numbers {
            note: "The faults that stop a scan.".into(),
            name: "Fault".into(),
            public: true,
            ty: Some(Ty::U8),
            rows: faults.collect(),
        };
        self.m.numbers = vec![faults, steps, rows];
    }

    /// Only the steps whose time is read have one.
    fn few_times(&mut self) {
        let none = self.timed.len() as u32;
        let place = |step: u32| self.timed.iter().position(|s| *s == step).map_or(none, |i| i as u32);
        let places: Vec<u32> = (0..self.t.steps.len() as u32).map(place).collect();
        self.numbers("TIME_OF", &format!("Where the time of each step stands; {none} for none."), &places);
        self.facts.timed = self.timed.len();
        self.facts.has_times = !self.timed.is_empty();
    }

    /// Refuses a time that is longer than the clock can tell.
    pub(crate) fn judge_time(&mut self, nanoseconds: i64) {
        let longest = self.room.clock.longest();
        if nanoseconds <= longest {
            return;
        }
        let text = say!(
            "a time of {} s does not fit: 32 bits of {} tell {} s; a coarser unit of the clock, or nanoseconds in 64 bits, hold it",
            nanoseconds / 1_000_000_000,
            Said::foreign(self.room.clock.unit()),
            longest / 1_000_000_000
        );
        if self.problems.iter().all(|p| *p.what != *text) {
            self.problems.push(Problem::new(&codes::NOT_CARRIED, self.at, text));
        }
    }

    /// The same for the times that variables begin with.
    pub(crate) fn judge_initial_times(&mut self) {
        let c = self.c;
        for v in c.symbols.variables.iter().filter(|v| v.ty == Type::Time) {
            for word in self.t.init.get(v.addr.0 as usize..(v.addr.0 + v.elements) as usize).unwrap_or(&[]) {
                self.at = v.at;
                self.judge_time(*word as i64);
            }
        }
    }

    /// Reports a construct that the language of the code cannot say.
    pub(crate) fn cannot(&mut self, what: Said) {
        let text = say!("{what} cannot be printed as code");
        if self.problems.iter().all(|p| *p.what != *text) {
            self.problems.push(Problem::new(&codes::NOT_CARRIED, self.at, text));
        }
    }

    pub(crate) fn step(&self, step: StepId) -> Expr {
        Expr::name(self.steps.get(step.0 as usize).cloned().unwrap_or_default())
    }

    pub(crate) fn transition(&self, rank: u32) -> Expr {
        Expr::name(self.transitions.get(rank as usize).cloned().unwrap_or_default())
    }

    pub(crate) fn active(&self, step: StepId) -> Expr {
        memory("x").at(self.step(step))
    }

    /// True if a period is due in this scan.
    pub(crate) fn due(&self, period: u32) -> Expr {
        let known = self.t.periods.get(period as usize).is_none_or(|p| *p <= 0);
        if known { Expr::Bool(true) } else { s().field("due").at(Expr::size(period as usize)) }
    }

    /// A piece of the chart's text on one line.
    pub(crate) fn text(&self, span: Span) -> String {
        let text = self.source.get(span.start as usize..span.end as usize).unwrap_or("");
        let words: Vec<&str> = text.split_whitespace().collect();
        let line = words.join(" ");
        match line.char_indices().nth(90) {
            Some((i, _)) => format!("{} …", line.get(..i).unwrap_or("")),
            None => line,
        }
    }

    /// The name of a transition in comments.
    pub(crate) fn transition_note(&self, rank: u32) -> String {
        let text = self.text(self.c.symbols.transition_place(rank));
        if text.is_empty() || !self.c.symbols.is_written(rank) {
            self.c.symbols.transition_text(rank).to_owned()
        } else {
            text
        }
    }

    pub(crate) fn function(&mut self, name: &str, note: &str, parameters: Vec<(String, Ty)>, body: Block) {
        let result = None;
        let (note, name) = (note.to_owned(), name.to_owned());
        self.m.functions.push(Function { public: false, note, name, parameters, result, body });
    }

    /// The value of code: an expression where it is one, else a function of its own;
    /// and whether it can end in a fault.
    pub(crate) fn value(&mut self, code: Code, ty: Type, name: &str) -> (Expr, bool) {
        self.at = self.c.symbols.place(code.start);
        let (list, value) = self.bodies.value(code);
        let n = num(ty).unwrap_or(Num::I64);
        let Translated { block, value, fails } = body::translate(self, &list, Some((&value, n)));
        let value = value.unwrap_or(Expr::Bool(false));
        if block.is_empty() {
            return (value, false);
        }
        let name = self.names.small(name);
        let mut body = block;
        body.push(Stmt::Return(Some(value)));
        let result = Some(crate::vars::ty(n));
        let (parameters, note) = (vec![state()], String::new());
        let call = Expr::call(name.clone(), vec![s()]);
        self.m.functions.push(Function { public: false, note, name, parameters, result, body });
        (call, fails)
    }

    /// A condition, which holds where there is none; and whether it can end in a fault.
    pub(crate) fn condition(&mut self, code: Code, name: &str) -> (Expr, bool) {
        if code.is_empty() { (Expr::Bool(true), false) } else { self.value(code, Type::Bool, name) }
    }

    pub(crate) fn guard(&mut self, rank: u32) -> (Expr, bool) {
        let Some(tr) = self.t.transitions.get(rank as usize) else { return (Expr::Bool(false), false) };
        match tr.receptivity {
            Receptivity::True => (Expr::Bool(true), false),
            Receptivity::Word(a) => (self.bool_at(a), false),
            Receptivity::NotWord(a) => (self.bool_at(a).not(), false),
            Receptivity::Code(code) => {
                let name =
                    format!("guard_{}", self.transitions.get(rank as usize).cloned().unwrap_or_default());
                self.value(code, Type::Bool, &name)
            }
        }
    }

    /// A BOOL variable.
    fn bool_at(&mut self, addr: Addr) -> Expr {
        let memory = self.bodies.word(addr, Type::Bool);
        body::translate(self, &[], Some((&Term::Read(memory), Num::Bool))).value.unwrap_or(Expr::Bool(false))
    }

    /// Statements of the chart's code.
    pub(crate) fn statements(&mut self, list: &[Line]) -> Block {
        body::translate(self, list, None).block
    }

    /// A function that does something for one of many numbers.
    pub(crate) fn choice(&mut self, name: &str, note: &str, of: &str, arms: Vec<Arm>) {
        self.choose(name, note, of, None, arms);
    }

    /// The same with a value, which is FALSE for a number that has no arm.
    pub(crate) fn question(&mut self, name: &str, note: &str, of: &str, arms: Vec<Arm>) {
        self.choose(name, note, of, Some(Ty::Bool), arms);
    }

    fn choose(&mut self, name: &str, note: &str, of: &str, result: Option<Ty>, arms: Vec<Arm>) {
        if arms.len() <= LONG {
            self.one_of(name, note, Expr::name(of), of, result, arms);
            return;
        }
        let names = self.steps.iter().enumerate().chain(self.transitions.iter().enumerate());
        let numbers: HashMap<String, usize> = names.map(|(i, name)| (name.clone(), i)).collect();
        let mut parts: BTreeMap<usize, Vec<Arm>> = BTreeMap::new();
        for arm in arms {
            let number = match &arm.label {
                Expr::Name(name) => numbers.get(name).copied().unwrap_or(0),
                Expr::Int(n, _) => *n as usize,
                _ => 0,
            };
            parts.entry(number >> PART).or_default().push(arm);
        }
        let mut all = Vec::new();
        for (part, arms) in parts {
            let name = format!("{name}_part_{part}");
            self.one_of(&name, "", Expr::name(of), of, result.clone(), arms);
            let call = Expr::call(name, vec![s(), Expr::name(of)]);
            let body = vec![if result.is_some() { Stmt::Return(Some(call)) } else { Stmt::Do(call) }];
            all.push(Arm { label: Expr::size(part), note: String::new(), body });
        }
        let part = Expr::name(of).bin(Bin::Shr, Expr::size(PART));
        self.one_of(name, note, part, of, result, all);
    }

    fn one_of(&mut self, name: &str, note: &str, by: Expr, of: &str, result: Option<Ty>, arms: Vec<Arm>) {
        let parameters = vec![state(), (of.to_owned(), Ty::Size)];
        let mut body = vec![Stmt::Match(by, arms)];
        if result.is_some() {
            body.push(Stmt::Return(Some(Expr::Bool(false))));
        }
        let (note, name) = (note.to_owned(), name.to_owned());
        self.m.functions.push(Function { public: false, note, name, parameters, result, body });
    }

    /// Everything of the structured style: what is this chart's own, and the runtime
    /// that all charts have in common.
    pub(crate) fn structured(&mut self) {
        self.chart();
        self.acts();
        self.limits();
        if self.room.small {
            self.few_times();
        }
        // The smaller structures first: the larger ones consist of them.
        let (structs, functions) = runtime::of(&self.facts);
        self.m.structs.extend(structs);
        self.m.functions.extend(functions);
        if self.room.small {
            pack::pack(&mut self.m);
        }
    }

    /// The structures that hold the variables.
    pub(crate) fn structures(&mut self) {
        let homes = [
            (Home::Inputs, "Inputs", "The inputs."),
            (Home::Outputs, "Outputs", "The outputs."),
            (Home::Variables, "Variables", "The variables of the chart."),
            (Home::Locals, "Locals", "Intermediate values."),
        ];
        for (home, name, note) in homes {
            let fields = self.vars.fields(home);
            self.m.structs.push(Struct { public: true, note: note.into(), name: name.into(), fields });
        }
    }

    /// Calls of the section, where there is something in it.
    pub(crate) fn section(&mut self, name: &str, note: &str, code: Code) {
        if !code.is_empty() {
            self.at = self.c.symbols.place(code.start);
            let list = self.bodies.work(code);
            let body = self.statements(&list);
            self.function(name, note, vec![state()], body);
        }
    }

    /// Rows of a list as numbers.
    pub(crate) fn list(rows: &[u32], r: Rows) -> Vec<u32> {
        rows.get(r.start as usize..r.end as usize).unwrap_or(&[]).to_vec()
    }

    /// Preceding or succeeding steps of a transition.
    pub(crate) fn ends(&self, first: StepId, rest: Rows) -> Vec<StepId> {
        let more = self.t.arcs.get(rest.start as usize..rest.end as usize).unwrap_or(&[]);
        let first = (first.0 != NONE).then_some(first);
        first.into_iter().chain(more.iter().copied()).collect()
    }
}
