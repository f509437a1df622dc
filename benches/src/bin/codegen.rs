//! Measures one scan of generated C.
//!
//! Prints ns a scan (moving / idle) for the C of `g7 gen c`, and for matiec's C if `iec2c` is on
//! the `PATH`, with the ratio; both are compiled by gcc -O2. Checks first that both visit the same
//! situations.

use std::path::Path;
use std::process::Command;

use g7_benches::matiec::{self, LOOKED_AT, Measured};
use g7_benches::shape::Shape;
use g7_benches::tools::run;
use g7_codegen::{Language, Options, Style};
use g7_model::FileId;
use g7_peers::Matiec;

const HARNESS: &str = r#"
#include <stdio.h>
#include <time.h>
#include "chart.h"
static uint64_t ns(void) { struct timespec t; clock_gettime(CLOCK_MONOTONIC, &t);
  return (uint64_t)t.tv_sec * 1000000000u + (uint64_t)t.tv_nsec; }
static chart_state s;
static chart_outputs out;
static int64_t now;
static void tick(void) { now += 1000000; if (SCAN) { printf("fault\n"); } }
int main(void) {
  chart_init(&s);
  uint64_t h = 14695981039346656037u;
  if (FIRST) { s.inputs.go = false; tick(); }
  s.inputs.go = true;
  for (int k = 0; k < LOOKED_AT; k++) {
    tick();
    for (uint32_t i = 0; i < STEPS; i++) if (chart_is_active(&s, i)) { h ^= (uint64_t)i; h *= 1099511628211u; }
    h ^= 0xffff; h *= 1099511628211u;
  }
  double best[2];
  for (int go = 1; go >= 0; go--) {
    s.inputs.go = go; best[go] = 1e18;
    for (int r = 0; r < 9; r++) {
      uint64_t a = ns();
      for (int k = 0; k < SCANS; k++) tick();
      double t = (double)(ns() - a) / SCANS;
      if (t < best[go]) best[go] = t;
    }
  }
  printf("%.3f %.3f %llu\n", best[1], best[0], (unsigned long long)h);
  return 0;
}
"#;

/// One scan on the inputs and outputs of the state.
const IN_PLACE: &str = "((void)out, chart_scan_in_place(&s, now))";
/// One scan that copies them.
const COPIED: &str = "(chart_scan(&s.inputs, &out, &s, now))";

fn main() {
    let quick = std::env::args().any(|a| a == "--quick");
    let flat = std::env::args().any(|a| a == "--flat");
    let copied = std::env::args().any(|a| a == "--copied");
    let style = if flat { Style::Flat } else { Style::Structured };
    let peer = Matiec::find();
    if peer.is_none() {
        println!("matiec: skipped, no iec2c on the PATH");
    }
    println!(
        "{:<16}{:>22}{:>24}{:>18}",
        "ns a scan", "g7 gen c moving / idle", "matiec moving / idle", "ratio"
    );
    let small =
        [Shape::Linear(10), Shape::Linear(100), Shape::Par(100), Shape::Alt(100), Shape::AndFork(100)];
    let large = [Shape::Linear(1000), Shape::Par(1000), Shape::Alt(1000), Shape::AndFork(1000)];
    let folder = std::env::temp_dir().join(format!("g7-gen-{}", std::process::id()));
    for shape in small.into_iter().chain(large.into_iter().filter(|_| !quick)) {
        let place = folder.join(shape.name().replace(' ', "-"));
        let ours = match ours(&place.join("g7"), shape, style, copied) {
            Ok(m) => m,
            Err(why) => {
                println!("{:<16}  {why}", shape.name());
                continue;
            }
        };
        let mut line =
            format!("{:<16}{:>22}", shape.name(), format!("{:.1} / {:.1}", ours.moving, ours.idle));
        match peer.as_ref().map(|peer| matiec::measure(peer, &place.join("matiec"), shape)) {
            None => {}
            Some(Ok(m)) if m.digest != ours.digest => line.push_str("  NOT COMPARABLE: other situations"),
            Some(Ok(m)) => line.push_str(&format!(
                "{:>24}{:>18}",
                format!("{:.0} / {:.0}", m.moving, m.idle),
                format!("{:.0} / {:.0}", m.moving / ours.moving, m.idle / ours.idle)
            )),
            Some(Err(why)) => line.push_str(&format!("  {}", why.lines().next().unwrap_or(""))),
        }
        println!("{line}");
    }
    let _ = std::fs::remove_dir_all(&folder);
}

/// Generates, compiles and times one chart in a folder of its own.
fn ours(folder: &Path, shape: Shape, style: Style, copied: bool) -> Result<Measured, String> {
    let text = shape.g7();
    let (doc, _) = g7_syntax::parse(&text, FileId(0));
    let (compiled, problems) = g7_compile::compile(&doc);
    let compiled = compiled.ok_or_else(|| format!("{problems:?}"))?;
    let options =
        Options { language: Language::C, style, room: Default::default(), name: "chart", source: &text };
    let printed = g7_codegen::print(&compiled, &options).map_err(|p| format!("{p:?}"))?;
    let io = |e: std::io::Error| e.to_string();
    std::fs::create_dir_all(folder).map_err(io)?;
    for file in &printed.files {
        std::fs::write(folder.join(&file.name), &file.text).map_err(io)?;
    }
    let scans = 4_000_000 / (1 + shape.steps() / 100).min(400);
    let harness = HARNESS
        .replace("LOOKED_AT", &LOOKED_AT.to_string())
        .replace("SCANS", &scans.to_string())
        .replace("(SCAN)", if copied { COPIED } else { IN_PLACE })
        .replace("STEPS", &shape.steps().to_string())
        .replace("FIRST", if shape.forks() { "1" } else { "0" });
    std::fs::write(folder.join("main.c"), harness).map_err(io)?;
    run(Command::new("gcc").args(["-O2", "-o", "chart", "main.c", "chart.c"]).current_dir(folder))?;
    let out = run(&mut Command::new(folder.join("chart")))?;
    let mut words = out.split_whitespace();
    let mut number = || words.next().and_then(|w| w.parse::<f64>().ok());
    let (moving, idle) = number().zip(number()).ok_or("the timer printed nothing")?;
    let digest = out.split_whitespace().nth(2).and_then(|w| w.parse().ok()).ok_or("no digest")?;
    Ok(Measured { moving, idle, digest })
}
