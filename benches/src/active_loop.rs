//! A loop in C over the active steps of a chart, by `gcc -O2`: the unit in which the costs of scans are
//! given, since machines differ.

use std::cell::RefCell;
use std::io::{BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

/// The loop as a process that waits for its next measurement.
#[derive(Debug)]
pub struct ActiveLoop {
    process: Child,
    pipes: RefCell<(ChildStdin, BufReader<ChildStdout>)>,
}

impl ActiveLoop {
    /// Compiles and starts it.
    ///
    /// # Errors
    ///
    /// A text where gcc is missing or fails.
    pub fn build() -> Result<ActiveLoop, String> {
        let folder = std::env::temp_dir().join(format!("g7-loop-{}", std::process::id()));
        std::fs::create_dir_all(&folder).map_err(|e| e.to_string())?;
        let program = folder.join("loop");
        std::fs::write(folder.join("loop.c"), include_str!("active_loop.c")).map_err(|e| e.to_string())?;
        let gcc = Command::new("gcc").args(["-O2", "-o", "loop", "loop.c"]).current_dir(&folder).status();
        let started = match gcc {
            Ok(status) if status.success() => {
                Command::new(&program).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn()
            }
            Ok(status) => return Err(format!("gcc: {status}")),
            Err(e) => return Err(format!("gcc: {e}")),
        };
        let mut process = started.map_err(|e| e.to_string())?;
        // The process keeps its file.
        let _ = std::fs::remove_dir_all(&folder);
        let (Some(input), Some(output)) = (process.stdin.take(), process.stdout.take()) else {
            return Err("the loop has no pipes".into());
        };
        Ok(ActiveLoop { process, pipes: RefCell::new((input, BufReader::new(output))) })
    }

    /// ns a scan, moving and waiting; endless where the process has ended.
    pub fn time(&self) -> (f64, f64) {
        let (input, output) = &mut *self.pipes.borrow_mut();
        let mut line = String::new();
        let asked =
            input.write_all(b"\n").and_then(|()| input.flush()).and_then(|()| output.read_line(&mut line));
        let mut numbers = line.split_whitespace().filter_map(|word| word.parse().ok());
        match (asked, numbers.next(), numbers.next()) {
            (Ok(_), Some(moving), Some(waiting)) => (moving, waiting),
            _ => (f64::INFINITY, f64::INFINITY),
        }
    }
}

impl Drop for ActiveLoop {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
