//! A machine at work: the scan, each driver and the watchdog in threads of their own.
//!
//! The thread of the caller takes the events, gives commands, and ends it all.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Condvar, Mutex};
use std::thread::JoinHandle;
use std::time::Duration;

use g7_host::{Clock, WallClock};
use g7_model::Nanos;

use crate::changer::{Changer, FromScan, ToScan};
use crate::controller::{Command, Controller, Event, Mode, Refused, Shared};
use crate::driver::{Driver, Happened};
use crate::exchange::Reader;
use crate::keep::KeptFile;
use crate::machine::Machine;
use crate::pace::Pace;
use crate::realtime;
use crate::saver::Saver;
use crate::slots::Disk;

/// The pause of threads that have nothing else to wait for.
const PAUSE: Duration = Duration::from_millis(20);
/// Pauses in which the last values of the scan are waited for.
const LAST: usize = 100;
/// Commands that wait for the scan.
const COMMANDS: usize = 64;
/// Paces that wait to be counted: those of some seconds at a scan each millisecond.
const PACES: usize = 8192;

/// Something that happened at a device: its number in the wiring, and what it was.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AtDevice {
    /// The number of the device.
    pub device: usize,
    /// The event itself.
    pub happened: Happened,
}

/// The answer to a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Answer {
    /// The number that [`Running::command`] gave the command.
    pub number: u64,
    /// Done, or why not.
    pub done: Result<(), Refused>,
}

/// How a machine is run.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// The longest time between the ends of two steps.
    pub watchdog: Nanos,
    /// The priority of the scan thread, 1 to 99.
    pub priority: Option<u8>,
}

/// A machine at work. Dropping it ends it as [`Running::end`] does.
pub struct Running {
    /// The clock of the controller.
    pub clock: WallClock,
    stop: Arc<Stop>,
    shared: Shared,
    commands: rtrb::Producer<(u64, Command)>,
    /// The number of the next command.
    next: u64,
    /// The answers to the commands; left out while nobody takes them.
    pub answers: rtrb::Consumer<Answer>,
    /// The events of the controller.
    pub events: rtrb::Consumer<Event>,
    /// The events of the devices.
    pub devices: Receiver<AtDevice>,
    /// The pace of each scan; the latest are left out while nobody takes them.
    pub paces: rtrb::Consumer<Pace>,
    scan: Option<JoinHandle<Option<Controller>>>,
    threads: Vec<JoinHandle<()>>,
    /// Why the scan has no priority although one was asked for.
    pub no_priority: Receiver<String>,
    /// Why values could not be saved; each time it begins to fail.
    pub disk: Receiver<std::io::Error>,
    /// The one who makes on-line changes; whoever takes it puts it back.
    pub changer: Option<Changer>,
}

/// A flag that can be waited for.
#[derive(Default)]
struct Stop {
    flag: Mutex<bool>,
    changed: Condvar,
    /// The same flag, for the scan thread, which does not lock.
    plain: AtomicBool,
}

impl Stop {
    fn set(&self) {
        self.plain.store(true, Ordering::Release);
        // A thread that panicked cannot have left the flag half set.
        *self.flag.lock().unwrap_or_else(std::sync::PoisonError::into_inner) = true;
        self.changed.notify_all();
    }

    /// Waits for so long, or until the flag is set; true if it is.
    fn wait(&self, time: Duration) -> bool {
        let flag = self.flag.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let waited = self.changed.wait_timeout_while(flag, time, |set| !*set);
        *waited.unwrap_or_else(std::sync::PoisonError::into_inner).0
    }
}

/// Starts a machine; the controller is stopped until it gets [`Command::Run`].
///
/// # Errors
///
/// The system has no more threads.
pub fn start<D: Disk + Send + 'static>(
    machine: Machine,
    kept: Option<KeptFile<D>>,
    options: Options,
) -> std::io::Result<Running> {
    begin(machine, kept, options, scan)
}

