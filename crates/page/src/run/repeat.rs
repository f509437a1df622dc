//! A run that a proof found, repeated on the bench: its inputs come as if a user had set them, so that
//! the page can go back in it.

use g7_host::Value;
use g7_rig::Role;

use super::past::Event;
use super::running::Run;
use super::scans::Scan;

impl Run {
    /// Makes these scans from the start, until a fault stops the run.
    pub(super) fn repeat(&mut self, scans: &[Scan]) {
        let inputs = &self.runner.program().tables().inputs;
        let words = (inputs.end - inputs.start) as usize;
        for m in Scan::moves(scans, words) {
            self.give(&m.inputs);
            self.cleared.clear();
            if !self.scan() {
                break;
            }
        }
    }

    /// Sets the inputs that are not as they are to be. A text is as it was: no proof moves texts.
    fn give(&mut self, inputs: &[u64]) {
        let changed = |role: &Role| match role {
            Role::Input(number) => {
                let word = inputs.get(*number as usize).copied();
                word.filter(|word| *word != self.runner.input(*number))
            }
            Role::Output | Role::Variable | Role::Plant => None,
        };
        let items = self.bench.items.iter().enumerate().filter(|(_, item)| item.words == 1);
        let events: Vec<(usize, u64)> =
            items.filter_map(|(signal, item)| Some((signal, changed(&item.role)?))).collect();
        for (signal, word) in events {
            self.come(Event::Set(signal, Value::Word(word)));
        }
    }
}
