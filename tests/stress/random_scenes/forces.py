"""Random forces between two bodies, or on one."""

from __future__ import annotations

from typing import Any

import numpy as np

from .draft import Content, Draft, Unfit
from .laws import law_of_motion

STIFFNESS, DAMPING = 60.0, 3.0
"""Largest stiffness and damping of soft elements, N/m and N s/m."""
STIFF = 2e4
"""Largest stiffness of stiff elements, N/m."""
FORCE, TORQUE = 8.0, 2.0


def add_force(draft: Draft) -> str:
    """Add a force by formulas on one body, or between two, in one of the kinds of axes."""
    i, j = draft.two_bodies()
    fields: Content = {"i": draft.marker(i, draft.near(i), draft.axes())}
    fields |= draft.choice([{}, {"axes": "body"}, {"j": j}])
    if draft.in_space and "axes" not in fields and draft.chance(0.3):
        fields["frame"] = draft.choice([i, j])
    return draft.add("forces", "force", type="force", **fields, force=_components(draft, i, FORCE))


def add_torque(draft: Draft) -> str:
    """Add a torque by formula on one body, or between two."""
    i, j = draft.two_bodies()
    fields: Content = {"i": i, **draft.choice([{}, {"j": j}])}
    if not draft.in_space:
        return draft.add("forces", "torque", type="torque", **fields, torque=law_of_motion(draft, i, TORQUE))
    fields |= draft.choice([{}, {"axes": "body"}, {"frame": j}])
    return draft.add("forces", "torque", type="torque", **fields, torque=_components(draft, i, TORQUE))


def _components(draft: Draft, body: str, size: float) -> list[Any]:
    """Return components of which one or two are formulas."""
    found: list[Any] = draft.vector(size)
    for _ in range(int(draft.rng.integers(1, 3))):
        found[int(draft.rng.integers(draft.dimensions))] = law_of_motion(draft, body, size)
    return found


def add_line_force(draft: Draft) -> str:
    """Add a force along the line of two points."""
    i, j = draft.two_bodies()
    return draft.add("forces", "line", type="line_force", **_ends(draft, i, j), force=law_of_motion(draft, i, FORCE))


def add_spring_damper(draft: Draft) -> str:
    """Add a spring and damper, linear or by laws."""
    i, j = draft.two_bodies()
    fields: Content = {
        "stiffness": draft.uniform(5, STIFF if draft.chance(0.15) else STIFFNESS), "damping": draft.uniform(0.5, DAMPING),
        "free_length": draft.uniform(0.2, 1), "preload": draft.choice([0.0, draft.uniform(-5, 5)]),
    }  # fmt: skip
    if draft.chance(0.4):
        fields |= _laws(draft, FORCE)
    return draft.add("forces", "spring", type="spring_damper", **_ends(draft, i, j), **fields)


def add_torsion_spring(draft: Draft) -> str:
    """Add a torsion spring; in space about the axis of a joint, or of bodies that are drawn parallel."""
    if not draft.in_space:
        i, j = draft.two_bodies()
        markers: Content = {"i": i, "j": j}
    else:
        markers = draft.choice(
            {key: joint[key] for key in "ij"}
            for joint in draft.content.get("joints", {}).values()
            if joint["type"] in ("revolute", "cylindrical", "parallel", "screw")
        )
    fields = {
        "stiffness": draft.uniform(1, 20),
        "damping": draft.uniform(0.05, 0.5),
        "free_angle": draft.uniform(-0.5, 0.5),
    }
    if draft.chance(0.4):
        fields |= _laws(draft, TORQUE)
    return draft.add("forces", "torsion", type="torsion_spring", **markers, **fields)


def add_bushing(draft: Draft) -> str:
    """Add a bushing with numbers, a full matrix or laws, undeformed or slightly deformed."""
    i, j = draft.two_bodies()
    fields: Content = {**_stiffness(draft), "preload": draft.choice([None, _wrench(draft)])}
    if draft.chance(0.3):
        fields |= {"law_x": f"{draft.uniform(100, 1000)!r}*s^3", "law_y": _curve(draft, FORCE)}
    if draft.chance(0.2):
        fields["axes"] = "ground"
    return draft.add("forces", "bushing", type="bushing", **_joined(draft, i, j), **fields)


def add_field(draft: Draft) -> str:
    """Add a field."""
    i, j = draft.two_bodies()
    return draft.add(
        "forces", "field", type="field", **_joined(draft, i, j), **_stiffness(draft), preload=_wrench(draft)
    )


