"""Explicit integrator with projection onto the constraints after each step."""

from __future__ import annotations

from ...dynamics.dynamics import Dynamics
from ...dynamics.initial import InitialValues
from ...model.settings import RunSettings
from ..solver import Traits
from ..trajectory import Grid, ProgressCallback, Trajectory
from . import SCHEMES
from .adaptive import AdaptiveRun
from .fixed import euler_cromer, runge_kutta, solve_with_fixed_steps

EULER_CROMER = "euler_cromer"
READ_BY_FIXED_STEPS = ("scheme", "step", "projection")
READ_BY_ADAPTIVE_STEPS = ("scheme", "rtol", "atol", "max_step", "projection")


def _fixed(name: str, order: int) -> Traits:
    return Traits(name, READ_BY_FIXED_STEPS, fixed_steps=True, order=order, locates_events=False)


def _adaptive(name: str) -> Traits:
    return Traits(name, READ_BY_ADAPTIVE_STEPS)


TRAITS = {
    EULER_CROMER: _fixed(EULER_CROMER, 1),
    **{name: _adaptive(name) if scheme.adaptive else _fixed(name, scheme.order) for name, scheme in SCHEMES.items()},
}
"""Traits by scheme."""


def traits(settings: RunSettings) -> Traits:
    """Return the traits of the scheme in the settings; by default `dop853`, or `euler_cromer` if a step is given."""
    return TRAITS[settings.scheme or (EULER_CROMER if "step" in settings.model_fields_set else "dop853")]


def solve(
    dynamics: Dynamics, start: InitialValues, grid: Grid, settings: RunSettings, watch: ProgressCallback
) -> Trajectory:
    """Integrate q' = u, u' = u'(q, u, t) explicitly; the contract is in `stiffmbs.solve.trajectory`.

    After each step, minimum-norm Newton moves correct positions to |C| < 1e-12, and the smallest correction in the mass
    norm corrects velocities: Hairer, Wanner, Solving Ordinary Differential Equations II, 1996, sec. VII.2, "projection
    methods".
    """
    dynamics.forget_pivots()
    chosen = traits(settings).name
    if chosen == EULER_CROMER:
        return solve_with_fixed_steps(dynamics, euler_cromer(dynamics, start, settings), grid, settings, watch)
    scheme = SCHEMES[chosen]
    if scheme.adaptive:
        return AdaptiveRun(scheme, dynamics, start, grid, settings, watch).integrate()
    return solve_with_fixed_steps(dynamics, runge_kutta(scheme, dynamics, start, grid, settings), grid, settings, watch)
