"""Explicit integrator with projection onto the constraints after each step."""

from __future__ import annotations

from ...dynamics.dynamics import Dynamics
from ...dynamics.initial import InitialValues
from ...model.settings import RunSettings
from ..integrator import Integrator, integrated
from ..solver import Traits
from ..trajectory import Grid, ProgressCallback, Trajectory
from .adaptive import AdaptiveSteps
from .fixed import solve_with_fixed_steps
from .integration import Integration
from .scheme import Scheme
from .schemes import SCHEMES

READ_BY_FIXED_STEPS = ("scheme", "step", "projection")
READ_BY_ADAPTIVE_STEPS = ("scheme", "rtol", "atol", "max_step", "projection")


def _traits(scheme: Scheme) -> Traits:
    if scheme.adaptive:
        return Traits(scheme.name, READ_BY_ADAPTIVE_STEPS)
    return Traits(scheme.name, READ_BY_FIXED_STEPS, fixed_steps=True, order=scheme.order, locates_events=False)


TRAITS = {scheme.name: _traits(scheme) for scheme in SCHEMES.values()}
"""Traits by scheme."""


def traits(settings: RunSettings) -> Traits:
    """Return the traits of the scheme in the settings; by default `dop853`, or `euler_cromer` if a step is given."""
    return TRAITS[settings.scheme or ("euler_cromer" if "step" in settings.model_fields_set else "dop853")]


def scheme_of(settings: RunSettings) -> Scheme:
    """Return the scheme that the settings choose."""
    return SCHEMES[traits(settings).name]


def solve(
    dynamics: Dynamics, start: InitialValues, grid: Grid, settings: RunSettings, watch: ProgressCallback
) -> Trajectory:
    """Integrate q' = u, u' = u'(q, u, t) explicitly; the contract is in `stiffmbs.solve.trajectory`.

    After each step, minimum-norm Newton moves correct positions to |C| < 1e-12, and the smallest correction in the mass
    norm corrects velocities: Hairer, Wanner, Solving Ordinary Differential Equations II, 1996, sec. VII.2, "projection
    methods".
    """
    dynamics.forget_pivots()
    scheme = scheme_of(settings)
    if scheme.adaptive:
        engine = AdaptiveSteps(scheme, dynamics, start, grid, settings)
        return engine.ended(integrated(Integrator(dynamics, settings, engine), start, grid, watch))
    return solve_with_fixed_steps(
        dynamics, Integration.of(scheme, dynamics, start, grid, settings), grid, settings, watch
    )
