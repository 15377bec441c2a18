"""Constant directions of indeterminate forces and torques, in ground or body axes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from ..compile.quaternions import CONJUGATE, rotated, times
from .loop_equations import LoopEquations, Pose
from .parameters import REDUNDANCY


class Direction(NamedTuple):
    """Direction of the indeterminate part of a reaction at all poses.

    - `quantity`: ``force`` or ``torque``.
    - `axes`: axes in which it is constant: a body, or ``ground``.
    - `vector`: unit vector in these axes, with arbitrary sign.
    - `across`: true if it is perpendicular to that vector (in space), not parallel.
    """

    quantity: str
    axes: str
    vector: tuple[float, ...]
    across: bool


def directions(
    equations: LoopEquations,
    poses: Sequence[Pose],
    changes: Sequence[Mapping[str, np.ndarray]],
    owner: str,
    negligible: float,
) -> Iterator[Direction]:
    """Yield the constant directions of an element's indeterminate force, and in space of its torque.

    In space, a direction that the kind of joint implies is omitted. `changes`: at each pose, the change of each channel
    along each null vector, shape (vectors,). `owner`: name of the element. `negligible`: change that counts as zero.
    """
    of_body = equations.state.system.of_body
    quantities = {"force": of_body.reactions[: of_body.linear]}
    if of_body.dimensions == 3:
        quantities["torque"] = of_body.reactions[of_body.linear :]
    transmits = next((joint.element.transmits for joint in equations.loop.joints if joint.name == owner), ())
    for quantity, components in quantities.items():
        stacks = [np.array([change[f"{owner}.{name}"] for name in components]) for change in changes]
        parts = [_space(stack, negligible) for stack in stacks]
        rank = parts[0][0]
        possible = [name for name in transmits if name[0] == quantity[0]] if len(components) == 3 else ()
        if any(found != rank for found, _ in parts) or not 0 < rank < (len(possible) or len(components)):
            continue
        across = rank == 2
        for axes, back in _frames(equations, poses, owner):
            own = [seen @ axis for seen, (_, axis) in zip(back, parts, strict=True)]
            if all(_same(vector, own[0]) for vector in own):
                yield Direction(quantity, axes, _rounded(own[0]), across)
                break


def _frames(equations: LoopEquations, poses: Sequence[Pose], owner: str) -> Iterator[tuple[str, list[np.ndarray]]]:
    """Yield the ground and an element's bodies, each with the rotation matrices into its axes at the poses."""
    system = equations.state.system
    yield "ground", [np.eye(system.of_body.dimensions)] * len(poses)
    for body in next((joint.bodies for joint in equations.loop.joints if joint.name == owner), ()):
        first = system.of_body.n_q * equations.loop.bodies.index(body) + system.of_body.linear
        turns = [pose.q[first : first + system.of_body.n_q - system.of_body.linear] for pose in poses]
        yield system.bodies[body], [_into_own_axes(turn, system.principal_axes[body]) for turn in turns]


def _into_own_axes(turn: np.ndarray, principal: np.ndarray) -> np.ndarray:
    """Return the rotation matrix for a body's angle, or for its quaternion and its principal axes in its own."""
    if len(turn) == 1:
        c, s = np.cos(turn[0]), np.sin(turn[0])
        return np.array([[c, s], [-s, c]])
    return rotated(times(turn, CONJUGATE * principal), np.eye(3))


def _space(change: np.ndarray, negligible: float) -> tuple[int, np.ndarray]:
    """Return the number of directions spanned by columns, and the one direction, or the normal to two."""
    axes, sizes, _ = np.linalg.svd(change, full_matrices=change.shape[1] < len(change))
    if sizes[0] <= negligible:
        return 0, axes[:, 0]
    rank = int(np.sum(sizes > REDUNDANCY.same_direction * sizes[0]))
    return rank, axes[:, 0] if rank == 1 else axes[:, -1]


def _same(a: np.ndarray, b: np.ndarray) -> bool:
    return bool(min(np.linalg.norm(a - b), np.linalg.norm(a + b)) < REDUNDANCY.same_direction)


def _rounded(vector: np.ndarray) -> tuple[float, ...]:
    largest = int(np.argmax(np.abs(vector) > np.abs(vector).max() - REDUNDANCY.same_direction))
    return tuple(round(float(part), 9) + 0.0 for part in vector * np.sign(vector[largest]))
