#!/usr/bin/env bash
# Prints the settings of a Rust compiler for WebAssembly, as lines for `eval`. The installed Rust is enough if it has the standard
# library of wasm32-unknown-unknown (`rustup target add wasm32-unknown-unknown`). Otherwise the compiler comes from the packages of
# Debian, unpacked into the folder that is given and not installed, and the build makes the standard library from its source.
set -euo pipefail
folder="${1:?the folder for the compiler}"
target="wasm32-unknown-unknown"
if [ -d "$(rustc --print sysroot)/lib/rustlib/$target/lib" ]; then
    exit 0
fi
mkdir -p "$folder/packages"
folder="$(cd "$folder" && pwd)"
root="$folder/root"
if [ ! -x "$root/usr/bin/wasm-ld-22" ]; then
    apt-get update --quiet=2 >&2
    # of several versions of rustc-web the newest is the candidate; its libraries have the same version
    version="$(apt-cache policy rustc-web | sed -n 's/ *Candidate: //p')"
    short="$(cut -d. -f1,2 <<<"$version")"
    (cd "$folder/packages" && apt-get download --quiet=2 --option APT::Sandbox::User=root \
        "rustc-web=$version" "libstd-rust-web-$short=$version" "libstd-rust-web-dev=$version" "rust-web-src=$version" libllvm22 lld-22 >&2)
    for package in "$folder"/packages/*.deb; do
        dpkg --extract "$package" "$root"
    done
fi
cat <<LINES
export RUSTC='$root/usr/bin/rustc'
export LD_LIBRARY_PATH='$root/usr/lib/x86_64-linux-gnu'
export CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER='$root/usr/bin/wasm-ld-22'
export CARGO_ENCODED_RUSTFLAGS='-Clinker-flavor=wasm-ld'
# for the option -Z, which a release of cargo does not take
export RUSTC_BOOTSTRAP=1
STANDARD_LIBRARY=-Zbuild-std=std,panic_abort
LINES
