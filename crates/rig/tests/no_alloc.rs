//! A run of charts with their plant allocates nothing in a scan, recorded as it may be.

use allocation_counter::measure;
use g7_host::{Recording, Runner, Value};
use g7_model::Nanos;
use g7_rig::{Bench, Options, Role, Source, build};

const EXAMPLES: [(&str, &str); 4] = [
    ("bead-sorter", include_str!("../../../examples/bead-sorter/chart.g7")),
    ("transport-workcell", include_str!("../../../examples/transport-workcell/improved.g7")),
    ("two-tanks", include_str!("../../../examples/two-tanks/chart.g7")),
    ("bottle-conveyor", include_str!("../../../examples/bottle-conveyor/chart.g7")),
];

fn bench(text: &str) -> Bench {
    let source = Source::new("chart.g7", text.as_bytes().to_vec(), 0);
    let (bench, problems) = build(&source, &Options::default()).expect("the plant is there");
    bench.unwrap_or_else(|| panic!("{problems:?}"))
}

/// Sets the inputs that the plant does not drive.
fn set_inputs(bench: &Bench, runner: &mut Runner, value: u64) {
    for item in &bench.items {
        if matches!(item.role, Role::Input(_)) && !bench.is_driven(runner, item) {
            bench.set(runner, item, &Value::Word(value));
        }
    }
}

/// Makes scans and records them; returns in how many of them something was allocated.
fn scans(bench: &Bench, runner: &mut Runner, recording: &mut Recording, scans: usize) -> usize {
    let mut allocating = 0;
    for i in 0..scans {
        // A button is pressed and let go.
        set_inputs(bench, runner, u64::from(i % 100 < 50));
        let counted = measure(|| {
            runner.scan().expect("the examples run without fault");
            recording.sample(Nanos::new(runner.state().now()), bench.sample(runner));
        });
        allocating += usize::from(counted.count_total > 0);
    }
    allocating
}

/// With a limit there is room for all changes from the first scan on, and in the first chunk of a tape
/// for some thousand scans.
#[test]
fn scans_with_a_tape_and_a_limited_recording_allocate_nothing() {
    for (name, text) in EXAMPLES {
        let bench = bench(text);
        let mut runner = bench.runner(1).with_tape();
        let mut recording = Recording::new(bench.signals()).with_limit(100);
        scans(&bench, &mut runner, &mut recording, 1);
        assert_eq!(scans(&bench, &mut runner, &mut recording, 3000), 0, "{name}");
        let most = (0..bench.signals().len()).map(|i| recording.count(i)).max();
        assert_eq!(most, Some(100), "{name}: a signal has come to the limit");
    }
}

/// Without a limit the room of each signal doubles now and then, and a tape gets a chunk more.
#[test]
fn scans_with_an_unlimited_recording_allocate_less_and_less() {
    for (name, text) in EXAMPLES {
        let bench = bench(text);
        let mut runner = bench.runner(1).with_tape();
        let mut recording = Recording::new(bench.signals());
        scans(&bench, &mut runner, &mut recording, 10_000);
        let allocating = scans(&bench, &mut runner, &mut recording, 10_000);
        // A doubling for each signal, and 10 words of a tape in each scan.
        let most = bench.signals().len() + 10 * 10_000 / (1 << 14);
        assert!(allocating <= most, "{name}: {allocating} scans allocate, {most} may");
    }
}

/// Beads that fall change texts of the plant; forced variables are written before and after a scan.
#[test]
fn changes_of_texts_and_forces_allocate_nothing() {
    let bench = bench(EXAMPLES[0].1);
    let mut runner = bench.runner(1).with_tape();
    let mut recording = Recording::new(bench.signals()).with_limit(100);
    for (item, value) in [("LED", 1), ("SortWaitTime", 60), ("Tilt", 0)] {
        let item = bench.item(item).expect("an item of the example");
        bench.force(&mut runner, item, &Value::Word(value));
    }
    scans(&bench, &mut runner, &mut recording, 1);
    assert_eq!(scans(&bench, &mut runner, &mut recording, 1200), 0);
    let texts = bench.signals().iter().filter(|s| s.name.starts_with("shown")).count();
    let changes = |name: &str| {
        recording.count(bench.signals().iter().position(|s| s.name == name).expect("a signal of the example"))
    };
    assert_eq!(texts, 3);
    assert!(changes("shown") > 3 && changes("shown1") > 3, "beads have fallen");
}
