#!/bin/sh
# The extension of Zed in a folder of its own. Zed takes a grammar from a repository of git, so one is made of the
# grammar and its parser.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
out=$1
rm -rf "$out"
mkdir -p "$out/grammar"
cp -r "$here" "$out/g7"
cp -r "$here/../tree-sitter-g7/." "$out/grammar"
rm -f "$out/grammar/.gitignore"
cd "$out/grammar"
git init --quiet
git add --all
git -c user.name=g7 -c user.email=g7@localhost commit --quiet --message "The grammar of .g7"
printf '\n[grammars.g7]\nrepository = "file://%s"\nrev = "%s"\n' "$out/grammar" "$(git rev-parse HEAD)" >>"$out/g7/extension.toml"
echo "$out/g7"
