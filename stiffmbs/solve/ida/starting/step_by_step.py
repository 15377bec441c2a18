"""A start of IDA that does not need the compiled one: for algebraic states, infinite stiffness, and scikit-sundae's callbacks."""

from __future__ import annotations

import numpy as np

from ....compile.equations import ABSENT, Equations
from ....describe.settings import RunSettings
from ...algebraic_states import rates_of_algebraic
from ...dynamics import Dynamics
from ...error_control.error_test import ErrorControl
from ...error_control.newton import newton_tolerance, stiffness_at
from ...error_control.relaxation import relax
from ...initial import InitialValues, rates_of
from ..engine import Engine


def begin_step_by_step(
    engine: Engine,
    dynamics: Dynamics,
    equations: Equations,
    chosen: tuple[RunSettings, ErrorControl],
    start: InitialValues,
    t: float,
) -> None:
    """Start an engine at consistent values; `chosen` is what its steps follow."""
    settings, control = chosen
    at = equations.at
    state, coordinates = dynamics.state, equations.coordinates
    rates = rates_of(dynamics, t, start)
    state.a[:], state.mu[:] = start.acceleration, 0.0
    equations.start_from(start.q)
    y, yp = np.zeros(equations.n), np.zeros(equations.n)
    y[equations.independent] = coordinates.state(start.q, start.u)
    if len(dynamics.system.algebraic_coordinates):
        rates[dynamics.system.algebraic_coordinates] = rates_of_algebraic(
            dynamics, t, start.q, start.u, start.acceleration
        )
    yp[equations.independent] = coordinates.state(rates, start.acceleration)
    solved = at["lam"] != ABSENT
    multipliers = yp if equations.formulation.integrated else y
    multipliers[at["lam"][solved]] = start.lam[solved]
    relax(dynamics, settings, t)
    stiffness = stiffness_at(dynamics, t)
    newton = control.newton or newton_tolerance(stiffness, settings)
    engine.begin(t, y, yp, newton, stiffness)
