//! The words of a control block in the image of a state.
//!
//! A plain block has one word: the number of its true N inputs, with [`WRITTEN`].
//! Any other block has [`BLOCK`] words: for each input the number of true
//! contributions, the memory word, and for each timed input a start and a time.

/// Words of a block that is not plain.
pub(crate) const BLOCK: u32 = 22;
/// Place of the memory word.
pub(crate) const MEMORY: u32 = 11;
/// Place of the starts of the timers (ns), in the order of [`TIMED`].
pub(crate) const STARTS: u32 = 12;
/// Place of the times of the timers (ns), in the order of [`TIMED`].
pub(crate) const TIMES: u32 = 17;

// The inputs, in the order of `INPUTS`.
pub(crate) const N: u32 = 0;
pub(crate) const S: u32 = 1;
pub(crate) const R: u32 = 2;
pub(crate) const L: u32 = 3;
pub(crate) const D: u32 = 4;
pub(crate) const P: u32 = 5;
pub(crate) const P1: u32 = 6;
pub(crate) const P0: u32 = 7;
pub(crate) const SD: u32 = 8;
pub(crate) const DS: u32 = 9;
pub(crate) const SL: u32 = 10;

/// The timed inputs.
pub(crate) const TIMED: [u32; 5] = [L, D, SD, DS, SL];

// Bits of the memory word. The low 11 are the inputs at the latest evaluation; the
// next ones are the flip-flops of the standard's block.
pub(crate) const S_FF: u64 = 1 << 16;
pub(crate) const SD_FF: u64 = 1 << 17;
pub(crate) const DS_FF: u64 = 1 << 18;
pub(crate) const SL_FF: u64 = 1 << 19;
/// Q at the latest evaluation, without the pulses P1 and P0.
pub(crate) const Q_BEFORE: u64 = 1 << 20;
/// A pulse that was seen before the evolution.
pub(crate) const EARLY_P1: u64 = 1 << 21;
pub(crate) const EARLY_P0: u64 = 1 << 22;
/// Q as it was written last. In a plain block it stands in the word of the count.
pub(crate) const WRITTEN: u64 = 1 << 63;

/// True if the timer at this place of [`TIMED`] had a true input at the latest
/// evaluation, so that its start will be read again.
pub(crate) fn timer_latched(memory: u64, place: u32) -> bool {
    let latch = match TIMED.get(place as usize) {
        Some(&SD) => SD_FF,
        Some(&SL) => SL_FF,
        Some(input) => 1 << input,
        None => 0,
    };
    memory & latch != 0
}
