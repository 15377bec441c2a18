"""Coordinates of joints, and couplers: linear equations between joint displacements."""

from __future__ import annotations

import numpy as np

from ...elements.spatial.number_format import plain
from ..statements.constraints import ROTATIONAL, TRANSLATIONAL, Coupler, Joint
from ..statements.declared import Numbered
from .mechanism import Mechanism, Place

SORTS = {"REVOLUTE": ROTATIONAL, "TRANSLATIONAL": TRANSLATIONAL}
"""Type of displacement of the joints with one coordinate."""


def coordinate(joint: Joint, sort: str) -> str:
    """Return the scene name of a joint coordinate."""
    if joint.kind in SORTS:
        return joint.name
    return f"{joint.name}.{'angle' if sort == ROTATIONAL else 'displacement'}"


def initial_displacement(sort: str, i: Place, j: Place) -> float:
    """Return the displacement of a joint at the initial pose, m or rad."""
    a, b = i.initial, j.initial
    if sort != ROTATIONAL:
        return float((a.point - b.point) @ b.axes[:, 2])
    x = a.axes[:, 0]
    return float(np.arctan2(x @ b.axes[:, 1], x @ b.axes[:, 0]))


def relations(mechanism: Mechanism) -> dict[str, object]:
    """Return the scene's couplers by name."""
    return {coupler.name: _coupled(coupler, mechanism) for coupler in mechanism.dataset.couplers.values()}


def _coupled(coupler: Coupler, mechanism: Mechanism) -> dict[str, object]:
    """Return a coupler: the sum of scales times displacements is zero."""
    tied = [coupled_joint(coupler, ident, mechanism) for ident in coupler.joints]
    sorts = [_sort(coupler, joint, sort) for joint, sort in zip(tied, coupler.sorts, strict=True)]
    units = [1.0 if sort == ROTATIONAL else mechanism.dataset.units.length for sort in sorts]
    scales = [scale / unit for scale, unit in zip(coupler.scales, units, strict=True)]
    return _tied(tied, sorts, [scale / scales[0] for scale in scales], mechanism)


def _tied(tied: list[Joint], sorts: list[str], scales: list[float], mechanism: Mechanism) -> dict[str, object]:
    """Return a coupler of two joints; for more joints an equation that holds at the initial pose."""
    if len(tied) == 2:
        first, second = (coordinate(joint, sort) for joint, sort in zip(tied, sorts, strict=True))
        return {"type": "coupler", "joint_1": first, "joint_2": second, "scale": plain(-scales[1])}
    terms, at_start = [], 0.0
    for joint, sort, scale in zip(tied, sorts, scales, strict=True):
        i, j = mechanism.ends(joint)
        I, J = i.reference, j.reference
        measure = f"az({I}, {J})" if sort == ROTATIONAL else f"dz({I}, {J}, {J})"
        terms.append(f"{plain(scale)!r} * {measure}")
        at_start += scale * initial_displacement(sort, i, j)
    ends = {
        "i": mechanism.place(tied[0].i, tied[0], "I").reference,
        "j": mechanism.place(tied[0].j, tied[0], "J").reference,
    }
    return {"type": "equation", **ends, "zero": " + ".join([*terms, *([repr(plain(-at_start))] if at_start else [])])}


def coupled_joint(user: Numbered, ident: int, mechanism: Mechanism) -> Joint:
    """Return a joint of a coupler or a gear.

    Raises DatasetFault if the joint does not exist, or has no displacement to couple.
    """
    joint = mechanism.dataset.joints.get(ident)
    if joint is None:
        raise user.fault(f"found JOINTS = {ident}, expected the number of a JOINT")
    if joint.kind not in (*SORTS, "CYLINDRICAL"):
        raise user.fault(f"found {joint.label}, {joint.kind}, expected a revolute, translational or cylindrical joint")
    return joint


def _sort(user: Numbered, joint: Joint, sort: str | None) -> str:
    own = SORTS.get(joint.kind, sort)
    if own is None or (sort is not None and sort != own):
        raise user.fault(f"found {sort or 'no TYPE'} of {joint.label}, {joint.kind}, expected {own or 'T or R'}")
    return own
