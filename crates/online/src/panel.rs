//! Panels: buttons, switches and numbers that a person moves on the operator page.
//!
//! ```text
//! page -> attendant -> Panels -> Cells <- Panel, the device of a driver -> scan
//! ```
//!
//! # Invariants
//!
//! A button is TRUE only as long as a page says again and again that it is pressed: a page that dies
//! releases it (`release`). A press lasts at least `press`, so that no exchange misses it.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use g7_host::{Clock as _, WallClock};
use g7_model::Nanos;

use crate::device::{Absent, Device, Failed};
use crate::part::{Part, number};
use crate::setup::{self, Handle};
use crate::value::{Raw, Scaling};
use crate::wire::Wire;
use crate::wired::Wired;

/// Pages that press one button at the same time; more are refused.
const HANDS: usize = 16;
/// A page counts as open for so long after its last sign.
const OPEN: Nanos = Nanos::from_millis(2_000);

/// A movement of a person's hand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Moved {
    /// A button is pressed, or still pressed.
    Pressed,
    /// A button is released.
    Released,
    /// A switch, a number or a choice is set.
    Set(f64),
}

/// The movable parts of all panels, by the variable that is wired to them; clones are the same.
#[derive(Clone, Debug, Default)]
pub struct Panels(Arc<Mutex<Cells>>);

/// All parts, and the time of a page's last sign.
#[derive(Debug, Default)]
struct Cells {
    clock: WallClock,
    page: Option<Nanos>,
    parts: BTreeMap<String, Cell>,
}

/// A part that a person moves.
#[derive(Debug)]
struct Cell {
    part: Part,
    times: setup::Panel,
    /// The scaling decides which numbers the variable can hold.
    scaling: Scaling,
    /// The hands on a button, and until when each counts.
    hands: Vec<(u64, Nanos)>,
    /// The end of the shortest press.
    until: Nanos,
    /// The value of what stays as it is set.
    value: Option<Raw>,
}

impl Cell {
    fn new(part: &Part, times: &setup::Panel, scaling: Scaling) -> Cell {
        let value = match &part.handle {
            Handle::Switch => Some(Raw::Bit(false)),
            Handle::Choice(_) => Some(Raw::Whole(0)),
            Handle::Number => part.initial.map(number),
            Handle::Button | Handle::Page | Handle::Lamp(_) | Handle::Value => None,
        };
        let (part, times) = (part.clone(), times.clone());
        Cell { part, times, scaling, hands: Vec::new(), until: Nanos::ZERO, value }
    }

    /// Moves it at `now`; true if that is news.
    fn set(&mut self, now: Nanos, hand: u64, moved: Moved) -> Result<bool, String> {
        match (&self.part.handle, moved) {
            (Handle::Button, Moved::Pressed) => self.press(now, hand),
            (Handle::Button, Moved::Released) => {
                self.hands.retain(|(by, _)| *by != hand);
                Ok(false)
            }
            (Handle::Button, Moved::Set(_)) => Err("a button is pressed, not set".to_owned()),
            (Handle::Switch, Moved::Set(x)) if x == 0.0 || x == 1.0 => Ok(self.keep(Raw::Bit(x != 0.0))),
            (Handle::Choice(words), Moved::Set(x))
                if x.fract() == 0.0 && x >= 0.0 && x < words.len() as f64 =>
            {
                Ok(self.keep(number(x)))
            }
            (Handle::Number, Moved::Set(x)) => self.number(x),
            (handle, _) => Err(format!("`{handle}` cannot be moved so")),
        }
    }

    fn press(&mut self, now: Nanos, hand: u64) -> Result<bool, String> {
        let was = self.is_pressed(now);
        self.hands.retain(|(by, until)| *by != hand && *until > now);
        if self.hands.len() >= HANDS {
            return Err("too many pages press this button".to_owned());
        }
        self.hands.push((hand, now + self.times.release));
        if !was {
            self.until = now + self.times.press;
        }
        Ok(!was)
    }

    fn is_pressed(&self, now: Nanos) -> bool {
        now < self.until || self.hands.iter().any(|(_, until)| *until > now)
    }

