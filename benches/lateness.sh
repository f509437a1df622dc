#!/usr/bin/env bash
# How late the scans of a controller begin, beside cyclictest: at 1 ms and 10 ms, with nothing else at work and
# with twice as many busy processes as processors, with no page open and with a thousand.
#
#   benches/lateness.sh [SECONDS [PAGES]]      30 seconds each, 1000 pages: about nine minutes
#
# cyclictest has the same beside it as the scan: the same load, and for the pages a controller without priority
# that shows itself to as many. Needs the right to SCHED_FIFO (root), rt-tests and stress-ng of Debian, and a
# machine that does nothing else.
set -euo pipefail
cd "$(dirname "$0")/.."
seconds=${1:-30}
many=${2:-1000}
for tool in cyclictest stress-ng; do
  command -v "$tool" >/dev/null || { echo "lateness: skipped, $tool is missing"; exit 0; }
done
cargo build --release --quiet --package g7
cargo build --quiet --package g7-benches --bin crowd
g7=$(realpath "${CARGO_TARGET_DIR:-target}/release/g7")
crowd=$(realpath "${CARGO_TARGET_DIR:-target}/debug/crowd")
folder=$(mktemp -d)
stress= controller=
finish() {
  [ -z "$stress" ] || kill "$stress" 2>/dev/null || true
  [ -z "$controller" ] || kill "$controller" 2>/dev/null || true
  rm -rf "$folder"
}
trap finish EXIT
cp examples/bead-sorter/chart.g7 "$folder"
mkfifo "$folder/lines"
# Held open, so that the controller does not find its end.
exec 3<>"$folder/lines"

# start PERIOD [PRIORITY]: a controller that is served; waits for its address.
start() {
  printf '[controller]\nperiod = "%dms"\n%s\n' "$1" "${2:+priority = $2}" >"$folder/chart.io.toml"
  : >"$folder/address"
  XDG_STATE_HOME="$folder" "$g7" serve "$folder/chart.g7" --online --no-open --port 0 \
    <"$folder/lines" >"$folder/address" 2>"$folder/events" &
  controller=$!
  until [ -s "$folder/address" ]; do sleep 0.1; done
}

stop() {
  echo quit >&3
  wait "$controller" || true
  controller=
}

# watch PAGES: pages for the time of a measurement.
watch() {
  if [ "$1" -gt 0 ]; then
    "$crowd" "$(cat "$folder/address")" "$1" "$seconds" >>"$folder/pages"
  else
    sleep "$seconds"
  fi
}

# ours PERIOD PAGES: 50 %, 99 %, 99.9 %, most.
ours() {
  start "$1" 80
  watch "$2"
  stop
  sed -n 's/^scans were late: half of them \(.*\) us, 99 % \(.*\) us, 99.9 % \(.*\) us, all \(.*\) us.*/\1 \2 \3 \4/p' \
    "$folder/events"
}

# theirs PERIOD PAGES: the same of cyclictest.
theirs() {
  if [ "$2" -gt 0 ]; then
    start 10
    watch "$2" &
    local pages=$!
  fi
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
  if [ "$2" -gt 0 ]; then
    wait "$pages"
    stop
  fi
}

line() { printf '%-24s%9s%9s%9s%9s  |%9s%9s%9s%9s  |%7s\n' "$@"; }

line "us late" "g7: 50 %" "99 %" "99.9 %" "most" "cyc: 50 %" "99 %" "99.9 %" "most" "99.9 %"
for load in idle busy; do
  if [ "$load" = busy ]; then
    stress-ng --cpu $(($(nproc) * 2)) --quiet &
    stress=$!
  fi
  for pages in 0 "$many"; do
    for period in 1 10; do
      read -r -a g7s <<<"$(ours $period "$pages")"
      read -r -a cyc <<<"$(theirs $period "$pages")"
      ratio=$(awk -v a="${g7s[2]}" -v b="${cyc[2]}" 'BEGIN { printf "%.2f", (b > 0) ? a / b : 0 }')
      line "$load, $pages pages, $period ms" "${g7s[@]}" "${cyc[@]}" "$ratio"
    done
  done
done
sort "$folder/pages" | uniq -c
