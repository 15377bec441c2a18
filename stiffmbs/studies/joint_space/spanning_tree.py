"""Spanning tree of the joints of a model, found from their equations and coordinates alone.

The derivatives of a joint's equations and coordinates at one pose determine the screws along which it moves its second body. A
trial of another pose shows whether these screws describe the joint everywhere: other joints close loops.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import count
from typing import Final

import numpy as np

from ...compile.quaternions import CONJUGATE, rotated, times
from ...compile.state import State
from ...dynamics.dynamics import Dynamics
from ...dynamics.joint_tree import Frame, JointTree, Tree
from ...elements.element import Joint
from ...elements.turns import TURN
from ...results.joint_angles import joint_angles
from ...results.joint_coordinates import JointCoordinates
from ..joint_pose import JointPose

DEPENDENT: Final = 1e-8
"""Singular value of dependent equations of a joint, lengths in sizes of the mechanism."""
ROUNDING: Final = 1e-13
"""Part of a screw that is rounding, such as the rotation of a slider, relative to the largest, lengths in sizes of the mechanism."""
TRIED: Final = 0.7
"""Largest change of a coordinate in a trial, rad or sizes of the mechanism."""
SATISFIED: Final = 1e-7
"""Largest error of a joint in a trial, rad or sizes of the mechanism."""


@dataclass(frozen=True)
class Link:
    """Joint between two bodies. `rows`: its equations. `bodies`: indices; that of ground follows the last. `coordinates`: indices."""

    name: str
    rows: np.ndarray
    bodies: tuple[int, int]
    coordinates: tuple[int, ...]


@dataclass(frozen=True)
class Chosen:
    """Spanning tree with the names of its coordinates and rates. `joints`: coordinates of joints among these, their first names."""

    tree: Tree
    coordinates: tuple[str, ...]
    rates: tuple[str, ...]
    joints: tuple[str, ...]


class SpanningTree:
    """Search for a spanning tree at a pose.

    `dynamics`: dynamics at this pose. `joints`: coordinates of joints. `preferred`: coordinates that the tree contains if possible, those of the
    first set before those of the next.
    """

    def __init__(
        self,
        dynamics: Dynamics,
        joints: JointCoordinates,
        t: float,
        q: np.ndarray,
        preferred: tuple[frozenset[str], ...],
    ) -> None:
        self._system, self._joints, self._t, self._q = dynamics.system, joints, t, q
        self._dynamics = dynamics
        pose = JointPose(dynamics, joints, t, q)
        with dynamics.state.unchanged():
            self._rates = pose.rate_matrix()
            joints.begin(t, {})
            self._values = joints.coordinates.copy()
            dynamics.state.q[:], dynamics.state.u[:] = q, 0.0
            dynamics.state.evaluate("motion", t)
            self._J = dynamics.state.matrix("motion", "J")
        self._size = self._system.size or 1.0
        self._unit = self._system.per_velocity(self._size, 1.0)
        links = list(self._links())
        names = [{joints.names[k] for k in link.coordinates} for link in links]
        rank = [next((n for n, first in enumerate(preferred) if first & own), len(preferred)) for own in names]
        self._order = [link for _, link in sorted(zip(rank, links, strict=True), key=lambda pair: pair[0])]

    def _links(self) -> Iterator[Link]:
        numbers = {name: k for k, name in enumerate(self._joints.names)}
        for group in self._system.groups:
            n = group.record.n_equations
            if not n or not issubclass(group.kind.element, Joint) or group.bodies.shape[1] != 2:
                continue
            for e, name in enumerate(group.names):
                own = (numbers.get(f"{name}.{coordinate}", -1) for coordinate in group.kind.element.free_coordinates())
                first, second = (int(body) for body in group.bodies[e])
                rows = group.first_row + n * e + np.arange(n)
                if first != second and not self._system.timed[rows].any():
                    yield Link(name, rows, (first, second), tuple(k for k in own if k >= 0))

    def found(self) -> Chosen:
        """Return the tree whose joints describe their motion at every pose."""
        reversed_ones: set[str] = set()
        left_out: set[str] = set()
        while True:
            chosen, used = self._built(reversed_ones, left_out)
            wrong = self._wrong(chosen, used)
            if not wrong:
                return chosen
            left_out |= wrong & reversed_ones
            reversed_ones |= wrong

    def _screws(self, link: Link, child: int, backwards: bool) -> list[tuple[int, np.ndarray]] | None:
        """Return the coordinates of a joint with their screws at the pose, None if they do not describe its motion."""
        width = self._system.of_body.n_u
        columns = slice(width * child, width * (child + 1))
        unit = self._unit[columns]
        equations = self._J[link.rows][:, columns] * unit
        matrix, rank, chosen = equations, _rank(equations), list[int]()
        for k in sorted(
            link.coordinates, key=lambda k: ".angle" not in self._joints.names[k]
        ):  # of a thread, its turns
            wider = np.vstack([matrix, self._rates[k, columns] * unit])
            if rank < width and _rank(wider) > rank:
                matrix, rank = wider, rank + 1
                chosen.append(k)
        if rank < width:
            return None
        chosen.sort()
        matrix = np.vstack([equations, self._rates[chosen][:, columns] * unit])
        right = np.zeros((len(matrix), len(chosen)))
        right[len(matrix) - len(chosen) :] = np.eye(len(chosen))
        moves = np.linalg.lstsq(matrix, right, rcond=None)[0]
        moves[np.abs(moves) <= ROUNDING * np.abs(moves).max(axis=0, initial=0.0)] = 0.0
        found = [(k, self._twist(child, unit * move)) for k, move in zip(chosen, moves.T, strict=True)]
        return found[::-1] if backwards else found

    def _twist(self, body: int, u: np.ndarray) -> np.ndarray:
        """Return the velocity at the origin and the angular velocity of a body, ground axes."""
        own = self._q[self._system.of_body.n_q * body :]
        if self._system.of_body.dimensions == 2:
            return np.array([u[0] + u[2] * own[1], u[1] - u[2] * own[0], 0.0, 0.0, 0.0, u[2]])
        w = rotated(own[3:7], u[3:])
        return np.concatenate([u[:3] + np.cross(own[:3], w), w])

    def _built(self, backwards: set[str], left_out: set[str]) -> tuple[Chosen, list[Link]]:
        """Return the tree without some joints, and its joints."""
        n_bodies = len(self._system.bodies)
        carried = {n_bodies: -1}
        parents: list[int] = []
        screws: list[tuple[int, np.ndarray] | int] = []  # with the coordinate's index; or a free body
        used: list[Link] = []
        while len(carried) <= n_bodies:
            step = next(self._steps(carried, backwards, left_out), None)
            if step is None:
                body = next(b for b in range(n_bodies) if b not in carried)
                carried[body] = self._add_free(parents, screws, body)
                continue
            link, parent, child, moves = step
            frame = carried[parent]
            for move in moves:
                parents.append(frame)
                screws.append(move)
                frame = len(parents) - 1
            carried[child] = frame
            used.append(link)
        return self._numbered(parents, screws, [carried[b] for b in range(n_bodies)], used), used

    def _steps(
        self, carried: dict[int, int], backwards: set[str], left_out: set[str]
    ) -> Iterator[tuple[Link, int, int, list[tuple[int, np.ndarray]]]]:
        """Yield the joints that carry another body next."""
        for link in self._order:
            for parent, child in (link.bodies[::-1], link.bodies):
                if parent in carried and child not in carried and link.name not in left_out:
                    moves = self._screws(link, child, link.name in backwards)
                    if moves is not None:
                        yield link, parent, child, moves

    def _add_free(self, parents: list[int], screws: list[tuple[int, np.ndarray] | int], body: int) -> int:
        """Add the frames of a free body; return the last of them."""
        if self._system.of_body.dimensions == 3:
            parents.append(-1)
            screws.append(body)
            return len(parents) - 1
        for k in range(3):
            parents.append(len(parents) - 1 if k else -1)
            screws.append((-1 - 3 * body - k, self._twist(body, np.eye(3)[k])))
        return len(parents) - 1

    def _numbered(
        self, parents: list[int], screws: list[tuple[int, np.ndarray] | int], of_body: list[int], used: list[Link]
    ) -> Chosen:
        """Number the coordinates: those of joints in their order, then those of free bodies."""
        of_joints = sorted(move[0] for move in screws if not isinstance(move, int) and move[0] >= 0)
        place = {k: n for n, k in enumerate(of_joints)}
        coordinates, rates = (
            [self._joints.names[k] for k in of_joints],
            [f"{self._joints.names[k]}_rate" for k in of_joints],
        )
        kind, bodies = self._system.of_body, self._system.bodies
        frames = []
        for parent, move in zip(parents, screws, strict=True):
            at_q, at_v = len(coordinates), len(rates)
            if isinstance(move, int):
                coordinates += [f"{bodies[move]}.{label}" for label in kind.positions]
                rates += [f"{bodies[move]}.{label}" for label in kind.velocities]
                frames.append(Frame(parent, at_q, at_v, None, self._in_own_axes(move)))
            elif move[0] < 0:
                body, k = divmod(-1 - move[0], 3)
                coordinates.append(f"{bodies[body]}.{kind.positions[k]}")
                rates.append(f"{bodies[body]}.{kind.velocities[k]}")
                frames.append(Frame(parent, at_q, at_v, move[1], self._q[3 * body + k : 3 * body + k + 1]))
            else:
                at = place[move[0]]
                frames.append(Frame(parent, at, at, move[1], self._values[move[0] : move[0] + 1]))
        loops = np.ones(self._system.n_c, dtype=bool)
        for link in used:
            loops[link.rows] = False
        angles = joint_angles(self._system)
        counters = {counter: name for name, counter in (angles.counters if angles else {}).items()}
        known = {place: coordinates.index(name) for place, name in counters.items() if name in coordinates}
        tree = Tree(tuple(frames), tuple(of_body), loops, known)
        return Chosen(tree, tuple(coordinates), tuple(rates), tuple(coordinates[: len(of_joints)]))

    def _in_own_axes(self, body: int) -> np.ndarray:
        """Return position and quaternion of a body's own axes."""
        own = self._q[7 * body : 7 * body + 7].copy()
        own[3:] = times(own[3:], CONJUGATE * self._system.principal_axes[body])
        return own

    def _wrong(self, chosen: Chosen, used: list[Link]) -> set[str]:
        """Return the joints of the tree that do not hold, or have other coordinates, in another pose."""
        state = State(self._system)
        state.q[:] = self._q
        tree = JointTree(state, chosen.tree)
        rng = np.random.default_rng(0)
        n = len(chosen.joints)
        angular = np.array([name.rpartition(".")[2].startswith("angle") for name in chosen.joints], dtype=bool)
        unit = np.where(angular, 1.0, self._size)
        tree.q[:n] += TRIED * unit * rng.uniform(-1.0, 1.0, n)
        tree.v[:n] = unit * rng.uniform(-1.0, 1.0, n)
        tree.place(self._t)
        state.evaluate("motion", self._t)
        gaps = np.abs(state.vector("motion", "C")), np.abs(state.vector("motion", "V"))
        self._joints.watch(state.q, state.u)
        self._joints.begin(self._t, {})
        off = dict.fromkeys(chosen.joints, 0.0)
        for k, name, scale, turns in zip(count(), chosen.joints, unit, angular, strict=False):
            own = self._joints.names.index(name)
            change = self._joints.coordinates[own] - tree.q[k]
            change -= TURN * round(change / TURN) if turns else 0.0
            off[name] = max(abs(change), abs(self._joints.rates[own] - tree.v[k])) / scale
        wrong = set()
        for link in used:
            left = max(float(gap[link.rows].max(initial=0.0)) / max(1.0, self._size) for gap in gaps)
            left = max([left, *(off.get(self._joints.names[k], 0.0) for k in link.coordinates)])
            if not left <= SATISFIED:
                wrong.add(link.name)
        return wrong


def _rank(matrix: np.ndarray) -> int:
    return int(np.linalg.matrix_rank(matrix, tol=DEPENDENT * max(1.0, float(np.abs(matrix).max(initial=0.0)))))
