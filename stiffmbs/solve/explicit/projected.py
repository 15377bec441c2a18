"""The explicit integrator with projection: each step is brought back to the constraints."""

from __future__ import annotations

from ...describe.settings import RunSettings
from ..initial import InitialValues
from ..mechanics import Mechanics
from ..trajectory import Grid, Trajectory, Watch
from . import SCHEMES
from .adaptive import AdaptiveRun
from .fixed import euler_cromer, runge_kutta, solve_with_fixed_steps


def solve(mechanics: Mechanics, start: InitialValues, grid: Grid, settings: RunSettings, watch: Watch) -> Trajectory:
    """Integrate q' = u, u' = u'(q, u, t) explicitly; the contract is in `stiffmbs.solve.trajectory`.

    After each step positions return by Newton's smallest moves to |C| < 1e-12 and velocities by the smallest
    correction in the mass matrix (Hairer, Wanner, Solving Ordinary Differential Equations II, 1996, ch. VII.2,
    "projection methods").
    """
    mechanics.forget_pivots()
    if settings.scheme == "euler_cromer":
        return solve_with_fixed_steps(mechanics, euler_cromer(mechanics, start, settings), grid, settings, watch)
    scheme = SCHEMES[settings.scheme]
    if scheme.adaptive:
        return AdaptiveRun(scheme, mechanics, start, grid, settings, watch).integrate()
    return solve_with_fixed_steps(
        mechanics, runge_kutta(scheme, mechanics, start, grid, settings), grid, settings, watch
    )
