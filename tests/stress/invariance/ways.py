"""Run a scene in several ways: at once, interrupted by a saved state, step by step, as a study, in space."""

from __future__ import annotations

import json
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from stiffmbs.analyses.in_space import in_space
from stiffmbs.analyses.run import run
from stiffmbs.errors import InputError, SolverError
from stiffmbs.model.model import PlanarData
from stiffmbs.model.read_scene import read_scene
from stiffmbs.results.solution import Solution
from stiffmbs.solve.trajectory import Outcome
from stiffmbs.studies.simulation import simulation
from stiffmbs.studies.sweep import sweep

from ..random_scenes.draft import Content
from .change import Channels
from .typed import NotLegitimate


@dataclass(frozen=True)
class Found:
    """Channels of a run.

    Attributes
    ----------
    time : ndarray
    channels : dict of str to ndarray
    not_unique : frozenset of str
        The reactions that have no unique value.
    notes : tuple of str
    """

    time: np.ndarray
    channels: Channels
    not_unique: frozenset[str] = frozenset()
    notes: tuple[str, ...] = ()


def scene_of(content: Content) -> Any:
    """Return the scene with a given content."""
    return read_scene(json.dumps(content), source="'a random scene'")


def found_of(solution: Solution) -> Found:
    """Return the results of a run.

    Raises
    ------
    SolverError
        When the run stopped early.
    """
    if solution.outcome is not Outcome.DONE:
        raise SolverError(solution.message)
    return Found(solution.time, dict(solution.channels), frozenset(solution.not_unique), tuple(solution.notes))


def at_once(content: Content, **how: Any) -> Found:
    """Return the channels of one run."""
    return found_of(run(scene_of(content), **how))


def in_two_runs(content: Content, **how: Any) -> Found:
    """Return the channels of a run and of its continuation from a saved state."""
    scene = scene_of(content)
    duration, points = content["run"]["duration"], content["run"]["points"]
    half = (points - 1) // 2
    middle = duration * half / (points - 1)
    first = run(scene, **how, duration=middle, points=half + 1)
    found = found_of(first)
    with tempfile.TemporaryDirectory() as folder:
        first.save(Path(folder) / "state.npz")
        rest = run(
            scene, **how, start_from=Path(folder) / "state.npz", duration=duration - middle, points=points - half
        )
    then = found_of(rest)
    joined = {name: np.concatenate([found.channels[name][:-1], series]) for name, series in then.channels.items()}
    return Found(np.concatenate([found.time[:-1], then.time]), joined, found.not_unique)


def in_stages(content: Content, **how: Any) -> Found:
    """Return the channels of a run in two stages without changes."""
    duration, points = content["run"]["duration"], content["run"]["points"]
    half = (points - 1) // 2
    middle = duration * half / (points - 1)
    own = {key: value for key, value in content["run"].items() if key not in ("duration", "points")}
    stages = [
        {"run": {"duration": middle, "points": half + 1}},
        {"run": {"duration": duration - middle, "points": points - half}},
    ]
    found = found_of(run(scene_of({**content, "run": own, "stages": stages}), **how))
    kept = np.append(np.diff(found.time) > 0, True)  # one of two rows at the transition
    return Found(found.time[kept], {name: x[kept] for name, x in found.channels.items()}, found.not_unique)


def step_by_step(content: Content, **how: Any) -> Found:
    """Return the channels of a simulation after each step."""
    stepped = simulation(scene_of(content), **how)
    points = content["run"]["points"]
    rows = [stepped.channels]
    for _ in range(points - 1):
        stepped.step(content["run"]["duration"] / (points - 1))
        rows.append(stepped.channels)
    return Found(np.linspace(0, stepped.t, points), {name: np.array([row[name] for row in rows]) for name in rows[0]})


def as_a_study(content: Content, **how: Any) -> Found:
    """Return the channels of the second of two cases of a study that differ in the mass of a body."""
    scene = scene_of(content)
    body = next((name for name, each in content["bodies"].items() if "mass" in each), None)
    if body is None:
        raise NotLegitimate("no body has a mass of its own")
    mass = content["bodies"][body]["mass"]
    names = [name for name in at_once(content, **how).channels if not name.startswith("constraint.")]
    path = f"bodies.{body}.mass"
    settings = {f"run.{key}": [value] for key, value in how.items()}
    data = sweep(scene, {path: [1.5 * mass, mass], **settings}, outputs={f"o{k}": name for k, name in enumerate(names)})
    case = data.isel({name: -1 for name in data["o0"].dims if name != "time"})
    return Found(data["time"].values, {name: case[f"o{k}"].values for k, name in enumerate(names)})


def embedded(content: Content, **how: Any) -> Found:
    """Return the channels of a planar scene embedded in space, by their planar names; only planar torques have a potential.

    Raises
    ------
    NotLegitimate
        When an element has no counterpart in space.
    """
    scene = scene_of(content)
    assert isinstance(scene, PlanarData)
    try:
        spatial = in_space(scene)
    except InputError as refusal:
        raise NotLegitimate(str(refusal)) from None
    found = found_of(run(spatial, **how))
    channels: Channels = {}
    for name, series in found.channels.items():
        channels[_in_plane(name)] = series
        if name.endswith(".q3"):
            body = name.removesuffix(".q3")
            channels[f"{body}.angle"] = 2 * np.arctan2(series, found.channels[f"{body}.q0"])
    if any(force["type"] == "torque" for force in content.get("forces", {}).values()):
        channels = {name: series for name, series in channels.items() if not name.startswith("energy.")}
    return Found(found.time, channels, frozenset(map(_in_plane, found.not_unique)))


def _in_plane(name: str) -> str:
    owner, _, label = name.rpartition(".")
    others = {"wz": "omega", "wdz": "alpha", "tz": "torque"}
    return f"{owner}.{others[label]}" if owner and label in others else name
