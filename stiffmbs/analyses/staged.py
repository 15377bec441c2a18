"""Runs in stages, which end or change where a request reaches a value.

The whole time span is solved once, with the solver's own steps as output, or with even points if the steps are few.  The
first interval in which a condition becomes true is solved again on finer points, until linear interpolation gives the
instant.  Then the run is solved up to it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import partial

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
from .equilibrium import equilibrium
from .given_inputs import Given
from .run import run
from .start_from import StartFrom, state_to_start_from

POINTS, LEVELS = 33, 3
"""Points in a refined step, and number of refinements: the last points are 1/32768 of the step apart."""
LEAST = 1000
"""Number of intervals below which a condition might hold only within one of them."""
MOST = 500
"""Number of times that conditions may become true in one stage."""
SAME = 1e-9
"""Default part of a bound by which a value has to go back before its condition counts again."""
Run = Callable[..., Solution]
"""`stiffmbs.analyses.run.run` of one scene: takes changes of settings, ``start_from`` and ``inputs``."""


@dataclass(frozen=True)
class Ended:
    """Result of a stage: the condition that ended it, empty if none did, and the inputs set by conditions."""

    solution: Solution
    by: str = ""
    inputs: Mapping[str, Given] = field(default_factory=dict)


@dataclass(frozen=True)
class Margin:
    """Margin, negative before a condition becomes true: ``factor (value - bound) + near``, from `armed` on."""

    channel: str
    factor: float
    bound: float
    near: float
    armed: float

    def __call__(self, solution: Solution) -> np.ndarray:
        values = self.factor * (solution[self.channel] - self.bound) + self.near
        return np.where(solution.time >= self.armed, values, np.nan)


@dataclass(frozen=True)
class Crossing:
    """Time at which a condition becomes true, after the row `before` of a solution."""

    name: str
    before: int
    t: float


def run_until(
    run: Run,
    conditions: Mapping[str, Until],
    interval: float | None,
    inputs: Mapping[str, Given] | None,
    **changes: object,
) -> Ended:
    """Solve up to the condition that ends the stage, or over the whole time, with changes of settings and ``start_from``.

    `interval` is the time between output points, s; None for the solver's own steps. Raises InputError if a condition
    names no request, is true at the start, or becomes true more than `MOST` times.
    """
    given, ended_by = dict(inputs or {}), ""
    parts: list[Solution] = []
    for _ in range(MOST):
        part, name, rest = _up_to_the_first(run, conditions, interval, not parts, inputs=given, **changes)
        parts.append(part)
        if not name:
            break
        condition = conditions[name]
        given |= {key: float(_channel(name, request, part)[-1]) for key, request in condition.sets.items()}
        if condition.then != "on":
            ended_by = name
            break
        if rest <= 0:
            break
        interval = condition.output or interval
        state = replace(part.state(), source=f"'{name}'")
        changes = {**changes, "start_from": state, "start": float(part.time[-1]), "duration": rest}
    else:
        raise InputError(f"found conditions that become true more than {MOST} times, expected fewer")
    doubtful = (part.message for part in parts if IN_DOUBT in part.message)
    solution = replace(joined(parts[0].name, parts), message=next(doubtful, parts[-1].message))
    return Ended(solution, ended_by, given)


CONDITION = NoteKind("condition", "{what} at t = {t:.9g} s by '{element}'", severity=Severity.REMARK)


def _up_to_the_first(
    run: Run, conditions: Mapping[str, Until], interval: float | None, fresh: bool, **changes: object
) -> tuple[Solution, str, float]:
    """Return the run up to the first condition, the name of the condition (empty for none), and the remaining time."""
    whole = run(**{**changes, "points": "steps", "output": None})
    if len(whole.time) <= LEAST:
        whole = run(**{**changes, "points": LEAST + 1, "output": None})
    margins = {name: _margin_of(name, condition, whole, fresh) for name, condition in conditions.items()}
    for name, margin in margins.items():
        if fresh and margin(whole)[0] >= 0:
            raise InputError(
                f"'{name}': found its condition true at the start, t = {whole.time[0]:.9g} s, expected it to become true "
                "during the run"
            )
    grid = {"output": interval, "points": None} if interval else {}
    crossing = _first(margins, whole)
    if crossing is None:
        return run(**{**changes, **grid}), "", 0.0
    start, found = float(whole.time[0]), whole
    end, name = crossing.t, crossing.name
    for _ in range(LEVELS):
        a, b = (float(found.time[k]) for k in (crossing.before, crossing.before + 1))
        step = {"start": a, "duration": b - a, "points": POINTS, "output": None}
        fine = run(**{**changes, "start_from": found.state(at=a), **step})
        nearer = _first({name: margins[name]}, fine)
        if nearer is None:  # the condition is true only in the last digits of the longer run
            break
        found, crossing, end = fine, nearer, nearer.t
    solution = run(**{**changes, **grid, "duration": end - start})
    if not solution.success:
        return solution, "", 0.0
    note = CONDITION(name, what="ended" if conditions[name].then != "on" else "changed", t=end)
    solution = replace(solution, message=str(note), notes=(*solution.notes, note))
    return solution, name, float(whole.time[-1]) - end


def _channel(name: str, request: str, solution: Solution) -> np.ndarray:
    if request not in solution:
        raise InputError(f"'{name}': found request = {request}, expected the name of a request")
    return solution[request]


def _margin_of(name: str, condition: Until, whole: Solution, fresh: bool) -> Margin:
    """Return the margin of a condition in a run; in a continued run, from where the value has gone back far enough."""
    values = _channel(name, condition.request, whole)
    bound = next(b for b in (condition.at_least, condition.at_most, condition.equals) if b is not None)
    away = values - bound
    back = max(condition.within, SAME * max(1.0, abs(bound)))
    factor = 1.0 if condition.at_least is not None else -1.0
    far = np.abs(away) > back if condition.equals is not None else factor * away < -back
    rows = np.flatnonzero(far)
    first = 0 if fresh else int(rows[0]) if len(rows) else len(away)
    armed = float(whole.time[first]) if first < len(away) else np.inf
    near = 0.0
    if condition.equals is not None and first < len(away):
        factor = -1.0 if away[first] > 0 else 1.0
        past = factor * away[first:]
        near = condition.within if np.nanmax(past) < 0 or past[0] >= -condition.within else 0.0
    return Margin(condition.request, factor, bound, near, armed)


def _first(margins: Mapping[str, Margin], solution: Solution) -> Crossing | None:
    """Return the first condition that becomes true, with its time by linear interpolation between the rows."""
    found = None
    for name, margin in margins.items():
        values = margin(solution)
        holds = np.flatnonzero((values[:-1] < 0) & (values[1:] >= 0) & (np.diff(solution.time) > 0))
        if not len(holds):
            continue
        k = int(holds[0])
        part = -values[k] / (values[k + 1] - values[k])
        t = float(solution.time[k] + part * (solution.time[k + 1] - solution.time[k]))
        if found is None or t < found.t:
            found = Crossing(name, k, t)
    return found


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
        runner = partial(run, scene, watch=watch)
        return run_until(runner, stage.until, _interval(scene, changes), inputs, start_from=state, **changes)
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
