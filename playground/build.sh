#!/usr/bin/env bash
# Builds the page: `playground/build.sh [FOLDER]`. The folder (playground/site if none is given) then has all files of the page, and any
# server of static files can serve it. It needs Node and npm; the compiler is that of toolchain.sh.
set -euo pipefail
here="$(cd "$(dirname "$0")" && pwd)"
out="${1:-$here/site}"
mkdir -p "$out"
out="$(cd "$out" && pwd)"
cd "$here"
work="${CARGO_TARGET_DIR:-$PWD/../target}/playground"
mkdir -p "$work"
target="wasm32-unknown-unknown"

# in a subshell: the settings are those of this build alone
(
    STANDARD_LIBRARY=""
    settings="$(./toolchain.sh "$work/compiler")"
    eval "$settings"
    # 16 MB of stack, as the nesting of texts needs it; it lies below all data, so that an overflow stops the module
    flags="${CARGO_ENCODED_RUSTFLAGS:+$CARGO_ENCODED_RUSTFLAGS$'\x1f'}-Clink-arg=-zstack-size=16777216"
    CARGO_ENCODED_RUSTFLAGS="$flags" CARGO_TARGET_DIR="$work/target" cargo rustc ${STANDARD_LIBRARY:+"$STANDARD_LIBRARY"} --locked --profile playground --target "$target" \
        --package eng-playground --lib --crate-type cdylib
)
cp "$work/target/$target/playground/eng_playground.wasm" "$out/eng.wasm"

# with the versions of package-lock.json, in a folder of its own
mkdir -p "$work/page"
cp -r page/. package.json package-lock.json "$work/page/"
cp ../editors/vscode/syntaxes/eng.tmLanguage.json "$work/page/"
(cd "$work/page" && npm ci --no-audit --no-fund --silent)
node examples.js > "$work/page/examples.json"
(
    cd "$work/page"
    for entry in page.js worker.js; do
        node_modules/.bin/esbuild "$entry" --bundle --minify --format=esm --target=es2022 --outfile="$out/$entry" --log-level=warning
    done
)
cp page/index.html page/style.css "$out/"
(cd "$out" && for file in *; do printf '%9d bytes, %9d compressed: %s\n' "$(wc -c <"$file")" "$(gzip -9 <"$file" | wc -c)" "$file"; done)
