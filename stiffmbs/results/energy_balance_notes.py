"""Sentences on the energy balance and on the ranges of channels of a run.

With conservative forces alone, kinetic + potential energy is constant at any instants.  The work of dampers, drives and
friction is integrated from values at the output instants, which may miss a contact in between.  It is therefore judged
only where several instants lie within one step of the solver.  There the motion is a smooth polynomial, and so is the
power unless the step missed an event.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

import numpy as np

from ..compile.system import System
from ..dynamics.dynamics import OutputRows
from ..dynamics.storage import with_gaps
from ..model.settings import RunSettings
from ..reading.files.quoted import MOST_LISTED
from ..solve.settings import traits_of
from .energy_balance import BROKEN, Balance, potentials

ACTING = "load"
"""Channel that is zero if the element does not act; its other channels are then ignored."""


def range_notes(
    ranges: Mapping[str, Mapping[str, tuple[float, float]]], series: Callable[[str], np.ndarray]
) -> Iterator[str]:
    """Yield a sentence for each element, with the extremes of its channels outside their ranges.

    `ranges`: valid ranges by element and channel. `series`: returns the values of a channel at the output times.
    """
    for name, of_element in ranges.items():
        acts = series(f"{name}.{ACTING}") > 0 if ACTING in of_element else slice(None)
        found = [
            sentence
            for channel, (low, high) in of_element.items()
            if (sentence := _beyond(channel, series(f"{name}.{channel}")[acts], low, high))
        ]
        if found:
            yield f"'{name}' leaves the valid ranges of its data: {', '.join(found)}"


def _beyond(channel: str, values: np.ndarray, low: float, high: float) -> str:
    """Return a clause with the extremes of a channel and its range, or an empty string within it."""
    values = values[np.isfinite(values)]
    if not len(values) or (low <= values.min() and values.max() <= high):
        return ""
    reached = [x for x, beyond in ((values.min(), values.min() < low), (values.max(), values.max() > high)) if beyond]
    return f"{channel} reaches {' and '.join(f'{x:.4g}' for x in reached)} (valid from {low:.4g} to {high:.4g})"


def undefined_values(rows: OutputRows, channels: Mapping[str, np.ndarray]) -> Iterator[str]:
    """Yield a sentence for each channel with NaN or infinite values at solved instants, and one for all beyond the first few."""
    solved = ~np.isnan(rows.position_violation)  # the other instants are reported as left out
    time = rows.t[solved]
    found = {name: ~np.isfinite(values[solved]) for name, values in with_gaps(channels).items()}
    found = {name: bad for name, bad in found.items() if np.any(bad)}
    for name in list(found)[:MOST_LISTED]:
        bad = found[name]
        first = float(time[np.argmax(bad)])
        yield f"{name} is not finite at {np.count_nonzero(bad)} of {len(time)} output times, first at t = {first:.9g} s"
    if len(found) > MOST_LISTED:
        yield f"{len(found) - MOST_LISTED} more channels are not finite at some output times"


FINER = ("rtol", "max_step", "step")
"""Settings that shorten steps."""
PER_TOLERANCE = 100.0
"""Missing part of the exchanged energy that is accepted, in relative tolerances, if that is more than `BROKEN`."""
REPORTED = 1e-6
"""Part of the exchanged energy above which work between output instants is reported."""
CERTAIN = 3.0
"""Ratio of missing energy to the resolution of the quadrature, such as its end corrections, above which it counts."""
OF_TOLERANCE = 10.0
"""Factor on the work of the largest force along a position error of the tolerance; smaller energies are ignored."""
OF_POTENTIAL = 1e-10
"""Part of the largest potential energy below which energies are ignored."""


def balance_words(balance: Balance, start: float) -> str:
    """Return the energy balance as a summary prints it, from the energy at the start, J."""
    change, work = float(balance.change[-1]), float(balance.work[-1])
    if balance.keeps_energy:
        return f"{start:.9g} J; changes by at most {balance.imbalance:.3g} J"
    coarse = max(balance.resolved, balance.between) > balance.imbalance
    error = balance.furthest if coarse else balance.imbalance
    return (
        f"{start:.9g} J -> {start + change:.9g} J; non-conservative work {work:.6g} J; "
        f"balance error {error:.2g} J{' (the output times do not resolve the work)' if coarse else ''}"
    )


def unresolved_work(balance: Balance) -> str:
    """Return a note on the work between output times that their values do not resolve, or an empty string."""
    if balance.keeps_energy or balance.between <= max(REPORTED * balance.scale, balance.imbalance):
        return ""
    return f"between output times {balance.between:.2g} J of work is not resolved; use 'points: steps' or --verify"


def balance_notes(
    system: System, balance: Balance, rows: OutputRows, settings: RunSettings, steps: np.ndarray
) -> Iterator[str]:
    """Yield a sentence if a balance is certainly broken.

    `steps`: ends of the solver's own steps, s; empty if unknown.
    """
    allowed = may_be_missing(system, balance, rows, settings)
    if balance.keeps_energy:
        yield from _changed(system, balance, rows, settings, allowed)
    else:
        yield from _left(system, balance, rows, steps, allowed)


def may_be_missing(system: System, balance: Balance, rows: OutputRows, settings: RunSettings) -> float:
    """Return the energy that may be missing in a balance before it is reported, J."""
    return _accepted(settings) * balance.scale + _negligible(system, rows, settings)


def _accepted(settings: RunSettings) -> float:
    """Return the part of the exchanged energy that may be missing."""
    return BROKEN if traits_of(settings).fixed_steps else max(BROKEN, PER_TOLERANCE * settings.rtol)


def _negligible(system: System, rows: OutputRows, settings: RunSettings) -> float:
    """Return the energy below tolerance and rounding, J."""
    with np.errstate(all="ignore"):
        force = np.nanmax(np.abs(rows.values[:, system.term("output", "reaction").source]), initial=0.0)
        weight = np.nanmax(np.abs(system.mass[None, :] * rows.acceleration[:1]), initial=0.0)
        stored = np.nanmax(np.abs(rows.values[:, system.term("output", "potential").source]), initial=0.0)
    return float(OF_TOLERANCE * settings.rtol * system.size * max(force, weight) + OF_POTENTIAL * stored)


def _changed(
    system: System, balance: Balance, rows: OutputRows, settings: RunSettings, allowed: float
) -> Iterator[str]:
    """Yield a sentence for a conservative scene: the time at which its energy first changes too much."""
    beyond = np.flatnonzero(np.abs(balance.open) > allowed)
    if len(beyond):
        allowed += _accepted(settings) * _exchanged_between(system, balance, rows)
        beyond = beyond[np.abs(balance.open[beyond]) > allowed]
    if not len(beyond):
        return
    finer = [name for name in FINER if name in traits_of(settings).reads]
    remedy = f"; use a smaller {' or '.join(finer)}" if finer else ""
    steepest = int(np.argmax(np.abs(np.diff(balance.open))))
    yield (
        f"the energy balance is broken: all forces are conservative, but the energy changes by "
        f"{balance.imbalance:.3g} J of the {balance.scale:.3g} J exchanged (first by more than {allowed:.2g} J at "
        f"t = {balance.t[beyond[0]]:.6g} s{_where(system, balance, rows, steepest)}){remedy}"
    )


def _exchanged_between(system: System, balance: Balance, rows: OutputRows) -> float:
    """Return a bound of the energy that forces at the instants may exchange between instants several steps apart, J.

    At turning points, instants have no kinetic energy. From there, forces act until half of the interval, at most along
    the size of the mechanism, or 1 rad.
    """
    apart = balance.steps > 1
    if not apart.any():
        return 0.0
    acceleration = np.abs(rows.acceleration[np.searchsorted(rows.t, balance.t[:-1][apart])])
    half = 0.5 * np.diff(balance.t)[apart, None]
    along = np.minimum(0.5 * acceleration * half**2, system.per_velocity(system.size, 1.0))
    return float(np.max(np.sum(system.mass * acceleration * along, axis=1)))


def _left(system: System, balance: Balance, rows: OutputRows, steps: np.ndarray, allowed: float) -> Iterator[str]:
    """Yield a sentence for any other scene: the interval within one solver step with the most missing energy."""
    inside = within_steps(balance.t[:-1], balance.t[1:], steps)
    missing = np.abs(np.diff(balance.open))
    missing = np.where(inside & (missing > CERTAIN * np.abs(balance.within)), missing, 0.0)
    if not len(missing) or missing.max() <= allowed:
        return
    k = int(np.argmax(missing))
    yield (
        f"the energy balance is broken: {missing[k]:.3g} J of the {balance.scale:.3g} J exchanged are missing between "
        f"t = {balance.t[k]:.6g} s and {balance.t[k + 1]:.6g} s, within one step of the solver"
        f"{_where(system, balance, rows, k)}; set max_step to less than {balance.t[k + 1] - balance.t[k]:.2g} s"
    )


def within_steps(begin: np.ndarray, end: np.ndarray, steps: np.ndarray) -> np.ndarray:
    """Return True for each interval between two instants that lies strictly inside one step of the solver."""
    if not len(steps):
        return np.zeros(len(begin), dtype=bool)
    after, before = np.searchsorted(steps, begin, side="right"), np.searchsorted(steps, end, side="left")
    last = len(steps) - 1
    begun, ended = steps[np.maximum(after - 1, 0)] < begin, steps[np.minimum(before, last)] > end
    return (after == before) & (after > 0) & (before <= last) & begun & ended


def _where(system: System, balance: Balance, rows: OutputRows, k: int) -> str:
    """Return a clause on the element whose potential energy changes most in an interval."""
    at = np.searchsorted(rows.t, balance.t[k : k + 2])
    changes = {
        name: float(abs(np.diff(values[at])[0]))
        for name, values in potentials(system, rows.values).items()
        if name not in system.bodies
    }
    name = max(changes, key=lambda each: changes[each], default="")
    return f", at '{name}'" if name and changes[name] > 0.1 * abs(float(np.diff(balance.open)[k])) else ""
