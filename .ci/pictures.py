"""Checks pictures of a run with independent readers. Usage: pictures.py GLB PVD

GLB is the file of `eng report --gltf`, and PVD that of `--vtu`, of the same analysis. The Khronos validator reads the first (Node.js and
gltf-validator, found by NODE_PATH); meshio and VTK read the second. Then both must show the same motion: nodes of the glTF file, moved by
its morph targets and weights, are nodes of the VTU files with their displacements, and the body `crank`, which turns about its z, is at
the crank angle. Node.js, gltf-validator, numpy, meshio and VTK must be installed. Exits with 1 if anything is wrong.
"""

import json
import os
import struct
import subprocess
import sys
import xml.etree.ElementTree

import meshio
import numpy
import vtk
from vtk.util.numpy_support import vtk_to_numpy

glb, pvd = sys.argv[1:3]
here = os.path.dirname(os.path.abspath(__file__))

# ---- the Khronos validator

validate = os.path.join(here, "..", "report", "tests", "report", "validate.cjs")
run = subprocess.run(["node", validate, glb], capture_output=True, text=True)
assert run.returncode == 0, run.stderr or "gltf-validator (npm) is not installed"
report = json.loads(run.stdout)
issues = report["issues"]
assert issues["numErrors"] == 0 and issues["numWarnings"] == 0, json.dumps(report, indent=1)
assert report["info"]["hasMorphTargets"] and report["info"]["animationCount"] == 1
print(f"{glb}: the Khronos validator finds no error and no warning")

# ---- glTF

data = open(glb, "rb").read()
assert data[:4] == b"glTF" and struct.unpack("<I", data[8:12])[0] == len(data)
size = struct.unpack("<I", data[12:16])[0]
document = json.loads(data[20 : 20 + size])
binary = data[28 + size :]


def array(index):
    accessor = document["accessors"][index]
    view = document["bufferViews"][accessor["bufferView"]]
    kind = {5126: "<f4", 5125: "<u4"}[accessor["componentType"]]
    width = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}[accessor["type"]]
    values = numpy.frombuffer(binary, kind, accessor["count"] * width, view["byteOffset"])
    return values.reshape(-1, width) if width > 1 else values


def rotation(q):
    x, y, z, w = q / numpy.linalg.norm(q)
    return numpy.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ])


extras = document["scenes"][0]["extras"]
animation = document["animations"][0]
tracks = {}
for channel in animation["channels"]:
    sampler = animation["samplers"][channel["sampler"]]
    tracks.setdefault(channel["target"]["node"], {})[channel["target"]["path"]] = array(sampler["output"])


def shown(node, moment):
    """Places (m) of a flexible body's nodes, not deformed, and their displacements (m, inertial axes) at a moment."""
    body = document["nodes"][node]
    primitive = document["meshes"][body["mesh"]]["primitives"][0]
    track = tracks.get(node, {})
    turn = rotation(track["rotation"][moment].astype(float) if "rotation" in track else numpy.array(body["rotation"], float))
    origin = track["translation"][moment].astype(float) if "translation" in track else numpy.array(body["translation"], float)
    targets = primitive["targets"]
    weights = track["weights"].reshape(-1, len(targets))[moment].astype(float) / extras["deformation_scale"]
    moved = sum(w * array(t["POSITION"]).astype(float) for w, t in zip(weights, targets))
    return origin + array(primitive["attributes"]["POSITION"]).astype(float) @ turn.T, moved @ turn.T


# times are slowed down, and the crank is at its angle: its frame turns with it, without its twist
clock = numpy.array([array(s["input"]) for s in animation["samplers"]])
moments = numpy.array(extras["times"])
assert abs(clock - (moments - extras["start"]) * extras["slowdown"]).max() <= 1e-5 * clock.max()
turning = next((i for i, node in enumerate(document["nodes"]) if node.get("name") == "crank"), None)
if turning is not None and extras["crank_angles"] and "rotation" in tracks.get(turning, {}):
    turns = [rotation(q.astype(float)) for q in tracks[turning]["rotation"]]
    about = [numpy.degrees(numpy.arctan2(*(turns[0].T @ turn)[[1, 0], 0])) for turn in turns]
    angles = numpy.array(extras["crank_angles"]) - extras["crank_angles"][0]
    off = (numpy.array(about) - angles + 180) % 360 - 180
    assert abs(off).max() < 0.5, f"the crank stands {abs(off).max():.2f} degrees from its angle"
    print(f"{glb}: the crank stands at its angle within {abs(off).max():.2f} degrees at {len(turns)} times")

# ---- VTU, by each reader


def by_meshio(path):
    mesh = meshio.read(path)
    return mesh.points, mesh.point_data


def by_vtk(path):
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(path)
    reader.Update()
    grid = reader.GetOutput()
    arrays = grid.GetPointData()
    names = [arrays.GetArrayName(i) for i in range(arrays.GetNumberOfArrays())]
    numbers = {name: vtk_to_numpy(arrays.GetArray(name)) for name in names}
    return vtk_to_numpy(grid.GetPoints().GetData()), numbers


readers = {"meshio": by_meshio, "VTK": by_vtk}
parts = xml.etree.ElementTree.parse(pvd).getroot().findall(".//DataSet")
assert parts, f"{pvd} names no file"
times = sorted({float(part.get("timestep")) for part in parts})
flexible = [i for i, node in enumerate(document["nodes"]) if "mesh" in node and document["meshes"][node["mesh"]].get("weights")]
bodies = list(dict.fromkeys(part.get("part") for part in parts))
assert len(bodies) == len(flexible), (bodies, flexible)
for name, read in readers.items():
    compared = 0
    for part in parts:
        points, numbers = read(os.path.join(os.path.dirname(pvd), part.get("file")))
        displacement = numbers["displacement"]
        assert points.shape == displacement.shape and numpy.isfinite(displacement).all()
        xx, yy, zz, xy, yz, xz = numbers["stress"].T
        mises = numpy.sqrt(0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) + 3 * (xy**2 + yz**2 + xz**2))
        largest = mises.max()
        assert abs(numbers["von_mises"] - mises).max() <= 1e-9 * largest
        assert (numbers["von_mises_envelope (Pa)"] >= mises - 1e-9 * largest).all()
        # the same moment of the same body in the glTF file
        time = float(part.get("timestep"))
        moment = int(numpy.argmin(abs(numpy.array(extras["times"]) - time)))
        assert abs(extras["times"][moment] - time) <= 1e-12 * max(1.0, abs(time))
        if time not in (times[0], times[len(times) // 2]):
            continue
        places, moved = shown(flexible[bodies.index(part.get("part"))], moment)
        order = numpy.argsort(points[:, 0])
        low = numpy.searchsorted(points[order, 0], places[:, 0] - 2e-6)
        high = numpy.searchsorted(points[order, 0], places[:, 0] + 2e-6)
        for place, move, a, b in zip(places, moved, low, high):
            near = order[a:b]
            distance = numpy.linalg.norm(points[near] - place, axis=1)
            assert len(near) and distance.min() < 2e-6, f"no node of {part.get('file')} at {place}"
            same = near[distance.argmin()]
            # modes that move nothing by more than a thousandth of the largest are left out of pictures
            size = numpy.linalg.norm(displacement, axis=1).max()
            assert numpy.linalg.norm(displacement[same] - move) <= 1e-2 * size
            compared += 1
    print(f"{pvd}: {len(parts)} files read by {name}, {compared} nodes as in {glb}")
