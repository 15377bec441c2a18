"""Doubts about a run from comparison with others, in sentences."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..analyses.job import Job
from ..results.error_bars import ErrorBar
from ..results.solution import Solution
from ..solve.settings import traits_of
from .dense_sampling import DenseSamples, beyond, poses_of
from .divergence import Divergence, distance, divergence
from .parameters import VERIFICATION
from .solve_again import Again


@dataclass(frozen=True)
class Comparison:
    """A run and those with which it is compared.

    Attributes
    ----------
    tighter : tuple of Again
        By the same solver, the tightest last.
    other : Again or None
        By the other solver.
    between : DenseSamples or None
        Samples between output times.
    sizes : mapping of str to float
        Scales of the channels.
    """

    job: Job
    first: Solution
    tighter: tuple[Again, ...]
    other: Again | None
    between: DenseSamples | None
    bars: Mapping[str, ErrorBar]
    sizes: Mapping[str, float]

    @property
    def acceptable(self) -> float:
        """Largest error of a peak that is not reported, relative to its scale."""
        settings = self.job.settings
        if traits_of(settings).fixed_steps:
            return VERIFICATION.visible
        return max(
            min(VERIFICATION.amplified * settings.rtol, VERIFICATION.visible), VERIFICATION.loose * settings.rtol
        )

    @cached_property
    def uncertain(self) -> dict[str, float]:
        """Channels with unacceptably uncertain peaks, the worst first, and their uncertainties in scales."""
        parts = {
            name: max(bar.least - bar.sampled_least, bar.greatest - bar.sampled_greatest) / self.sizes[name]
            for name, bar in self.bars.items()
            if self.sizes[name]
        }
        beyond = {name: part for name, part in parts.items() if part > self.acceptable}
        return dict(sorted(beyond.items(), key=lambda item: -item[1]))

    def divergences(self) -> list[Divergence | None]:
        """Return the divergences, or None, between successive tighter runs, and of the first run from the other's."""
        runs = [self.first.channels, *({name: run.reported(name) for name in self.first} for run in self.tighter)]
        pairs = [*itertools.pairwise(runs)]
        if self.other is not None:
            pairs.append((runs[0], {name: self.other.reported(name) for name in self.first}))
        found = []
        for one, two in pairs:
            count = min(len(one["energy.total"]), len(two["energy.total"]))
            found.append(divergence(self.first.time, distance(one, two, count, self.sizes)) if count else None)
        return found

    @property
    def suspicious(self) -> bool:
        """True if differences are larger than acceptable."""
        return bool(self.uncertain) or any(self.divergences())


def diagnostics(comparison: Comparison) -> Iterator[str]:
    """Yield a sentence on each doubt; nothing if the runs agree."""
    divergences = comparison.divergences()
    met = [found for found in divergences if found is not None]
    if met:
        yield _divergence_sentence(comparison, divergences, min(met, key=lambda found: found.t))
    if comparison.uncertain:
        yield _uncertain_sentence(comparison, parted=bool(met))
    missed = _missed(comparison)
    if missed and not met:
        yield _missed_sentence(comparison, missed)


def _divergence_sentence(comparison: Comparison, divergences: list[Divergence | None], first: Divergence) -> str:
    solution = comparison.between.solution if comparison.between else comparison.first
    pose = poses_of(comparison.job, solution).nearest(first.begun, first.t)
    settings = comparison.job.settings
    if pose is not None:
        where = ", ".join(
            f"{body} at {words}"
            for body, words in zip(pose.bodies[: VERIFICATION.named], pose.poses[: VERIFICATION.named], strict=True)
        )
        return (
            f"another branch: at t = {pose.t:.6g} s the mechanism passes a (nearly) singular pose ({where}); "
            f"{', '.join(pose.joints)} hold less there than elsewhere, and the motion may go on in more than one way; the runs "
            f"part there ({first.body} is elsewhere from t = {first.t:.4g} s on). Remedy: a tighter rtol until two runs "
            "agree, exact dimensions, or a gear or stop that decides the branch"
        )
    others = [comparison.other.name] if comparison.other else []
    names = ["this run", *(run.name for run in comparison.tighter), *others]
    of_levels = divergences[: len(comparison.tighter)]
    if len(of_levels) > 1 and of_levels[0] and of_levels[1]:
        begin = comparison.job.grid.start
        later = of_levels[1].t - begin
        if later < VERIFICATION.sensitive * (of_levels[0].t - begin):
            return (
                f"a sensitive (chaotic) motion: from t = {of_levels[0].t:.4g} s on {of_levels[0].body} is elsewhere in "
                f"{names[1]}, and that parts from {names[2]} at t = {of_levels[1].t:.4g} s; a tighter tolerance puts "
                "the divergence off but never away, so beyond it the results are one of many possible motions"
            )
    remedy = f"tighten {'the step' if traits_of(settings).fixed_steps else 'rtol'}"
    other = names[1] if of_levels and of_levels[0] else names[-1]
    return (
        f"the motion is not resolved: from t = {first.t:.4g} s on {first.body} is elsewhere in {other}; {remedy} until "
        "two runs agree"
    )


