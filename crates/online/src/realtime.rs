//! Time and priority as the system gives them to the scan thread.

#[cfg(not(target_os = "linux"))]
use g7_host::Clock as _;
use g7_host::WallClock;
use g7_model::Nanos;

/// Sleeps until an instant of the clock.
#[cfg(target_os = "linux")]
pub(crate) fn sleep_until(clock: &mut WallClock, instant: Nanos) {
    use rustix::thread::{ClockId, NanosleepRelativeResult, clock_nanosleep_relative};
    let Some(left) = clock.until(instant) else { return };
    let Ok(request) = left.try_into() else { return };
    // A signal ends the sleep; the step then comes early by as much, so the rest is slept as well.
    let mut rest = clock_nanosleep_relative(ClockId::Monotonic, &request);
    while let NanosleepRelativeResult::Interrupted(left) = rest {
        rest = clock_nanosleep_relative(ClockId::Monotonic, &left);
    }
}

/// Sleeps until an instant of the clock.
#[cfg(not(target_os = "linux"))]
pub(crate) fn sleep_until(clock: &mut WallClock, instant: Nanos) {
    clock.wait_until(instant);
}

/// Keeps the processors out of their deep sleep states for as long as it is held, because waking from
/// one can take longer than a scan. Measured at a period of 1 ms: without it half of the scans began more
/// than 70 us late, with it more than 34 us.
#[derive(Debug)]
pub(crate) struct Awake {
    /// The kernel takes the request back as the file is closed.
    _held: Option<std::fs::File>,
}

impl Awake {
    #[cfg(target_os = "linux")]
    fn hold() -> Awake {
        use std::io::Write as _;
        // Linux, PM QoS: four bytes, the longest permitted latency in us. Without the file, or where it may
        // not be opened, the scan runs all the same and is less punctual.
        let file = std::fs::OpenOptions::new().write(true).open("/dev/cpu_dma_latency");
        Awake { _held: file.and_then(|mut file| file.write_all(&0i32.to_ne_bytes()).map(|()| file)).ok() }
    }
}

/// Gives this thread a fixed priority before all threads that have none, and keeps the memory of the
/// program from being moved to the disk and the processors from sleeping deeply.
///
/// # Errors
///
/// A sentence that says what the system refused, and what would allow it.
#[cfg(target_os = "linux")]
pub(crate) fn claim(priority: u8) -> Result<Awake, String> {
    use thread_priority::unix::{
        RealtimeThreadSchedulePolicy, ThreadSchedulePolicy, set_thread_priority_and_policy, thread_native_id,
    };
    use thread_priority::{ThreadPriority, ThreadPriorityValue};
    let allow = "run it by systemd with `LimitRTPRIO=99` and `LimitMEMLOCK=infinity`, or by `sudo chrt`";
    let value =
        ThreadPriorityValue::try_from(priority).map_err(|e| format!("no priority {priority}: {e}"))?;
    set_thread_priority_and_policy(
        thread_native_id(),
        ThreadPriority::Crossplatform(value),
        ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo),
    )
    .map_err(|e| format!("the system gives the scan no priority ({e:?}): {allow}"))?;
    rustix::mm::mlockall(rustix::mm::MlockAllFlags::CURRENT | rustix::mm::MlockAllFlags::FUTURE)
        .map_err(|e| format!("the system does not lock memory ({e}): {allow}"))?;
    Ok(Awake::hold())
}

/// Other systems have no such priority.
///
/// # Errors
///
/// Always.
#[cfg(not(target_os = "linux"))]
pub(crate) fn claim(_priority: u8) -> Result<Awake, String> {
    Err("only Linux gives the scan a priority".to_owned())
}
