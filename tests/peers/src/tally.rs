//! The last line of `make test`: how many tests passed, and what was skipped.

use std::collections::BTreeMap;

/// The sum of the logs of a run and its list of skips.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    passed: usize,
    skipped: BTreeMap<String, usize>,
}

impl Tally {
    /// Adds the log of a test runner: cargo's, Node's or that of `g7 test`.
    ///
    /// # Errors
    ///
    /// If no test passed or one failed: such a log proves nothing.
    pub fn add_log(&mut self, name: &str, log: &str) -> Result<(), String> {
        let (mut passed, mut failed, mut ignored) = (0, 0, 0);
        for line in log.lines().map(str::trim) {
            if let Some(counts) = line.strip_prefix("test result: ") {
                passed += before(counts, "passed");
                failed += before(counts, "failed");
                ignored += before(counts, "ignored");
            } else if let Some(counts) = line.strip_prefix("# ").or_else(|| line.strip_prefix("ℹ ")) {
                passed += behind(counts, "pass");
                failed += behind(counts, "fail") + behind(counts, "cancelled");
                ignored += behind(counts, "skipped") + behind(counts, "todo");
            } else if line.starts_with(|c: char| c.is_ascii_digit()) && line.contains(" passed, ") {
                passed += before(line, "passed");
                failed += before(line, "failed");
            }
        }
        if passed == 0 || failed > 0 {
            return Err(format!("{name}: {passed} tests passed, {failed} failed"));
        }
        self.passed += passed;
        if ignored > 0 {
            *self.skipped.entry(format!("ignored in {name}")).or_default() += ignored;
        }
        Ok(())
    }

    /// Adds the lines that [`crate::skip`] wrote.
    pub fn add_skips(&mut self, skips: &str) {
        for why in skips.lines().filter_map(|l| l.split('\t').next()) {
            *self.skipped.entry(why.to_owned()).or_default() += 1;
        }
    }
}

/// The number in front of a word.
fn before(text: &str, word: &str) -> usize {
    let words: Vec<&str> = text.split([' ', ';', ',']).filter(|w| !w.is_empty()).collect();
    let number = words.windows(2).find(|w| w.last() == Some(&word)).and_then(|w| w.first()?.parse().ok());
    number.unwrap_or(0)
}

/// The number behind a word that begins the text.
fn behind(text: &str, word: &str) -> usize {
    let mut words = text.split_whitespace();
    if words.next() != Some(word) {
        return 0;
    }
    words.next().and_then(|n| n.parse().ok()).unwrap_or(0)
}

impl std::fmt::Display for Tally {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let all: usize = self.skipped.values().sum();
        write!(f, "{} tests passed; skipped: ", self.passed)?;
        if all == 0 {
            return write!(f, "none");
        }
        let reasons: Vec<String> = self.skipped.iter().map(|(why, n)| format!("{why}: {n}")).collect();
        write!(f, "{all} ({})", reasons.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(logs: &[&str], skips: &str) -> Result<String, String> {
        let mut tally = Tally::default();
        logs.iter().try_for_each(|log| tally.add_log("log", log))?;
        tally.add_skips(skips);
        Ok(tally.to_string())
    }

    const CARGO: &str = "running 3 tests\n...\ntest result: ok. 3 passed; 0 failed; 0 ignored; 0 measured; \
                         0 filtered out; finished in 0.00s\n\nrunning 0 tests\n\
                         test result: ok. 0 passed; 0 failed; 0 ignored; 0 measured\n";

    #[test]
    fn the_runners_are_added_up() {
        let node = "# tests 5\n# suites 0\n# pass 5\n# fail 0\n# cancelled 0\n# skipped 0\n# todo 0\n";
        let spec = node.replace('#', "ℹ");
        let g7 = "beads: ok\n\n7 passed, 0 failed\n";
        assert_eq!(of(&[CARGO, node, g7], ""), Ok("15 tests passed; skipped: none".into()));
        let unproved = "7 passed, 0 failed, 2 left to g7 prove\n";
        assert_eq!(of(&[unproved], ""), Ok("7 tests passed; skipped: none".into()));
        assert_eq!(of(&[&spec], ""), Ok("5 tests passed; skipped: none".into()));
    }

    #[test]
    fn skips_are_added_by_reason() {
        let skips = "corpus absent\tone\nclang missing\ttwo\ncorpus absent\tthree\n";
        let want = "3 tests passed; skipped: 3 (clang missing: 1, corpus absent: 2)";
        assert_eq!(of(&[CARGO], skips), Ok(want.into()));
        let ignored = CARGO.replace("0 ignored; 0 measured; ", "2 ignored; 0 measured; ");
        let want = "3 tests passed; skipped: 2 (ignored in log: 2)";
        assert_eq!(of(&[&ignored], ""), Ok(want.into()));
        let todo = "# pass 1\n# skipped 1\n# todo 1\n";
        assert_eq!(of(&[todo], ""), Ok("1 tests passed; skipped: 2 (ignored in log: 2)".into()));
    }

    #[test]
    fn a_log_that_proves_nothing_is_refused() {
        assert!(of(&[""], "").is_err());
        assert!(of(&["error: could not compile\n"], "").is_err());
        assert!(of(&[CARGO, "0 passed, 0 failed\n"], "").is_err());
        assert!(of(&["3 passed, 1 failed\n"], "").is_err());
        assert!(of(&["3 passed, 1 failed, 2 left to g7 prove\n"], "").is_err());
        assert!(of(&["# pass 3\n# cancelled 1\n"], "").is_err());
        assert!(of(&[&CARGO.replacen("0 failed", "1 failed", 1)], "").is_err());
    }
}
