"""Reads exported results with independent readers: pyuff, scipy, pyarrow. Usage: exports.py FOLDER ANALYSIS

The folder holds ANALYSIS.parquet, .csv, .uff and .mat of one run. Exits with 1 where they differ.
"""

import csv
import json
import sys

import numpy
import pyarrow.parquet
import pyuff
import scipy.io

folder, analysis = sys.argv[1:3]
table = pyarrow.parquet.read_table(f"{folder}/{analysis}.parquet")
paths = table.schema.names
fields = {f.name: {k.decode(): v.decode() for k, v in f.metadata.items()} for f in table.schema}
shown = {p: table.column(p).to_numpy() for p in paths}
si = {p: shown[p] * float(fields[p]["si_scale"]) + float(fields[p]["si_offset"]) for p in paths}
assert json.loads(table.schema.metadata[b"PANDAS_ATTRS"])["units"] == {p: fields[p]["unit"] for p in paths}
for key in (b"eng.run.source_hash", b"eng.run.version", b"eng.model"):
    assert table.schema.metadata[key], key


def close(a, b, relative, what):
    scale = max(1e-300, numpy.nanmax(numpy.abs(b)))
    assert a.shape == b.shape, (what, a.shape, b.shape)
    error = numpy.nanmax(numpy.abs(a - b)) / scale
    assert error <= relative, (what, error)


with open(f"{folder}/{analysis}.csv", newline="") as file:
    rows = list(csv.reader(file))
assert rows[0] == paths and rows[1] == [fields[p]["unit"] for p in paths]
numbers = numpy.array(rows[2:], dtype=float)
for i, p in enumerate(paths):
    close(numbers[:, i], shown[p], 1e-15, f"csv {p}")

mat = scipy.io.loadmat(f"{folder}/{analysis}.mat", squeeze_me=True, struct_as_record=False)
names = mat["paths"]._fieldnames
assert [getattr(mat["paths"], n) for n in names] == paths
for n, p in zip(names, paths):
    close(mat[n], shown[p], 1e-15, f"mat {p}")
    unit = getattr(mat["units"], n)
    assert (unit if isinstance(unit, str) else "") == fields[p]["unit"], p
    frame = getattr(mat["frames"], n)
    assert (frame if isinstance(frame, str) else "") == fields[p].get("frame", ""), p
assert mat["info"].analysis == analysis

sets = pyuff.UFF(f"{folder}/{analysis}.uff").read_sets()
assert sets[0]["type"] == 164 and sets[0]["units_code"] == 1
assert sets[0]["length"] == 1 and sets[0]["force"] == 1
responses = {s["id1"].strip(): s for s in sets[1:]}
assert list(responses) == [p[:80] for p in paths if p != "time"]
types = {"kg*m/s^2": 13, "m": 8, "m/s": 11, "m/s^2": 12, "kg/m/s^2": 15, "K": 5}
for p in paths:
    if p == "time":
        continue
    s = responses[p[:80]]
    assert s["type"] == 58 and s["func_type"] == 1 and s["ord_data_type"] == 4
    assert s["abscissa_spec_data_type"] == 17
    expected = types.get(fields[p]["dimension"])
    if expected:
        assert s["ordinate_spec_data_type"] == expected, (p, s["ordinate_spec_data_type"])
    # the format gives an abscissa six digits
    close(s["x"], si["time"], 1e-5, f"uff abscissa {p}")
    close(numpy.real(s["data"]), si[p], 1e-12, f"uff {p}")
print(f"{analysis}: {len(paths)} columns of {table.num_rows} samples agree in csv, mat and uff58")
