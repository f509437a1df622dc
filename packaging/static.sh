#!/usr/bin/env bash
# Builds g7 for Linux without a system library, so that one file runs on any distribution:
# packaging/static.sh [x86_64|aarch64]. Prints the path of the program.
set -euo pipefail
cd "$(dirname "$0")/.."
machine=${1:-$(uname -m)}
case $machine in
  x86_64 | aarch64) target=$machine-unknown-linux-musl ;;
  *) echo "static: x86_64 or aarch64, not $machine" >&2; exit 2 ;;
esac
rustup target list --installed | grep -qx "$target" || rustup target add "$target" >&2
# The linker that comes with Rust links for other machines as well.
name=CARGO_TARGET_$(tr 'a-z-' 'A-Z_' <<<"$target")_LINKER
export "$name=rust-lld"
cargo build --release --quiet --locked --package g7 --target "$target" >&2
echo "${CARGO_TARGET_DIR:-target}/$target/release/g7"
