"""Library parts on a car body with soft bushings, or on the ground."""

from __future__ import annotations

import numpy as np

from .draft import Content, Draft, Pose, about_z

SUSPENSIONS = ("double_wishbone", "macpherson", "multi_link", "trailing_arm", "rigid_axle")
ALONE = ("wishbone", "link", "strut", "leaf_spring", "anti_roll_bar", "steering_rack", "aerodynamics")
SOFT = 2e5
"""Stiffness of bushings, N/m."""
SMALL_PARTS: dict[str, tuple[str, ...]] = {
    "wishbone": ("outside",),
    "link": ("outside",),
    "strut": ("below",),
    "leaf_spring": ("axle",),
}
"""Mounts that need a second body."""
SPRINGS = {"air_spring": "above", "hydromount": "load", "viscoelastic_bushing": "other"}
"""Suspension elements, and their mounts for a second body."""


def add_part(draft: Draft, part: str) -> str:
    """Add a part on the body of a car, and an end body if it needs one."""
    chassis = _car(draft)
    use: Content = {"part": part, "on": chassis, "compliance": draft.choice(["rigid", "bushing"])}
    if part == "aerodynamics":
        use = {"part": part, "on": chassis}
    else:
        use["parameters"] = {"zeta": 0.3}
        if part != "strut":
            use["parameters"]["k_b"] = draft.uniform(SOFT / 4, SOFT)
    if draft.chance(0.5):
        use["position"] = draft.vector(0.2, 3)
    if draft.chance(0.4) and part != "steering_rack":
        use["mirror"] = draft.choice(["x", "y"])
    return _added(draft, use, SMALL_PARTS.get(part, ()))


def add_spring(draft: Draft, part: str) -> str:
    """Add an air spring, a hydraulic mount or a viscoelastic bushing between a car body and another body."""
    use: Content = {"part": part, "on": _car(draft)}
    if part == "air_spring":
        use["parameters"] = {"load": draft.uniform(100, 400)}
    return _added(draft, use, (SPRINGS[part],))


def _added(draft: Draft, use: Content, ends: tuple[str, ...]) -> str:
    """Add the use of a part with bodies at its ends and return its name."""
    name = f"part{len(draft.section('use'))}"
    mounts = {mount: _end(draft) for mount in ends}
    if mounts:
        use["mounts"] = mounts
    draft.section("use")[name] = use
    draft.freedoms += 1
    return name


def _car(draft: Draft) -> str:
    """Add the body of a car, held by a soft bushing."""
    point, axes = draft.place(1.0), about_z(draft.uniform(-3, 3))
    chassis = draft.add(
        "bodies",
        "chassis",
        mass=draft.uniform(200, 500),
        inertia=[100, 300, 350],
        position=point.tolist(),
        orientation=axes.tolist(),
    )
    draft.poses[chassis] = Pose(point, axes)
    markers = {"i": draft.marker(chassis, point), "j": draft.marker("ground", point)}
    k, c = [2e4, 2e4, 2e4, 5e3, 5e3, 5e3], [1e3, 1e3, 1e3, 300.0, 300.0, 300.0]
    draft.add("forces", "held", type="bushing", **markers, stiffness=k, damping=c)
    draft.freedoms += 6
    return chassis


def _end(draft: Draft) -> str:
    """Add a body at the end of a part, with a soft bushing to the ground."""
    point = draft.poses[draft.bodies[-1]].point + np.array([0.0, 0.6, 0.2])
    body = draft.add("bodies", "end", mass=draft.uniform(10, 30), inertia=[0.5, 0.6, 0.5], position=point.tolist())
    draft.poses[body] = Pose(point, np.eye(3))
    markers = {"i": draft.marker(body, point), "j": draft.marker("ground", point)}
    k, c = [5e4, 5e4, 5e4, 1e3, 1e3, 1e3], [1e3, 1e3, 1e3, 50.0, 50.0, 50.0]
    draft.add("forces", "held", type="bushing", **markers, stiffness=k, damping=c)
    draft.freedoms += 6
    return body
