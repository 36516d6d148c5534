"""Writes MED files for the tests with medcoupling 9.14, the library of Salome, and with h5py; and `.msh` of the same meshes with gmsh 4.15.

`kinds1`, `kinds2`: one solid of each shape, of both orders. `many`: a family for each of 300 cells. `old`: the mesh of
`kinds1` in the layout of MED 2.2. `mirrored`: `kinds2` with mirrored solids. `cover`: a hexahedron, shells
beside it and a face of it. `wrong_*`: copies of `kinds1` (`wrong_overlap`: of `old`) with one mistake each.
"""
import os
import re
import shutil

import gmsh
import h5py
import medcoupling as mc
import numpy as np

PLACES = [
    # a hexahedron, the apex of a pyramid on it, the third edge of a wedge beside it, the apex of a tetrahedron on the wedge
    (0, 0, 0), (20, 1, 0), (21, 20, 1), (-1, 19, 0), (0, 0, 18), (20, 0, 20), (19, 20, 21), (1, 20, 20),
    (10, 11, 34), (38, 2, 3), (37, 21, 2), (27, -14, 9),
]
# the nodes of the first face run around it as an observer outside sees them
CELLS = [
    (mc.NORM_HEXA8, [0, 3, 2, 1, 4, 7, 6, 5]),
    (mc.NORM_PYRA5, [4, 7, 6, 5, 8]),
    (mc.NORM_PENTA6, [1, 9, 5, 2, 10, 6]),
    (mc.NORM_TETRA4, [1, 5, 9, 11]),
]
LEFT, RIGHT = [0, 3, 4, 7], [9, 10]
# the nodes of mirrored solids; there is one of each kind
MIRRORED = {
    "T10": [0, 2, 1, 3, 6, 5, 4, 7, 9, 8],
    "H20": [0, 3, 2, 1, 4, 7, 6, 5, 11, 10, 9, 8, 15, 14, 13, 12, 16, 19, 18, 17],
    "P15": [0, 2, 1, 3, 5, 4, 8, 7, 6, 11, 10, 9, 12, 14, 13],
    "P13": [0, 3, 2, 1, 4, 8, 7, 6, 5, 9, 12, 11, 10],
}


def mesh(name, cells, dimension=3):
    made = mc.MEDCouplingUMesh(name, dimension)
    made.setCoords(mc.DataArrayDouble([list(map(float, place)) for place in PLACES]))
    made.allocateCells(len(cells))
    for kind, nodes in cells:
        made.insertNextCell(kind, len(nodes), nodes)
    made.finishInsertingCells()
    return made


def group(name, members):
    made = mc.DataArrayInt(members)
    made.setName(name)
    return made


def kinds(order):
    solids = mesh("kinds", CELLS)
    assert not len(solids.findAndCorrectBadOriented3DCells())
    if order == 2:
        solids.convertLinearCellsToQuadratic(0)
    faces = solids.buildDescendingConnectivity()[0]
    file = mc.MEDFileUMesh()
    solids.sortCellsInMEDFileFrmt()
    file.setMeshAtLevel(0, solids)
    faces.sortCellsInMEDFileFrmt()
    file.setMeshAtLevel(-1, faces)
    file.setName("kinds")
    file.setGroupsAtLevel(0, [group("BODY", [0, 1, 2, 3]), group("HALF", [0, 1])])
    file.setGroupsAtLevel(1, [group("LEFT", LEFT), group("RIGHT", RIGHT)])
    file.write(f"kinds{order}.med", 2)
    # gmsh reads no version after 4.1
    file.write40("gmsh.med", 2)
    gmsh.clear()
    gmsh.option.setNumber("Mesh.SecondOrderIncomplete", 1)
    gmsh.option.setNumber("Mesh.SaveAll", 1)
    gmsh.open("gmsh.med")
    gmsh.write(f"kinds{order}.msh")
    os.remove("gmsh.med")


def many():
    # a bar of 300 hexahedra, each in a group of its own
    arrays = [mc.DataArrayDouble([10.0 * i for i in range(count)]) for count in (301, 2, 2)]
    bar = mc.MEDCouplingCMesh()
    bar.setCoords(*arrays)
    bar = bar.buildUnstructured()
    bar.setName("many")
    bar.findAndCorrectBadOriented3DCells()
    file = mc.MEDFileUMesh()
    file.setMeshAtLevel(0, bar)
    file.setGroupsAtLevel(0, [group(f"CELL_{i + 1:03}", [i]) for i in range(300)])
    file.write("many.med", 2)


