//! Other model checkers, which tests and benches ask what the prover was asked: ABC and rIC3 by AIGER
//! files, Spin by a model in Promela, LTSmin by a table of transitions (ETF).
//!
//! Each is tried on a question with a known answer before it is used; one that is missing or fails there is
//! a counted skip. What they say is one tool's word: a test shows by a run who is right.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use crate::{Scratch, skip};

/// The word of a checker on a bad signal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Said {
    /// No run shows it.
    Never,
    /// A run of so many steps shows it.
    Reached(usize),
    /// It gave up.
    Open,
}

/// Two latches that count the steps in which an input is 1, from 2 on. Bad: 3, 2, a latch that is 1 and 0 at
/// once, 0 and 1.
const COUNTER: &[u8] = b"aig 13 1 2 0 10 5\n12 0\n20 1\n22\n24\n26\n0\n1\n\x04\x02\x05\x02\x01\x02\x0a\x02\x02\x08\x03\x08\x01\x02\x10\x02\x12\x01\x04\x11";

/// Berkeley ABC.
#[derive(Clone, Debug)]
pub struct Abc(PathBuf);

impl Abc {
    /// The program, if it answers a small question; otherwise the skip is counted.
    pub fn find() -> Option<Abc> {
        let found = ["berkeley-abc", "abc"].iter().find_map(|name| in_path(name)).map(Abc);
        let Some(abc) = found else {
            skip("berkeley-abc missing");
            return None;
        };
        let wanted = [Said::Reached(2), Said::Reached(1), Said::Never, Said::Never, Said::Reached(1)];
        if abc.ask(&[COUNTER.to_vec()], 10) == [wanted] {
            return Some(abc);
        }
        skip("berkeley-abc does not work");
        None
    }

    /// Asks for the bad signals of AIGER files, each file for at most so many seconds. Runs are shortest ones.
    ///
    /// # Panics
    ///
    /// If the program cannot be started, or its files cannot be written.
    pub fn ask(&self, files: &[Vec<u8>], seconds: u32) -> Vec<Vec<Said>> {
        let folder = Scratch::new("abc");
        let mut script = String::new();
        for (i, file) in files.iter().enumerate() {
            std::fs::write(folder.0.join(format!("{i}.aig")), file).expect("a file for abc");
            // Latches without an initial value become inputs of the first step; constraints a part of each output.
            script += &format!(
                "read_aiger {i}.aig; logic; undc; strash; fold; zero; pdr -aq -T {seconds}; echo end of file\n"
            );
        }
        std::fs::write(folder.0.join("script"), script).expect("a file for abc");
        let out = Command::new(&self.0).args(["-f", "script"]).current_dir(&folder.0).output();
        let out = out.expect("abc starts");
        let text = String::from_utf8_lossy(&out.stdout);
        let parts = text.split("end of file");
        files.iter().zip(parts).map(|(file, part)| said_by_abc(part, bad_signals(file))).collect()
    }
}

/// The number of bad signals in the header of an AIGER file.
pub fn bad_signals(file: &[u8]) -> usize {
    let header = file.split(|b| *b == b'\n').next().unwrap_or(&[]);
    let header = String::from_utf8_lossy(header);
    header.split_whitespace().nth(6).and_then(|n| n.parse().ok()).unwrap_or(0)
}

fn said_by_abc(text: &str, count: usize) -> Vec<Said> {
    // Every output that is neither asserted nor undecided is proved; the last line counts them.
    let number = |word: &str| -> Option<usize> {
        let rest = text.split_once(word)?.1.trim_start();
        rest.split(|c: char| !c.is_ascii_digit()).next()?.parse().ok()
    };
    let whole = number("All =") == Some(count) && number("Undecided =") == Some(0);
    let mut said = vec![if whole { Said::Never } else { Said::Open }; count];
    for line in text.lines().filter_map(|l| l.strip_prefix("Output ")) {
        let output = line.split_whitespace().next().and_then(|n| n.parse::<usize>().ok());
        let frame = line.split_once("in frame").and_then(|(_, f)| f.split_whitespace().next());
        let frame = frame.and_then(|f| f.parse::<usize>().ok());
        if let (Some(slot), Some(frame)) = (output.and_then(|o| said.get_mut(o)), frame) {
            *slot = Said::Reached(frame + 1);
        }
    }
    said
}

/// rIC3.
#[derive(Clone, Debug)]
pub struct Ric3(PathBuf);

