"""Divergence of two runs, and doubts about a run from comparison with others, in sentences."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..analyses.job import Job
from ..compile.bodies import SPACE
from ..compile.quaternions import CONJUGATE, rotation_vector, times
from ..notes import Note, NoteKind
from ..results.error_bars import ErrorBar
from ..results.scales import kind_of
from ..results.solution import Solution
from ..solve.settings import traits_of
from .missed_events import Along, DenseSamples, beyond, poses_of
from .parameters import VERIFICATION
from .solve_again import Again

BRANCH = NoteKind(
    "another-branch",
    "another branch: at t = {pose:.6g} s the mechanism passes a (nearly) singular pose ({where}), where the equations of "
    "{joints} lose rank and the motion may branch; the runs diverge there ({element} differs from t = {t:.4g} s on). "
    "Remedy: {remedy}",
    "a smaller rtol until two runs agree, exact dimensions, or a gear or stop that selects the branch",
)
SENSITIVE = NoteKind(
    "sensitive-motion",
    "a sensitive (chaotic) motion: {element} differs in {tighter} from t = {t:.4g} s on, and in {tightest} from t = "
    "{later:.4g} s on; a smaller tolerance only delays the divergence, and the results after it are one of many possible "
    "motions",
)
NOT_RESOLVED = NoteKind(
    "motion-not-resolved",
    "the motion is not resolved: from t = {t:.4g} s on {element} differs in {other}",
    "tighten {setting} until two runs agree",
)
UNCERTAIN_PEAKS = NoteKind("uncertain-peaks", "error bars of peaks are large: {peaks}", "{effect}")
PEAKS_BETWEEN = NoteKind(
    "peaks-between-outputs",
    "peaks lie between the output times: {element} reaches {value:.4g} at t = {t:.6g} s, but {reported:.4g} at output "
    "times{more}",
    "use a smaller output interval, or points: steps",
)
STEPS_MISS = NoteKind(
    "steps-miss-events",
    "runs diverge because some steps miss events, not because of the tolerance: this run agrees with {run}, others do not",
    "set max_step to this value",
)
STEP_LENGTH = NoteKind(
    "step-length",
    "the results depend on the step length: from t = {t:.4g} s on {body} differs in {run}, but not at a smaller tolerance alone",
    "set max_step to this value, and reduce it until two runs agree",
)
STEPPED_OVER = NoteKind(
    "stepped-over",
    "missed event: {whose} at t = {t:.6g} s within a step that does not contain its force; {known}",
    "set max_step to {max_step:.1g} s or less",
)


TURNING = (*SPACE.positions[SPACE.linear :], *SPACE.velocities[SPACE.linear :])


@dataclass(frozen=True)
class Divergence:
    """Divergence of two motions.

    `body`: first body that diverges. `begun`, `t`: times at which the difference begins to grow, and at which it counts
    as divergence, s.
    """

    body: str
    begun: float
    t: float


def distance(
    first: Mapping[str, np.ndarray], other: Mapping[str, np.ndarray], sizes: Mapping[str, float]
) -> dict[str, np.ndarray]:
    """Return the distance of each body from that in another run over time, relative to the motion's size or in rad.

    `first`, `other`: channels at the same times, as far as both have them. `sizes`: scales of the channels.
    """
    found: dict[str, np.ndarray] = {}
    count = min(len(next(iter(run.values()))) for run in (first, other))
    for name, values in first.items():
        kind, (body, _, ending) = kind_of(name), name.rpartition(".")
        if not sizes[name] or not (kind in ("position", "angle") or ending == TURNING[0]):
            continue
        if ending == TURNING[0] and not all(f"{body}.{part}" in first for part in TURNING):
            continue  # a request
        if kind == "orientation":
            apart = _turned_apart(
                *(np.stack([run[f"{body}.{part}"] for part in TURNING])[:, :count] for run in (first, other))
            )
        else:
            scale = max(sizes[name], 1.0) if kind == "angle" else sizes[name]
            apart = np.abs(values[:count] - other[name][:count]) / scale
        found[body] = np.maximum(found.get(body, 0.0), apart)
    return found


def _turned_apart(first: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Return the difference of two motions in orientation over time, in rad.

    About the rotation axis it is relative to the total rotation of the first motion if that exceeds 1 rad. `first`,
    `other` of shape (7, n): quaternion with arbitrary sign, and angular velocity in the body's own axes.
    """
    p, w = first[:4], first[4:]
    turn = rotation_vector(times(CONJUGATE * p.T, other[:4].T))
    axis = (w / np.maximum(np.linalg.norm(w, axis=0), np.finfo(float).tiny)).T  # zero without a rotation
    along = np.sum(turn * axis, axis=1, keepdims=True)
    turned = 4 * np.arcsin(np.minimum(np.linalg.norm(np.diff(p), axis=0) / 2, 1.0))
    phase = np.abs(along[:, 0]) / max(1.0, float(np.nansum(turned)))
    return np.maximum(phase, np.linalg.norm(turn - along * axis, axis=1))


