#!/usr/bin/env bash
# Prints the target of Rust whose programs need no system library: packaging/target.sh [x86_64|aarch64].
set -euo pipefail
machine=${1:-$(uname -m)}
case $machine in
  x86_64 | aarch64) echo "$machine-unknown-linux-musl" ;;
  *) echo "packages are for x86_64 or aarch64, not $machine" >&2; exit 2 ;;
esac