def add_beam(draft: Draft) -> str:
    """Add a beam from marker j along its x."""
    i, j = draft.two_bodies()
    axes, at = draft.axes(), draft.near(i, 0.1)
    length, side = draft.uniform(0.5, 1), draft.uniform(0.02, 0.04)
    fields = {
        "length": length, "young": draft.uniform(1e7, 1e8), "shear_modulus": draft.uniform(1e7, 4e7), "area": side**2,
        "torsion": 0.14 * side**4, "iyy": side**4 / 12, "izz": side**4 / 10, "damping_ratio": draft.uniform(0.005, 0.02),
        "asy": draft.choice([0.0, 1.2]), "asz": draft.choice([0.0, 1.2]),
    }  # fmt: skip
    markers = {"i": draft.marker(i, at, axes), "j": draft.marker(j, at - length * axes[:, 0], axes)}
    return draft.add("forces", "beam", type="beam", **markers, **fields)


def add_joint_friction(draft: Draft) -> str:
    """Add friction to a joint without friction, with transition speeds that are not too small."""
    taken = {force.get("joint") for force in draft.content.get("forces", {}).values()}
    rubbing = ("revolute", "prismatic", "cylindrical", "spherical") if draft.in_space else ("revolute", "prismatic")
    joints = draft.content.get("joints", {})
    name = draft.choice(name for name, joint in joints.items() if joint["type"] in rubbing and name not in taken)
    kind = joints[name]["type"]
    fields: Content = {"friction": draft.uniform(0.05, 0.3), "stiction_velocity": draft.uniform(0.05, 0.2)}
    if draft.chance(0.5):
        fields |= {"static_friction": fields["friction"] + draft.uniform(0.02, 0.1), "friction_velocity": 0.5}
    if kind != "prismatic":
        fields["radius"] = draft.uniform(0.02, 0.1)
    if kind == "prismatic" or (draft.in_space and kind != "spherical" and draft.chance(0.5)):
        fields["length"] = draft.uniform(0.2, 0.5)
    return draft.add("forces", "rub", type="joint_friction", joint=name, **fields)


def add_wheel_torque(draft: Draft) -> str:
    """Add a torque about y of a marker."""
    i, j = draft.two_bodies()
    return draft.add("forces", "motor", type="wheel_torque", i=i, j=j, torque=law_of_motion(draft, i, TORQUE))


def add_brake(draft: Draft) -> str:
    """Add a brake about y of a marker."""
    i, j = draft.two_bodies()
    fields = {"torque": draft.uniform(0.5, 3), "windup": draft.uniform(0.02, 0.05), "lag": draft.uniform(0.01, 0.05)}
    return draft.add("forces", "brake", type="brake", i=i, j=j, **fields)


def _ends(draft: Draft, i: str, j: str) -> Content:
    """Return markers at distinct points."""
    at, there = draft.near(i), draft.near(j)
    if np.linalg.norm(at - there) < 0.3:
        raise Unfit
    return {"i": draft.marker(i, at), "j": draft.marker(j, there)}


def _joined(draft: Draft, i: str, j: str) -> Content:
    """Return markers at the same pose, except for a small deformation."""
    at, axes = draft.near(i), draft.axes()
    return {"i": draft.marker(i, at, axes), "j": draft.marker(j, at + draft.place(0.05), axes)}


def _stiffness(draft: Draft) -> Content:
    """Return stiffness and damping of all components, sometimes as a full matrix."""
    moving, turning = draft.dimensions, draft.dimensions * (draft.dimensions - 1) // 2
    top = STIFF if draft.chance(0.15) else 300.0
    k = [*(draft.uniform(top / 10, top) for _ in range(moving)), *(draft.uniform(2, 20) for _ in range(turning))]
    c = [*(draft.uniform(1, 10) for _ in range(moving)), *(draft.uniform(0.1, 0.5) for _ in range(turning))]
    if draft.chance(0.3):
        root = np.diag(np.sqrt(k)) @ (np.eye(len(k)) + np.triu(draft.rng.uniform(-0.2, 0.2, (len(k), len(k))), 1))
        return {"stiffness": (root @ root.T).tolist(), "damping": c}
    return {"stiffness": k, "damping": c}


def _wrench(draft: Draft) -> list[float]:
    turning = draft.dimensions * (draft.dimensions - 1) // 2
    return [*draft.vector(3.0), *draft.vector(0.5, turning)]


def _laws(draft: Draft, size: float) -> Content:
    """Return laws of a spring and of a damper: polynomials or tables."""
    spring = draft.choice([f"{size * draft.uniform(1, 5)!r}*s^3", _curve(draft, size)])
    damper = draft.choice(
        [f"{size / 10 * draft.uniform(0.5, 2)!r}*v^3", f"{size / 2 * draft.uniform(0.5, 1)!r}*tanh(v)"]
    )
    return draft.choice([{"spring_law": spring}, {"damper_law": damper}, {"spring_law": spring, "damper_law": damper}])


def _curve(draft: Draft, size: float) -> Content:
    """Return an increasing table over a deflection."""
    steps = np.cumsum([draft.uniform(0.05, 1) for _ in range(5)])
    values = (steps - steps[2]) * size / 3
    sort = draft.choice([{"akima": True}, {}, {"lines": True}] if draft.features.events else [{}])
    return {"table": [[round(-0.5 + 0.25 * k, 3), float(value)] for k, value in enumerate(values)], **sort}
