//! Work that several threads share; the results are taken in the order of the work.

use std::num::NonZero;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::channel;

use crate::failure::{Failure, refused};

/// Stack of a thread: as large as that of the main thread on most systems.
const STACK: usize = 8 << 20;

/// Does `one` with each work, on as many threads as `jobs` says or else as there are processors, and hands the results to
/// `take`.
///
/// # Errors
///
/// The first failure of a work or of `take`; no further work is begun then.
pub(crate) fn in_order<W: Sync, T: Send>(
    jobs: Option<u16>,
    works: &[W],
    one: impl Fn(&W) -> Result<T, Failure> + Sync,
    mut take: impl FnMut(T) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let (next, given_up) = (AtomicUsize::new(0), AtomicBool::new(false));
    let all = || std::thread::available_parallelism().map_or(1, NonZero::get);
    let threads = jobs.map_or_else(all, usize::from);
    let (give, results) = channel();
    std::thread::scope(|scope| {
        for _ in 0..threads.min(works.len()).max(1) {
            let give = give.clone();
            let (next, given_up, one) = (&next, &given_up, &one);
            let thread = move || {
                while !given_up.load(Ordering::Relaxed) {
                    let number = next.fetch_add(1, Ordering::Relaxed);
                    let Some(work) = works.get(number) else { break };
                    if give.send((number, one(work))).is_err() {
                        break;
                    }
                }
            };
            std::thread::Builder::new().stack_size(STACK).spawn_scoped(scope, thread).map_err(refused)?;
        }
        // Only the threads hold a sender now, so `recv` ends when the last of them has ended.
        drop(give);
        let mut waiting = std::collections::BTreeMap::new();
        let mut taken = 0;
        while taken < works.len() {
            let Ok((number, done)) = results.recv() else { break };
            waiting.insert(number, done);
            while let Some(done) = waiting.remove(&taken) {
                taken += 1;
                if let Err(failure) = done.and_then(&mut take) {
                    given_up.store(true, Ordering::Relaxed);
                    return Err(failure);
                }
            }
        }
        Ok(())
    })
}