/// Starts a machine whose scan thread does this.
fn begin<D: Disk + Send + 'static>(
    machine: Machine,
    kept: Option<KeptFile<D>>,
    options: Options,
    scan: impl FnOnce(Controller, WallClock, Ends, &Stop) -> Controller + Send + 'static,
) -> std::io::Result<Running> {
    let Machine { mut controller, drivers, events, shared, tables } = machine;
    controller.guard(options.watchdog);
    let (stop, clock) = (Arc::new(Stop::default()), WallClock::default());
    let last = Arc::new(Mutex::new(None));
    let (commands, to_scan) = rtrb::RingBuffer::new(COMMANDS);
    let (of_scan, paces) = rtrb::RingBuffer::new(PACES);
    let (answer, answers) = rtrb::RingBuffer::new(COMMANDS);
    let asked = (to_scan, answer);
    // One is on its way at any time.
    let (ask_change, changes) = rtrb::RingBuffer::new(2);
    let (changed, of_change) = rtrb::RingBuffer::new(2);
    let mut renewed = None;
    let runner = controller.runner().clone();
    let (tell, devices) = channel();
    let (priority_failed, no_priority) = channel();
    let mut threads = Vec::new();
    for (device, driver) in drivers.into_iter().enumerate() {
        let (stop, tell) = (Arc::clone(&stop), tell.clone());
        let name = format!("device {device}");
        threads.push(spawn(name, move || drive(driver, device, clock, &stop, &tell))?);
    }
    let (unsaved, disk) = channel();
    if let Some(kept) = kept {
        let (stop, last) = (Arc::clone(&stop), Arc::clone(&last));
        let (renew, readers) = channel();
        renewed = Some(renew);
        threads.push(spawn("values".to_owned(), move || save(kept, &readers, &last, &stop, &unsaved))?);
    }
    let (watched, watching) = (shared.clone(), Arc::clone(&stop));
    threads.push(spawn("watchdog".to_owned(), move || watch(&watched, clock, options.watchdog, &watching))?);
    let (scan_shared, scan_stop) = (shared.clone(), Arc::clone(&stop));
    let final_words = Arc::clone(&last);
    let scan = std::thread::Builder::new().name("scan".to_owned()).spawn(move || {
        let claimed = options.priority.map(realtime::claim);
        if let Some(Err(why)) = &claimed {
            // The caller may have gone on without listening.
            priority_failed.send(why.clone()).ok();
        }
        let ends = Ends { commands: asked.0, answers: asked.1, changes, changed, paces: of_scan };
        let done = catch_unwind(AssertUnwindSafe(|| scan(controller, clock, ends, &scan_stop)));
        // Drivers write safe values from here on, also after a panic.
        scan_shared.safe.store(true, Ordering::Release);
        let mut controller = done.ok();
        let words = controller.as_mut().map(|c| c.kept().to_vec()).unwrap_or_default();
        *final_words.lock().unwrap_or_else(std::sync::PoisonError::into_inner) = Some(words);
        controller
    })?;
    let changer = Some(Changer::new(&runner, (ask_change, of_change), renewed, tables));
    Ok(Running {
        clock,
        stop,
        shared,
        commands,
        next: 0,
        answers,
        events,
        devices,
        paces,
        scan: Some(scan),
        threads,
        no_priority,
        disk,
        changer,
    })
}

fn spawn(name: String, work: impl FnOnce() + Send + 'static) -> std::io::Result<JoinHandle<()>> {
    std::thread::Builder::new().name(name).spawn(work)
}

/// The scan thread's ends of what leads to it and from it.
struct Ends {
    commands: rtrb::Consumer<(u64, Command)>,
    answers: rtrb::Producer<Answer>,
    changes: rtrb::Consumer<ToScan>,
    changed: rtrb::Producer<FromScan>,
    paces: rtrb::Producer<Pace>,
}

