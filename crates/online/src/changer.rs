//! The one who makes on-line changes: asks the scan thread for a picture, prepares the change, and hands
//! it over before the next scan.

use std::sync::mpsc::Sender;
use std::time::Duration;

use g7_host::{Clock, Runner, WallClock};
use g7_model::Nanos;

use crate::change::{Chart, Prepared, prepare};
use crate::exchange::Reader;
use crate::notes::Table;
use crate::parts::{Picture, Successor};
use crate::sight::Sight;

/// The scan is asked so often before the change is given up.
const ATTEMPTS: u32 = 20;
/// The pause between two looks for an answer of the scan: short beside a scan.
const PAUSE: Duration = Duration::from_micros(50);
/// Longer than an answer of a scan that works takes, beside its period.
const PATIENCE: Nanos = Nanos::from_millis(3_000);

/// On the way to the scan thread. Only one is on its way at any time.
pub(crate) enum ToScan {
    /// Take a picture after the next scan.
    Look(Box<Picture>),
    /// Go on with this before the next scan.
    Take(Box<Successor>),
}

/// On the way back.
pub(crate) enum FromScan {
    Seen(Box<Picture>),
    /// True: it goes on with it, and these are the parts of the chart before. False: something has
    /// changed since the picture.
    Back(bool, Box<Successor>),
}

/// The way in which a change ended.
pub enum Change {
    /// Nothing is changed, since this would be lost.
    Asks(Vec<String>),
    /// It goes on with the new chart.
    Made {
        /// A sentence for each part that was lost.
        lost: Vec<String>,
        /// The sight of the controller from here on.
        sight: Box<Sight>,
    },
}

/// The one who makes changes.
pub struct Changer {
    pub(crate) to_scan: rtrb::Producer<ToScan>,
    pub(crate) from_scan: rtrb::Consumer<FromScan>,
    /// `None` while the scan has it.
    picture: Option<Box<Picture>>,
    /// The way to the thread that saves values, where there is one.
    saver: Option<Sender<Reader>>,
    /// The way to the one who records, where there is one.
    historian: Option<Sender<Table>>,
}

impl Changer {
    pub(crate) fn new(
        runner: &Runner,
        (to_scan, from_scan): (rtrb::Producer<ToScan>, rtrb::Consumer<FromScan>),
        saver: Option<Sender<Reader>>,
        historian: Option<Sender<Table>>,
    ) -> Changer {
        Changer { to_scan, from_scan, picture: Some(Box::new(Picture::of(runner))), saver, historian }
    }

    /// Changes the chart that runs. What would be lost is lost only `anyway`.
    ///
    /// # Errors
    ///
    /// The reason why it cannot be changed; the controller goes on as before.
    pub fn change(&mut self, old: Chart<'_>, new: Chart<'_>, anyway: bool) -> Result<Change, String> {
        let wait = old.bench.period * 2 + PATIENCE;
        let mut took = Nanos::ZERO;
        for _ in 0..ATTEMPTS {
            let picture = self.look(wait)?;
            let mut clock = WallClock::default();
            let prepared = prepare(old, new, &picture);
            took = clock.now();
            self.picture = Some(picture);
            let Prepared { successor, lost, picture, sight, kept, table } = prepared?;
            if !lost.is_empty() && !anyway {
                return Ok(Change::Asks(lost));
            }
            if let (Some(historian), Some(table)) = (&self.historian, table) {
                // Before its first note. Nobody has to record.
                historian.send(table).ok();
            }
            if self.hand_over(successor, wait)? {
                self.picture = Some(picture);
                if let Some(saver) = &self.saver {
                    // The saver ends with the controller; the last values come to it in another way.
                    saver.send(kept).ok();
                }
                return Ok(Change::Made { lost, sight: Box::new(sight) });
            }
        }
        let [took, period] = [took, old.bench.period].map(|time| time.count() as f64 / 1e6);
        Err(format!(
            "the change takes {took:.1} ms, too long beside a scan each {period} ms: stop the controller for it"
        ))
    }

    /// A picture of the controller behind its next scan.
    fn look(&mut self, wait: Nanos) -> Result<Box<Picture>, String> {
        // An answer that came after it was given up.
        while let Ok(late) = self.from_scan.pop() {
            if let FromScan::Seen(picture) = late {
                self.picture = Some(picture);
            }
        }
        let picture = self.picture.take().ok_or_else(silent)?;
        match self.ask(ToScan::Look(picture), wait)? {
            FromScan::Seen(picture) => Ok(picture),
            FromScan::Back(..) => Err(silent()),
        }
    }

    /// True if the scan has taken it.
    fn hand_over(&mut self, successor: Box<Successor>, wait: Nanos) -> Result<bool, String> {
        match self.ask(ToScan::Take(successor), wait)? {
            FromScan::Back(taken, parts) => {
                drop(parts);
                Ok(taken)
            }
            FromScan::Seen(_) => Err(silent()),
        }
    }

    fn ask(&mut self, what: ToScan, wait: Nanos) -> Result<FromScan, String> {
        self.to_scan.push(what).map_err(|_| silent())?;
        let mut clock = WallClock::default();
        while clock.now() < wait {
            if let Ok(answer) = self.from_scan.pop() {
                return Ok(answer);
            }
            std::thread::sleep(PAUSE);
        }
        Err(silent())
    }
}

fn silent() -> String {
    "the scan does not answer".to_owned()
}
