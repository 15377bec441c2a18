"""Conversion of an assembly to a scene mapping."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from ..elements.spatial.number_format import quaternion, vector
from ..elements.spatial.orientation import IDENTITY
from ..reading.files.quoted import listed
from ..reading.files.yaml_text import Content
from ..reading.marker import GROUND
from ..robots.scene.joints import Masses, motion, odd_inertias, rigid_body
from ..robots.scene.mechanism import Names
from .assembly import Assembly, Part, Seat, Tie


def scene(assembly: Assembly) -> Content:
    """Return the scene of an assembly for `stiffmbs.model.read_scene.read_scene`."""
    names = Names()
    called: dict[str | None, str] = {None: GROUND}
    for part in assembly.parts:
        called[part.name] = names.take(part.name)
    notes = list(assembly.notes)
    if not any(part.link.mass for part in assembly.parts):
        assembly = replace(
            assembly, parts=tuple(replace(part, link=replace(part.link, mass=1.0)) for part in assembly.parts)
        )
        notes.append("no part has a mass; 1 kg is used for each, so the forces have no meaning")
    masses = Masses([part.link for part in assembly.parts], [part.placed for part in assembly.parts], "part")
    markers: dict[str, Content] = {}
    ties = [(names.take(tie.name), tie) for tie in assembly.ties]
    joints = {tie.name: name for name, tie in reversed(ties)}
    found: Content = {
        "name": assembly.name,
        "dimensions": 3,
        "gravity": vector(assembly.gravity),
        "joints": {name: _joint(tie, name, called, markers) for name, tie in ties},
    }
    for name, (joint, coordinate, law) in assembly.drives.items():
        found["joints"][names.take(name)] = {"type": "drive", "joint": joints[joint] + coordinate, "position": law}
    found["bodies"] = {
        called[part.name]: _body(part, masses, markers.get(called[part.name])) for part in assembly.parts
    }
    found["markers"] = markers.get(GROUND, {})
    found["run"] = assembly.run
    found["notes"] = [*notes, *_notes(assembly, called)]
    return {key: value for key, value in found.items() if value or key == "bodies"}


def _body(part: Part, masses: Masses, markers: Content | None) -> Content:
    pose = motion(part.placed, part.link.center_of_mass)
    return rigid_body(part.link, masses, "part") | pose | ({"markers": markers} if markers else {})


def _joint(tie: Tie, name: str, called: dict[str | None, str], markers: dict[str, Content]) -> Content:
    ends = [_marker(seat, f"{name}_{letter}", called, markers) for letter, seat in (("i", tie.i), ("j", tie.j))]
    if tie.equation:
        further = {key: _marker(seat, f"{name}_{key}", called, markers) for key, seat in tie.others.items()}
        return {"type": tie.kind, "i": ends[0], "zero": tie.equation.format(i=ends[0], j=ends[1], **further)}
    return {"type": tie.kind, "i": ends[0], "j": ends[1]} | dict(tie.fields)


def _marker(seat: Seat, name: str, called: dict[str | None, str], markers: dict[str, Content]) -> str:
    """Add a marker; return its reference in the scene."""
    placement: dict[str, object] = {}
    if seat.frame.position.any():
        placement["point"] = vector(seat.frame.position)
    turned = quaternion(seat.frame.axes)
    if tuple(turned) != IDENTITY:
        placement["orientation"] = turned
    markers.setdefault(called[seat.part], {})[name] = placement
    return f"{called[seat.part]}.{name}"


def _notes(assembly: Assembly, called: dict[str | None, str]) -> Iterator[str]:
    yield from odd_inertias({called[part.name]: part.link for part in assembly.parts})
    held = {seat.part for tie in assembly.ties for seat in (tie.i, tie.j)}
    free = [called[part.name] for part in assembly.parts if part.name not in held]
    if free:
        yield f"parts without a mate move freely: {listed(free)}"
    slight = [called[part.name] for part in assembly.parts if part.link.mass == 0]
    if slight:
        yield f"parts without mass are given 1e-8 of the lightest mass: {listed(slight)}"
