"""Distributed and moving loads on beams, and their contacts, as forces at their nodes."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence
from typing import Annotated, Any, Literal

from pydantic import Field, field_validator

from ...errors import InputError
from ...reading.did_you_mean import did_you_mean
from ...reading.fields import Described
from ...reading.files.quoted import quoted
from ...reading.units import si
from .discretise import SAME, Line
from .interpolation import shapes

PLACE = "x"
"""Name in formulas of the distance from the start of a beam."""
_PLACE = re.compile(rf"(?<![\w.]){PLACE}(?![\w.]|\s*\()")


Component = Annotated[float, Field(strict=True, allow_inf_nan=False)] | str


class _Load(Described):
    """Load on a beam: an entry of the forces of a scene.

    It becomes one force for each node, with the name of the node after its own and a dot.
    """

    beam: str = Field(description="name of the beam")
    force: tuple[Component, ...]
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

    def at(self, node: str, components: list[float | str]) -> dict[str, object]:
        """Return the force at a node as an entry of a scene."""
        axes = {"axes": "body"} if self.axes == "section" else {}
        return {"type": "force", "i": f"{self.beam}.{node}", "force": components, **axes}


class DistributedLoad(_Load):
    """Force per length along a beam or a part of it."""

    type: Literal["distributed_load"] = "distributed_load"
    force: tuple[Component, ...] = Field(
        description="components per length, N/m: numbers or formulas of time, of measured quantities and of x, the distance from the start along the axis, m"
    )
    first: si.Length | None = Field(None, description="x at the start of the load, m; the start of the beam by default")
    last: si.Length | None = Field(None, description="x at the end of the load, m; the end of the beam by default")


class MovingLoad(_Load):
    """Force at a place that moves along a beam, such as a wheel on a bridge."""

    type: Literal["moving_load"] = "moving_load"
    force: tuple[Component, ...] = Field(
        description="components, N: numbers or formulas of time and of measured quantities"
    )
    place: Component = Field(
        description="distance of the force from the start along the axis, m: a formula of time and of measured quantities; there is no force beyond the ends"
    )


def node_forces(
    name: str, load: DistributedLoad, lines: Mapping[str, Line], where: str, names: Collection[str]
) -> dict[str, object]:
    """Return the nodal forces of a distributed load, as entries of a scene.

    Each has the load at the node times a length that lumps the mass. In an interval that is loaded in part, it has the
    integral of the load times the shape of the node. `names`: those of the parameters, variables, states and inputs of the
    scene. Raises InputError if the load names an unknown beam, has a part beyond it, or a formula of x, which is one of the names.
    """
    line = _line(load.beam, lines, where)
    if PLACE in names and any(isinstance(part, str) and _PLACE.search(part) for part in load.force):
        raise InputError(
            f"{where}.force: found a name '{PLACE}' of the scene, which is the distance from the start of the beam here, "
            "expected another name of the parameter, variable, state or input"
        )
    total = line.divided.length
    first, last = 0.0 if load.first is None else load.first, total if load.last is None else load.last
    if not 0 <= first < last <= total * (1 + SAME):
        raise InputError(
            f"{where}: found a load from {first:g} to {last:g} m, expected a part of the beam, 0 to {total:g} m"
        )
    return {
        f"{name}.{node.name}": load.at(node.name, [_times(part, lengths) for part in load.force])
        for node, lengths in zip(line.nodes, line.shares(first, last), strict=True)
        if lengths
    }


def moving_forces(name: str, load: MovingLoad, lines: Mapping[str, Line], where: str) -> dict[str, object]:
    """Return the nodal forces of a moving load, as entries of a scene: the load times the shape of the node at its place.

    Raises InputError if the load names an unknown beam.
    """
    line = _line(load.beam, lines, where)
    shares: list[list[str]] = [[] for _ in line.nodes]
    for span in line.spans:
        length = span.end - span.start
        for first, fractions in span.group.polynomials():
            start, end = (line.nodes[span.first + first + k].s for k in (0, len(fractions) - 1))
            to = f"(({load.place}) + 0 m - ({start!r} m))"
            is_last = span.first + first + len(fractions) == len(line.nodes)
            for k, column in enumerate(shapes((fractions - fractions[0]) * length / (end - start)).T.tolist()):
                shares[span.first + first + k].append(_within(to, end - start, column, is_last))
    return {
        f"{name}.{node.name}": load.at(node.name, [f"({' + '.join(share)})*(({part}) + 0 N)" for part in load.force])
        for node, share in zip(line.nodes, shares, strict=True)
    }


def _within(to: str, length: float, coefficients: Sequence[float], is_last: bool) -> str:
    """Return a polynomial of a place, relative to a length of the beam, within it and 0 beyond; highest power first.

    The end belongs to the next part, and that of the last part to the beam.
    """
    value = repr(coefficients[0])
    for coefficient in coefficients[1:]:
        value = f"({value}*{to}/({length!r} m) + {coefficient!r})"
    return f"branch({to}, 0, {value}, branch(({length!r} m) - {to}, 0, {value if is_last else '0'}, {value}))"


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


def _times(component: float | str, lengths: Mapping[float, float]) -> float | str:
    """Return a force from a force per length and lengths by place; a formula keeps its units, and a plain number is in N/m."""
    if not isinstance(component, str):
        return component * sum(lengths.values())
    if not _PLACE.search(component):
        return f"({sum(lengths.values())!r} m)*(({component}) + 0 N/m)"
    return " + ".join(
        f"({length!r} m)*(({_PLACE.sub(f'({x!r} m)', component)}) + 0 N/m)" for x, length in lengths.items()
    )
