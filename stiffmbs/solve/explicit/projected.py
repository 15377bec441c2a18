"""The explicit integrator with projection: each step is brought back to the constraints."""

from __future__ import annotations

from ...describe.settings import RunSettings
from ..dynamics import Dynamics
from ..initial import InitialValues
from ..solver import Traits
from ..trajectory import Grid, ProgressCallback, Trajectory
from . import SCHEMES
from .adaptive import AdaptiveRun
from .fixed import euler_cromer, runge_kutta, solve_with_fixed_steps

EULER_CROMER = "euler_cromer"
READ_BY_FIXED_STEPS = ("scheme", "step", "projection")
READ_BY_ADAPTIVE_STEPS = ("scheme", "rtol", "atol", "max_step", "projection")


def _fixed(name: str) -> Traits:
    return Traits(name, READ_BY_FIXED_STEPS, fixed_steps=True, locates_events=False)


def _adaptive(name: str) -> Traits:
    return Traits(name, READ_BY_ADAPTIVE_STEPS)


TRAITS = {
    EULER_CROMER: _fixed(EULER_CROMER),
    **{name: _adaptive(name) if scheme.adaptive else _fixed(name) for name, scheme in SCHEMES.items()},
}
"""Of each scheme."""


def traits(settings: RunSettings) -> Traits:
    """Those of the scheme in the settings; without one `dop853`, and `euler_cromer` where a step is given."""
    return TRAITS[settings.scheme or (EULER_CROMER if "step" in settings.model_fields_set else "dop853")]


def solve(
    dynamics: Dynamics, start: InitialValues, grid: Grid, settings: RunSettings, watch: ProgressCallback
) -> Trajectory:
    """Integrate q' = u, u' = u'(q, u, t) explicitly; the contract is in `stiffmbs.solve.trajectory`.

    After each step positions return by Newton's smallest moves to |C| < 1e-12 and velocities by the smallest
    correction in the mass matrix (Hairer, Wanner, Solving Ordinary Differential Equations II, 1996, ch. VII.2,
    "projection methods").
    """
    dynamics.forget_pivots()
    chosen = traits(settings).name
    if chosen == EULER_CROMER:
        return solve_with_fixed_steps(dynamics, euler_cromer(dynamics, start, settings), grid, settings, watch)
    scheme = SCHEMES[chosen]
    if scheme.adaptive:
        return AdaptiveRun(scheme, dynamics, start, grid, settings, watch).integrate()
    return solve_with_fixed_steps(dynamics, runge_kutta(scheme, dynamics, start, grid, settings), grid, settings, watch)
