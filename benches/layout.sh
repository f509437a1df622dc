#!/usr/bin/env bash
# Times the layout of random charts; --quick takes two sizes only.
set -euo pipefail
cd "$(dirname "$0")/.."
exec cargo run --release --quiet --package g7-benches --bin layout -- "$@"
