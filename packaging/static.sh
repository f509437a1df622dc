#!/usr/bin/env bash
# Builds g7 for Linux without a system library, so that one file runs on any distribution:
# packaging/static.sh [x86_64|aarch64]. Prints the path of the program.
set -euo pipefail
cd "$(dirname "$0")/.."
machine=${1:-$(uname -m)}
target=$(packaging/target.sh "$machine")
rustup target list --installed | grep -qx "$target" || rustup target add "$target" >&2
folder=$PWD/${CARGO_TARGET_DIR:-target}/zig
case ${CARGO_TARGET_DIR:-} in /*) folder=$CARGO_TARGET_DIR/zig ;; esac
# The linker that comes with Rust links for other machines as well.
name=$(tr 'a-z-' 'A-Z_' <<<"$target")
export "CARGO_TARGET_${name}_LINKER=rust-lld"
# SQLite and the ciphers of TLS are C: zig, a package of Python, has a C compiler and musl's headers for
# each machine.
if [ ! -x "$folder/bin/python" ] || ! "$folder/bin/python" -m ziglang version >/dev/null 2>&1; then
  python3 -m venv "$folder" && "$folder/bin/pip" install --quiet 'ziglang==0.17.*' >&2 ||
    { echo "static: zig cannot be installed: python3 with venv, and its packages, are needed" >&2; exit 1; }
fi
for tool in cc ar; do
  cat >"$folder/$machine-$tool" <<SCRIPT
#!/usr/bin/env bash
# The machine is named as zig names it. Checks of undefined behaviour would want a library.
[ $tool = cc ] || exec "$folder/bin/python" -m ziglang ar "\$@"
for word; do
  shift
  case \$word in --target=*) ;; *) set -- "\$@" "\$word" ;; esac
done
exec "$folder/bin/python" -m ziglang cc -target $machine-linux-musl -fno-sanitize=undefined "\$@"
SCRIPT
  chmod +x "$folder/$machine-$tool"
done
export "CC_${target//-/_}=$folder/$machine-cc" "AR_${target//-/_}=$folder/$machine-ar"
# Whoever has the program cannot build it anew, so it has the devices that are features of the build.
cargo build --release --quiet --locked --package g7 --features s7,gpio --target "$target" >&2
echo "${CARGO_TARGET_DIR:-target}/$target/release/g7"
