"""Initial coordinates of joints that follow others, such as URDF's ``mimic``."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.polynomial import Polynomial

from .robot import Robot


def with_followers(
    robot: Robot, coordinates: Mapping[str, float], rates: Mapping[str, float]
) -> tuple[dict[str, float], dict[str, float]]:
    """Return the initial coordinates and rates of joints with those of the joints that follow them.

    A follower whose coordinate is given moves the joint that it follows. Without this, the assembly would share an offset
    among both joints.
    """
    found, moving, joints = dict(coordinates), dict(rates), robot.joints()
    for one in robot.relations * len(robot.relations):  # backwards along chains of any order
        if one.joint in found and one.other in joints and one.other not in found:
            first, *slope = np.trim_zeros(one.coefficients, "b") or (0.0,)
            if len(slope) == 1:
                s = found[one.joint] - joints[one.joint].zero
                found[one.other] = joints[one.other].zero + (s - first) / slope[0]
    left = {one.joint: one for one in robot.relations if one.joint not in found and one.joint in joints}
    while left:
        ready = [one for one in left.values() if one.other not in left]
        if not ready:  # joints that follow each other in a circle
            break
        for one in ready:
            del left[one.joint]
            law, joint = Polynomial(np.array(one.coefficients or (0.0,))), joints[one.joint]
            other = joints.get(one.other) if one.other is not None else None
            s = 0.0 if other is None else found.get(other.name, other.zero) - other.zero
            found[one.joint] = joint.zero + float(law(s))
            rate = 0.0 if other is None else moving.get(other.name, 0.0) * float(law.deriv()(s))
            if rate:
                moving.setdefault(one.joint, rate)
    return found, moving
