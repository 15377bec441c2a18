"""Loads of joints and force elements over a run: magnitude, peak, mean and root mean square, with error bars."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..compile.bodies import PLANE, SPACE
from ..reading.names import owner_of
from ..reading.units.display import SI_UNITS, DisplayUnits
from ..results.digits import largest_bar
from ..results.error_bars import UNKNOWN
from ..results.solution import Solution
from .parameters import EVALUATION

UNITS = {"f": "N", "t": "N m"}
"""Unit of the components of a reaction by their first letter: a force, a torque."""


@dataclass(frozen=True, eq=False)
class Load:
    """Force or torque of one element on its first body.

    Attributes
    ----------
    element : str
        Name of the joint or force.
    unit : str
        ``N`` or ``N m``.
    time : ndarray, shape (n,)
        Output instants, s.
    components : ndarray, shape (n, 2), (n, 3) or (n, 1)
        Along the ground axes; a torque in the plane has one.
    bar : float
        Bound on the error of the magnitude: the magnitude of the bars of the components. NaN if unknown.
    unique : bool
        False if rigid bodies do not determine the load.
    excess : float
        Part of the bar for peaks between output instants.
    display : DisplayUnits
        Units in which pages show the load.
    """

    element: str
    unit: str
    time: np.ndarray
    components: np.ndarray
    bar: float
    unique: bool
    excess: float = 0.0
    display: DisplayUnits = SI_UNITS

    def __repr__(self) -> str:
        return f"<Load of {self.element}: peak {self.peak:.6g} {self.unit} at t = {self.peak_time:.6g} s>"

    @property
    def magnitude(self) -> np.ndarray:
        """Magnitude at the output instants, shape (n,)."""
        return np.asarray(np.sqrt(np.square(self.components).sum(axis=1)))

    @property
    def peak_row(self) -> int:
        """Output instant of the peak; the first if no value is known."""
        sizes = self.magnitude
        return 0 if np.isnan(sizes).all() else int(np.nanargmax(sizes))

    @property
    def peak_time(self) -> float:
        """Output instant of the peak, s."""
        return float(self.time[self.peak_row])

    @property
    def peak(self) -> float:
        """Largest magnitude at an output instant."""
        return float(np.nan_to_num(self.magnitude[self.peak_row]))

    @property
    def mean(self) -> float:
        """Mean magnitude over time."""
        return self.over_time(1)[0]

    @property
    def rms(self) -> float:
        """Root mean square over time."""
        return self.over_time(2)[0]

    def over_time(self, power: int) -> tuple[float, float]:
        """Return the mean over time of a power of the magnitude, its root taken, and the error of the sum over the instants.

        The error is the difference from the sum over every other instant.
        """
        known = np.isfinite(self.magnitude)
        t, values = self.time[known], self.magnitude[known] ** power
        every = np.arange(len(t))
        other = np.union1d(every[::2], every[-1:])
        whole, coarse = (_mean(t[rows], values[rows]) ** (1.0 / power) for rows in (every, other))
        return whole, abs(whole - coarse)


def _mean(t: np.ndarray, values: np.ndarray) -> float:
    if len(t) < 2 or t[-1] <= t[0]:
        return float(values[0]) if len(values) else 0.0
    return float(np.trapezoid(values, t) / (t[-1] - t[0]))


@np.errstate(all="ignore")  # numbers of a diverged run overflow
def loads(solution: Solution) -> tuple[Load, ...]:
    """Return the forces and torques of joints and force elements that are not zero, the largest of each first.

    Forces come before torques. A load without a unique value is listed even if it is zero.

    Examples
    --------
    >>> import stiffmbs
    >>> hinge = stiffmbs.loads(stiffmbs.run("examples/bar_pendulum.yaml", rtol=1e-8))[0]
    >>> print(hinge.element, round(hinge.peak, 2), hinge.unit, hinge.components.shape)
    hinge 29.43 N (301, 2)
    """
    components, elements = reactions_of(solution), elements_of(solution)
    every = [
        _load(solution, element, [name for name in components if name[0] == kind], unit)
        for kind, unit in UNITS.items()
        for element in elements
    ]
    least = EVALUATION.zero * max((max(load.peak, load.excess) for load in every), default=0.0)
    kept = [load for load in every if max(load.peak, load.excess) > least or not load.unique]
    return tuple(sorted(kept, key=lambda load: (load.unit != UNITS["f"], -load.peak)))


def unloaded(solution: Solution, found: Sequence[Load]) -> list[str]:
    """Return the elements of a solution that carry none of its loads."""
    carrying = {load.element for load in found}
    return [element for element in elements_of(solution) if element not in carrying]


def _load(solution: Solution, element: str, parts: Sequence[str], unit: str) -> Load:
    names = [f"{element}.{part}" for part in parts]
    errors = [solution.errors.get(name, UNKNOWN) for name in names]
    bar, excess = (
        float(np.hypot.reduce([size(error) for error in errors]))
        for size in (largest_bar, lambda error: max(error.sampled_least, error.sampled_greatest))
    )
    unique = not any(name in solution.not_unique for name in names)
    values = np.column_stack([solution.channels[name] for name in names])
    return Load(element, unit, solution.time, values, bar, unique, excess, solution.display)


def elements_of(solution: Solution) -> list[str]:
    """Return the elements that have a force and torque among the channels, in the order of the scene."""
    own, last = [name for name in solution.channels if name not in solution.requested], reactions_of(solution)[-1]
    return list(dict.fromkeys(owner_of(name) for name in own if name.endswith(f".{last}")))


def reactions_of(solution: Solution) -> tuple[str, ...]:
    """Return the labels of forces and torques in a solution."""
    in_space = any(name.endswith(".tz") for name in solution.channels if name not in solution.requested)
    return (SPACE if in_space else PLANE).reactions
