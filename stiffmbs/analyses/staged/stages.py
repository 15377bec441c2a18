"""Runs of scenes with stages; each stage starts from the final state of the previous one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import Any

from ...errors import InputError, StiffmbsError
from ...model.files.stages import OWN_SETTINGS, Stage
from ...model.scene import Scene, notes_of
from ...model.settings import RunSettings
from ...results.joined import joined
from ...results.saved_state import SavedState
from ...results.solution import Solution
from ...solve.settings import changed, output_grid
from ...solve.trajectory import ProgressCallback
from ..equilibrium import equilibrium
from ..given_inputs import Given
from ..run import run
from ..start_from import StartFrom, state_to_start_from
from .until import Ended, run_until


def run_stages(
    scene: Scene,
    settings: RunSettings | None = None,
    watch: ProgressCallback | None = None,
    start_from: StartFrom | None = None,
    inputs: Mapping[str, Given] | None = None,
    **changes: Any,
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
    changes: dict[str, Any],
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
        return Ended(_settled(scene, state, changes))
    grid = output_grid(changed(scene.run, {**changes, "start": state.t if state else scene.run.start}))
    if grid.times is None:
        raise InputError("found points = steps for an equilibrium, expected a number or an output interval")
    rows: list[Solution] = []
    for t in grid.times:
        rows.append(_settled(scene, state, {**changes, "start": float(t)}))
        state = replace(rows[-1].state(), elements=_elements(scene))
    return Ended(joined(scene.name, rows))


def _interval(scene: Scene, changes: dict[str, Any]) -> float | None:
    """Return the time between the output points of a stage of full length."""
    times = output_grid(changed(scene.run, changes)).times
    return None if times is None else float(times[1] - times[0])


def _up_to(end: float, start: float) -> float:
    """Return the duration of a stage that ends at a given time."""
    if not end > start:
        raise InputError(f"found its end at {end:g} s, expected a time after {start:g} s, where it starts")
    return end - start


def _settled(scene: Scene, state: SavedState | None, changes: dict[str, Any]) -> Solution:
    found = equilibrium(scene, start_from=state, **changes).solution
    return replace(found, notes=(*notes_of(scene), *found.notes))
