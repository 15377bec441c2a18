"""Estimated errors of runs against their true errors: ``python -m tests.stress.self_assessment``.

    python -m tests.stress.self_assessment [--count N] [--seed N] [--solver bdf|radau|auto|projected]... [--rtol X]...
        [--reference SOLVER:RTOL]... [SCENE...]

Prints a line for each run, with the ratio of the estimated to the true error of positions, velocities and forces, and at the end,
for each integrator, their quantiles, the shares of runs with errors right within a factor, the runs that are lost or not
estimated, and false and missing notes. SCENEs are files; random scenes by default, of consecutive seeds. Each is run with all
combinations of solvers and tolerances. The truth is a run of another integrator at a much smaller tolerance, ``--reference`` for
scenes that an explicit one takes hours for: radau:1e-10 and bdf:1e-8 for beams and cars. 300 scenes:

    python -m tests.stress.self_assessment --seed 0 --count 300 --solver bdf --solver radau --solver projected --rtol 1e-3 \\
        --rtol 1e-5 --rtol 1e-8
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from types import MappingProxyType
from typing import Any

import numpy as np

from stiffmbs.analyses.load_scene import load_scene
from stiffmbs.analyses.run import run
from stiffmbs.errors import StiffmbsError
from stiffmbs.model.read_scene import read_scene
from stiffmbs.model.scene import Scene
from stiffmbs.results.digits import GROUPS, KnownErrors, over_time
from stiffmbs.results.error_bars import ErrorBar, difference
from stiffmbs.results.scales import kind_of
from stiffmbs.results.solution import Solution

from .random_scenes.scene import random_scene

REFERENCES = ("projected:1e-12", "radau:1e-10")
"""Runs for the truth, in the order of their use."""
ROUNDING = 1e-9
"""Relative error below which a ratio is not meaningful."""
POINTS = 501
"""Output points of a scene that has those of the solver's steps, which differ from run to run."""
AGREED = 0.1
"""Difference of the two references in the error of the run, up to which the truth is known."""
FALSE = 3.0
"""A note on an error is false if the true error is below this part of its threshold, or missing if above as many times it."""
FAR_BELOW = 5.0
"""An estimate is far too small if the true error is more than so many times as large, without a note."""
NOTE = "the estimated error of"
SEVERAL = "passes a singular pose", "several motions are possible"
"""Begins of the notes on a state from which several motions go on: none of them is the truth."""
FACTORS = {"bdf": (3, 0.9), "radau": (3, 0.9), "projected": (4, 0.8)}
"""Factor within which the errors of positions are to be right, and in what share of runs, by integrator."""
FORCES = 5, 0.8
"""The same of forces, by all integrators."""
MOST_LOST = 0.05
"""Largest share of runs that may be lost."""


@dataclass(frozen=True)
class Assessment:
    """Estimate and truth of one run.

    - `status`: of the estimate, or ``no truth``.
    - `true`, `estimated`: largest errors relative to the size of their channels, by group. `in_peaks`: true ones relative to
      sizes with the peaks between output times, as those of notes.
    - `noted`: True if a note says that the errors are large or lost.
    - `solver`: the integrator.
    """

    status: str
    true: Mapping[str, float]
    estimated: Mapping[str, float]
    noted: bool
    rtol: float
    solver: str
    in_peaks: Mapping[str, float]

    def ratios(self) -> dict[str, float]:
        """Return the estimated error in the true one by group, where this is more than rounding."""
        if self.status != "estimated":
            return {}
        return {group: self.estimated[group] / true for group, true in self.true.items() if true > ROUNDING}

    @property
    def exceeds(self) -> float:
        """Return the largest true error in the threshold of its note."""
        limits = {"positions": min(200.0 * max(self.rtol, 1e-6), 0.01)}
        return max((true / limits.get(group, 0.01) for group, true in self.in_peaks.items()), default=0.0)

    @property
    def is_false(self) -> bool:
        """Return True if a note has no reason."""
        return self.noted and self.status == "estimated" and self.exceeds < 1.0 / FALSE

    @property
    def is_silent(self) -> bool:
        """Return True if a note is missing."""
        return not self.noted and self.status == "estimated" and self.exceeds > FALSE


def references(scene: Scene, how: Mapping[str, Any], wanted: Sequence[str] = REFERENCES) -> list[Solution]:
    """Return the runs for the truth that are not refused, each of a solver and its tolerance as in ``radau:1e-10``."""
    found = []
    for reference in wanted:
        solver, _, rtol = reference.partition(":")
        try:
            found.append(run(scene, **{**how, "solver": solver, "rtol": float(rtol)}, errors=False))
        except StiffmbsError:
            continue
    return [each for each in found if each.success]


def assess(scene: Scene, how: Mapping[str, Any], truths: Sequence[Solution] | None = None) -> Assessment:
    """Return the assessment of a run; raise a StiffmbsError if it is refused. `truths`: `references`, if known."""
    found = run(scene, **how, errors=True)
    rtol = float(how.get("rtol", scene.run.rtol))
    noted = any(note.startswith(NOTE) or "solution is lost" in note for note in found.notes)
    solver = next((name for name in FACTORS if name in str(found.solver.get("name"))), str(found.solver.get("name")))
    nothing = Assessment("no truth", {}, {}, noted, rtol, solver, {})
    if not found.success or found.estimate is None or any(note.startswith(SEVERAL) for note in found.notes):
        return nothing
    others = references(scene, how) if truths is None else truths
    bars = [errors_of(found, other) for other in others]
    fine = [largest(found, each) for each in bars]
    if not fine or any(
        abs(fine[-1][group] - true) > AGREED * true for group, true in fine[0].items() if true > ROUNDING
    ):
        return nothing
    in_peaks = largest(found, bars[0], found.errors)
    return Assessment(found.estimate.status, fine[0], largest(found, found.errors), noted, rtol, solver, in_peaks)


