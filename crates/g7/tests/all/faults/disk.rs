//! A full disk under a controller: a small file system that nobody else sees is filled again and again.

use std::fs::OpenOptions;
use std::io::Write as _;
use std::time::{Duration, Instant};

use g7_peers::faults::{Times, row, trials};
use g7_peers::process;
use snapbox::cmd::cargo_bin;

use super::{COUNTER, saved};
use crate::common::Folder;
use crate::common::talk::Running;

#[test]
fn row_4_a_full_disk_stops_neither_scans_nor_saves() {
    let Some(mut command) = g7_peers::with_own_mounts() else { return };
    let _alone = super::alone();
    let folder = Folder::with(COUNTER);
    folder.write("chart.io.toml", "[controller]\nperiod = '10ms'\nretain = 'kept'\n");
    folder.write("disk/empty", "");
    let line = "mount -t tmpfs -o size=256k none disk && cp chart.g7 chart.io.toml disk && cd disk && \
                exec \"$0\" run chart.g7 --online";
    command.arg(line).arg(cargo_bin!("g7")).current_dir(folder.root());
    let mut g7 = Running::start(command, |child| Box::new(child.stderr.take().expect("piped")));
    g7.until("running");
    let file = |name: &str| process::its_file(g7.pid(), &folder.path("disk").join(name));
    let (kept, filler) = (file("kept"), file("filler"));
    let (mut times, count) = (Times::default(), trials(100, 3));
    for _ in 0..count {
        fill(&filler);
        let (before, begin) = (saved(&kept), Instant::now());
        // Values that were saved once may have been on its way before the disk was full.
        for _ in 0..2 {
            let now = saved(&kept);
            while saved(&kept) == now {
                assert!(begin.elapsed() < Duration::from_secs(60), "nothing is saved any more");
                std::thread::sleep(Duration::from_millis(10));
            }
        }
        assert!(saved(&kept) > before);
        times.add(begin.elapsed());
        std::fs::remove_file(&filler).expect("it is there");
    }
    g7.say("quit");
    let told = g7.rest();
    assert!(!told.iter().any(|line| line.contains("cannot be saved")), "{told:#?}");
    let late = told.iter().find_map(|line| line.strip_prefix("scans were late: ")).expect("it tells");
    row(4, "", count.into(), 0, format!("two saves on the full disk after {times}; scans late: {late}"));
}

/// Fills the disk to its last byte.
fn fill(file: &std::path::Path) {
    let mut file = OpenOptions::new().create(true).append(true).open(file).expect("it can be opened");
    for size in [4096, 1] {
        while file.write_all(&vec![b'x'; size]).is_ok() {}
    }
    assert_eq!(file.write(b"x").expect_err("it is full").kind(), std::io::ErrorKind::StorageFull);
}
