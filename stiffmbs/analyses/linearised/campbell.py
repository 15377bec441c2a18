"""Modes over a parameter: Campbell diagrams of rotors, root loci, critical speeds and limits of stability."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cached_property, partial
from itertools import pairwise
from pathlib import Path
from typing import Unpack

import numpy as np
from scipy.optimize import brentq

from ...errors import AssemblyError, InputError, SolverError
from ...linear_analysis.branches import continued, whirl
from ...linear_analysis.modes import Mode
from ...methods import CampbellMethods
from ...model.settings import RunSettings, Settings, takes_settings
from ...notes import Note, NoteKind, Severity
from ...reading.units.units import DIMENSIONS, named_unit
from ...reading.variation import Range, Variation, numbers_of, variation
from ..job import Runnable, data_of
from ..load_scene import with_parameter
from ..settled import growth_by_rounding
from .modes import Modes, modes

COUNT = 51
"""Default number of values of a range, and of a decade of one with equal ratios."""
FINE = 1e-4
"""Precision of critical speeds and limits of stability, relative to the distance of neighbouring values."""
ANGULAR = DIMENSIONS["angular velocity"][0]

LEFT_OUT = NoteKind(
    "campbell-value-left-out", "no modes at {parameter} = {value:.6g}: {reason}", severity=Severity.REMARK
)
Tell = Callable[[str], None]
Measure = Callable[[float, Mode], float]
"""Number of a mode at a value of the parameter."""


@dataclass(frozen=True)
class Found:
    """Modes at one value of the parameter, and the direction of whirl of each: see `stiffmbs.linear_analysis.branches.whirl`."""

    value: float
    modes: tuple[Mode, ...]
    whirl: tuple[float, ...]
    scale: np.ndarray  # shape (n_u,): as for `stiffmbs.linear_analysis.modes.natural_modes`


Point = tuple[Found, int]
"""Modes at a value, and the number of one of them."""


@dataclass(frozen=True, eq=False)
class Branch:
    """A mode followed over the parameter.

    Attributes
    ----------
    eigenvalues : array, shape (n,)
        Eigenvalue with positive imaginary part at each value, 1/s; NaN where the mode does not exist.
    damping_ratios : array, shape (n,)
    growth : array, shape (n,)
        Largest real part of the eigenvalues of the mode, 1/s.
    whirl : array, shape (n,)
        1 for forward whirl on circles, -1 for backward whirl, 0 for motion in a plane; NaN without rotation.
    participation : mapping of str to float
        Part of each body in the kinetic energy at the first value, largest first.
    """

    eigenvalues: np.ndarray
    damping_ratios: np.ndarray
    growth: np.ndarray
    whirl: np.ndarray
    participation: dict[str, float]

    @property
    def frequencies(self) -> np.ndarray:
        """Damped natural frequencies, Hz, shape (n,)."""
        return np.asarray(np.abs(self.eigenvalues.imag) / (2 * np.pi))


@dataclass(frozen=True)
class Crossing:
    """Value of the parameter at which a branch meets a condition.

    Attributes
    ----------
    value : float
    branch : int
        Number of the branch; 1 for the first.
    frequency : float
        Damped natural frequency there, Hz.
    whirl : float
        As for `Branch`.
    growing : bool
        True if the real part of the eigenvalue increases with the parameter.
    """

    value: float
    branch: int
    frequency: float
    whirl: float
    growing: bool

    def as_dict(self) -> dict[str, object]:
        """Return the numbers for JSON."""
        direction = None if np.isnan(self.whirl) else self.whirl
        return {"value": self.value, "branch": self.branch, "frequency": self.frequency, "whirl": direction}


@dataclass(frozen=True, eq=False)
class Campbell(CampbellMethods):
    """Modes over a parameter.

    Attributes
    ----------
    name : str
    parameter : str
    unit : str
        SI unit of the parameter; empty if it has none.
    values : array, shape (n,)
        Values of the parameter at which there are modes.
    branches : tuple of Branch
        By frequency at the first value.
    notes : tuple of str
        Values without modes, and notes on the states, one sentence each.
    """

    name: str
    parameter: str
    unit: str
    values: np.ndarray
    branches: tuple[Branch, ...]
    notes: tuple[str, ...]
    _at: Callable[[float], Found] = field(repr=False)
    _found: tuple[Found, ...] = field(repr=False)
    _numbers: tuple[tuple[int | None, ...], ...] = field(repr=False)  # of each branch, its mode at each value

    def critical(self, order: float = 1.0) -> tuple[Crossing, ...]:
        """Return the critical speeds: where a damped natural frequency is a multiple of the parameter, an angular velocity in rad/s.

        Parameters
        ----------
        order : float
            The multiple: 1 for an unbalance, 2 for a cracked shaft, the number of blades.
        """

        def above_line(value: float, mode: Mode) -> float:
            return abs(mode.eigenvalues[0].imag) - order * abs(value) if mode.frequency or value else np.nan

        return _by_value(
            self._crossing(number, {a[0].value: a, b[0].value: b}, above_line)[0]
            for number, a, b in self._changes(above_line)
        )

    @cached_property
    def _largest(self) -> float:
        sizes = [abs(value) for found in self._found for mode in found.modes for value in mode.eigenvalues]
        return max(sizes, default=0.0)

    def rounding(self, sizes: np.ndarray | float) -> np.ndarray | float:
        """Return the real parts, 1/s, up to which eigenvalues of given magnitudes count as ones without growth."""
        return growth_by_rounding(sizes, self._largest)

    def limits(self) -> tuple[Crossing, ...]:
        """Return the limits of stability: where the largest real part of a mode's eigenvalues becomes positive, or no longer is.

        Real parts within rounding count as stable. The real part itself decides if it is larger at both ends. It jumps where
        modes meet or their real eigenvalues form other pairs: the number of growing eigenvalues then decides.
        """

        def growth(_: float, mode: Mode) -> float:
            return _fastest(mode).real

        def beyond_rounding(_: float, mode: Mode) -> float:
            fastest = _fastest(mode)
            return float(fastest.real - self.rounding(abs(fastest)))

        def is_rounding(point: Point | None) -> bool:
            if point is None:
                return True
            fastest = _fastest(point[0].modes[point[1]])
            return bool(abs(fastest.real) <= self.rounding(abs(fastest)))

        def kept(points: Sequence[Point | None]) -> Sequence[Point | None]:
            """Return the points without a single one that is a limit itself."""
            near = [is_rounding(point) for point in points]
            return [point for k, point in enumerate(points) if near[max(k - 1, 0) : k + 2] != [False, True, False]]

        found = []
        for number, a, b in self._changes(beyond_rounding, kept):
            measure = beyond_rounding if is_rounding(a) or is_rounding(b) else growth
            crossing, jumps = self._crossing(number, {a[0].value: a, b[0].value: b}, measure)
            if not jumps:
                found.append(crossing)
            elif self._growing(a[0]) != self._growing(b[0]):
                found.append(self._change(number, a[0], b[0]))
        return _by_value(found)

    def _growing(self, found: Found) -> int:
        """Return the number of eigenvalues with growth."""
        values = np.array([value for mode in found.modes for value in mode.eigenvalues])
        return int(np.sum(values.real > self.rounding(np.abs(values))))

    def _changes(
        self, measure: Measure, kept: Callable[[Sequence[Point | None]], Sequence[Point | None]] = tuple
    ) -> Iterator[tuple[int, Point, Point]]:
        """Yield the number of a branch and neighbouring points of it between which a measure changes its sign.

        `kept`: of the points of a branch, those that are neighbours.
        """
        for number, branch in enumerate(self._numbers, start=1):
            points = [None if k is None else (one, k) for one, k in zip(self._found, branch, strict=True)]
            for a, b in pairwise(kept(points)):
                if a is None or b is None:
                    continue
                sides = [measure(one.value, one.modes[k]) for one, k in (a, b)]
                if (sides[0] < 0.0) != (sides[1] < 0.0) and not np.isnan(sides).any():
                    yield number, a, b

    def _change(self, number: int, low: Found, high: Found) -> Crossing:
        """Return the value between two others at which the number of growing eigenvalues changes, by bisection."""
        precision, fewest = FINE * (high.value - low.value), self._growing(low)
        growing = self._growing(high) > fewest
        with suppress(AssemblyError, SolverError):
            while high.value - low.value > precision:
                middle = self._at((low.value + high.value) / 2)
                low, high = (middle, high) if self._growing(middle) == fewest else (low, middle)
        after = high if growing else low
        rates = [(_fastest(mode).real, k) for k, mode in enumerate(after.modes)]
        _, mode = min((each for each in rates if each[0] > self.rounding(each[0])), default=max(rates))
        return Crossing((low.value + high.value) / 2, number, after.modes[mode].frequency, after.whirl[mode], growing)

    def _crossing(self, number: int, known: dict[float, Point], measure: Measure) -> tuple[Crossing, bool]:
        """Return the zero of a measure between neighbouring values, and True if the measure jumps there.

        It is found by modes at values between them; `known`: those of the ends.
        """

        def measured(value: float) -> float:
            """Return the measure of the mode at a value."""
            if value not in known:
                (found, mode), between = nearest(value), self._at(value)
                before = found.modes[mode]
                same = continued([before], [before.eigenvalues[0]], between.modes, found.scale)
                known[value] = between, same[0]
            found, mode = known[value]
            result = measure(value, found.modes[mode])
            if np.isnan(result):
                raise SolverError(f"mode {number} does not oscillate at {self.parameter} = {value:g}")
            return result

        def nearest(value: float) -> Point:
            return known[min(known, key=lambda each: abs(each - value))]

        low, high = sorted(known)
        sides = measured(low), measured(high)
        by_line = low + (high - low) * sides[0] / (sides[0] - sides[1])
        jumps = False
        try:
            value = float(brentq(measured, low, high, xtol=FINE * (high - low)))
            around = [
                measured(min(side, key=lambda each: abs(each - value)))
                for side in (
                    [each for each in known if measured(each) < 0.0],
                    [each for each in known if measured(each) >= 0.0],
                )
            ]
            jumps = min(map(abs, around)) > np.sqrt(FINE) * max(map(abs, sides))  # to another mode
            if jumps:
                value = by_line
        except (AssemblyError, SolverError):  # no such mode between
            value = by_line
        found, mode = nearest(value)
        return Crossing(value, number, found.modes[mode].frequency, found.whirl[mode], sides[1] > sides[0]), jumps

    def __repr__(self) -> str:
        return f"<Campbell {self.name or 'model'}: {len(self.branches)} modes over {self.parameter}, {len(self.values)} values>"

    @property
    def is_speed(self) -> bool:
        """Return True if the parameter has the unit of an angular velocity."""
        return self.unit == DIMENSIONS["angular velocity"][1]

    def as_dict(self, scene: str, orders: Sequence[float] | None = None) -> dict[str, object]:
        """Return the content of ``stiffmbs modes --over ... --json``; `scene` is the file or name of the scene."""
        return {
            "scene": scene, "parameter": self.parameter, "unit": self.unit, "values": self.values.tolist(),
            "branches": [
                {
                    "frequency": _listed(branch.frequencies), "damping": _listed(branch.damping_ratios), "whirl": _listed(branch.whirl),
                    "eigenvalue": [[_number(value.real), _number(value.imag)] for value in branch.eigenvalues.tolist()],
                    "participation": branch.participation,
                }
                for branch in self.branches
            ],
            "critical": {f"{order:g}": [each.as_dict() for each in self.critical(order)] for order in self.orders(orders)},
            "limits": [{**each.as_dict(), "stable": "below" if each.growing else "above"} for each in self.limits()],
            "notes": list(self.notes),
        }  # fmt: skip

    def orders(self, asked: Sequence[float] | None) -> Sequence[float]:
        """Return the multiples of the parameter that are shown: those that were asked for, by default 1 of an angular velocity."""
        return asked if asked is not None else (1.0,) if self.is_speed else ()


def _by_value(crossings: Iterable[Crossing]) -> tuple[Crossing, ...]:
    return tuple(sorted(crossings, key=lambda each: each.value))


def _fastest(mode: Mode) -> complex:
    """Return the eigenvalue with the largest real part, 1/s."""
    return max(mode.eigenvalues, key=lambda each: each.real)


def _listed(values: np.ndarray) -> list[float | None]:
    return [_number(value) for value in values.tolist()]


def _number(value: float) -> float | None:
    return None if np.isnan(value) else value


@takes_settings
def campbell(
    model: str | Path | Callable[[float], Runnable],
    parameter: str,
    values: str | Range | Variation | Sequence[float],
    settings: RunSettings | None = None,
    at: float | None = None,
    tell: Tell | None = None,
    changes: Sequence[tuple[str, str]] = (),
    **other: Unpack[Settings],
) -> Campbell:
    """Compute modes over a parameter, such as the speed of a rotor (Campbell diagram) or of a vehicle (root locus).

    Modes of neighbouring values are joined by their shapes and eigenvalues.  The modes of a rotor are in ground axes.

    Parameters
    ----------
    model : str, Path or callable
        A scene's file, or a function of a value that returns a model, a scene or a file's name.
    parameter : str
        A parameter of the scene, or the path of any of its values; for a function, any name.
    values : sequence of float, Range or str
        Values of the parameter, SI units, or text with units such as ``"0:6000 rpm:61"``; without a count there are 51.
    settings : RunSettings, optional
        Settings of the run to the state; by default those of the scene.
    at : float, optional
        Time of the state, s; the start of the run by default.
    tell : callable, optional
        Called with a line for each value.
    changes : sequence of (path, text)
        Values that replace those of the file, as for `stiffmbs.load_scene`.
    **other
        Fields of the settings to change.

    Returns
    -------
    Campbell

    Raises
    ------
    InputError
        As for `stiffmbs.run`, or if there are fewer than two values.
    AssemblyError, SolverError
        As for `stiffmbs.modes`, if there are modes at no value.

    Examples
    --------
    >>> found = stiffmbs.campbell("examples/beams/rotor.yaml", "spin", "0:400 rad/s:41", changes=[("unbalance", "0")])
    >>> [crossing.value for crossing in found.critical()]
    """
    varied = variation(parameter, values)
    numbers = tuple(dict.fromkeys(numbers_of(varied, COUNT - 1, COUNT)))
    if len(numbers) < 2:
        raise InputError(f"{parameter}: found one value, expected two or more")
    made = model if callable(model) else with_parameter(model, parameter, changes, varied.dimension)
    at_value = partial(_at_value, made, partial(modes, settings=settings, at=at, **other))
    found, notes = list[Found](), list[Note]()
    refused: Exception | None = None
    for value in numbers:
        if tell:
            tell(f"{parameter} = {value:.6g}")
        try:
            one, of_state = at_value(value)
        except (AssemblyError, SolverError) as reason:
            refused = reason
            notes.append(LEFT_OUT("", parameter=parameter, value=value, reason=str(reason)))
            continue
        found.append(one)
        kinds = {(note.kind, note.element) for note in notes}
        notes += [note for note in of_state if (note.kind, note.element) not in kinds]
    if not found:
        raise refused or InputError(f"{parameter}: found no values")
    name, unit = data_of(made(numbers[0])).name, named_unit(varied.dimension) if varied.dimension else ""
    branches = tuple(_joined(found))
    return Campbell(
        name, parameter, unit, np.array([one.value for one in found]), tuple(_branch(found, each) for each in branches), tuple(notes),
        lambda value: at_value(value)[0], tuple(found), branches,
    )  # fmt: skip


def _at_value(
    made: Callable[[float], Runnable], compute: Callable[[Runnable], Modes], value: float
) -> tuple[Found, Sequence[Note]]:
    """Return the modes at a value of the parameter, and the notes on its state."""
    found = compute(made(value))
    system, dynamics = found.about.dynamics.system, found.about.dynamics
    scale = system.per_velocity(system.size, 1.0)
    if system.of_body.dimensions == 3:
        velocities = found.own_axes.T @ dynamics.state.u
        parts = (np.array([mode.participation.get(body, 0.0) for body in system.bodies]) for mode in found.modes)
        directions = tuple(
            whirl(mode.shape, velocities, scale, part) for mode, part in zip(found.modes, parts, strict=True)
        )
    else:
        directions = (float("nan"),) * len(found.modes)
    return Found(value, found.modes, directions, scale), [Note.of(note) for note in found.notes]


def _joined(found: Sequence[Found]) -> Iterator[tuple[int | None, ...]]:
    """Yield the branches: the number of the mode at each value, None where a branch does not exist."""
    branches: list[list[int | None]] = [[k] for k in range(len(found[0].modes))]
    for k, (before, after) in enumerate(pairwise(found)):
        present = [branch for branch in branches if branch[k] is not None]
        modes_before = [before.modes[branch[k]] for branch in present]  # type: ignore[index]
        expected = [_expected(found, branch, after.value) for branch in present]
        same = len(before.scale) == len(after.scale)
        pairs = continued(modes_before, expected, after.modes, after.scale) if same else {}
        of_branch = {id(present[row]): column for row, column in pairs.items()}
        for branch in branches:
            branch.append(of_branch.get(id(branch)))
        new = set(range(len(after.modes))) - set(pairs.values())
        branches += [[*[None] * (k + 1), number] for number in sorted(new)]
    yield from map(tuple, branches)


def _expected(found: Sequence[Found], branch: Sequence[int | None], value: float) -> complex:
    """Return the eigenvalue of a branch at the next value, extrapolated from the last two."""
    last = found[len(branch) - 1]
    now = last.modes[branch[-1]].eigenvalues[0]  # type: ignore[index]
    if len(branch) < 2 or branch[-2] is None:
        return now
    before = found[len(branch) - 2]
    rate = (now - before.modes[branch[-2]].eigenvalues[0]) / (last.value - before.value)
    return now + rate * (value - last.value)


def _branch(found: Sequence[Found], numbers: Sequence[int | None]) -> Branch:
    def column(of: Callable[[Found, int], complex], kind: type) -> np.ndarray:
        nothing = complex(np.nan, np.nan) if kind is complex else np.nan
        return np.array(
            [nothing if k is None else of(one, k) for one, k in zip(found, numbers, strict=True)], dtype=kind
        )

    first = next((one, k) for one, k in zip(found, numbers, strict=True) if k is not None)
    return Branch(
        column(lambda one, k: one.modes[k].eigenvalues[0], complex),
        column(lambda one, k: one.modes[k].damping_ratio, float),
        column(lambda one, k: _fastest(one.modes[k]).real, float),
        column(lambda one, k: one.whirl[k], float),
        first[0].modes[first[1]].participation,
    )
