"""Ways to solve a problem."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.integrate import solve_ivp

from stiffmbs.analyses.job import prepare
from stiffmbs.model.model_data import ModelData
from stiffmbs.solve.trajectory import Outcome

if TYPE_CHECKING:
    from .by_hand.ida import Equations

Solve = Callable[[], np.ndarray]


class Failed(Exception):
    """A contestant did not come to the end of a problem; the text says why."""


@dataclass(frozen=True)
class Contestant:
    """One way to solve a problem, at any tolerance.

    Attributes
    ----------
    solver : str
        What it is.
    peer : bool
        Whether it is a yardstick beside this package.
    at : callable
        For a tolerance, the function that is timed: it integrates from consistent initial values, everything that
        the integrator needs being made anew, and returns the coordinates of all bodies at all output times, rows of
        (x1 y1 phi1 x2 ...), nan where its steps pass over an output time.  May raise `Failed`.
    setting : str
        What `at` takes.
    settings : tuple of float
        At which it is tried over all decades of error, from loose to tight; tolerances unless given.
    """

    solver: str
    peer: bool
    at: Callable[[float], Solve]
    setting: str = "rtol"
    settings: tuple[float, ...] = ()


def own(scene: ModelData, **settings: Any) -> Callable[[float], Solve]:
    """This package on a scene, with a job for each tolerance: what it sets up in its first run serves the timed ones."""

    def at(rtol: float) -> Solve:
        job = prepare(scene, rtol=rtol, **settings)

        def solve() -> np.ndarray:
            trajectory = job.integrate()
            if trajectory.outcome is not Outcome.DONE:
                raise Failed(trajectory.message)
            return trajectory.q

        return solve

    return at


def bdf(scene: ModelData) -> Contestant:
    """The implicit integrator."""
    return Contestant("bdf", False, own(scene, solver="bdf"))


def bdf_of_all(scene: ModelData) -> Contestant:
    """The implicit integrator on all unknowns, as the yardsticks have them."""
    return Contestant("bdf without presolve", False, own(scene, solver="bdf", presolve=False))


def dop853(scene: ModelData) -> Contestant:
    """The explicit integrator of order 8, with projection."""
    return Contestant("dop853", False, own(scene, solver="projected", scheme="dop853"))


def auto(scene: ModelData) -> Contestant:
    """The package's own choice between the two, made while it solves."""
    return Contestant("auto", False, own(scene, solver="auto"))


def by_hand(equations: Equations, times: np.ndarray) -> Contestant:
    """The yardstick: residual and Jacobian written by hand for this problem, on the same IDA."""

    def at(rtol: float) -> Solve:
        def solve() -> np.ndarray:
            try:
                return equations.integrate(rtol, times)[:, : len(equations.positions)]
            except RuntimeError as error:
                raise Failed(str(error)) from None

        return solve

    return Contestant("yardstick", True, at)


def minimal(
    rates: Callable[..., np.ndarray], start: np.ndarray, places: Callable[[np.ndarray], np.ndarray], times: np.ndarray
) -> Contestant:
    """SciPy's DOP853 on minimal equations derived by hand."""

    def at(rtol: float) -> Solve:
        return lambda: converged(rates, start, places, times, rtol)

    return Contestant("SciPy DOP853, minimal", True, at)


def converged(
    rates: Callable[..., np.ndarray], start: np.ndarray, places: Callable[[np.ndarray], np.ndarray],
    times: np.ndarray, rtol: float = 1e-13,
) -> np.ndarray:  # fmt: skip
    """Coordinates of all bodies from minimal equations and SciPy's DOP853."""
    found = solve_ivp(rates, (times[0], times[-1]), start, method="DOP853", rtol=rtol, atol=rtol, t_eval=times)
    if not found.success:
        raise Failed(found.message)
    return places(found.y.T)