    fn number(&mut self, x: f64) -> Result<bool, String> {
        let Part { min, max, .. } = self.part;
        if !x.is_finite() || min.is_some_and(|least| x < least) || max.is_some_and(|most| x > most) {
            let limits = match (min, max) {
                (Some(least), Some(most)) => format!("from {least} to {most}"),
                (Some(least), None) => format!("at least {least}"),
                (None, Some(most)) => format!("at most {most}"),
                (None, None) => "finite".to_owned(),
            };
            return Err(format!("the number must be {limits}"));
        }
        if self.scaling.word(number(x)).is_none() {
            return Err(format!("the variable cannot hold {x}"));
        }
        Ok(self.keep(number(x)))
    }

    fn keep(&mut self, value: Raw) -> bool {
        self.value.replace(value) != Some(value)
    }

    fn value(&self, now: Nanos, page: bool) -> Result<Raw, Absent> {
        match self.part.handle {
            Handle::Button => Ok(Raw::Bit(self.is_pressed(now))),
            Handle::Page => Ok(Raw::Bit(page)),
            Handle::Switch | Handle::Number | Handle::Choice(_) | Handle::Lamp(_) | Handle::Value => {
                self.value.ok_or_else(|| Absent::Refused("nobody has entered it yet".to_owned()))
            }
        }
    }
}

impl Cells {
    fn is_open(&self, now: Nanos) -> bool {
        self.page.is_some_and(|at| now - at <= OPEN)
    }

    fn set(&mut self, now: Nanos, name: &str, hand: u64, moved: Moved) -> Result<bool, String> {
        let cell = self.parts.get_mut(name).ok_or_else(|| format!("`{name}` is on no panel"))?;
        cell.set(now, hand, moved).map_err(|why| format!("`{name}`: {why}"))
    }
}

impl Panels {
    fn lock(&self) -> MutexGuard<'_, Cells> {
        // Each movement is whole, so the cells are whole after a panic too.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Notes that a page is open.
    pub fn watched(&self) {
        let mut cells = self.lock();
        cells.page = Some(cells.clock.now());
    }

    /// Moves the part of a variable by the hand of a page; true if that is news.
    ///
    /// # Errors
    ///
    /// A sentence that says why it cannot be moved so.
    pub fn set(&self, name: &str, hand: u64, moved: Moved) -> Result<bool, String> {
        let mut cells = self.lock();
        let now = cells.clock.now();
        cells.set(now, name, hand, moved)
    }

    /// The panel of a wiring as a device.
    pub(crate) fn device(&self, panel: &setup::Panel, wired: &Wired) -> Box<dyn Device> {
        let mut names = Vec::new();
        for input in &wired.inputs {
            if let Wire::Panel(part) = &input.wire {
                self.lock().parts.insert(input.name.clone(), Cell::new(part, panel, input.scaling));
            }
            names.push(input.name.clone());
        }
        Box::new(Panel { panels: self.clone(), names })
    }
}

/// The inputs of one panel.
struct Panel {
    panels: Panels,
    names: Vec<String>,
}

impl Device for Panel {
    fn connect(&mut self) -> Result<(), Failed> {
        Ok(())
    }

    /// Lamps need nothing here: the page sees the outputs themselves.
    fn exchange(
        &mut self,
        _: &[Raw],
        _: &[bool],
        inputs: &mut [Result<Raw, Absent>],
        _: &mut [Option<String>],
    ) -> Result<(), Failed> {
        let mut cells = self.panels.lock();
        let now = cells.clock.now();
        let open = cells.is_open(now);
        for (name, input) in self.names.iter().zip(inputs) {
            *input = cells.parts.get(name).map_or(Err(Absent::Unread), |cell| cell.value(now, open));
        }
        Ok(())
    }

    fn close(&mut self) {}
}

#[cfg(test)]
mod tests {
    use g7_host::Kind;

    use super::*;

    const MS: Nanos = Nanos::MILLISECOND;
    const INT: Kind = Kind::Int { bits: 16, signed: true };

    fn cells(handle: Handle, kind: Kind, (min, max): (Option<f64>, Option<f64>)) -> Cells {
        let part = Part { handle, min, max, initial: None };
        let times = setup::Panel { release: MS * 1_000, press: MS * 200 };
        let scaling = Scaling::plain(kind);
        let mut cells = Cells::default();
        cells.parts.insert("a".to_owned(), Cell::new(&part, &times, scaling));
        cells
    }

    fn at(cells: &Cells, ms: i64) -> Result<Raw, Absent> {
        cells.parts["a"].value(MS * ms, false)
    }

