"""Conclusions of a comparison, in sentences."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from .at_error import AtError
from .measures import MEASURES
from .plan import Entry

if TYPE_CHECKING:
    from .compare import Comparison
    from .comparison_over import ComparisonOver

ALIKE = 1.1
"""Factor within which times are equal up to noise."""


def conclusion(comparison: Comparison) -> str:
    """Return the fastest solvers at each error, with ratios, and the cost of solvers that choose between others."""
    unit = MEASURES[comparison.measure].unit
    racing, choosing = _sides(comparison.entries)
    runs = [
        (names, list(run))
        for names, run in itertools.groupby(comparison.at_errors, key=lambda at: _fastest(at, racing))
        if names
    ]
    if not runs:
        return "no times at equal errors: no solver was measured on both sides of a power of ten of the error"
    parts = []
    for names, run in runs:
        errors = f"{run[0].error:.0e}" if len(run) == 1 else f"{run[0].error:.0e} to {run[-1].error:.0e}"
        parts.append(f"at an error of {errors} {unit} {_are_fastest(names, run, racing)}")
    return "; ".join([*parts, *_choices(comparison.at_errors, racing, choosing)])


def _sides(entries: Sequence[Entry]) -> tuple[list[str], list[str]]:
    """Return the names of the compared solvers, and of those that choose between them."""
    racing = [entry.name for entry in entries if not entry.chooses]
    choosing = [entry.name for entry in entries if entry.chooses]
    return (racing, choosing) if racing else (choosing, [])


def _fastest(at: AtError, racing: Sequence[str]) -> tuple[str, ...]:
    """Return the fastest of some solvers, and those that are equal up to noise."""
    times = {name: at.seconds[name] for name in racing if name in at.seconds}
    most = ALIKE * min(times.values(), default=0.0)
    return tuple(name for name, seconds in times.items() if seconds <= most)


def _are_fastest(names: Sequence[str], run: Sequence[AtError], racing: Sequence[str]) -> str:
    """Return the fastest solvers and their ratio to the best of the others; for a single solver, its time."""
    if len(racing) == 1:
        return f"{racing[0]} takes {_span([1e3 * at.seconds[racing[0]] for at in run])} ms"
    who = (
        f"{names[0]} is the fastest" if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]} are equally fast"
    )
    found = []
    for at in run:
        others = {name: at.seconds[name] for name in racing if name in at.seconds and name not in names}
        if others:
            following = min(others, key=lambda name: others[name])
            found.append((others[following] / min(at.seconds[name] for name in names), following))
    if not found and len(names) == len(racing):
        return who
    if not found:
        times = _span([1e3 * min(at.seconds[name] for name in names) for at in run])
        return f"only {' and '.join(names)} {'has a time' if len(names) == 1 else 'have times'}, {times} ms"
    after = " or ".join(dict.fromkeys(name for _, name in found))
    return f"{who}, {_span([ratio for ratio, _ in found])} times as fast as {after}"


def _choices(found: Sequence[AtError], racing: Sequence[str], choosing: Sequence[str]) -> Iterator[str]:
    """Yield the times of solvers that choose, relative to the fastest."""
    for name in choosing:
        ratios = [
            at.seconds[name] / min(at.seconds[other] for other in racing if other in at.seconds)
            for at in found
            if name in at.seconds and any(other in at.seconds for other in racing)
        ]
        if ratios:
            span = _span(ratios)
            yield f"{name} takes {'' if span == '1' else f'{span} times '}as long as the fastest"


def _span(ratios: Sequence[float]) -> str:
    least, most = f"{min(ratios):.2g}", f"{max(ratios):.2g}"
    return least if least == most else f"{least} to {most}"


def conclusion_over(comparison: ComparisonOver) -> str:
    """Return the ranges in which each kind of integrator is faster."""
    racing, choosing = _sides(comparison.entries)
    times = [at for at in comparison.at if at is not None]
    sentences = [*_crossing_sentences(comparison), *_choices(times, racing, choosing)]
    return f"at an error of {comparison.error:g} {MEASURES[comparison.measure].unit} " + "; ".join(sentences)


def _crossing_sentences(comparison: ComparisonOver) -> Iterator[str]:
    parameter = comparison.parameter
    for crossing in comparison.crossings:
        where = (
            f"about {crossing.at:.1e}"
            if crossing.measured
            else f"between {crossing.between[0]:.4g} and {crossing.between[1]:.4g}"
        )
        yield f"{crossing.then} is faster than {crossing.before} from {parameter} {where} on"
    if comparison.crossings:
        return
    times = [at for at in comparison.at if at is not None]
    racing, _ = _sides(comparison.entries)
    faster = list(dict.fromkeys(names for at in times if (names := _fastest(at, racing))))
    if len(faster) == 1:
        yield f"over all of {parameter} {_are_fastest(faster[0], times, racing)}"
    else:
        yield f"neither implicit nor explicit steps take over along {parameter}"
