"""Compares the frequencies of decks with those that Nastran or MYSTRAN printed. Usage: frequencies.py ENG FOLDER

ENG is the command. Each result (.f06, .ans of MYSTRAN, .op2) of the folder with a table of real eigenvalues belongs to the deck of its
name, beside it or elsewhere in the folder, else to the deck beside it with which its name begins. `eng reduce` with
`element_rules = nastran` and the supports of the deck gives as many frequencies as the table. Of a free body those below 1e-4 of the
largest are rigid motions. A line for each deck has the number of frequencies and the largest relative difference; decks above 1e-3 follow
with both lists, refused decks with the message.
"""

import pathlib
import re
import struct
import sys

from decks import ENDINGS, reduced

RESULTS = {".f06", ".ans", ".op2"}
LIMIT = 1e-3
RIGID = 1e-4
ROW = re.compile(r"^\s+(\d+)\s+\d+\s+(-?\d\S*)\s+\d\S*\s+(\d[0-9.E+-]*)\s+\S+\s+\S+\s*$")


def printed(text: str) -> list[list[float]]:
    """The distinct tables of frequencies (Hz) of a printed result. A table goes on over pages; buckling has other headings."""
    tables: list[list[float]] = []
    inside = False
    for line in text.splitlines():
        if re.search(r"[A-Z] [A-Z] [A-Z] [A-Z]", line):
            inside = "R E A L   E I G E N V A L U E S" in line
        elif inside and (row := ROW.match(line)):
            number = int(row[1])
            if number == 1:
                tables.append([])
            if tables and number == len(tables[-1]) + 1:
                tables[-1].append(float(row[3]))
    return [table for i, table in enumerate(tables) if table not in tables[:i]]


def records(data: bytes):
    """The records of a Fortran file of 32-bit words."""
    at = 0
    while at + 8 <= len(data):
        (length,) = struct.unpack_from("<i", data, at)
        if length < 0 or at + 8 + length > len(data):
            return
        yield data[at + 4 : at + 4 + length]
        at += 8 + length


def binary(data: bytes) -> list[list[float]]:
    """The tables LAMA of an OP2 file: a record of 146 words, then seven words for each mode, of which the fifth is the frequency (Hz)."""
    tables: list[list[float]] = []
    inside = headed = False
    for record in records(data):
        if len(record) == 8 and record.strip().isalnum():
            inside, headed = record.startswith(b"LAMA"), False
        elif inside and len(record) == 584:
            headed = True
        elif inside and headed and len(record) > 4 and len(record) % 28 == 0:
            table = [struct.unpack_from("<2i5f", record, at)[4] for at in range(0, len(record), 28)]
            headed = False
            if table not in tables:
                tables.append(table)
    return tables


def deck_of(result: pathlib.Path, decks: list[pathlib.Path]) -> pathlib.Path | None:
    """The deck of a result: of its name in its folder, else anywhere; else the longest in its folder that begins its name."""
    name = result.stem.lower()
    beside = [deck for deck in decks if deck.parent == result.parent]
    same = [deck for deck in beside + decks if deck.stem.lower() == name]
    begins = sorted((deck for deck in beside if name.startswith(deck.stem.lower())), key=lambda deck: len(deck.stem))
    return same[0] if same else (begins[-1] if begins else None)


def band(deck: pathlib.Path) -> tuple[float, float]:
    """The frequencies between which a deck asks for modes (Hz). Those beyond are residual vectors, which are no modes."""
    bands = set()
    for card in re.findall(r"^EIGRL?\b.*", deck.read_text(errors="replace"), re.M):
        fields = [field.strip() for field in (card.split(",") if "," in card else [card[i : i + 8] for i in range(0, 80, 8)])]
        at = 2 if fields[0] == "EIGRL" else 3  # EIGR names its method first
        values = []
        for field in (fields + [""] * 5)[at : at + 2]:
            field = re.sub(r"(?<=[0-9.])([+-])", r"e\1", field)
            values.append(float(field) if field else None)
        bands.add((values[0] or 0.0, values[1] or float("inf")) if at == 2 else (values[0] or 0.0, float("inf")))
    return bands.pop() if len(bands) == 1 else (0.0, float("inf"))


def found(eng: str, deck: pathlib.Path, root: pathlib.Path, table: list[float]) -> tuple[str, list[float], list[float]]:
    """The refusal, the printed frequencies, and ours. Those of a free body begin after the rigid motions."""
    low, high = band(deck)
    theirs = [frequency for frequency in table if frequency <= high]
    below, supports = 0, True
    while True:
        failed, answer = reduced(eng, deck, "nastran", len(theirs) + below, supports, root, "element_rules = nastran")
        if failed and supports and "holds no freedom" in answer:
            supports = False
            theirs = [frequency for frequency in theirs if frequency > RIGID * max(theirs)]
            continue
        if failed:
            error = re.search(r"error(?:\[E\d+\])?: .*", answer)
            lost = re.findall(r"\d+ × (.*?) \(the first", answer)
            return (error.group(0) if error else answer[:200]) + (f" {lost}" if lost else ""), theirs, []
        ours = [float(row) for row in re.findall(r"^\s+\d+\s+([0-9.e+-]+)\s+[0-9.]+ %", answer, re.M)]
        if sum(frequency < low for frequency in ours) <= below:
            return "", theirs, [frequency for frequency in ours if frequency >= low]
        below = sum(frequency < low for frequency in ours)


def main() -> None:
    """Prints the comparison of a folder."""
    eng, root = sys.argv[1], pathlib.Path(sys.argv[2]).resolve()
    files = sorted(path for path in root.rglob("*") if path.is_file())
    decks = [path for path in files if path.suffix.lower() in ENDINGS["nastran"]]
    details = []
    seen = set()
    for result in files:
        if result.suffix.lower() not in RESULTS:
            continue
        tables = binary(result.read_bytes()) if result.suffix.lower() == ".op2" else printed(result.read_text(errors="replace"))
        deck = deck_of(result, decks)
        if not tables or deck is None or len(tables[0]) == 0:
            continue
        for table in tables:
            key = (deck, tuple(float(f"{frequency:.5g}") for frequency in table))
            if key in seen or max(table) <= 0:
                continue
            seen.add(key)
            name = f"{deck.relative_to(root)} ({result.suffix.lower()[1:]})"
            refusal, theirs, ours = found(eng, deck, root, table)
            if refusal:
                print(f"{name}: {len(theirs)} frequencies, refused", flush=True)
                details.append(f"{name}: {refusal}")
                continue
            pairs = list(zip(theirs, ours))
            worst = max((abs(mine / other - 1) for other, mine in pairs), default=0.0)
            print(f"{name}: {len(pairs)} frequencies, {worst:.1e}", flush=True)
            if worst > LIMIT or len(ours) != len(theirs):
                rows = "\n".join(f"    {other:.6g}  {mine:.6g}  {mine / other - 1:+.1e}" for other, mine in pairs)
                details.append(f"{name}:\n{rows}")
    print("\n" + "\n".join(details))


if __name__ == "__main__":
    main()
