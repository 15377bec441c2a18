"""Directions that undetermined forces and torques keep: in the axes of the ground, or of a body."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from ..compile.quaternions import CONJUGATE, rotated, times
from .loop_equations import LoopEquations, Pose

SAME_DIRECTION = 1e-5
"""Angle, rad, and part of a force across it, up to which a direction counts as the same."""


class Direction(NamedTuple):
    """Where what is undetermined of a reaction always lies.

    Attributes
    ----------
    quantity : str
        ``force`` or ``torque``.
    axes : str
        Whose axes keep it: a body, or ``ground``.
    vector : tuple of float
        Unit vector in these axes; either sign means the same.
    across : bool
        Whether it lies across that vector (in space) and not along it.
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
    """The directions of an element's undetermined force, and in space of its torque, where they stay.

    What a joint of its kind can transmit at all is no news, and is left out in space.

    Parameters
    ----------
    poses : sequence of Pose
    changes : sequence of mapping of str to ndarray
        At each of them, the change of each channel along each null vector, shape (vectors,).
    owner : str
        The element.
    negligible : float
        Change that is none.
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
    """The ground and an element's bodies, each with the matrices that turn vectors into its own axes at the poses."""
    system = equations.state.system
    yield "ground", [np.eye(system.of_body.dimensions)] * len(poses)
    for body in next((joint.bodies for joint in equations.loop.joints if joint.name == owner), ()):
        first = system.of_body.n_q * equations.loop.bodies.index(body) + system.of_body.linear
        turns = [pose.q[first : first + system.of_body.n_q - system.of_body.linear] for pose in poses]
        yield system.bodies[body], [_into_own_axes(turn, system.principal_axes[body]) for turn in turns]


def _into_own_axes(turn: np.ndarray, principal: np.ndarray) -> np.ndarray:
    """The matrix for a body's angle, or for its quaternion and its principal axes in its own."""
    if len(turn) == 1:
        c, s = np.cos(turn[0]), np.sin(turn[0])
        return np.array([[c, s], [-s, c]])
    return rotated(times(turn, CONJUGATE * principal), np.eye(3))


def _space(change: np.ndarray, negligible: float) -> tuple[int, np.ndarray]:
    """The number of directions of vectors (columns), and the one direction, or that across two."""
    axes, sizes, _ = np.linalg.svd(change, full_matrices=change.shape[1] < len(change))
    if sizes[0] <= negligible:
        return 0, axes[:, 0]
    rank = int(np.sum(sizes > SAME_DIRECTION * sizes[0]))
    return rank, axes[:, 0] if rank == 1 else axes[:, -1]


def _same(a: np.ndarray, b: np.ndarray) -> bool:
    """Whether unit vectors have one direction, whatever their sense."""
    return bool(min(np.linalg.norm(a - b), np.linalg.norm(a + b)) < SAME_DIRECTION)


def _rounded(vector: np.ndarray) -> tuple[float, ...]:
    largest = int(np.argmax(np.abs(vector) > np.abs(vector).max() - SAME_DIRECTION))
    return tuple(round(float(part), 9) + 0.0 for part in vector * np.sign(vector[largest]))
