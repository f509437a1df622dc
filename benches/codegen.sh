#!/usr/bin/env bash
# Times a scan of the C that `g7 gen c` prints and, where an iec2c is on the PATH,
# of matiec's C, on the same charts, both by gcc -O2. --quick leaves out the large ones,
# --flat takes the flat style, --copied the scan that copies inputs and outputs.
set -euo pipefail
cd "$(dirname "$0")/.."
exec cargo run --quiet --package g7-benches --bin codegen -- "$@"
