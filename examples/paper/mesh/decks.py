"""Writes meshes for other codes: Nastran bulk data and Abaqus input, compressed, the same bytes for the same mesh."""

import gzip
import io

from solids import Ring


def pack(text):
    """Compresses without name and time, so that the bytes depend on the content alone."""
    packed = io.BytesIO()
    with gzip.GzipFile(filename="", mode="wb", compresslevel=9, fileobj=packed, mtime=0) as file:
        file.write(text.encode("ascii"))
    return packed.getvalue()


def describe(part):
    """Comment lines that describe the sets."""
    for name, chosen in part.sets.items():
        place = part.places[name]
        if isinstance(place, Ring):
            center = ", ".join(f"{x:g}" for x in place.center)
            surface = f"radius {place.radius:g}, width {place.width:g}, axis {'xyz'[place.axis]}"
            yield f"{name}: {len(chosen)} nodes on {surface}, center [{center}]"
        else:
            yield f"{name}: {len(chosen)} nodes in the plane {'xyz'[place.axis]} = {place.at:g}"


def nastran_real(x):
    """A real in eight columns."""
    text = f"{x:.5E}"
    mantissa, exponent = text.split("E")
    mantissa = mantissa.rstrip("0")
    return f"{mantissa}{int(exponent):+d}".rjust(8)


def nastran(part, title):
    """Bulk data: MAT1, PSOLID, GRID*, CTETRA of ten nodes, SET1 a set (numbers in the order of the sets, from 1)."""
    lines = [f"$ {title}", "$ made by make.py; PARAM,COUPMASS,1 gives the consistent mass"]
    lines += [f"$ SET1 {number} {line}" for number, line in enumerate(describe(part), 1)]
    lines += ["BEGIN BULK"]
    m = part.material
    figures = (m.young_mpa, m.poisson, m.density_t_mm3)
    young, poisson, density = map(nastran_real, figures)
    lines.append(f"MAT1    {1:8d}{young}{'':8s}{poisson}{density}")
    lines.append(f"PSOLID  {1:8d}{1:8d}")
    for i, (x, y, z) in enumerate(part.nodes, 1):
        lines.append(f"GRID*   {i:16d}{'':16s}{x:16.6f}{y:16.6f}*")
        lines.append(f"*       {z:16.6f}")
    for i, element in enumerate(part.elements + 1, 1):
        head, tail = element[:6], element[6:]
        lines.append(f"CTETRA  {i:8d}{1:8d}" + "".join(f"{n:8d}" for n in head) + "+")
        lines.append("+       " + "".join(f"{n:8d}" for n in tail))
    for number, chosen in enumerate(part.sets.values(), 1):
        ids = [int(n) + 1 for n in chosen]
        lines.append(f"SET1    {number:8d}" + "".join(f"{n:8d}" for n in ids[:7]))
        for k in range(7, len(ids), 8):
            lines[-1] += "+"
            lines.append("+       " + "".join(f"{n:8d}" for n in ids[k : k + 8]))
    lines.append("ENDDATA")
    return pack("\n".join(lines) + "\n")


def abaqus_lines(part, title):
    """Lines of the mesh with its sets and material."""
    yield f"** {title}"
    yield "** made by make.py"
    for line in describe(part):
        yield f"** {line}"
    yield "*NODE, NSET=ALL"
    for i, (x, y, z) in enumerate(part.nodes, 1):
        yield f"{i},{x:.6f},{y:.6f},{z:.6f}"
    yield "*ELEMENT, TYPE=C3D10, ELSET=SOLID"
    for i, element in enumerate(part.elements + 1, 1):
        yield f"{i}," + ",".join(map(str, element))
    for name, chosen in part.sets.items():
        yield f"*NSET, NSET={name}"
        ids = [int(n) + 1 for n in chosen]
        for k in range(0, len(ids), 12):
            yield ",".join(map(str, ids[k : k + 12]))
    yield "*MATERIAL, NAME=METAL"
    yield "*ELASTIC"
    yield f"{part.material.young_mpa:g},{part.material.poisson:g}"
    yield "*DENSITY"
    yield f"{part.material.density_t_mm3:g}"
    yield "*SOLID SECTION, ELSET=SOLID, MATERIAL=METAL"


def abaqus(part, title):
    """Abaqus and CalculiX input: nodes, C3D10, node sets, material."""
    return pack("\n".join(abaqus_lines(part, title)) + "\n")
