"""The energy balance of a run: kinetic + potential energy against the work of everything that has no potential.

Along a motion T + V changes by the work of dampers, drives, friction, applied forces and laws without a potential
(`stiffmbs.compile.symbolic.losses` has their power).  Both are computed from the states that a run reports, so their difference
tells how well these satisfy the equations of motion, whatever the integrator believes of its own error.

The work is integrated by the trapezoidal rule with end corrections, of order 4; the same rule on every other instant tells how well these resolve the power.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..compile.machine.layout import addresses
from ..compile.machine.routines import together
from ..compile.system import System
from ..compile.terms import TERM_SETS
from ..solve.dynamics import OutputRows

WORK, STEPS_INSIDE = together(
    "stiffmbs.results.native.work",
    work="float64(int64, float64*, float64*, float64*, float64*)",
    steps_inside="void(int64, float64*, int64, float64*, int64*)",
)

MOST_INSTANTS = 100_000
"""Instants that a balance is made of at the most; of more every other one counts, or fewer."""
BROKEN = 1e-2
"""Part of the exchanged energy that may be missing before it is told."""
SEEN = 1
"""Steps of the solver that may end inside an interval whose work the values at its ends tell."""


@dataclass(frozen=True)
class Balance:
    """Energies and work over a run, J.

    Attributes
    ----------
    t : ndarray, shape (n,)
        Instants at which all is known, s.
    change : ndarray, shape (n,)
        Of kinetic + potential energy since the start.
    work : ndarray, shape (n,)
        Of everything without a potential since the start.
    within : ndarray, shape (n - 1,)
        What the end corrections of the quadrature add in each interval.
    steps : ndarray of int, shape (n - 1,)
        How many of the solver's own steps end inside each interval.
    resolved : float
        How far the work is from that of every other instant: what the quadrature resolves.
    scale : float
        The energy that is exchanged: the largest kinetic energy, change of the potential energy, or work.
    keeps_energy : bool
        Whether nothing does such work for certain: the work is then zero, not computed.
    """

    t: np.ndarray
    change: np.ndarray
    work: np.ndarray
    within: np.ndarray
    steps: np.ndarray
    resolved: float
    scale: float
    keeps_energy: bool

    @property
    def open(self) -> np.ndarray:
        """What is missing in the balance since the start, shape (n,)."""
        return self.change - self.work

    @property
    def furthest(self) -> float:
        """The largest magnitude of that, or of what is missing in one interval."""
        open_ = self.open
        return float(max(np.max(np.abs(open_), initial=0.0), np.max(np.abs(np.diff(open_)), initial=0.0)))

    @property
    def _seen(self) -> np.ndarray:
        """The intervals whose work the instants may resolve: those of hardly more than one step of the solver."""
        return (self.steps <= SEEN) | self.keeps_energy

    @property
    def imbalance(self) -> float:
        """The largest magnitude of what is missing, summed over the intervals that the instants resolve."""
        missing = np.cumsum(np.where(self._seen, np.diff(self.open), 0.0))
        return float(np.max(np.abs(missing), initial=0.0))

    @property
    def between(self) -> float:
        """The sum of what is missing in the other intervals: work between instants, or an error."""
        return float(np.sum(np.abs(np.diff(self.open)), where=~self._seen))

    def as_dict(self) -> dict[str, float | bool]:
        """The object ``balance`` of ``stiffmbs run --json``, J."""
        return {
            "change": float(self.change[-1]), "work": float(self.work[-1]), "imbalance": self.imbalance,
            "between": self.between, "resolved": self.resolved, "conservative": self.keeps_energy,
        }  # fmt: skip


def energy_balance(system: System, rows: OutputRows, steps: np.ndarray) -> Balance:
    """The balance at the instants of a run; those without values are passed over.

    Parameters
    ----------
    system : System
    rows : OutputRows
    steps : ndarray
        Ends of the solver's own steps, s; empty where it does not tell them.
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


def may_be_broken(missing: float, exchanged: float) -> bool:
    """Whether a balance in which some energy is missing is worth a closer look, J."""
    return missing > BROKEN * exchanged


def work_since_start(t: np.ndarray, power: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
    """The integral of a power by the trapezoidal rule with end corrections.

    Davis and Rabinowitz, Methods of Numerical Integration (1984), sec. 2.9.

    Parameters
    ----------
    t, power : ndarrays, shape (n,)
        s, W; n is 1 or more.

    Returns
    -------
    work : ndarray, shape (n,)
        J.
    within : ndarray, shape (n - 1,)
        What the corrections add in each interval, J.
    resolved : float
        How far the work is from that of every other instant, J.
    """
    t, power = np.ascontiguousarray(t), np.ascontiguousarray(power)
    total, within = np.empty(len(t)), np.empty(len(t) - 1)
    resolved = WORK.call(len(t), *addresses(t, power, total, within))
    return total, within, resolved


def steps_inside(t: np.ndarray, steps: np.ndarray) -> np.ndarray:
    """How many of increasing steps end inside each interval between increasing instants, its ends left out; shape (n - 1,)."""
    t, steps = np.ascontiguousarray(t), np.ascontiguousarray(steps, dtype=float)
    inside = np.empty(max(len(t) - 1, 0), dtype=np.int64)
    at_t, at_steps, at_inside = addresses(t, steps, inside)
    STEPS_INSIDE.call(len(t), at_t, len(steps), at_steps, at_inside)
    return inside


def potentials(system: System, values: np.ndarray) -> dict[str, np.ndarray]:
    """The potential energy of each element that has one, J, shape (n,)."""
    at = 1 + TERM_SETS["output"].index("potential")
    return {
        name: values[:, system.places["output"][g, at] + e]
        for g, group in enumerate(system.groups)
        if group.record.patterns.get("potential")
        for e, name in enumerate(group.names)
    }
