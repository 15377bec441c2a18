"""Distributed loads on beams and their contacts, as forces at their nodes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal

from pydantic import Field, field_validator

from ...errors import InputError
from ...reading.did_you_mean import did_you_mean
from ...reading.fields import Described
from ...reading.files.quoted import quoted
from .discretise import Line


class DistributedLoad(Described):
    """Force per length along a whole beam: an entry of the forces of a scene.

    It becomes one force for each node, with the name of the node after its own and a dot.
    """

    type: Literal["distributed_load"] = "distributed_load"
    beam: str = Field(description="name of the beam")
    force: tuple[float | str, ...] = Field(
        description="components per length, N/m: numbers or formulas of time and of measured quantities"
    )
    axes: Literal["ground", "section"] = Field(
        "ground",
        description="axes of the components: the ground's, or those of the section, which rotate with the node",
    )

    @field_validator("force")
    @classmethod
    def _components(cls, force: tuple[object, ...]) -> tuple[object, ...]:
        if len(force) not in (2, 3):
            raise ValueError(f"found {len(force)} components, expected two in the plane or three in space")
        return force


def node_forces(name: str, load: DistributedLoad, lines: Mapping[str, Line], where: str) -> dict[str, object]:
    """Return the nodal forces of a distributed load, as entries of a scene.

    Nodes have the same shares of the load as of the mass. Raises InputError if the load names an unknown beam.
    """
    axes = {"axes": "body"} if load.axes == "section" else {}
    return {
        f"{name}.{node.name}": {
            "type": "force", "i": f"{load.beam}.{node.name}", "force": [_times(part, node.share) for part in load.force], **axes
        }
        for node in _line(load.beam, lines, where).nodes
    }  # fmt: skip


def node_contacts(
    name: str, entry: Mapping[str, object], lines: Mapping[str, Line], where: str, kind: str
) -> dict[str, object]:
    """Return the contacts of nodes of an entry ``beam_contact``, as entries of a scene.

    They are of the given kind and have its fields, with `beam` in place of `i`. The stiffness is per length of the beam; the
    radius of a node is by default the radius of its section. Raises InputError for an unknown beam or without a stiffness.
    """
    if "i" in entry:
        raise InputError(f"{where}.i: found a marker of a beam contact, expected 'beam' only")
    for key in ("beam", "stiffness"):
        if entry.get(key) is None:
            raise InputError(f"{where}.{key}: found nothing, expected a value (the key is required)")
    fields = {key: value for key, value in entry.items() if key not in ("beam", "stiffness")}
    stiffness = entry["stiffness"]
    return {
        f"{name}.{node.name}": {
            "radius": node.radius, "exponent": 1.0, **fields, "type": kind, "i": f"{entry['beam']}.{node.name}",
            "stiffness": f"({node.share!r} m)*({stiffness})" if isinstance(stiffness, str) else _product(stiffness, node.share),
        }
        for node in _line(entry["beam"], lines, where).nodes
    }  # fmt: skip


def _line(beam: Any, lines: Mapping[str, Line], where: str) -> Line:
    if beam not in lines:
        near = did_you_mean(beam, lines)
        raise InputError(
            f"{where}.beam: found the unknown beam '{quoted(beam)}'{near}, expected {', '.join(lines) or 'one of type beam'}"
        )
    return lines[beam]


def _product(stiffness: Any, length: float) -> Any:
    """Return a stiffness from one per length; other entries as they are, for the message of the contact."""
    return stiffness * length if type(stiffness) in (int, float) else stiffness


def _times(component: float | str, length: float) -> float | str:
    """Return a force from a force per length; a formula keeps its units, and a plain number is in N/m."""
    return f"({length!r} m)*(({component}) + 0 N/m)" if isinstance(component, str) else component * length
