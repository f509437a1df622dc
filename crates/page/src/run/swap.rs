//! An on-line change: the run continues with a changed chart.

use std::sync::Arc;

use g7_ide::Positions;
use g7_model::Said;
use g7_rig::Source;
use serde::Serialize;

use super::past::Past;
use super::places::Places;
use super::running::{Breaks, Run, recording};
use super::start::Started;
use super::wish::bench;

/// The answer to an on-line change.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(untagged)]
pub(crate) enum Swapped {
    /// The description of the new run.
    Started(Box<Started>),
    /// Nothing was changed, because this would be lost.
    Lost { lost: Vec<String> },
}

impl Run {
    /// Continues the run with a changed text after the present scan. Returns what would be lost; if
    /// anything would be, the change is made only if it is `forced`.
    pub(crate) fn swap(&mut self, source: &Source, forced: bool) -> Result<Vec<Said>, Said> {
        self.only_now()?;
        let new = bench(source, &self.wish)?;
        let document = Arc::new(source.whole().clone());
        // A scan that is executed pass by pass is completed first.
        if self.runner.is_within_scan() {
            self.scan();
        }
        let old = (&self.bench, &*self.document);
        let carried = g7_rig::carry((&new, &document), old, &self.runner)?;
        if !carried.lost.is_empty() && !forced {
            return Ok(carried.lost);
        }
        let mut recording = recording(&new);
        for (i, signal) in new.signals().iter().enumerate() {
            let same = |s: &g7_host::Signal| {
                s.name == signal.name && s.group == signal.group && s.kind == signal.kind
            };
            if let Some(other) = self.recording.signals().iter().position(same) {
                recording.adopt(i, &self.recording, other);
            }
        }
        let places = Places::new(source, &new);
        let ids = self.break_ids();
        (self.bench, self.document, self.runner, self.recording) = (new, document, carried.runner, recording);
        self.places = places;
        self.text = source.text.as_str().into();
        self.hash = crate::overview::hash(source);
        self.positions = Arc::new(Positions::new(&source.text));
        self.breaks = Breaks::default();
        self.set_breaks(&ids);
        self.past = Past::new(&self.runner);
        self.cleared.clear();
        self.stopped = None;
        self.recording.sample(self.now, self.bench.sample(&self.runner));
        Ok(Vec::new())
    }
}
