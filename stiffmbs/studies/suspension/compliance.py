"""Compliance matrices of an axle: displacements of the wheels under unit forces and torques."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .characteristics import Pose
from .rig import centre, pad

DISPLACEMENTS = ("x", "y", "z", "rx", "ry", "rz")
LOADS = ("fx", "fy", "fz", "mx", "my", "mz")


@dataclass(frozen=True)
class Compliance:
    """Compliance of the carriers with the springs free and the steering joint held."""

    sides: tuple[str, ...]  # sides of the wheels
    # centre, contact: shape (6 n, 6 n): displacements (m) and rotations (rad) along the ground axes, x forward, y to
    # the left, z up, by forces (N) and torques (N m), for the n wheels in turn: at their centres and at their contacts
    centre: np.ndarray
    contact: np.ndarray

    def as_dict(self) -> dict[str, object]:
        """Return the matrices for JSON with the names of their rows and columns."""
        return {
            "displacements": [f"{side}.{name}" for side in self.sides for name in DISPLACEMENTS],
            "loads": [f"{side}.{name}" for side in self.sides for name in LOADS],
            "unit": "m or rad per N or N m",
            "wheel_centre": self.centre.tolist(),
            "contact": self.contact.tolist(),
        }


def compliance_of(pose: Pose) -> Compliance:
    """Return the compliance matrices at a pose: the body is clamped and the pads are replaced by their forces."""
    changes = pose.tangent.released([pad(hub.wheel) for hub in pose.hubs])
    matrices = []
    for at_contact in (False, True):
        arms = [hub.contact - hub.centre if at_contact else np.zeros(3) for hub in pose.hubs]
        columns = []
        for hub, arm in zip(pose.hubs, arms, strict=True):
            for load in np.eye(6):
                force = pose.tangent.wrench(centre(hub.wheel), load[:3], load[3:], arm)
                x = changes.pushed(force)
                twists = [pose.twist(each, x) for each in pose.hubs]
                columns.append(
                    np.concatenate([[*twist.at(a), *twist.omega] for twist, a in zip(twists, arms, strict=True)])
                )
        matrices.append(np.array(columns).T)
    return Compliance(tuple(hub.wheel.side for hub in pose.hubs), *matrices)