    #[test]
    fn a_button_is_released_when_its_page_falls_silent() {
        let mut cells = cells(Handle::Button, Kind::Bool, (None, None));
        assert_eq!(at(&cells, 0), Ok(Raw::Bit(false)));
        assert_eq!(cells.set(MS * 10, "a", 1, Moved::Pressed), Ok(true));
        // A page that says it again is no news, and holds it.
        assert_eq!(cells.set(MS * 800, "a", 1, Moved::Pressed), Ok(false));
        assert_eq!(at(&cells, 1_700), Ok(Raw::Bit(true)));
        assert_eq!(at(&cells, 1_800), Ok(Raw::Bit(false)), "1 s after its last word");
    }

    #[test]
    fn a_short_press_lasts_as_long_as_the_file_says() {
        let mut cells = cells(Handle::Button, Kind::Bool, (None, None));
        cells.set(MS * 10, "a", 1, Moved::Pressed).expect("a button");
        cells.set(MS * 20, "a", 1, Moved::Released).expect("a button");
        assert_eq!(at(&cells, 209), Ok(Raw::Bit(true)));
        assert_eq!(at(&cells, 210), Ok(Raw::Bit(false)));
    }

    #[test]
    fn of_two_hands_on_a_button_each_lets_go_for_itself() {
        let mut cells = cells(Handle::Button, Kind::Bool, (None, None));
        assert_eq!(cells.set(MS * 10, "a", 1, Moved::Pressed), Ok(true));
        assert_eq!(cells.set(MS * 300, "a", 2, Moved::Pressed), Ok(false));
        cells.set(MS * 400, "a", 1, Moved::Released).expect("a button");
        assert_eq!(at(&cells, 500), Ok(Raw::Bit(true)));
        cells.set(MS * 600, "a", 2, Moved::Released).expect("a button");
        assert_eq!(at(&cells, 601), Ok(Raw::Bit(false)));
        for hand in 0..HANDS as u64 {
            cells.set(MS * 700, "a", hand, Moved::Pressed).expect("there is room");
        }
        assert!(cells.set(MS * 700, "a", 99, Moved::Pressed).is_err());
    }

    #[test]
    fn a_number_stays_within_its_limits_and_its_variable() {
        let mut cells = cells(Handle::Number, INT, (Some(-5.0), Some(40_000.0)));
        assert!(matches!(at(&cells, 0), Err(Absent::Refused(_))), "nobody has entered it");
        assert_eq!(cells.set(Nanos::ZERO, "a", 1, Moved::Set(7.0)), Ok(true));
        assert_eq!(cells.set(Nanos::ZERO, "a", 1, Moved::Set(7.0)), Ok(false));
        for wrong in [-6.0, 40_001.0, 39_000.0, f64::NAN, f64::INFINITY] {
            assert!(cells.set(Nanos::ZERO, "a", 1, Moved::Set(wrong)).is_err(), "{wrong}");
        }
        assert_eq!(at(&cells, 0), Ok(Raw::Whole(7)));
    }

    #[test]
    fn a_choice_has_its_words_and_a_switch_two_places() {
        let words = ["A1", "F1"].map(str::to_owned).to_vec();
        let mut choice = cells(Handle::Choice(words), INT, (None, None));
        assert_eq!(at(&choice, 0), Ok(Raw::Whole(0)));
        assert_eq!(choice.set(Nanos::ZERO, "a", 1, Moved::Set(1.0)), Ok(true));
        assert_eq!(at(&choice, 9_000_000), Ok(Raw::Whole(1)), "it stays without a page");
        for wrong in [2.0, -1.0, 0.5, f64::NAN] {
            assert!(choice.set(Nanos::ZERO, "a", 1, Moved::Set(wrong)).is_err(), "{wrong}");
        }
        assert!(choice.set(Nanos::ZERO, "a", 1, Moved::Pressed).is_err());
        let mut switch = cells(Handle::Switch, Kind::Bool, (None, None));
        assert_eq!(switch.set(Nanos::ZERO, "a", 1, Moved::Set(1.0)), Ok(true));
        assert_eq!(at(&switch, 0), Ok(Raw::Bit(true)));
        assert!(switch.set(Nanos::ZERO, "a", 1, Moved::Set(2.0)).is_err());
        assert!(switch.set(Nanos::ZERO, "b", 1, Moved::Set(1.0)).is_err());
    }
}