def old():
    with h5py.File("kinds1.med") as new, h5py.File("old.med", "w", libver="earliest") as file:
        about = file.create_group("INFOS_GENERALES")
        for name, number in zip(("MAJ", "MIN", "REL"), (2, 2, 2)):
            about.attrs[name] = np.int32(number)
        own = file.create_group("ENS_MAA/kinds")
        own.attrs["DIM"], own.attrs["TYP"] = np.int32(3), np.int32(0)
        step = next(iter(new["ENS_MAA/kinds"].values()))
        for part in ("NOE", *(f"MAI/{kind}" for kind in step["MAI"])):
            folder = own.create_group(part)
            for name, values in step[part].items():
                data = values[:].astype(">i4") if name != "COO" else values[:]
                folder.create_dataset(name, data=data).attrs["NBR"] = np.int32(values.attrs["NBR"])
        own["NOE/COO"].attrs["REP"] = np.int32(0)
        families = own.create_group("FAS")
        for part in new["FAS/kinds"].values():
            for family in part.values() if "NUM" not in part.attrs else [part]:
                folder = families.create_group(f"FAMILLE_{family.attrs['NUM']}")
                folder.attrs["NUM"] = np.int32(family.attrs["NUM"])
                if "GRO" in family:
                    # a zero byte follows the names
                    names = np.frombuffer(family["GRO/NOM"][:].tobytes() + b"\0", "S1")
                    folder.create_group("GRO").create_dataset("NOM", data=names)


def cover():
    solids = mesh("cover", [CELLS[0]])
    faces = mesh("cover", [(mc.NORM_TRI3, [5, 6, 8]), (mc.NORM_QUAD4, [5, 9, 10, 6]), (mc.NORM_QUAD4, [0, 1, 2, 3])], 2)
    faces.setCoords(solids.getCoords())
    file = mc.MEDFileUMesh()
    file.setMeshAtLevel(0, solids)
    file.setMeshAtLevel(-1, faces)
    file.setName("cover")
    file.setGroupsAtLevel(-1, [group("COVER", [0, 1]), group("FOOT", [2])])
    file.write("cover.med", 2)


def changed(name, source, change):
    """A copy of a file with a change."""
    with h5py.File(f"{source}.med") as good, h5py.File(f"{name}.med", "w", libver="v108") as file:
        for part in good:
            good.copy(part, file)
        mesh = file["ENS_MAA/kinds"]
        change(file, mesh, next(iter(mesh.values())))


def wrong(name, change):
    changed(f"wrong_{name}", "kinds1", change)


def replaced(folder, name, values, **how):
    attributes = dict(folder[name].attrs) if name in folder else {}
    if name in folder:
        del folder[name]
    made = folder.create_dataset(name, data=values, **how)
    for key, value in attributes.items():
        made.attrs[key] = value


def with_node(step, node):
    nodes = step["MAI/HE8/NOD"][:]
    nodes[3] = node
    replaced(step["MAI/HE8"], "NOD", nodes)


def lose(file, mesh, step):
    """Families of two cells and of two nodes without a description. That of other nodes has one, but no groups."""
    del file["FAS/kinds/ELEME/Family_-3"], file["FAS/kinds/NOEUD/Family_6"]


def share(file, mesh, step):
    """Eight families with one list of names, which is most of the file: more than four times its bytes in all."""
    families = file["FAS/kinds/ELEME"]
    names = np.frombuffer(families["Family_-2/GRO/NOM"][:].tobytes(), "i1")
    first = families.create_group("Shared_1")
    first.create_group("GRO").create_dataset("NOM", data=np.tile(names, 2000))
    for number in range(1, 9):
        family = families.require_group(f"Shared_{number}")
        family.attrs["NUM"] = -100 - number
        if number > 1:
            family["GRO"] = first["GRO"]


