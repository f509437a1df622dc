//! Measures matiec: the compiler from the `PATH`; its C is compiled by `gcc -O2` and timed by a
//! small C program of ours.

use std::path::Path;
use std::process::Command;

use g7_peers::Matiec;

use crate::shape::Shape;
use crate::tools::run;

/// The results for one program: ns a scan, and the situations it visited.
#[derive(Clone, Debug)]
pub struct Measured {
    /// Time of a scan in which every active step moves, in ns.
    pub moving: f64,
    /// Time of a scan in which no transition clears, in ns.
    pub idle: f64,
    /// A digest of the situations of the first scans.
    pub digest: u64,
}

/// Number of scans whose situations are part of the digest.
pub const LOOKED_AT: usize = 40;

const HARNESS: &str = r#"
#include <stdio.h>
#include <stdint.h>
#include <time.h>
#include "POUS.h"
TIME __CURRENT_TIME;
BOOL __DEBUG = 0;
#include "POUS.c"
static uint64_t ns(void) { struct timespec t; clock_gettime(CLOCK_MONOTONIC, &t);
  return (uint64_t)t.tv_sec * 1000000000u + (uint64_t)t.tv_nsec; }
static void tick(CHART *c) {
  __CURRENT_TIME.tv_nsec += 1000000;
  if (__CURRENT_TIME.tv_nsec >= 1000000000) { __CURRENT_TIME.tv_sec++; __CURRENT_TIME.tv_nsec -= 1000000000; }
  CHART_body__(c); }
static CHART c;
int main(void) {
  CHART_init__(&c, 0);
  int first = FIRST;
  uint64_t h = 14695981039346656037u;
  if (first) { c.GO.value = 0; tick(&c); }
  c.GO.value = 1;
  for (int k = 0; k < LOOKED_AT; k++) {
    tick(&c);
    for (int i = first; i < c.__nb_steps; i++) if (c.__step_list[i].X.value) { h ^= (uint64_t)(i - first); h *= 1099511628211u; }
    h ^= 0xffff; h *= 1099511628211u;
  }
  double best[2];
  for (int go = 1; go >= 0; go--) {
    c.GO.value = go; best[go] = 1e18;
    for (int r = 0; r < 7; r++) {
      uint64_t a = ns();
      for (int k = 0; k < SCANS; k++) tick(&c);
      double t = (double)(ns() - a) / SCANS;
      if (t < best[go]) best[go] = t;
    }
  }
  printf("%.3f %.3f %llu\n", best[1], best[0], (unsigned long long)h);
  return 0;
}
"#;

/// Generates, compiles and times one chart in a folder of its own.
///
/// # Errors
///
/// The message of a tool that failed.
pub fn measure(matiec: &Matiec, folder: &Path, shape: Shape) -> Result<Measured, String> {
    let io = |e: std::io::Error| e.to_string();
    std::fs::create_dir_all(folder).map_err(io)?;
    std::fs::write(folder.join("chart.st"), shape.st()).map_err(io)?;
    let scans = 20_000_000 / (shape.steps() * 20).max(1);
    let harness = HARNESS
        .replace("LOOKED_AT", &LOOKED_AT.to_string())
        .replace("SCANS", &scans.max(1000).to_string())
        .replace("FIRST", if shape.forks() { "1" } else { "0" });
    std::fs::write(folder.join("main.c"), harness).map_err(io)?;
    run(&mut matiec.translate(folder, "chart.st"))?;
    run(Command::new("gcc")
        .args(["-O2", "-w", "-o", "chart", "main.c", "-I"])
        .arg(matiec.lib.join("C"))
        .args(["-lrt", "-lm"])
        .current_dir(folder))?;
    let out = run(Command::new(folder.join("chart")).current_dir(folder))?;
    let mut words = out.split_whitespace();
    let mut number = || words.next().and_then(|w| w.parse::<f64>().ok());
    let (moving, idle) = number().zip(number()).ok_or("the timer printed nothing")?;
    let digest = out.split_whitespace().nth(2).and_then(|w| w.parse().ok()).ok_or("no digest")?;
    Ok(Measured { moving, idle, digest })
}
