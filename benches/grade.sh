#!/usr/bin/env bash
# 200 submissions of the bead sorter's sequencing mode, graded by `g7 grade`, with the time. Four of five are the model solution under
# other names, the others the wrong solutions. G7 names the program.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
g7=${G7:-g7}
exercise=$root/exercises/bead-sorter
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
wrong=("$exercise"/wrong/*.g7)
for n in $(seq 200); do
  if ((n % 5)); then file=$exercise/model.g7; else file=${wrong[n / 5 % ${#wrong[@]}]}; fi
  # Only names of the author's: those that the exercise looks at stay.
  sed -e "s/Attempts/Tries$n/g" -e "s/\b\(Reset\|Settle\|Release\|Wait\|Detected\)\([1-6]\)\b/\1${n}_\2/g" "$file" >"$folder/student-$n.g7"
done
TIMEFORMAT='%R s for 200 submissions'
time { "$g7" grade "$exercise" "$folder" --csv "$folder/marks.csv" --jobs "${JOBS:-2}" >/dev/null || [ $? = 1 ]; }
cut -d, -f2 "$folder/marks.csv" | tail -n +2 | sort | uniq -c
