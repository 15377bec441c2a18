"""Random mechanisms: bodies in a tree of random joints, with springs between them."""

from __future__ import annotations

import numpy as np

from stiffmbs.elements.body import Body
from stiffmbs.elements.planar_kinds import FORCES, JOINTS
from stiffmbs.model.model import Model
from stiffmbs.reading.marker import Marker


def random_tree(rng: np.random.Generator, count: int, gravity: bool, grounded: bool, springs: int) -> Model:
    """Bodies joined in a tree by random joints, assembled as described, with undamped springs between them."""
    model = Model(gravity=(0.5, -9.81) if gravity else (0, 0))
    poses = [(0.0, 0.0, 0.0)]
    names = ["ground"]
    for k in range(count):
        name = f"b{k}"
        parent = int(rng.integers(0 if grounded else min(1, k), len(names))) if k or grounded else 0
        x, y, angle = poses[parent]
        here, there = rng.uniform(-0.5, 0.5, 2), rng.uniform(-0.5, 0.5, 2)
        turn = rng.uniform(-2, 2)
        kind = ("revolute", "prismatic", "fixed")[int(rng.integers(0, 3))] if (k or grounded) else "free"
        slide = rng.uniform(-0.3, 0.3) if kind == "prismatic" else 0.0
        axis = rng.uniform(-3, 3)
        point = np.array([x, y]) + _rotated(angle, here) + slide * _rotated(angle + axis, np.array([1.0, 0.0]))
        position = point - _rotated(angle + turn, there)
        poses.append((*position, angle + turn))
        model.add(
            name,
            Body(
                mass=rng.uniform(0.5, 2), inertia=rng.uniform(0.1, 1), position=tuple(position), angle=angle + turn,
                velocity=tuple(rng.uniform(-1, 1, 2)), omega=rng.uniform(-1, 1),
            ),
        )  # fmt: skip
        if kind != "free":
            i = Marker(body=name, point=tuple(there), angle=axis - turn)
            j = Marker(body=names[parent], point=tuple(here), angle=axis)
            model.add(f"joint{k}", JOINTS[kind](i=i, j=j))
        names.append(name)
    for k in range(springs):
        a, b = rng.choice(names[0 if grounded else 1 :], 2, replace=False)
        i, j = (Marker(body=str(n), point=tuple(rng.uniform(-0.5, 0.5, 2))) for n in (a, b))
        model.add(f"spring{k}", FORCES["spring_damper"](i=i, j=j, stiffness=rng.uniform(5, 50), free_length=0.1))
    return model


def _rotated(angle: float, vector: np.ndarray) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([c * vector[0] - s * vector[1], s * vector[0] + c * vector[1]])