impl Ric3 {
    /// The program, if it answers a small question; otherwise the skip is counted.
    pub fn find() -> Option<Ric3> {
        let Some(ric3) = in_path("rIC3").or_else(|| in_path("ric3")).map(Ric3) else {
            skip("rIC3 missing");
            return None;
        };
        let said: Vec<Said> = (0..3).map(|i| ric3.ask(&one_of(COUNTER, i), 10)).collect();
        if said == [Said::Reached(0), Said::Reached(0), Said::Never] {
            return Some(ric3);
        }
        skip("rIC3 does not work");
        None
    }

    /// Asks for the one bad signal of an AIGER file. The length of a run is not told: it is 0.
    ///
    /// # Panics
    ///
    /// If the program cannot be started, or its file cannot be written.
    pub fn ask(&self, file: &[u8], seconds: u32) -> Said {
        let folder = Scratch::new("ric3");
        let path = folder.0.join("asked.aig");
        std::fs::write(&path, file).expect("a file for rIC3");
        // IC3 alone: its `kind` leaves out the base case.
        let mut command = Command::new("timeout");
        command.arg(seconds.to_string()).arg(&self.0).args(RIC3).arg(&path);
        match command.output().expect("rIC3 starts").status.code() {
            Some(10) => Said::Reached(0),
            Some(20) => Said::Never,
            _ => Said::Open,
        }
    }
}

/// The words behind the name of rIC3.
const RIC3: [&str; 2] = ["-e", "ic3"];

/// An AIGER file with one bad signal of another.
///
/// # Panics
///
/// If it is no AIGER file, or has no such signal.
pub fn one_of(file: &[u8], signal: usize) -> Vec<u8> {
    let mut lines = file.split(|b| *b == b'\n');
    let header = String::from_utf8_lossy(lines.next().expect("a header"));
    let mut numbers: Vec<&str> = header.split(' ').collect();
    let latches: usize = numbers[3].parse().expect("a number of latches");
    let bad = bad_signals(file);
    assert!(signal < bad, "no signal {signal}");
    numbers[6] = "1";
    let mut out = (numbers.join(" ") + "\n").into_bytes();
    for (i, line) in lines.enumerate() {
        let is_other = (latches..latches + bad).contains(&i) && i != latches + signal;
        if !is_other {
            out.extend_from_slice(line);
            out.push(b'\n');
        }
    }
    out.pop();
    out
}

/// The end of a search by Spin that visited all states.
#[derive(Clone, Debug, PartialEq)]
pub struct Searched {
    /// States.
    pub states: usize,
    /// Assertions that failed.
    pub errors: usize,
    /// Seconds of the search alone.
    pub seconds: f64,
    /// The output, with what the model itself has written.
    pub text: String,
}

/// Spin, with a C compiler.
#[derive(Clone, Debug)]
pub struct Spin(PathBuf);

impl Spin {
    /// The program, if it searches a small model; otherwise the skip is counted.
    pub fn find() -> Option<Spin> {
        let Some(spin) = in_path("spin").map(Spin) else {
            skip("spin missing");
            return None;
        };
        let small = "byte n; active proctype p() { do :: d_step { n < 5 -> n++ } :: n == 5 -> break od }\n";
        if spin.search(small, &[], 100, 10).is_ok_and(|s| s.errors == 0 && s.states > 5) {
            return Some(spin);
        }
        skip("spin does not work");
        None
    }

    /// Searches all states of a model, with these options of the C compiler and these bounds on the depth and the
    /// seconds.
    ///
    /// # Errors
    ///
    /// The output of Spin or the compiler where they fail; and where the search was cut: Spin says
    /// "errors: 0" there too.
    pub fn search(
        &self,
        model: &str,
        options: &[&str],
        depth: usize,
        seconds: u32,
    ) -> Result<Searched, String> {
        let folder = Scratch::new("spin");
        std::fs::write(folder.0.join("model.pml"), model).map_err(|e| e.to_string())?;
        run(Command::new(&self.0).args(["-a", "model.pml"]), &folder.0)?;
        let flags = ["-O1", "-w", "-DSAFETY", "-DNOREDUCE", "-o", "pan", "pan.c"];
        run(Command::new("cc").args(options).args(flags), &folder.0)?;
        // Every error is counted. A process that rests for ever is none.
        let mut search = Command::new("timeout");
        search.arg(seconds.to_string()).arg(folder.0.join("pan"));
        let table = if depth > 1 << 20 { "-w24" } else { "-w20" };
        search.arg(format!("-m{depth}")).args(["-c0", "-E", table]);
        let begun = Instant::now();
        let text = run(&mut search, &folder.0)?;
        let seconds = begun.elapsed().as_secs_f64();
        searched(&text).map(|found| Searched { seconds, ..found }).ok_or(text)
    }
}

