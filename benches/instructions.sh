#!/usr/bin/env bash
# Counts the instructions of a scan in each row of features, moving and waiting, with callgrind, and
# compares them with the table that is kept in benches/instructions.tsv. Instructions, unlike times,
# are the same on a loaded machine. --write replaces the table. Rows of 10000 steps are left out: a
# scan of them costs what one of 1000 steps costs, but the compiler runs under callgrind as well.
set -euo pipefail
cd "$(dirname "$0")/.."
command -v valgrind >/dev/null || { echo "instructions: skipped, valgrind is missing"; exit 0; }
scans=500
# callgrind finds the function by its symbol.
export CARGO_PROFILE_RELEASE_STRIP=none
cargo build --release --quiet --package g7-benches --bin rows
rows=${CARGO_TARGET_DIR:-target}/release/rows
table=benches/instructions.tsv
new=$(mktemp)
trap 'rm -f "$new"' EXIT

count() {
  valgrind --tool=callgrind --callgrind-out-file=/dev/null '--toggle-collect=*measured*' \
    "$rows" --run "$1" "$2" $scans 2>&1 | sed -n 's/.*Collected : //p' |
    awk -v scans=$scans '$1 > 0 { printf "%.1f", $1 / scans; seen = 1 }
      END { if (!seen) { print "instructions: nothing was counted" >"/dev/stderr"; exit 1 } }'
}

"$rows" --list | grep -v ' 10000' | while IFS= read -r row; do
  printf '%s\t%s\t%s\n' "$row" "$(count "$row" moving)" "$(count "$row" waiting)"
done >"$new"

if [ "${1:-}" = --write ]; then
  cat "$new" >"$table"
  exit
fi
awk -F'\t' '
  NR == FNR { moving[$1] = $2; waiting[$1] = $3; next }
  function shown(old, now) { return old > 0 ? sprintf("%9.1f %+6.1f %%", now, 100 * (now - old) / old) : sprintf("%9.1f      new", now) }
  { printf "%-36s %s %s\n", $1, shown(moving[$1], $2), shown(waiting[$1], $3) }
' "$table" "$new"
