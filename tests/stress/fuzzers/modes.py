"""Compare random state matrices and modes with differences of accelerations, and with small motions near equilibria."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
from scipy.linalg import expm

from stiffmbs.analyses.equilibrium import equilibrium
from stiffmbs.analyses.job import Runnable, prepare
from stiffmbs.analyses.linearised.at_state import AtState
from stiffmbs.analyses.linearised.modes import Modes, modes
from stiffmbs.errors import SolverError, StiffmbsError
from stiffmbs.linear_analysis.state_space import StateMatrix
from stiffmbs.linear_analysis.tangent_space import Linearised, linearised
from stiffmbs.model.read_scene import read_scene
from stiffmbs.results.solution import Solution
from stiffmbs.solve.trajectory import Outcome as Ending

from ..case import Outcome, Verdict, measured
from ..random_scenes.features import SMOOTH
from ..random_scenes.scene import random_scene
from ..random_statics import random_statics

WHAT = "State matrices and modes of random scenes, in motion and in equilibrium, against differences and small motions."
STEPS = 1e-4, 3e-3
"""Variations of a state, relative to the size of the mechanism, or rad: the first, and one for accelerations that rounding governs."""
ALLOWED = 1e-5
"""Allowed error of a rate relative to the largest one."""
DIRECTIONS = 2
SMALL, DURATION, RTOL = 3e-6, 0.2, 1e-11
"""Displacement (relative to the size of the mechanism, or rad), duration (s) and tolerance of small motions."""
OFF = 3e-2
"""Allowed error of a small motion relative to its size."""


def trial(seed: int) -> Verdict:
    """Test one random scene: two of three in motion, otherwise a mechanism with an equilibrium."""
    rng = np.random.default_rng(seed)
    try:
        if seed % 3 == 2:
            return _beside_equilibrium(rng, random_statics(rng, in_space=bool(rng.random() < 0.5)))
        found = modes(read_scene(json.dumps(random_scene(rng, features=SMOOTH))))
    except StiffmbsError as refusal:
        return Verdict(Outcome.TOLD, detail=str(refusal))
    wrong = _listed_wrongly(found)
    if wrong:
        return Verdict(Outcome.WRONG, detail=wrong)
    about = found.about
    linear = linearised(about.dynamics, about.t, about.acceleration)
    ways = [rng.standard_normal(len(found.state.matrix)) for _ in range(DIRECTIONS)]
    error = max(min(_difference(about, linear, found.state, way.copy(), step) for step in STEPS) for way in ways)
    return measured(error, ALLOWED, f"{len(found.state.matrix)} variations; {'; '.join(found.notes)}"[:300])


def _listed_wrongly(found: Modes) -> str:
    """Describe the fault of a list of modes: its power sums must be the traces of the state matrix, with no mode missing."""
    values = np.array([value for mode in found.modes for value in mode.eigenvalues])
    matrix = found.state.matrix
    largest = max(1.0, float(np.abs(values).max(initial=0.0)))
    for power in (1, 2):
        trace = np.trace(np.linalg.matrix_power(matrix, power))
        if abs(np.sum(values**power) - trace) > ALLOWED * largest**power * max(1, len(matrix)):
            return f"the sum of eigenvalues to the power of {power} is {np.sum(values**power)}, the trace {trace}"
    if len(values) < 2 * found.degrees_of_freedom and not found.state.n_states:
        return f"{len(values)} eigenvalues of {found.degrees_of_freedom} degrees of freedom"
    return ""


def _difference(about: AtState, linear: Linearised, chosen: StateMatrix, z: np.ndarray, step: float) -> float:
    """Compare the matrix with extrapolated differences of accelerations and rates of states."""
    system = about.dynamics.system
    scale = np.concatenate([system.per_velocity(system.size, 1.0), system.state_scales])
    z[: chosen.n_poses] /= max(1.0, float(np.linalg.norm(z[: chosen.n_poses])))
    wide, narrow = (_slope(about, linear, chosen, z, size) for size in (step, step / 2))
    rates = (4 * narrow - wide) / 3
    own = linear.algebraic.among_all((chosen.matrix @ z)[len(z) - chosen.n_states :, None])[:, 0]
    predicted = np.append(linear.own_axes @ ((chosen.accelerations - linear.spin @ chosen.velocities) @ z), own)
    differs = np.append(np.ones(system.n_u, dtype=bool), ~system.algebraic)
    off = np.abs(rates - predicted)[differs] / scale[differs]
    return float(np.max(off, initial=0.0) / max(1.0, float(np.max(np.abs(predicted / scale), initial=0.0))))


def _slope(about: AtState, linear: Linearised, chosen: StateMatrix, z: np.ndarray, step: float) -> np.ndarray:
    """Return the central difference of accelerations and rates of states along a variation."""
    rates = []
    for size in (-step, step):
        with about.dynamics.state.unchanged():
            _vary(about, linear, chosen, size * z)
            status, acceleration = about.dynamics.accelerate(about.t)
            if status < 0:
                raise ValueError(f"no accelerations at a variation of {size:g}")
            state, first = about.dynamics.state, about.dynamics.system.first_state
            rates.append(np.append(acceleration, about.dynamics.position_rates(state.q, state.u)[first:]))
    return np.asarray((rates[1] - rates[0]) / (2 * step))


def _vary(about: AtState, linear: Linearised, chosen: StateMatrix, z: np.ndarray) -> None:
    """Apply a variation to the state of a system, and project it onto the constraints."""
    dynamics, state = about.dynamics, about.dynamics.state
    own = linear.algebraic.among_all(z[len(z) - chosen.n_states :, None])[:, 0]
    state.q[:] = dynamics.system.of_body.moved(state.q, linear.own_axes @ (chosen.poses @ z))
    state.q[dynamics.system.first_state :] += own
    state.u[:] += linear.own_axes @ (chosen.velocities @ z)
    dynamics.assemble(about.t)
    dynamics.correct_velocities(about.t)


def _beside_equilibrium(rng: np.random.Generator, scene: Runnable) -> Verdict:
    """Compare the difference of two small motions from an equilibrium with the exponential of the state matrix."""
    rest = equilibrium(scene).solution
    found = modes(scene, start_from=rest)
    wrong = _listed_wrongly(found)
    if wrong:
        return Verdict(Outcome.WRONG, detail=wrong)
    about, chosen = found.about, found.state
    linear = linearised(about.dynamics, about.t, about.acceleration)
    z = rng.standard_normal(len(chosen.matrix))
    rates = max(1.0, float(np.abs(np.linalg.eigvals(chosen.matrix)).max(initial=0.0)))
    z *= SMALL / max(float(np.linalg.norm(z)), 1.0)
    z[: chosen.n_poses] /= rates if rates > 100 else 1.0
    ends = [_end(scene, rest, found, linear, sign * z) for sign in (-1.0, 1.0)]
    system = about.dynamics.system
    moved = linear.own_axes.T @ system.move(*ends) / 2
    scale = system.per_velocity(system.size, 1.0)
    expected = chosen.poses @ (expm(chosen.matrix * DURATION) @ z)
    size = float(max(np.abs(part / scale).max() for part in (expected, chosen.poses @ z)))
    return measured(float(np.abs((moved - expected) / scale).max()) / (size or 1.0), OFF, f"{len(z)} variations")


def _end(scene: Runnable, rest: Solution, found: Modes, linear: Linearised, z: np.ndarray) -> np.ndarray:
    """Run from a varied state and return the state at the end."""
    job = prepare(scene, None, rest, duration=DURATION, points=2, rtol=RTOL, presolve=False)
    about = replace(found.about, dynamics=job.dynamics)
    state = job.dynamics.state
    state.q[:], state.u[:] = job.start.q, job.start.u
    _vary(about, linear, found.state, z)
    _, acceleration = job.dynamics.accelerate(about.t)
    lam = state.lam[: job.dynamics.system.n_c].copy()
    start = replace(job.start, q=state.q.copy(), u=state.u.copy(), acceleration=acceleration, lam=lam)
    trajectory = replace(job, start=start).integrate()
    if trajectory.outcome is not Ending.DONE:
        raise SolverError(trajectory.message)
    return np.asarray(trajectory.q[-1])