fn searched(text: &str) -> Option<Searched> {
    if ["too small", "out of memory", "not completed", "max search depth"].iter().any(|w| text.contains(w)) {
        return None;
    }
    let number = |line: Option<&str>| line?.split_whitespace().next()?.parse().ok();
    let errors = number(text.split_once("errors: ").map(|(_, rest)| rest))?;
    let states = number(text.lines().find(|l| l.ends_with("states, stored")))?;
    Some(Searched { states, errors, seconds: 0.0, text: text.to_owned() })
}

/// The sequential tool of LTSmin that reads ETF.
#[derive(Clone, Debug)]
pub struct Ltsmin(PathBuf);

impl Ltsmin {
    /// The program, if it counts the states of a small model; otherwise the skip is counted.
    pub fn find() -> Option<Ltsmin> {
        let Some(ltsmin) = in_path("etf2lts-seq").map(Ltsmin) else {
            skip("LTSmin missing");
            return None;
        };
        let small = "begin state\na:t b:t\nend state\nbegin edge\nend edge\nbegin init\n0 0\nend init\n\
                     begin trans\n0/1 *\n1/2 *\nend trans\nbegin trans\n2/2 0/1\nend trans\n";
        if ltsmin.states(small, 10) == Ok(4) {
            return Some(ltsmin);
        }
        skip("LTSmin does not work");
        None
    }

    /// The number of states of a model in ETF, all visited in so many seconds.
    ///
    /// # Errors
    ///
    /// Its output where it does not count all.
    pub fn states(&self, model: &str, seconds: u32) -> Result<usize, String> {
        let folder = Scratch::new("ltsmin");
        std::fs::write(folder.0.join("model.etf"), model).map_err(|e| e.to_string())?;
        let mut command = Command::new("timeout");
        let text = run(command.arg(seconds.to_string()).arg(&self.0).arg("model.etf"), &folder.0)?;
        let line = text.lines().find_map(|l| l.split_once("state space ").map(|(_, rest)| rest));
        let count = line.and_then(|l| l.split_once(" states")?.0.rsplit(' ').next()?.parse().ok());
        count.ok_or(text)
    }
}

fn run(command: &mut Command, folder: &Path) -> Result<String, String> {
    let out = command.current_dir(folder).output().map_err(|e| e.to_string())?;
    let text = [out.stdout, out.stderr].map(|t| String::from_utf8_lossy(&t).into_owned()).concat();
    if out.status.success() { Ok(text) } else { Err(text) }
}

/// A program on the `PATH`.
fn in_path(name: &str) -> Option<PathBuf> {
    let path = std::env::var_os("PATH")?;
    std::env::split_paths(&path).map(|d| d.join(name)).find(|p| p.is_file())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_signal_of_a_file() {
        let file = b"aig 3 1 1 0 1 2 1\n7 4\n4\n6\n5\n\x01\n";
        assert_eq!(bad_signals(file), 2);
        assert_eq!(one_of(file, 0), b"aig 3 1 1 0 1 1 1\n7 4\n4\n5\n\x01\n");
        assert_eq!(one_of(file, 1), b"aig 3 1 1 0 1 1 1\n7 4\n6\n5\n\x01\n");
    }

    #[test]
    fn the_words_of_abc() {
        let text = "Output 1 was asserted in frame  0 ( 0) (solved 1 out of 3 outputs).\nOutput 2 was trivially \
                    asserted in frame  4 (solved)\nProperties:  All = 3. Proved = 1. Disproved = 2. Undecided = 0.";
        assert_eq!(said_by_abc(text, 3), [Said::Never, Said::Reached(1), Said::Reached(5)]);
        let cut = text.replace("Undecided = 0", "Undecided = 1");
        assert_eq!(said_by_abc(&cut, 3), [Said::Open, Said::Reached(1), Said::Reached(5)]);
    }

    #[test]
    fn a_search_that_is_cut_counts_nothing() {
        let text = "State-vector 20 byte, depth reached 11, errors: 2\n       12 states, stored\n";
        assert!(searched(text).is_some_and(|s| s.states == 12 && s.errors == 2));
        assert_eq!(searched(&format!("error: max search depth too small\n{text}")), None);
    }
}
