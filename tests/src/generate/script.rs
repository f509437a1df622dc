//! The script of a random chart: inputs that change now and then, time that advances by the
//! durations that the charts use, and a few restarts.

use std::collections::BTreeMap;

use g7_model::{Document, Item, Type, VarKind};

use super::rng::Rng;
use crate::naive::Value;

/// An event of the script.
#[derive(Clone, Debug)]
pub enum Event {
    /// A scan: its instant, and the inputs that change.
    Scan {
        /// The instant, in nanoseconds.
        now: i64,
        /// The new values.
        inputs: BTreeMap<String, Value>,
    },
    /// A restart.
    Restart {
        /// True if retained variables are reset too.
        cold: bool,
    },
}

/// The events in their order.
pub type Script = Vec<Event>;

const MS: i64 = 1_000_000;

pub(super) fn script(rng: &mut Rng, doc: &Document, scans: usize) -> Script {
    let mut inputs = Vec::new();
    for item in &doc.items {
        if let Item::Var(v) = item
            && v.kind == VarKind::Input
        {
            inputs.extend(v.names.iter().map(|n| (n.text.to_string(), v.ty)));
        }
    }
    let mut bits: BTreeMap<String, bool> = BTreeMap::new();
    let mut now = 0;
    let mut script = Vec::new();
    let restart = rng.percent(12).then(|| rng.below(scans));
    for i in 0..scans {
        let mut changes = BTreeMap::new();
        for (name, ty) in &inputs {
            if !rng.percent(if i == 0 { 60 } else { 30 }) {
                continue;
            }
            let value = match ty {
                Type::Bool => {
                    let bit = bits.entry(name.clone()).or_insert(false);
                    *bit = !*bit;
                    Value::Bool(*bit)
                }
                Type::Real => Value::Real(rng.below(40) as f32 * 0.25 - 3.0),
                _ if rng.percent(3) => Value::Int(32_700),
                _ => Value::Int(rng.below(10) as i128 - 1),
            };
            changes.insert(name.clone(), value);
        }
        if restart == Some(i) {
            script.push(Event::Restart { cold: rng.percent(50) });
        }
        script.push(Event::Scan { now, inputs: changes });
        now += rng.one([MS, 5 * MS, 5 * MS, 10 * MS, 10 * MS, 10 * MS, 20 * MS, 37 * MS, 1]);
    }
    script
}
