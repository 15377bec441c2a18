"""Random mechanisms in space with random constraints, assembled as described, as the content of scene files."""

from __future__ import annotations

from typing import Any

import numpy as np

from stiffmbs.elements.spatial.orientation import Quaternion, conjugate, matrix, product, rotated

from .random_laws import random_law

EQUATIONS = {
    "revolute": 5, "spherical": 3, "prismatic": 5, "cylindrical": 4, "fixed": 6, "universal": 4, "planar": 3, "parallel": 2,
    "point_on_line": 2, "point_on_plane": 1, "orientation": 3, "point_on_curve": 2, "free": 0,
}  # fmt: skip
QUARTER_TURN: Quaternion = (np.sqrt(0.5), np.sqrt(0.5), 0.0, 0.0)
UPRIGHT: Quaternion = (1.0, 0.0, 0.0, 0.0)
GROUND = (np.zeros(3), UPRIGHT)
COORDINATES = ("x", "y", "z", "az")
Pose = tuple[np.ndarray, Quaternion]


def random_space_constraints(rng: np.random.Generator) -> dict[str, Any]:
    """The content of a scene file: one to three bodies, joints to what was there before, and equations between them."""
    content: dict[str, Any] = {"dimensions": 3, "gravity": [0, 0, -9.81], "bodies": {}, "joints": {}, "tables": {}}
    poses: dict[str, Pose] = {"ground": GROUND}
    freedoms = 0
    for k in range(int(rng.integers(1, 4))):
        body, parent = f"b{k}", str(rng.choice([*poses, "ground"]))
        poses[body] = rng.uniform(-1, 1, 3), UPRIGHT if rng.random() < 0.5 else _orientation(rng)
        position, orientation = poses[body]
        content["bodies"][body] = {
            "mass": rng.uniform(0.5, 2), "inertia": rng.uniform(0.5, 0.9, 3).tolist(), "position": position.tolist(),
            "orientation": list(orientation), "velocity": rng.uniform(-3, 3, 3).tolist(), "omega": rng.uniform(-2, 2, 3).tolist(),
        }  # fmt: skip
        kind = str(rng.choice(list(EQUATIONS)))
        freedoms += 6 - EQUATIONS[kind]
        if kind != "free":
            content["joints"][f"{kind}_{body}"] = _joint(rng, content, poses, kind, body, parent)
    for k in range(int(rng.integers(0, 3))):
        if freedoms > 1:
            content["joints"][f"c{k}"] = {"type": "equation", "zero": _equation(rng, content, poses, f"c{k}")}
            freedoms -= 1
    return {key: value for key, value in content.items() if value}


def _joint(
    rng: np.random.Generator, content: dict[str, Any], poses: dict[str, Pose], kind: str, body: str, other: str
) -> dict[str, Any]:
    """A joint that fits the bodies at their initial pose; every second one in the body's centre of mass."""
    at = poses[body][0] + (rng.random() < 0.5) * rng.uniform(-0.5, 0.5, 3)
    axes = (UPRIGHT, poses[body][1], _orientation(rng))[int(rng.integers(3))]
    own, fields, there = axes, dict[str, Any](), at
    match kind:
        case "universal":
            own = product(axes, QUARTER_TURN)
        case "prismatic" | "cylindrical" | "point_on_line":
            there = at + rng.uniform(-0.3, 0.3) * matrix(axes)[:, 2]
        case "planar" | "point_on_plane":
            there = at + matrix(axes)[:, :2] @ rng.uniform(-0.3, 0.3, 2)
        case "parallel" | "orientation":
            there = at + rng.uniform(-0.3, 0.3, 3)
        case "point_on_curve":
            x = float(rng.choice([0.0, rng.uniform(-1, 1)]))
            law = random_law(rng, x, f"p_{body}")
            fields["y"] = law.text.replace("WAY", "x")
            content["tables"].update(law.tables)
            there = at - matrix(axes) @ np.array([x, law.value(x), 0.0])
    return {"type": kind, "i": _marker(poses, body, at, own), "j": _marker(poses, other, there, axes), **fields}


def _equation(rng: np.random.Generator, content: dict[str, Any], poses: dict[str, Pose], name: str) -> str:
    """One coordinate of a body against a law of one of the same or of another body."""
    bodies = [body for body in poses if body != "ground"]
    (body, own), (other, place) = ((str(rng.choice(bodies)), str(rng.choice(COORDINATES))) for _ in range(2))
    law = random_law(rng, _value(poses, other, place), f"p_{name}")
    content["tables"].update(law.tables)
    value = _value(poses, body, own) - law.value(_value(poses, other, place))
    return f"{_name(body, own)} - ({law.text.replace('WAY', _name(other, place))}) - ({float(value)!r})"


def _name(body: str, coordinate: str) -> str:
    return f"az({body})" if coordinate == "az" else f"{body}.{coordinate}"


def _value(poses: dict[str, Pose], body: str, coordinate: str) -> float:
    position, orientation = poses[body]
    if coordinate == "az":
        A = matrix(orientation)
        return float(np.arctan2(A[1, 0], A[0, 0]))
    return float(position["xyz".index(coordinate)])


def _orientation(rng: np.random.Generator) -> Quaternion:
    w, x, y, z = rng.standard_normal(4)
    length = float(np.sqrt(w * w + x * x + y * y + z * z))
    return float(w / length), float(x / length), float(y / length), float(z / length)


def _marker(poses: dict[str, Pose], body: str, at: np.ndarray, axes: Quaternion) -> dict[str, Any]:
    """A marker of a body at a point and with axes of the ground."""
    position, orientation = poses[body]
    own = rotated(conjugate(orientation), tuple(at - position))
    own[np.abs(own) < 1e-15] = 0.0
    turned = [float(part) for part in product(conjugate(orientation), axes)]
    return {"body": body, "point": own.tolist(), "orientation": turned}
