//! Requests of the server to the system, beside a machine: room for its sockets, and a place behind the scan.

#[cfg(target_os = "linux")]
use rustix::process::{Resource, Rlimit, getrlimit, setpriority_process, setrlimit};

/// Files that are open besides the sockets of clients.
#[cfg(target_os = "linux")]
const OTHERS: u64 = 1_024;
/// The nice value of the threads of the server: other programs are not held up, and neither is a scan to which
/// the system gives no priority.
#[cfg(target_os = "linux")]
const NICE: i32 = 5;

/// Allows this program as many open files as so many clients need, where the system lets it. A shell gives a
/// program 1024 by default. Where there are too few, connections wait or are refused, and nothing else.
pub(super) fn room_for(clients: usize) {
    #[cfg(target_os = "linux")]
    {
        let is = getrlimit(Resource::Nofile);
        let wanted = OTHERS + u64::try_from(clients).unwrap_or(OTHERS);
        let wanted = is.maximum.map_or(wanted, |most| most.min(wanted));
        if is.current.is_some_and(|now| now < wanted) {
            setrlimit(Resource::Nofile, Rlimit { current: Some(wanted), maximum: is.maximum }).ok();
        }
    }
    #[cfg(not(target_os = "linux"))]
    let _ = clients;
}

/// Puts the thread that calls this behind those that scan and talk to devices.
pub(super) fn step_back() {
    // On Linux this is about the calling thread alone. Without it the server works as well.
    #[cfg(target_os = "linux")]
    setpriority_process(None, NICE).ok();
}
