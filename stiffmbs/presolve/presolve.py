"""Presolve: smaller systems solved in place of the model, and recovery of the whole motion.

Bodies connected by fixed joints are merged, spins of axisymmetric bodies are removed from their quaternions, and
independent mechanisms are solved separately. All body states follow from the solved ones, and all reactions from the
equations of the whole model.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..compile.compile_model import compile_model
from ..compile.quaternions import CONJUGATE, rotated, times
from ..compile.system import System
from ..model.model_data import ModelData
from ..reading.marker import Placement
from .merged_bodies import merge
from .reduced_model import ReducedModel, name_of_angle
from .relations import PRESOLVE
from .spinning_bodies import AXES, spinning
from .subsystems import mechanisms, part_of, trailing_coordinates

if TYPE_CHECKING:
    from ..elements.spatial.marker import Placement as SpatialPlacement

IDENTITY = np.array([1.0, 0.0, 0.0, 0.0])


class PlanarPoses(NamedTuple):
    """Poses in the plane. `point`, `angle`: centres of mass and axes in those of the parent bodies, m, rad."""

    point: np.ndarray
    angle: np.ndarray

    @classmethod
    def of(cls, placements: Sequence[Placement]) -> PlanarPoses:
        """Return the poses of planar placements."""
        return cls(np.array([place.point for place in placements]), np.array([place.angle for place in placements]))

    @property
    def moved(self) -> bool:
        """True if any pose differs from that of its parent body."""
        return bool(self.point.any() or self.angle.any())

    def inverse(self) -> PlanarPoses:
        """Return the poses of the parent bodies on the bodies."""
        return PlanarPoses(-_turned(-self.angle, self.point), -self.angle)

    def like(self, q: np.ndarray, parent: np.ndarray) -> PlanarPoses:
        """Return the same poses: those in the plane have one representation."""
        return self

    def carried(self, q: np.ndarray, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the states of the bodies from those of their parents, shapes (..., k, n_q) and (..., k, n_u)."""
        arm = _turned(q[..., 2], self.point)
        across = np.stack([-arm[..., 1], arm[..., 0]], axis=-1)
        place = np.concatenate([q[..., :2] + arm, (q[..., 2] + self.angle)[..., None]], axis=-1)
        return place, np.concatenate([u[..., :2] + u[..., 2:] * across, u[..., 2:]], axis=-1)


