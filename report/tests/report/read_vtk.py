"""Reads a series of VTK files with meshio and with VTK, whichever are there, and prints what they found as JSON.

Ends with 77 where both are missing.
"""

import json
import pathlib
import sys
import xml.etree.ElementTree as tree


def by_meshio(path):
    import meshio

    mesh = meshio.read(path)
    data = mesh.point_data
    return (
        mesh.points,
        sum(len(block.data) for block in mesh.cells),
        data["displacement"],
        data["stress"],
        data["von_mises"],
    )


def by_vtk(path):
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    grid = reader.GetOutput()
    if grid.GetNumberOfPoints() == 0:
        raise ValueError(f"VTK read no points from {path}")
    data = grid.GetPointData()
    array = lambda name: vtk_to_numpy(data.GetArray(name))
    time = vtk_to_numpy(grid.GetFieldData().GetArray("TimeValue"))
    assert len(time) == 1
    return (
        vtk_to_numpy(grid.GetPoints().GetData()),
        grid.GetNumberOfCells(),
        array("displacement"),
        array("stress"),
        array("von_mises"),
    )


def available():
    found = []
    try:
        import meshio  # noqa: F401

        found.append(("meshio", by_meshio))
    except ImportError:
        pass
    try:
        import vtkmodules.vtkIOXML  # noqa: F401

        found.append(("vtk", by_vtk))
    except ImportError:
        pass
    return found


def main():
    folder = pathlib.Path(sys.argv[1])
    readers = available()
    if not readers:
        sys.exit(77)
    collection = tree.parse(folder / "crank.pvd").getroot().find("Collection")
    files = [entry.get("file") for entry in collection]
    result = []
    for name, read in readers:
        frames = []
        for file in files:
            points, cells, moved, stress, mises = read(folder / file)
            frames.append(
                {
                    "points": len(points),
                    "cells": cells,
                    "x7": float(points[7][0]),
                    "u7": float(moved[7][0]),
                    "s7": float(stress[7][0]),
                    "t7": float(stress[7][3]),
                    "mises7": float(mises.ravel()[7]),
                }
            )
        result.append({"name": name, "frames": frames})
    print(json.dumps({"readers": result}))


main()
