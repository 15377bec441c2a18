"""Scenes run in consecutive stages, each with other joints, forces or numbers."""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, Literal, Self

from pydantic import Field, model_validator

from ...errors import InputError
from ...reading.fields import Described
from ...reading.files.quoted import quoted
from ...reading.files.yaml_text import Content, read_yaml
from ...reading.units import si
from .written_scene import WrittenScene

BOUNDS = ("at_least", "at_most", "equals")


class Until(Described):
    """Condition that ends a stage or changes its course (Adams: SENSOR)."""

    request: str = Field(description="name of the request that is watched over the solver's internal steps")
    at_least: si.Number | None = Field(None, description="the stage ends where the value comes to be this or more")
    at_most: si.Number | None = Field(None, description="where it comes to be this or less")
    equals: si.Number | None = Field(None, description="where it comes to this from either side")
    within: si.NumberOrZero = Field(
        0.0,
        description="tolerance for an extremum that does not quite reach `equals`, and the distance by which the value must move back before the condition can be met again",
    )
    then: Literal["next", "stop", "on"] = Field(
        "next", description="continue with the next stage, end all stages, or continue this one"
    )
    output: si.PositiveTime | None = Field(None, description="time between output points from there on, s; with on")
    sets: dict[str, str] = Field(
        default_factory=dict, description="inputs that take the value that a request has at that time"
    )

    @model_validator(mode="after")
    def _one_bound(self) -> Self:
        given = [name for name in BOUNDS if getattr(self, name) is not None]
        if len(given) != 1:
            raise ValueError(f"found {' and '.join(given) or 'no bound'}, expected one of {', '.join(BOUNDS)}")
        if self.output is not None and self.then != "on":
            raise ValueError("found an output in a condition that ends the stage, expected then: on")
        return self


OWN_SETTINGS = ("duration", "output", "points", "start")
"""Settings of ``run`` that each stage has for itself."""
GRIDS = ("output", "points")


class Stage(Described):
    """Stage of a scene, which starts where the previous one ends."""

    analysis: Literal["dynamic", "static"] = Field(
        "dynamic",
        description="over time, or static: the equilibrium found from the state at its start, at that time; with a duration, one at each output time",
    )
    change: dict[str, Any] = Field(
        default_factory=dict,
        description="changes from the previous stage, or the scene, as a merge patch (RFC 7386): null removes an entry",
    )
    run: dict[str, Any] = Field(
        default_factory=dict, description="settings of this stage, in addition to those of the scene"
    )
    end: si.Time | None = Field(None, description="when it ends, s, in place of a duration")
    until: dict[str, Until] = Field(default_factory=dict, description="conditions that end it earlier, by name")

    @property
    def over_time(self) -> bool:
        """True for a stage with a time interval."""
        return self.analysis == "dynamic" or "duration" in self.run or self.end is not None

    @property
    def removed(self) -> list[str]:
        """Names of the entries that the stage removes from their sections."""
        sections = [section for section in self.change.values() if isinstance(section, dict)]
        return [name for section in sections for name, entry in section.items() if entry is None]

    @model_validator(mode="after")
    def _one_end(self) -> Self:
        if self.end is not None and "duration" in self.run:
            raise ValueError("found end and a duration, expected one of them")
        if self.until and self.analysis == "static":
            raise ValueError("found until with an equilibrium, expected it with analysis: dynamic")
        return self


def written_stages(scene: WrittenScene, stages: Sequence[Stage]) -> list[WrittenScene]:
    """Return each stage as a separate scene.

    Raises InputError if a change from outside concerns a setting that each stage has for itself.
    """
    for path, _ in scene.changes if len(stages) > 1 else ():
        if path.partition(".")[0] == "run" and path.partition(".")[2] in OWN_SETTINGS:
            raise InputError(
                f"--set {path}: found a scene with stages, which have durations and outputs of their own, expected no change of it"
            )
    content = {key: value for key, value in scene.content.items() if key != "stages"}
    found: list[WrittenScene] = []
    for k, stage in enumerate(stages):
        content = merged(content, stage.change)
        if k == 1:
            content.pop("at_start", None)
        settings = dict(content.get("run") or {})
        if any(grid in stage.run for grid in GRIDS):
            settings = {name: value for name, value in settings.items() if name not in GRIDS}
        whole = copy.deepcopy({**content, "run": settings | stage.run})
        later = frozenset(_elements(whole) - _elements(found[0].content)) if k else frozenset()
        changes = _of_stage(scene.changes, whole)
        found.append(WrittenScene(whole, changes, scene.source, scene.folder, starts_later=later))
    return found


def _elements(content: Content) -> set[str]:
    """Return the names of the joints and forces of a scene."""
    return {name for section in ("joints", "forces") for name in content.get(section) or ()}


def merged(old: object, change: object) -> Any:
    """Apply a merge patch (RFC 7386)."""
    if not isinstance(change, Mapping):
        return change
    found = dict(old) if isinstance(old, Mapping) else {}
    for name, value in change.items():
        if value is None:
            found.pop(name, None)
        else:
            found[name] = merged(found.get(name), value)
    return found


def merge_patch(old: Mapping[str, object], new: Mapping[str, object]) -> Content:
    """Return the patch that converts one mapping to another; see `merged`."""
    patch: dict[str, object] = {name: None for name in old if name not in new}
    for name, value in new.items():
        before = old.get(name)
        if isinstance(value, Mapping) and isinstance(before, Mapping):
            inner = merge_patch(before, value)
            patch |= {name: inner} if inner else {}
        elif name not in old or value != before:
            patch[name] = value
    return patch


def _of_stage(changes: Sequence[tuple[str, object]], content: Content) -> tuple[tuple[str, object], ...]:
    """Return the changes from outside, without those of joints, forces and requests that a stage does not have."""
    if not changes:
        return ()
    from ..parts.changes import set_later

    def is_there(path: str) -> bool:
        section, _, name = path.partition(".")
        if section not in ("joints", "forces", "requests") or set_later(path, content):
            return True
        return any(name == known or name.startswith(f"{known}.") for known in content.get(section) or ())

    return tuple((path, value) for path, value in changes if is_there(path))


AT_START = "at_start"


def with_held(scene: WrittenScene) -> WrittenScene:
    """Return the scene with the initial-condition joints among its own.

    Raises InputError if one of them has the name of a permanent joint.
    """
    content = dict(scene.content)
    held, joints = content.pop(AT_START, None), dict(content.get("joints") or {})
    for path, value in scene.changes:
        if path == AT_START:
            held = read_yaml(value, f"--set {path}") if isinstance(value, str) else value
    held = held or {}
    twice = next((name for name in held if name in joints), None)
    if twice is not None:
        raise InputError(
            f"{scene.source}: {AT_START}: found '{quoted(twice)}', a joint of the scene, expected another name"
        )
    changes = tuple((_of_joint(path), value) for path, value in scene.changes if path != AT_START)
    return replace(scene, content={**content, "joints": {**joints, **held}}, changes=changes)


def _of_joint(path: str) -> str:
    section, dot, name = path.partition(".")
    return f"joints.{name}" if section == AT_START and dot else path
