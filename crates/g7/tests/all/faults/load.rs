//! A busy machine: twice as many busy processes as processors and a storm of files, beside a controller whose
//! scan has a priority, and beside cyclictest.

use std::process::{Child, Command, Stdio};

use g7_peers::faults::{many, row};

use super::COUNTER;
use crate::common::Folder;

/// Stops the load at the end.
struct Load(Child);

impl Drop for Load {
    fn drop(&mut self) {
        // It ends its own processes when it is told to.
        Command::new("kill").arg(self.0.id().to_string()).status().ok();
        self.0.wait().ok();
    }
}

fn load(folder: &Folder) -> Load {
    let processors = std::thread::available_parallelism().map_or(1, usize::from);
    let mut stress = Command::new("stress-ng");
    stress.args(["--quiet", "--cpu", &(2 * processors).to_string(), "--hdd", "1", "--hdd-bytes", "64m"]);
    stress.arg("--temp-path").arg(folder.root()).stdin(Stdio::null());
    Load(stress.spawn().expect("it starts"))
}

/// How late scans were, in us: 99.9 %, and all.
fn late(folder: &Folder, seconds: u64) -> (f64, f64) {
    let ran = folder.g7(&["run", "chart.g7", "--online", "--for", &format!("{seconds}s")]);
    let line = ran.err.lines().find_map(|l| l.strip_prefix("scans were late: ")).expect("it tells");
    let of = |what: &str| {
        let number = line.split_once(what).and_then(|(_, rest)| rest.split_whitespace().next());
        number.and_then(|n| n.parse().ok()).expect("a number")
    };
    (of("99.9 % "), of("all "))
}

/// The same of cyclictest.
fn cyclictest(seconds: u64) -> (f64, f64) {
    let mut command = Command::new("cyclictest");
    command.args([
        "--mlockall",
        "--priority=80",
        "--threads=1",
        "--interval=1000",
        "--histogram=100000",
        "--quiet",
    ]);
    let out = command.arg(format!("--duration={seconds}")).output().expect("it starts");
    let text = String::from_utf8_lossy(&out.stdout).into_owned();
    let rows: Vec<(f64, f64)> = text
        .lines()
        .filter_map(|l| l.split_once(' '))
        .filter_map(|(us, count)| Some((us.parse().ok()?, count.trim().parse().ok()?)))
        .filter(|(_, count)| *count > 0.0)
        .collect();
    let all: f64 = rows.iter().map(|(_, count)| count).sum();
    let mut sum = 0.0;
    let most = rows.iter().find(|(_, count)| {
        sum += count;
        sum >= 0.999 * all
    });
    (most.expect("a histogram").0, rows.last().expect("a histogram").0)
}

#[test]
fn row_20_a_busy_machine_leaves_the_scan_its_time() {
    if !g7_peers::load_tools() {
        return;
    }
    let _alone = super::alone();
    let folder = Folder::with(COUNTER);
    folder.write("chart.io.toml", "[controller]\nperiod = '1ms'\npriority = 80\n");
    let seconds = if many() { 150 } else { 1 };
    let idle = (late(&folder, seconds), cyclictest(seconds));
    let busy = {
        let _load = load(&folder);
        (late(&folder, seconds), cyclictest(seconds))
    };
    let told = |(g7, other): ((f64, f64), (f64, f64))| {
        format!("{:.0} us (all {:.0}), cyclictest {:.0} us (all {:.0})", g7.0, g7.1, other.0, other.1)
    };
    let times = busy.0.0 / idle.0.0.max(1.0);
    let held = format!("99.9 % late by idle {}; busy {}: {times:.1} times", told(idle), told(busy));
    row(20, "1 ms", seconds * 1000, 0, held);
}
