"""Assemblies from the text files of OndselSolver, which FreeCAD's assembly workbench writes.

The format is that of OndselSolver (github.com/FreeCAD/OndselSolver, classes ASMT...): parts with a principal mass marker,
markers on reference points, joints and motions between them, gravity, and times. It states no units; numbers are read as
m, kg, s and rad.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping

import numpy as np

from ...reading.files.quoted import listed, quoted
from ...reading.files.requested import unused_notes
from ...reading.files.yaml_text import Content
from ...robots.robot import Link
from ..assembly import WORLD, Assembly, CadFault, Frame, Part, Seat, Tie, rotation
from .joints import Ends, joint, kind_of
from .tree import Item, tree

SHAPES, STEPS, PICTURES = "shapes are not read", "the solver chooses its steps", "films are not read"
REASONS: Mapping[str, Mapping[str, str]] = {
    "Parts/Part": {"FeatureOrder": SHAPES, "Features": SHAPES, "RefCurves": SHAPES, "RefSurfaces": SHAPES},
    "SimulationParameters": {"*": STEPS},
    "": {"AnimationParameters": PICTURES}, "Assembly": {"AnimationParameters": PICTURES},
    "Parts/Part/PrincipalMassMarker": {"Density": SHAPES, "Name": SHAPES},
}  # fmt: skip
"""Reasons why entries have no effect."""
COORDINATES = {
    "RotationalMotion": {"RevoluteJoint": "", "CylindricalJoint": ".angle"},
    "TranslationalMotion": {"TranslationalJoint": "", "CylindricalJoint": ".displacement"},
}  # fmt: skip
"""Coordinate that a motion drives, by the motion and the kind of its joint."""
LAW = {"RotationalMotion": "RotationZ", "TranslationalMotion": "TranslationZ"}
FUNCTIONS = {"arcsin": "asin", "arctan": "atan", "asin": "asin", "sin": "sin", "cos": "cos", "abs": "abs"}
"""Functions of motions by their names in a scene."""
_NUMBER = re.compile(r"(?<![\w.])((?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)d(?!\w)")


def read_asmt(text: str) -> Assembly:
    """Read an assembly from the text of an .asmt file; raises CadFault with the line."""
    item, stored = tree(text)
    name = item.text("Name", "assembly")
    item.find("Notes")
    world = _frame(item, WORLD)
    parts = tuple(_part(one, world) for one in item.each("Parts") if one.label == "Part")
    frames: dict[str | None, Frame] = {None: WORLD} | {part.name: part.frame for part in parts}
    if len(frames) <= len(parts):
        raise CadFault("found two parts with one name, expected unique names")
    seats = dict[tuple[str, ...], Seat]()
    for path, seat in _markers(item, parts, world):
        if path in seats:
            raise CadFault(f"found two markers {'/'.join(path)}, expected unique names")
        seats[path] = seat
    sets = item.find("ConstraintSets")
    ties, notes, drives = [], list[str](), dict[str, tuple[str, str, str]]()
    if sets is not None:
        joints = sets.each("Joints")
        ties = list(_ties(joints, seats, frames, notes))
        drives = _drives(sets.each("Motions"), joints, item, {tie.name for tie in ties}, notes)
    gravity = item.numbers("ConstantGravity", (3,), np.zeros(3))
    if stored:
        notes.append("results in the file are not read; stiffmbs diff compares with them")
    notes.append("the file states no units; its numbers are read as m, kg, s and rad")
    return Assembly(
        name, parts, tuple(ties), tuple(map(float, gravity)), _run(item), drives, (*notes, *unused_notes(item.fields(), REASONS))
    )  # fmt: skip


def _frame(item: Item, outer: Frame) -> Frame:
    turned = item.numbers("RotationMatrix", (3, 3), np.eye(3))
    return Frame(
        item.numbers("Position3D", (3,), np.zeros(3)), rotation(f"line {item.line}, RotationMatrix", turned)
    ).on(outer)


def _part(item: Item, world: Frame) -> Part:
    name = item.text("Name")
    mass, centre, inertia = 0.0, np.zeros(3), np.zeros((3, 3))
    marker = item.find("PrincipalMassMarker")
    if marker is not None:
        principal = _frame(marker, WORLD)
        mass, centre = marker.number("Mass"), principal.position
        moments = marker.numbers("MomentOfInertias", (3,))
        inertia = (principal.axes * moments) @ principal.axes.T
        marker.find("Name")
    if mass < 0:
        raise CadFault(f"line {item.line}, {name}: found a mass of {mass:g}, expected 0 or more")
    link = Link(name, None, mass=mass, center_of_mass=tuple(map(float, centre)), inertia=(inertia + inertia.T) / 2)
    velocity, omega = (world.axes @ item.numbers(label, (3,), np.zeros(3)) for label in ("Velocity3D", "Omega3D"))
    return Part(name, link, _frame(item, world), velocity, omega)


def _markers(assembly: Item, parts: tuple[Part, ...], world: Frame) -> Iterator[tuple[tuple[str, ...], Seat]]:
    """Yield the markers by their names, with that of the part before it."""
    owners = [item for item in assembly.each("Parts") if item.label == "Part"]
    for part, item, frame in (
        (None, assembly, world),
        *((one.name, item, WORLD) for one, item in zip(parts, owners, strict=True)),
    ):
        for point in item.each("RefPoints"):
            outer = _frame(point, frame)
            for marker in point.each("Markers"):
                path = (marker.text("Name"),) if part is None else (part, marker.text("Name"))
                yield path, Seat(part, _frame(marker, outer))


def _ties(
    joints: list[Item], seats: Mapping[tuple[str, ...], Seat], frames: Mapping[str | None, Frame], notes: list[str]
) -> Iterator[Tie]:
    pairs = {id(item): tuple(_seat(item, label, seats) for label in ("MarkerI", "MarkerJ")) for item in joints}
    hinges: dict[str | None, set[str | None]] = {}
    for item in joints:
        i, j = pairs[id(item)]
        if kind_of(item) == "RevoluteJoint":
            hinges.setdefault(i.part, set()).add(j.part)
            hinges.setdefault(j.part, set()).add(i.part)
    turning = {part: frozenset(found) for part, found in hinges.items()}
    alone, known = [], set[str]()
    for item in joints:
        (i, j), name = pairs[id(item)], item.text("Name")
        if name in known:
            raise CadFault(f"line {item.line}: found two joints with the name {name}, expected unique names")
        known.add(name)
        if i.part == j.part:
            alone.append(name)
            continue
        drawn_i, drawn_j = (seat.frame.on(frames[seat.part]) for seat in (i, j))
        yield from joint(name, item, Ends(i, j, drawn_i, drawn_j, turning, frames))
    if alone:
        notes.append(f"joints with both markers on one part are left out: {listed(alone)}")


def _seat(item: Item, label: str, seats: Mapping[tuple[str, ...], Seat]) -> Seat:
    """Return the marker that a path such as /Assembly1/Part1/Marker1 names."""
    path = item.text(label)
    _, *names = path.removeprefix("/").split("/")
    for count in range(len(names)):  # names of parts may contain a slash
        key = tuple(part for part in ("/".join(names[:count]), "/".join(names[count:])) if part)
        if key in seats:
            return seats[key]
    raise CadFault(f"line {item.line}, {label}: found {quoted(path)}, expected the path of a marker")


def _drives(
    motions: list[Item], joints: list[Item], assembly: Item, held: set[str], notes: list[str]
) -> dict[str, tuple[str, str, str]]:
    """Return the drives: the coordinate of I relative to J is minus the motion of J relative to I. `held`: joints of the scene."""
    kinds = {one.text("Name"): kind_of(one) for one in joints}
    start = _times(assembly)[0]
    found: dict[str, tuple[str, str, str]] = {}
    alone = []
    for item in motions:
        name = item.text("Name")
        where = f"line {item.line}, {name}"
        if name in found:
            raise CadFault(f"{where}: found two motions {name}, expected unique names")
        if item.label not in COORDINATES:
            raise CadFault(f"{where}: found {item.label}, expected one of {', '.join(COORDINATES)}")
        of = item.text("MotionJoint").rpartition("/")[2]
        coordinate = COORDINATES[item.label].get(kinds.get(of, ""))
        if coordinate is None:
            expected = " or ".join(COORDINATES[item.label])
            raise CadFault(f"{where}: found a motion of {of}, expected the name of a {expected}")
        law = _law(where, item.text(LAW[item.label]), start)
        if of in held:
            found[name] = of, coordinate, f"-({law})"
        else:
            alone.append(name)
    if alone:
        notes.append(f"motions of joints that are left out are left out: {listed(alone)}")
    return found


def _law(where: str, text: str, start: float) -> str:
    """Return a function of ``time`` as a formula of a scene; numbers may end in d."""
    time = f"(t + {start!r})" if start else "t"
    known = {"time": time, "pi": "pi", **FUNCTIONS}
    plain = _NUMBER.sub(r"\1", text)

    def word(match: re.Match[str]) -> str:
        if match[0] not in known:
            raise CadFault(f"{where}: found {match[0]} in '{quoted(text)}', expected one of {', '.join(known)}")
        return known[match[0]]

    return re.sub(r"(?<![\w.])[A-Za-z_]\w*", word, plain)


def _times(assembly: Item) -> tuple[float, float, float | None]:
    item = assembly.find("SimulationParameters")
    if item is None:
        return 0.0, 1.0, None
    return item.number("tstart", 0.0), item.number("tend", 1.0), item.number("hout", 0.0)


def _run(assembly: Item) -> Content:
    start, end, step = _times(assembly)
    if not end > start:
        raise CadFault(f"SimulationParameters: found the times {start:g} to {end:g}, expected an end after the start")
    found: Content = {"duration": end - start}
    return found | ({"output": step} if step and 0 < step <= end - start else {"points": 101})
