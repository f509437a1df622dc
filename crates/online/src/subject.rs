//! The subject of a channel of the io file: a variable of the chart, or a step.
//!
//! `wiring` finds it here by its name, and holds it against the point.

use g7_host::Kind;

use crate::messages::Carried;
use crate::wire::Folder;
use crate::word::Source;

/// The three ways in which a channel is used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Class {
    Input,
    Output,
    /// Masters of a server read it.
    Shown,
}

/// The variable or step of a channel.
pub(crate) struct Subject {
    pub(crate) name: String,
    pub(crate) kind: Kind,
    /// Its type, for messages.
    pub(crate) ty: String,
    pub(crate) inverted: bool,
    /// The number of an input word.
    pub(crate) input: Option<u32>,
    pub(crate) source: Source,
    pub(crate) safe: Option<u64>,
    /// Where a server of OPC UA shows it.
    pub(crate) folder: Folder,
    pub(crate) comment: Option<String>,
}

impl Subject {
    /// As far as messages and nodes must know it.
    pub(crate) fn carried(&self, class: Class) -> Carried<'_> {
        Carried {
            name: &self.name,
            kind: self.kind,
            inverted: self.inverted,
            input: class == Class::Input,
            safe: class == Class::Output,
        }
    }
}
