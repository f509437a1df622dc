//! The state of a run as the page knows it from the frames that were sent.
//!
//! A run keeps it, and `frame` compares it with the present state, so that a frame holds changes only.

use std::collections::{BTreeMap, BTreeSet};

use g7_host::Value;
use serde::Serialize;

/// A value of the plant's picture.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(untagged)]
pub enum Show {
    /// A BOOL.
    Flag(bool),
    /// A number; a TIME in seconds.
    Number(f64),
    /// A STRING.
    Text(String),
}

/// The values that the page already knows.
#[derive(Debug, Default)]
pub(super) struct Sent {
    pub(super) active: BTreeSet<u32>,
    pub(super) enabled: BTreeMap<u32, u8>,
    pub(super) values: Vec<Value>,
    pub(super) forced: Vec<bool>,
    pub(super) view: Vec<Show>,
}
