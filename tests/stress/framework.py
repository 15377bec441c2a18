"""Frameworks of slender rods that are hinged at their nodes, in the plane and in space, and their motion by nodes alone.

Between its ends a and b a slender rod of mass m has the kinetic energy m/6 (|v_a|^2 + v_a v_b + |v_b|^2), so that the
equations of motion hold nodes for unknowns and a length for each rod: [M A^T; A 0] [x''; w] = [F; -c], with
c = |v_a - v_b|^2.  Neither bodies nor angles nor hinges occur in them.  (Cook, Malkus, Plesha, Witt, Concepts and
Applications of Finite Element Analysis, 2002, sec. 11.3, for the consistent mass matrix.)
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from stiffmbs.elements.body import Body
from stiffmbs.elements.planar_kinds import JOINTS
from stiffmbs.elements.spatial import body as body_in_space
from stiffmbs.elements.spatial import marker as marker_in_space
from stiffmbs.model import spatial_model as model_in_space
from stiffmbs.model.model import Model
from stiffmbs.reading.marker import Marker
from stiffmbs.results.solution import Solution

GRAVITY = 9.81
MASS = 1.0
"""Of each rod, kg."""
THICKNESS = 0.01
"""Moment of inertia about a rod's own axis in space, kg m2; nothing turns it."""


@dataclass(frozen=True)
class Framework:
    """Rods between nodes; gravity along the last axis.

    Attributes
    ----------
    nodes : ndarray, shape (n, 2) or (n, 3)
        m.
    rods : sequence of (int, int)
    held : tuple of int
        Nodes that are hinged to the ground.
    """

    nodes: np.ndarray
    rods: Sequence[tuple[int, int]]
    held: tuple[int, ...]

    @property
    def gravity(self) -> np.ndarray:
        """m/s2."""
        down = np.zeros(self.nodes.shape[1])
        down[-1] = -GRAVITY
        return down

    @cached_property
    def ends(self) -> list[list[tuple[int, int]]]:
        """For each node the rods that end there, with the end: 0 or 1."""
        meeting: list[list[tuple[int, int]]] = [[] for _ in self.nodes]
        for rod, pair in enumerate(self.rods):
            for end, node in enumerate(pair):
                meeting[node].append((rod, end))
        return meeting

    def centre(self, rod: int) -> np.ndarray:
        """The middle of a rod."""
        return np.asarray(self.nodes[list(self.rods[rod])].mean(axis=0))

    def along(self, rod: int) -> tuple[np.ndarray, float]:
        """The direction of a rod, and its length."""
        a, b = self.rods[rod]
        way = self.nodes[b] - self.nodes[a]
        length = float(np.linalg.norm(way))
        return way / length, length


def in_plane(framework: Framework) -> Model:
    """Bodies ``rod0``, ``rod1``, ... on pins; rods that meet are pinned to the first of them."""
    model = Model("Framework", gravity=tuple(framework.gravity))
    for rod in range(len(framework.rods)):
        (c, s), length = framework.along(rod)
        pose: Any = {"position": tuple(framework.centre(rod)), "angle": float(np.arctan2(s, c))}
        model.add(f"rod{rod}", Body(mass=MASS, inertia=MASS * length**2 / 12, **pose))
    ground = [Marker(body="ground", point=tuple(node)) for node in framework.nodes]
    _hinge(framework, model, JOINTS["revolute"], lambda rod, at: Marker(body=f"rod{rod}", point=(at, 0)), ground)
    return model


def in_space(framework: Framework) -> model_in_space.Model:
    """The same with spherical joints."""
    model = model_in_space.Model("Framework", gravity=tuple(framework.gravity))
    for rod in range(len(framework.rods)):
        direction, length = framework.along(rod)
        across = MASS * length**2 / 12
        model.add(
            f"rod{rod}",
            body_in_space.Body(
                mass=MASS, inertia=(THICKNESS, across, across), position=tuple(framework.centre(rod)), orientation=_towards(direction)
            ),
        )  # fmt: skip
    ground = [marker_in_space.Marker(body="ground", point=tuple(node)) for node in framework.nodes]
    joint = model_in_space.JOINTS["spherical"]
    _hinge(framework, model, joint, lambda rod, at: marker_in_space.Marker(body=f"rod{rod}", point=(at, 0, 0)), ground)
    return model


