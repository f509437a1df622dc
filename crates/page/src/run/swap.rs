//! An on-line change: the run goes on in a changed chart.

use std::sync::Arc;

use g7_rig::Source;

use super::past::Past;
use super::start::{Places, bench};
use super::{Breaks, Run};
use crate::positions::Positions;

impl Run {
    /// Takes over a changed text behind the scan in hand. Unless it is `forced`,
    /// nothing is done where something would be lost: that is said instead.
    pub(crate) fn swap(&mut self, source: &Source, forced: bool) -> Result<Vec<String>, String> {
        self.only_now()?;
        let new = bench(source, &self.wish)?;
        let document = Arc::new(source.document.clone());
        // A scan that is looked at pass by pass comes to its end first.
        if self.runner.is_within_scan() {
            self.scan();
        }
        let old = (&self.bench, &*self.document);
        let carried = g7_rig::carry((&new, &document), old, &self.runner)?;
        if !carried.lost.is_empty() && !forced {
            return Ok(carried.lost);
        }
        let mut recording = super::recording(&new);
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
