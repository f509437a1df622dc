//! No scan of any chart allocates memory: random charts with all features under every profile, with
//! the allocations of this thread counted.
#![allow(unsafe_code, reason = "counting allocations needs a GlobalAlloc")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use g7_compile::compile;
use g7_engine::{FaultKind, State, scan};
use g7_model::ProfileName;
use g7_tests::generate::sample;

struct Counting;

thread_local! {
    /// Counts only this thread, because tests run in parallel.
    static COUNT: Cell<usize> = const { Cell::new(0) };
}

fn count() {
    // A thread that is ending has no counter any more.
    COUNT.try_with(|c| c.set(c.get() + 1)).ok();
}

// SAFETY: forwards to `System`, which upholds the contract.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, ptr: *mut u8, layout: Layout) {
        unsafe { System.dealloc(ptr, layout) }
    }
    unsafe fn realloc(&self, ptr: *mut u8, layout: Layout, new: usize) -> *mut u8 {
        count();
        unsafe { System.realloc(ptr, layout, new) }
    }
}

#[global_allocator]
static ALLOC: Counting = Counting;

/// Number of charts for each profile.
const CHARTS: u64 = 250;
/// Number of scans of each chart.
const SCANS: i64 = 40;

#[test]
fn no_scan_of_any_chart_allocates() {
    for profile in ProfileName::ALL {
        let (mut scans, mut cleared, mut ran) = (0, 0, 0);
        for seed in 1..=CHARTS {
            let sample = sample(seed, profile, 1).expect("a random chart can be read");
            let (Some(c), _) = compile(&sample.document) else { continue };
            let program = &c.program;
            let rows = program.tables().inputs;
            let mut state = State::new(program);
            let mut inputs = vec![0u64; (rows.end - rows.start) as usize];
            let (mut other, mut image) = (state.clone(), Vec::with_capacity(state.image().len()));
            let mut chance = seed;
            for k in 0..SCANS {
                for word in &mut inputs {
                    chance = chance.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(99);
                    *word = (chance >> 33) & 1;
                }
                let before = COUNT.get();
                let report = scan(program, &mut state, &inputs, k * 10_000_000);
                assert_eq!(COUNT.get(), before, "{} seed {seed}, scan {k}", profile.name());
                // Nor does what a search does between two scans.
                state.canonical(program, &mut image);
                other.restore(program, &image).expect("a canonical image");
                assert_eq!(COUNT.get(), before, "{} seed {seed}, after scan {k}", profile.name());
                match report {
                    Ok(report) => cleared += report.cleared,
                    // After a fault the run stays stopped.
                    Err(fault) if fault.kind == FaultKind::Stopped => break,
                    Err(_) => {}
                }
                scans += 1;
                ran += state.ran().len();
            }
        }
        assert!(scans > 1000 && cleared > 1000 && ran > 1000, "{}: {scans} {cleared} {ran}", profile.name());
    }
}
