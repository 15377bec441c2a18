"""Distributed loads on beams, as forces at their nodes."""

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
        "ground", description="whether the components are along the ground's axes, or follow those of the section"
    )

    @field_validator("force")
    @classmethod
    def _components(cls, force: tuple[Any, ...]) -> tuple[Any, ...]:
        if len(force) not in (2, 3):
            raise ValueError(f"found {len(force)} components, expected two in the plane or three in space")
        return force


def node_forces(name: str, load: DistributedLoad, lines: Mapping[str, Line], where: str) -> dict[str, Any]:
    """Return the forces that stand for a distributed load, as entries of a scene.

    The weights of the nodes are those of their masses. Raises InputError if the load names an unknown beam.
    """
    if load.beam not in lines:
        near = did_you_mean(load.beam, lines)
        raise InputError(
            f"{where}.beam: found the unknown beam '{quoted(load.beam)}'{near}, expected {', '.join(lines) or 'one of type beam'}"
        )
    axes = {"axes": "body"} if load.axes == "section" else {}
    return {
        f"{name}.{node.name}": {
            "type": "force", "i": f"{load.beam}.{node.name}", "force": [_times(part, node.share) for part in load.force], **axes
        }
        for node in lines[load.beam].nodes
    }  # fmt: skip


def _times(component: float | str, length: float) -> float | str:
    """Return a force from a force per length; a formula keeps its units, and a plain number is in N/m."""
    return f"({length!r} m)*(({component}) + 0 N/m)" if isinstance(component, str) else component * length
