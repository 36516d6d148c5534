"""Compares the frequencies of CalculiX' decks with those that ccx computes. Usage: calculix.py ENG CCX FOLDER ELEMENT [TABLE]

ENG and CCX are the commands. Each deck of the folder with elements of the type ELEMENT (such as C3D20R) becomes a frequency deck: its model
as it is, with the supports of its first step, which hold where that step moves, and one step that asks for ten modes. Sections of pre-tension
are closed, as in Eng. A material without *DENSITY gets one. ccx computes it, and `eng reduce` with `element_rules = calculix` and the
supports of the deck gives as many frequencies.
If the supports hold nothing, or leave rigid motions, both compute the free body. Of a free body those below 1e-4 of the largest are rigid
motions. TABLE gets a line for each deck. The counts are printed by answer, then the differences above 1e-6 and the refusals.
"""

import collections
import pathlib
import re
import subprocess
import sys
import tempfile

from decks import LARGEST, SECONDS, reduced

LIMIT = 1e-6  # both codes print seven digits
RIGID = 1e-4
MODES = 10
RULES = "element_rules = calculix"
FREE = ("holds no freedom", "rigid motion")  # refusals of the supports alone
KEYWORD = re.compile(r"^\*(?!\*)\s*([A-Z][A-Z -]*?)\s*(?:,|$)", re.I)


def joined(deck: pathlib.Path) -> list[str]:
    """The lines of a deck with its included files, without comments."""
    lines: list[str] = []
    for line in deck.read_text(errors="replace").splitlines():
        include = re.match(r"^\*INCLUDE\s*,\s*INPUT\s*=\s*\"?([^\",\s]+)", line, re.I)
        if include and (deck.parent / include[1]).is_file():
            lines += joined(deck.parent / include[1])
        elif not line.startswith("**"):
            lines.append(line.rstrip())
    return lines


def blocks(lines: list[str]) -> list[list[str]]:
    """The keywords with their lines."""
    found: list[list[str]] = [[]]
    for line in lines:
        if line.startswith("*"):
            found.append([])
        if found[-1] or line.strip():
            found[-1].append(line)
    return [block for block in found if block]


def name(block: list[str]) -> str:
    """The keyword of a block, with single blanks."""
    keyword = KEYWORD.match(block[0])
    return " ".join(keyword[1].upper().split()) if keyword else ""


def holding(block: list[str]) -> list[str]:
    """A *BOUNDARY without its values and amplitudes, and without temperatures and pressures."""
    rows = [[field.strip() for field in row.split(",")[:3]] for row in block[1:]]
    return ["*BOUNDARY", *(",".join(row) for row in rows if len(row) > 1 and row[1] not in {"0", "8", "11"})]


def frequency_deck(lines: list[str], supports: bool, modes: int) -> str:
    """The deck with one step of frequencies in the place of its steps."""
    steps = 0
    made: list[list[str]] = []
    held: list[list[str]] = []
    for block in blocks(lines):
        keyword = name(block)
        steps += keyword == "STEP"
        if keyword == "BOUNDARY":
            if supports and steps <= 1 and not re.search(r"SUBMODEL|FIXED", block[0], re.I):
                held.append(holding(block))
        elif steps == 0:
            made.append(block)
            if keyword == "PRE-TENSION SECTION" and (node := re.search(r"NODE\s*=\s*([^,\s]+)", block[0], re.I)):
                held.append(["*BOUNDARY", f"{node[1]},1"])
    dense: list[list[str]] = []
    for block in made:
        dense.append(block)
        if name(block) == "MATERIAL":
            rest = made[len(dense) :]
            ends = (i for i, other in enumerate(rest) if name(other) in {"MATERIAL", "SOLID SECTION", "SHELL SECTION", "BEAM SECTION"})
            own = rest[: next(ends, len(rest))]
            if not any(name(other) == "DENSITY" for other in own):
                dense.append(["*DENSITY", "7.8E-9"])
    step = ["*STEP", "*FREQUENCY", str(modes), "*END STEP", ""]
    return "\n".join(line for block in dense + held + [step] for line in block)


