"""Equilibria in steady motion, as of a car at constant speed on a straight road or on a circle."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from ..compile.system import System
from ..dynamics.dynamics import Dynamics
from ..dynamics.initial import InitialValues
from ..equilibria.equilibrium import Equilibrium, find_equilibrium, nearest_equilibrium
from ..equilibria.force_balance import balance_at, forces_by_velocity
from ..equilibria.found_speeds import with_found_spins
from ..equilibria.matrices import Matrix, dense
from ..equilibria.parameters import EQUILIBRIA
from ..equilibria.steady_motion import SteadyMotion
from ..errors import InputError, SolverError
from ..model.model_data import ModelData
from ..model.settings import SteadyMotion as Described
from ..notes import Note, NoteKind, Severity
from ..reading.did_you_mean import instead_of
from .far_away import beyond_its_size, far_away

if TYPE_CHECKING:
    from .settled import Settled

MOTION_AHEAD = 1e-3
"""Distance along a motion, rad or parts of the mechanism's size, after which the balance of forces is checked."""
STEADY_IMBALANCE, VELOCITY_ERROR = 1e-6, 1e-8
"""Accepted relative imbalance there, and accepted velocity error of joints relative to the largest velocity."""


UNCHECKED_START = NoteKind(
    "steady-motion-not-checked",
    "the stability of the steady motion at the start was not checked",
    severity=Severity.REMARK,
)
UNCHECKED = NoteKind("steady-stability-not-checked", "the stability of the steady motion was not checked: {reason}")
UNSTABLE = NoteKind("unstable-steady-motion", "the steady motion is unstable: disturbances grow at {rate:.3g} 1/s")
STABLE = NoteKind("stable-steady-motion", "the steady motion is stable: no disturbance grows", severity=Severity.REMARK)
TURNS = NoteKind(
    "steady-motion-turns",
    "the forces do not balance on a straight line: the steady motion turns at {rate:.3g} rad/s",
    severity=Severity.REMARK,
)
OTHER_SPEED = NoteKind(
    "steady-speed",
    "the forces determine a steady motion of {speed:.3g} m/s; the velocity of start is {given:.3g} m/s",
    "correct the forces, such as traction and drag, begin with a velocity nearer to the motion, or use speed: given",
)
ROTATION_LEFT_OUT = NoteKind(
    "rotation-left-out",
    "the run starts in the equilibrium at rest, without the centrifugal forces of its rotation",
    "for the equilibrium in rotation write start: {{rotation: {rotation}, about: {about}}}",
)


def settled_in_motion(
    model: ModelData, dynamics: Dynamics, start: InitialValues, t: float, described: Described
) -> Settled:
    """Find an equilibrium in steady motion and assess its stability.

    The search begins at the pose of `start`, with its spins of bodies that neither rolling constraints nor forces
    determine. Raises InputError if the motion has another number of dimensions, or a body cannot spin. Raises
    SolverError if none is found, a joint prevents the motion, or the forces do not stay in balance.
    """
    from .settled import Settled  # a run that starts in the motion does not load linear analyses

    found = _found(model, dynamics, start, t, described)
    values = _eigenvalues(dynamics, t, found)
    notes = (
        _stability(values, dynamics.system.n_u),
        *beyond_its_size(dynamics, start, found),
        *_speed(described, found.motion),
    )
    eigenvalues = () if values is None else tuple(values.tolist())
    return Settled(_moving(start, found, notes), found.moves, found.imbalance, (), notes, eigenvalues)


def start_in_motion(
    model: ModelData, dynamics: Dynamics, start: InitialValues, t: float, described: Described
) -> InitialValues:
    """Return initial values in steady motion, unchecked for stability; arguments as for `settled_in_motion`."""
    found = _found(model, dynamics, start, t, described)
    notes = (UNCHECKED_START(), *far_away(dynamics, start, found), *_speed(described, found.motion))
    return _moving(start, found, notes)


def rotation_left_out(model: ModelData, dynamics: Dynamics, start: InitialValues) -> tuple[Note, ...]:
    """Return a note if the described velocities are a rotation of all bodies as one, whose forces deform the mechanism."""
    with dynamics.state.unchanged():
        dynamics.state.q[:] = start.q
        found = rotation_as_one(model, dynamics, start.u)
    return () if found is None else (ROTATION_LEFT_OUT(rotation=found[0], about=found[1]),)


