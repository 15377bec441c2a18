"""Choice of the integrator of `stiffmbs.solve.auto` by the costs of explicit and implicit steps.

The criteria are in `stiffmbs.solve.auto_decisions`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ..dynamics.dynamics import Dynamics
from ..dynamics.initial import InitialValues
from ..model.settings import RunSettings
from . import cost
from .auto_decisions import AUTO, ExplicitSteps, Thresholds, saving_by_return, steps_of_decay
from .auto_implicit import Implicit
from .error_control.tolerances import absolute_tolerances
from .explicit import DOP853
from .explicit.integration import Integration
from .explicit.stable_step import Rates, rates_at
from .trajectory import Grid


class Switch(NamedTuple):
    """Switch to the implicit integrator.

    `explicit_rate`: cost of explicit steps per second of the motion, with which the implicit one is compared.
    `thresholds`: those from then on.
    """

    reason: str
    explicit_rate: float
    thresholds: Thresholds


class Choice:
    """Choice of the integrator in a run.

    `implicit`: the implicit integrator. `thresholds`: current ones. `explicit_step`: cost of an explicit step.
    """

    def __init__(self, dynamics: Dynamics, grid: Grid, settings: RunSettings) -> None:
        self._dynamics, self._grid, self._settings = dynamics, grid, settings
        self.implicit = Implicit(dynamics, settings)
        self._breakpoints = dynamics.input_features(grid.start, grid.end).breakpoints
        self.explicit_step, self._evaluation = dynamics.kept(
            "costs of explicit steps", settings, lambda: (cost.of_explicit_step(dynamics), cost.of_kernels(dynamics))
        )
        self._explicit_rate = np.inf  # cost per second of the motion
        self._implicit_rate = np.inf  # the same of implicit steps, before they were left
        self.thresholds = Thresholds()

    def follow(self, switch: Switch) -> None:
        """Note a switch to the implicit integrator."""
        self._explicit_rate, self.thresholds = switch.explicit_rate, switch.thresholds

    def leave_implicit(self, rate: float, loss: float) -> None:
        """Note that implicit steps were left: their cost per second of the motion, and their cost in excess of explicit ones."""
        self._implicit_rate = rate
        self.thresholds = self.thresholds.after_failed_trial(self.implicit.start + loss)

    def first_trial(self, start: InitialValues) -> Switch | None:
        """Return the decision to begin with the implicit integrator, because stability would limit explicit steps; None to begin explicit."""
        t = self._grid.start
        rates = rates_at(self._dynamics, t, start.q, start.u)
        rate = self._stable_rate(rates)
        pieces = 1 + self._breakpoints_after(t)
        explicit_cost = self.remaining(t) * rate + (pieces - 1) * cost.COSTS.restart_steps * self.explicit_step
        self.implicit.choose(rates, self.remaining(t) * rate / self.explicit_step, pieces)
        decay = self._decay(rates, t, start.u)
        if not self._confirmed(lambda: self._least_cost(pieces, decay) < explicit_cost - self.implicit.growth):
            return None  # the growth is what a failed trial loses
        return Switch(f"{self.implicit.name} (fastest rate {rates.fastest:.3g} 1/s)", rate, self.thresholds)

    def _confirmed(self, pays: Callable[[], bool]) -> bool:
        """Return True if implicit steps pay, first by lower bounds of their cost, then by that with their linear solver."""
        if not pays():
            return False
        self.implicit.confirm()
        return pays()

    def _least_cost(self, pieces: int, decay: float) -> float:
        """Return a lower bound of the cost of implicit steps from the start: small steps and a decay, at least a failed trial."""
        of_decay = decay * self.implicit.cost.work(self.implicit.cost.step_residuals, 0)  # it keeps its matrices
        return max(pieces * self.implicit.growth + of_decay, self.implicit.start)

    def later_trial(self, steps: ExplicitSteps, segment: ExplicitSteps, work: Integration) -> Switch | None:
        """Return the decision to try the implicit integrator, because stability limits explicit steps; None to continue with these.

        `steps`: those since the last check. `segment`: those of the whole segment.
        """
        if not steps.limited or segment.cost < self.thresholds.penalty:
            return None
        t, share = work.t, steps.limited / steps.accepted
        saving = share * steps.cost * self.remaining(t) / steps.time
        if not saving > self._justifying(t):
            return None
        rates = rates_at(self._dynamics, t, work.q.copy(), work.u.copy())
        rate = self._stable_rate(rates)
        self.implicit.choose(rates, saving / self.explicit_step, 1 + self._breakpoints_after(t))
        if not self._confirmed(lambda: min(saving, self.remaining(t) * rate) > self._justifying(t)):
            return None
        reason = (
            f"{self.implicit.name} from t = {t:.4g} s on (stability limited {100 * share:.0f} % of the "
            f"explicit steps, fastest rate {rates.fastest:.3g} 1/s)"
        )
        return Switch(reason, rate, self.thresholds)

    def returned(self, steps: ExplicitSteps, t: float) -> Switch | None:
        """Return the decision to resume the implicit integrator, because explicit steps cost more; None to continue with these."""
        rate = steps.cost / steps.time
        saving = saving_by_return(rate, self._implicit_rate, self.thresholds.return_ratio, self._grid.end - t)
        if not saving > self.implicit.start:
            return None
        reason = f"{self.implicit.name} again from t = {t:.4g} s on (explicit steps cost more)"
        return Switch(reason, rate, self.thresholds.after_return())

    def _stable_rate(self, rates: Rates) -> float:
        """Return the cost of explicit steps per second if stability limits them."""
        return self.explicit_step * rates.fastest / DOP853.stability

    def _decay(self, rates: Rates, t: float, u: np.ndarray) -> float:
        """Return the implicit steps of the vibration that accelerations excite, up to its decay."""
        if not rates.fastest:
            return np.inf
        system, settings = self._dynamics.system, self._settings
        tolerances = self._dynamics.kept("tolerances", settings, lambda: absolute_tolerances(system, settings))
        excitation = float((rates.velocity / (tolerances[system.n_q :] + settings.rtol * np.abs(u))).max(initial=0.0))
        return steps_of_decay(AUTO, excitation, rates.decay_ratio, rates.excited * self.remaining(t))

    def _breakpoints_after(self, t: float) -> int:
        """Return the number of input breakpoints after a time."""
        return len(self._breakpoints) - int(self._breakpoints.searchsorted(t, side="right"))

    def _justifying(self, t: float) -> float:
        """Return the saving that justifies a switch to implicit steps, with small steps after each breakpoint."""
        small = self.implicit.start + self._breakpoints_after(t) * self.implicit.growth
        return AUTO.trial_margin * small

    @property
    def evaluations(self) -> int:
        """Return the number of evaluations of the equations so far, including those of event functions."""
        return self._dynamics.state.evaluations

    def spent(self, evaluations: int, accelerations: int) -> float:
        """Return the cost of explicit steps by their evaluations, some of which were accelerations."""
        of_accelerations = self.explicit_step * accelerations / DOP853.stages
        return of_accelerations + self._evaluation * (evaluations - accelerations)

    def remaining(self, t: float) -> float:
        """Return the time of the motion after t, s."""
        return self._grid.end - t

    def explicit_cost(self, duration: float, restarts: int, fewest: int = 0) -> float:
        """Return the cost of explicit steps over a time of the motion, s, with restarts: `fewest` steps, or as stability requires."""
        of_steps = max(duration * self._explicit_rate, fewest * self.explicit_step)
        return of_steps + restarts * cost.COSTS.restart_steps * self.explicit_step

    def is_breakpoint(self, t: float) -> bool:
        """Return True if t is an input breakpoint, or just before or after one; no integrator can start there."""
        return bool(np.any(np.abs(self._breakpoints - t) <= 2.0 * self._grid.aside))

    def first_check(self) -> int:
        """Return the explicit steps of a segment that cost as much as a switch."""
        return max(int(self.implicit.start / self.explicit_step), 1)
