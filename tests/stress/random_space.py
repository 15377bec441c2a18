"""Random mechanisms in space: bodies of any inertia in a tree of random joints, assembled as described."""

from __future__ import annotations

import numpy as np

from stiffmbs.elements.spatial.body import Body
from stiffmbs.elements.spatial.marker import Marker
from stiffmbs.elements.spatial.orientation import Quaternion, conjugate, matrix, product, rotated
from stiffmbs.elements.spatial.spatial_kinds import FORCES, JOINTS
from stiffmbs.model.spatial_model import Model

TREE_JOINTS = (
    "revolute", "spherical", "prismatic", "cylindrical", "fixed", "universal", "planar", "parallel", "perpendicular",
    "point_on_line", "point_on_plane", "orientation",
)  # fmt: skip
AT_RIGHT_ANGLES = ("universal", "perpendicular")
"""Joints that hold the axes z of their markers at right angles."""
QUARTER_TURN: Quaternion = (np.sqrt(0.5), np.sqrt(0.5), 0.0, 0.0)
UPRIGHT: Quaternion = (1.0, 0.0, 0.0, 0.0)


def random_space_tree(rng: np.random.Generator, count: int, springs: int) -> Model:
    """Bodies joined to the ground in a tree, moving, with undamped springs between them."""
    model = Model("Tree", gravity=(0.5, 0.3, -9.81))
    poses: list[tuple[np.ndarray, Quaternion]] = [(np.zeros(3), UPRIGHT)]
    names = ["ground"]
    for k in range(count):
        parent, kind = int(rng.integers(len(names))), TREE_JOINTS[int(rng.integers(len(TREE_JOINTS)))]
        here, there = _placed(rng), _placed(rng)
        position, orientation = _joined(poses[parent], here, there, kind in AT_RIGHT_ANGLES)
        name = f"b{k}"
        model.add(
            name,
            Body(
                mass=rng.uniform(0.5, 2), inertia=_tensor(rng), center_of_mass=tuple(rng.uniform(-0.2, 0.2, 3)),
                position=tuple(position), orientation=orientation,
                velocity=tuple(rng.uniform(-1, 1, 3)), omega=tuple(rng.uniform(-2, 2, 3)),
            ),
        )  # fmt: skip
        i, j = (
            Marker(body=body, point=tuple(point), orientation=turned)
            for body, (point, turned) in ((name, there), (names[parent], here))
        )
        model.add(f"joint{k}", JOINTS[kind](i=i, j=j))
        poses.append((position, orientation))
        names.append(name)
    for k in range(springs):
        a, b = rng.choice(names, 2, replace=False)
        i, j = (Marker(body=str(n), point=tuple(rng.uniform(-0.5, 0.5, 3))) for n in (a, b))
        model.add(f"spring{k}", FORCES["spring_damper"](i=i, j=j, stiffness=rng.uniform(5, 50), free_length=0.1))
    return model


def _placed(rng: np.random.Generator) -> tuple[np.ndarray, Quaternion]:
    """A point and an orientation on a body; every third one along its axes."""
    turned = rng.standard_normal(4)
    w, x, y, z = turned / np.linalg.norm(turned)
    return rng.uniform(-0.5, 0.5, 3), UPRIGHT if rng.random() < 1 / 3 else (w, x, y, z)


def _joined(
    parent: tuple[np.ndarray, Quaternion], here: tuple[np.ndarray, Quaternion], there: tuple[np.ndarray, Quaternion],
    across: bool,
) -> tuple[np.ndarray, Quaternion]:  # fmt: skip
    """The pose of a body whose marker `there` falls on its parent's marker `here`, perhaps a quarter turn about x on."""
    (at, turned), (point, axes), (own_point, own_axes) = parent, here, there
    joint = product(turned, axes)
    orientation = product(product(joint, QUARTER_TURN) if across else joint, conjugate(own_axes))
    return at + rotated(turned, tuple(point)) - rotated(orientation, tuple(own_point)), orientation


def _tensor(rng: np.random.Generator) -> tuple[tuple[float, ...], ...]:
    """An inertia tensor in axes that are no principal ones."""
    turn = rng.standard_normal(4)
    axes = matrix(tuple(turn / np.linalg.norm(turn)))
    tensor = axes @ np.diag(rng.uniform(0.5, 0.9, 3)) @ axes.T
    return tuple(map(tuple, ((tensor + tensor.T) / 2).tolist()))