def rotation_as_one(
    model: ModelData, dynamics: Dynamics, u: np.ndarray
) -> tuple[list[float] | float, list[float]] | None:
    """Return angular velocity, rad/s, and axis point, m, if velocities are a rotation of all bodies about the vertical.

    `dynamics`: at the pose. `u` of shape (n_u,). Without gravity the axis has any direction. None for a single body.
    """
    system = dynamics.system
    d, gravity = system.of_body.dimensions, np.array(model.gravity)
    still = SteadyMotion(np.zeros(d), np.zeros(2 * d - 3), np.zeros(d))
    units = np.eye(3 * d - 3)
    carried = [replace(still, velocity=unit[:d], rotation=unit[d:]).carried(dynamics) for unit in units]
    motion, *_ = np.linalg.lstsq(np.array(carried).T, u, rcond=None)
    velocity, rotation = np.append(motion[:d], np.zeros(3 - d)), np.append(np.zeros(6 - 2 * d), motion[d:])
    rate = float(np.linalg.norm(rotation))
    tilt = np.linalg.norm(np.cross(rotation, np.append(gravity, np.zeros(3 - d))))  # m/s^2 times the rate
    misfit = np.abs(np.append(np.array(carried).T @ motion - u, velocity @ rotation / max(rate, 1e-300)))
    turns = rate > 0.0 and tilt <= VELOCITY_ERROR * rate * np.linalg.norm(gravity)
    if len(system.bodies) < 2 or not turns or np.any(misfit > VELOCITY_ERROR * np.max(np.abs(u))):
        return None
    turn = _rounded(rotation, rate)
    return turn[2] if d == 2 else turn, _rounded(np.cross(rotation, velocity) / rate**2, system.size)[:d]


def _rounded(vector: np.ndarray, size: float) -> list[float]:
    return [float(f"{x:.6g}") if abs(x) > VELOCITY_ERROR * size else 0.0 for x in vector]


def _found(model: ModelData, dynamics: Dynamics, start: InitialValues, t: float, described: Described) -> Equilibrium:
    if dynamics.system.has_coupled_inertia:
        raise InputError(
            "bodies: found a flexible body, expected rigid ones: steady motions do not include flexible bodies"
        )
    motion = _motion(model, dynamics, start, described)
    dynamics.state.q[:] = start.q
    missing = ""
    if len(motion.spinning):
        known = balance_at(dynamics, t, motion)
        by_velocity = forces_by_velocity(dynamics)
        motion = with_found_spins(dynamics, motion, by_velocity)
        missing = _left_out(dynamics, known.stiffness, by_velocity, motion.spinning)
    turning = replace(motion, upright=_rotation(model, 1.0))
    searches = [partial(find_equilibrium, motion=motion), partial(nearest_equilibrium, motion=motion)]
    if described.rotation == "found":
        searches = [partial(find_equilibrium, motion=turning)]
    elif np.any(motion.velocity) and "rotation" not in described.model_fields_set:
        few = EQUILIBRIA.most_straight_moves
        searches = [
            partial(find_equilibrium, motion=motion, most=few),
            partial(find_equilibrium, motion=turning),
            *searches,
        ]
    if missing:
        try:
            found = _first_found(dynamics, t, start, searches[:1])
        except SolverError as error:
            raise SolverError(f"{error}; {missing}") from None
    else:
        found = _first_found(dynamics, t, start, searches)
    _refuse_joints(dynamics, t)
    _refuse_unsteady(dynamics, t, found.motion)
    return found


