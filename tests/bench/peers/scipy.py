"""SciPy on minimal coordinates, rates compiled by Numba: DOP853, Radau, and LSODA through its Fortran loop."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from ..contestant import Contestant, Failed, Solve
from ..task import Task
from .segments import segments_of

MOST_UNKNOWNS = 60
"""Of Radau, which takes full matrices, and differences for them: on the chain of 100 rods it needs seconds."""
MOST_STEPS = 10**7


def contestants(task: Task) -> Iterator[Contestant]:
    """DOP853 and LSODA; Radau for small systems."""
    yield Contestant("SciPy DOP853", True, lambda rtol: marching(task, explicit, rtol))
    yield Contestant("SciPy LSODA", True, lambda rtol: marching(task, lsoda, rtol))
    if len(task.minimal.start) <= MOST_UNKNOWNS:
        yield Contestant("SciPy Radau", True, lambda rtol: marching(task, radau, rtol))


def marching(task: Task, method: Callable[..., np.ndarray], rtol: float) -> Solve:
    """Coordinates of all bodies; the conversion from minimal ones is timed, it is cheap."""
    return lambda: task.minimal.places(states(task, method, rtol))


def states(task: Task, method: Callable[..., np.ndarray], rtol: float) -> np.ndarray:
    """Rows of minimal coordinates at the output times, by a method from breakpoint to breakpoint."""
    y, rows = task.minimal.start, [task.minimal.start[None]]
    for times, count in segments_of(task.times, task.breakpoints):
        found = method(task, y, times, rtol)
        rows.append(found[1 : count + 1])
        y = found[-1]
    return np.concatenate(rows)


def explicit(task: Task, y: np.ndarray, times: np.ndarray, rtol: float) -> np.ndarray:
    """Dormand and Prince's method of order 8."""
    return _solve_ivp(task, y, times, rtol, method="DOP853")


def radau(task: Task, y: np.ndarray, times: np.ndarray, rtol: float) -> np.ndarray:
    """Radau IIA of order 5, with the Jacobian where there is one."""
    return _solve_ivp(task, y, times, rtol, method="Radau", jac=task.minimal.jacobian)


def _solve_ivp(task: Task, y: np.ndarray, times: np.ndarray, rtol: float, **options: Any) -> np.ndarray:
    from scipy.integrate import solve_ivp

    ends = (times[0], times[-1])
    found = solve_ivp(task.minimal.rates, ends, y, t_eval=times, rtol=rtol, atol=rtol, **options)
    if not found.success:
        raise Failed(found.message)
    return found.y.T


def lsoda(task: Task, y: np.ndarray, times: np.ndarray, rtol: float) -> np.ndarray:
    """Adams or BDF as the method itself chooses; `odeint` loops in Fortran, `solve_ivp` in Python."""
    from scipy.integrate import odeint

    found, report = odeint(
        task.minimal.rates, y, times, Dfun=task.minimal.jacobian, tfirst=True, rtol=rtol, atol=rtol, mxstep=MOST_STEPS,
        tcrit=times[-1:], full_output=True,
    )  # fmt: skip
    if report["message"] != "Integration successful.":
        raise Failed(report["message"])
    return found
