//! An FMU as the plant of a run: found, wired by names, and stepped before each scan of the charts.

use std::path::Path;

use g7_fmi::archive;
use g7_fmi::description::{Causality, Description, Type, Variable, Version};
use g7_fmi::library::{Instance, Value as Foreign};
use g7_host::{Kind, Runner, Value};
use g7_model::{Nanos, Said, say};
use g7_rig::{Bench, Item, Role};

use crate::failure::{Failure, raw};
use crate::files;
use crate::message::note;
use crate::scratch::Scratch;

/// The plant: an instance and what is connected.
pub(super) struct Outside {
    name: String,
    instance: Instance,
    /// Outputs of the charts to inputs of the FMU, and the other way: by their place in the bench.
    to_plant: Vec<(usize, Variable)>,
    to_charts: Vec<(Variable, usize)>,
    /// The time up to which it has gone; `None` before the first scan.
    reached: Option<Nanos>,
    /// Deleted behind the instance.
    _folder: Scratch,
}

/// True if the plant that was asked for is a file of this kind.
pub(crate) fn is_fmu(plant: Option<&str>) -> bool {
    plant.is_some_and(|p| p.to_ascii_lowercase().ends_with(".fmu"))
}

impl Outside {
    /// Unpacks and loads an FMU and connects it: `wires` first, then what has the same name on both sides.
    pub(super) fn open(path: &Path, bench: &Bench, wires: &[(String, String)]) -> Result<Outside, Failure> {
        let bad = |what: Said| Failure::Usage(say!("{}: {what}", raw(path.display())));
        // The reader of FMUs has its sentences in English.
        let its = |what: String| bad(raw(what));
        let all = archive::unpack(&files::read(path)?).map_err(its)?;
        let text = all.iter().find(|(name, _)| name == "modelDescription.xml");
        let text = text.ok_or_else(|| bad(say!("it has no modelDescription.xml")))?;
        let text = std::str::from_utf8(&text.1).map_err(|_| bad(say!("its description is not UTF-8")))?;
        let what = Description::read(text).map_err(its)?;
        fits(&what, bench.period).map_err(bad)?;
        let (to_plant, to_charts) = wired(&what, bench, wires).map_err(bad)?;
        let library = library(&what, &all).map_err(bad)?;
        let folder = unpacked(&all)?;
        let instance = Instance::new(&folder.path().join(library), &folder.path().join("resources"), &what)
            .map_err(its)?;
        let free = what.variables.iter().filter(|v| v.causality == Causality::Input);
        let free: Vec<&str> = free
            .filter(|v| !to_plant.iter().any(|(_, t)| t.name == v.name))
            .map(|v| v.name.as_str())
            .collect();
        if !free.is_empty() {
            note(say!("not wired, and with their first value: {}", raw(free.join(", "))));
        }
        let name = path.display().to_string();
        Ok(Outside { name, instance, to_plant, to_charts, reached: None, _folder: folder })
    }

    /// True if the FMU drives an input.
    pub(super) fn drives(&self, bench: &Bench, item: &Item) -> bool {
        self.to_charts.iter().any(|(_, at)| bench.items.get(*at).is_some_and(|i| i.name == item.name))
    }

    /// Goes on to the instant of the next scan, and brings its outputs to the charts.
    pub(super) fn step(&mut self, bench: &Bench, runner: &mut Runner) -> Result<(), Failure> {
        let now = runner.due();
        let name = raw(&self.name);
        let at = |what: Said| Failure::Usage(say!("{} at {}: {what}", name, raw(now.plain())));
        let its = |what: String| at(raw(what));
        if self.reached.is_none() {
            self.instance.begin().map_err(its)?;
        }
        for (from, to) in &self.to_plant {
            if let Some(item) = bench.items.get(*from) {
                self.instance.set(to, &out(bench, runner, item, to.ty)).map_err(its)?;
            }
        }
        let ends = match self.reached {
            None => self.instance.ready().map(|()| false),
            Some(from) => self.instance.step(from.as_seconds(), (now - from).as_seconds()),
        };
        if ends.map_err(its)? {
            return Err(at(say!("the FMU ends the simulation")));
        }
        for (from, to) in &self.to_charts {
            if let Some(item) = bench.items.get(*to) {
                let value = self.instance.get(from).map_err(its)?;
                let value = taken(item, &value)
                    .ok_or_else(|| at(say!("`{}` cannot hold `{value:?}` of `{}`", item.name, from.name)))?;
                bench.set(runner, item, &value);
            }
        }
        self.reached = Some(now);
        Ok(())
    }
}

