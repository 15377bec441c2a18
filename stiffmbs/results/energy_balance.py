"""Energy balance of a run: kinetic + potential energy against the work of non-conservative forces.

Along a motion T + V changes by the work of dampers, drives, friction, applied forces and laws without a potential
(`stiffmbs.compile.symbolic.derive` has their power).  Both are computed from the reported states.  Their difference
shows how well these satisfy the equations of motion, independent of the integrator's own error estimate.

A first balance takes the work from the output times, which may miss what happens in between.  If it does not close, the
run is repeated with rows at the nodes of a Gauss-Lobatto quadrature within each step of the solver
(`stiffmbs.analyses.balance_within_steps`).  The work is then as exact as the solution, for steps of any length.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from ..compile.system import System
from ..compile.terms import TERM_SETS
from ..dynamics.dynamics import OutputRows

MOST_INSTANTS = 100_000
"""Number of instants of a balance at most; of more, only every second (or third, ...) is used."""


@dataclass(frozen=True)
class ElementEnergy:
    """Energy that an element exchanges with the mechanism over a run, J.

    Attributes
    ----------
    stored : float
        Change of its potential energy: of a spring, or of a body by gravity.
    supplied : float
        Work of its other forces while they drive the mechanism, as those of a motor.
    dissipated : float
        Work that its other forces take from the mechanism while they resist it, as those of a damper.
    """

    stored: float
    supplied: float
    dissipated: float


@dataclass(frozen=True, eq=False)
class Balance:
    """Energies and work over a run, J."""

    t: np.ndarray  # shape (n,): instants at which all values are known, s
    change: np.ndarray  # shape (n,): change of kinetic + potential energy since the start
    work: np.ndarray  # shape (n,): work of non-conservative forces since the start
    scale: float  # exchanged energy: the largest kinetic energy, change of the potential energy, or work
    keeps_energy: bool  # True if no non-conservative force exists: the work is then zero, not computed
    within_steps: bool = False  # True if the work is a quadrature within each step of the solver
    elements: Mapping[str, ElementEnergy] = field(default_factory=dict)  # of those that store energy or do work

    def __repr__(self) -> str:
        change, work = (float(values[-1]) for values in (self.change, self.work))
        return f"<Balance: change {change:.6g} J, work {work:.6g} J, imbalance {self.imbalance:.2g} J>"

    @property
    def open(self) -> np.ndarray:
        """Return the energy missing in the balance since the start, shape (n,)."""
        return self.change - self.work

    @property
    def imbalance(self) -> float:
        """Return the largest magnitude of the energy missing since the start, or in one interval."""
        open_ = self.open
        return float(max(np.max(np.abs(open_), initial=0.0), np.max(np.abs(np.diff(open_)), initial=0.0)))

    @property
    def resolved(self) -> bool:
        """Return True if the work has no error by the distance of the instants."""
        return self.keeps_energy or self.within_steps

    def as_dict(self) -> dict[str, float | bool]:
        """Return the object ``balance`` of ``stiffmbs run --json``, J."""
        return {
            "change": float(self.change[-1]), "work": float(self.work[-1]), "imbalance": self.imbalance,
            "resolved": self.resolved, "conservative": self.keeps_energy,
        }  # fmt: skip


def energy_balance(system: System, rows: OutputRows) -> Balance:
    """Return the balance at the instants of a run; those without values are skipped."""
    keeps_energy, rows = system.keeps_energy, rows.at(slice(None, None, 1 + len(rows.t) // MOST_INSTANTS))
    with np.errstate(all="ignore"):  # a diverged run has no balance
        finite = np.isfinite(rows.kinetic + rows.potential + rows.power)
        increasing = rows.t[1:] > rows.t[:-1]
        if not (finite.all() and increasing.all()):
            rows = rows.at(finite & np.append(True, increasing)[: len(rows.t)])
        t, total = rows.t, rows.kinetic + rows.potential
        if not len(t):
            return Balance(t, np.zeros(1), np.zeros(1), 0.0, keeps_energy)
        work = np.zeros_like(t) if keeps_energy else work_since_start(t, rows.power)
        scale = max(float(rows.kinetic.max()), float(np.ptp(rows.potential)), float(np.ptp(work)))
        elements = element_energies(system, rows.values, partial(_net_and_both, t))
    return Balance(t, total - total[0], work, scale, keeps_energy, elements=elements)


def work_since_start(t: np.ndarray, power: np.ndarray) -> np.ndarray:
    """Integrate a power by the trapezoidal rule with end corrections.

    Davis and Rabinowitz, Methods of Numerical Integration (1984), sec. 2.9. `t`, `power` of shape (n,): times, s, and
    power, W; n is 1 or more. The result: work since the start, shape (n,), J.
    """
    h = np.diff(t)
    rise = np.diff(power) / h
    gained = h * (power[:-1] + power[1:]) / 2.0
    if len(t) > 2:
        inner = (rise[:-1] * h[1:] + rise[1:] * h[:-1]) / (h[:-1] + h[1:])  # of parabolas, of lines at the ends
        slope = np.concatenate([rise[:1], inner, rise[-1:]])
        gained += h * h * (slope[:-1] - slope[1:]) / 12.0
    return np.append(0.0, np.cumsum(gained))


def _net_and_both(t: np.ndarray, power: np.ndarray) -> tuple[float, float]:
    """Return the integrals of a power and of its magnitude, J; where its sign changes it is a line."""
    gained, begin, end = np.diff(work_since_start(t, power)), np.abs(power[:-1]), np.abs(power[1:])
    changes = power[:-1] * power[1:] < 0
    smaller = np.diff(t) * np.minimum(begin, end) ** 2 / np.where(changes, begin + end, 1.0)  # twice its area
    both = np.abs(gained) + np.where(changes, smaller, 0.0)
    return float(gained.sum()), float(both.sum())


def balance_of_steps(system: System, rows: OutputRows, weights: np.ndarray, jumps: np.ndarray) -> Balance:
    """Return the balance at the ends of the solver's steps, by a quadrature in each.

    `rows`: at the nodes of all steps, one after the other, the first and last node next to both ends of a step.
    `weights` of shape (steps, nodes): of the power at the nodes, s. `jumps` of shape (steps - 1,): True where velocities jump
    between two steps, by a drive or an impact: what they change is no work of a force.
    """
    shape = weights.shape
    kinetic, potential, power = (x.reshape(shape) for x in (rows.kinetic, rows.potential, rows.power))
    total = kinetic + potential
    between = np.where(jumps, 0.0, total[1:, 0] - total[:-1, -1])
    change = np.cumsum(total[:, -1] - total[:, 0]) + np.append(0.0, np.cumsum(between))
    work = np.zeros(len(change)) if system.keeps_energy else np.cumsum(np.sum(weights * power, axis=1))
    scale = max(float(kinetic.max()), float(np.ptp(potential)), float(np.ptp(np.append(0.0, work))))
    elements = element_energies(
        system, rows.values, lambda power: (weights.ravel() @ power, weights.ravel() @ np.abs(power))
    )
    return Balance(rows.t.reshape(shape)[:, -1], change, work, scale, system.keeps_energy, True, elements)


def element_energies(
    system: System, values: np.ndarray, work_of: Callable[[np.ndarray], tuple[float, float]]
) -> dict[str, ElementEnergy]:
    """Return the energies of all elements that store energy or do work.

    `values`: output terms of shape (n, n_terms). `work_of`: integrals over the run of a power of shape
    (n,), and of its magnitude, J.
    """
    (stores, stored), (works, power) = (_of_elements(system, values, term) for term in ("potential", "power"))
    net, both = np.array([work_of(each) for each in power.T]).reshape(-1, 2).T
    both = np.maximum(both, np.abs(net))  # the integral has an error where the power changes its sign
    found = {name: np.zeros(3) for name in (*stores, *works)}
    for name, change in zip(stores, stored[-1] - stored[0], strict=True):
        found[name] += [change, 0.0, 0.0]  # the weight of a flexible body and the law of its modes have one name
    for name, supplied, dissipated in zip(works, 0.5 * (both + net), 0.5 * (both - net), strict=True):
        found[name] += [0.0, supplied, dissipated]
    return {name: ElementEnergy(*map(float, each)) for name, each in found.items()}


def potentials(system: System, values: np.ndarray) -> dict[str, np.ndarray]:
    """Return the potential energy of each element that has one, J, shape (n,); of a flexible body that of its modes."""
    names, energies = _of_elements(system, values, "potential")
    return dict(zip(names, energies.T, strict=True))


def _of_elements(system: System, values: np.ndarray, term: str) -> tuple[list[str], np.ndarray]:
    """Return the names of the elements that have an output term of one entry, and its values, shape (n, elements)."""
    at = 1 + TERM_SETS["output"].index(term)
    columns = [
        (name, int(system.places["output"][g, at]) + e)
        for g, group in enumerate(system.groups)
        if group.record.patterns.get(term)
        for e, name in enumerate(group.names)
    ]
    return [name for name, _ in columns], values[:, [column for _, column in columns]]
