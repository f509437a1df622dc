//! The names of what a controller tells by numbers.

use std::ops::Deref;
use std::sync::Arc;

use g7_host::{Force, Halt};
use g7_model::Nanos;
use g7_online::{Chart, Command, Forced, Part, Reason, Target, Wire, Wired, Wiring};
use g7_rig::{Bench, Item, Role, Source};

use super::order::Wish;
use super::picture::View;

/// A chart and its wiring.
pub(crate) struct Known {
    pub(crate) source: Source,
    pub(crate) bench: Bench,
    pub(crate) wiring: Wiring,
    /// The picture of the plant.
    pub(super) view: Option<View>,
}

/// A chart and its wiring, for names; clones are the same.
#[derive(Clone)]
pub(crate) struct Names(Arc<Known>);

impl Deref for Names {
    type Target = Known;

    fn deref(&self) -> &Known {
        &self.0
    }
}

impl Known {
    /// The chart, for an on-line change.
    pub(crate) fn chart(&self) -> Chart<'_> {
        Chart { bench: &self.bench, document: self.source.whole(), wiring: &self.wiring }
    }
}

impl Names {
    pub(crate) fn new(source: Source, bench: Bench, wiring: Wiring) -> Names {
        let view = View::new(&source, &bench);
        Names(Arc::new(Known { source, bench, wiring, view }))
    }

    /// The name of a device.
    pub(crate) fn device(&self, device: usize) -> &str {
        self.wiring.devices.get(device).map_or("", |wired| &wired.device.name.value)
    }

    pub(crate) fn wired(&self, device: usize) -> Option<&Wired> {
        self.wiring.devices.get(device)
    }

    /// The name of what a device gives.
    pub(crate) fn input(&self, target: Target) -> &str {
        let is = |item: &&Item| match target {
            Target::Input(index) => item.role == Role::Input(index),
            Target::Word(addr) => item.role != Role::Plant && item.addr == addr.0,
        };
        self.bench.items.iter().find(is).map_or("", |item| &item.name)
    }

    /// The value of an input of a device as text.
    pub(crate) fn given(&self, device: usize, input: usize, word: u64) -> String {
        let input = self.wired(device).and_then(|wired| wired.inputs.get(input));
        let kind = input.map_or(g7_host::Kind::Bool, |input| input.scaling.kind);
        g7_rig::values::shown(&g7_host::Value::Word(word), kind)
    }

    /// The forced variable.
    pub(crate) fn forced(&self, what: Force) -> Option<&Item> {
        self.bench.items.iter().find(|item| self.bench.force_of(item) == Some(what))
    }

    /// The name of a forced variable, and its value as text.
    pub(crate) fn value_of(&self, force: Forced) -> (&str, String) {
        let Some(item) = self.forced(force.what) else { return ("", String::new()) };
        (&item.name, item.show(&g7_host::Value::Word(force.word)))
    }

    /// Why the charts or the plant ended, with the place in the text.
    pub(crate) fn halt(&self, halt: Halt) -> String {
        let place = self.bench.halt_place(halt).map(|at| format!("{}: ", self.source.place(at)));
        let kind = match halt {
            Halt::Charts(fault) => fault.kind.to_string(),
            Halt::Plant(fault) => format!("the plant: {}", fault.kind),
        };
        format!("{}{kind}", place.unwrap_or_default())
    }

    /// The reason of a fault in a sentence.
    pub(crate) fn reason(&self, reason: Reason) -> String {
        match reason {
            Reason::Watchdog => "a scan took longer than the watchdog allows".to_owned(),
            Reason::Input(target) => format!("the input `{}` is bad", self.input(target)),
            Reason::Halt(halt) => self.halt(halt),
        }
    }

    /// The command for a wish; `None` for a wish that the controller does not hear of.
    pub(crate) fn command(&self, wish: &Wish) -> Result<Option<Command>, String> {
        Ok(Some(match wish {
            Wish::Run => Command::Run,
            Wish::Stop => Command::Stop,
            Wish::Acknowledge => Command::Acknowledge,
            Wish::Cold => Command::Restart(g7_host::Start::Cold),
            Wish::Force { name, value, seconds } => {
                let (item, what) = self.forcible(name)?;
                let word = item.read(value).map_err(|e| e.to_string())?.word();
                Command::Force(what, word, Nanos::SECOND * i64::from(*seconds))
            }
            Wish::Release { name } => Command::Release(self.forcible(name)?.1),
            Wish::ReleaseAll => Command::ReleaseAll,
            Wish::Watch
            | Wish::Seen { .. }
            | Wish::Press { .. }
            | Wish::Set { .. }
            | Wish::Change { .. }
            | Wish::Back { .. } => return Ok(None),
        }))
    }

    /// The part of a panel that a variable is wired to, and the name of the variable.
    pub(crate) fn part(&self, name: &str) -> Result<(&str, &Part), String> {
        let item = self.bench.item(name).ok_or_else(|| self.bench.unknown(name).to_string())?;
        let mut inputs = self.wiring.devices.iter().flat_map(|device| &device.inputs);
        match inputs.find(|input| input.name == item.name).map(|input| &input.wire) {
            Some(Wire::Panel(part)) => Ok((&item.name, part)),
            Some(_) | None => Err(format!("`{name}` is no input on a panel")),
        }
    }

    /// A variable that can be forced.
    fn forcible(&self, name: &str) -> Result<(&Item, Force), String> {
        let item = self.bench.item(name).ok_or_else(|| self.bench.unknown(name).to_string())?;
        match self.bench.force_of(item) {
            Some(what) => Ok((item, what)),
            None if item.role == Role::Plant => {
                Err(format!("`{name}` is a state of the plant: it cannot be forced"))
            }
            None => Err(format!("`{name}` is a text: it cannot be forced while a machine runs")),
        }
    }
}
