"""Writes each mesh of a distorted block three times, as `.msh`, `.unv` and `.med`, by gmsh 4.15."""
import gmsh


def block(name, kind, order):
    gmsh.model.add(name)
    gmsh.option.setNumber("Mesh.SecondOrderIncomplete", 1)
    gmsh.option.setNumber("Mesh.MeshSizeMin", 18)
    gmsh.option.setNumber("Mesh.MeshSizeMax", 18)
    geo = gmsh.model.geo
    corners = [(0, 0), (60, 3), (57, 21), (-2, 18)]
    points = [geo.addPoint(x, y, 0) for x, y in corners]
    lines = [geo.addLine(points[i], points[(i + 1) % 4]) for i in range(4)]
    base = geo.addPlaneSurface([geo.addCurveLoop(lines)])
    if kind != "tet":
        for line, count in zip(lines, [4, 3, 4, 3]):
            geo.mesh.setTransfiniteCurve(line, count)
        geo.mesh.setTransfiniteSurface(base)
    if kind == "hex":
        geo.mesh.setRecombine(2, base)
    layers = [] if kind == "tet" else [2]
    geo.extrude([(2, base)], 2, 1, 15, layers, recombine=kind != "tet")
    geo.synchronize()
    gmsh.model.mesh.generate(3)
    gmsh.model.mesh.setOrder(order)
    # both files print these digits in full
    tags, places, _ = gmsh.model.mesh.getNodes()
    for i, tag in enumerate(tags):
        place = [round(x * 1024) / 1024 for x in places[3 * i:3 * i + 3]]
        gmsh.model.mesh.setNode(tag, place, [])
    gmsh.model.addPhysicalGroup(3, [t for _, t in gmsh.model.getEntities(3)], 11, "BLOCK")
    left, right = [], []
    for _, tag in gmsh.model.getEntities(2):
        box = gmsh.model.getBoundingBox(2, tag)
        left += [tag] if box[3] < 5 else []
        right += [tag] if box[0] > 50 else []
    gmsh.model.addPhysicalGroup(2, left, 21, "LEFT")
    gmsh.model.addPhysicalGroup(2, right, 22, "RIGHT")
    gmsh.option.setNumber("Mesh.SaveGroupsOfNodes", 1)
    gmsh.write(name + ".msh")
    gmsh.write(name + ".unv")
    gmsh.write(name + ".med")
    gmsh.model.remove()


gmsh.initialize()
for kind in ("tet", "hex", "wedge"):
    for order in (1, 2):
        block(f"{kind}{order}", kind, order)