def _left_out(dynamics: Dynamics, stiffness: Matrix, by_velocity: Matrix, spinning: np.ndarray) -> str:
    """Return a sentence if a free spin that is not in `rolling` acts on one that is, as that of a shaft on a wheel.

    `stiffness`, `by_velocity` with n_u + states rows: derivatives of the forces and of the rates of states by
    displacements and by velocities.
    """
    system, state = dynamics.system, dynamics.state
    effects, stiff = dense(abs(by_velocity)), dense(abs(stiffness))
    acts = effects > EQUILIBRIA.no_effect * effects.max(axis=0, initial=0.0)
    held = np.abs(state.matrix("motion", "J")).max(axis=0, initial=0.0) > EQUILIBRIA.no_effect
    rests = stiff > EQUILIBRIA.no_effect * np.max(stiff, initial=0.0)
    for body in system.bodies:
        k = _axis(system, body)
        if k is None or k in spinning or held[k] or np.delete(rests[: system.n_u, k], [k, *spinning]).any():
            continue
        rates = acts[system.n_u :]
        together = acts[k, spinning] | acts[spinning, k] | rates[rates[:, k]][:, spinning].any(axis=0)
        if together.any():
            wheels = system.names_of(spinning[together], system.of_body.velocities)
            return f"'{body}' spins freely and acts on the spin of {wheels[0].rpartition('.')[0]}, expected it in rolling too"
    return ""


def _first_found(
    dynamics: Dynamics, t: float, start: InitialValues, searches: Sequence[Callable[[Dynamics, float], Equilibrium]]
) -> Equilibrium:
    """Return the result of the first search from the start that succeeds; raise the error of the last one if none does."""
    for search in searches[:-1]:
        dynamics.state.q[:] = start.q
        with suppress(SolverError):
            return search(dynamics, t)
    dynamics.state.q[:] = start.q
    return searches[-1](dynamics, t)


def _speed(described: Described, found: SteadyMotion) -> tuple[Note, ...]:
    """Return a note if the forces determine a speed that is far from that of the description, from which the search begins."""
    speed, given = (float(np.linalg.norm(velocity)) for velocity in (found.velocity, described.velocity))
    differs = described.speed == "found" and abs(speed - given) > EQUILIBRIA.other_speed * given
    return (OTHER_SPEED(speed=speed, given=given),) if differs else ()


def _moving(start: InitialValues, found: Equilibrium, notes: tuple[str, ...]) -> InitialValues:
    motion = found.motion
    if motion.upright is not None:
        rate = float(motion.rotation @ motion.upright)
        notes = (*notes, TURNS(rate=rate))
    notes = (*start.far_notes(), *notes)
    return replace(start, q=found.q, u=found.u, acceleration=found.acceleration, lam=found.lam, moved=(), notes=notes)


def _eigenvalues(dynamics: Dynamics, t: float, found: Equilibrium) -> np.ndarray | None:
    """Return the eigenvalues of perturbations of the steady motion, or None if they cannot be computed."""
    from ..linear_analysis.stability import eigenvalues_about
    from .settled import MOST_FOR_EIGENVALUES

    if dynamics.system.n_u > MOST_FOR_EIGENVALUES:
        return None
    state = dynamics.state
    state.q[:], state.u[:] = found.q, found.u
    dynamics.accelerate(t)
    return eigenvalues_about(dynamics, t, found.motion, found.acceleration)


def _stability(values: np.ndarray | None, n_u: int) -> Note:
    from .settled import GROWING, MOST_FOR_EIGENVALUES

    if values is None:
        reason = f"it has {n_u} velocities" if n_u > MOST_FOR_EIGENVALUES else "its equations change along the motion"
        return UNCHECKED(reason=reason)
    fastest = float(np.max(values.real, initial=0.0))
    if fastest > GROWING * np.max(np.abs(values), initial=0.0):
        return UNSTABLE(rate=fastest)
    return STABLE()


def _motion(model: ModelData, dynamics: Dynamics, start: InitialValues, described: Described) -> SteadyMotion:
    system, state = dynamics.system, dynamics.state
    velocity, about = (_vector(system, name, getattr(described, name)) for name in ("velocity", "about"))
    if described.rotation == "found" and not np.any(velocity):
        raise InputError(
            "rotation: found no velocity, expected one: forces determine a rotation of bodies that move ahead"
        )
    rotation = _rotation(model, 0.0 if described.rotation == "found" else described.rotation)
    spinning = np.array([_spin(system, name) for name in described.rolling], dtype=int)
    found = described.speed == "found" and bool(np.any(velocity))
    motion = SteadyMotion(velocity, rotation, about, spinning, np.zeros(len(spinning)), found)
    state.q[:] = start.q
    spins = start.u[spinning] - motion.carried(dynamics)[spinning]
    return replace(motion, spins=spins)


