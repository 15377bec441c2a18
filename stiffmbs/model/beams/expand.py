"""Expansion of the beams of a scene into bodies and forces, before validation."""

from __future__ import annotations

from collections.abc import Collection, Mapping

from ...elements.body import FLEXIBLE, check_names
from ...errors import InputError, prefixed
from ...reading.did_you_mean import did_you_mean
from ...reading.fields import is_valid, located
from ...reading.files.quoted import quoted
from ...reading.files.yaml_text import Content
from ..model_data import RESERVED
from .beam import Beam
from .discretise import Line
from .division import record_beams
from .entries import CONTACT, LOAD, MOVING
from .expanded import expanded
from .loads import DistributedLoad, MovingLoad, moving_forces, node_contacts, node_forces
from .planar import BeamBody as PlanarBeam
from .spatial import BeamBody as SpatialBeam

BEAM = "beam"


def expand_beams(
    bodies: Content,
    forces: object,
    parameters: Mapping[str, object],
    names: Collection[str],
    dimensions: object,
    where: str,
    instance: str,
) -> tuple[Content, object]:
    """Return the bodies and forces of a scene or part with beams replaced by their nodes and elements.

    The entries are as written, with repeated ones expanded. `where` is the path of the bodies for messages, `instance`
    the name of the part followed by a dot, for the record of all beams. `names`: further names in formulas. InputError if a beam cannot be read, or one of
    its names is taken.
    """
    found: Content = {}
    added: Content = {}
    lines: dict[str, Line] = {}
    of_beams: set[str] = set()
    for name, entry in bodies.items():
        if not (isinstance(entry, dict) and entry.get("type", FLEXIBLE) != FLEXIBLE):
            found[name] = entry
            continue
        _check_name(name, f"{where}.{name}")
        beam = read_beam(entry, parameters, dimensions, f"{where}.{name}")
        with prefixed(f"{where}.{name}.", ValueError):
            made = expanded(str(name), beam)
        taken = next((full for full in made.bodies if full in bodies), None)
        if taken is not None:
            raise InputError(f"{where}.{taken}: found the name of a node of the beam '{name}', expected another")
        found |= made.bodies
        added |= made.forces
        of_beams |= made.forces.keys()
        lines[str(name)] = made.line
    if not (forces is None or isinstance(forces, dict)):
        return found, forces
    for name, entry in (forces or {}).items():
        if name in added:
            raise InputError(f"forces.{name}: found a name that a beam makes too, expected another")
        loads = _loads(
            name, entry, lines, f"{where.removesuffix('bodies')}forces.{name}", dimensions, parameters, names
        )
        of_beams |= loads.keys() - {name}
        added |= loads
    divided = {f"{instance}{name}": line.divided for name, line in lines.items()}
    record_beams(divided, [f"{instance}{name}" for name in of_beams])
    return found, added


def _check_name(name: object, where: str) -> None:
    with prefixed(f"{where.rpartition('.')[0]}: ", ValueError):
        check_names([name], "entry")
    if name in RESERVED:
        raise InputError(f"{where}: found the name '{name}', which is reserved, expected another")


def _loads(
    name: str,
    entry: object,
    lines: Mapping[str, Line],
    where: str,
    dimensions: object,
    parameters: Mapping[str, object],
    names: Collection[str],
) -> dict[str, object]:
    """Return the forces of a load or a contact of a beam; other forces as they are."""
    if not isinstance(entry, dict):
        return {name: entry}
    kind = entry.get("type")
    if kind == CONTACT:
        return node_contacts(name, entry, lines, where, "sphere_contact" if dimensions == 3 else "contact")
    if kind not in (LOAD, MOVING):
        return {name: entry}
    context = {"parameters": parameters}
    with located(where):
        if kind == MOVING:
            return moving_forces(name, MovingLoad.model_validate(entry, context=context), lines, where)
        load = DistributedLoad.model_validate(entry, context=context)
    return node_forces(name, load, lines, where, {*parameters, *names})


def read_beam(entry: Mapping[str, object], parameters: Mapping[str, object], dimensions: object, where: str) -> Beam:
    """Return the beam of an entry. Raises InputError if it has another type, or cannot be read."""
    kind = entry["type"]
    if kind != BEAM:
        near = did_you_mean(kind, [BEAM, FLEXIBLE]) if isinstance(kind, str) else ""
        raise InputError(
            f"{where}.type: found '{quoted(kind)}'{near}, expected {BEAM}, {FLEXIBLE}, or no type for a rigid body"
        )
    context = {"parameters": parameters}
    try:
        with located(where):
            return (SpatialBeam if dimensions == 3 else PlanarBeam).model_validate(entry, context=context)
    except InputError:
        if dimensions != 3 and is_valid(SpatialBeam, entry, context):
            raise InputError("dimensions: found none, expected 3 for beams in space") from None
        raise
