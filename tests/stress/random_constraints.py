"""Random mechanisms of the plane with random constraints, assembled as described, as the content of scene files."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from .random_laws import random_law

EQUATIONS = {
    "revolute": 2, "prismatic": 2, "fixed": 3, "point_on_line": 1, "distance": 1, "point_on_curve": 1, "equation": 1, "coupler": 1,
    "drive": 1,
}  # fmt: skip
TREE_JOINTS = ("revolute", "prismatic", "point_on_line", "fixed", "distance", "point_on_curve", "free")
COORDINATES = ("x", "y", "angle")


@dataclass
class RandomScene:
    """A scene in the making.

    Attributes
    ----------
    content : dict
        Of the scene file.
    poses : dict of str to ndarray
        x, y, angle of each body and of the ground.
    freedoms : int
        Degrees of freedom that are left.
    moving : list of str
        Joints with a coordinate that could be driven or coupled.
    """

    content: dict[str, Any]
    poses: dict[str, np.ndarray] = field(default_factory=lambda: {"ground": np.zeros(3)})
    freedoms: int = 0
    moving: list[str] = field(default_factory=list)


def random_constraints(rng: np.random.Generator) -> dict[str, Any]:
    """The content of a scene file: one to four bodies, joints to what was there before, and further constraints."""
    scene = RandomScene({"gravity": [0, -9.81], "bodies": {}, "joints": {}, "forces": {}, "tables": {}})
    for k in range(int(rng.integers(1, 5))):
        _add_body(rng, scene, f"b{k}")
    for k in range(int(rng.integers(0, 4))):
        kind = ("equation", "coupler", "drive", "point_on_curve")[int(rng.choice(4, p=[0.5, 0.2, 0.1, 0.2]))]
        if scene.freedoms > EQUATIONS[kind]:
            _add_constraint(rng, scene, f"c{k}", kind)
    if rng.random() < 0.5:
        i, j = rng.choice(list(scene.poses), 2, replace=False)
        scene.content["forces"]["spring"] = {
            "type": "spring_damper", "i": _marker(scene, i, rng.uniform(-1, 1, 2)), "j": _marker(scene, j, rng.uniform(-1, 1, 2)),
            "stiffness": rng.uniform(5, 50), "free_length": 0.2, "damping": rng.choice([0.0, 1.0]),
        }  # fmt: skip
    return {key: value for key, value in scene.content.items() if value}


def _add_body(rng: np.random.Generator, scene: RandomScene, name: str) -> None:
    parent = str(rng.choice([*scene.poses, "ground"]))
    pose = np.array([*rng.uniform(-1, 1, 2), rng.choice([0.0, rng.uniform(-2, 2)])])
    scene.poses[name] = pose
    scene.freedoms += 3
    scene.content["bodies"][name] = {
        "mass": rng.uniform(0.5, 2), "inertia": rng.uniform(0.1, 1), "position": pose[:2].tolist(), "angle": pose[2],
        "velocity": rng.uniform(-3, 3, 2).tolist(), "omega": rng.uniform(-3, 3),
    }  # fmt: skip
    kind = str(rng.choice(TREE_JOINTS))
    if kind != "free":
        _add_joint(rng, scene, f"{kind}_{name}", kind, name, parent)


def _add_joint(rng: np.random.Generator, scene: RandomScene, joint: str, kind: str, body: str, other: str) -> None:
    """A joint that fits the bodies at their initial pose; every second one in the body's centre of mass."""
    at = scene.poses[body][:2] + (rng.random() < 0.5) * rng.uniform(-0.5, 0.5, 2)
    angle = float(rng.choice([0.0, np.pi / 2, scene.poses[body][2], rng.uniform(-3, 3)]))
    fields: dict[str, Any] = {}
    there = at
    match kind:
        case "prismatic" | "point_on_line":
            there = at + rng.uniform(-0.3, 0.3) * np.array([math.cos(angle), math.sin(angle)])
        case "distance":
            there = at + rng.uniform(0.3, 1, 2)
            fields["length"] = float(np.linalg.norm(there - at))
        case "point_on_curve":
            x = float(rng.choice([0.0, rng.uniform(-1, 1)]))
            law = random_law(rng, x, f"p_{joint}")
            fields["y"] = law.text.replace("WAY", "x")
            scene.content["tables"].update(law.tables)
            there = at - _rotation(angle) @ np.array([x, law.value(x)])
    if kind in ("revolute", "prismatic", "point_on_line"):
        scene.moving += [joint] if kind != "revolute" or rng.random() < 0.9 else []
    scene.content["joints"][joint] = {
        "type": kind, "i": _marker(scene, body, at, angle), "j": _marker(scene, other, there, angle), **fields,
    }  # fmt: skip
    scene.freedoms -= EQUATIONS[kind]


def _add_constraint(rng: np.random.Generator, scene: RandomScene, name: str, kind: str) -> None:
    bodies = [body for body in scene.poses if body != "ground"]
    match kind:
        case "equation":
            terms = _equation(rng, scene, name, bodies)
            scene.content["joints"][name] = {"type": "equation", "zero": terms}
            scene.freedoms -= 1
        case "coupler" if len(scene.moving) > 1:
            first, second = (str(joint) for joint in rng.choice(scene.moving, 2, replace=False))
            scale = float(rng.choice([1.0, -1.0, rng.uniform(0.3, 2)]))
            scene.content["joints"][name] = {"type": "coupler", "joint_1": first, "joint_2": second, "scale": scale}
            scene.freedoms -= 1
        case "drive" if scene.moving:
            joint = str(rng.choice(scene.moving))
            scene.content["joints"][name] = {
                "type": "drive",
                "joint": joint,
                "velocity": f"{rng.uniform(-1, 1)!r}*cos(3*t)",
            }
            scene.freedoms -= 1
        case "point_on_curve":
            body, other = (str(found) for found in rng.choice([*bodies, "ground"], 2, replace=False))
            if body == "ground":
                body, other = other, body
            _add_joint(rng, scene, name, kind, body, other)


def _equation(rng: np.random.Generator, scene: RandomScene, name: str, bodies: list[str]) -> str:
    """One coordinate against a law of another one, and at times a third one as well."""
    chosen = [(str(rng.choice(bodies)), int(rng.integers(3))) for _ in range(3)]
    (body, own), (other, place), (third, last) = chosen
    law = random_law(rng, float(scene.poses[other][place]), f"p_{name}")
    scene.content["tables"].update(law.tables)
    factor = float(rng.choice([0.0, 0.0, 1.0, rng.uniform(-1, 1)]))
    value = scene.poses[body][own] - law.value(scene.poses[other][place]) + factor * scene.poses[third][last]
    text = f"{body}.{COORDINATES[own]} - ({law.text.replace('WAY', f'{other}.{COORDINATES[place]}')})"
    if rng.random() < 0.5:
        text += f" + {factor!r}*{third}.{COORDINATES[last]}"
    else:
        value -= factor * scene.poses[third][last]
    return f"{text} - ({float(value)!r})"


def _marker(scene: RandomScene, body: str, at: np.ndarray, angle: float = 0.0) -> dict[str, Any]:
    """A marker of a body at a point and angle of the ground."""
    x, y, turned = scene.poses[body]
    own = _rotation(turned).T @ (at - np.array([x, y]))
    own[np.abs(own) < 1e-15] = 0.0
    return {"body": body, "point": own.tolist(), "angle": float(angle - turned)}


def _rotation(angle: float) -> np.ndarray:
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s], [s, c]])
