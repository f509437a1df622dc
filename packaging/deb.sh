#!/usr/bin/env bash
# Makes a Debian package of the static program, with manual pages, completions and examples:
# packaging/deb.sh [x86_64|aarch64]. Prints the path of the package.
set -euo pipefail
cd "$(dirname "$0")/.."
machine=${1:-$(uname -m)}
target=$(packaging/target.sh "$machine")
case $target in
  aarch64-*) architecture=arm64 ;;
  *) architecture=amd64 ;;
esac
program=$(packaging/static.sh "$machine")
version=$(sed -n '/^\[workspace.package\]/,/^$/s/^version = "\(.*\)"/\1/p' Cargo.toml)
out=${CARGO_TARGET_DIR:-target}/deb
tree=$out/g7_${version}_$architecture
rm -rf "$tree"
install -D -m 755 "$program" "$tree/usr/bin/g7"

# The pages and completions are the same on all machines; the program of this one prints them.
own=$program
[ "$machine" = "$(uname -m)" ] || own=$(packaging/static.sh)
install -d "$tree/usr/share/man/man1" "$tree/usr/share/bash-completion/completions" \
  "$tree/usr/share/zsh/vendor-completions" "$tree/usr/share/fish/vendor_completions.d" "$tree/usr/share/doc/g7"
"$own" man --out "$tree/usr/share/man/man1" >/dev/null
gzip -9n "$tree"/usr/share/man/man1/*
"$own" completions bash >"$tree/usr/share/bash-completion/completions/g7"
"$own" completions zsh >"$tree/usr/share/zsh/vendor-completions/_g7"
"$own" completions fish >"$tree/usr/share/fish/vendor_completions.d/g7.fish"
# What it is built of, for whoever looks for known weaknesses.
cp "${CARGO_TARGET_DIR:-target}/sbom/g7.cdx.json" "${CARGO_TARGET_DIR:-target}/sbom/page.cdx.json" "$tree/usr/share/doc/g7/"
cp -r examples "$tree/usr/share/doc/g7/examples"
gzip -9n <CHANGELOG.md >"$tree/usr/share/doc/g7/changelog.gz"
{
  echo "Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/"
  echo "Upstream-Name: G7"
  echo
  echo "Files: *"
  echo "Copyright: 2026 The G7 authors"
  echo "License: MIT or Apache-2.0"
} >"$tree/usr/share/doc/g7/copyright"
# Files of other owners or for the group alone have no place in a package.
find "$tree" -type d -exec chmod 755 {} + && find "$tree/usr/share" -type f -exec chmod 644 {} +

install -d "$tree/DEBIAN"
cat >"$tree/DEBIAN/control" <<CONTROL
Package: g7
Version: $version
Architecture: $architecture
Maintainer: The G7 authors <g7@localhost>
Installed-Size: $(du -ks --exclude=DEBIAN "$tree" | cut -f1)
Section: science
Priority: optional
Description: GRAFCET and SFC: draw, run, prove, deploy
 Charts of IEC 60848 and IEC 61131-3, as text or drawn in the browser, run against
 simulated plants or real inputs and outputs, tested, and printed as code for PLCs.
CONTROL
dpkg-deb --root-owner-group --build "$tree" "$tree.deb" >&2
echo "$tree.deb"