def _hinge(
    framework: Framework, model: Any, joint: Any, marker: Callable[[int, float], Any], ground: list[Any]
) -> None:
    for node, meeting in enumerate(framework.ends):
        first, *others = [marker(rod, (end - 0.5) * framework.along(rod)[1]) for rod, end in meeting]
        if node in framework.held:
            model.add(f"foot{node}", joint(i=first, j=ground[node]))
        for k, other in enumerate(others):
            model.add(f"hinge{node}_{k}", joint(i=other, j=first))


def _towards(direction: np.ndarray) -> tuple[float, float, float, float]:
    """The quaternion that turns the axis x into a direction by the smallest angle."""
    x, y, z = direction
    if x < -0.9:  # half a turn about z before that
        w, a, b, c = _towards(-direction)
        return (-c, b, -a, w)
    p = np.array([1 + x, 0.0, -z, y])
    w, a, b, c = (p / np.linalg.norm(p)).tolist()
    return (w, a, b, c)


def node_positions(framework: Framework, times: np.ndarray) -> np.ndarray:
    """Where the nodes are when the framework falls from rest, shape (len(times), n, 2 or 3)."""
    from scipy.integrate import solve_ivp

    count = framework.nodes.size
    accelerations = _nodal(framework)

    def rate(_: float, y: np.ndarray) -> np.ndarray:
        return np.concatenate([y[count:], accelerations(y[:count], y[count:])])

    start = np.concatenate([framework.nodes.ravel(), np.zeros(count)])
    found = solve_ivp(rate, (0.0, times[-1]), start, "DOP853", times, rtol=1e-11, atol=1e-11)
    return np.asarray(found.y[:count].T).reshape(len(times), *framework.nodes.shape)


def _nodal(framework: Framework) -> Callable[[np.ndarray, np.ndarray], np.ndarray]:
    """Accelerations of the nodes from positions and velocities, by the sparse block system."""
    from scipy.sparse import block_array, csc_array, eye_array, kron
    from scipy.sparse.linalg import splu

    (n, width), a, b = framework.nodes.shape, *np.array(framework.rods).T
    rods = np.arange(len(a))
    ones = np.ones(len(a))
    mass = csc_array(
        (MASS / 6 * np.tile(ones, 4), (np.concatenate([a, b, a, b]), np.concatenate([a, b, b, a]))), (n, n)
    )
    mass = mass + csc_array((MASS / 6 * np.tile(ones, 2), (np.concatenate([a, b]), np.concatenate([a, b]))), (n, n))
    load = np.outer(MASS / 2 * np.bincount(np.concatenate([a, b]), minlength=n), framework.gravity)
    free = np.repeat(np.isin(np.arange(n), framework.held, invert=True), width)
    full = csc_array(kron(mass, eye_array(width)))[:, free][free]
    rows = np.repeat(rods, 2 * width)
    columns = (width * np.stack([a, b], 1)[:, :, None] + np.arange(width)).ravel()

    def accelerations(x: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Accelerations of the free nodes."""
        way, rate = (part.reshape(n, width)[a] - part.reshape(n, width)[b] for part in (x, v))
        values = np.stack([way, -way], 1).ravel()
        jacobian = csc_array((values, (rows, columns)), (len(rods), n * width))[:, free]
        system = block_array([[full, jacobian.T], [jacobian, 0 * eye_array(len(rods))]], format="csc")
        known = np.concatenate([load.ravel()[free], -(rate**2).sum(axis=1)])
        result = np.zeros(n * width)
        result[free] = splu(system).solve(known)[: free.sum()]
        return result

    return accelerations


def distance(framework: Framework, solution: Solution) -> float:
    """The largest distance of a rod's middle from where its nodes say it is, m."""
    nodes = node_positions(framework, solution.t)
    axes = "xyz"[: framework.nodes.shape[1]]
    worst = 0.0
    for rod, (a, b) in enumerate(framework.rods):
        middle = np.stack([solution[f"rod{rod}.{axis}"] for axis in axes], axis=1)
        worst = max(worst, float(np.max(np.abs(middle - (nodes[:, a] + nodes[:, b]) / 2))))
    return worst
