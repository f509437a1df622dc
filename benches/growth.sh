#!/usr/bin/env bash
# How parsing, checking, drawing and printing code grow with the document: the times at n and at
# 10 n and their ratio; about 10 is linear. With an argument only the rows that begin so.
set -euo pipefail
cd "$(dirname "$0")/.."
exec cargo run --release --quiet --package g7-benches --bin growth -- "$@"
