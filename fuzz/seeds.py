"""Writes seeds for the target `readers`. Usage: seeds.py FOLDER

A changed byte of a packed file only breaks its packing. So each file of the tests' data is unpacked here. Files of more than 20 kB
are left out: a run tries few changes of them. Most small decks are texts inside of the tests, so their texts of two lines and more are
seeds, too.
"""

import ast
import gzip
import hashlib
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).parent.parent
LARGEST = 20_000  # bytes
FOLDERS = ["flexible/tests/data", "tests/mesh", "tests/diagnostics/mesh", "fuzz/artifacts/readers"]
TEXT = re.compile(r'r(#+)"(.*?)"\1|"((?:[^"\\]|\\.)*)"', re.S)


def plain(text: str) -> str:
    """The text of a literal of Rust without its escapes."""
    text = re.sub(r"\\\n\s*", "", text)  # the literal goes on in the next line
    text = re.sub(r"\\u\{(\w+)\}", lambda found: chr(int(found[1], 16)), text)
    try:
        return ast.literal_eval('"""' + text.replace('"""', '\\"\\"\\"') + '"""')
    except (SyntaxError, ValueError):
        return text


def main(folder: pathlib.Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    seeds: set[bytes] = set()
    for place in FOLDERS:
        for path in (ROOT / place).rglob("*"):
            if path.is_file() and path.suffix not in {".md", ".py", ".json", ".eng", ".txt"}:
                content = path.read_bytes()
                seeds.add(gzip.decompress(content) if path.suffix == ".gz" else content)
    for path in [*(ROOT / "flexible").rglob("*.rs"), *(ROOT / "tests").glob("*.rs")]:
        for found in TEXT.finditer(path.read_text()):
            text = found[2] or plain(found[3] or "")
            if text.count("\n") > 1 or text.startswith(("GRID", "*")):
                seeds.add(text.encode())
    seeds = {seed for seed in seeds if len(seed) <= LARGEST}
    for seed in seeds:
        (folder / hashlib.sha1(seed).hexdigest()).write_bytes(seed)
    print(len(seeds), "seeds")


main(pathlib.Path(sys.argv[1]))
