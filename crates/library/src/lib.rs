//! The library that comes with G7. Its parts are .g7 files; a chart takes one in with `use debounce`.
//!
//! The files are in the folder `library/` of the repository, with their tests in `library/tests/` and a page of the book
//! for each. This crate only holds their texts; `rig` reads them.
#![no_std]
#![forbid(unsafe_code)]

/// A part of the library.
#[derive(Clone, Copy, Debug)]
pub struct Part {
    /// Its name behind `use`.
    pub name: &'static str,
    /// A .g7 file.
    pub text: &'static str,
}

impl Part {
    /// The first line of its text: what it is, in a few words.
    pub fn title(&self) -> &'static str {
        self.text.lines().next().unwrap_or_default().trim_start_matches('/').trim()
    }
}

macro_rules! parts {
    ($($name:literal)*) => {
        /// All parts, in the order of the alphabet.
        pub static PARTS: &[Part] = &[
            $(Part { name: $name, text: include_str!(concat!("../../../library/", $name, ".g7")) }),*
        ];
    };
}

parts! {
    "alarm"
    "blink"
    "debounce"
    "drive"
    "filter"
    "gemma"
    "hysteresis"
    "pid"
    "ramp"
    "scale"
    "stopwatch"
    "totaliser"
    "two_hand"
    "valve"
}

/// The part of this name.
pub fn part(name: &str) -> Option<&'static Part> {
    PARTS.iter().find(|p| p.name == name)
}
