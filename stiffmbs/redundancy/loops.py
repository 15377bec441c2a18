"""Kinematic loops of bodies and joints, the only parts in which equations can be redundant."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from ..compile.group import Group
from ..compile.state import State
from ..compile.system import System
from ..compile.terms import TERM_SETS
from ..elements.element import Joint
from .parameters import REDUNDANCY


class LoopJoint(NamedTuple):
    """Joint with its rows and bodies.

    `rows`: its equations in the whole system. `bodies`: numbers of its bodies, without the ground.
    """

    name: str
    element: Joint
    rows: np.ndarray
    bodies: tuple[int, ...]


class Loop(NamedTuple):
    """Bodies and joints of loops that are connected by more than the ground.

    `bodies`: their numbers in the system. `rows`, `columns`, `coordinates`: the joints' equations, and the bodies'
    velocities and coordinates, in the whole system.
    """

    joints: tuple[LoopJoint, ...]
    bodies: tuple[int, ...]
    rows: np.ndarray
    columns: np.ndarray
    coordinates: np.ndarray

    @property
    def joint_of(self) -> list[str]:
        """Name of the joint of each row."""
        return [joint.name for joint in self.joints for _ in joint.rows]


def loops(system: System, state: State) -> list[Loop]:
    """Return the parts of a system in which equations may be dependent, separated if they share no body.

    A body with a single joint is removed with the joint if the joint's rows are independent on that body's velocities,
    as such rows depend on no others. The loops remain; of a tree, nothing remains. `state`: with the set ``motion``
    evaluated at the pose.
    """
    joints = [joint for g, group in enumerate(system.groups) for joint in _joints(system, state, g, group)]
    joints_of: list[set[int]] = [set() for _ in system.bodies]
    for k, (joint, _) in enumerate(joints):
        for body in joint.bodies:
            joints_of[body].add(k)
    leaves = [body for body, around in enumerate(joints_of) if len(around) == 1]
    while leaves:
        body = leaves.pop()
        if len(joints_of[body]) != 1:
            continue
        (k,) = joints_of[body]
        joint, held = joints[k]
        if body in held:
            for other in joint.bodies:
                joints_of[other].discard(k)
                if len(joints_of[other]) == 1:
                    leaves.append(other)
    return list(_connected(system, [joint for joint, _ in joints], joints_of))


def _joints(system: System, state: State, g: int, group: Group) -> Iterator[tuple[LoopJoint, set[int]]]:
    """Yield the joints of a group, each with the bodies on whose velocities alone its rows are independent."""
    count = group.record.n_equations
    if not count:
        return
    row, column = np.array(group.record.patterns["J"], dtype=np.int64).reshape(-1, 2).T
    first = system.places["motion"][g, 1 + TERM_SETS["motion"].index("J")]
    values = state.values["motion"][first : first + group.count * len(row)].reshape(group.count, len(row))
    width, straight = system.of_body.n_u, system.of_body.linear
    J = np.zeros((group.count, count, group.kind.n_bodies, width))
    J[:, row, column // width, column % width] = values
    J[..., straight:] /= system.size
    norms = np.linalg.norm(J, axis=(2, 3), keepdims=True)
    with np.errstate(invalid="ignore"):  # a joint that is undefined at this pose has no independent rows
        J /= np.where(norms > 0, norms, 1.0)
        parts = J.transpose(0, 2, 1, 3)
        independent = np.linalg.det(parts @ parts.transpose(0, 1, 3, 2)) > REDUNDANCY.dependent
    for e, (name, joint) in enumerate(zip(group.names, group.elements, strict=True)):
        assert isinstance(joint, Joint)
        on = [int(body) for body in group.bodies[e]]
        rows = group.first_row + e * count + np.arange(count)
        held = {body for body, alone in zip(on, independent[e], strict=True) if alone}
        yield LoopJoint(name, joint, rows, tuple(b for b in on if b < len(system.bodies))), held


def _connected(system: System, joints: list[LoopJoint], joints_of: list[set[int]]) -> Iterator[Loop]:
    """Yield the remaining joints, in parts that share no body."""
    seen: set[int] = set()
    for start, around in enumerate(joints_of):
        if not around or start in seen:
            continue
        bodies, members, open_bodies = {start}, set[int](), [start]
        while open_bodies:
            for k in joints_of[open_bodies.pop()] - members:
                members.add(k)
                new = set(joints[k].bodies) - bodies
                bodies |= new
                open_bodies += new
        seen |= bodies
        inside, numbers = tuple(joints[k] for k in sorted(members)), tuple(sorted(bodies))
        columns, coordinates = (
            (width * np.array(numbers)[:, None] + np.arange(width)).ravel()
            for width in (system.of_body.n_u, system.of_body.n_q)
        )
        yield Loop(inside, numbers, np.concatenate([joint.rows for joint in inside]), columns, coordinates)