class SpatialPoses(NamedTuple):
    """Poses in space.

    `point`, `turn`: centres of mass and principal axes in those of the parent bodies, m, quaternions.
    """

    point: np.ndarray
    turn: np.ndarray

    @classmethod
    def of(cls, placements: Sequence[SpatialPlacement]) -> SpatialPoses:
        """Return the poses of placements in space."""
        return cls(
            np.array([place.point for place in placements]), np.array([place.orientation for place in placements])
        )

    @property
    def moved(self) -> bool:
        """True if any pose differs from that of its parent body."""
        return bool(self.point.any() or np.any(self.turn != IDENTITY))

    def inverse(self) -> SpatialPoses:
        """Return the poses of the parent bodies on the bodies."""
        back = CONJUGATE * self.turn
        return SpatialPoses(-rotated(back, self.point), back)

    def like(self, q: np.ndarray, parent: np.ndarray) -> SpatialPoses:
        """Choose the sign of each quaternion that is continuous with that of the parent's first body.

        `q` of shape (k, n_q): coordinates of the bodies. `parent` of shape (k,): number of each body's parent body.
        """
        _, first, number = np.unique(parent, return_index=True, return_inverse=True)
        of_parent = times(q[first, 3:], CONJUGATE * self.turn[first])[number]
        against = np.sum(times(of_parent, self.turn) * q[:, 3:], axis=1) < 0
        return SpatialPoses(self.point, np.where(against[:, None], -self.turn, self.turn))

    def carried(self, q: np.ndarray, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the states of the bodies from those of their parents, as `PlanarPoses.carried`."""
        p, w = q[..., 3:], u[..., 3:]
        arm = rotated(p, self.point)
        velocity = u[..., :3] + np.cross(rotated(p, w), arm)
        place = np.concatenate([q[..., :3] + arm, times(p, self.turn)], axis=-1)
        return place, np.concatenate([velocity, rotated(CONJUGATE * self.turn, w)], axis=-1)


def _turned(phi: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Rotate points from body axes to ground axes."""
    c, s, (xi, eta) = np.cos(phi), np.sin(phi), np.moveaxis(points, -1, 0)
    return np.stack([c * xi - s * eta, s * xi + c * eta], axis=-1)


BodyFixedPoses = PlanarPoses | SpatialPoses
BODY_FIXED_POSES: dict[int, type[PlanarPoses] | type[SpatialPoses]] = {2: PlanarPoses, 3: SpatialPoses}


@dataclass(frozen=True, eq=False)
class Part:
    """Mechanism to solve, and the bodies of the whole model that its bodies carry.

    - `bodies`: numbers of the bodies in the whole model.
    - `parent`: number in `system` of the body that carries each of them.
    - `poses`: poses of the bodies on their parents.
    - `trailing`: coordinates of the whole model that the part's rotation counters and states represent.
    - `kept`: the corresponding coordinates of the part.
    """

    system: System
    bodies: np.ndarray
    parent: np.ndarray
    poses: BodyFixedPoses
    trailing: np.ndarray
    kept: np.ndarray
    spins: tuple[Spin, ...]

    def reduced(self, q: np.ndarray, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the coordinates and velocities of the part's bodies, from consistent ones of the whole model."""
        of, first = np.unique(self.parent, return_index=True)
        assert len(of) == len(self.system.bodies)
        trailing, rates = np.zeros(self.system.n_q - self.system.n_pose), u.reshape(-1, self.system.of_body.n_u)
        trailing[self.kept - self.system.n_pose] = q[self.trailing]
        places = q[: self.system.of_body.n_q * len(rates)].reshape(len(rates), -1)
        places, rates = places[self.bodies], rates[self.bodies]
        if self.poses.moved:
            places, rates = self.poses.inverse().carried(places, rates)
        return np.concatenate([places[first].ravel(), trailing]), rates[first].ravel()

    def put(self, q: np.ndarray, u: np.ndarray, into_q: np.ndarray, into_u: np.ndarray) -> None:
        """Write the states of the bodies of the whole model, one state per row, from those of the part."""
        n_q, n_u, count = self.system.of_body.n_q, self.system.of_body.n_u, len(self.system.bodies)
        into_q[:, self.trailing] = q[:, self.kept]
        if self._is_whole and into_u.shape[1] == n_u * count:  # nothing to select, which is slow for thousands of rows
            into_q[:, : n_q * count], into_u[:] = q[:, : n_q * count], u
            self._turn(into_q[:, : n_q * count].reshape(len(q), count, n_q), into_u.reshape(len(u), count, n_u), q)
            return
        of, rates = q[:, : n_q * count].reshape(len(q), count, n_q), u.reshape(len(u), count, n_u)
        if self.spins:
            of, rates = of.copy(), rates.copy()
            self._turn(of, rates, q)
        of, rates = of[:, self.parent], rates[:, self.parent]
        if self.poses.moved:
            of, rates = self.poses.carried(of, rates)
        into_q[:, n_q * self.bodies[:, None] + np.arange(n_q)] = of
        into_u[:, n_u * self.bodies[:, None] + np.arange(n_u)] = rates

    @cached_property
    def _is_whole(self) -> bool:
        """True if the part's bodies are those of the whole model, in the same order."""
        order = np.arange(len(self.system.bodies))
        return not self.poses.moved and np.array_equal(self.bodies, order) and np.array_equal(self.parent, order)

    def _turn(self, places: np.ndarray, rates: np.ndarray, q: np.ndarray) -> None:
        """Apply the spins to quaternions and velocities, shapes (rows, bodies, n_q) and (rows, bodies, n_u)."""
        for spin in self.spins:
            spin.turned(places, rates, q[:, spin.angle])


def parts_of(model: ModelData, whole: System, travel: np.ndarray | None, apart: bool) -> tuple[Part, ...]:
    """Return the mechanisms to solve in place of a compiled model; empty if none replaces it.

    `whole`: with its redundant equations marked. `travel` of shape (n_u,): initial velocities times the duration of the
    run; None to keep all spins in the quaternions. `apart`: whether independent mechanisms are solved separately, if they
    are few.
    """
    held = {joint for joint, _ in whole.equations} - {joint for (joint, _), on in zip(whole.equations, whole.active, strict=True) if not on}  # fmt: skip
    reduced = merge(model, held)
    if travel is not None and whole.of_body.dimensions == 3:
        reduced = replace(reduced, axes=spinning(reduced, _turns(reduced, whole, travel)))
    system = _compiled(reduced, whole) if reduced.members or reduced.axes else whole
    found = mechanisms(system) if apart else []
    if not 1 < len(found) <= PRESOLVE.most_apart:
        if system is whole:
            return ()
        found = [np.arange(len(system.bodies))]
    return tuple(_part(bodies, system, whole, reduced) for bodies in found)


def _turns(reduced: ReducedModel, whole: System, travel: np.ndarray) -> dict[str, np.ndarray]:
    """Return the angular displacement of each solved body about its principal axes."""
    of_bodies = travel.reshape(len(whole.bodies), -1)[:, whole.of_body.linear :]
    turns = dict(zip(whole.bodies, of_bodies, strict=True))
    for name in reduced.bodies.keys() & reduced.members.keys():
        turns[name] = rotated(np.array(reduced.members[name][1].orientation), turns[name])
    return turns


def _compiled(model: ReducedModel, whole: System) -> System:
    """Compile the model in place of the whole one, with the same redundant equations and the same size."""
    system = compile_model(model)
    on = dict(zip(whole.equations, whole.active, strict=True))
    return replace(system, active=np.array([on[equation] for equation in system.equations], dtype=bool))


def _part(bodies: np.ndarray, system: System, whole: System, reduced: ReducedModel) -> Part:
    own = part_of(system, bodies)
    number = {name: k for k, name in enumerate(own.bodies)}
    of_whole, of_part = trailing_coordinates(whole), trailing_coordinates(own)
    shared = sorted(of_part.keys() & of_whole.keys(), key=of_part.__getitem__)
    trailing, kept = (np.array([of[key] for key in shared], dtype=np.int64) for of in (of_whole, of_part))
    spins = tuple(
        Spin(number[name], AXES.index(axis), of_part[name_of_angle(name), None])
        for name, axis in reduced.axes.items()
        if name in number
    )
    on_parents = [(k, *reduced.on_parent(name)) for k, name in enumerate(whole.bodies)]
    carried = [(k, number[parent], placed) for k, parent, placed in on_parents if parent in number]
    numbers, parent = (np.array([each[k] for each in carried]) for k in (0, 1))
    at_initial_pose = whole.q[: whole.n_pose].reshape(len(whole.bodies), -1)[numbers]
    poses = BODY_FIXED_POSES[whole.of_body.dimensions].of([placed for _, _, placed in carried])
    placed = poses.like(at_initial_pose, parent)
    return Part(own, numbers, parent, placed, trailing, kept, spins)


class Spin(NamedTuple):
    """Body of a part whose quaternion excludes its spin.

    `body`: its number in the part. `axis`: principal axis of the spin. `angle`: coordinate of the part that holds the
    angle.
    """

    body: int
    axis: int
    angle: int

    def turned(self, q: np.ndarray, u: np.ndarray, angle: np.ndarray) -> None:
        """Rotate the body by the angle (rows,), in arrays of shapes (rows, bodies, n_q) and (rows, bodies, n_u)."""
        turn = np.zeros((len(angle), 4))
        turn[:, 0], turn[:, 1 + self.axis] = np.cos(angle / 2), np.sin(angle / 2)
        q[:, self.body, 3:] = times(q[:, self.body, 3:], turn)
        u[:, self.body, 3:] = rotated(CONJUGATE * turn, u[:, self.body, 3:])
