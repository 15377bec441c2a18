"""Decisions of `stiffmbs.solve.auto`: which implicit integrator to take, and when to try, keep and leave it.

They are functions of measured costs. Costs are in the unit of `stiffmbs.solve.cost`; no clock is read.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, NamedTuple, TypeVar

from ..tuning import tuned


@dataclass(frozen=True)
class AutoParameters:
    """Parameters of the choice between explicit and implicit steps.

    Source: run times of ``python -m tests.bench.solvers.choice`` and of the scenes in ``tests/solve/test_auto.py``.

    - `steps_per_radian`: implicit steps per radian of a vibration that the start excites, until it has decayed to the
      tolerances.
    - `trial_margin`: saving of a later trial of implicit steps, relative to the cost of their start and of their small
      steps, above which it is justified; and run length above which radau replaces bdf for overdamped motions.
    - `check_interval`: least number of steps up to the next check of implicit steps, relative to those of the segment
      so far.
    - `trial_loss`: loss up to which implicit steps are kept, relative to the cost of explicit steps to the end of the run.
      That of their start is always tolerated.
    """

    steps_per_radian: float = 0.35
    trial_margin: float = 3.0
    check_interval: float = 0.25
    trial_loss: float = 0.05


AUTO = tuned("auto", AutoParameters())


class ExplicitSteps(NamedTuple):
    """Numbers of explicit steps.

    `time`: time of the motion, s: at the count, or covered by the steps after an earlier count. `accepted`: accepted
    steps, `limited` of which were limited by stability. `cost`: that of all attempts, including those that an event ended.
    """

    time: float
    accepted: int
    limited: int
    cost: float


class ImplicitSteps(NamedTuple):
    """Cost of implicit steps.

    `time`: time of the motion, s: at the count, or covered by the steps after an earlier count. `restarts`: restarts at
    breakpoints and events. `long`: steps of `radau`, which those of DOP853, of similar order, do not exceed in length.
    """

    time: float
    restarts: int
    long: int
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

    - `return_ratio`: ratio of explicit to implicit cost at which implicit steps are resumed.
    - `penalty`: explicit cost of a segment before the next trial of implicit steps.
    """

    return_ratio: float = 1.0
    penalty: float = 0.0

    def after_return(self) -> Thresholds:
        """Return the thresholds after implicit steps were resumed because explicit steps cost more."""
        return replace(self, return_ratio=2.0 * self.return_ratio)

    def after_failed_trial(self, cost: float) -> Thresholds:
        """Return the thresholds after a trial of implicit steps that cost `cost` in excess of explicit steps."""
        return replace(self, penalty=max(cost, 2.0 * self.penalty))


def implicit_solver(parameters: AutoParameters, damping_ratio: float, run_length: float) -> str:
    """Return the name of the implicit integrator, ``bdf`` or ``radau``.

    BDF is taken for overdamped motions if small steps after starts are a large part of the run.
    `damping_ratio`: that of the stiffest motion. `run_length`: number of explicit steps at the cost of steps of bdf,
    relative to the cost of the small steps of radau.
    """
    return "radau" if damping_ratio < 1.0 or run_length > parameters.trial_margin else "bdf"


def steps_of_decay(parameters: AutoParameters, excitation: float, damping_ratio: float, radians: float) -> float:
    """Return the implicit steps of a vibration up to its decay to the tolerances, or in all its `radians` to the end of the run.

    `excitation`: change of a velocity by it, in tolerances.
    """
    if excitation <= 1.0:
        return 0.0
    decaying = math.log(excitation) / damping_ratio if damping_ratio > 0.0 else math.inf
    return parameters.steps_per_radian * min(decaying, radians)


def saving_by_return(explicit_rate: float, implicit_rate: float, ratio: float, remaining: float) -> float:
    """Return the cost that implicit steps save up to the end if they are `ratio` times as expensive as before.

    `explicit_rate`, `implicit_rate`: measured cost of both per second of the motion. `remaining`: time up to the end of
    the run, s.
    """
    return remaining * (explicit_rate - ratio * implicit_rate)


def loss_of_trial(before: float, implicit_cost: float, explicit_cost: float) -> float:
    """Return the cost of implicit steps in excess of explicit ones, summed since they were last less expensive."""
    return max(before + implicit_cost - explicit_cost, 0.0)


def tolerable_loss(parameters: AutoParameters, start: float, explicit_cost: float) -> float:
    """Return the loss up to which implicit steps are kept; their start costs `start`, explicit steps to the end `explicit_cost`."""
    return max(start, parameters.trial_loss * explicit_cost)


class Interval(NamedTuple):
    """Implicit steps between two checks: the time at their middle, s, and their cost per second of the motion."""

    middle: float
    rate: float


def cost_ahead(first: Interval, last: Interval, begin: float, end: float) -> float:
    """Return the cost of implicit steps if their rate falls on as that of a decaying vibration does.

    `first`, `last`: intervals since the start. `begin`, `end`: of the steps, s. Steps follow a root of the amplitude, which
    is an exponential too.
    """
    if not 0.0 < last.rate < first.rate:
        return last.rate * (end - begin)
    constant = (last.middle - first.middle) / math.log(first.rate / last.rate)
    at_begin = last.rate * math.exp((last.middle - begin) / constant)
    return -at_begin * constant * math.expm1((begin - end) / constant)