def errors_of(solution: Solution, other: Solution) -> dict[str, ErrorBar]:
    """Return the largest true errors by channel, from a more accurate run, at output times: rows beside events differ in time."""
    bars = {}
    _, rows, others = np.intersect1d(solution.time, other.time, return_indices=True)
    for name in solution.channels:
        values, known = solution[name][rows], other[name][others]
        error = np.abs(difference(name, values, known))
        if kind_of(name) == "orientation":  # q and -q are one orientation
            error = np.minimum(error, np.abs(values + known))
        bars[name] = ErrorBar(float(np.nanmax(error, initial=0.0)), 0.0, 0.0, 0.0, 0.0)
    return bars


def largest(
    solution: Solution, bars: Mapping[str, ErrorBar], peaks: Mapping[str, ErrorBar] = MappingProxyType({})
) -> dict[str, float]:
    """Return the largest errors relative to the sizes of their channels, by group; `peaks`: bars of peaks that sizes contain."""
    from dataclasses import replace

    known = KnownErrors(replace(solution, errors=bars))
    found: dict[str, float] = {}
    for group in GROUPS:
        for name, error in known.relative(over_time, group).items():
            above = max(peaks[name].sampled_least, peaks[name].sampled_greatest) if name in peaks else 0.0
            found[group] = max(found.get(group, 0.0), error / (1.0 + float(np.nan_to_num(above)) / known.sizes[name]))
    return found


def drawn(seed: int, solver: str = "") -> tuple[Scene, dict[str, Any]]:
    """Return a random scene, and settings of its run."""
    rng = np.random.default_rng(seed)
    chosen = solver or str(rng.choice(["bdf", "bdf", "radau", "auto"]))
    how = {"solver": chosen, "rtol": float(10.0 ** -rng.integers(3, 9))}
    scene = random_scene(rng)
    how["duration"] = float(10.0 ** rng.uniform(0, 1)) * scene["run"]["duration"]
    return read_scene(json.dumps(scene)), how


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*")
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--solver", action="append", default=[])
    parser.add_argument("--rtol", type=float, action="append", default=[])
    parser.add_argument("--reference", action="append", default=[])
    asked = parser.parse_args()
    found = []
    names = asked.scenes or [str(seed) for seed in range(asked.seed, asked.seed + asked.count)]
    for name in names:
        truths = None
        for solver, rtol in product(asked.solver or [""], asked.rtol or [0.0]):
            scene, how = (load_scene(name), {"solver": solver or "bdf"}) if asked.scenes else drawn(int(name), solver)
            how |= ({"rtol": rtol} if rtol else {}) | ({"points": POINTS} if scene.run.points == "steps" else {})
            try:
                truths = references(scene, how, asked.reference or REFERENCES) if truths is None else truths
                one = assess(scene, how, truths)
            except StiffmbsError as refusal:
                print(name, "refused:", str(refusal)[:100])
                continue
            found.append(one)
            ratios = " ".join(
                f"{group} {true:.1e} {one.ratios().get(group, float('nan')):.2f}" for group, true in one.true.items()
            )
            marks = " FALSE NOTE" * one.is_false + " SILENT" * one.is_silent
            print(f"{name} {how['solver']} {one.rtol:.0e} {one.status}: {ratios}{marks}", flush=True)
    for solver in sorted({one.solver for one in found}):
        own = [one for one in found if one.solver == solver]
        print(f"\n{solver}\n{table(own)}\n{shares(own)}")


def table(found: list[Assessment]) -> str:
    """Return quantiles of the ratios, and counts of runs by status, as text."""
    lines = []
    for group in GROUPS:
        ratios = np.array([one.ratios()[group] for one in found if group in one.ratios()])
        if len(ratios):
            shown = ", ".join(f"{ratio:.2f}" for ratio in np.quantile(ratios, [0.0, 0.1, 0.5, 0.9, 1.0]))
            within = ", ".join(
                f"{np.mean((ratios > 1 / factor) & (ratios < factor)):.0%} within {factor}" for factor in (2, 3, 5)
            )
            lines.append(f"{group}: {len(ratios)} ratios, least, 10 %, median, 90 %, largest: {shown}; {within}")
    for status in dict.fromkeys(one.status for one in found):
        lines.append(f"{status}: {sum(one.status == status for one in found)}")
    lines.append(f"false notes: {sum(one.is_false for one in found)}, missing: {sum(one.is_silent for one in found)}")
    return "\n".join(lines)


def shares(found: list[Assessment]) -> str:
    """Return the shares of runs of one integrator with errors right within a factor, and of those lost, with what is expected."""
    lines = []
    for group, (factor, share) in {"positions": FACTORS.get(found[0].solver, (5, 0.0)), "forces": FORCES}.items():
        ratios = np.array([one.ratios()[group] for one in found if group in one.ratios()])
        if len(ratios):
            within = np.mean((ratios > 1 / factor) & (ratios < factor))
            lines.append(
                f"{group} within a factor of {factor}: {within:.0%} of {len(ratios)} runs, expected {share:.0%}"
            )
    low = [one for one in found if not one.noted and min(one.ratios().values(), default=1.0) < 1.0 / FAR_BELOW]
    known = [one for one in found if one.status != "no truth"]
    lost = sum(one.status == "lost" for one in known)
    lines.append(f"below a part of {1.0 / FAR_BELOW:g} without a note: {len(low)}, expected 0")
    lines.append(f"lost: {lost / max(len(known), 1):.0%} of {len(known)} runs, expected at most {MOST_LOST:.0%}")
    return "\n".join(lines)


if __name__ == "__main__":
    main()
