"""Counts how `eng reduce` takes the decks of a folder. Usage: decks.py ENG FOLDER nastran|calculix|abaqus [TABLE]

ENG is the command. A deck counts if it has nodes, an element that carries stiffness, and a density or a mass. Each is reduced to its two
first modes with the supports of the deck, else without supports. TABLE gets a line for each deck. The counts are printed by reason,
in the form of the table of docs/validation.md. Included parts of other decks fail for the lack of the rest, and count.
"""

import collections
import os
import pathlib
import re
import subprocess
import sys
import tempfile

ENDINGS = {"nastran": {".bdf", ".dat", ".nas"}, "calculix": {".inp"}, "abaqus": {".inp"}}
LARGEST = 3_000_000  # bytes
SECONDS = 60

NASTRAN_ELEMENT = re.compile(r"^C(QUAD|TRIA|HEXA|TETRA|PENTA|PYRA|BAR|BEAM|ROD|TUBE|ONROD|SHEAR|BUSH|BEND)[0-9RD]*\b", re.M | re.I)
NASTRAN_MASS = re.compile(r"^(CONM|CMASS|NSM)", re.M | re.I)
KEYWORD_ELEMENT = re.compile(r"^\*ELEMENT\b.*TYPE\s*=\s*(C3D|S\d|B3|M3D|T3D)", re.M | re.I)
KEYWORD_MASS = re.compile(r"^\*(DENSITY|MASS)\b", re.M | re.I)

# the first that fits the error counts
REASONS = [
    ("contents that Eng does not read", "content"),
    ("a second superelement or part in one file", "second part"),
    ("freedoms without stiffness (Nastran's AUTOSPC holds them)", "no stiffness"),
    ("supports of the deck leave rigid motions, or a mechanism", "rigid motion"),
    ("supports of the deck leave rigid motions, or a mechanism", "without stiffness"),
    ("supports that move, change or belong to a later step", "changes a support"),
    ("parts that nothing connects", "nothing connects"),
    ("element types or variants of no public rule", "E0734"),
    ("no density", "no mass"),
    ("an included file is missing", "can't be opened"),
    ("a card or keyword that is wrong or refers to nothing", "E0730"),
    ("too few modes for two", "modes are requested"),
    ("longer than the limit of time", "TIMEOUT"),
]


def density(card: str) -> bool:
    """Whether a card MAT1 has a density."""
    if "," in card:
        fields = card.split(",")
    elif card[4:5] == "*":
        return True  # its density is on the next line
    else:
        fields = [card[i : i + 8] for i in range(0, 80, 8)]
    return len(fields) > 5 and fields[5].strip() not in {"", "0.", "0.0", "0", ".0"}


def counts(text: str, code: str) -> bool:
    """Whether a file is a structure with mass."""
    if code != "nastran":
        return bool(re.search(r"^\*NODE\b", text, re.M | re.I) and KEYWORD_ELEMENT.search(text) and KEYWORD_MASS.search(text))
    mass = NASTRAN_MASS.search(text) or any(density(card) for card in re.findall(r"^MAT1.*", text, re.M | re.I))
    return bool(re.search(r"^GRID", text, re.M | re.I) and NASTRAN_ELEMENT.search(text) and mass)


def reduced(
    eng: str, deck: pathlib.Path, code: str, modes: int, supports: bool, folder: pathlib.Path, rules: str = ""
) -> tuple[bool, str]:
    """Whether `eng reduce` refused a deck, and its answer. The model is written into the folder of the survey."""
    place = folder / "survey.eng"  # a model reads files of its own folder and below
    support = "support = deck" if supports else ""
    model = f"""model M {{
    gravity = [0, 0, 0] m/s^2
    flexible body {{
        mesh = {code}("{deck.relative_to(folder)}", units: m_kg_s)
        modes = normal({modes})
        damping = 1 %
        {support}
        {rules}
    }}
}}
analysis stand = assemble(M())
"""
    with tempfile.TemporaryDirectory() as cache:
        place.write_text(model)
        try:
            environment = dict(os.environ, ENG_CACHE=cache)
            run = subprocess.run([eng, "reduce", place], capture_output=True, text=True, timeout=SECONDS, env=environment)
        except subprocess.TimeoutExpired:
            return True, "TIMEOUT"
        finally:
            place.unlink()
        return run.returncode != 0, run.stdout + run.stderr


def answer(eng: str, deck: pathlib.Path, code: str, folder: pathlib.Path) -> str:
    """The error of a deck; empty if it is read."""
    failed, text = reduced(eng, deck, code, 2, True, folder)
    supports = "holds no freedom" not in text
    if not supports:
        failed, text = reduced(eng, deck, code, 2, False, folder)
    if failed and "modes are requested" in text:
        failed, text = reduced(eng, deck, code, 1, supports, folder)
    return text if failed else ""


def main() -> None:
    """Prints the counts of a folder."""
    eng, folder, code = sys.argv[1], pathlib.Path(sys.argv[2]).resolve(), sys.argv[3]
    table = open(sys.argv[4], "w") if len(sys.argv) > 4 else None
    reasons: collections.Counter = collections.Counter()
    contents: collections.Counter = collections.Counter()
    decks = 0
    for deck in sorted(folder.rglob("*")):
        if deck.suffix.lower() not in ENDINGS[code] or not deck.is_file() or deck.stat().st_size > LARGEST:
            continue
        if not counts(deck.read_text(errors="replace"), code):
            continue
        decks += 1
        text = answer(eng, deck, code, folder)
        found = re.search(r"error(?:\[E\d+\])?: .*", text)
        if not text:
            reason = "read"
        else:
            named = (reason for reason, words in REASONS if words in text)
            reason = next(named, "others")
        reasons[reason] += 1
        lost = re.findall(r"\d+ × (.*?) \(the first", text)
        contents.update(set(lost))
        if table:
            print(deck.relative_to(folder), reason, found.group(0) if found else "", lost, sep="\t", file=table, flush=True)
    print(f"{decks} decks\n")
    print("| answer | decks |\n| --- | --- |")
    for reason, count in reasons.most_common():
        print(f"| {reason} | {count} |")
    print("\ncontents: " + ", ".join(f"{name} {count}" for name, count in contents.most_common(25)))


if __name__ == "__main__":
    main()
