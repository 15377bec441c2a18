"""Driving angle of a run, and loads over it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ..elements.joints.drive import Drive
from ..elements.turns import TURN
from ..model.model_data import ModelData
from ..reading.marker import GROUND
from ..results.solution import Solution
from .loads import Load

ROUNDED = 1e-6
"""Part of a revolution that may be missing, for durations written with six digits."""


@dataclass(frozen=True, eq=False)
class DrivingAngle:
    """Angle of a driven joint that turns in one direction, over its last revolution."""

    joint: str
    rows: np.ndarray  # output instants of the last revolution, in the order of time
    degrees: np.ndarray  # angle at these, from 0 to 360 deg, in the order of `rows`

    @property
    def order(self) -> np.ndarray:
        """Return the output instants by their angle."""
        return self.rows[np.argsort(self.degrees, kind="stable")]

    @property
    def sorted_degrees(self) -> np.ndarray:
        """Return the angles in increasing order, deg."""
        return np.sort(self.degrees, kind="stable")


def driving_angle(data: ModelData, solution: Solution) -> DrivingAngle | None:
    """Return the angle of the first drive that turns its joint once or more in one direction, or None."""
    for element in data.joints.values():
        joint = getattr(getattr(element, "joint", None), "joint", "")
        channel = f"{joint}.angle"
        if element.kind != Drive.kind or channel not in solution.channels:
            continue
        angle = solution.channels[channel]
        steps = np.diff(angle)
        if (
            np.isfinite(angle).all()
            and abs(angle[-1] - angle[0]) >= TURN * (1 - ROUNDED)
            and (np.all(steps >= 0) or np.all(steps <= 0))
        ):
            rows = np.flatnonzero(np.abs(angle - angle[-1]) <= TURN * (1 + ROUNDED))
            return DrivingAngle(joint, rows, np.degrees(angle[rows]) % 360.0)
    return None


def rotating_loads(
    data: ModelData, solution: Solution, load: Load, rows: np.ndarray
) -> Iterator[tuple[str, np.ndarray]]:
    """Yield each of the two bodies of an element and the force on it in its axes, shape (n, 2), in the plane.

    A point of the load that stays in one direction of a body loads one side of the bearing there.
    """
    element = {**data.joints, **data.forces}.get(load.element)
    for sign, end in ((1.0, "i"), (-1.0, "j")):
        body = getattr(getattr(element, end, None), "body", "")
        if not body or load.components.shape[1] != 2:
            continue
        angle = np.zeros(len(rows)) if body == GROUND else solution.channels[f"{body}.angle"][rows]
        fx, fy = sign * load.components[rows].T
        yield body, np.column_stack([fx * np.cos(angle) + fy * np.sin(angle), fy * np.cos(angle) - fx * np.sin(angle)])
