"""Decisions of `stiffmbs.solve.auto`: which implicit integrator to take, and when to try, keep and leave it.

They are functions of measured costs. Costs are in the unit of `stiffmbs.solve.cost`; no clock is read.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, NamedTuple, TypeVar

from ..tuning import tuned


@dataclass(frozen=True)
class AutoParameters:
    """Parameters of the choice between explicit and implicit steps.

    Source: run times of ``python -m tests.bench car_choice`` and of the scenes in ``tests/solve/test_auto.py``.

    Attributes
    ----------
    light_damping : float
        Damping ratio of the stiffest vibration below which a lightly damped one is assumed.
    radau_rtol, radau_rtol_lightly_damped : float
        Relative tolerance below which the implicit integrator is `radau`. At loose tolerances the low orders of BDF
        damp stiff vibrations; at tight ones BDF follows them.
    check_after : int
        Explicit steps of a segment before its first check.
    stiff_fraction : float
        Fraction of explicit steps limited by stability from which on a trial of implicit steps is considered.
    trial_starts : float
        Explicit cost up to the end of the run that justifies a trial of implicit steps, in their starts.
    at_rest : float
        Velocity change in an explicit step, in tolerances, below which a start excites no vibration.
    trial_starts_at_rest : float
        Value of `trial_starts` for such a start, from which implicit steps soon grow. For `radau`, in addition to one start for each piece between breakpoints.
    check_cost : float
        Cost of the implicit steps between two checks, in their starts without their small steps.
    fewest_steps : int
        Fewest steps between two checks.
    first_loss : float
        Fraction of the remaining explicit cost that the first trial may cost in excess of explicit steps and a start.
        Vibrations that the start excites shorten implicit steps until they are damped.
    return_ratio : float
        Ratio of the explicit cost to the implicit one before at which implicit steps are resumed. It is multiplied by itself at each
        return.
    penalty : float
        Explicit cost before the next trial, in costs of a failed trial. It doubles with each further trial.
    """

    light_damping: float = 0.1
    radau_rtol: float = 3e-5
    radau_rtol_lightly_damped: float = 3e-4
    check_after: int = 32
    stiff_fraction: float = 0.05
    trial_starts: float = 7.0
    at_rest: float = 1e-4
    trial_starts_at_rest: float = 1.5
    check_cost: float = 3.0
    fewest_steps: int = 10
    first_loss: float = 0.45
    return_ratio: float = 1.5
    penalty: float = 3.0


AUTO = tuned("auto", AutoParameters())


class ExplicitSteps(NamedTuple):
    """Numbers of explicit steps.

    `time`: time of the motion, s: at the count, or covered by the steps after an earlier count. `accepted`,
    `attempted`: attempts include rejected steps. `limited`: accepted steps limited by stability.
    """

    time: float
    accepted: int
    attempted: int
    limited: int


class ImplicitSteps(NamedTuple):
    """Cost of implicit steps.

    `time`: time of the motion, s: at the count, or covered by the steps after an earlier count. `restarts`: restarts at
    breakpoints and events.
    """

    time: float
    restarts: int
    cost: float


Steps = TypeVar("Steps", ExplicitSteps, ImplicitSteps)


def since(before: Steps, counted: Steps) -> Steps:
    """Return the steps taken after an earlier count."""
    kind: Any = type(counted)  # mypy does not resolve the constructors of a constrained type variable
    steps: Steps = kind(*(now - then for now, then in zip(counted, before, strict=True)))
    return steps


@dataclass(frozen=True)
class Thresholds:
    """Thresholds of a run, which rise with each switch to bound the number of switches.

    Attributes
    ----------
    return_ratio : float
        Ratio of explicit to implicit cost at which implicit steps are resumed.
    loss : float
        Fraction of the remaining explicit cost that a trial of implicit steps may lose in addition to a start.
    penalty : float
        Explicit cost of a segment before the next trial of implicit steps.
    """

    return_ratio: float
    loss: float
    penalty: float

    @classmethod
    def of(cls, parameters: AutoParameters) -> Thresholds:
        """Return the thresholds at the start of a run."""
        return cls(parameters.return_ratio, parameters.first_loss, 0.0)

    def after_return(self, parameters: AutoParameters) -> Thresholds:
        """Return the thresholds after implicit steps were resumed because explicit steps cost more."""
        return replace(self, return_ratio=parameters.return_ratio * self.return_ratio)

    def after_failed_trial(self, parameters: AutoParameters, cost: float) -> Thresholds:
        """Return the thresholds after a trial of implicit steps that cost `cost` in excess of explicit steps."""
        return replace(self, loss=0.0, penalty=max(parameters.penalty * cost, 2.0 * self.penalty))


def implicit_solver(parameters: AutoParameters, rtol: float, damping_ratio: float) -> str:
    """Return the name of the implicit integrator, ``bdf`` or ``radau``.

    `damping_ratio`: damping ratio of the stiffest vibration; BDF is taken for overdamped motions.
    """
    light = damping_ratio < parameters.light_damping
    loosest = parameters.radau_rtol_lightly_damped if light else parameters.radau_rtol
    return "radau" if damping_ratio < 1.0 and rtol < loosest else "bdf"


def starts_for_first_trial(parameters: AutoParameters, excitation: float) -> float:
    """Return the explicit cost of a run that justifies beginning with implicit steps, in their starts.

    `excitation`: largest change of a velocity in an explicit step, in tolerances.
    """
    return parameters.trial_starts_at_rest if excitation < parameters.at_rest else parameters.trial_starts


def stability_limits(parameters: AutoParameters, steps: ExplicitSteps) -> bool:
    """Return True if stability, not accuracy, limits a significant part of the explicit steps."""
    return steps.limited / steps.accepted >= parameters.stiff_fraction


def saving_by_return(explicit_rate: float, implicit_rate: float, ratio: float, remaining: float) -> float:
    """Return the cost that implicit steps save up to the end if they are `ratio` times as expensive as before.

    `explicit_rate`, `implicit_rate`: measured cost of both per second of the motion. `remaining`: time up to the end of
    the run, s.
    """
    return remaining * (explicit_rate - ratio * implicit_rate)


def loss_of_trial(before: float, implicit_cost: float, explicit_cost: float) -> float:
    """Return the cost of implicit steps in excess of explicit ones, summed since they were last less expensive."""
    return max(before + implicit_cost - explicit_cost, 0.0)


def trial_goes_on(loss: float, start: float, allowed: float, remaining_cost: float) -> bool:
    """Return True if the loss of a trial of implicit steps is below a start and a fraction of the remaining explicit cost."""
    return loss <= start + allowed * remaining_cost
