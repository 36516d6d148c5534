"""Compares the results and messages of two builds of `eng`.

Usage: compare.py BEFORE AFTER [MODEL …] [--limit 1e-9] [--out FOLDER] [--patience 600]

BEFORE and AFTER are two executables. Without a MODEL it runs all examples and all models of tests/good. It prints a
row for each model: the largest difference of a channel over the swing of this channel, and the channel. A swing
counts as at least FLOOR of the largest value of the same dimension in the analysis, because a force that is zero has
rounding alone. Lines below a row name messages that only one of the builds gives. Exits with 1 if a difference
is above the limit, or if files, channels, samples or messages differ.
"""

import argparse
import collections
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

import numpy
import pyarrow.parquet

FLOOR = 1e-6
HERE = pathlib.Path(__file__).resolve().parent.parent


def ran(eng, model, folder, patience):
    """Runs a model into a folder. Returns the exit code and the multiset of its messages' codes."""
    environment = {**os.environ, "ENG_CACHE": str(folder.parent.parent / "cache" / folder.parent.name)}
    command = [eng, "run", model, "--out", folder, "--no-plots", "--threads", "1"]
    try:
        run = subprocess.run(command, capture_output=True, text=True, timeout=patience, env=environment)
    except subprocess.TimeoutExpired:
        return "time out", collections.Counter()
    check = subprocess.run([eng, "check", model, "--format", "json"], capture_output=True, text=True, env=environment)
    try:
        checked = [message["code"] for message in json.loads(check.stdout)["diagnostics"]]
    except (ValueError, KeyError):
        checked = []
    told = re.findall(r"\b(?:error|warning)\[([EW]\d{4})\]", run.stdout + run.stderr)
    return run.returncode, collections.Counter(checked) | collections.Counter(told)


def channels(file):
    """Numbers in SI and dimension of each channel."""
    table = pyarrow.parquet.read_table(file)
    found = {}
    for field in table.schema:
        about = {key.decode(): value.decode() for key, value in (field.metadata or {}).items()}
        numbers = table.column(field.name).to_numpy()
        if numbers.dtype.kind in "fiu":
            scale, offset = float(about.get("si_scale", 1)), float(about.get("si_offset", 0))
            found[field.name] = numbers * scale + offset, about.get("dimension", "")
    return found


def distance(before, after):
    """The number of compared channels, the largest difference over the swing with its channel, and what cannot be compared."""
    one, two = channels(before), channels(after)
    lone = sorted(one.keys() ^ two.keys())
    remarks = [f"{len(lone)} channels of one build only, such as {lone[0]}"] if lone else []
    largest = collections.defaultdict(float)
    for numbers, dimension in one.values():
        size = numpy.nanmax(numpy.abs(numbers), initial=0.0) if numbers.size else 0.0
        largest[dimension] = max(largest[dimension], size)
    worst = 0.0, ""
    for path in one.keys() & two.keys():
        (a, dimension), (b, _) = one[path], two[path]
        if a.shape != b.shape:
            return 0, worst, [f"{a.size} and {b.size} samples", *remarks]
        if numpy.any(numpy.isnan(a) != numpy.isnan(b)):
            return len(one), (numpy.inf, path), remarks
        known = ~numpy.isnan(a)
        difference = numpy.max(numpy.abs(a[known] - b[known]), initial=0.0)
        swing = max(numpy.ptp(a[known]) if known.any() else 0.0, FLOOR * largest[dimension])
        if difference > 0 and difference / max(swing, 1e-300) > worst[0]:
            worst = difference / max(swing, 1e-300), path
    return len(one.keys() & two.keys()), worst, remarks


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("before")
    parser.add_argument("after")
    parser.add_argument("models", nargs="*", type=pathlib.Path)
    parser.add_argument("--limit", type=float, default=1e-9)
    parser.add_argument("--out", type=pathlib.Path, help="keep the results here")
    parser.add_argument("--patience", type=float, default=600, help="seconds for a model")
    stated = parser.parse_args()
    models = stated.models or sorted([*HERE.glob("examples/*/*.eng"), *HERE.glob("tests/good/*.eng")])
    out = stated.out or pathlib.Path(tempfile.mkdtemp())
    good = True
    print(f"{'model':<28} {'channels':>8} {'difference':>10}  largest in")
    for model in models:
        name = f"{model.resolve().parent.name}/{model.stem}"
        compared, worst, remarks = both((stated.before, stated.after), model.resolve(), out, stated.patience)
        above = worst[0] > stated.limit
        good &= not above and not remarks
        print(f"{name:<28} {compared:>8} {worst[0]:>10.1e}  {worst[1]}{' !' if above else ''}", flush=True)
        for remark in remarks:
            print(f"    {remark}", flush=True)
    sys.exit(0 if good else 1)


def both(binaries, model, out, patience):
    """Runs a model with both builds. Returns the number of compared channels, the largest difference with its place,
    and what cannot be compared."""
    folders = [(out / build / f"{model.parent.name}-{model.stem}").resolve() for build in ("before", "after")]
    runs = [ran(pathlib.Path(binary).resolve(), model, folder, patience) for binary, folder in zip(binaries, folders)]
    files = [{file.name for file in folder.glob("*.parquet")} for folder in folders]
    remarks = [f"only one build writes {file}" for file in sorted(files[0] ^ files[1])]
    if runs[0][0] != runs[1][0]:
        remarks.append(f"exit codes {runs[0][0]} and {runs[1][0]}")
    for which, (more, fewer) in (("before", runs), ("after", runs[::-1])):
        if more[1] - fewer[1]:
            remarks.append(f"messages {which} only: {' '.join(sorted((more[1] - fewer[1]).elements()))}")
    compared, worst = 0, (0.0, "")
    for file in sorted(files[0] & files[1]):
        count, (difference, path), further = distance(folders[0] / file, folders[1] / file)
        compared += count
        if difference > worst[0]:
            worst = difference, f"{file.removesuffix('.parquet')}: {path}"
        remarks += [f"{file}: {remark}" for remark in further]
    if compared == 0:
        remarks.append("nothing to compare")
    return compared, worst, remarks


if __name__ == "__main__":
    main()
