//! Text to a plant, ticks of it, and looking into it by name.

use g7_compile::plant::{PlantProgram, compile_plant, plants};
use g7_compile::symbols::{Symbols, Variable};
use g7_compile::{Compiled, compile};
use g7_engine::{Addr, Program, State, scan};
use g7_model::FileId;

/// A chart with two outputs and two inputs, for plants to answer.
const CHART: &str = "
    input a : BOOL
    input r : REAL
    output V, W : BOOL
    chart G {
      initial step 0 { N V }
      step 1 { N W }
      0 -> 1 when a -> 0 when r > 0.5
    }
";

/// The text of a plant `P` with these items, beside the chart.
pub(crate) fn text(items: &str) -> String {
    format!("{CHART}\nplant P {{\n{items}\n}}")
}

/// Compiles the charts and the first plant of a text; the codes where it cannot.
pub(crate) fn compiled(text: &str) -> Result<(Compiled, PlantProgram), Vec<&'static str>> {
    let (doc, problems) = g7_syntax::parse(text, FileId(0));
    assert!(problems.is_empty(), "{problems:#?}");
    let (charts, problems) = compile(&doc);
    let charts = charts.unwrap_or_else(|| panic!("{problems:#?}"));
    let (plant, problems) = compile_plant(&doc, plants(&doc).next().expect("a plant"), &charts, &[]);
    plant.map(|p| (charts, p)).ok_or_else(|| problems.iter().map(|p| p.code.id).collect())
}

/// A plant being run.
pub(crate) struct Run {
    pub(crate) charts: Compiled,
    pub(crate) plant: PlantProgram,
    state: State,
    inputs: Vec<u64>,
    now: i64,
    /// Time between two ticks, ns.
    pub(crate) period: i64,
}

/// A plant `P` with these items before its first tick, ten milliseconds a tick.
pub(crate) fn run(items: &str) -> Run {
    run_text(&text(items))
}

/// The first plant of a text before its first tick.
pub(crate) fn run_text(text: &str) -> Run {
    let (charts, plant) = compiled(text).unwrap_or_else(|codes| panic!("{codes:?}"));
    let inputs = plant.compiled.program.tables().inputs;
    let state = State::new(&plant.compiled.program);
    let inputs = vec![0; (inputs.end - inputs.start) as usize];
    Run { charts, plant, state, inputs, now: 0, period: 10_000_000 }
}

impl Run {
    fn program(&self) -> &Program {
        &self.plant.compiled.program
    }

    fn symbols(&self) -> &Symbols {
        &self.plant.compiled.symbols
    }

    fn variable(&self, name: &str) -> &Variable {
        self.symbols().variable(name).unwrap_or_else(|| panic!("no {name}"))
    }

    /// An output of the charts as the plant sees it.
    pub(crate) fn output(&mut self, name: &str, value: bool) -> &mut Run {
        let at = self.variable(name).addr.0 - self.program().tables().inputs.start;
        self.inputs[at as usize] = u64::from(value);
        self
    }

    /// Sets a state from outside.
    pub(crate) fn set(&mut self, name: &str, word: u64) -> &mut Run {
        let at = self.variable(name).addr;
        self.state.set_word(&self.plant.compiled.program, at, word);
        self
    }

    /// Where chance begins.
    pub(crate) fn seed(&mut self, seed: u64) -> &mut Run {
        let at = self.symbols().seed.expect("chance");
        self.state.set_word(&self.plant.compiled.program, at, seed);
        self
    }

    pub(crate) fn ticks(&mut self, n: u32) -> &mut Run {
        for _ in 0..n {
            scan(&self.plant.compiled.program, &mut self.state, &self.inputs, self.now).expect("a tick");
            self.now += self.period;
        }
        self
    }

    fn word(&self, addr: Addr) -> u64 {
        self.state.word(addr)
    }

    pub(crate) fn int(&self, name: &str) -> i64 {
        self.word(self.variable(name).addr) as i64
    }

    pub(crate) fn bool(&self, name: &str) -> bool {
        self.int(name) != 0
    }

    pub(crate) fn real(&self, name: &str) -> f32 {
        f32::from_bits(self.word(self.variable(name).addr) as u32)
    }

    pub(crate) fn lreal(&self, name: &str) -> f64 {
        f64::from_bits(self.word(self.variable(name).addr))
    }

    /// The word that an input of the charts is given.
    pub(crate) fn driven(&self, input: &str) -> u64 {
        let to = self.charts.symbols.variable(input).expect("an input").addr;
        let link = self.plant.to_charts.iter().find(|l| l.to == to).expect("driven");
        self.word(link.from)
    }
}

/// Equal but for rounding.
#[track_caller]
pub(crate) fn near(a: f64, b: f64) {
    assert!((a - b).abs() < 1e-4, "{a} is not {b}");
}
