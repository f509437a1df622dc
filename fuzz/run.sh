#!/usr/bin/env bash
# Runs every fuzz target for so many seconds (default 60), on the stable toolchain.
set -euo pipefail
cd "$(dirname "$0")/.."
seconds=${1:-60}
mkdir -p fuzz/corpus/text fuzz/corpus/run fuzz/corpus/jgrafchart fuzz/corpus/xmi
for f in $(git ls-files 'examples/*.g7' 'tests/check/*.g7'); do
    cp "$f" "fuzz/corpus/text/$(echo "$f" | tr / _)"
    cp "$f" "fuzz/corpus/run/$(echo "$f" | tr / _)"
done
for f in $(git ls-files 'tests/interchange/jgrafchart/*.xml'); do
    cp "$f" "fuzz/corpus/jgrafchart/$(basename "$f")"
done
for f in $(git ls-files 'tests/interchange/xmi/*.grafcet'); do
    cp "$f" "fuzz/corpus/xmi/$(basename "$f")"
done
for target in text jgrafchart xmi run tables; do
    cargo fuzz run --sanitizer none "$target" -- -max_total_time="$seconds" -max_len=65536 -timeout=20 -verbosity=0
done