/// The scan thread: commands, a step, and nothing until the next one.
fn scan(mut controller: Controller, mut clock: WallClock, mut ends: Ends, stop: &Stop) -> Controller {
    // A picture that was asked for; it is taken behind a scan, when most time is left.
    let mut picture = None;
    loop {
        let due = controller.due();
        realtime::sleep_until(&mut clock, due);
        if stop.plain.load(Ordering::Acquire) {
            return controller;
        }
        while let Ok((number, command)) = ends.commands.pop() {
            let done = controller.command(clock.now(), command);
            ends.answers.push(Answer { number, done }).ok();
        }
        match ends.changes.pop() {
            Ok(ToScan::Look(room)) => picture = Some(room),
            Ok(ToScan::Take(mut successor)) => {
                let taken = controller.change(clock.now(), &mut successor);
                // There is room: only one is on its way. So nothing is freed here.
                ends.changed.push(FromScan::Back(taken, successor)).ok();
            }
            Err(_) => {}
        }
        let begin = clock.now();
        controller.step(begin);
        if controller.mode() == Mode::Run {
            // Without a reader the ring is full; the scan goes on.
            ends.paces.push(Pace { late: begin - due, took: clock.now() - begin }).ok();
        }
        if let Some(mut room) = picture.take() {
            controller.look(&mut room);
            ends.changed.push(FromScan::Seen(room)).ok();
        }
    }
}

/// The thread of a device.
fn drive(mut driver: Driver, device: usize, mut clock: WallClock, stop: &Stop, tell: &Sender<AtDevice>) {
    let mut happened = |happened| {
        // Nobody has to listen.
        tell.send(AtDevice { device, happened }).ok();
    };
    loop {
        let left = clock.until(driver.due()).unwrap_or(PAUSE);
        if stop.wait(left) {
            driver.end();
            return;
        }
        let worked = driver.work(clock.now(), &mut happened);
        driver.settle(clock.now(), worked, &mut happened);
    }
}

/// The thread of the values that are kept: it saves them as they come, and the last ones at the end.
fn save<D: Disk>(
    kept: KeptFile<D>,
    renewed: &Receiver<Reader>,
    last: &Mutex<Option<Vec<u64>>>,
    stop: &Stop,
    unsaved: &Sender<std::io::Error>,
) {
    let mut saver = Saver::new(kept);
    let tell = |done: std::io::Result<()>| {
        if let Err(e) = done {
            // Nobody has to listen.
            unsaved.send(e).ok();
        }
    };
    while !stop.wait(PAUSE) {
        if let Ok(reader) = renewed.try_recv() {
            saver.renew(reader);
        }
        tell(saver.save());
    }
    // The scan ends at the same flag; its last values come a moment later.
    for _ in 0..LAST {
        let last = last.lock().unwrap_or_else(std::sync::PoisonError::into_inner).take();
        match last {
            Some(words) if !words.is_empty() => return tell(saver.save_these(&words)),
            Some(_) => return,
            None => std::thread::sleep(PAUSE),
        }
    }
}

/// The watchdog: outputs are safe as soon as a step takes too long.
fn watch(shared: &Shared, mut clock: WallClock, most: Nanos, stop: &Stop) {
    let pause = Duration::from_nanos((most.count() / 4).max(1).unsigned_abs()).min(PAUSE);
    while !stop.wait(pause) {
        let silent = clock.now() - Nanos::new(shared.beat.load(Ordering::Acquire));
        if silent > most && !shared.safe.load(Ordering::Acquire) {
            shared.tripped.store(true, Ordering::Release);
            shared.safe.store(true, Ordering::Release);
        }
    }
}

impl Running {
    /// Gives a command to the scan and returns its number; `None` where too many wait for it.
    pub fn command(&mut self, command: Command) -> Option<u64> {
        let number = self.next;
        self.commands.push((number, command)).ok()?;
        self.next += 1;
        Some(number)
    }

    /// True while the scan thread works; a panic in it ends it.
    pub fn is_alive(&self) -> bool {
        self.scan.as_ref().is_some_and(|scan| !scan.is_finished())
    }

    /// Ends all threads: the outputs are safe, and the connections closed. Returns the controller;
    /// `None` where the scan panicked.
    pub fn end(mut self) -> Option<Controller> {
        self.finish()
    }

    fn finish(&mut self) -> Option<Controller> {
        self.shared.safe.store(true, Ordering::Release);
        self.stop.set();
        let controller = self.scan.take().and_then(|scan| scan.join().ok()).flatten();
        for thread in self.threads.drain(..) {
            // A driver that panicked has told so already.
            thread.join().ok();
        }
        controller
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        self.finish();
    }
}

#[cfg(test)]
mod tests;
