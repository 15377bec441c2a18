"""Models as functions of the coordinates of their joints."""

from __future__ import annotations

import math
import numbers
from collections.abc import Sequence
from typing import Any, Unpack

import numpy as np

from ...analyses.job import Runnable, data_of, prepare, settings_of
from ...analyses.linearised.transfer import STEP
from ...compile.state import State
from ...dynamics.joint_tree import JointTree
from ...errors import InputError, SolverError
from ...linear_analysis.transfer import Transfer
from ...model.settings import RunSettings, Settings, takes_settings
from ...reading.marker import MarkerReference
from ...results.channels import channels_of, turns_of
from ...results.joint_coordinates import JointCoordinates
from ...results.saved_state import SavedState
from ...solve.settings import changed
from .efforts import Efforts, coordinates_of_drives, least_efforts, places_of
from .following import IndependentCoordinates
from .independent import named, order_of, places_in, refuse_others, refuse_velocities
from .inverse_kinematics import Reach, Wanted, nearest
from .linear import LinearInputs, joint_equations, refuse_reactions
from .loops import Loops, move_tree
from .markers import MarkerPose, PlacedMarker, placed_marker
from .mass_matrix import solved
from .spanning_tree import SpanningTree

Array = np.ndarray | Sequence[float]


@takes_settings
def joint_space(
    model: Runnable,
    independent: Sequence[str] | None = None,
    settings: RunSettings | None = None,
    **changes: Unpack[Settings],
) -> JointSpace:
    """Return a model as functions of the coordinates of its joints.

    Drives are left out: their coordinates move freely, and `JointSpace.actuator_efforts` has their efforts. States, inputs and time
    keep their values of the start.

    Parameters
    ----------
    model : Model, Scene, str or Path
    independent : sequence of str, optional
        Coordinates that determine the others where joints close loops, such as ``crank.angle``, one for each degree of freedom.
        By default the first coordinates in the order of the scene that do so well at the start.
    settings : RunSettings, optional
        Settings of the run; by default those of the scene.
    **changes
        Fields of the settings to change.

    Raises
    ------
    InputError
        If the model or a coordinate is invalid, if a joint depends on time or constrains velocities only, if forces depend on
        reactions, or if a state has no rate.
    AssemblyError
        If no consistent start is found.

    Examples
    --------
    >>> space = stiffmbs.joint_space("examples/cart_pendulum.yaml")
    >>> space.coordinates
    ('rail.displacement', 'hinge.angle')
    >>> M = space.mass_matrix([0.0, 0.3])
    """
    data = data_of(model)
    drives = coordinates_of_drives(data)
    wanted = {} if not drives else {"joints": {k: v for k, v in data.joints.items() if k not in drives}, "requests": {}}
    settings = changed(settings_of(data, settings, dict(changes)), {"presolve": False})
    return JointSpace(data.model_copy(update=wanted), settings, drives, independent)


