#!/usr/bin/env bash
# Times a scan in each row of features, beside a loop in C over the active steps. With an argument
# only the rows whose name begins so: benches/rows.sh 'par'
set -euo pipefail
cd "$(dirname "$0")/.."
exec cargo run --release --quiet --package g7-benches --bin rows -- "$@"