def overlap():
    """`old` with families whose names are ends of one long name."""
    places = range(10)
    shutil.copy("old.med", "wrong_overlap.med")
    long = b"F" * 2000
    with h5py.File("wrong_overlap.med", "r+", libver="earliest") as file:
        families = file["ENS_MAA/kinds/FAS"]
        for name in (long.decode(), *(f"OVERLAP_{place}" for place in places)):
            families.create_group(name).attrs["NUM"] = np.int32(0)
    with open("wrong_overlap.med", "rb") as file:
        data = bytearray(file.read())
    # a name is an offset in the data of a heap, whose address is 24 bytes behind its beginning; the entries of a symbol
    # node have 40 bytes each
    heaps = [at.start() for at in re.finditer(b"HEAP", bytes(data))]
    begins = [int.from_bytes(data[at + 24 : at + 32], "little") for at in heaps]
    begin = max(begin for begin in begins if begin <= data.index(long))
    changed = 0
    for place in places:
        old = (data.index(b"OVERLAP_%d\0" % place) - begin).to_bytes(8, "little")
        new = (data.index(long) - begin + place).to_bytes(8, "little")
        for node in re.finditer(b"SNOD", bytes(data)):
            count = int.from_bytes(data[node.start() + 6 : node.start() + 8], "little")
            for entry in range(node.start() + 8, node.start() + 8 + 40 * count, 40):
                if data[entry : entry + 8] == old:
                    data[entry : entry + 8] = new
                    changed += 1
    assert changed == len(places), changed
    with open("wrong_overlap.med", "wb") as file:
        file.write(data)


def mirror(file, mesh, step):
    for kind, order in MIRRORED.items():
        replaced(step["MAI"][kind], "NOD", step["MAI"][kind]["NOD"][:][order])


gmsh.initialize()
gmsh.option.setNumber("General.Verbosity", 1)
for order in (1, 2):
    kinds(order)
many()
old()
cover()

wrong("version", lambda file, mesh, step: file["INFOS_GENERALES"].attrs.modify("MAJ", 5))
wrong("no_version", lambda file, mesh, step: file.__delitem__("INFOS_GENERALES"))
wrong("no_mesh", lambda file, mesh, step: file.__delitem__("ENS_MAA"))
wrong("meshes", lambda file, mesh, step: file.copy(mesh, "ENS_MAA/other"))
wrong("steps", lambda file, mesh, step: file.copy(step, mesh.name + "/" + "0" * 19 + "1" + "0" * 19 + "1"))
wrong("structured", lambda file, mesh, step: mesh.attrs.modify("TYP", 1))
wrong("cylindrical", lambda file, mesh, step: mesh.attrs.modify("REP", 1))
wrong("part", lambda file, mesh, step: step["NOE"].create_dataset("GLB", data=np.arange(12)))
wrong("packed", lambda file, mesh, step: replaced(step["NOE"], "COO", step["NOE/COO"][:], compression="gzip"))
wrong("polyhedra", lambda file, mesh, step: step["MAI"].create_group("POE"))
wrong("middle", lambda file, mesh, step: step["MAI"].create_group("H27").create_dataset("NOD", data=np.ones(27, "i8")))
wrong("node", lambda file, mesh, step: with_node(step, 13))
wrong("no_node", lambda file, mesh, step: with_node(step, 0))
wrong("odd", lambda file, mesh, step: replaced(step["MAI/HE8"], "NOD", np.ones(9, "i8")))
wrong("reals", lambda file, mesh, step: replaced(step["MAI/HE8"], "NOD", np.ones(8)))
wrong("infinite", lambda file, mesh, step: replaced(step["NOE"], "COO", np.full(36, np.inf)))
wrong("numbers", lambda file, mesh, step: step["NOE"].create_dataset("NUM", data=np.ones(12, "i8")))
wrong("no_nodes", lambda file, mesh, step: step.__delitem__("NOE"))
wrong("no_solids", lambda file, mesh, step: [step["MAI"].__delitem__(kind) for kind in ("HE8", "PE6", "PY5", "TE4")])
wrong("no_groups", lambda file, mesh, step: file.__delitem__("FAS"))
wrong("unknown", lambda file, mesh, step: (file.create_group("CHA"), file.create_group("STRUCT_ELEM")))
wrong("lost", lose)
wrong("shared", share)
overlap()

changed("mirrored", "kinds2", mirror)
