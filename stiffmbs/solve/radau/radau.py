"""Radau IIA methods of 3, 5 and 7 stages: L-stable, of orders 5, 9 and 13, with error control."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from ...dynamics.dynamics import Dynamics
from ...dynamics.initial import InitialValues
from ...model.settings import RunSettings
from ...tuning import parameters_of, tuned
from ..bdf import refuse_untested_reactions
from ..cost import ImplicitCost, least_solver, of_evaluation
from ..error_control.error_test import ErrorControl
from ..error_control.native.parameters import NEWTON
from ..ida.choice import Driven, chosen, driven, natural
from ..ida.native_engine import NativeEngine
from ..integrator import Integrator, integrated
from ..trajectory import Grid, ProgressCallback, Trajectory
from .memory import Radau, pair_cost
from .parameters import RADAU


class StepwiseControl(ErrorControl):
    """Settings by which velocities that a formulation does not test are tested times the step.

    They have index 2: in short steps, their errors are those of positions over the step (Hairer, Wanner 1996, ch. VII.4).
    """

    by_step = ("u",)


CONTROL = tuned("error_test_of_radau", StepwiseControl(margin=1.0, relaxation=0.01))
ITERATIONS, START_STEPS = 3, 4
"""Average number of Newton iterations in a step; small steps after a start per digit of the relative tolerance."""
RESIDUAL = 4.0
"""Cost of a residual in that of a matrix, relative to bdf, by which a run chooses its stages and keeps its matrices.

Source: run times of the half car, the chain, the elastic bearing and the axle on bushings.
"""


def solve(
    dynamics: Dynamics, start: InitialValues, grid: Grid, settings: RunSettings, watch: ProgressCallback
) -> Trajectory:
    """Integrate by Radau IIA methods; the contract is in `stiffmbs.solve.trajectory`.

    Raises InputError when the formulation does not test velocities and forces depend on reactions.
    """
    refuse_untested_reactions(dynamics.system, settings)
    dynamics.forget_pivots()
    return integrated(radau_integrator(dynamics, settings), start, grid, watch)


def radau_integrator(dynamics: Dynamics, settings: RunSettings, memory: str = "radau") -> Integrator[NativeEngine]:
    """Return the integrator of a system, which may be reused; its dynamics keep the engine under the name `memory`."""
    return Integrator(dynamics, settings, driven(dynamics, settings, **driver(memory)).engine)


def driver(memory: str = "radau") -> dict[str, Any]:
    """Return how an integrator is driven: arguments of `stiffmbs.solve.ida.choice.driven`."""
    return {"control": CONTROL, "memory": memory, "driver": driven_by_radau}


def of_radau(dynamics: Dynamics, factors: float | None = None) -> ImplicitCost:
    """Return the cost of steps of five stages, with a real and two complex matrices.

    Most terms keep their values for several matrices, so that a matrix costs its factors alone. `factors`: mean cost of
    the three linear systems, us; None if unknown.
    """
    of_bdf = ImplicitCost.of(dynamics, factors)
    factors = least_solver(dynamics) if factors is None else factors
    residual = of_evaluation(dynamics) + RADAU.solution_cost * factors * 3 / 5
    each = {"step_residuals": 5 * ITERATIONS, "step_matrices": 3, "start_steps": START_STEPS}
    return replace(of_bdf, residual=residual, matrix=factors, **each)


def driven_by_radau(dynamics: Dynamics, settings: RunSettings, control: ErrorControl) -> Driven:
    """Return the equations with their engine, and the mean cost of a real and two complex linear systems."""
    equations = natural(dynamics, settings)
    matrix, cost = chosen(equations)

    def engine() -> NativeEngine:
        """Return the engine; its formula weighs residuals by `RESIDUAL`."""
        stages = None if settings.stages == "auto" else settings.stages
        of_bdf = ImplicitCost.of(dynamics, 1e-3 * cost)
        of_steps = replace(of_bdf, residual=RESIDUAL * of_bdf.residual)
        coordinates = max(1.0, dynamics.system.size)  # joints transmit their rounding to unknowns near zero
        hidden = float(np.sqrt(NEWTON.precision * coordinates / settings.rtol))  # remainder that rounding hides
        parameters = replace(parameters_of(RADAU), remainder=max(RADAU.remainder, min(NEWTON.loosest, hidden)))
        formula = Radau(equations, matrix, dynamics.state, stages, of_steps, parameters)
        return NativeEngine(equations, dynamics, matrix, settings, control, formula)

    return Driven(equations, cost * (1 + 2 * pair_cost(matrix)) / 3, engine)
