#!/usr/bin/env bash
# Lists what G7 is built of, as CycloneDX: the crates of the static program; the packages of its page, where
# tools that are not built in are marked as `development`.
# packaging/sbom.sh [x86_64|aarch64]. Prints the paths of the two lists.
set -euo pipefail
cd "$(dirname "$0")/.."
target=$(packaging/target.sh "${1:-}")
out=${CARGO_TARGET_DIR:-target}/sbom
mkdir -p "$out"
# Written beside each crate of the workspace; the one of the program lists all that it is made of.
cargo cyclonedx --quiet --quiet --manifest-path crates/g7/Cargo.toml --format json --spec-version 1.5 --no-build-deps \
  --features s7,gpio --target "$target" --override-filename sbom.cdx
# No path of this machine goes into the list.
sed "s|path+file://$PWD|path+file:///g7|g" crates/g7/sbom.cdx.json >"$out/g7.cdx.json"
find crates tests benches -name sbom.cdx.json -delete
(cd web && npm sbom --sbom-format cyclonedx --package-lock-only) >"$out/page.cdx.json"
echo "$out/g7.cdx.json"
echo "$out/page.cdx.json"
