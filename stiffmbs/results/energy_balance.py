"""Energy balance of a run: kinetic + potential energy against the work of non-conservative forces.

Along a motion T + V changes by the work of dampers, drives, friction, applied forces and laws without a potential
(`stiffmbs.compile.symbolic.derive` has their power).  Both are computed from the reported states.  Their difference
shows how well these satisfy the equations of motion, independent of the integrator's own error estimate.

The work is integrated by the trapezoidal rule with end corrections, of order 4.  The same rule on every other instant
shows how well the instants resolve the power.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..compile.machine.layout import addresses
from ..compile.machine.routines import together
from ..compile.system import System
from ..compile.terms import TERM_SETS
from ..dynamics.dynamics import OutputRows

WORK, STEPS_INSIDE = together(
    "stiffmbs.results.native.work",
    work="float64(int64, float64*, float64*, float64*, float64*)",
    steps_inside="void(int64, float64*, int64, float64*, int64*)",
)

MOST_INSTANTS = 100_000
"""Number of instants of a balance at most; of more, only every second (or third, ...) is used."""
BROKEN = 1e-2
"""Part of the exchanged energy that may be missing before it is reported."""


@dataclass(frozen=True)
class Balance:
    """Energies and work over a run, J."""

    t: np.ndarray  # shape (n,): instants at which all values are known, s
    change: np.ndarray  # shape (n,): change of kinetic + potential energy since the start
    work: np.ndarray  # shape (n,): work of non-conservative forces since the start
    within: np.ndarray  # shape (n - 1,): end corrections of the quadrature in each interval
    steps: np.ndarray  # of int, shape (n - 1,): number of the solver's own steps that end inside each interval
    resolved: float  # difference between the work and that of every other instant: resolution of the quadrature
    scale: float  # exchanged energy: the largest kinetic energy, change of the potential energy, or work
    keeps_energy: bool  # True if no non-conservative force exists: the work is then zero, not computed

    @property
    def open(self) -> np.ndarray:
        """Return the energy missing in the balance since the start, shape (n,)."""
        return self.change - self.work

    @property
    def furthest(self) -> float:
        """Return the largest magnitude of the energy missing since the start, or in one interval."""
        open_ = self.open
        return float(max(np.max(np.abs(open_), initial=0.0), np.max(np.abs(np.diff(open_)), initial=0.0)))

    @property
    def _seen(self) -> np.ndarray:
        """Return True for intervals whose work may be resolved: those with at most one solver step inside."""
        return (self.steps <= 1) | self.keeps_energy

    @property
    def imbalance(self) -> float:
        """Return the largest magnitude of the missing energy, summed over the intervals that the instants resolve."""
        missing = np.cumsum(np.where(self._seen, np.diff(self.open), 0.0))
        return float(np.max(np.abs(missing), initial=0.0))

    @property
    def between(self) -> float:
        """Return the sum of the energies missing in the other intervals: work between instants, or an error."""
        return float(np.sum(np.abs(np.diff(self.open)), where=~self._seen))

    @property
    def may_be_broken(self) -> bool:
        """Return True if the missing energy requires a closer check."""
        return self.furthest > BROKEN * self.scale

    def as_dict(self) -> dict[str, float | bool]:
        """Return the object ``balance`` of ``stiffmbs run --json``, J."""
        return {
            "change": float(self.change[-1]), "work": float(self.work[-1]), "imbalance": self.imbalance,
            "between": self.between, "resolved": self.resolved, "conservative": self.keeps_energy,
        }  # fmt: skip


def energy_balance(system: System, rows: OutputRows, steps: np.ndarray) -> Balance:
    """Return the balance at the instants of a run; those without values are skipped.

    `steps`: ends of the solver's own steps, s; empty if unknown.
    """
    thinned, keeps_energy = slice(None, None, 1 + len(rows.t) // MOST_INSTANTS), system.keeps_energy
    with np.errstate(all="ignore"):  # a diverged run has no balance
        t, kinetic = rows.t[thinned], rows.kinetic[thinned]
        potential, power = rows.potential[thinned], rows.power[thinned]
        finite, increasing = np.isfinite(kinetic + potential + power), t[1:] > t[:-1]
        if not (finite.all() and increasing.all()):
            known = finite & np.append(True, increasing)[: len(t)]
            t, kinetic, potential, power = t[known], kinetic[known], potential[known], power[known]
        if not len(t):
            nothing = np.empty(0)
            return Balance(t, np.zeros(1), np.zeros(1), nothing, nothing, 0.0, 0.0, keeps_energy)
        total = kinetic + potential
        if keeps_energy:
            work, within, resolved = np.zeros_like(t), np.zeros(len(t) - 1), 0.0
        else:
            work, within, resolved = work_since_start(t, power)
        scale = max(float(kinetic.max()), float(np.ptp(potential)), float(np.ptp(work)))
    inside = steps_inside(t, steps)
    return Balance(t, total - total[0], work, within, inside, resolved, scale, keeps_energy)


def work_since_start(t: np.ndarray, power: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
    """Integrate a power by the trapezoidal rule with end corrections.

    Davis and Rabinowitz, Methods of Numerical Integration (1984), sec. 2.9. `t`, `power` of shape (n,): times, s, and
    power, W; n is 1 or more. The result: work since the start, shape (n,), end corrections in each interval, shape
    (n - 1,), and the difference between the work and that of every other instant, J.
    """
    t, power = np.ascontiguousarray(t), np.ascontiguousarray(power)
    total, within = np.empty(len(t)), np.empty(len(t) - 1)
    resolved = WORK.call(len(t), *addresses(t, power, total, within))
    return total, within, resolved


def steps_inside(t: np.ndarray, steps: np.ndarray) -> np.ndarray:
    """Return the number of steps that end strictly inside each interval between increasing instants; shape (n - 1,)."""
    t, steps = np.ascontiguousarray(t), np.ascontiguousarray(steps, dtype=float)
    inside = np.empty(max(len(t) - 1, 0), dtype=np.int64)
    at_t, at_steps, at_inside = addresses(t, steps, inside)
    STEPS_INSIDE.call(len(t), at_t, len(steps), at_steps, at_inside)
    return inside


def potentials(system: System, values: np.ndarray) -> dict[str, np.ndarray]:
    """Return the potential energy of each element that has one, J, shape (n,)."""
    at = 1 + TERM_SETS["output"].index("potential")
    return {
        name: values[:, system.places["output"][g, at] + e]
        for g, group in enumerate(system.groups)
        if group.record.patterns.get("potential")
        for e, name in enumerate(group.names)
    }
