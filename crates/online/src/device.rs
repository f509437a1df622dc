//! A device as the controller sees it.

use std::fmt;

use crate::value::Raw;

/// Why a device could not be reached or did not answer, in a few words for the engineer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failed(pub String);

impl fmt::Display for Failed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Failed {}

/// A value that a device did not give, though it answers: with the reason, where it has one.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Absent {
    /// It was not asked yet.
    #[default]
    Unread,
    /// It refused to give the value.
    Refused(String),
}

/// Something that a device tells beside its values.
#[derive(Clone, Debug, PartialEq)]
pub enum Remark {
    /// A sentence, such as one about somebody whom it did not let in.
    Note(String),
    /// Somebody has given an input another value.
    Written {
        /// The number of the input.
        input: usize,
        /// The value, as the device has it.
        value: Raw,
        /// The user, where there are users.
        who: Option<String>,
    },
}

/// A device: it has inputs and outputs of fixed number and order, those of its channels.
///
/// Each call returns within the time-out of the device, apart from scheduling.
pub trait Device: Send {
    /// Reaches the device.
    ///
    /// # Errors
    ///
    /// It cannot be reached.
    fn connect(&mut self) -> Result<(), Failed>;

    /// Writes those outputs whose `write` is true, then reads all inputs. An input or output that the
    /// device refuses is noted with it, at once or at a later exchange; the others are carried on with.
    ///
    /// # Errors
    ///
    /// The device does not answer; it is to be reached anew.
    fn exchange(
        &mut self,
        outputs: &[Raw],
        write: &[bool],
        inputs: &mut [Result<Raw, Absent>],
        refused: &mut [Option<String>],
    ) -> Result<(), Failed>;

    /// The things that have happened at the device since the last call, beside its values.
    fn remarks(&mut self) -> Vec<Remark> {
        Vec::new()
    }

    /// Ends the connection, if there is one.
    fn close(&mut self);
}