def _uncertain_sentence(comparison: Comparison, parted: bool) -> str:
    worst = list(comparison.uncertain)[: VERIFICATION.named]
    peaks = ", ".join(_peak(comparison, name) for name in worst)
    more = len(comparison.uncertain) - len(worst)
    others = f" and {more} more channels" if more else ""
    return f"peaks are less certain than they should be: {peaks}{others}; {_remedy(comparison, worst[0], parted)}"


def _peak(comparison: Comparison, name: str) -> str:
    bar, values = comparison.bars[name], comparison.first[name]
    low = bar.least - bar.sampled_least > bar.greatest - bar.sampled_greatest
    value, half = (np.nanmin(values), bar.least) if low else (np.nanmax(values), bar.greatest)
    unit = comparison.first.unit(name)
    return f"{name} {value:.3g} ± {half:.1g} {unit}".rstrip()


def _remedy(comparison: Comparison, name: str, parted: bool) -> str:
    """Return a clause on the effect of a tighter tolerance, from the convergence of the runs."""
    settings, first = comparison.job.settings, comparison.first
    fixed = traits_of(settings).fixed_steps
    what, ratio = (f"step {settings.step:.3g} s", 2.0) if fixed else (f"rtol {settings.rtol:.3g}", 10.0)
    if parted:
        return f"at {what} they belong to motions that part"
    whole = [run for run in comparison.tighter if not run.obstacle]
    if len(whole) < 2:
        return f"{what} is too coarse for them, or the integrators disagree; compare with a tighter one"
    peaks = [(float(np.nanmin(v)), float(np.nanmax(v))) for v in (first[name], *(run.reported(name) for run in whole))]
    once = max(abs(a - b) for a, b in zip(peaks[0], peaks[1], strict=True))
    twice = max(abs(a - b) for a, b in zip(peaks[1], peaks[2], strict=True))
    shrinks = once / twice if twice else math.inf
    if shrinks < VERIFICATION.converges:
        return f"they do not settle with a tighter tolerance than {what}: differences shrink by {shrinks:.2g} only"
    needed = comparison.uncertain[name] / comparison.acceptable
    steps = math.ceil(math.log(needed) / math.log(min(shrinks, ratio)))
    if fixed:
        return f"they converge; step {settings.step / ratio**steps:.2g} s should do"
    return f"they converge; rtol {settings.rtol / ratio**steps:.1g} should do"


def _missed(comparison: Comparison) -> list[str]:
    """Return the channels with peaks between output times, the worst first."""
    if comparison.between is None:
        return []
    parts = {
        name: max(beyond(*comparison.between.fine(name)[1:])) / comparison.sizes[name]
        for name in comparison.bars
        if comparison.sizes[name]
    }
    return sorted((name for name, part in parts.items() if part > VERIFICATION.blown_up), key=lambda name: -parts[name])


def _missed_sentence(comparison: Comparison, missed: list[str]) -> str:
    name = missed[0]
    assert comparison.between is not None
    times, values, at = comparison.between.fine(name)
    below, above = beyond(values, at)
    low = below > above
    k = int(np.nanargmin(values) if low else np.nanargmax(values))
    reported = np.nanmin(values[at]) if low else np.nanmax(values[at])
    more = f", and {len(missed) - 1} more channels alike" if len(missed) > 1 else ""
    return (
        f"peaks lie between the output instants: {name} comes to {values[k]:.4g} at t = {times[k]:.6g} s, "
        f"{reported:.4g} at output instants{more}; take a smaller output, or points: steps"
    )
