"""Deformation, strain energy and stresses of a flexible body in a run."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..compile.quaternions import rotated
from ..elements.spatial.flexible.bodies import FloatingFrame
from ..errors import InputError, needs
from ..flexible_bodies.finite_elements import FiniteElements
from ..flexible_bodies.reduction import ReducedBody, static_solver
from ..flexible_bodies.second_order import displacement_of_second_order, stress_of
from ..flexible_bodies.stress import StressPoints, principal_stresses, stress_points, von_mises
from ..reading.did_you_mean import did_you_mean

if TYPE_CHECKING:
    from ..model.scene import Scene
    from .solution import Solution
AT_ONCE = 50_000_000
"""Numbers in the coefficients of a function, or in its values, that are in memory at once; they take 400 MB."""


@dataclass(frozen=True)
class Peak:
    """Largest value of a stress over all nodes and output times."""

    value: float  # N/m^2
    node: int  # from 0
    point: tuple[float, float, float]  # position of the node in the mesh, m
    time: float  # s


class FlexibleMotion:
    """Motion of a flexible body at the output times of a run.

    Parameters
    ----------
    scene : Scene
        The scene that was run.
    solution : mapping of str to ndarray
        Its solution, or other channels over time with an entry ``time``-like attribute `t`.
    body : str
        Name of the flexible body.

    Attributes
    ----------
    t : ndarray, shape (times,)
    modal : ndarray, shape (times, modes)
        Coordinates of modes with unit modal mass, m kg^(1/2).

    Raises
    ------
    InputError
        If there is no such body.
    """

    def __init__(self, scene: Scene, solution: Solution, body: str) -> None:
        self.check(scene, body)
        frame = scene.bodies[f"{body}.frame"]
        self.name, self.t = body, np.asarray(solution.t)
        self._source = frame.source
        self._frame = np.array([solution[f"{body}.frame.{axis}"] for axis in ["x", "y", "z", "q0", "q1", "q2", "q3"]]).T
        moving = ["ax", "ay", "az", "wx", "wy", "wz", "wdx", "wdy", "wdz"]
        self._motion = np.array([solution[f"{body}.frame.{axis}"] for axis in moving]).T
        self._motion[:, :3] -= scene.gravity
        places = [f"{body}.modes{1 + k // 3}.{'xyz'[k % 3]}" for k in range(len(self.reduced.frequencies))]
        values = np.array([solution[place] for place in places]).reshape(len(places), len(self.t))
        self.modal = values.T * np.sqrt(self.reduced.mass)
        errors = getattr(solution, "errors", {})
        self._modal_errors: np.ndarray | None = None
        if places and errors.keys() >= {*places}:
            self._modal_errors = np.array([errors[place].over_time for place in places]) * np.sqrt(self.reduced.mass)

    @staticmethod
    def check(scene: Scene, body: str) -> None:
        """Raise an InputError for the name of another body."""
        names = [name.removesuffix(".frame") for name, each in scene.bodies.items() if isinstance(each, FloatingFrame)]
        if body not in names:
            listed = ", ".join(names) or "none in this scene"
            raise InputError(f"found no flexible body '{body}'{did_you_mean(body, names)}, expected one of {listed}")

    @cached_property
    def reduced(self) -> ReducedBody:
        """Reduced body with its mode shapes."""
        from ..flexible_bodies.reduced import reduced_body

        return reduced_body(*self._source)

    @cached_property
    def model(self) -> FiniteElements:
        """Finite element model."""
        body, folder = self._source
        return body.model(folder)  # type: ignore[no-any-return]

    @cached_property
    def _second_order(self) -> Callable[[np.ndarray], np.ndarray]:
        """Displacements of second order of all nodes by those of first order, with geometric stiffening."""
        model, interfaces = self.model, self._source[0].interfaces_on(self.model)
        solver, _ = static_solver(model, interfaces, model.rigid_modes(self.reduced.centre))
        return partial(displacement_of_second_order, model, stress_of(model), interfaces, solver)

    @cached_property
    def _further_displacement(self) -> Quadratic:
        """Displacements of second order of all nodes, shape (times, size)."""
        return Quadratic(self._second_order, self.reduced.modes, len(self.t))

    @cached_property
    def _further_stress(self) -> Quadratic:
        """Stresses by displacements and strains of second order, shape (times, points, 6)."""

        def further(first: np.ndarray) -> np.ndarray:
            """Return the stress of second order of a displacement."""
            return self._points.stresses(self._second_order(first)[:, None], first[:, None])[0]

        return Quadratic(further, self.reduced.modes, len(self.t))

    def displacement(self, nodes: Sequence[int] | None = None, at: slice | np.ndarray = slice(None)) -> np.ndarray:
        """Return the displacements of nodes in the floating frame, m, in the axes of the mesh.

        `nodes`: all by default. `at`: output times by number. The result: shape (times, nodes, 3).
        """
        chosen = np.arange(self.reduced.nodes) if nodes is None else self._checked(nodes)
        entries = (self.reduced.components * chosen[:, None] + np.arange(3)).ravel()
        modal = self.modal[at]
        found = modal @ self.reduced.modes[entries].T
        if self._source[0].is_stiffened:
            found += self._further_displacement(modal)[:, entries]
        return found.reshape(len(modal), len(chosen), 3)

    def position(self, nodes: Sequence[int] | None = None, at: slice | np.ndarray = slice(None)) -> np.ndarray:
        """Return the positions of nodes in ground axes, m; parameters and shape as `displacement`."""
        chosen = np.arange(self.reduced.nodes) if nodes is None else self._checked(nodes)
        own = self.displacement(nodes, at) + self.model.nodes[chosen] - self.reduced.centre
        turned = np.array([rotated(pose[3:], points) for pose, points in zip(self._frame[at], own, strict=True)])
        return self._frame[at][:, None, :3] + turned.reshape(own.shape)

    def strain_energy(self) -> np.ndarray:
        """Return the strain energy of each mode, J, shape (times, modes), with geometric stiffening that of strains of second order."""
        strained, terms = self.modal, self.reduced.second_order
        if self._source[0].is_stiffened:
            stretches = np.einsum("tk,ikl,tl->ti", strained, terms.stretch, strained, optimize=True) / 2
            strained = strained + stretches @ terms.static.T
        return (2 * np.pi * self.reduced.frequencies * strained) ** 2 / 2  # type: ignore[no-any-return]

    def unrepresented(self) -> tuple[float, float]:
        """Return the share of the strain energy by inertia and weight that the modes cannot represent, and its time, s.

        It is that of the static response of the mesh to these loads with the interfaces held, relative to the largest
        strain energy of the run. Loads are those at the largest acceleration, angular velocity and angular acceleration.
        """
        model, largest = self.model, (0.0, float(self.t[0]))
        rigid = model.rigid_modes(self.reduced.centre)
        solver, _ = static_solver(model, self._source[0].interfaces_on(model), rigid)
        total = float(self.strain_energy().sum(axis=1).max())
        for k in {int(np.linalg.norm(self._motion[:, part : part + 3], axis=1).argmax()) for part in (0, 3, 6)}:
            acceleration, w, alpha = self._motion[k].reshape(3, 3)
            uniform = rotated(self._frame[k, 3:] * [1, -1, -1, -1], acceleration)
            gradient = np.cross(alpha, np.eye(3)) + np.cross(w, np.cross(w, np.eye(3)))  # of unit arms, by rows
            load = -model.inertial_forces(uniform[:, None], gradient.T[:, :, None], self.reduced.centre)[:, 0]
            missing = load @ solver.held_response(load) / 2 - self.reduced.energy_under(load, rigid)
            largest = max(largest, (float(missing / (missing + total or 1.0)), float(self.t[k])))
        return largest

    @cached_property
    def _points(self) -> StressPoints:
        """Points with stresses."""
        return stress_points(self.model)

    @cached_property
    def _stress_modes(self) -> np.ndarray:
        """Stresses xx yy zz xy yz zx by mode, shape (modes, points, 6)."""
        return self._points.stresses(self.reduced.modes)

    @property
    def stress_nodes(self) -> np.ndarray:
        """Node of each point with a stress: all nodes of solids; of shells each node at least twice, for both surfaces."""
        return self._points.nodes

    def stress(self, at: slice | np.ndarray = slice(None)) -> np.ndarray:
        """Return the stresses xx, yy, zz, xy, yz, zx, N/m^2, in the axes of the mesh, shape (times, points, 6).

        They are the mean of the elements at a point, and contain strains of second order with geometric stiffening. The points are
        those of `stress_nodes`. `at`: output times by number. Raises InputError if the body is described by matrices.
        """
        modal = self.modal[at]
        found = np.tensordot(modal, self._stress_modes, 1)
        if self._source[0].is_stiffened:
            found += self._further_stress(modal)
        return found

    def von_mises(self, at: slice | np.ndarray = slice(None)) -> np.ndarray:
        """Return the von Mises stresses at the nodes, N/m^2, shape (times, nodes): of shells the largest there; see `stress`."""
        return self._largest(von_mises(self.stress(at)))

    def principal(self, at: slice | np.ndarray = slice(None)) -> np.ndarray:
        """Return the principal stresses, N/m^2, the largest first, shape (times, points, 3); see `stress`."""
        return principal_stresses(self.stress(at))

    def _largest(self, of_points: np.ndarray) -> np.ndarray:
        """Return the largest value at each node, shape (times, nodes)."""
        first = np.searchsorted(self.stress_nodes, np.arange(self.reduced.nodes))
        return np.maximum.reduceat(of_points, first, axis=1)  # type: ignore[no-any-return]

    def peaks(self) -> dict[str, Peak]:
        """Return the largest von Mises and principal stress and the smallest principal stress, with place and time."""
        found: dict[str, Peak] = {}
        step = max(1, AT_ONCE // max(1, 6 * len(self.stress_nodes)))
        for first in range(0, len(self.t), step):
            stress = self.stress(slice(first, first + step))
            principal = principal_stresses(stress)
            for name, values, sign in (
                ("von Mises", von_mises(stress), 1), ("largest principal", principal[..., 0], 1),
                ("smallest principal", principal[..., 2], -1),
            ):  # fmt: skip
                row, point = np.unravel_index(int((sign * values).argmax()), values.shape)
                value, node = float(values[row, point]), int(self.stress_nodes[point])
                if name not in found or sign * value > sign * found[name].value:
                    x, y, z = self.model.nodes[node].tolist()
                    found[name] = Peak(value, node, (x, y, z), float(self.t[first + row]))
        return found

    def error_of_stress(self, peak: Peak) -> float | None:
        """Return the error bar of the von Mises stress at the node and time of a peak, N/m^2, if the run was verified."""
        if self._modal_errors is None:
            return None
        at = self.stress_nodes == peak.node
        rates = self._stress_modes[:, at]
        if self._source[0].is_stiffened:
            modal = self.modal[np.abs(self.t - peak.time).argmin()]
            differences = (self._further_stress(modal + np.outer([1, -1], unit))[:, at] for unit in np.eye(len(modal)))
            rates = rates + [(more - less) / 2 for more, less in differences]
        return float((self._modal_errors @ von_mises(rates)).max())

    def write(self, path: Path, at: slice | np.ndarray = slice(None), scale: float = 1.0) -> None:
        """Write the moving and deformed mesh over time for ParaView, with displacement and stresses.

        `path`: an XDMF file (.xdmf). `at`: output times by number. `scale`: factor of the deformation in the positions.
        Raises InputError if the type of the file is another one.
        """
        if path.suffix.lower() != ".xdmf":
            raise InputError(f"-o {path}: found the type '{path.suffix}', expected .xdmf")
        with needs("meshio", "flexible"):
            import meshio
        cells = list(dict(self.model.cells or {"vertex": np.arange(len(self.model.nodes))[:, None]}).items())
        with meshio.xdmf.TimeSeriesWriter(path, data_format="XML") as writer:
            writer.write_points_cells(self.model.nodes, cells)
            for k in np.arange(len(self.t))[at]:
                writer.write_data(float(self.t[k]), point_data=self._fields(int(k), scale))

    def _fields(self, k: int, scale: float) -> Mapping[str, np.ndarray]:
        row = np.array([k])
        own = self.displacement(at=row)[0]
        moved = self.position(at=row)[0]
        if scale != 1.0:
            moved = moved + rotated(self._frame[k, 3:], (scale - 1.0) * own)
        fields = {"displacement": own, "moved": moved - self.model.nodes}
        if self.model.has_stresses:
            stress = self.stress(row)
            for name, values in (
                ("von Mises", von_mises(stress)),
                ("largest principal", principal_stresses(stress)[..., 0]),
            ):
                fields[name] = self._largest(values)[0]
        return fields

    def _checked(self, nodes: Sequence[int]) -> np.ndarray:
        chosen, count = np.asarray(nodes, dtype=np.int64), self.reduced.nodes
        if chosen.size and not 0 <= chosen.min() <= chosen.max() < count:
            wrong = chosen.max() if chosen.min() >= 0 else chosen.min()
            raise InputError(f"nodes: found node {wrong}, expected 0 to {count - 1}")
        return chosen


class Quadratic:
    """Homogeneous quadratic function of the coordinates of n modes.

    Many values are sums of products of coordinates with coefficients, which are found once.

    Parameters
    ----------
    function : callable
        Function of a displacement, shape (size,). It returns an array of any shape.
    modes : ndarray, shape (size, n)
        Displacements by unit coordinates.
    times : int
        Number of times at which values may be needed. For fewer ones than coefficients, each value is found by itself.
    """

    def __init__(self, function: Callable[[np.ndarray], np.ndarray], modes: np.ndarray, times: int) -> None:
        self._function, self._modes, self._times = function, modes, times
        self._pairs = np.triu_indices(modes.shape[1])

    def __call__(self, coordinates: np.ndarray) -> np.ndarray:
        """Return the values at coordinates, shape (times, n); the first axis is that of the times."""
        if self._coefficients is None:
            found = [self._function(self._modes @ each) for each in coordinates]
            return np.array(found) if found else np.empty((0, *self._function(np.zeros(len(self._modes))).shape))
        one, other = self._pairs
        return np.tensordot(coordinates[:, one] * coordinates[:, other], self._coefficients, 1)

    @cached_property
    def _coefficients(self) -> np.ndarray | None:
        """Coefficients of products of two coordinates, on the first axis; None if there are too many."""
        count, modes = len(self._pairs[0]), self._modes.T
        if not 0 < count < self._times or count * self._function(modes[0]).size > AT_ONCE:
            return None
        squares = [self._function(mode) for mode in modes]
        return np.array([
            squares[k] if k == j else self._function(modes[k] + modes[j]) - squares[k] - squares[j]
            for k, j in zip(*self._pairs, strict=True)
        ])  # fmt: skip
