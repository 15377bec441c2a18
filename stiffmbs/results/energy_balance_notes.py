"""Sentences on the energy balance and on the ranges of channels of a run.

With conservative forces alone, kinetic + potential energy is constant at any instants.  The work of dampers, drives and
friction at output times may miss what happens in between: a balance that does not close there is judged by a quadrature
within the solver's steps.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

import numpy as np

from ..compile.system import System
from ..dynamics.dynamics import OutputRows
from ..dynamics.storage import with_gaps
from ..model.settings import RunSettings
from ..notes import Note, NoteKind, Severity
from ..reading.files.quoted import MOST_LISTED
from ..solve.error_control.tolerances import absolute_tolerances
from ..solve.settings import traits_of
from .energy_balance import Balance, potentials

OUT_OF_RANGE = NoteKind("outside-valid-ranges", "'{element}' leaves the valid ranges of its data: {channels}")
NOT_FINITE = NoteKind(
    "not-finite", "{element} is not finite at {count} of {whole} output times, first at t = {first:.9g} s"
)
MORE_NOT_FINITE = NoteKind("more-not-finite", "{count} more channels are not finite at some output times")
BALANCE = NoteKind(
    "energy-balance",
    "the energy balance is broken: {forces} {imbalance:.3g} J of the {scale:.3g} J exchanged (first by more than "
    "{allowed:.2g} J at t = {first:.6g} s{where})",
    "{finer}",
    Severity.DOUBT,
)
ACTING = "load"
"""Channel that is zero if the element does not act; its other channels are then ignored."""


def range_notes(
    ranges: Mapping[str, Mapping[str, tuple[float, float]]], series: Callable[[str], np.ndarray], t: np.ndarray
) -> Iterator[Note]:
    """Yield a note for each element, with the extremes of its channels outside their ranges.

    `ranges`: valid ranges by element and channel. `series`: returns the values of a channel at the output times t, s.
    """
    for name, of_element in ranges.items():
        acts = series(f"{name}.{ACTING}") > 0 if ACTING in of_element else np.full(len(t), True)
        found = [
            sentence
            for channel, (low, high) in of_element.items()
            if (sentence := _beyond(channel, np.where(acts, series(f"{name}.{channel}"), np.nan), low, high, t))
        ]
        if found:
            yield OUT_OF_RANGE(name, channels=", ".join(found))


def _beyond(channel: str, values: np.ndarray, low: float, high: float, t: np.ndarray) -> str:
    """Return a clause with the extremes of a channel, its range, and the time outside, or an empty string within it."""
    outside = (values < low) | (values > high)  # values that are not finite are not outside
    duration = float(np.sum(np.diff(t) * (outside[1:] + outside[:-1].astype(float)) / 2))
    values = values[np.isfinite(values)]
    if not len(values) or (low <= values.min() and values.max() <= high):
        return ""
    reached = [x for x, beyond in ((values.min(), values.min() < low), (values.max(), values.max() > high)) if beyond]
    return f"{channel} reaches {' and '.join(f'{x:.4g}' for x in reached)} (valid from {low:.4g} to {high:.4g}; outside for {duration:.3g} s)"


def undefined_values(rows: OutputRows, channels: Mapping[str, np.ndarray]) -> Iterator[Note]:
    """Yield a note for each channel with NaN or infinite values at solved instants, and one for all beyond the first few."""
    solved = ~np.isnan(rows.position_violation)  # the other instants are reported as left out
    time = rows.t[solved]
    found = {name: ~np.isfinite(values[solved]) for name, values in with_gaps(channels).items()}
    found = {name: bad for name, bad in found.items() if np.any(bad)}
    for name in list(found)[:MOST_LISTED]:
        bad = found[name]
        first = float(time[np.argmax(bad)])
        yield NOT_FINITE(name, count=np.count_nonzero(bad), whole=len(time), first=first)
    if len(found) > MOST_LISTED:
        yield MORE_NOT_FINITE(count=len(found) - MOST_LISTED)


FINER = ("rtol", "max_step", "step")
"""Settings that shorten steps."""
BROKEN = 1e-2
"""Part of the exchanged energy that may be missing before it is reported."""
PER_TOLERANCE = 100.0
"""Missing part of the exchanged energy that is accepted, in relative tolerances, if that is more than `BROKEN`."""
OF_TOLERANCE = 10.0
"""Factor on the work of the largest force along a position error of the tolerance; smaller energies are ignored."""
OF_POTENTIAL = 1e-10
"""Part of the largest potential energy below which energies are ignored."""


def balance_words(balance: Balance, start: float) -> str:
    """Return the energy balance as a summary prints it, from the energy at the start, J."""
    if balance.keeps_energy:
        return f"{start:.9g} J; changes by at most {balance.imbalance:.3g} J"
    change, work = float(balance.change[-1]), float(balance.work[-1])
    bound = "" if balance.resolved else "at most "
    closer = ", a bound from the output times; 'points: steps' gives a closer one"
    is_wide = not balance.resolved and balance.imbalance > abs(change)
    return (
        f"{start:.9g} J -> {start + change:.9g} J; non-conservative work {work:.6g} J; "
        f"balance error {bound}{balance.imbalance:.2g} J{closer * is_wide}"
    )


def is_broken(system: System, balance: Balance, rows: OutputRows, settings: RunSettings) -> bool:
    """Return True if more energy is missing in a balance than may be."""
    if balance.imbalance <= BROKEN * balance.scale:
        return False
    return balance.imbalance > may_be_missing(system, balance, rows, settings)


def may_be_missing(system: System, balance: Balance, rows: OutputRows, settings: RunSettings) -> float:
    """Return the energy that may be missing in a balance before it is reported, J."""
    return _accepted(settings) * balance.scale + _negligible(system, rows, settings)


def broken_balance(system: System, balance: Balance, rows: OutputRows, settings: RunSettings) -> Note:
    """Return a note on a balance that is broken: how much is missing, since when, and where.

    `rows`: those of the balance and others.
    """
    allowed = may_be_missing(system, balance, rows, settings)
    finer = [name for name in FINER if name in traits_of(settings).reads]
    remedy = f"use a smaller {' or '.join(finer)}" if finer else ""
    steepest = int(np.argmax(np.abs(np.diff(balance.open)))) if len(balance.t) > 1 else 0
    beyond = np.flatnonzero(np.abs(balance.open) > allowed)
    first = balance.t[beyond[0] if len(beyond) else steepest]
    forces = (
        "all forces are conservative, but the energy changes by"
        if balance.keeps_energy
        else "the energy changes, apart from the work of forces, by"
    )
    return BALANCE(
        forces=forces, imbalance=balance.imbalance, scale=balance.scale, allowed=allowed, first=first,
        where=_where(system, balance, rows, steepest), finer=remedy,
    )  # fmt: skip


def _accepted(settings: RunSettings) -> float:
    """Return the part of the exchanged energy that may be missing."""
    return BROKEN if traits_of(settings).fixed_steps else max(BROKEN, PER_TOLERANCE * settings.rtol)


def _negligible(system: System, rows: OutputRows, settings: RunSettings) -> float:
    """Return the energy below tolerance and rounding, J."""
    with np.errstate(all="ignore"):
        force = np.nanmax(np.abs(rows.values[:, system.term("output", "reaction").source]), initial=0.0)
        weight = np.nanmax(np.abs(system.mass[None, :] * rows.acceleration[:1]), initial=0.0)
        stored = np.nanmax(np.abs(rows.values[:, system.term("output", "potential").source]), initial=0.0)
    resting = 0.5 * system.mass @ absolute_tolerances(system, settings)[system.n_q :] ** 2
    return float(OF_TOLERANCE * settings.rtol * system.size * max(force, weight) + OF_POTENTIAL * stored + resting)


def _where(system: System, balance: Balance, rows: OutputRows, k: int) -> str:
    """Return a clause on the element whose potential energy changes most in an interval."""
    if len(balance.t) < 2:
        return ""
    at = np.searchsorted(rows.t, balance.t[k : k + 2])
    changes = {
        name: float(abs(np.diff(values[at])[0]))
        for name, values in potentials(system, rows.values).items()
        if name not in system.bodies
    }
    name = max(changes, key=lambda each: changes[each], default="")
    return f", at '{name}'" if name and changes[name] > 0.1 * abs(float(np.diff(balance.open)[k])) else ""
