"""Neovim as a client of `eng lsp`. Usage: neovim.py ENG NVIM FOLDER

The configuration is the one that docs/editor.md shows. Neovim opens a text with an unknown unit and a line out of form. It must show
the message at the unit, take the change that the message proposes, and format: then the file has the text of the example.
"""

import os
import pathlib
import re
import subprocess
import sys

root = pathlib.Path(__file__).parent.parent
RIGHT = "    param begin: Angle = 60 deg\n"
WRONG = "  param begin :Angle=60 degg\n"


def main() -> None:
    eng, nvim, folder = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2], pathlib.Path(sys.argv[3]).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    blocks = re.findall(r"^```lua\n(.*?)^```$", (root / "docs/editor.md").read_text(), re.M | re.S)
    assert len(blocks) == 1, blocks
    (folder / "init.lua").write_text(blocks[0])
    text = (root / "examples/swing/swing.eng").read_text()
    assert text.count(RIGHT) == 1
    model = folder / "swing.eng"
    model.write_text(text.replace(RIGHT, WRONG))
    # neither settings nor state of this user
    own = {f"XDG_{kind}_HOME": str(folder / kind.lower()) for kind in ("CONFIG", "DATA", "STATE", "CACHE")}
    path = f"{eng.parent}{os.pathsep}{os.environ['PATH']}"
    words = [nvim, "--headless", "-i", "NONE", "-u", "init.lua", "swing.eng", "-c", f"luafile {root / '.ci/neovim.lua'}"]
    done = subprocess.run(words, cwd=folder, env={**os.environ, **own, "PATH": path}, capture_output=True, text=True, timeout=1500)
    if done.returncode != 0:
        sys.exit(f"Neovim ended with {done.returncode}\n{done.stderr}")
    assert model.read_text() == text, model.read_text()
    print("Neovim: a message, its change, and the form of the text")


main()
