"""Concatenation of solutions in time."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import astuple, replace

import numpy as np

from ..notes import Note
from ..solve.trajectory import IN_DOUBT, History
from .digits import KnownErrors
from .energy_balance import Balance, ElementEnergy
from .error_bars import RESOLVED, ErrorBar, ErrorEstimate
from .scales import MECHANICAL, ROUNDING, kind_of
from .solution import Solution

SAME_VALUE = 1e-6
"""Difference up to which two values are equal, relative to the largest value of channels of that kind."""
VIOLATIONS = "constraint."
COUNTED = (
    "steps", "residuals", "jacobians", "factorizations", "error_test_failures", "convergence_failures", "newton_iterations",
    "newton_failures", "rejected", "accelerations", "breakpoints", "events", "moves", "seconds",
)  # fmt: skip
"""Solver statistics that are added up; of others the value of the last run is kept."""


def joined(name: str, solutions: Sequence[Solution]) -> Solution:
    """Join the results of runs that follow each other in time.

    At each transition there are two rows of one time, before and after it; only the second is kept if no channel
    changes. Channels that a run lacks are zero if they are forces or torques of an element, otherwise nan. `solutions`:
    at least one.
    """
    first = solutions[0]
    if len(solutions) == 1:
        return replace(first, name=name)
    channels = list(dict.fromkeys(channel for solution in solutions for channel in solution.channels))
    turns = list(dict.fromkeys(key for solution in solutions for key in solution.turns))
    requested = {key: unit for solution in solutions for key, unit in solution.requested.items()}
    kept = _kept_rows(solutions)
    pairs = list(zip(solutions, kept, strict=True))
    found = Solution(
        name=name,
        time=np.concatenate([s.time[rows] for s, rows in pairs]),
        channels={
            channel: np.concatenate([_values(s, channel, requested)[rows] for s, rows in pairs]) for channel in channels
        },
        outcome=solutions[-1].outcome,
        message=_message(solutions),
        notes=_notes([s.notes for s in solutions]),
        solver=_statistics(solutions),
        history=History(
            np.concatenate([s.history.t for s in solutions]), np.concatenate([s.history.order for s in solutions])
        ),
        balance=_balance([s.balance for s in solutions]),
        not_unique=tuple(dict.fromkeys(channel for s in solutions for channel in s.not_unique)),
        requested=requested,
        presolve=_notes([s.presolve for s in solutions]),
        figure=first.figure,
        display=first.display,
        provenance=first.provenance,
        turns={
            key: np.concatenate([s.turns.get(key, np.full(len(s.time), np.nan))[rows] for s, rows in pairs])
            for key in turns
        },
        errors=_bars(solutions, channels) if all(s.errors for s in solutions if s.estimate) else {},
    )
    return replace(found, estimate=_estimate(found, [s.estimate for s in solutions]))


def _kept_rows(solutions: Sequence[Solution]) -> list[slice]:
    """Return the rows of each solution, without the last row if the next solution starts with the same values."""
    sizes: dict[str, float] = {}
    for solution in solutions:
        for name, values in solution.channels.items():
            kind = kind_of(name) or name
            sizes[kind] = max(sizes.get(kind, 0.0), float(np.nanmax(np.abs(values), initial=0.0)))
    force, torque = (sizes.get(kind, 0.0) for kind in MECHANICAL)  # a zero one is rounding of the other
    length = sizes.get("position") or 1.0
    sizes["force"], sizes["torque"] = max(force, ROUNDING * torque / length), max(torque, ROUNDING * force * length)
    found = []
    for before, after in itertools.pairwise(solutions):
        same = before.time[-1] == after.time[0] and before.channels.keys() == after.channels.keys()
        found.append(slice(None, -1 if same and _goes_on(before, after, sizes) else None))
    return [*found, slice(None)]


def _goes_on(before: Solution, after: Solution, sizes: Mapping[str, float]) -> bool:
    """Return True if all channels continue from one solution to the next; `sizes` are those of their kinds."""
    return all(
        np.isclose(
            values[-1], after.channels[name][0], rtol=0, atol=SAME_VALUE * sizes[kind_of(name) or name], equal_nan=True
        )
        for name, values in before.channels.items()
        if not name.startswith(VIOLATIONS)
    )


def _values(solution: Solution, channel: str, requested: Iterable[str]) -> np.ndarray:
    if channel in solution.channels:
        return solution.channels[channel]
    there = kind_of(channel) not in MECHANICAL or channel in requested
    return np.full(len(solution.time), np.nan if there else 0.0)


def _bars(solutions: Sequence[Solution], channels: Sequence[str]) -> dict[str, ErrorBar]:
    """Return the error bars of channels over all runs; those of a peak are from the run that has it."""
    found = {}
    for name in channels:
        parts = [s for s in solutions if name in s.errors]
        if not parts:
            continue
        least = min(parts, key=lambda s: float(np.nanmin(s.channels[name], initial=np.inf))).errors[name]
        greatest = max(parts, key=lambda s: float(np.nanmax(s.channels[name], initial=-np.inf))).errors[name]
        over_time = float(np.max([s.errors[name].over_time for s in parts]))
        found[name] = ErrorBar(
            over_time, least.least, greatest.greatest, least.sampled_least, greatest.sampled_greatest
        )
    return found


def _estimate(joined: Solution, of_runs: Sequence[ErrorEstimate | None]) -> ErrorEstimate | None:
    """Return the estimate over all runs; each begins with the errors of the one before it, which it does not know."""
    estimates = [each for each in of_runs if each]
    if not estimates:
        return None
    others = [each for each in estimates if each.status != "estimated"]
    if others:
        status = next((each.status for each in others if each.status == "lost"), others[0].status)
        return ErrorEstimate(status, "; ".join(_notes([[each.sentence] if each else [] for each in of_runs])))
    largest = (max(getattr(each, name) for each in estimates) for name in RESOLVED)
    resolved = ErrorEstimate("estimated", "", **dict(zip(RESOLVED, largest, strict=True)))
    found = KnownErrors(replace(joined, estimate=resolved)).estimate()
    found = replace(found, sentence=f"{found.sentence}; of each run alone, without the errors of those before it")
    reached = _notes([[each.reached] if each and each.reached else [] for each in of_runs])
    return found.with_accuracy("; ".join(reached))


def _notes(of_runs: Sequence[Sequence[str]]) -> tuple[Note, ...]:
    """Return each note once, with the numbers of its runs unless all have it."""
    all_of_them = dict.fromkeys(sentence for sentences in of_runs for sentence in sentences)
    found = []
    for sentence in all_of_them:
        runs = [str(k) for k, sentences in enumerate(of_runs, start=1) if sentence in sentences]
        place = "" if len(runs) == len(of_runs) else f"run{'s' if len(runs) > 1 else ''} {', '.join(runs)}: "
        found.append(Note.of(sentence).after(place))
    return tuple(found)


def _statistics(solutions: Sequence[Solution]) -> dict[str, object]:
    """Return the sums of counters, and the other statistics of the last run."""
    found: dict[str, object] = {}
    for solution in solutions:
        for name, value in solution.solver.items():
            found[name] = found.get(name, 0) + value if name in COUNTED else value
    return {**found, "name": " ".join(dict.fromkeys(str(s.solver["name"]) for s in solutions))}


def _balance(balances: Sequence[Balance]) -> Balance:
    """Return the balance over all runs; changes between them are not work."""
    change, work = (_one_after_the_other([getattr(b, name) for b in balances]) for name in ("change", "work"))
    names = dict.fromkeys(name for b in balances for name in b.elements)
    return Balance(
        t=np.concatenate([b.t for b in balances]),
        change=change,
        work=work,
        scale=max(b.scale for b in balances),
        keeps_energy=all(b.keeps_energy for b in balances),
        within_steps=all(b.resolved for b in balances),
        elements={name: _sum_of_energies([b.elements[name] for b in balances if name in b.elements]) for name in names},
    )


def _sum_of_energies(parts: Sequence[ElementEnergy]) -> ElementEnergy:
    return ElementEnergy(*(sum(column) for column in zip(*map(astuple, parts), strict=True)))


def _one_after_the_other(parts: Sequence[np.ndarray]) -> np.ndarray:
    """Join histories since the start of each run into one since the start of the first."""
    found, reached = [], 0.0
    for part in parts:
        found.append(part + reached)
        reached = float(found[-1][-1]) if len(part) else reached
    return np.concatenate(found)


def _message(solutions: Sequence[Solution]) -> str:
    """Return the reason why the last run stopped, or the first note that questions a run."""
    if not solutions[-1].success:
        return solutions[-1].message
    doubtful = (solution.message for solution in solutions if IN_DOUBT in solution.message)
    return next(doubtful, f"{len(solutions)} runs: all were solved")
