"""The element that most likely caused a run to stop."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from ..compile.state import LEFT_OPEN
from ..compile.system import System
from ..compile.written_values import writer
from ..dynamics.dynamics import Dynamics
from ..dynamics.friction_loads import REMEDY, ambiguous_loads_clause
from .events.native.parameters import EPSILON, SEARCH

TERM_SETS = ("motion", "acceleration")


def suspect(dynamics: Dynamics, t: float, q: np.ndarray, u: np.ndarray) -> str:
    """Return a clause on the element that probably caused a run to stop, or an empty string.

    It is an element with an undefined value at or just after a state. Otherwise it is an open joint, joints whose loads by
    friction have several solutions, or the element with the largest acceleration of a body. `t`: s. `q`, `u`: last state that was reached.
    """
    for ahead in _ahead():
        later = ahead * max(1.0, abs(t))
        dynamics.state.q[:], dynamics.state.u[:] = dynamics.system.of_body.moved(q, later * u), u
        for term_set in TERM_SETS:
            dynamics.state.evaluate(term_set, t + later)
            name = _undefined(dynamics.system, dynamics.state.values[term_set], term_set)
            if name:
                return f"; '{name}' has no finite value {'after' if ahead else 'at'} that time"
    dynamics.state.q[:], dynamics.state.u[:] = q, u
    if clause := _open(dynamics, t):
        return clause
    loads = ambiguous_loads_clause(dynamics, t, q, u)
    return f"; {loads}; {REMEDY}" if loads else _hardest(dynamics, t)


def _ahead() -> Iterator[float]:
    """Yield times after a state, relative to the time: zero, then growing from its rounding to half of its digits."""
    yield 0.0
    ahead = EPSILON
    while ahead < math.sqrt(EPSILON):
        yield ahead
        ahead *= SEARCH.longer


def _undefined(system: System, values: np.ndarray, term_set: str) -> str:
    """Return the first element that wrote a value that is not finite."""
    wrong = np.flatnonzero(~np.isfinite(values[: system.n_values(term_set)]))
    return writer(system, term_set, int(wrong[0])) if len(wrong) else ""


def _open(dynamics: Dynamics, t: float) -> str:
    """Return the joint with the largest violation if it exceeds an error of integration."""
    gap, joint, equation = most_violated(dynamics, t, dynamics.system.active)
    return "" if gap < LEFT_OPEN else f"; joint '{joint}' (equation {equation}) is violated by {gap:.3g}"


def most_violated(dynamics: Dynamics, t: float, among: np.ndarray) -> tuple[float, str, str]:
    """Return the largest violation of constraints of positions at the current state, with joint and equation.

    `among`: mask of the equations. The violation is 0 without equations.
    """
    dynamics.state.evaluate("motion", t)
    gaps = np.abs(dynamics.state.vector("motion", "C")) * among
    row = int(np.argmax(gaps)) if len(gaps) else 0
    return (float(gaps[row]), *dynamics.system.equations[row]) if len(gaps) else (0.0, "", "")


def _hardest(dynamics: Dynamics, t: float) -> str:
    if dynamics.accelerate(t)[0] < 0:
        return ""
    largest, name, k = max(_pulls(dynamics, t), default=(0.0, "", 0))
    if not largest > 0.0:
        return ""
    return (
        f"; '{name}' causes the largest acceleration there ({acceleration_name(dynamics.system, k)} by {largest:.3g})"
    )


def acceleration_name(system: System, k: int) -> str:
    """Return the name of a velocity's rate; in space, angular rates about principal axes have no channel."""
    of_body = system.of_body
    if of_body.dimensions == 3 and k % of_body.n_u >= of_body.linear:
        return f"the angular acceleration of {system.bodies[k // of_body.n_u]}"
    return system.name_of(k, of_body.accelerations)


def _pulls(dynamics: Dynamics, t: float) -> Iterator[tuple[float, str, int]]:
    """Yield the largest acceleration by a force, and by a joint, with the element and the velocity that it changes."""
    system, state = dynamics.system, dynamics.state
    state.evaluate("motion", t)
    values, lam = state.values["motion"], state.lam
    force, jacobian = system.term("motion", "f"), system.term("motion", "J")
    of_forces = np.abs(values[force.source] / system.mass[force.row])
    of_joints = np.abs(values[jacobian.source] * lam[jacobian.row] / system.mass[jacobian.column])
    if len(of_forces):
        k = int(np.argmax(of_forces))
        yield float(of_forces[k]), writer(system, "motion", int(force.source[k])), int(force.row[k])
    if len(of_joints):
        k = int(np.argmax(of_joints))
        yield float(of_joints[k]), system.equations[jacobian.row[k]][0], int(jacobian.column[k])
