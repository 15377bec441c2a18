"""The main job: a model is compiled, assembled, solved and turned into channels."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..analyse.energy import kinetic_energy, potential_energy
from ..analyse.reactions import reactions
from ..analyse.redundancy import Redundancy, examine
from ..analyse.requests import requests
from ..compile.system import System, compile_model
from ..describe.model import Model, ModelData
from ..describe.scene import Scene
from ..describe.settings import RunSettings
from ..errors import AssemblyError, InputError
from ..solve import SOLVERS
from ..solve.auto import choose
from ..solve.explicit import ADAPTIVE
from ..solve.failures import FAILURES
from ..solve.initial import InitialValues, initial_values
from ..solve.mechanics import Mechanics, OutputRows
from ..solve.trajectory import Grid, Outcome, Trajectory, Watch
from .solution import Solution

DEFAULT_POINTS = 1001
BODY_CHANNELS = (("x", "y", "angle"), ("vx", "vy", "omega"), ("ax", "ay", "alpha"))


@dataclass(frozen=True)
class Examined:
    """A model compiled and examined for redundant equations."""

    data: ModelData
    settings: RunSettings
    grid: Grid
    redundancy: Redundancy

    def mechanics(self) -> Mechanics:
        """Of the system without its redundant equations."""
        system = self.redundancy.system
        return Mechanics(replace(system, active=self.redundancy.active) if self.redundancy.redundant else system)


@dataclass(frozen=True)
class Job:
    """A model compiled and assembled, ready to be integrated any number of times."""

    data: ModelData
    settings: RunSettings
    grid: Grid
    redundancy: Redundancy
    mechanics: Mechanics
    start: InitialValues
    choice: str = ""

    def integrate(self, watch: Watch | None = None) -> Trajectory:
        """Integrate from the start; see `stiffmbs.solve.trajectory`."""
        solve = SOLVERS[self.settings.solver]
        return solve(self.mechanics, self.start, self.grid, self.settings, watch or (lambda t: None))


def prepare(model: Model | ModelData, settings: RunSettings | None = None, **changes: Any) -> Job:
    """Compile and assemble a model; parameters and errors as for `run`."""
    found = examined(model, settings, **changes)
    if found.redundancy.findings:
        from .redundancy import refuse_contradictions

        refuse_contradictions(found.redundancy)
    mechanics = found.mechanics()
    start = initial_values(mechanics, found.grid.start)
    settings, choice = found.settings, ""
    if settings.solver == "auto":
        settings, choice = choose(mechanics, settings, found.grid.start)
    return Job(found.data, settings, found.grid, found.redundancy, mechanics, start, choice)


def examined(model: Model | ModelData, settings: RunSettings | None = None, **changes: Any) -> Examined:
    """Compile a model and look for redundant equations; parameters and errors as for `run`."""
    data = model.data() if isinstance(model, Model) else model
    if not isinstance(data, ModelData):
        raise InputError(f"found {model!r}, expected a Model, or a Scene as stiffmbs.load_scene reads it from a file")
    chosen = changed(settings or (data.run if isinstance(data, Scene) else RunSettings()), changes)
    for name in chosen.give_way:
        if name not in data.joints:
            raise InputError(f"give_way: found no joint '{name}', expected one of {', '.join(data.joints) or 'none'}")
    order = [*(name for name in data.joints if name not in chosen.give_way), *chosen.give_way]
    grid = output_grid(chosen)
    system = compile_model(data)
    return Examined(data, chosen, grid, examine(system, grid.start, chosen.duration, order))


def run(
    model: Model | ModelData, settings: RunSettings | None = None, watch: Watch | None = None, **changes: Any
) -> Solution:
    """Solve a model.

    Parameters
    ----------
    model : Model or Scene
        What to solve.
    settings : RunSettings, optional
        How; the scene's own by default.
    watch : callable, optional
        Called with the time reached, s.
    **changes
        Fields of the settings to change: ``duration=2.0, rtol=1e-8``.

    Returns
    -------
    Solution
        Also for a run that stopped early: it then holds what was computed, and `message` says why it ended.

    Raises
    ------
    InputError
        When the model or a setting is wrong.
    AssemblyError
        When no consistent start is found.
    """
    job = prepare(model, settings, **changes)
    trajectory = job.integrate(watch)
    project = _near_constraints(job.settings)
    rows = job.mechanics.report(trajectory.t, trajectory.q, trajectory.u, project=project)
    if not len(rows.t):
        raise AssemblyError(f"no accelerations could be computed at the start: {FAILURES[rows.status]}")
    statistics = {"name": job.settings.solver, **trajectory.statistics}
    if project:
        statistics["drift"] = float(rows.drift.max())
    outcome, message = _ending(rows, trajectory)
    return Solution(
        name=job.data.name, time=rows.t, channels=channels_of(job.mechanics.system, rows), outcome=outcome,
        message=message, notes=tuple(_notes(job, trajectory)), solver=statistics,
        history=trajectory.history, not_unique=job.redundancy.not_unique,
    )  # fmt: skip


def _ending(rows: OutputRows, trajectory: Trajectory) -> tuple[Outcome, str]:
    """How the run ended, and the sentence for it: also stopped where states have no accelerations and reactions."""
    if len(rows.t) == len(trajectory.t):
        return trajectory.outcome, trajectory.message
    t = trajectory.t[len(rows.t)]
    return Outcome.STOPPED, f"no accelerations and reactions were found at t = {t:.9g} s: {FAILURES[rows.status]}"


def _near_constraints(settings: RunSettings) -> bool:
    """Whether states are on the constraints but for the tolerance; those of explicit fixed steps are shown as they are."""
    return settings.solver != "projected" or (settings.projection and settings.scheme in ADAPTIVE)


def changed(settings: RunSettings, changes: dict[str, Any]) -> RunSettings:
    """The settings with some fields changed, checked as a whole.

    Raises
    ------
    InputError
        When a field is unknown or its value out of bounds.
    """
    kept = {name: getattr(settings, name) for name in settings.model_fields_set}
    if {"output", "points"} & changes.keys():
        kept = {name: value for name, value in kept.items() if name not in ("output", "points")}
    return RunSettings(**{**kept, **changes})


def output_grid(settings: RunSettings) -> Grid:
    """The instants to report, from the settings: ends included."""
    start, end = settings.start, settings.start + settings.duration
    if settings.points == "steps":
        return Grid(start, end, None)
    if settings.output is not None:
        count = int(np.floor(settings.duration / settings.output * (1 + 1e-12))) + 1
        times = start + settings.output * np.arange(count)
        times = np.append(times, end) if end - times[-1] > 1e-9 * settings.output else np.append(times[:-1], end)
        return Grid(start, end, times)
    points = settings.points if isinstance(settings.points, int) else DEFAULT_POINTS
    return Grid(start, end, np.linspace(start, end, points))


def channels_of(system: System, rows: OutputRows) -> dict[str, np.ndarray]:
    """All channels by name: bodies, joints and forces, energies, constraint violations."""
    channels: dict[str, np.ndarray] = {}
    for k, body in enumerate(system.bodies):
        for state, names in zip((rows.q, rows.u, rows.acceleration), BODY_CHANNELS, strict=True):
            for offset, name in enumerate(names):
                channels[f"{body}.{name}"] = state[:, 3 * k + offset]
    channels |= requests(system, rows.values)
    channels |= reactions(system, rows.values)
    kinetic, potential = kinetic_energy(system, rows.u), potential_energy(system, rows.values)
    channels["energy.kinetic"], channels["energy.potential"] = kinetic, potential
    channels["energy.total"] = kinetic + potential
    channels["constraint.position"], channels["constraint.velocity"] = rows.position_violation, rows.velocity_violation
    return channels


def _notes(job: Job, trajectory: Trajectory) -> Iterator[str]:
    if job.choice:
        yield job.choice
    if job.redundancy.findings:
        from .redundancy import note_sentences

        yield from note_sentences(job.redundancy)
    if job.start.moved:
        yield job.start.sentence()
    if trajectory.note:
        yield trajectory.note
    if job.settings.solver == "projected" and job.mechanics.system.n_values("switch"):
        yield "projected does not locate the corners that forces have in the state (contacts, step, abs); bdf does"