class JointSpace:
    """Model as functions of the coordinates of its joints; made by `stiffmbs.joint_space`.

    All arrays have the order of `coordinates` (q) and `rates` (v, accelerations, efforts), in SI units. Joints come in the order of
    `Simulation.joint_coordinates`; those that loops determine are left out. Bodies follow that no joint with such coordinates carries.
    In space they have the position of the centre of mass and the quaternion of their own axes, of which dependent parts are corrected.
    Their rates are the velocity in ground axes and the angular velocity in own axes. Each thread needs its own `JointSpace`.

    The equations of motion are M(q) v' + h(q, v) = tau. With the velocities u = N(q) v of all bodies, M = N^T M_u N and
    h = N^T (M_u N' v - f), where f has the gyroscopic terms (Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems, 1989,
    sections 7.3 and 11.4; Featherstone, Rigid Body Dynamics Algorithms, 2008, section 3.1).

    Attributes
    ----------
    coordinates, rates : tuple of str
        Channels of q and of v.
    q, v : ndarray
        Values of the assembled start without drives; a driven coordinate has the value of the described pose.
    """

    def __init__(
        self, data: Any, settings: RunSettings, drives: dict[str, str], independent: Sequence[str] | None
    ) -> None:
        job = prepare(data, settings)
        self._data, self._settings, self._drives, self._job = data, settings, drives, job
        system, self._t = job.dynamics.system, job.grid.start
        refuse_others(system)
        self._size = system.size or 1.0
        joints = JointCoordinates(system, data.joints)
        given = named("independent", independent)
        first = frozenset(given), frozenset(drives.values())
        chosen = SpanningTree(job.dynamics, joints, self._t, job.start.q, first).found()
        self._all, tree = chosen, chosen.tree
        refuse_velocities(system, tree.loops)
        self._state = State(system)
        self._state.q[:] = job.start.q
        self._tree = JointTree(self._state, tree)
        names = tuple(name.removesuffix("_rate") for name in chosen.rates)
        self._units = np.array([self._unit(name) for name in chosen.rates])
        count = tree.sizes[1] - (system.n_u - int(np.count_nonzero(system.active)))
        order = order_of(chosen.rates, len(chosen.joints), places_in(given, names, len(names) - count if given else 0))
        self._loops = Loops(self._tree, self._t, names, order, count, self._units)
        if given and not {names[k] for k in self._loops.independent} >= set(given):
            free = ", ".join(names[k] for k in self._loops.independent)
            raise InputError(
                f"independent: found {', '.join(given)}, which do not determine the motion together, expected coordinates such as {free}"
            )
        self._independent, self._closed = self._loops.independent, count > 0
        self._own = IndependentCoordinates(self._tree, self._t, self._loops, chosen.coordinates)
        self._markers: dict[object, PlacedMarker] = {}
        self.coordinates = self._own.names
        self.rates = tuple(chosen.rates[k] for k in self._independent)
        self.q = self._tree.q[self._own.places].copy()
        pose = self._tree
        pose.place(self._t)
        self.v = np.linalg.lstsq(pose.N, job.start.u, rcond=None)[0][self._independent]

    def __repr__(self) -> str:
        return f"<JointSpace of '{self._data.name}': {', '.join(self.coordinates)}>"

    def _unit(self, rate: str) -> float:
        label = rate.rpartition(".")[2]
        return 1.0 if label.startswith(("angle", "w", "omega")) else self._size

    def mass_matrix(self, q: Array) -> np.ndarray:
        """Return the symmetric mass matrix M(q), shape (n, n).

        Parameters
        ----------
        q : array_like, shape (coordinates,)

        Raises
        ------
        InputError
            If q has another shape or is not finite, or if the loops cannot be closed at it.
        SolverError
            At a pose in which the independent coordinates do not determine the motion, such as a dead point.
        """
        self._move_to(q)
        M = self._tree.inertia(self._t)
        if not self._closed:
            return M.copy()
        D = self._loops.map()
        return D.T @ M @ D

    def bias(self, q: Array, v: Array) -> np.ndarray:
        """Return h(q, v): Coriolis, centrifugal and gyroscopic terms, minus gravity and forces of elements, shape (n,).

        Parameters and errors as for `mass_matrix`; v of shape (rates,).
        """
        self._move_to(q)
        return self._dynamics(v)[1]

    def _dynamics(self, v: Array) -> tuple[np.ndarray, np.ndarray, np.ndarray | None]:
        """Return M, h and D at the pose of the tree."""
        tree, D = self._tree, self._take_rates(v)
        tree.forces(self._t)
        if D is None:
            return tree.M.copy(), tree.h.copy(), None
        return D.T @ tree.M @ D, D.T @ (tree.h + tree.M @ self._tree_bias()), D

    def _tree_bias(self) -> np.ndarray:
        """Return the accelerations of the tree's rates where the independent ones are constant."""
        found = np.zeros(len(self._all.rates))
        found[self._loops.dependent] = self._loops.solved(self._tree.gamma)
        return found

    def inverse_dynamics(self, q: Array, v: Array, acceleration: Array) -> np.ndarray:
        """Return the efforts M(q) v' + h(q, v) on the coordinates that give accelerations, N or N m, shape (n,).

        Where joints close loops, these are efforts on the independent coordinates; `actuator_efforts` has those of others.

        Parameters and errors as for `bias`; acceleration of shape (rates,).
        """
        a = self._array("acceleration", acceleration, self.rates)
        self._move_to(q)
        M, h, _ = self._dynamics(v)
        return M @ a + h

    def actuator_efforts(
        self, q: Array, v: Array, acceleration: Array, actuators: Sequence[str] | None = None
    ) -> Efforts:
        """Return the efforts of actuators that give accelerations; of redundant ones those of least norm.

        Parameters
        ----------
        q, v, acceleration : array_like
            As for `inverse_dynamics`.
        actuators : sequence of str, optional
            Drives, or coordinates of joints, also dependent ones. By default the drives of the model.

        Raises
        ------
        InputError, SolverError
            As for `mass_matrix`; and if an actuator is unknown, or if the actuators cannot give the accelerations.
        """
        names = tuple(self._drives) if actuators is None else tuple(named("actuators", actuators))
        a = self._array("acceleration", acceleration, self.rates)
        own = {name.removesuffix("_rate"): k for k, name in enumerate(self._all.rates)}
        places = places_of(names, own, self._drives)
        self._move_to(q)
        M, h, D = self._dynamics(v)
        along = (np.eye(len(a)) if D is None else D)[places]
        return least_efforts(names, along, M @ a + h, float(np.abs(M).max(initial=0.0)), self.rates)

    def forward_dynamics(self, q: Array, v: Array, efforts: Array | None = None) -> np.ndarray:
        """Return the accelerations v' by efforts on the coordinates, by default none, shape (n,).

        Parameters and errors as for `bias`; efforts of shape (rates,), N or N m. Raises SolverError if a motion has no mass.
        """
        tau = np.zeros(len(self.rates)) if efforts is None else self._array("efforts", efforts, self.rates)
        self._move_to(q)
        M, h, _ = self._dynamics(v)
        return solved(M, tau - h, self.rates)

    def pose(self, marker: str | MarkerReference, q: Array) -> MarkerPose:
        """Return position and rotation of a marker (forward kinematics).

        Parameters
        ----------
        marker : str or Marker
            A body, which stands for its axes at the centre of mass (in space at its origin), ``body.marker`` or ``ground.marker``.
        q : array_like, shape (coordinates,)

        Raises
        ------
        InputError, SolverError
            As for `mass_matrix`, and if the marker is unknown.
        """
        placed = self._placed(marker)
        self._move_to(q)
        self._tree.place(self._t)
        motion, _ = self._motion(placed)
        n = self._data.dimensions
        return MarkerPose(motion[:3][:n].copy(), motion[3:12].reshape(3, 3)[:n, :n].copy())

    def jacobian(self, marker: str | MarkerReference, q: Array) -> np.ndarray:
        """Return J with the velocity of a marker, then its angular velocity, as J v, in ground axes.

        Shape (6, n), or (3, n) in the plane: vx, vy, omega. Parameters and errors as for `pose`.
        """
        placed = self._placed(marker)
        self._move_to(q)
        return self._jacobian(placed)

    def _jacobian(self, placed: PlacedMarker) -> np.ndarray:
        """Return the Jacobian of a marker at the pose of the tree."""
        if self._closed:
            self._tree.closure(self._t)
        else:
            self._tree.place(self._t)
        columns = self._motion(placed)[1][self._rows]
        return columns @ self._loops.map() if self._closed else columns.copy()

    def jacobian_bias(self, marker: str | MarkerReference, q: Array, v: Array) -> np.ndarray:
        """Return the acceleration of a marker and its angular acceleration at v' = 0, J' v in ground axes, shape (6,) or (3,).

        Parameters and errors as for `pose`; v of shape (rates,).
        """
        placed = self._placed(marker)
        self._move_to(q)
        if self._take_rates(v) is None:
            self._tree.place(self._t)
            return self._motion(placed)[0][12:][self._rows].copy()
        self._tree.forces(self._t)
        motion, columns = self._motion(placed)
        found: np.ndarray = (motion[12:] + columns @ self._tree_bias())[self._rows]
        return found

    @property
    def _rows(self) -> list[int] | slice:
        """Rows of velocities of a marker."""
        return [0, 1, 5] if self._data.dimensions == 2 else slice(None)

    def inverse_kinematics(
        self,
        marker: str | MarkerReference,
        position: Array | None = None,
        rotation: np.ndarray | None = None,
        q: Array | None = None,
        most_iterations: int = 100,
        tolerance: float = 1e-10,
    ) -> np.ndarray:
        """Return coordinates at which a marker has a pose, near given ones.

        Levenberg and Marquardt's method (Sugihara, IEEE Transactions on Robotics 27, 2011). Where coordinates are redundant,
        each move is the smallest one.

        Parameters
        ----------
        marker : str or Marker
        position : array_like, shape (3,) or (2,), optional
            In ground axes, m.
        rotation : array_like, optional
            Rotation matrix of shape (3, 3), or (2, 2) in the plane. Without it, the orientation is free.
        q : array_like, optional
            Coordinates from which the search begins; by default those of the start.
        most_iterations : int
        tolerance : float
            Largest error of the position relative to the size of the mechanism, and of the orientation, rad.

        Raises
        ------
        InputError
            If an argument is invalid, or if no such coordinates are found.
        """
        if not (isinstance(tolerance, numbers.Real) and tolerance > 0.0):
            raise InputError(f"tolerance: found {tolerance!r}, expected a number greater than 0")
        if not (isinstance(most_iterations, numbers.Integral) and most_iterations > 0):
            raise InputError(f"most_iterations: found {most_iterations!r}, expected a whole number greater than 0")
        wanted = Wanted.of(position, rotation, self._data.dimensions, self._size)
        here = self.q if q is None else self._array("q", q, self.coordinates)
        reach = Reach(
            lambda q: self.pose(marker, q),
            lambda q: self.jacobian(marker, q),
            self.moved,
            self._units[self._independent],
        )
        best, gap = nearest(reach, wanted, here, most_iterations, tolerance)
        if wanted.is_met(gap, tolerance):
            return best
        raise InputError(
            f"inverse_kinematics: no coordinates were found in {most_iterations} iterations; the nearest pose of '{marker}' is "
            f"{wanted.described(gap)} away; expected a reachable pose, or other coordinates to begin with"
        )

    def moved(self, q: Array, move: Array) -> np.ndarray:
        """Return coordinates after a small move, rates times time: sums, and for quaternions a rotation about own axes.

        Parameters and errors as for `bias`; move of shape (rates,), m or rad.
        """
        step = np.zeros(len(self._all.rates))
        step[self._independent] = self._array("move", move, self.rates)
        self._move_to(q)
        if self._closed:
            step = self._loops.map() @ step[self._independent]
        move_tree(self._tree, step)
        if self._closed and not self._loops.close():
            raise InputError("moved: the loops cannot be closed after this move; expected a smaller one")
        return self._tree.q[self._own.places].copy()

    def linearise(
        self,
        q: Array | None = None,
        v: Array | None = None,
        efforts: Array | None = None,
        inputs: Sequence[str] | None = None,
        outputs: Sequence[str] | None = None,
    ) -> Transfer:
        """Linearise the model: x' = A x + B u, y = C x + D u in joint coordinates.

        The state x has the deviations of the coordinates, in the order of `rates`, of these rates, and of the model's states. The deviation
        of a quaternion is a small rotation about the body's own axes.

        Parameters
        ----------
        q, v : array_like, optional
            Coordinates and rates; by default those of the start.
        efforts : array_like, shape (rates,), optional
            Constant efforts on the coordinates, by default none.
        inputs : sequence of str, optional
            Coordinates of joints and rates of bodies, along which an effort is the input, inputs of the model, and forces on bodies as
            for `stiffmbs.transfer`.  By default the inputs of the model that are numbers, or efforts on all coordinates if it has none.
        outputs : sequence of str, optional
            Channels; by default the deviations x without those of states.

        Returns
        -------
        Transfer
            Matrices `a`, `b`, `c`, `d`, and the outputs `at` the state.

        Raises
        ------
        InputError, SolverError
            As for `mass_matrix` and `stiffmbs.transfer`.
        """
        here, moving = self.q if q is None else q, self.v if v is None else v
        tau = np.zeros(len(self.rates)) if efforts is None else self._array("efforts", efforts, self.rates)
        outputs = None if outputs is None else named("outputs", outputs)
        chosen = LinearInputs.of(None if inputs is None else named("inputs", inputs), self._data, self.rates)
        if outputs is not None and (tau.any() or len(chosen.of_scene) < len(chosen.names)):
            kind, bodies = self._job.dynamics.system.of_body, self._job.dynamics.system.bodies
            of_bodies = [f"{body}.{label}" for body in bodies for label in (*kind.positions, *kind.velocities)]
            refuse_reactions(
                outputs, [*self._all.coordinates, *self._all.rates, *of_bodies, *self._job.dynamics.system.states]
            )
        inverse = solved(self.mass_matrix(here), np.eye(len(tau)), self.rates)
        found = joint_equations(
            self._data, self._settings, self.state(here, moving), self.rates, chosen, outputs, inverse
        )
        if tau.any():
            found.a[len(tau) : 2 * len(tau), : len(tau)] -= inverse @ self._inertia_slopes(here, inverse @ tau)
        return found

    def _inertia_slopes(self, q: Array, acceleration: np.ndarray) -> np.ndarray:
        """Return the derivatives of M v' by the coordinates at constant accelerations, by central differences."""
        columns = []
        for k, unit in enumerate(self._units[self._independent]):
            move = np.zeros(len(acceleration))
            move[k] = STEP * unit
            there, back = (self.mass_matrix(self.moved(q, sign * move)) for sign in (1.0, -1.0))
            columns.append((there - back) @ acceleration / (2.0 * move[k]))
        return np.transpose(columns)

    def state(self, q: Array, v: Array) -> SavedState:
        """Return the state of all bodies, for `Simulation.reset`, ``start_from`` of `stiffmbs.run`, and drawings.

        Parameters and errors as for `bias`.
        """
        self._move_to(q)
        if self._take_rates(v) is None:
            self._tree.place(self._t)
        else:
            self._tree.closure(self._t)
        own, u = self._state.q.copy(), self._state.u.copy()
        system = self._job.dynamics.system
        rows = self._job.dynamics.report(np.array([self._t]), own[None], u[None], project=False)
        if not len(rows.t):
            raise SolverError("state: found no accelerations in this pose, expected a pose that is not singular")
        channels = {name: float(values[0]) for name, values in channels_of(self._data, system, rows).items()}
        turns = {name: float(values[0]) for name, values in turns_of(system, rows.q).items()}
        angles = {name: float(self._tree.q[k]) for k, name in enumerate(self._all.joints)}
        return SavedState("joint_space", self._t, channels | angles, turns, exact=np.concatenate([own, u]))

    def _placed(self, marker: str | MarkerReference) -> PlacedMarker:
        key = marker if isinstance(marker, str) else id(marker)
        if key not in self._markers:
            found = placed_marker(self._data, self._tree, marker)
            if not isinstance(marker, str):
                return found
            self._markers[key] = found
        return self._markers[key]

    def _motion(self, placed: PlacedMarker) -> tuple[np.ndarray, np.ndarray]:
        """Return position, rotation and bias of a marker, and its Jacobian by the tree's rates."""
        if placed.body is None:
            return np.concatenate([placed.numbers, np.zeros(6)]), np.zeros((6, len(self._all.rates)))
        return self._tree.marker(placed.body, placed.numbers)

    def _array(self, what: str, values: Array, names: tuple[str, ...]) -> np.ndarray:
        """Return an argument as an array; raise an InputError if it has another shape or is not finite."""
        try:
            found = np.asarray(values, dtype=float)
        except (TypeError, ValueError):
            raise InputError(f"{what}: found {values!r}, expected numbers for {', '.join(names)}") from None
        if found.shape != (len(names),):
            raise InputError(
                f"{what}: found an array of shape {found.shape}, expected ({len(names)},), one number for each of {', '.join(names)}"
            )
        if not math.isfinite(found.sum()) and not np.isfinite(found).all():
            k = int(np.argmin(np.isfinite(found)))
            raise InputError(f"{what}: found {found[k]} for {names[k]}, expected a finite number")
        return found

    def _move_to(self, q: Array) -> None:
        """Take valid coordinates; where joints close loops, follow the motion to them from the start."""
        goal = self._own.normalised(self._array("q", q, self.coordinates))
        self._tree.v[:] = 0.0
        self._own.move_to(goal)

    def _take_rates(self, v: Array) -> np.ndarray | None:
        """Take rates at the pose of the tree; return D where joints close loops."""
        own = self._array("v", v, self.rates)
        if not self._closed:
            self._tree.v[:] = own
            return None
        self._tree.closure(self._t)
        D = self._loops.map()
        self._tree.v[:] = D @ own
        return D
