//! Text to a compiled chart, and looking into it by name.

use g7_compile::{Compiled, compile};
use g7_engine::{Addr, Extra, Fault, NONE, Op, Rows, State, StepId, Tables, Transition, scan};
use g7_model::{FileId, Problem, Severity};

/// Compiles a text without errors.
pub(crate) fn compiled(text: &str) -> Compiled {
    let (doc, problems) = g7_syntax::parse(text, FileId(0));
    assert!(problems.is_empty(), "{problems:#?}");
    let (made, problems) = compile(&doc);
    let errors: Vec<&Problem> = problems.iter().filter(|p| p.severity() == Severity::Error).collect();
    made.unwrap_or_else(|| panic!("{errors:#?}"))
}

/// The problems of a text that cannot be compiled.
pub(crate) fn refused(text: &str) -> Vec<&'static str> {
    let (doc, problems) = g7_syntax::parse(text, FileId(0));
    assert!(problems.is_empty(), "{problems:#?}");
    let (made, problems) = compile(&doc);
    assert!(made.is_none());
    problems.iter().map(|p| p.code.id).collect()
}

/// Questions by name.
pub(crate) trait Look {
    fn tables(&self) -> &Tables;
    fn step(&self, name: &str) -> StepId;
    fn addr(&self, name: &str) -> Addr;
    /// The rank of a labelled transition.
    fn rank(&self, label: &str) -> u32;
    fn transition(&self, label: &str) -> Transition;
    /// The preceding steps of a labelled transition, by name.
    fn from(&self, label: &str) -> Vec<String>;
    /// The succeeding steps of a labelled transition, by name.
    fn to(&self, label: &str) -> Vec<String>;
    fn extra(&self, step: &str) -> Extra;
    fn ops(&self, code: g7_engine::Code) -> &[Op];
    fn start(&self) -> Run<'_>;
}

impl Look for Compiled {
    fn tables(&self) -> &Tables {
        self.program.tables()
    }

    fn step(&self, name: &str) -> StepId {
        self.symbols.step(name).unwrap_or_else(|| panic!("no step {name}"))
    }

    fn addr(&self, name: &str) -> Addr {
        self.symbols.variable(name).unwrap_or_else(|| panic!("no variable {name}")).addr
    }

    fn rank(&self, label: &str) -> u32 {
        (0..self.symbols.transitions())
            .find(|r| self.symbols.label(*r) == Some(label))
            .unwrap_or_else(|| panic!("no transition {label}"))
    }

    fn transition(&self, label: &str) -> Transition {
        self.tables().transitions[self.rank(label) as usize]
    }

    fn from(&self, label: &str) -> Vec<String> {
        let t = self.transition(label);
        names(self, t.from, t.more_from)
    }

    fn to(&self, label: &str) -> Vec<String> {
        let t = self.transition(label);
        names(self, t.to, t.more_to)
    }

    fn extra(&self, step: &str) -> Extra {
        let row = self.tables().steps[self.step(step).0 as usize].extra;
        if row == NONE { Extra::default() } else { self.tables().extras[row as usize] }
    }

    fn ops(&self, code: g7_engine::Code) -> &[Op] {
        &self.tables().code[code.start as usize..code.end as usize]
    }

    fn start(&self) -> Run<'_> {
        let inputs = self.tables().inputs;
        let state = State::new(&self.program);
        Run { c: self, state, inputs: vec![0; (inputs.end - inputs.start) as usize], now: 0 }
    }
}

fn names(c: &Compiled, first: StepId, more: Rows) -> Vec<String> {
    let rest = &c.tables().arcs[more.start as usize..more.end as usize];
    let first = (first.0 != NONE).then_some(first);
    first.iter().chain(rest).map(|s| c.symbols.step_name(*s).to_owned()).collect()
}

/// A chart being run, ten milliseconds a scan.
pub(crate) struct Run<'a> {
    c: &'a Compiled,
    pub(crate) state: State,
    inputs: Vec<u64>,
    now: i64,
}

impl Run<'_> {
    /// Gives an input a value from now on.
    pub(crate) fn set(&mut self, input: &str, value: u64) -> &mut Self {
        self.inputs[self.c.addr(input).0 as usize] = value;
        self
    }

    pub(crate) fn scan(&mut self) -> &mut Self {
        self.try_scan().unwrap_or_else(|f| panic!("{f:?}"));
        self
    }

    pub(crate) fn try_scan(&mut self) -> Result<(), Fault> {
        let done = scan(&self.c.program, &mut self.state, &self.inputs, self.now);
        self.now += 10_000_000;
        done.map(|_| ())
    }

    /// The active steps, sorted and separated by blanks.
    pub(crate) fn situation(&self) -> String {
        let mut names: Vec<&str> = self.c.symbols.situation(&self.state).collect();
        names.sort_unstable();
        names.join(" ")
    }

    /// A variable as text.
    pub(crate) fn value(&self, name: &str) -> String {
        let v = self.c.symbols.variable(name).unwrap_or_else(|| panic!("no variable {name}"));
        g7_compile::symbols::Symbols::value_text(v.ty, v.value(&self.state))
    }
}
