"""Relations between joints of SDFormat files: gearboxes, mimicking joints, and joints that limits hold."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from ...reading.files.quoted import quoted
from ..robot import Relation, RobotFault
from .joints import AXES, BALL, GEARBOX, KINDS, Arc, limits
from .parameters import SDF
from .poses import number, text_of


def relations(arcs: Sequence[Arc]) -> Iterator[Relation]:
    """Yield the relations between joint coordinates."""
    by_name = {arc.name: arc for arc in arcs}
    for arc in arcs:
        if arc.kind == GEARBOX:
            yield _gearbox(arc, arcs)
            continue
        for name, axis in zip(_coordinates(arc), arc.axes, strict=True):
            mimic = axis.node.find("mimic")
            if mimic is not None:
                leader = _leader(arc, mimic.get("joint") or "", mimic.get("axis") or AXES[0], by_name)
                slope, offset, reference = (
                    number(arc.where, mimic, tag, default)
                    for tag, default in (("multiplier", 1.0), ("offset", 0.0), ("reference", 0.0))
                )
                yield Relation(f"{name}_mimic", name, leader, (offset - slope * reference, slope))
            elif (bounds := limits(arc, axis)) is not None and bounds[0] == bounds[1]:
                yield Relation(f"{name}_held", name, None, (bounds[0],))


def _coordinates(arc: Arc) -> list[str]:
    return [] if arc.kind == BALL else arc.names()


def _leader(arc: Arc, joint: str, axis: str, by_name: Mapping[str, Arc]) -> str:
    """Return the coordinate that an axis mimics."""
    leader = by_name.get(f"{arc.scope.prefix}{joint}")
    names = _coordinates(leader) if leader is not None and leader.kind != GEARBOX else []
    if axis not in AXES[: len(names)] or leader is arc:
        raise RobotFault(
            f"{arc.where}: found that it mimics {quoted(axis)} of {quoted(joint)}, expected an axis of another joint of the model"
        )
    return names[AXES.index(axis)]


def _gearbox(arc: Arc, arcs: Sequence[Arc]) -> Relation:
    """Return the relation of the hinges of both links on the reference body: theta_2 = -ratio theta_1."""
    body = text_of(arc.node.find("gearbox_reference_body"))
    if not body:
        raise RobotFault(f"{arc.where}: found no <gearbox_reference_body>, expected the link that carries both hinges")
    ratio = number(arc.where, arc.node, "gearbox_ratio", 1.0)
    carrier = arc.scope.link(body, arc.where)
    (first, sign_1), (second, sign_2) = (
        _hinge(arc, arcs, carrier, link, axis.direction)
        for link, axis in zip((arc.parent, arc.child), arc.axes, strict=True)
    )
    return Relation(arc.name, second, first, (0.0, -ratio * sign_1 * sign_2))


def _hinge(
    arc: Arc, arcs: Sequence[Arc], carrier: str | None, link: str | None, direction: np.ndarray
) -> tuple[str, float]:
    """Return the hinge of a link on a carrier, and the sign of its angle about a direction."""
    for other in arcs:
        if {other.parent, other.child} == {carrier, link} and KINDS[other.kind] == ("hinge",):
            axis = other.axes[0].direction
            if np.linalg.norm(np.cross(axis, direction)) < SDF.parallel:
                sense = float(np.sign(axis @ direction))
                return other.name, sense if other.parent == carrier else -sense
    raise RobotFault(
        f"{arc.where}: found no hinge of {link or 'the world'} on {carrier or 'the world'} about the axis of the gearbox, "
        "expected one of each link on the reference body"
    )
