//! The faults that stop a scan. The numbers stand in the printed code, each with its note.

/// no fault
pub const FAULT_NONE: u8 = 0;
/// the chart comes back to the same state within a scan
pub const FAULT_UNSTABLE: u8 = 1;
/// no stable situation within the bound, or a loop without end
pub const FAULT_BOUND: u8 = 2;
/// a result that its type cannot hold
pub const FAULT_OVERFLOW: u8 = 3;
/// division by zero
pub const FAULT_DIVISION: u8 = 4;
/// an index or a text out of range
pub const FAULT_RANGE: u8 = 5;
/// two forcing orders disagree
pub const FAULT_FORCING: u8 = 6;
/// more than the tables of the target hold
pub const FAULT_TABLE: u8 = 7;
/// time went back
pub const FAULT_INPUTS: u8 = 8;
/// stopped by an earlier fault
pub const FAULT_STOPPED: u8 = 9;
