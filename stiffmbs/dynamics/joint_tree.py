"""Spanning tree of a mechanism: pose, inertia and forces of all bodies from the coordinates of its joints."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..compile.machine.layout import address, packed
from ..compile.machine.object_code import SHORT
from ..compile.machine.routines import together
from ..compile.quaternions import rotated
from ..compile.state import State
from .native.layouts import BODY, FRAME, JOINT_TREE

_SIGNATURE = "void(float64, float64*, float64*, int64*)"
POSE, INERTIA, CLOSURE, FORCES, MARKER = together(
    "stiffmbs.dynamics.native.joint_tree",
    SHORT,
    pose=_SIGNATURE,
    inertia=_SIGNATURE,
    closure=_SIGNATURE,
    forces=_SIGNATURE,
    marker="void(int64, int64, float64*, int64*, float64*, float64*)",
)
MOTION_OF_MARKER = 18
"""Numbers of a marker: position, rotation matrix by rows, and the bias of its velocities."""


@dataclass(frozen=True)
class Frame:
    """Frame of a spanning tree, moved by one coordinate, or by position and quaternion of a free body.

    `parent`: index of the frame before, -1 for ground. `at_q`, `at_v`: its first coordinate and rate. `screw`: velocity of the
    point at the origin and angular velocity per rate at the reference pose, in ground axes; None for a free body. `reference`:
    coordinates at the reference pose.
    """

    parent: int
    at_q: int
    at_v: int
    screw: np.ndarray | None
    reference: np.ndarray

    @property
    def widths(self) -> tuple[int, int]:
        """Numbers of coordinates and rates."""
        return (1, 1) if self.screw is not None else (7, 6)


@dataclass(frozen=True)
class Tree:
    """Spanning tree of a mechanism.

    `frames`: each after its parent. `of_body`: frame that carries each body, -1 for ground. `loops` of shape (n_c,): True for the
    equations that the tree does not satisfy by itself. `counters`: coordinates of the tree that counters of turns follow, by
    their places in q.
    """

    frames: tuple[Frame, ...]
    of_body: tuple[int, ...]
    loops: np.ndarray
    counters: dict[int, int]

    @property
    def sizes(self) -> tuple[int, int]:
        """Numbers of coordinates and rates."""
        n_q, n_v = np.sum([frame.widths for frame in self.frames], axis=0) if self.frames else (0, 0)
        return int(n_q), int(n_v)

    @property
    def reference(self) -> np.ndarray:
        """Coordinates of the tree at the reference pose."""
        found = np.zeros(self.sizes[0])
        for frame in self.frames:
            found[frame.at_q : frame.at_q + frame.widths[0]] = frame.reference
        return found

    def path(self, body: int) -> list[int]:
        """Return the rates that move a body."""
        found: list[int] = []
        k = self.of_body[body]
        while k >= 0:
            frame = self.frames[k]
            found = [*range(frame.at_v, frame.at_v + frame.widths[1]), *found]
            k = frame.parent
        return found


class JointTree:
    """Working memory of a spanning tree at one state.

    `state`: its q and u follow from coordinates and rates of the tree; its pose is the reference pose at first.

    - `q`, `v`: coordinates and rates of the tree, for the caller to fill.
    - `N` of shape (n_u, n_v), `drift` of shape (n_u,): u = N v and u' = N v' + drift.
    - `M`, `h`: mass matrix and bias of the tree's rates: M v' + h are the efforts on them, without those of loops.
    - `C`, `J`, `gamma`: equations of the loops, and J v' = gamma of their accelerations.
    """

    def __init__(self, state: State, tree: Tree) -> None:
        system, self.tree, self.state = state.system, tree, state
        n_v, n_loops = tree.sizes[1], int(np.count_nonzero(tree.loops))
        self.q, self.v = tree.reference, np.zeros(n_v)
        self.N, self.drift = np.zeros((system.n_u, n_v)), np.zeros(system.n_u)
        self.M, self.h = np.zeros((n_v, n_v)), np.zeros(n_v)
        self.C, self.J, self.gamma = np.zeros(n_loops), np.zeros((n_loops, n_v)), np.zeros(n_loops)
        paths = [tree.path(body) for body in range(len(system.bodies))]
        memory = np.zeros((len(tree.frames) + 1, FRAME))
        memory[0, [0, 7, 11, 15]] = 1.0
        row_of = np.full(system.n_c, -1)
        row_of[tree.loops] = np.arange(n_loops)
        self._lists = {
            "parent": _ints([frame.parent + 1 for frame in tree.frames]),
            "free": _ints([frame.screw is None for frame in tree.frames]),
            "at_q": _ints([frame.at_q for frame in tree.frames]),
            "at_v": _ints([frame.at_v for frame in tree.frames]),
            "screw": np.array([np.zeros(6) if frame.screw is None else frame.screw for frame in tree.frames]).reshape(-1),
            "reference": np.array([np.resize(frame.reference, 7) for frame in tree.frames]).reshape(-1),
            "frame": memory,
            "column": np.zeros(6 * n_v),
            "body_frame": _ints([k + 1 for k in tree.of_body]),
            "body_reference": _poses(state),
            "path_start": _ints(np.cumsum([0, *map(len, paths)])),
            "path": _ints([k for path in paths for k in path]),
            "mass": np.ascontiguousarray(system.mass, dtype=float),
            "N": self.N, "drift": self.drift, "M": self.M, "h": self.h, "C": self.C, "J": self.J, "gamma": self.gamma,
            "counter": _ints([*tree.counters]), "counter_from": _ints([*tree.counters.values()]),
        }  # fmt: skip
        counts = {
            "n_bodies": len(system.bodies), "n_v": n_v, "n_frames": len(tree.frames), "n_loops": n_loops, "n_counters": len(tree.counters),
        }  # fmt: skip
        for name, term_set, term in (
            ("f", "acceleration", "f"), ("inertia", "acceleration", "inertia"), ("c", "motion", "C"), ("j", "motion", "J"),
            ("gamma", "acceleration", "gamma"), ("ja", "acceleration", "J"),
        ):  # fmt: skip
            state.load(term_set)
            found = system.term(term_set, term)
            of_loops = term in ("C", "J", "gamma")
            used = row_of[found.row] >= 0 if of_loops else np.ones(len(found.row), dtype=bool)
            counts[f"n_{name}"] = int(np.count_nonzero(used))
            self._lists[f"{name}_source"] = _ints(found.source[used])
            self._lists[f"{name}_row"] = _ints((row_of[found.row] if of_loops else found.row)[used])
            if term in ("J", "inertia"):
                self._lists[f"{name}_column"] = _ints(found.column[used])
        self.table = packed(JOINT_TREE, {"state": state.table, **self._lists, **counts})
        self._at = address(self.q), address(self.v), address(self.table)
        self._frames, self._bodies = self._lists["body_frame"], self._lists["body_reference"].reshape(-1, BODY)
        counters = range(system.n_pose, system.first_state)
        self._other_counters = [place for place in counters if place not in tree.counters]
        self._turns = state.q[self._other_counters].copy()
        self._motion, self._columns = np.zeros(MOTION_OF_MARKER), np.zeros((6, n_v))
        self._pose, self._inertia = POSE.short_call, INERTIA.short_call
        self._closure, self._forces, self._marker = CLOSURE.short_call, FORCES.short_call, MARKER.short_call

    def place(self, t: float) -> None:
        """Compute q, u, N and the drift."""
        self._pose(t, *self._at)

    def inertia(self, t: float) -> np.ndarray:
        """Return the mass matrix of the tree."""
        self._inertia(t, *self._at)
        return self.M

    def closure(self, t: float) -> None:
        """Compute C and J of the loops."""
        self._closure(t, *self._at)

    def forces(self, t: float) -> None:
        """Compute M, h, and J and gamma of the loops."""
        if self._other_counters:  # in the turns nearest to those of the reference pose
            self.place(t)
            self.state.q[self._other_counters] = self._turns
            self.state.restart_counters(t)
        self._forces(t, *self._at)

    def at_reference(self, body: int, point: np.ndarray, axes: np.ndarray) -> np.ndarray:
        """Return the numbers of a marker for `marker`: its position and axes in ground axes at the reference pose.

        `point`: from the centre of mass, m. `axes` of shape (3, 3): both in principal axes.
        """
        place, turn = self._bodies[body, :3], self._bodies[body, 3:7]
        return np.concatenate([place + rotated(turn, point), rotated(turn, axes.T).T.reshape(-1)])

    def marker(self, body: int, placed: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return position, rotation matrix and bias of a marker, and the derivatives of its velocities; memory of the next call.

        `placed`: by `at_reference`. The state was computed by any of the other functions.
        """
        self._columns[:] = 0.0
        frame = int(self._frames[body])
        self._marker(frame, body, address(placed), self._at[2], address(self._motion), address(self._columns))
        return self._motion, self._columns


def _ints(values: object) -> np.ndarray:
    return np.array(values, dtype=np.int64).reshape(-1)


def _poses(state: State) -> np.ndarray:
    """Return position, quaternion and angle of each body at the current pose."""
    of_body = state.system.of_body
    of_q = state.q[: state.system.n_pose].reshape(-1, of_body.n_q)
    found = np.zeros((len(of_q), BODY))
    found[:, : of_body.linear] = of_q[:, : of_body.linear]
    if of_body.dimensions == 3:
        found[:, 3:7] = of_q[:, 3:]
    else:
        found[:, 7] = of_q[:, 2]
        found[:, 3], found[:, 6] = np.cos(of_q[:, 2] / 2), np.sin(of_q[:, 2] / 2)
    return found.reshape(-1)
