"""Residual of the force balance at rest or in a steady motion, and its derivative by the pose."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..compile.system import System
from ..dynamics.algebraic_states import failure
from ..dynamics.dynamics import Dynamics
from ..dynamics.native.parameters import CONSISTENCY
from ..errors import SolverError
from .found_speeds import FoundSpeeds, found_speeds
from .matrices import Matrix, joined, mass_matrix, matrix_of, product, scaled, solution, term_matrix, zeros
from .parameters import EQUILIBRIA
from .steady_motion import SteadyMotion

PATH = np.polynomial.legendre.leggauss(5)
"""Gauss points and weights along a move, whose rotations are below 0.5 rad."""


@dataclass(frozen=True)
class Balance:
    """Balance of forces at a pose.

    - `left` of shape (n_u + states,): residual of forces, inertia forces and reactions, and the rates of the user's
      own states.
    - `largest`: largest force.
    - `allowed` of shape (n_u + states,): allowed residual.
    - `stiffness`: negative derivative of the residual with respect to pose and states.
    - `jacobian`, `reactions`: J of the independent equations, and the negative derivative of the residual with respect
      to multipliers.
    - `dragged`: derivative of the rates of states with respect to velocities.
    - `motion`: steady motion of the balance.
    - `negligible` of shape (n_u,): forces that count as zero if all forces vanish in equilibrium.
    - `speeds`: speeds of the motion that the forces determine.
    - `at_a_pole`: True if derivatives of forces are so large that rounding exceeds all forces, which stay bounded nearby.
    - `strayed`, `may_stray` of shape (rows of J,): integrals of velocity constraints along the search, and their bounds.
    """

    left: np.ndarray
    lam: np.ndarray
    largest: float
    allowed: np.ndarray
    stiffness: Matrix
    jacobian: Matrix
    reactions: Matrix
    dragged: Matrix
    motion: SteadyMotion
    negligible: np.ndarray | float
    strayed: np.ndarray
    may_stray: np.ndarray
    speeds: FoundSpeeds | None = None
    at_a_pole: bool = False

    @property
    def imbalance(self) -> float:
        """Largest imbalance of forces that are not negligible, relative to the largest force."""
        forces = np.abs(self.left[: self.dragged.shape[1]])
        return float(np.max(np.where(forces > self.negligible, forces, 0.0), initial=0.0) / (self.largest or 1.0))

    @property
    def balanced(self) -> bool:
        """True if the residual is within rounding and the tolerance, and so are the integrals of velocity constraints."""
        return bool(np.all(np.abs(self.left) <= self.allowed) and np.all(np.abs(self.strayed) <= self.may_stray))


def balance_at(dynamics: Dynamics, t: float, motion: SteadyMotion) -> Balance:
    """Return the balance of the current pose, with multipliers that minimize the residual in the mass metric.

    Raises SolverError when the pose has no accelerations.
    """
    state, system = dynamics.state, dynamics.system
    motion.put(dynamics, t)
    state.restart_counters(t)
    status, acceleration = dynamics.accelerate(t)
    if status < 0:
        raise SolverError(f"no equilibrium was found: {failure(dynamics, status, t)}")
    rates = dynamics.position_rates(state.q, state.u)[system.first_state :]
    lam = state.lam[: system.n_c].copy()
    steady = motion.acceleration(dynamics)
    state.evaluate("motion", t)
    largest = max(_largest_force(dynamics), float(np.max(np.abs(system.mass * steady), initial=0.0)))
    stiffness, jacobian = _derivatives(dynamics, t, motion, lam)
    farthest = float(np.max(np.abs(state.q[system.straight[0]]), initial=system.size))
    of_coordinates = EQUILIBRIA.rounding * np.finfo(float).eps * system.per_velocity(farthest, 1.0)
    rounding = abs(stiffness) @ of_coordinates
    roots = np.sqrt(system.mass)  # the balance is a projection in this metric, which does not increase rounding
    unloaded = largest <= np.max(rounding, initial=0.0)  # as stiff bushings in zero gravity: all forces are rounding
    at_a_pole = unloaded and not _grow(dynamics, t, of_coordinates)
    if at_a_pole:  # where rounding excuses no imbalance
        rounding, unloaded = 0.0 * rounding, False
    most_passed_on = np.inf if unloaded else EQUILIBRIA.passed_on * largest
    at_most = roots * np.max(rounding / roots, initial=0.0)
    passed_on = np.minimum(at_most, most_passed_on)
    negligible = system.mass * system.per_velocity(system.size, 1.0) * EQUILIBRIA.slowest**2
    mass = mass_matrix(dynamics)
    left = mass @ _off_the_constraints(dynamics, mass, acceleration - steady, jacobian)
    if np.any(np.abs(left) > passed_on) and np.all(np.abs(left) <= at_most):  # more than a small part of the forces
        passed_on = np.maximum(passed_on, _transmitted(jacobian, rounding, roots))
    found = Balance(
        left,
        lam,
        largest,
        np.maximum.reduce([np.full(len(left), EQUILIBRIA.balanced * largest), rounding, passed_on, negligible]),
        stiffness,
        jacobian,
        jacobian.T,
        zeros(system, 0, len(left)),
        motion,
        negligible,
        np.zeros(jacobian.shape[0]),
        CONSISTENCY.position_tolerance * (abs(jacobian) @ system.per_velocity(farthest, 1.0)),
        at_a_pole=at_a_pole,
    )
    if system.states:
        found = with_states(dynamics, found, rates, motion, t)
    if not motion.n_found:
        return found
    return replace(found, speeds=found_speeds(dynamics, motion, forces_by_velocity(dynamics)))


def _largest_force(dynamics: Dynamics) -> float:
    """Return the largest generalised force, or part of one (set ``motion``)."""
    state = dynamics.state
    parts = state.vector("motion", "f"), state.values["motion"][dynamics.system.term("motion", "f").source]
    return max(float(np.max(np.abs(part), initial=0.0)) for part in parts)


def _grow(dynamics: Dynamics, t: float, rounding: np.ndarray) -> bool:
    """Return True if forces grow as stiff ones do over a move of many roundings; those at a pole of a law do not."""
    state = dynamics.state
    before = _largest_force(dynamics)
    with state.unchanged():
        move = EQUILIBRIA.pole * rounding * np.cos(np.arange(len(rounding)) ** 2)
        state.q[:] = dynamics.system.of_body.moved(state.q, move)
        state.evaluate("motion", t)
        return _largest_force(dynamics) > np.sqrt(EQUILIBRIA.pole) * before


def _transmitted(jacobian: Matrix, rounding: np.ndarray, roots: np.ndarray) -> np.ndarray:
    """Return bounds of the rounding of forces that joints pass on: abs(I - Q Q^T) in the mass metric, Q spanning J^T."""
    rows = jacobian.toarray() if hasattr(jacobian, "toarray") else np.asarray(jacobian)
    held, _ = np.linalg.qr((rows / roots).T)
    bound: np.ndarray = roots * (np.abs(np.eye(len(roots)) - held @ held.T) @ (rounding / roots))
    return bound


def _off_the_constraints(dynamics: Dynamics, mass: Matrix, acceleration: np.ndarray, jacobian: Matrix) -> np.ndarray:
    """Remove accelerations that constraints impose, such as those of a drive that accelerates at the start."""
    asked, n_u = jacobian @ acceleration, len(acceleration)
    if np.all(np.abs(asked) <= EQUILIBRIA.no_effect * (abs(jacobian) @ np.abs(acceleration))):
        return acceleration
    matrix = joined([[mass, jacobian.T], [jacobian, zeros(dynamics.system, *(asked.shape * 2))]])
    found = solution(dynamics, matrix, np.concatenate([mass @ acceleration, 0.0 * asked]), n_u)
    return np.full(n_u, np.nan) if found is None else found[:n_u]


def with_states(dynamics: Dynamics, known: Balance, rates: np.ndarray, motion: SteadyMotion, t: float) -> Balance:
    """Add the rows and columns of user-defined states to a balance."""
    system, q = dynamics.system, dynamics.state.q
    own, active = slice(system.first_state, None), np.flatnonzero(system.active)
    by_velocity = _position_rates(dynamics)
    of_rates, of_states = (
        term_matrix(dynamics, "rate_q")[own],
        (term_matrix(dynamics, "f_q") - term_matrix(dynamics, "G_lam"))[:, own],
    )
    by_pose, of_velocities = -product(of_rates, by_velocity), term_matrix(dynamics, "rate_u")[own]
    if motion.changes_with_pose(system):
        velocity, _ = motion.derivatives(dynamics, t, by_velocity)
        by_pose = by_pose - product(of_velocities, velocity)
    stiffness = [[known.stiffness, -of_states], [by_pose, -of_rates[:, own]]]
    by_states = term_matrix(dynamics, "C_x")[active][:, own]
    reactions = [[known.reactions], [-term_matrix(dynamics, "rate_lam")[own][:, active]]]
    sizes = system.per_coordinate(system.size, 1.0)
    sizes[own] = system.state_scales
    allowed = EQUILIBRIA.balanced * (abs(of_rates) @ np.maximum(sizes, np.abs(q)) + EQUILIBRIA.slow_state * sizes[own])
    rounding = EQUILIBRIA.rounding * np.finfo(float).eps * (abs(of_states) @ np.maximum(sizes, np.abs(q))[own])
    return replace(
        known,
        left=np.append(known.left, rates),
        allowed=np.append(np.maximum(known.allowed, rounding), allowed),
        stiffness=joined(stiffness),
        jacobian=joined([[known.jacobian, by_states]]),
        reactions=joined(reactions),
        dragged=scaled(np.where(system.algebraic, 0.0, 1.0), of_velocities),
        negligible=0.0,
    )


def forces_by_velocity(dynamics: Dynamics) -> Matrix:
    """Return derivatives of forces and rates of states (set ``tangent``) by velocities, shape (n_u + states, n_u)."""
    of_rates = term_matrix(dynamics, "rate_u")[slice(dynamics.system.first_state, None)]
    return joined([[term_matrix(dynamics, "f_u")], [of_rates]])


def _position_rates(dynamics: Dynamics) -> Matrix:
    """Return Z of q' = Z u for all coordinates."""
    system = dynamics.system
    q, u = system.straight
    return term_matrix(dynamics, "Z") + matrix_of(system, np.ones(len(q)), q, u, (system.n_q, system.n_u))


