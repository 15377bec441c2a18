"""Conversion of motions to drives."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..functions.motion_law import Law
from ..functions.translate import Translation
from ..statements.constraints import COMPONENTS, ROTATIONAL, TRANSLATIONAL, Joint, Motion
from ..statements.fault import of_each
from .coordinates import SORTS, coordinate, initial_displacement
from .mechanism import Mechanism


def motions(mechanism: Mechanism, translation: Translation) -> dict[str, Any]:
    """Return the scene's drives by name."""

    def made(motion: Motion) -> dict[str, Any]:
        of_pair = _between_markers if motion.joint is None else _of_joint
        return {motion.name: of_pair(motion, mechanism, translation)}

    return of_each(mechanism.dataset.motions.values(), made)


def _of_joint(motion: Motion, mechanism: Mechanism, translation: Translation) -> dict[str, Any]:
    joint = mechanism.dataset.joints.get(motion.joint or 0)
    if ("JOINT", motion.joint) in mechanism.dataset.inactive:
        raise motion.fault(
            f"found JOINT = {motion.joint}, which is inactive, expected the motion to be deactivated too"
        )
    if joint is None:
        raise motion.fault(f"found JOINT = {motion.joint}, expected the number of a JOINT")
    sort = _sort(motion, joint)
    i, j = mechanism.ends(joint)
    law = Law(motion, translation, sort)
    initial = initial_displacement(sort, i, j)
    return {"type": "drive", "joint": coordinate(joint, sort), **law.over_time(initial)}


def _sort(motion: Motion, joint: Joint) -> str:
    own = SORTS.get(joint.kind)
    if joint.kind == "CYLINDRICAL":
        own = motion.sort
    if own is None or motion.sort not in (None, own):
        raise motion.fault(
            f"found {motion.sort or 'neither ROTATIONAL nor TRANSLATIONAL'} of {joint.label}, {joint.kind}, expected a "
            "revolute, translational or cylindrical joint and a motion that it has"
        )
    return own


def _between_markers(motion: Motion, mechanism: Mechanism, translation: Translation) -> dict[str, Any]:
    """Return a drive between two markers: a component in the axes of J, or a body-fixed x-y-z angle."""
    assert motion.i is not None and motion.j is not None and motion.component is not None
    i, j = mechanism.place(motion.i, motion, "I"), mechanism.place(motion.j, motion, "J")
    relative = i.initial.seen_from(j.initial)
    component = motion.component
    drive = {"type": "drive", "i": i.reference, "j": j.reference}
    if component in COMPONENTS[:3]:
        way = f"d{component.lower()}({i.reference}, {j.reference}, {j.reference})"
        initial = float(relative.point[COMPONENTS[:3].index(component)])
        return {**drive, "coordinate": way, **Law(motion, translation, TRANSLATIONAL).over_time(initial)}
    A = relative.axes  # Rx(b1) Ry(b2) Rz(b3): AX gives b1, and AZ of J against I gives -b3
    angle, initial = {
        "B1": (f"ax({i.reference}, {j.reference})", float(np.arctan2(-A[1, 2], A[2, 2]))),
        "B2": (
            f"asin(dx({mechanism.tip(i)}, {i.reference}, {j.reference}))",
            float(np.arcsin(np.clip(A[0, 2], -1, 1))),
        ),
        "B3": (f"-az({j.reference}, {i.reference})", float(np.arctan2(-A[0, 1], A[0, 0]))),
    }[component]
    return {**drive, "coordinate": angle, **Law(motion, translation, ROTATIONAL).over_time(initial)}