/// Refuses a period that the FMU cannot make steps of.
fn fits(what: &Description, period: Nanos) -> Result<(), Said> {
    let Some(step) = what.fixed_step.filter(|s| *s > 0.0) else { return Ok(()) };
    let times = period.as_seconds() / step;
    if times.round() >= 1.0 && (times - times.round()).abs() < 1e-6 {
        return Ok(());
    }
    Err(say!(
        "its steps are multiples of {step} s, and the scans are {} apart; --scan sets another time",
        raw(period.plain())
    ))
}

type Wires = (Vec<(usize, Variable)>, Vec<(Variable, usize)>);

/// The connections, checked for their types.
fn wired(what: &Description, bench: &Bench, wires: &[(String, String)]) -> Result<Wires, Said> {
    let (mut to_plant, mut to_charts): Wires = (Vec::new(), Vec::new());
    let place = |name: &str, role: fn(&Role) -> bool| {
        bench.items.iter().position(|i| i.name == *name && role(&i.role))
    };
    let (is_output, is_input) =
        (|r: &Role| matches!(r, Role::Output), |r: &Role| matches!(r, Role::Input(_)));
    let input = |name: &str| what.variable(name).filter(|v| v.causality == Causality::Input);
    for (from, to) in wires {
        let out = place(from, is_output).zip(input(to));
        let back = what.variable(from).filter(|v| v.causality != Causality::Input).zip(place(to, is_input));
        match (out, back) {
            (Some(_), Some(_)) => return Err(say!("`--wire {from}={to}`: both directions are possible")),
            (Some((at, v)), None) => to_plant.push((at, v.clone())),
            (None, Some((v, at))) => to_charts.push((v.clone(), at)),
            (None, None) => {
                return Err(say!(
                    "`--wire {from}={to}`: neither an output of the charts and an input of the FMU, nor the other way"
                ));
            }
        }
    }
    for (at, item) in bench.items.iter().enumerate() {
        if is_output(&item.role)
            && let Some(v) = input(&item.name)
            && !to_plant.iter().any(|(_, t)| t.name == v.name)
        {
            to_plant.push((at, v.clone()));
        }
        let output = what.variable(&item.name).filter(|v| v.causality == Causality::Output);
        if is_input(&item.role)
            && let Some(v) = output
            && !to_charts.iter().any(|(_, t)| *t == at)
        {
            to_charts.push((v.clone(), at));
        }
    }
    if to_plant.is_empty() && to_charts.is_empty() {
        return Err(say!("nothing has the same name here and there; --wire OUTPUT=INPUT connects"));
    }
    let pairs = to_plant.iter().map(|(at, v)| (*at, v)).chain(to_charts.iter().map(|(v, at)| (*at, v)));
    for (item, v) in pairs.filter_map(|(at, v)| Some((bench.items.get(at)?, v))) {
        if !go_together(item.kind, v.ty) {
            return Err(say!(
                "`{}` is {} here, and `{}` is {} there",
                item.name,
                item.ty,
                v.name,
                raw(format!("{:?}", v.ty))
            ));
        }
    }
    let mut twice: Vec<&str> = to_plant.iter().map(|(_, v)| v.name.as_str()).collect();
    twice.extend(to_charts.iter().filter_map(|(_, at)| Some(bench.items.get(*at)?.name.as_str())));
    let many = twice.len();
    twice.sort_unstable();
    twice.dedup();
    if twice.len() < many { Err(say!("an input is wired twice")) } else { Ok((to_plant, to_charts)) }
}