def displacement(system: System, start: np.ndarray, there: np.ndarray) -> np.ndarray:
    """Return the displacement between two poses, followed by the changes of states."""
    return np.append(system.move(start, there), (there - start)[system.first_state :])


def moved(system: System, q: np.ndarray, move: np.ndarray) -> np.ndarray:
    """Return the pose and states after a displacement."""
    there = system.of_body.moved(q, move[: system.n_u])
    there[system.first_state :] += move[system.n_u :]
    return there


def strayed(dynamics: Dynamics, t: float, start: np.ndarray) -> np.ndarray:
    """Return the integrals of velocity constraints from a pose to the current one, zero for equations with a position form.

    The integral of a drive's equation is the change of its coordinate, which the drive prevents at rest. Assembly after a
    move closes position equations alone.
    """
    system, state = dynamics.system, dynamics.state
    rows, term = np.flatnonzero(system.active), system.term("motion", "J")
    if system.holonomic[rows].all():
        return np.zeros(len(rows))
    end, total = state.q.copy(), np.zeros(system.n_c)
    move = system.move(start, end)
    for place, weight in zip(*PATH, strict=True):
        state.q[:] = system.of_body.moved(start, 0.5 * (1.0 + place) * move)
        state.evaluate("motion", t)
        with np.errstate(invalid="ignore"):  # where an equation has no finite value, no equilibrium is found
            slopes = state.values["motion"][term.source] * move[term.column]
        total += 0.5 * weight * np.bincount(term.row, slopes, system.n_c)
    state.q[:] = end
    return np.where(system.holonomic, 0.0, total)[rows]


def _derivatives(dynamics: Dynamics, t: float, motion: SteadyMotion, lam: np.ndarray) -> tuple[Matrix, Matrix]:
    """Return the stiffness -f_q + d(J^T lam)/dq with velocity and inertia terms, and J of the independent equations."""
    system, state = dynamics.system, dynamics.state
    state.lam[: system.n_c] = lam
    state.evaluate("tangent", t)
    rates = _position_rates(dynamics)
    stiffness = product(term_matrix(dynamics, "G_lam") - term_matrix(dynamics, "f_q"), rates)
    if motion.changes_with_pose(system):
        velocity, acceleration = motion.derivatives(dynamics, t, rates)
        stiffness = stiffness - product(term_matrix(dynamics, "f_u"), velocity) + scaled(system.mass, acceleration)
    return stiffness, term_matrix(dynamics, "J")[np.flatnonzero(system.active)]
