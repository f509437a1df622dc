#!/usr/bin/env bash
# Runs every fuzz target for so many seconds (default 60), on the stable toolchain.
set -euo pipefail
cd "$(dirname "$0")/.."
seconds=${1:-60}
mkdir -p fuzz/corpus/{text,fmu,run,restore,jgrafchart,classicladder,controlexpert,s7graph,l5x,xmi,plcopen,iectext,edit,page,tree}
for f in $(git ls-files 'examples/*.g7' 'tests/check/*.g7'); do
    cp "$f" "fuzz/corpus/text/$(echo "$f" | tr / _)"
    cp "$f" "fuzz/corpus/run/$(echo "$f" | tr / _)"
    { cat "$f"; printf -- '----\n40 0 x\n90 1 \n60 5 {\\n\n200 0 \\n  step 9\n'; } > "fuzz/corpus/tree/$(echo "$f" | tr / _)"
    { cat "$f"; printf '\0\5\0\1\0\0\0\0\0\0\0'; } > "fuzz/corpus/restore/$(echo "$f" | tr / _)"
done
for f in $(git ls-files 'tests/interchange/iectext/*.st'); do
    cp "$f" "fuzz/corpus/iectext/$(basename "$f")"
done
for f in $(git ls-files 'tests/interchange/jgrafchart/*.xml'); do
    cp "$f" "fuzz/corpus/jgrafchart/$(basename "$f")"
done
for f in $(git ls-files 'tests/interchange/plcopen/*.xml'); do
    cp "$f" "fuzz/corpus/plcopen/$(basename "$f")"
done
for f in $(git ls-files 'tests/interchange/xmi/*.grafcet'); do
    cp "$f" "fuzz/corpus/xmi/$(basename "$f")"
done
for format in classicladder controlexpert s7graph l5x; do
    for f in $(git ls-files "tests/interchange/$format/*"); do
        cp "$f" "fuzz/corpus/$format/$(basename "$f")"
    done
done
# The cases of gestures, and stories of messages.
awk '
    /^## / { n++; blocks = 0 }
    /^```/ { kind = kind == "" ? substr($0, 4) : ""; if (kind == "g7") blocks++; next }
    kind == "g7" && blocks == 1 { text[n] = text[n] $0 "\n" }
    kind == "json" { said[n] = said[n] $0 "\n" }
    END { for (k = 1; k <= n; k++) printf "%s----\n%s", text[k], said[k] > "fuzz/corpus/edit/case-" k }
' tests/edit/*.md
cp fuzz/stories/* fuzz/corpus/page/
for target in text fmu jgrafchart classicladder controlexpert s7graph l5x xmi plcopen iectext run restore tables edit page tree; do
    cargo fuzz run --sanitizer none "$target" -- -max_total_time="$seconds" -max_len=65536 -timeout=20 -verbosity=0
done
