"""Motion of closed loops from the start to given coordinates."""

from __future__ import annotations

from typing import Final

import numpy as np

from ...dynamics.joint_tree import JointTree
from ...errors import InputError, SolverError
from ..joint_pose import parts_of
from .loops import Loops, difference

SHORTEST: Final = 1e-6
"""Shortest part of a motion of loops from the start."""


class IndependentCoordinates:
    """Coordinates of a spanning tree that determine the others, and the motion of the loops to them from the start.

    Attributes
    ----------
    places : ndarray
        Places of the coordinates among those of the tree.
    names : tuple of str
        Channels of the coordinates.
    """

    def __init__(self, tree: JointTree, t: float, loops: Loops, names_of_all: tuple[str, ...]) -> None:
        self._tree, self._t, self._loops = tree, t, loops
        self._frames = [
            frame
            for frame in sorted(tree.tree.frames, key=lambda frame: frame.at_q)
            if np.isin(np.arange(frame.at_v, frame.at_v + frame.widths[1]), loops.independent).any()
        ]
        self.places = np.array([k for f in self._frames for k in range(f.at_q, f.at_q + f.widths[0])], dtype=int)
        self.names = tuple(names_of_all[k] for k in self.places)
        self._quaternions = [slice(k, k + 4) for k, name in enumerate(self.names) if name.endswith(".q0")]
        lengths = [not name.rpartition(".")[2].startswith(("angle", "q")) for name in self.names]
        self._units = np.where(lengths, tree.state.system.size or 1.0, 1.0)

    def normalised(self, q: np.ndarray) -> np.ndarray:
        """Return coordinates with unit quaternions; raise an InputError if one has the length 0."""
        found = q.copy()
        for part in self._quaternions:
            norm = float(np.linalg.norm(found[part]))
            if norm == 0.0:
                raise InputError(f"q: found a quaternion of length 0 at {self.names[part.start]}, expected length 1")
            found[part] /= norm
        return found

    def move_to(self, goal: np.ndarray) -> None:
        """Take coordinates in the tree; where joints close loops, follow the motion to them from the start.

        Raises InputError if the loops cannot be closed, and SolverError if the motion is not determined on the way.
        """
        tree = self._tree
        if not len(self._loops.dependent):
            tree.q[self.places] = goal
            return
        tree.q[:] = tree.tree.reference
        first, signs = tree.q[self.places].copy(), np.ones(len(goal))
        for part in self._quaternions:  # -p is the same rotation as p, and may have the shorter way
            signs[part] = 1.0 if first[part] @ goal[part] >= 0.0 else -1.0
        self._follow(first, signs * goal)
        tree.q[self.places] *= signs

    def _follow(self, first: np.ndarray, goal: np.ndarray) -> None:
        """Follow the motion of the loops, in shorter parts where they may close in another way."""
        tree, loops = self._tree, self._loops
        if np.array_equal(first, goal) and loops.close():
            return
        longest = part = 1.0 / parts_of(float((np.abs(goal - first) / self._units).max(initial=0.0)), "q")
        way = self._way(goal)
        tree.closure(self._t)
        passed, done, opened = loops.along(way), 0.0, False
        while done < 1.0:
            trial = 1.0 if done + 1.5 * part > 1.0 else done + part
            tree.q[:] = passed.q
            tree.q[self.places] = self.normalised(first + (goal - first) * trial)
            try:
                closed = loops.close()
                opened |= not closed
                now = loops.along(way)
            except SolverError:  # a singular pose
                closed = False
            if closed and passed.leads_to(now):
                passed, done, part = now, trial, min(longest, 2.0 * part)
                continue
            part = 0.5 * (trial - done)
            if part < SHORTEST:
                raise self._stopped(first + (goal - first) * trial, goal, opened)

    def _way(self, goal: np.ndarray) -> np.ndarray:
        """Return the independent rates of a motion from the start."""
        first, there = self._tree.tree.reference, self._tree.tree.reference
        there[self.places] = goal
        rates = np.zeros(len(self._tree.v))
        for frame in self._frames:
            rates[frame.at_v : frame.at_v + frame.widths[1]] = difference(frame, first, there)
        found: np.ndarray = rates[self._loops.independent]
        return found

    def _stopped(self, here: np.ndarray, goal: np.ndarray, opened: bool) -> InputError | SolverError:
        """Return the error of a motion of the loops that ends before its goal."""
        at, end = (
            ", ".join(f"{name} = {value:g}" for name, value in zip(self.names, q, strict=True)) for q in (here, goal)
        )
        if opened:
            return InputError(f"q: the loops cannot be closed at {end}; expected coordinates that the joints allow")
        where = "in this pose" if at == end else f"at {at}, on the way from the start to {end}"
        return SolverError(
            f"the coordinates {', '.join(self.names)} do not determine the motion {where}, such as a dead point; choose other "
            "coordinates by `independent`, or another pose"
        )
