#!/usr/bin/env bash
# Builds the page and tests it: the module under Node against the native command, and the page in Chromium. It is no part of `.ci/run`,
# because WebAssembly's standard library and the module take many minutes to build. `playground/test.sh [PICTURE]` also writes pictures
# of the page, PICTURE.png and others. ENG names a native command that is built already.
set -euo pipefail
cd "$(dirname "$0")"
root="$(realpath ..)"
picture="${1:-}"
picture="${picture:+$(realpath -m "$picture")}"
target="${CARGO_TARGET_DIR:-$PWD/../target}"
if [ -z "${ENG:-}" ]; then
    cargo build --release --locked --package eng --bin eng
    ENG="$target/release/eng"
fi
ENG="$(realpath "$ENG")"
if [ ! -x /usr/bin/chromium ]; then
    apt-get update --quiet=2
    apt-get install --yes --quiet=2 chromium
fi
./build.sh "$target/playground/site"
site="$(realpath "$target/playground/site")"
work="$(realpath "$target/playground")"
# the tests find the packages of the page
rm -rf "$work/test"
mkdir -p "$work/test/page"
cp -r tests "$work/test/tests"
cp page/*.js "$work/test/page/"
cp package.json "$work/test/"
ln -s "$work/page/node_modules" "$work/test/node_modules"
cd "$work/test/tests"
node node.js "$site" "$ENG" "$work/page/examples.json" "$root"
node browser.js "$site" "$picture"
