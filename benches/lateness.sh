#!/usr/bin/env bash
# How late the scans of `g7 run --online` begin, beside cyclictest, each for so many seconds in turn (20),
# at 1 ms and 10 ms, with nothing else at work and with twice as many busy processes as processors.
# Needs the right to SCHED_FIFO (root), and rt-tests and stress-ng of Debian.
set -euo pipefail
cd "$(dirname "$0")/.."
seconds=${1:-20}
for tool in cyclictest stress-ng; do
  command -v "$tool" >/dev/null || { echo "lateness: skipped, $tool is missing"; exit 0; }
done
cargo build --release --quiet --package g7
g7=$(realpath "${CARGO_TARGET_DIR:-target}/release/g7")
folder=$(mktemp -d)
stress=
finish() {
  [ -z "$stress" ] || kill "$stress" 2>/dev/null || true
  rm -rf "$folder"
}
trap finish EXIT
cp examples/bead-sorter/chart.g7 "$folder"

ours() {
  printf '[controller]\nperiod = "%dms"\npriority = 80\n' "$1" >"$folder/chart.io.toml"
  "$g7" run "$folder/chart.g7" --online --for "${seconds}s" </dev/null 2>&1 |
    sed -n 's/^scans were late: half of them \(.*\) us, 99 % \(.*\) us, 99.9 % \(.*\) us, all \(.*\) us.*/\1 \2 \3 \4/p'
}

theirs() {
  cyclictest --mlockall --priority=80 --threads=1 --interval=$(($1 * 1000)) --duration="$seconds" \
    --histogram=100000 --quiet |
    awk '/^[0-9]/ { count[$1 + 0] += $2; all += $2; if ($2 > 0) most = $1 + 0 }
      END {
        split("0.5 0.99 0.999", shares, " ")
        for (k = 1; k <= 3; k++) {
          sum = 0
          for (us = 0; us <= most; us++) { sum += count[us]; if (sum >= shares[k] * all) break }
          printf "%d ", us
        }
        print most
      }'
}

row() { printf '%-34s%10s%10s%10s%10s\n' "$@"; }

row "us late" "50 %" "99 %" "99.9 %" "most"
for load in idle busy; do
  if [ "$load" = busy ]; then
    stress-ng --cpu $(($(nproc) * 2)) --quiet &
    stress=$!
  fi
  for period in 1 10; do
    for round in 1 2; do
      # shellcheck disable=SC2046 # four numbers
      row "$load, $period ms, round $round: g7" $(ours $period)
      # shellcheck disable=SC2046
      row "$load, $period ms, round $round: cyclictest" $(theirs $period)
    done
  done
done
