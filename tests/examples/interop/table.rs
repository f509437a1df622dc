//! Prints the result: a table with a row for each program, then the reasons why files were refused.

use std::collections::BTreeMap;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use g7_model::{Problem, Severity};
use g7_peers::Matiec;
use g7_peers::mended::mended;
use g7_peers::projects::output;
use g7_tests::generated::cases::Folder;

use crate::charts::Chart;
use crate::reasons::{nameless, who};

/// The text that G7 wrote of a chart, or the reason why it writes none.
pub(crate) type Written = Result<String, String>;

/// A text, if nothing is lost in it; otherwise the first loss.
pub(crate) fn taken(text: String, problems: &[Problem]) -> Written {
    let lost = problems.iter().find(|p| p.severity() == Severity::Error);
    lost.map_or(Ok(text), |p| Err(format!("refused by G7: {}", p.what)))
}

/// The charts that are tried, and the reasons why some are not taken.
pub(crate) struct Table<'c> {
    pub(crate) charts: &'c [Chart],
    pub(crate) folder: Folder,
    pub(crate) matiec: Option<Matiec>,
    /// By reason: how often, and the first file.
    why: BTreeMap<String, (usize, PathBuf)>,
    /// When the table and the row were begun.
    begun: (Instant, Instant),
    /// How long a row may take; what is not tried until then is told.
    limit: Duration,
}

/// How long a row may take, in seconds, if `G7_LIMIT` says nothing else.
const LIMIT: u64 = 600;

impl<'c> Table<'c> {
    /// With the head of the table, printed.
    pub(crate) fn new(charts: &'c [Chart]) -> Table<'c> {
        let folder = Folder::new("interop-table");
        std::fs::create_dir_all(&folder.0).unwrap_or_else(|e| panic!("{}: {e}", folder.0.display()));
        let matiec = g7_peers::matiec();
        if let Some(matiec) = &matiec {
            mended(&matiec.lib.join("C"), &folder.0.join("C")).unwrap_or_else(|e| panic!("{e}"));
        }
        println!("{} charts\n\n| program | accepted / tried | seconds |\n|---|---|---|", charts.len());
        let now = Instant::now();
        let limit = std::env::var("G7_LIMIT").ok().and_then(|text| text.parse().ok()).unwrap_or(LIMIT);
        let limit = Duration::from_secs(limit);
        Table { charts, folder, matiec, why: BTreeMap::new(), begun: (now, now), limit }
    }

    /// The time of a row begins, behind what G7 had to write for it.
    pub(crate) fn begin(&mut self) {
        self.begun.1 = Instant::now();
    }

    /// True where the row has taken its time.
    pub(crate) fn late(&self) -> bool {
        self.begun.1.elapsed() > self.limit
    }

    /// Prints a row, with the time since the row before. `all` is what would be tried with more time.
    pub(crate) fn row(&mut self, program: &str, accepted: usize, tried: usize, all: usize) {
        let of = if all > tried { format!(" (of {all}, out of time)") } else { String::new() };
        println!("| {program} | {accepted} / {tried}{of} | {} |", self.begun.1.elapsed().as_secs());
        let _ = std::io::stdout().flush();
        self.begun.1 = Instant::now();
    }

    /// Counts a reason.
    pub(crate) fn note(&mut self, reason: &str, file: &Path) {
        eprintln!("{}: {reason}", file.display());
        self.why.entry(nameless(reason)).or_insert_with(|| (0, file.to_path_buf())).0 += 1;
    }

    /// A row of what a program takes, one file after the other.
    pub(crate) fn tries(
        &mut self,
        program: &str,
        written: impl Fn(&Chart) -> Option<Written>,
        takes: impl Fn(&mut Self, &str) -> Result<(), String>,
    ) {
        let (mut all, mut tried, mut accepted) = (0, 0, 0);
        for chart in self.charts {
            match written(chart) {
                Some(Ok(text)) => {
                    all += 1;
                    if self.late() {
                        continue;
                    }
                    tried += 1;
                    match takes(self, &text) {
                        Ok(()) => accepted += 1,
                        Err(reason) => self.note(&format!("{program}: {reason}"), &chart.file),
                    }
                }
                Some(Err(reason)) => self.note(&reason, &chart.file),
                None => {}
            }
        }
        self.row(program, accepted, tried, all);
    }

    /// Writes a file.
    pub(crate) fn file(&self, name: &str, text: &str) -> PathBuf {
        let path = self.folder.0.join(name);
        std::fs::write(&path, text).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        path
    }

    /// Has matiec compile a text.
    pub(crate) fn compiles(&self, matiec: &Matiec, program: &str) -> Result<(), String> {
        let folder = self.folder.0.join("c");
        let _ = std::fs::remove_dir_all(&folder);
        std::fs::create_dir_all(&folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
        self.file("c/program.st", program);
        output(&matiec.translate(&folder, "program.st")).map(|_| ())
    }

    /// Prints the reasons.
    pub(crate) fn end(self) {
        println!("\n| reason | charts | first | who is right |\n|---|---|---|---|");
        for (reason, (count, first)) in &self.why {
            println!("| {reason} | {count} | {} | {} |", first.display(), who(reason, first));
        }
        println!("\n{} seconds", self.begun.0.elapsed().as_secs());
    }
}