def computed(ccx: str, place: pathlib.Path) -> tuple[str, list[float]]:
    """The error of ccx, and the frequencies (Hz) that it prints."""
    try:
        run = subprocess.run([ccx, place.stem], cwd=place.parent, capture_output=True, text=True, timeout=SECONDS, errors="replace")
    except subprocess.TimeoutExpired:
        return "longer than the limit of time", []
    result = place.with_suffix(".dat")
    text = result.read_text() if result.exists() else ""
    table = text.split("P A R T I C I P A T I O N")[0]
    rows = re.findall(r"^\s+\d+\s+(-?\d\S*)\s+(\d\S*)\s+(\d\S*)\s+(\d\S*)\s*$", table, re.M)
    frequencies = [float(row[2]) if float(row[3]) == 0 else 0.0 for row in rows]
    if frequencies:
        return "", frequencies
    error = re.search(r"\*ERROR\s*(.*(?:\n +[a-z].*)?)", run.stdout)
    return " ".join(error[1].split()) if error else f"ccx ends with code {run.returncode}", []


def theirs(ccx: str, lines: list[str], supports: bool, place: pathlib.Path) -> tuple[str, list[float]]:
    """The error of ccx, and its frequencies without rigid motions: of ten modes, else of as many as it accepts."""
    error, found = "", []
    for modes in (MODES if supports else MODES + 6, 6, 3, 1):
        for old in place.parent.glob(place.stem + ".*"):
            old.unlink()
        place.write_text(frequency_deck(lines, supports, modes))
        error, found = computed(ccx, place)
        if found:
            break
    rigid = 0.0 if supports else RIGID * max(found, default=0.0)
    return error, [frequency for frequency in found if frequency > rigid]


def compared(eng: str, ccx: str, deck: pathlib.Path, folder: pathlib.Path) -> tuple[str, str, list[float], list[float]]:
    """The answer about a deck, the message, the frequencies of ccx, and ours."""
    lines = joined(deck)
    place = folder / f"{deck.stem}.inp"
    supports = True
    while True:
        error, other = theirs(ccx, lines, supports, place)
        failed, text = reduced(eng, place, "calculix", max(len(other), 1), supports, folder, RULES)
        if fewer := re.search(r"modes are requested, but only (\d+)", text):
            other = other[: int(fewer[1])]
            failed, text = reduced(eng, place, "calculix", len(other), supports, folder, RULES)
        if failed and supports and any(words in text for words in FREE):
            supports = False
            continue
        break
    state = "held" if supports else "free"
    if failed:
        found = re.search(r"error(?:\[E\d+\])?: .*", text)
        lost = re.findall(r"\d+ × (.*?) \(the first", text)
        message = (found[0] if found else text[-200:]) + (f" {lost}" if lost else "")
        return ("refused by Eng" if other else "refused by both"), message + (f" — ccx: {error}" if error else ""), other, []
    if not other:
        return "not computed by ccx", error, [], []
    ours = [float(row) for row in re.findall(r"^\s+\d+\s+([0-9.e+-]+)\s+[0-9.]+ %", text, re.M)]
    return f"compared, {state}", "", other, ours


def main() -> None:
    """Prints the comparison of a folder."""
    eng, ccx, root, element = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3]).resolve(), sys.argv[4]
    table = open(sys.argv[5], "w") if len(sys.argv) > 5 else None
    wanted = re.compile(rf"^\*ELEMENT\b.*TYPE\s*=\s*{element}\s*(,|$)", re.M | re.I)
    answers: collections.Counter = collections.Counter()
    details = []
    largest = 0.0
    for deck in sorted(root.rglob("*.inp")):
        if deck.stat().st_size > LARGEST or not wanted.search(deck.read_text(errors="replace")):
            continue
        with tempfile.TemporaryDirectory() as folder:
            answer, message, other, ours = compared(eng, ccx, deck, pathlib.Path(folder))
        worst = max((abs(mine / frequency - 1) for frequency, mine in zip(other, ours)), default=0.0)
        answers[answer] += 1
        largest = max(largest, worst)
        if message:
            details.append(f"{deck.stem}: {answer}: {message}")
        elif worst > LIMIT or len(other) != len(ours):
            rows = "\n".join(f"    {frequency:.7g}  {mine:.7g}  {mine / frequency - 1:+.1e}" for frequency, mine in zip(other, ours))
            details.append(f"{deck.stem}: {answer}, {worst:.1e}\n{rows}")
        if table:
            print(deck.relative_to(root), answer, len(ours), f"{worst:.1e}", message, sep="\t", file=table, flush=True)
    print(f"{sum(answers.values())} decks, largest difference {largest:.1e}\n")
    print("| answer | decks |\n| --- | --- |")
    for answer, count in answers.most_common():
        print(f"| {answer} | {count} |")
    print("\n" + "\n".join(details))


if __name__ == "__main__":
    main()
