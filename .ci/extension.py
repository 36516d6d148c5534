"""Packages the extension for Visual Studio Code as docs/editor.md shows, and looks into the package. Usage: extension.py VSCE FOLDER

VSCE is the command `vsce`, FOLDER gets a copy of the extension. The package must have the files of the extension, its client with all
that the client needs, their licences, and nothing else. From the unpacked package alone the extension must start. Visual Studio Code
itself is not there: a stand-in for its module answers `extension.js`, and finds no command, so the extension must offer to install one.
"""

import json
import pathlib
import re
import shutil
import subprocess
import sys
import zipfile

root = pathlib.Path(__file__).parent.parent
OWN = {
    "package.json",
    "readme.md",
    "extension.js",
    "find.js",
    "language-configuration.json",
    "snippets/eng.json",
    "syntaxes/eng.tmLanguage.json",
}
NEEDLESS = re.compile(r"\.(map|vsix|d\.[cm]?ts)$|(^|/)tests?/|package-lock\.json$")

STARTED = """
const Module = require("node:module");
const registered = [];
const words = [];
// what the client's classes inherit from, and values that nobody reads
const any = new Proxy(class {}, { get: (target, name) => (name in target ? target[name] : any) });
const known = {
    commands: { registerCommand: (name) => registered.push(name) },
    extensions: { getExtension: () => undefined },
    window: { showWarningMessage: async (text, ...choices) => void words.push(text, ...choices) },
    workspace: { getConfiguration: () => ({ get: () => "eng" }), workspaceFolders: undefined },
};
const load = Module._load;
Module._load = (name, ...rest) =>
    name === "vscode" ? new Proxy(known, { get: (target, name) => target[name] ?? any }) : load(name, ...rest);
process.env.PATH = "";
delete process.env.VIRTUAL_ENV;
const extension = require(process.argv[1]);
extension.activate({ subscriptions: [] }).then(() =>
    // the offer is made before any timer or input
    setImmediate(async () => {
        await extension.deactivate();
        console.log(JSON.stringify({ registered, words }));
    }));
"""


def run(words: list[str], where: pathlib.Path) -> str:
    done = subprocess.run(words, cwd=where, stdin=subprocess.DEVNULL, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(words)}\n{done.stdout}{done.stderr}")
    return done.stdout


def commands() -> list[str]:
    """The commands of the page."""
    page = (root / "docs/editor.md").read_text()
    block = re.search(r"^```console\ncd editors/vscode\n(.*?)^```$", page, re.M | re.S)
    assert block, "docs/editor.md shows no commands in the folder of the extension"
    return block.group(1).splitlines()


def named(value: object) -> set[str]:
    """The files that a package.json names."""
    if isinstance(value, dict):
        return set().union(*map(named, value.values()))
    if isinstance(value, list):
        return set().union(*map(named, value))
    return {value[2:]} if isinstance(value, str) and value.startswith("./") else set()


def manifests(folder: pathlib.Path, name: str) -> list[pathlib.Path]:
    """The descriptions of a package, one for each of its versions."""
    return sorted(folder.glob(f"**/node_modules/{name}/package.json"))


def needed(folder: pathlib.Path, package: dict[str, object]) -> set[str]:
    """The packages that a package needs, and those that they need."""
    found: set[str] = set()
    due = list(package["dependencies"])
    while due:
        name = due.pop()
        if name not in found:
            found.add(name)
            for manifest in manifests(folder, name):
                due += json.loads(manifest.read_text()).get("dependencies", {})
    return found


def main() -> None:
    vsce, folder = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    source = folder / "vscode"
    shutil.copytree(root / "editors/vscode", source, ignore=shutil.ignore_patterns("node_modules", "*.vsix", "package-lock.json"))
    install, package, use = commands()
    run(install.split() + ["--silent", "--no-audit", "--no-fund"], source)
    words = package.split()
    assert words[:2] == ["npx", "@vscode/vsce@3"], package
    run([str(vsce), *words[2:]], source)
    archive = source / use.split()[-1]
    assert use.split()[:2] == ["code", "--install-extension"] and archive.exists(), use

    with zipfile.ZipFile(archive) as packed:
        names = [name.removeprefix("extension/") for name in packed.namelist() if name.startswith("extension/")]
        packed.extractall(folder / "unpacked")
    unpacked = folder / "unpacked/extension"
    about = json.loads((unpacked / "package.json").read_text())
    assert {name for name in names if not name.startswith("node_modules/")} == OWN, names
    assert named(about) <= OWN, named(about)
    # directly below the folder of a package: its inner folders may have a package.json, too
    inside = re.compile(r"(?:.*/)?node_modules/((?:@[^/]+/)?[^/]+)/package\.json$")
    packages = {match.group(1) for name in names if (match := inside.match(name))}
    assert packages == needed(unpacked, about), packages
    for name in packages:
        for manifest in manifests(unpacked, name):
            assert any(path.name.lower().startswith("licen") for path in manifest.parent.iterdir()), f"no licence in {manifest.parent}"
    assert not (unwanted := [name for name in names if NEEDLESS.search(name)]), unwanted

    said = json.loads(run(["node", "-e", STARTED, str(unpacked)], folder))
    assert said["registered"] == ["eng.run", "eng.restart"], said
    assert "There is no command eng" in said["words"][0] and "pip install englang" in said["words"], said
    print(f"{archive.name}: {archive.stat().st_size // 1000} kB, {len(names)} files, {len(packages)} packages; it starts")


main()