def divergence(times: np.ndarray, distances: Mapping[str, np.ndarray]) -> Divergence | None:
    """Return the divergence of two motions, or None. `times` of shape (n,). `distances`: of each body (`distance`)."""
    if not distances or not len(next(iter(distances.values()))):
        return None
    bodies, rows = list(distances), np.array(list(distances.values()))
    beyond = rows > VERIFICATION.diverged
    if not beyond.any():
        return None
    k = int(np.argmax(beyond.any(axis=0)))
    body = int(np.argmax(rows[:, k]))
    together = np.flatnonzero(rows[:, :k].max(axis=0) < VERIFICATION.together * VERIFICATION.diverged)
    return Divergence(bodies[body], float(times[together[-1] if len(together) else 0]), float(times[k]))


@dataclass(frozen=True)
class Comparison:
    """A run and those with which it is compared.

    - `tighter`: by the same solver, the tightest last.
    - `other`: by the other solver.
    - `between`: samples between output times.
    - `sizes`: scales of the channels.
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
        runs = [self.first.channels, *(run.channels for run in self.tighter)]
        pairs = [*itertools.pairwise(runs), *([(runs[0], self.other.channels)] if self.other else [])]
        return [self.divergence(one, two) for one, two in pairs]

    def divergence(self, one: Mapping[str, np.ndarray], other: Mapping[str, np.ndarray]) -> Divergence | None:
        """Return the divergence of the channels of two runs, or None."""
        return divergence(self.first.time, distance(one, other, self.sizes))

    @property
    def suspicious(self) -> bool:
        """True if differences are larger than acceptable."""
        return bool(self.uncertain) or any(self.divergences())


def diagnostics(comparison: Comparison) -> Iterator[Note]:
    """Yield a note on each doubt; nothing if the runs agree."""
    divergences = comparison.divergences()
    met = [found for found in divergences if found is not None]
    if met:
        yield _divergence_note(comparison, divergences, min(met, key=lambda found: found.t))
    if comparison.uncertain:
        yield _uncertain_note(comparison, parted=bool(met))
    if not met:
        yield from _peaks_between(comparison)


def _divergence_note(comparison: Comparison, divergences: list[Divergence | None], first: Divergence) -> Note:
    solution = comparison.between.solution if comparison.between else comparison.first
    pose = poses_of(comparison.job, solution).nearest(first.begun, first.t)
    settings = comparison.job.settings
    if pose is not None:
        where = ", ".join(
            f"{body} at {words}"
            for body, words in zip(pose.bodies[: VERIFICATION.named], pose.poses[: VERIFICATION.named], strict=True)
        )
        return BRANCH(first.body, pose=pose.t, where=where, joints=", ".join(pose.joints), t=first.t)
    names = [run.name for run in (*comparison.tighter, comparison.other) if run]
    of_levels = divergences[: len(comparison.tighter)]
    if len(of_levels) > 1 and of_levels[0] and of_levels[1]:
        begin = comparison.job.grid.start
        later = of_levels[1].t - begin
        if later < VERIFICATION.sensitive * (of_levels[0].t - begin):
            return SENSITIVE(
                of_levels[0].body, tighter=names[0], t=of_levels[0].t, tightest=names[1], later=of_levels[1].t
            )
    setting = "the step" if traits_of(settings).fixed_steps else "rtol"
    other = names[0] if of_levels and of_levels[0] else names[-1]
    return NOT_RESOLVED(first.body, t=first.t, other=other, setting=setting)


def _uncertain_note(comparison: Comparison, parted: bool) -> Note:
    worst = list(comparison.uncertain)[: VERIFICATION.named]
    peaks = ", ".join(_peak(comparison, name) for name in worst)
    more = len(comparison.uncertain) - len(worst)
    others = f" and {more} more channels" if more else ""
    return UNCERTAIN_PEAKS(worst[0], peaks=peaks + others, effect=_remedy(comparison, worst[0], parted))


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
        return f"at {what} the motions of the runs diverge"
    whole = [run for run in comparison.tighter if not run.obstacle]
    if len(whole) < 2:
        return f"{what} is too large, or the integrators disagree; use a smaller one"
    peaks = [(float(np.nanmin(v)), float(np.nanmax(v))) for v in (first[name], *(run.reported(name) for run in whole))]
    once = max(abs(a - b) for a, b in zip(peaks[0], peaks[1], strict=True))
    twice = max(abs(a - b) for a, b in zip(peaks[1], peaks[2], strict=True))
    shrinks = once / twice if twice else math.inf
    if shrinks < VERIFICATION.converges:
        return f"they do not converge below {what}: differences decrease only by a factor of {shrinks:.2g}"
    needed = comparison.uncertain[name] / comparison.acceptable
    steps = math.ceil(math.log(needed) / math.log(min(shrinks, ratio)))
    if fixed:
        return f"they converge; step {settings.step / ratio**steps:.2g} s should suffice"
    return f"they converge; rtol {settings.rtol / ratio**steps:.1g} should suffice"


def _peaks_between(comparison: Comparison) -> Iterator[Note]:
    """Yield a note on the channel whose peak between output times exceeds its reported values most, if it does by much."""
    if comparison.between is None:
        return
    parts = {
        name: max(beyond(*comparison.between.fine(name)[1:])) / comparison.sizes[name]
        for name in comparison.bars
        if comparison.sizes[name]
    }
    missed = [name for name, part in parts.items() if part > VERIFICATION.blown_up]
    if missed:
        name = max(missed, key=lambda each: parts[each])
        times, values, at = comparison.between.fine(name)
        below, above = beyond(values, at)
        extreme, place = (np.nanmin, np.nanargmin) if below > above else (np.nanmax, np.nanargmax)
        more = f", and {len(missed) - 1} more channels" if len(missed) > 1 else ""
        yield PEAKS_BETWEEN(
            name, value=extreme(values), t=times[place(values)], reported=extreme(values[at]), more=more
        )


def step_diagnostics(comparison: Comparison, along: Along, shorter: Again | None) -> Iterator[Note]:
    """Yield a note on missed events, else on runs that differ by their longest step alone.

    `comparison`: of the run with others. `along`: result of sampling along the run. `shorter`: rerun with a shorter
    longest step.
    """
    if along.missed:
        missed = along.missed
        whose = f"'{missed.element}' acts" if missed.element else "something acts"
        known = _off(comparison, shorter) or "the errors after it are unknown, and there are no error bars"
        yield STEPPED_OVER(missed.element, whose=whose, t=missed.times[0], known=known, max_step=along.max_step)
    elif shorter is None or not shorter.whole:
        return
    elif any(comparison.divergences()):
        if comparison.divergence(comparison.first.channels, shorter.channels) is None:
            yield STEPS_MISS(run=shorter.name)
    elif (
        comparison.tighter
        and not comparison.tighter[-1].obstacle
        and (found := comparison.divergence(comparison.tighter[-1].channels, shorter.channels))
    ):
        yield STEP_LENGTH(t=found.t, body=found.body, run=shorter.name)


def _off(comparison: Comparison, shorter: Again | None) -> str:
    """Return a clause on the channel that differs most from a run with shorter steps; empty if that stopped early."""
    if shorter is None or shorter.solution is None or shorter.obstacle:
        return ""
    parts = {
        name: float(np.nanmax(np.abs(comparison.first[name] - shorter.reported(name)), initial=0.0)) / size
        for name, size in comparison.sizes.items()
        if size and kind_of(name) in ("velocity", "angular velocity", "position", "angle")
    }
    name = max(parts, key=lambda each: parts[each], default="")
    if not name:
        return ""
    unit = comparison.first.unit(name)
    return f"{name} differs by up to {parts[name] * comparison.sizes[name]:.3g} {unit} ({shorter.name})"