/// True if values of these types can be handed over. Whole numbers may be reals there, which FMI 2.0 needs
/// for those of 64 bits.
fn go_together(kind: Kind, ty: Type) -> bool {
    let real = matches!(ty, Type::Double | Type::Single);
    match kind {
        Kind::Bool => ty == Type::Boolean,
        Kind::Int { .. } => real || matches!(ty, Type::Int { .. }),
        Kind::Real | Kind::Lreal | Kind::Time | Kind::Moment(_) => real,
        Kind::Text => ty == Type::String,
    }
}

/// A value of the charts for the FMU.
fn out(bench: &Bench, runner: &Runner, item: &Item, ty: Type) -> Foreign {
    let value = bench.value(runner, item);
    let word = value.word();
    match (&value, item.kind) {
        (Value::Text(text), _) => Foreign::Text(text.to_string()),
        (_, Kind::Bool) => Foreign::Bool(word != 0),
        (_, Kind::Int { signed, .. }) if matches!(ty, Type::Int { .. }) => {
            Foreign::Int(if signed { (word as i64).into() } else { word.into() })
        }
        (_, kind) => Foreign::Real(value.number(kind)),
    }
}

/// A value of the FMU for the charts, if the input can hold it.
fn taken(item: &Item, value: &Foreign) -> Option<Value> {
    let int = |n: i128| {
        let Kind::Int { bits, signed } = item.kind else { return None };
        let (low, high) = match signed {
            true => (-(1i128 << (bits - 1)), (1i128 << (bits - 1)) - 1),
            false => (0, (1i128 << bits) - 1),
        };
        (low..=high).contains(&n).then_some(Value::Word(n as u64))
    };
    match (item.kind, value) {
        (Kind::Bool, Foreign::Bool(b)) => Some(Value::Word(u64::from(*b))),
        (Kind::Int { .. }, Foreign::Int(n)) => int(*n),
        (Kind::Int { .. }, Foreign::Real(r)) if r.fract() == 0.0 && r.abs() < 1e19 => int(*r as i128),
        (Kind::Real, Foreign::Real(r)) => Some(Value::Word(u64::from((*r as f32).to_bits()))),
        (Kind::Lreal, Foreign::Real(r)) => Some(Value::Word(r.to_bits())),
        (Kind::Time | Kind::Moment(_), Foreign::Real(r)) if r.abs() < 9.2e9 => {
            let word = (r * 1e9).round() as i64 as u64;
            item.kind.admits(word).then_some(Value::Word(word))
        }
        (Kind::Text, Foreign::Text(t)) => Some(Value::Text(t.as_str().into())),
        _ => None,
    }
}

/// The path of the library for this machine in the archive.
fn library(what: &Description, all: &[archive::File]) -> Result<String, Said> {
    let version = match what.version {
        Version::V2 => g7_codegen::fmu::Version::V2,
        Version::V3 => g7_codegen::fmu::Version::V3,
    };
    let folder = version.folder(std::env::consts::OS, std::env::consts::ARCH);
    let folder = folder.ok_or_else(|| say!("FMI has no name for this machine"))?;
    let path = format!("binaries/{folder}/{}{}", what.identifier, std::env::consts::DLL_SUFFIX);
    match all.iter().any(|(name, _)| *name == path) {
        true => Ok(path),
        false => Err(say!("it has no library for this machine (`{path}`)")),
    }
}

/// The files on disk.
fn unpacked(all: &[archive::File]) -> Result<Scratch, Failure> {
    let made = |path: &Path| std::fs::create_dir_all(path).map_err(|e| Failure::Write(path.to_path_buf(), e));
    let folder = Scratch::new()?;
    made(&folder.path().join("resources"))?;
    for (name, bytes) in all {
        let file = folder.path().join(name);
        made(file.parent().unwrap_or(folder.path()))?;
        files::write(&file, bytes)?;
    }
    Ok(folder)
}
