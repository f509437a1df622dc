#!/usr/bin/env bash
# Times a scan of G7 and, where an iec2c is on the PATH, of matiec's C, on the
# same charts. --quick leaves out matiec's large ones (gcc takes a minute each).
set -euo pipefail
cd "$(dirname "$0")/.."
exec cargo run --release --quiet --package g7-benches --bin scan -- "$@"
