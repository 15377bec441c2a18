"""Random bodies."""

from __future__ import annotations

from typing import Any

import numpy as np

from .draft import Content, Draft, Pose, about_z, random_axes

SIZE = 1.0
"""Half of the region that bodies are in, m."""


def add_body(draft: Draft, name: str = "b") -> str:
    """Add a body at a random pose, with a random mass, inertia and velocity, and return its name."""
    point = draft.place(SIZE)
    if draft.in_space:
        axes = draft.axes() if draft.chance(0.5) else random_axes(draft.rng)
    else:
        angle = draft.choice([0.0, draft.uniform(-3, 3)])
        axes = about_z(angle)
    fields = {
        "mass": draft.uniform(0.5, 3),
        "position": point[: draft.dimensions].tolist(),
        **(_of_space(draft, axes) if draft.in_space else {"inertia": draft.uniform(0.1, 1), "angle": angle}),
    }
    if draft.features.velocities:
        fields["velocity"] = draft.vector(1.0)
        fields["omega"] = draft.vector(1.5) if draft.in_space else draft.uniform(-2, 2)
    found = draft.add("bodies", name, **fields)
    draft.poses[found] = Pose(point, axes)
    draft.freedoms += 6 if draft.in_space else 3
    return found


def _of_space(draft: Draft, axes: np.ndarray) -> Content:
    """Return the inertia, in axes that need not be principal ones, the centre of mass, and the orientation."""
    moments = [draft.uniform(0.3, 0.5) for _ in range(3)]
    inertia: list[Any] = [*moments]
    if draft.chance(0.4):
        a, b, c = (draft.uniform(-0.05, 0.05) for _ in range(3))
        inertia = [[moments[0], a, b], [a, moments[1], c], [b, c, moments[2]]]
    return {
        "inertia": inertia,
        "center_of_mass": draft.vector(0.2) if draft.chance(0.5) else None,
        "orientation": axes.tolist(),
    }
