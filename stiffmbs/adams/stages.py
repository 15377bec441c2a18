"""Conversion of command file segments to stages of a scene."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TypeAlias

from ..model.files.stages import merge_patch
from ..reading.files.yaml_text import Content
from .commands.commands import Segment
from .commands.simulations import KINEMATICS, STATICS, one_run, refuse_velocities
from .scene.requests import conditions
from .statements.constraints import Motion
from .statements.dataset import Dataset
from .statements.units import Units

Described: TypeAlias = tuple[Dataset, Content]
"""Dataset and its scene."""
NOT_OF_A_STAGE = ("run", "notes", "start", "stages")
POSES = ("position", "orientation", "velocity", "omega", "open")
"""Body fields that define the initial state and its frame."""
BY_INITIAL_POSE = ("COUPLER", "GEAR", "SCREW", "RACKPIN", "CVCV")
"""Constraints that depend on the initial pose of joints or parts."""


def followed(
    segments: Sequence[Segment], described: Described, read: Callable[[Segment], Described], source: str
) -> Content:
    """Return the scene sections defined by simulations: ``run``, ``start``, ``stages`` and ``notes``.

    `segments`: at least one. `described`: the dataset as changed by the commands before the first simulation, and its
    scene. `read`: returns dataset and scene of a segment. `source`: name of the command file in notes. Raises
    DatasetFault if a simulation cannot be continued from the end of its predecessor.
    """
    dataset, scene = described
    units = dataset.units
    integrated = [
        name for name, joint in scene.get("joints", {}).items() if joint.get("position") in scene.get("states", ())
    ]
    if integrated and any(segment.simulation.kind == KINEMATICS for segment in segments):
        dynamics = [
            replace(segment, simulation=replace(segment.simulation, kind="DYNAMICS"))
            if segment.simulation.kind == KINEMATICS
            else segment
            for segment in segments
        ]
        found = followed(dynamics, described, read, source)
        note = f"{', '.join(integrated)}: integrals without a formula; KINEMATICS is solved as DYNAMICS"
        return found | {"notes": [*found["notes"], note]}
    first = segments[0].simulation
    if first.kind == STATICS:
        refuse_velocities(first.line, dataset)
    settled = first.kind == STATICS and not first.takes_time
    over_time = segments[1:] if settled and len(segments) > 1 else segments
    unchanged = all(s.changes == segments[0].changes and s.settings == over_time[0].settings for s in over_time)
    watched = bool(dataset.active_sensors) or any(
        key[0] == "SENSOR" for s in segments for key in (*s.changes.inactive, *s.changes.altered)
    )
    whole = one_run([s.simulation for s in over_time], units) if unchanged and not watched else None
    if whole is not None:
        start = {"start": "equilibrium"} if settled else {}
        notes = [f"duration and output are those of {source}"]
        return {"run": whole | _in_si(over_time[0], units), **start, "notes": notes}
    return _staged(segments, described, read, source, watched)


def _staged(
    segments: Sequence[Segment], described: Described, read: Callable[[Segment], Described], source: str, watched: bool
) -> dict[str, object]:
    """Return one stage per simulation; if sensors may end stages (`watched`), an end time stays absolute."""
    stages: list[dict[str, object]] = []
    count = len(segments)
    notes = [f"{source} runs {f'{count} simulations in succession' if count > 1 else 'one simulation'}"]
    units = described[0].units
    time, before, known = 0.0, segments[0], described
    for k, segment in enumerate(segments, start=1):
        simulation = segment.simulation
        stage: dict[str, object] = {"analysis": "static"} if simulation.kind == STATICS else {}
        if segment.changes != before.changes:
            now = read(segment)
            stage |= _changed(known, now, segment)
            notes += [f"from simulation {k} on {note}" for note in segment.changes.notes_since(before.changes, source)]
            known = now
        if watched and simulation.end is not None:
            stage["end"] = simulation.end * units.time
            run = simulation.settings_up_to_its_end(units)
        else:
            run = simulation.settings(time, units)
            time += simulation.length(time) if simulation.takes_time else 0.0
        run |= _in_si(segment, units)
        until = {} if simulation.kind == STATICS else conditions(known[0], known[1].get("inputs", {}))
        stages.append(stage | ({"until": until} if until else {}) | ({"run": run} if run else {}))
        before = segment
    if any(segment.simulation.kind == STATICS for segment in segments[1:]):
        notes.append("all velocities are zero after a static simulation")
    return {"run": {}, "stages": stages, "notes": notes}


def _in_si(segment: Segment, units: Units) -> dict[str, float]:
    return {name: value * (units.time if name == "max_step" else 1.0) for name, value in segment.settings.items()}


def _changed(before: Described, now: Described, segment: Segment) -> dict[str, object]:
    """Return the changes of a stage relative to the previous scene."""
    patch = merge_patch(_without(before[1]), _without(now[1]))
    _refuse_other_turns(patch.get("joints") or {}, now[0], segment)
    _refuse_other_frames(patch.get("bodies") or {}, segment)
    kept = _with_all_bodies(patch)
    return {"change": kept} if kept else {}


def _with_all_bodies(patch: Content) -> dict[str, object]:
    """Return a patch that removes no body: an auxiliary body of a deactivated CVCV moves on freely."""
    bodies = {name: part for name, part in (patch.get("bodies") or {}).items() if part is not None}
    others = {name: part for name, part in patch.items() if name != "bodies"}
    return others | ({"bodies": bodies} if bodies else {})


def _without(found: dict[str, object]) -> dict[str, object]:
    return {name: value for name, value in found.items() if name not in NOT_OF_A_STAGE}


def _refuse_other_frames(bodies: Content, segment: Segment) -> None:
    for name, patch in bodies.items():
        if any(key in POSES for key in patch or {}):
            raise segment.simulation.fault(
                f"found a changed centre-of-mass marker of {name}, expected the same marker in all simulations"
            )


def _refuse_other_turns(joints: Content, dataset: Dataset, segment: Segment) -> None:
    """Refuse constraints that depend on the initial pose but become active later."""
    for kind in dataset.statements.values():
        for found in kind.values():
            if not joints.get(getattr(found, "name", "")):
                continue
            sort = getattr(found, "kind", "") or found.keyword
            if sort in BY_INITIAL_POSE:
                raise segment.simulation.fault(
                    f"found {found.label}, {sort}, activated or changed between simulations, expected this before the first one"
                )
            if isinstance(found, Motion) and found.order and "position" in joints[found.name]:
                raise segment.simulation.fault(
                    f"found {found.label}, an integral since t = 0, activated or changed between simulations, "
                    "expected a displacement, or a velocity without ICDISP"
                )