def _vector(system: System, name: str, found: tuple[float, ...]) -> np.ndarray:
    dimensions = system.of_body.dimensions
    if found and len(found) != dimensions:
        raise InputError(f"{name}: found {len(found)} numbers, expected {dimensions}")
    return np.array(found or [0.0] * dimensions)


def _rotation(model: ModelData, found: float | tuple[float, ...]) -> np.ndarray:
    """Return W; in space a single number is about the direction against gravity, or about z without gravity."""
    if model.dimensions == 2:
        if isinstance(found, tuple):
            raise InputError("rotation: found 3 numbers, expected one in the plane")
        return np.array([found])
    if isinstance(found, tuple):
        return np.array(found)
    gravity = np.array(model.gravity)
    size = np.linalg.norm(gravity)
    return found * (-gravity / size if size else np.array([0.0, 0.0, 1.0]))


def _spin(system: System, body: str) -> int:
    """Return the index of a body's angular velocity about its axis of symmetry."""
    if body not in system.bodies:
        raise InputError(f"rolling: found no body '{body}'{instead_of(body, system.bodies)}")
    axis = _axis(system, body)
    if axis is None:
        raise InputError(
            f"rolling: found three different moments of inertia of body '{body}', expected an axisymmetric body"
        )
    return axis


def _axis(system: System, body: str) -> int | None:
    """Return the index of a body's angular velocity about its axis of symmetry, or None."""
    n_u, linear = system.of_body.n_u, system.of_body.linear
    first = n_u * system.bodies.index(body) + linear
    if linear == 2:
        return first
    moments = system.mass[first : first + 3]
    for k in range(3):
        one, other = np.delete(moments, k)
        if np.isclose(one, other, rtol=1e-9, atol=0):
            return first + k
    return None


def _refuse_joints(dynamics: Dynamics, t: float) -> None:
    state, system = dynamics.state, dynamics.system
    state.evaluate("motion", t)
    missed = np.abs(state.vector("motion", "V"))
    worst = int(np.argmax(missed)) if len(missed) else 0
    if len(missed) and missed[worst] > VELOCITY_ERROR * max(1.0, np.max(np.abs(state.u), initial=0.0)):
        joint, equation = system.equations[worst]
        raise SolverError(
            f"joint '{joint}' (equation {equation}) does not allow this motion: found a velocity of {missed[worst]:.3g} "
            "across it, expected zero"
        )


def _refuse_unsteady(dynamics: Dynamics, t: float, motion: SteadyMotion) -> None:
    """Raise an error if the forces no longer balance a little later in the motion."""
    state, system = dynamics.state, dynamics.system
    rates = np.abs(motion.carried(dynamics)) * system.per_velocity(1 / system.size, 1.0)
    if not np.max(rates, initial=0.0):
        return
    later = MOTION_AHEAD / float(np.max(rates))
    with state.unchanged():
        start = state.q.copy()
        move = late = later * motion.carried(dynamics)
        # Runge-Kutta's method of fourth order: the error of the midpoint rule would strain stiff beams
        for share, weight in ((1 / 2, 2), (1 / 2, 2), (1, 1)):
            state.q[:] = system.of_body.moved(start, share * late)
            late = later * motion.carried(dynamics)
            move = move + weight * late
        state.q[:] = system.of_body.moved(start, move / 6)
        dynamics.assemble(t + later)
        known = balance_at(dynamics, t + later, motion)
        allowed = np.maximum(known.allowed, STEADY_IMBALANCE * known.largest)[: system.n_u]  # rounding of stiff bodies
        excess = np.abs(known.left[: system.n_u]) - allowed
        worst = int(np.argmax(excess))
        if excess[worst] > 0.0:
            raise SolverError(
                f"the motion is not steady: forces balance at t = {t:g} s, but {later:.3g} s later "
                f"{system.name_of(worst, system.of_body.reactions)} has an imbalance of {known.left[worst]:.3g}; expected forces that "
                "move with the bodies, and a rotation about the direction of gravity"
            )
