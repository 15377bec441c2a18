"""Runs in stages, which end or change where a request reaches a value.

A run with the solver's own steps as output, or with even points if the steps are few, ends soon after a condition becomes
true.  The first interval in which it does is solved again on finer points, until linear interpolation gives the instant.
Then the run is solved up to it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from typing import NamedTuple

import numpy as np

from ..errors import InputError, StiffmbsError
from ..model.files.stages import OWN_SETTINGS, Stage, Until
from ..model.scene import Scene
from ..model.settings import RunSettings
from ..notes import NoteKind, Severity
from ..reading.files.yaml_text import Content
from ..results.joined import joined
from ..results.saved_state import SavedState
from ..results.solution import Solution
from ..solve.settings import changed, output_grid
from ..solve.trajectory import IN_DOUBT, ProgressCallback
from .conditions import SAME, Crossing, Margin, Monitor, channel_of, first_crossing, margin_of
from .equilibrium import equilibrium
from .given_inputs import Given
from .run import run, run_monitored
from .start_from import StartFrom, state_to_start_from

POINTS, LEVELS = 33, 3
"""Points in a refined step, and number of refinements: the last points are 1/32768 of the step apart."""
LEAST = 1000
"""Number of intervals over the whole time below which a condition might hold only within one of them."""
MOST = 500
"""Number of times that conditions may become true in one stage."""


class Runs(NamedTuple):
    """Runs of one scene with changes of settings, ``start_from`` and ``inputs``; `monitored` takes the monitor first."""

    run: Callable[..., Solution]
    monitored: Callable[..., Solution]


@dataclass(frozen=True)
class Ended:
    """Result of a stage: the condition that ended it, empty if none did, and the inputs set by conditions."""

    solution: Solution
    by: str = ""
    inputs: Mapping[str, Given] = field(default_factory=dict)


def run_until(
    runs: Runs,
    conditions: Mapping[str, Until],
    span: float,
    interval: float | None,
    inputs: Mapping[str, Given] | None,
    **changes: object,
) -> Ended:
    """Solve up to the condition that ends the stage, or over the whole time, with changes of settings and ``start_from``.

    `span` is the whole time, s; `interval` the time between output points, s, or None for the solver's own steps.
    Raises InputError if a condition names no request, is true at the start, or becomes true more than `MOST` times.
    """
    given, ended_by = dict(inputs or {}), ""
    parts: list[Solution] = []
    for _ in range(MOST):
        part, name, rest = _up_to_the_first(runs, conditions, span, interval, not parts, inputs=given, **changes)
        parts.append(part)
        if not name:
            break
        condition = conditions[name]
        given |= {key: float(channel_of(name, request, part)[-1]) for key, request in condition.sets.items()}
        if condition.then != "on":
            ended_by = name
            break
        if rest <= 0:
            break
        interval, span = condition.output or interval, rest
        state = replace(part.state(), source=f"'{name}'")
        changes = {**changes, "start_from": state, "start": float(part.time[-1]), "duration": rest}
    else:
        raise InputError(f"found conditions that become true more than {MOST} times, expected fewer")
    doubtful = (part.message for part in parts if IN_DOUBT in part.message)
    solution = replace(joined(parts[0].name, parts), message=next(doubtful, parts[-1].message))
    return Ended(solution, ended_by, given)


CONDITION = NoteKind("condition", "{what} at t = {t:.9g} s by '{element}'", severity=Severity.REMARK)


def _up_to_the_first(
    runs: Runs, conditions: Mapping[str, Until], span: float, interval: float | None, fresh: bool, **changes: object
) -> tuple[Solution, str, float]:
    """Return the run up to the first condition, the name of the condition (empty for none), and the remaining time."""
    run, grid = runs.run, {"output": interval, "points": None} if interval else {}
    searched = _searched(runs, conditions, span, fresh, changes)
    if searched is None:
        return run(**{**changes, **grid}), "", 0.0
    whole, margins, crossing = searched
    start, found = float(whole.time[0]), whole
    end, name = crossing.t, crossing.name
    for _ in range(LEVELS):
        a, b = (float(found.time[k]) for k in (crossing.before, crossing.before + 1))
        step = {"start": a, "duration": b - a, "points": POINTS, "output": None}
        fine = run(**{**changes, "start_from": found.state(at=a), **step})
        nearer = first_crossing({name: margins[name]}, fine)
        if nearer is None:  # the condition is true only in the last digits of the longer run
            break
        found, crossing, end = fine, nearer, nearer.t
    solution = run(**{**changes, **grid, "duration": end - start})
    if not solution.success:
        return solution, "", 0.0
    note = CONDITION(name, what="ended" if conditions[name].then != "on" else "changed", t=end)
    solution = replace(solution, message=str(note), notes=(*solution.notes, note))
    return solution, name, start + span - end


class Searched(NamedTuple):
    """Run on fine points up to a condition at least, margins of the conditions, and the first of them."""

    solution: Solution
    margins: Mapping[str, Margin]
    crossing: Crossing


def _searched(
    runs: Runs, conditions: Mapping[str, Until], span: float, fresh: bool, changes: Mapping[str, object]
) -> Searched | None:
    """Return where the first condition becomes true, or None if none does.

    Conditions of the results may differ from those of the rows at which a monitor ended the run; it is then repeated without.
    """
    for monitor in (partial(Monitor, conditions, fresh), None):
        found: list[Searched] = []
        points: str | int = "steps"
        while points:
            whole = runs.monitored(monitor, **{**changes, "points": points, "output": None})
            margins = {name: margin_of(name, condition, whole, fresh) for name, condition in conditions.items()}
            _refuse_true_ones(margins if fresh else {}, whole)
            if crossing := first_crossing(margins, whole):
                found.append(Searched(whole, margins, crossing))
            reached = float(np.ptp(whole.time))
            few = points == "steps" and len(whole.time) * span <= LEAST * reached
            points = LEAST + 1 if few else 0
        if found:
            return min(found, key=lambda each: each.crossing.t)
        if not whole.success or reached > (1 - SAME) * span:
            return None
    return None


def _refuse_true_ones(margins: Mapping[str, Margin], whole: Solution) -> None:
    """Raise an InputError if a condition is true at the start."""
    for name, margin in margins.items():
        if margin(whole)[0] >= 0:
            raise InputError(
                f"'{name}': found its condition true at the start, t = {whole.time[0]:.9g} s, expected it to become true "
                "during the run"
            )


def run_stages(
    scene: Scene,
    settings: RunSettings | None = None,
    watch: ProgressCallback | None = None,
    start_from: StartFrom | None = None,
    inputs: Mapping[str, Given] | None = None,
    **changes: object,
) -> Solution:
    """Solve all stages of a scene, up to the first that stops early; parameters and errors as for `stiffmbs.run`.

    Positions and velocities are made consistent with the joints and drives of each stage before it starts: positions by the
    smallest moves, velocities by the smallest change in the mass matrix.  A stage after an equilibrium starts at rest.
    """
    own = [name for name in OWN_SETTINGS if name in changes and (name != "start" or start_from is None)]
    if settings is not None or (own and len(scene.stages) > 1):
        raise InputError(
            f"found {own[0] if own else 'settings'} for a scene with stages, which have their own, expected none"
        )
    start = changes.pop("start", None)
    state = state_to_start_from(start_from)
    solutions: list[Solution] = []
    set_before: dict[str, Given] = {}
    for k, (stage, of_stage) in enumerate(zip(scene.stages, scene.stage_scenes, strict=True)):
        place = f"stage {k + 1} of {len(scene.stages)}"
        at_start = {"start": start} if start is not None and k == 0 else {}
        try:
            known = {name: value for name, value in set_before.items() if name in of_stage.inputs}
            ended = _solved(stage, of_stage, watch, state, {**(inputs or {}), **known}, {**changes, **at_start})
        except StiffmbsError as error:
            raise type(error)(f"{place}: {error}") from None
        found = ended.solution
        set_before |= {name: value for name, value in ended.inputs.items() if name not in (inputs or {})}
        solutions.append(replace(found, message=f"{place}: {found.message}"))
        if not found.success or (ended.by and stage.until[ended.by].then == "stop"):
            break
        state = replace(found.state(), source=f"stage {k + 1}", elements=_elements(of_stage))
    return joined(scene.name, solutions)


def _elements(scene: Scene) -> frozenset[str]:
    return frozenset((*scene.joints, *scene.forces))


def _solved(
    stage: Stage,
    scene: Scene,
    watch: ProgressCallback | None,
    state: SavedState | None,
    inputs: Mapping[str, Given] | None,
    changes: Content,
) -> Ended:
    if stage.end is not None:
        changes = {
            **changes,
            "duration": _up_to(stage.end, changes.get("start", state.t if state else scene.run.start)),
        }
    if stage.analysis == "dynamic":
        if not stage.until:
            return Ended(run(scene, watch=watch, inputs=inputs, start_from=state, **changes))
        runs = Runs(*(partial(each, scene, watch=watch) for each in (run, run_monitored)))
        span = changed(scene.run, changes).duration
        return run_until(runs, stage.until, span, _interval(scene, changes), inputs, start_from=state, **changes)
    if not stage.over_time:
        return Ended(equilibrium(scene, start_from=state, **changes).solution)
    grid = output_grid(changed(scene.run, {**changes, "start": state.t if state else scene.run.start}))
    if grid.times is None:
        raise InputError("found points = steps for an equilibrium, expected a number of points or an output interval")
    rows: list[Solution] = []
    for t in grid.times:
        rows.append(equilibrium(scene, start_from=state, **{**changes, "start": float(t)}).solution)
        state = replace(rows[-1].state(), elements=_elements(scene))
    return Ended(joined(scene.name, rows))


def _interval(scene: Scene, changes: dict[str, object]) -> float | None:
    """Return the time between the output points of a stage of full length."""
    times = output_grid(changed(scene.run, changes)).times
    return None if times is None else float(times[1] - times[0])


def _up_to(end: float, start: float) -> float:
    """Return the duration of a stage that ends at a given time."""
    if not end > start:
        raise InputError(f"found its end at {end:g} s, expected a time after its start at {start:g} s")
    return end - start
