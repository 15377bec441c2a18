"""Conversion of joints, primitives and general constraints."""

from __future__ import annotations

import ast

import numpy as np

from ...elements.spatial.number_format import plain, quaternion, vector
from ...reading.formula.text import parse
from ..functions.acting import rod
from ..functions.translate import ANGULAR_VELOCITIES, VELOCITIES, Translation
from ..statements.constraints import GeneralConstraint, Joint, Primitive
from ..statements.text import of_each
from .mechanism import Mechanism, Place
from .racks import rolling

KINDS = {
    "REVOLUTE": "revolute",
    "TRANSLATIONAL": "prismatic",
    "CYLINDRICAL": "cylindrical",
    "SPHERICAL": "spherical",
    "FIXED": "fixed",
    "UNIVERSAL": "universal",
    "PLANAR": "planar",
    "CONVEL": "constant_velocity",
    "ATPOINT": "spherical",
    "INLINE": "point_on_line",
    "INPLANE": "point_on_plane",
    "ORIENTATION": "orientation",
    "PARALLEL_AXES": "parallel",
    "PERPENDICULAR": "perpendicular",
}
"""Joints that use their two markers unchanged."""
RATES = {name.lower() for name in (*VELOCITIES, *ANGULAR_VELOCITIES)}
"""Measures of velocity in formulas."""
Z_ALONG_X = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
"""Axes with z along the x axis of the axes they are given in."""
Z_ALONG_Y = Z_ALONG_X.T


def joints(mechanism: Mechanism, translation: Translation) -> dict[str, object]:
    """Return the joints of the scene by name, without motions and relations."""
    dataset = mechanism.dataset
    pairs = (*dataset.joints.values(), *dataset.primitives.values())
    return of_each(pairs, lambda joint: {joint.name: _joint(joint, mechanism)}) | of_each(
        dataset.general_constraints.values(), lambda one: {one.name: _general(one, mechanism, translation)}
    )


def held(mechanism: Mechanism) -> dict[str, object]:
    """Return orientation joints that hold point masses."""
    found: dict[str, object] = {}
    for part in mechanism.moving:
        if part.point:
            axes = mechanism.center(part).within(part.frame).axes
            turned = not np.array_equal(axes, np.eye(3))
            ground = {"body": "ground", "orientation": quaternion(axes)} if turned else "ground"
            found[f"{part.name}_axes"] = {"type": "orientation", "i": part.name, "j": ground}
    return found


def _joint(joint: Primitive, mechanism: Mechanism) -> dict[str, object]:
    i, j = mechanism.ends(joint)
    match joint.kind:
        case "HOOKE":
            return {"type": "universal", "i": turned(i, Z_ALONG_X), "j": turned(j, Z_ALONG_Y)}
        case "SCREW" if isinstance(joint, Joint):
            return {"type": "thread", "i": i.reference, "j": j.reference, "pitch": plain(joint.pitch)}
        case "RACKPIN" if isinstance(joint, Joint):
            return rolling(joint, mechanism)
    return {"type": KINDS[joint.kind], "i": i.reference, "j": j.reference}


def turned(place: Place, axes: np.ndarray) -> dict[str, object]:
    """Return a marker with other axes, given in its own."""
    return {
        "body": place.body, "point": vector(place.on_body.point), "orientation": quaternion(place.on_body.axes @ axes),
    }  # fmt: skip


def _general(constraint: GeneralConstraint, mechanism: Mechanism, translation: Translation) -> dict[str, object]:
    distance = rod(constraint)
    if distance is not None:
        *ends, length = distance
        i, j = (mechanism.place(ident, constraint, "the marker").reference for ident in ends)
        return {"type": "distance", "i": i, "j": j, "length": plain(length * mechanism.dataset.units.length)}
    formula = translation.translated(constraint.function)
    kind = "velocity_equation" if _has_velocities(formula, mechanism) else "equation"
    reported = {} if constraint.i is None else {"i": mechanism.place(constraint.i, constraint, "I").reference}
    return {"type": kind, **reported, "zero": ast.unparse(formula)}


def _has_velocities(formula: ast.expr, mechanism: Mechanism) -> bool:
    """Return True if a formula measures a velocity, itself or in its variables."""
    names, pending = set[str](), [formula]
    while pending:
        found = {node.id for node in ast.walk(pending.pop()) if isinstance(node, ast.Name)} - names
        names |= found
        pending += [parse(mechanism.variables[name]) for name in found if name in mechanism.variables]
    return bool(names & RATES)
