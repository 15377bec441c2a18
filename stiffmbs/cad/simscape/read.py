"""Assemblies from Simscape Multibody XML.

The format is that of Simscape Multibody Link and of smexportonshape, as read by smimport: parts with mass properties, a
tree of their instances, constraints between points, lines and planes of instances, and joints between frames. MathWorks,
Simscape Multibody User's Guide, 'CAD Translation'.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Final

import numpy as np

from ...reading.files.quoted import listed
from ...reading.files.requested import unused_notes
from ...reading.files.xml_nodes import Node, parsed
from ...robots.robot import Link
from ..assembly import WORLD, Assembly, CadFault, Part, Seat, Tie
from .ends import Ends
from .instances import Instance, loose, numbers, readable, tied, tree
from .mates import Left, joint, mate

ROOT, FIRST = "SimscapeMultibodyImportXML", "PhysicalModelingXMLFile"
GRAVITY: Final = (0.0, 0.0, -9.80665)
"""Gravity that smimport gives a model, m/s^2; the files state none."""
RUN = {"duration": 1, "output": 0.01}
"""Default run settings, which the files lack."""
MASSES = {"kilogram": 1.0, "kg": 1.0, "gram": 1e-3, "g": 1e-3, "tonne": 1e3, "t": 1e3, "milligram": 1e-6, "mg": 1e-6,
          "pound": 0.45359237, "lbm": 0.45359237, "lb": 0.45359237, "ounce": 0.028349523125, "oz": 0.028349523125,
          "slug": 14.59390293720636}  # fmt: skip
LENGTHS = {"meter": 1.0, "m": 1.0, "centimeter": 1e-2, "cm": 1e-2, "millimeter": 1e-3, "mm": 1e-3, "micrometer": 1e-6,
           "um": 1e-6, "kilometer": 1e3, "km": 1e3, "inch": 0.0254, "in": 0.0254, "foot": 0.3048, "ft": 0.3048,
           "yard": 0.9144, "yd": 0.9144}  # fmt: skip
"""Units by their names in the files: kg, m."""
SHAPES, FILES = "shapes are not read", "files of the CAD program are not read"
REASONS: Mapping[str, Mapping[str, str]] = {
    "Parts/Part": {"<GeometryFile>": SHAPES, "<VisualProperties>": SHAPES, "<PartFile>": FILES},
    "RootAssembly": {"<AssemblyFile>": FILES}, "Assemblies/Assembly": {"<AssemblyFile>": FILES},
}  # fmt: skip
"""Reasons why attributes and children have no effect."""


def read_simscape(text: str) -> Assembly:
    """Read an assembly from Simscape Multibody XML.

    Grounded instances are fixed to ground, and those of one rigid subassembly or group to each other. Raises CadFault if
    the text is not of this format; names the instance, part or constraint.
    """
    root = parsed(text, "Simscape Multibody XML", {})
    if root.tag != ROOT:
        what = (
            " of the first generation, which is not supported; export the assembly again with the current plug-in"
            if root.tag == FIRST
            else f", expected <{ROOT}>"
        )
        raise CadFault(f"found <{root.tag}>{what}")
    assembly = root.find("RootAssembly")
    if assembly is None:
        raise CadFault("found no <RootAssembly>, expected one")
    for node in (root, assembly, *root.findall("Parts/Part"), *root.findall("Assemblies/Assembly")):
        node.get("version")
    data, name = root.find("DataUnits"), assembly.get("name") or "assembly"
    units = _units(data if data is not None else root.find("ModelUnits"), "the file")
    root.without_effect("Created")
    if data is not None:  # the units of drawings
        for node in (root, *root.findall("Parts/Part"), *root.findall("Assemblies/Assembly")):
            node.without_effect("ModelUnits")
    top = tree(assembly, assembly.get("uid") or "", units[1])
    links = dict(_links(root, None if data is None else units, units[1]))
    notes: list[str] = []
    parts = tuple(_parts(top, links, notes))
    ties = (*_rigid(top), *_mates(root, assembly, top, units[1], notes))
    held = {seat.part for tie in ties for seat in (tie.i, tie.j)}
    empty = [part.name for part in parts if part.link.mass == 0 and part.name not in held]
    if empty:
        notes.append(f"parts with neither mass nor mates are left out: {listed(empty)}")
    if unfixed := loose(top):
        notes.append(
            f"subassemblies in which no part is fixed are not fixed to ground or their group: {listed(unfixed)}"
        )
    notes.append("the file states no gravity; 9.80665 m/s^2 along -z is used, as in smimport")
    kept = tuple(part for part in parts if part.name not in empty)
    return Assembly(
        name, kept, ties, GRAVITY, dict(RUN), notes=(*notes, *unused_notes(root.fields(), REASONS))
    )  # fmt: skip


def _units(node: Node | None, where: str) -> tuple[float, float]:
    """Return the units of mass and length, kg and m."""
    found = []
    for key, known in (("mass", MASSES), ("length", LENGTHS)):
        name = "" if node is None else node.get(key) or ""
        if name.lower() not in known:
            raise CadFault(f"{where}: found the unit of {key} '{name}', expected one of {', '.join(known)}")
        found.append(known[name.lower()])
    return found[0], found[1]


def _links(root: Node, units: tuple[float, float] | None, length: float) -> Iterator[tuple[str, Link]]:
    """Yield the mass properties of each part by its uid. `units`: of the data, those of each part if None."""
    known = set()
    for node in root.findall("Parts/Part"):
        uid = node.get("uid") or ""
        where = f"part {node.get('name') or uid}"
        if uid in known:
            raise CadFault(f"{where}: found the uid '{uid}' twice, expected it once")
        known.add(uid)
        kg, m = units or _units(node.find("ModelUnits"), where)
        if m != length:
            raise CadFault(
                f"{where}: its unit of length differs from that of the assembly; change it in the CAD program and export again"
            )
        mass, centre, inertia = 0.0, np.zeros(3), np.zeros((3, 3))
        if (properties := node.find("MassProperties")) is not None:
            mass = float(numbers(where, properties, "Mass", 1)[0]) * kg
            centre = numbers(where, properties, "CenterOfMass", 3) * m
            xx, yy, zz, yz, zx, xy = numbers(where, properties, "Inertia", 6) * kg * m**2
            inertia = np.array([[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]])
        if mass < 0:
            raise CadFault(f"{where}: found a mass of {mass:g} kg, expected 0 or more")
        yield (
            uid,
            Link(
                where.removeprefix("part "), None, mass=mass, center_of_mass=tuple(map(float, centre)), inertia=inertia
            ),
        )


def _parts(top: Instance, links: Mapping[str, Link], notes: list[str]) -> Iterator[Part]:
    unknown = []
    for one in top.leaves():
        link = links.get(one.entity)
        if link is None:
            unknown.append(one.label)
        yield Part(one.label, link or Link(one.label, None), one.frame)
    if unknown:
        notes.append(f"instances of parts that the file does not describe have no mass: {listed(unknown)}")


def _rigid(top: Instance) -> Iterator[Tie]:
    """Yield the fixed joints of parts that move as one, or are grounded."""
    for part, other in tied(top):
        if other is None:
            yield Tie(f"{part.label}_ground", "fixed", Seat(part.label, WORLD), Seat(None, part.frame))
        else:
            yield Tie(
                f"{part.label}_rigid",
                "fixed",
                Seat(part.label, WORLD),
                Seat(other.label, part.frame.within(other.frame)),
            )


def _mates(root: Node, assembly: Node, top: Instance, length: float, notes: list[str]) -> Iterator[Tie]:
    """Yield the joints of the constraints and joints of all assemblies; those of one are repeated for its instances."""
    described = {node.get("uid") or "": node for node in root.findall("Assemblies/Assembly")}
    left: dict[str, list[str]] = {}
    for owner in top.below():
        node = assembly if owner is top else described.get(owner.entity)
        if node is None or (owner is not top and not owner.children):
            continue
        ends = Ends(top, owner, length)
        for section, made in (("Constraints", mate), ("Joints", joint)):
            for one in (child for found in node.findall(section) for child in found.children()):
                name = f"{owner.label}/{readable(one.get('name'), one.tag)}".removeprefix("/")
                try:
                    yield from made(name, one, ends)
                except Left as reason:
                    left.setdefault(str(reason), []).append(name)
    notes += [f"mates are left out ({reason}): {listed(found)}" for reason, found in left.items()]
