"""The implicit integrator of `stiffmbs.solve.auto`: `bdf` or `radau`, and its cost."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cached_property
from typing import Any, NamedTuple

from ..dynamics.dynamics import Dynamics
from ..model.settings import RunSettings
from . import SOLVERS
from .auto_decisions import AUTO, ImplicitSteps, implicit_solver
from .cost import ImplicitCost
from .explicit.stable_step import Rates
from .integrator import Integrator, driven
from .radau import radau
from .solver import Traits

OF_STEPS = {"bdf": ImplicitCost.of, "radau": radau.of_radau}
DRIVERS: dict[str, Callable[[], dict[str, Any]]] = {"bdf": dict, "radau": radau.driver}


class Estimates(NamedTuple):
    """Costs of an implicit integrator, described in `Implicit`."""

    cost: ImplicitCost
    growth: float
    start: float


class Implicit:
    """Implicit integrator, created when it is needed.

    - `name`: ``bdf`` or ``radau``; empty before it is chosen.
    - `cost`: cost of the chosen integrator with its linear solver. Before that is chosen too, a lower bound; before
      the integrator is chosen, that of `bdf`, which is the least.
    - `growth`: cost of the small steps after a start or a breakpoint.
    - `start`: cost of a switch to these steps, including the small ones.
    """

    def __init__(self, dynamics: Dynamics, settings: RunSettings) -> None:
        self._dynamics, self._settings = dynamics, settings
        self._become("", False)

    def choose(self, rates: Rates, explicit_steps: float, pieces: int) -> None:
        """Choose the integrator by the rates of the motion about a state, unless its linear solver is chosen.

        `explicit_steps`: explicit steps in place of implicit ones. `pieces`: number of starts and restarts.
        """
        if not self._final:
            run_length = explicit_steps * self._estimated("bdf").cost.step / (pieces * self._estimated("radau").growth)
            self._become(implicit_solver(AUTO, rates.damping_ratio, run_length), False)

    def confirm(self) -> None:
        """Confirm the chosen integrator, `bdf` if none is chosen, and estimate its cost with its linear solver."""
        if not self._final:
            self._become(self.name or "bdf", True)

    def change(self, name: str) -> None:
        """Change to another integrator, without steps at first."""
        self._become(name, True)
        self.__dict__.pop("integrator", None)

    def _become(self, name: str, final: bool) -> None:
        self.name, self._final = name, final
        self.cost, self.growth, self.start = self._estimated(name or "bdf", final)

    def _estimated(self, name: str, final: bool = False) -> Estimates:
        """Return the costs of an integrator, which the dynamics keep: with its linear solver if it is final, or lower bounds."""

        def estimated() -> Estimates:
            """Return the costs."""
            factors = 1e-3 * driven(self._dynamics, self._settings, **DRIVERS[name]()).cost if final else None
            found = OF_STEPS[name](self._dynamics, factors)
            growth = -math.log10(self._settings.rtol) * found.start_steps * found.step
            return Estimates(found, growth, found.memory + growth)

        return self._dynamics.kept(f"costs of {name}, {final}", self._settings, estimated)

    @cached_property
    def integrator(self) -> Integrator:
        """The integrator, without steps at first."""
        return Integrator(self._dynamics, self._settings, **DRIVERS[self.name]())

    def traits(self) -> Traits:
        """Return the traits of the solver."""
        return SOLVERS[self.name].traits(self._settings)

    def steps(self, t: float) -> ImplicitSteps:
        """Return the steps of all segments, the last of which has reached the time t."""
        if not self.integrator.steps():
            return ImplicitSteps(t, 0, 0, 0.0)
        counted = self.integrator.statistics()
        restarts = int(counted["breakpoints"]) + int(counted["events"])
        long = self.integrator.steps() if self.name == "radau" else 0
        return ImplicitSteps(
            t, restarts, long, self.cost.work(int(counted["residuals"]), int(counted["factorizations"]))
        )
