"""Divergence of two runs: at a singular pose, by sensitivity, or by loose tolerances."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ..compile.bodies import SPACE
from ..compile.quaternions import CONJUGATE, rotation_vector, times
from ..results.scales import kind_of
from .parameters import VERIFICATION

TURNING = (*SPACE.positions[SPACE.linear :], *SPACE.velocities[SPACE.linear :])


@dataclass(frozen=True)
class Divergence:
    """Divergence of two motions.

    `body`: first body that diverges. `begun`, `t`: times at which the difference begins to grow, and at which it counts
    as divergence, s.
    """

    body: str
    begun: float
    t: float


def distance(
    first: Mapping[str, np.ndarray], other: Mapping[str, np.ndarray], sizes: Mapping[str, float]
) -> dict[str, np.ndarray]:
    """Return the distance of each body from that in another run over time, relative to the motion's size or in rad.

    `first`, `other`: channels at the same times, as far as both have them. `sizes`: scales of the channels.
    """
    found: dict[str, np.ndarray] = {}
    count = min(len(next(iter(run.values()))) for run in (first, other))
    for name, values in first.items():
        kind, (body, _, ending) = kind_of(name), name.rpartition(".")
        if not sizes[name] or not (kind in ("position", "angle") or ending == TURNING[0]):
            continue
        if ending == TURNING[0] and not all(f"{body}.{part}" in first for part in TURNING):
            continue  # a request
        if kind == "orientation":
            apart = _turned_apart(
                *(np.stack([run[f"{body}.{part}"] for part in TURNING])[:, :count] for run in (first, other))
            )
        else:
            scale = max(sizes[name], 1.0) if kind == "angle" else sizes[name]
            apart = np.abs(values[:count] - other[name][:count]) / scale
        found[body] = np.maximum(found.get(body, 0.0), apart)
    return found


def _turned_apart(first: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Return the difference of two motions in orientation over time, in rad.

    About the rotation axis it is relative to the total rotation of the first motion if that exceeds 1 rad. `first`,
    `other` of shape (7, n): quaternion with arbitrary sign, and angular velocity in the body's own axes.
    """
    p, w = first[:4], first[4:]
    turn = rotation_vector(times(CONJUGATE * p.T, other[:4].T))
    axis = (w / np.maximum(np.linalg.norm(w, axis=0), np.finfo(float).tiny)).T  # zero without a rotation
    along = np.sum(turn * axis, axis=1, keepdims=True)
    turned = 4 * np.arcsin(np.minimum(np.linalg.norm(np.diff(p), axis=0) / 2, 1.0))
    phase = np.abs(along[:, 0]) / max(1.0, float(np.nansum(turned)))
    return np.maximum(phase, np.linalg.norm(turn - along * axis, axis=1))


def divergence(times: np.ndarray, distances: Mapping[str, np.ndarray]) -> Divergence | None:
    """Return the divergence of two motions, or None. `times` of shape (n,). `distances`: of each body (`distance`)."""
    if not distances or not len(next(iter(distances.values()))):
        return None
    bodies, rows = list(distances), np.array(list(distances.values()))
    beyond = rows > VERIFICATION.diverged
    if not beyond.any():
        return None
    k = int(np.argmax(beyond.any(axis=0)))
    body = int(np.argmax(rows[:, k]))
    together = np.flatnonzero(rows[:, :k].max(axis=0) < VERIFICATION.together * VERIFICATION.diverged)
    return Divergence(bodies[body], float(times[together[-1] if len(together) else 0]), float(times[k]))
