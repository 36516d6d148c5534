#!/usr/bin/env bash
# Installs what the tests of pages and files check with, as far as it can be had: Chromium, the Khronos glTF
# validator, axe-core, the engine of colours and the packager of Visual Studio Code, meshio, VTK.
# Prints the variables that point tests there; what cannot be installed is said on the error output, and its tests skip.
# Usage: eval "$(report/tests/install-tools.sh FOLDER)"
set -uo pipefail
folder="${1:?the folder to install into}"
mkdir -p "$folder"
folder="$(cd "$folder" && pwd)"
say() { printf '%s\n' "$*" >&2; }

if ! command -v chromium >/dev/null && ! command -v google-chrome >/dev/null; then
    if command -v apt-get >/dev/null && [ "$(id -u)" = 0 ]; then
        { apt-get update && apt-get install -y --no-install-recommends chromium fonts-dejavu-core; } >"$folder/apt.log" 2>&1 ||
            say "Chromium could not be installed, see $folder/apt.log"
    else
        say "Chromium is missing, and there is no way to install it"
    fi
fi

if command -v npm >/dev/null; then
    for package in gltf-validator axe-core vscode-tmgrammar-test @vscode/vsce@3; do
        # its folder has no version in its name
        [ -d "$folder/node_modules/${package%@[0-9]*}" ] ||
            npm install --silent --no-audit --no-fund --prefix "$folder" "$package" >>"$folder/npm.log" 2>&1 ||
            say "$package could not be installed, see $folder/npm.log"
    done
    printf 'export NODE_PATH=%q\n' "$folder/node_modules"
else
    say "npm is missing: no glTF validator, no axe-core, no test of colours, no package of the extension"
fi

if command -v python3 >/dev/null; then
    if [ ! -x "$folder/python/bin/python" ]; then
        python3 -m venv "$folder/python" >"$folder/venv.log" 2>&1 || say "no Python environment, see $folder/venv.log"
    fi
    if [ -x "$folder/python/bin/python" ]; then
        for package in meshio vtk; do
            "$folder/python/bin/python" -m pip install --quiet "$package" >>"$folder/pip.log" 2>&1 ||
                say "$package could not be installed, see $folder/pip.log"
        done
        printf 'export ENG_TEST_PYTHON=%q\n' "$folder/python/bin/python"
    fi
else
    say "Python is missing: no readers of VTK files"
fi
