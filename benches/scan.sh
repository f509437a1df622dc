#!/usr/bin/env bash
# Times a scan: of G7 and, where an iec2c is on the PATH, of matiec's C on the same charts; of each row
# of features beside a loop in C over the active steps; of a machine of many drives; of the C that `g7 gen c` prints in both styles.
# --quick leaves out the large charts of other compilers (gcc takes minutes).
set -euo pipefail
cd "$(dirname "$0")/.."
run() { cargo run --release --quiet --package g7-benches --bin "$@"; }
run scan -- "$@"
echo
run drives
echo
benches/rows.sh
for style in "" --flat; do
  echo -e "\nC of \`g7 gen c\` ${style#--}"
  run codegen -- $style "$@"
done
