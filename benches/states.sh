#!/usr/bin/env bash
# Times the successors of a state, cloned and restored.
set -euo pipefail
cd "$(dirname "$0")/.."
exec cargo run --release --quiet --package g7-benches --bin states -- "$@"
