"""Random wheels with tyres on roads."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from stiffmbs import __file__ as package

from .draft import Content, Draft, Pose, about_z

RADIUS = 0.3
PROPERTIES = Path(package).parent.parent / "examples" / "car.tir"


def add_wheel(draft: Draft) -> str:
    """Add a rolling wheel that stands on the road z = 0 and return its name."""
    heading, speed = draft.uniform(-3, 3), draft.uniform(2, 6)
    axes = about_z(heading)
    point = np.array([*draft.vector(1.0, 2), RADIUS - draft.uniform(0, 0.01)])
    velocity = speed * axes[:, 0]
    wheel = draft.add(
        "bodies", "wheel", mass=draft.uniform(10, 30), inertia=[0.6, 1.2, 0.6], position=point.tolist(),
        orientation=axes.tolist(), velocity=velocity.tolist(), omega=[0.0, speed / RADIUS, 0.0],
    )  # fmt: skip
    draft.poses[wheel] = Pose(point, axes)
    draft.freedoms += 6
    return wheel


def add_tyre(draft: Draft, kind: str) -> str:
    """Add a wheel with a tyre of a kind on a random road."""
    wheel = add_wheel(draft)
    fields: Content = {"i": wheel, "road": _road(draft)}
    if kind == "magic_formula_tyre":
        fields |= {"properties": str(PROPERTIES), "hand": draft.choice([1, -1])}
    else:
        fields |= {"radius": RADIUS, "stiffness": draft.uniform(1e4, 5e4), "damping": draft.uniform(50, 300)}
    if kind == "fiala_tyre":
        fields |= {
            "slip_stiffness": draft.uniform(500, 3000), "cornering_stiffness": draft.uniform(500, 3000), "mu_static": 0.9,
            "mu_sliding": 0.7, "width": 0.1, "relaxation": draft.choice([None, [0.2, 0.4]]),
        }  # fmt: skip
    return draft.add("forces", "tyre", type=kind, **fields)


def _road(draft: Draft) -> str:
    """Add a road and return its name."""
    name = f"road{len(draft.section('roads'))}"
    sorts: list[Content] = [
        {"type": "flat"},
        {"type": "formula", "z": f"{draft.uniform(0.005, 0.02)!r}*sin({draft.uniform(2, 5)!r}*x)*cos(y)"},
        {
            "type": "cosine_bump",
            "start": draft.uniform(0.2, 1),
            "length": draft.uniform(0.5, 1),
            "crest": draft.uniform(0.01, 0.03),
        },
    ]
    draft.section("roads")[name] = draft.choice(sorts if draft.features.events else sorts[:2])
    return name
