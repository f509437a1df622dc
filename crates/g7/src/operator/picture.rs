//! The picture of the plant, moved by the values of a controller.
//!
//! A simulated plant moves all of its parts. A real machine tells less: its outputs are known, and so is a
//! state of the plant whose value an input reads (`drive level := height`). A part that needs more is
//! told as unknown.

use g7_compile::plant::Binding;
use g7_engine::{Addr, State};
use g7_host::Force;
use g7_model::visit::Visitor;
use g7_model::{Document, Expr, ExprKind, Name, Order, Plant, PlantItem, Span};
use g7_online::Sight;
use g7_page::{Show, show};
use g7_rig::{Bench, Options, PlantSide, Role, Source, build};
use serde_json::{Value, json};

/// The picture of a chart with its wiring.
pub(crate) struct View {
    /// The file, relative to that of the chart.
    file: String,
    /// For each part that moves: true if its value is known.
    known: Vec<bool>,
    /// The plant in whose terms the picture is written; `None` while it is simulated, and then the
    /// bench has it.
    model: Option<Model>,
}

/// A plant that is not run: it is told what is known.
struct Model {
    bench: Bench,
    /// Words of it that are read off the machine: input of the charts, state of the plant.
    measured: Vec<(u32, Addr)>,
}

impl Model {
    fn side(&self) -> Option<&PlantSide> {
        self.bench.plant.as_ref()
    }
}

impl View {
    /// The picture of a chart; `None` without one.
    pub(crate) fn new(source: &Source, bench: &Bench) -> Option<View> {
        if let Some(side) = &bench.plant {
            let file = side.view.clone()?;
            return Some(View { file, known: vec![true; side.bindings.len()], model: None });
        }
        let has_view = |plant: &&Plant| plant.items.iter().any(|item| matches!(item, PlantItem::View(_)));
        let plant = plants(&source.document).find(has_view)?;
        let options = Options { plant: Some(&plant.name.text), ..Options::default() };
        // A plant with an error has no picture; `g7 check` tells it.
        let made = build(source, &options).ok()?.0?;
        let file = made.plant.as_ref()?.view.clone()?;
        let (names, measured) = measured(plant, bench, &made);
        let states = states(plant);
        let is_known = |value: &Expr| {
            let mut free = Free { names: Vec::new(), direct: false };
            free.expr(value);
            let is = |list: &[&str], name: &str| list.iter().any(|known| known.eq_ignore_ascii_case(name));
            !free.direct && free.names.iter().all(|name| is(&names, name) || !is(&states, name))
        };
        let known = bindings(plant).map(is_known).collect();
        Some(View { file, known, model: Some(Model { bench: made, measured }) })
    }

    /// The picture for the page.
    pub(super) fn json(&self, bench: &Bench) -> Option<Value> {
        let part = |(b, known): (&Binding, &bool)| json!({ "element": b.element, "attribute": b.attribute, "known": known });
        let parts: Vec<Value> = self.side(bench)?.bindings.iter().zip(&self.known).map(part).collect();
        Some(json!({ "file": self.file, "bindings": parts, "simulated": self.model.is_none() }))
    }

    fn side<'a>(&'a self, bench: &'a Bench) -> Option<&'a PlantSide> {
        self.model.as_ref().map_or(bench.plant.as_ref(), Model::side)
    }

    /// The state in which the expressions of a machine's picture are evaluated.
    pub(super) fn state(&self) -> Option<State> {
        Some(State::new(&self.model.as_ref()?.side()?.compiled.program))
    }

    /// The values of all parts.
    pub(super) fn values(&self, bench: &Bench, sight: &mut Sight, state: Option<&mut State>) -> Vec<Show> {
        let (Some(model), Some(state)) = (&self.model, state) else {
            let (Some(side), Some((program, state))) = (&bench.plant, sight.plant_mut()) else {
                return Vec::new();
            };
            return side.bindings.iter().map(|b| show(program, state, b)).collect();
        };
        let Some(side) = model.side() else { return Vec::new() };
        let program = &side.compiled.program;
        let inputs = program.tables().inputs.start;
        for (from, to) in &side.coupling.to_plant {
            state.set_word(program, Addr(inputs.saturating_add(*to)), output(bench, sight, *from));
        }
        for (input, addr) in &model.measured {
            state.set_word(program, *addr, sight.input(*input));
        }
        side.bindings.iter().map(|b| show(program, state, b)).collect()
    }
}

/// The word of an output that the machine gets, counted from the first.
fn output(bench: &Bench, sight: &Sight, number: u32) -> u64 {
    let tables = bench.compiled.program.tables();
    let addr = Addr(tables.outputs.start.saturating_add(number));
    if !sight.drives() {
        return tables.safe.get(number as usize).copied().unwrap_or(0);
    }
    let forced = sight.forces().find(|force| force.what == Force::Output(addr));
    forced.map_or_else(|| sight.state().word(addr), |force| force.word)
}

fn plants(document: &Document) -> impl Iterator<Item = &Plant> {
    document.items.iter().filter_map(|item| match item {
        g7_model::Item::Plant(plant) => Some(plant),
        _ => None,
    })
}

fn bindings(plant: &Plant) -> impl Iterator<Item = &Expr> {
    let views = plant.items.iter().filter_map(|item| match item {
        PlantItem::View(view) => Some(view),
        _ => None,
    });
    views.flat_map(|view| view.bindings.iter().map(|b| &b.value))
}

/// The names of what a plant remembers.
fn states(plant: &Plant) -> Vec<&str> {
    let mut names = Vec::new();
    for item in &plant.items {
        match item {
            PlantItem::State(state) => names.extend(state.names.iter().map(|name| &*name.text)),
            PlantItem::Parts(parts) => names.push(&*parts.name.text),
            PlantItem::Arrivals(arrivals) => names.push(&*arrivals.name.text),
            _ => {}
        }
    }
    names
}

/// The states that an input of the charts reads as they are, and where both are.
fn measured<'p>(plant: &'p Plant, bench: &Bench, made: &Bench) -> (Vec<&'p str>, Vec<(u32, Addr)>) {
    let (mut names, mut words) = (Vec::new(), Vec::new());
    for item in &plant.items {
        let PlantItem::Drive(drive) = item else { continue };
        let ExprKind::Path(path) = &drive.value.kind else { continue };
        let [state] = path.names.as_slice() else { continue };
        let input = drive.input.kind.variable().and_then(|name| bench.item(&name));
        let (Some(input), Some(known)) = (input, made.item(&state.text)) else {
            continue;
        };
        if let (Role::Input(index), Role::Plant, true) = (input.role, known.role, input.ty == known.ty) {
            names.push(&*state.text);
            words.push((index, Addr(known.addr)));
        }
    }
    (names, words)
}

/// The names in an expression.
struct Free<'d> {
    names: Vec<&'d str>,
    direct: bool,
}

impl<'d> Visitor<'d> for Free<'d> {
    fn path(&mut self, names: &'d [Name]) {
        self.names.extend(names.first().map(|name| &*name.text));
    }

    fn direct(&mut self, _: &'d str, _: Span) {
        self.direct = true;
    }

    fn order(&mut self, _: &'d Order) {}
}
