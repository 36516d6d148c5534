"""Makes the meshes of the example: crank.bdf.gz (Nastran bulk data) and block.inp.gz (Abaqus input), both in mm, tonne, s.

    pip install -r requirements.txt
    python make.py              # both; `python make.py crank` or `block` for one
    python make.py --check      # writes nothing: compares the files with those that it would make

Change a number below and run again. The same numbers give the same bytes (with the versions in requirements.txt).

Axes of both parts: z along the crankshaft from the timing end to the flywheel, x up along the cylinders, y to the side, origin
in the middle of main bearing 3: those of the engine. Both parts are symmetric about the planes y = 0 and z = 0: a quarter
(y > 0, z < 0) is meshed and mirrored, so the symmetry of the meshes is exact.
"""

import sys
from dataclasses import dataclass
from pathlib import Path

import decks
import parts
import solids


@dataclass(frozen=True)
class Engine:
    """Common data of crank and block."""

    spacing_mm: float = 92.0  # between main bearings, and between cylinders
    throw_mm: float = 43.0  # crank radius: half the stroke
    bore_mm: float = 86.0  # of the cylinders
    main_diameter_mm: float = 54.0  # main journals
    shell_width_mm: float = 20.0  # of the main bearings
    deck_height_mm: float = 216.0  # crank axis to deck: throw + rod 143 + 30 above the wrist pin


@dataclass(frozen=True)
class Crank:
    """Forged steel crank: five mains, four pins (throws 0-180-180-0), eight webs, the same at both ends."""

    main_width_mm: float = 24.0  # between webs; no fillets
    pin_diameter_mm: float = 48.0
    pin_width_mm: float = 28.0  # between webs
    web_mm: float = 20.0  # thickness
    web_pin_radius_mm: float = 34.0  # round the pin
    web_pin_angle_deg: float = 100.0  # where that arc ends, from the crank's radius
    web_waist_mm: tuple = (4.0, 37.0)  # along the crank's radius, and half width
    counterweight_radius_mm: float = 73.0
    counterweight_angle_deg: float = 106.0  # where it begins, from the crank's radius: 90 is half a disc
    neck_diameter_mm: float = 46.0  # beyond the outer mains
    flange_diameter_mm: float = 80.0  # flywheel at one end, pulley and damper at the other
    flange_mm: float = 10.0  # thickness
    end_mm: float = 230.0  # faces of the flanges from the middle
    young_mpa: float = 206_000.0  # steel
    poisson: float = 0.29
    density_t_mm3: float = 7.85e-9
    size_mm: float = 13.0  # of elements
    journal_size_mm: float = 8.0  # at the journals


@dataclass(frozen=True)
class Block:
    """Grey-iron block with a deep skirt and one-piece bearing walls; no oil pan, no head."""

    wall_mm: float = 20.0  # bearing walls 2, 3, 4: as wide as their shells
    end_mm: float = 198.0  # faces of the block from the middle
    housing_diameter_mm: float = 58.0  # bores of the bearing walls; shells of 2 mm
    recess_diameter_mm: float = 80.0  # round the crank outside the outer shells
    cap_mm: tuple = (90.0, 58.0)  # bearing caps, bolted to the skirts: half width, depth below the crank's axis
    barrel_mm: float = 6.0  # thickness of the cylinders' walls
    barrel_foot_mm: float = 75.0  # lower end of the cylinders above the crank's axis
    floor_mm: float = 10.0  # of the water jacket
    deck_mm: float = 10.0  # thickness of the deck
    jacket_half_mm: float = 68.0  # half width outside, at the cylinders
    jacket_mm: float = 5.5  # thickness of the outer walls
    boss_mm: tuple = (18.0, 18.0)  # columns of the head bolts: across and along
    crankcase_half_mm: float = 90.0  # half width inside
    crankcase_mm: float = 7.0  # thickness of skirts
    shoulder_mm: float = 46.0  # above the crank's axis, where the skirts turn inward
    skirt_mm: float = 68.0  # depth of the skirts below the crank's axis
    rail_mm: tuple = (14.0, 9.0)  # pan rail: width beside the skirt, thickness
    mount_at_mm: float = 138.0  # lugs of the supports from the middle, along the crank
    mount_mm: tuple = (57.0, 24.0, 12.0)  # lugs: across, along, high
    mount_up_mm: float = 8.0  # their lower faces above the crank's axis
    mount_pad_mm: float = 22.0  # outer part of a lower face that stands on the support
    young_mpa: float = 98_000.0  # grey iron GJL-200: 88 to 113 GPa
    poisson: float = 0.26
    density_t_mm3: float = 7.2e-9
    size_mm: float = 32.0  # of elements
    bearing_size_mm: float = 11.0  # at the bearings
    barrel_size_mm: float = 13.2  # at the cylinders
    bridge_size_mm: float = 10.0  # between the bores in the middle
    mount_size_mm: float = 11.0  # at the lugs


def build(wanted=("crank", "block")):
    """The parts with these names."""
    engine, crank, block = Engine(), Crank(), Block()
    if "crank" in wanted:
        yield parts.mesh("crank", crank, lambda: solids.crank(engine, crank), solids.crank_sets(engine, crank))
    if "block" in wanted:
        yield parts.mesh("block", block, lambda: solids.block(engine, block), solids.block_sets(engine, block))


FILES = {
    "crank": ("crank.bdf.gz", lambda part: decks.nastran(part, "crank: steel, mm tonne s")),
    "block": ("block.inp.gz", lambda part: decks.abaqus(part, "block: grey iron, mm tonne s")),
}


def main(arguments):
    wanted = [word for word in arguments if word != "--check"] or list(FILES)
    for part in build(wanted):
        parts.report(part)
        name, write = FILES[part.name]
        path, content = Path(__file__).parent / name, write(part)
        if "--check" not in arguments:
            path.write_bytes(content)
            print(f"  {name}: {len(content) / 1e6:.2f} MB")
        elif path.read_bytes() != content:
            raise SystemExit(f"{name} is not what make.py makes")
        else:
            print(f"  {name} is what make.py makes")


if __name__ == "__main__":
    main(sys.argv[1:])
