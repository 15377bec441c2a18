"""The implicit integrator of `stiffmbs.solve.auto`: `bdf` or `radau`, and its cost."""

from __future__ import annotations

import math

from ..dynamics.dynamics import Dynamics
from ..model.settings import RunSettings
from . import bdf, cost
from .auto_decisions import AUTO, ImplicitSteps, implicit_solver
from .explicit.stable_step import Rates
from .integrator import Integrator
from .radau import radau
from .solver import Traits


class Implicit:
    """Implicit integrator, created when it or its cost is needed.

    - `name`: ``bdf`` or ``radau``; empty before it is chosen.
    - `cost`: cost of the chosen integrator with its linear solver. Before it exists, a lower bound; before it is
      chosen, that of `bdf`, which is the least.
    - `growth`: cost of the small steps after a start or a breakpoint.
    - `start`: cost of a switch to these steps, including the small ones.
    """

    def __init__(self, dynamics: Dynamics, settings: RunSettings) -> None:
        self._dynamics, self._settings = dynamics, settings
        self.name, self._created = "", False
        self._estimate(None)

    def choose(self, rates: Rates, explicit_steps: float, pieces: int) -> None:
        """Choose the integrator by the rates of the motion about a state, unless one exists.

        `explicit_steps`: explicit steps in place of implicit ones. `pieces`: number of starts and restarts.
        """
        if not self._created:
            of_bdf = cost.ImplicitCost.of(self._dynamics)
            self._be("radau")
            run_length = explicit_steps * of_bdf.step / (pieces * self.growth)
            self._be(implicit_solver(AUTO, rates.damping_ratio, self._settings.rtol, run_length))

    def _be(self, name: str) -> None:
        if name != self.name:
            self.name = name
            self._estimate(None)

    def create(self) -> None:
        """Create the chosen integrator, `bdf` if none is chosen, unless it exists, and estimate its cost."""
        if not self._created:
            self._be(self.name or "bdf")
            create = radau.radau_integrator if self.name == "radau" else Integrator
            self.integrator, self._created = create(self._dynamics, self._settings), True
            self._estimate(self.integrator.factors)

    def _estimate(self, factors: float | None) -> None:
        of_steps = radau.of_radau if self.name == "radau" else cost.ImplicitCost.of
        self.cost = of_steps(self._dynamics, factors)
        self.growth = -math.log10(self._settings.rtol) * self.cost.start_steps * self.cost.step
        self.start = self.cost.memory + self.growth

    def traits(self) -> Traits:
        """Return the traits of the solver."""
        return (radau if self.name == "radau" else bdf).traits(self._settings)

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
