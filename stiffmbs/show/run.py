"""The main job: a model is compiled, assembled, solved and turned into channels."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..analyse.energy import kinetic_energy, potential_energy
from ..analyse.reactions import reactions
from ..compile.system import System, compile_model
from ..describe.model import Model, ModelData
from ..describe.scene import Scene
from ..describe.settings import RunSettings
from ..solve import SOLVERS
from ..solve.initial import initial_values
from ..solve.mechanics import Mechanics, OutputRows
from ..solve.trajectory import Grid, Trajectory, Watch
from .solution import Solution

DEFAULT_POINTS = 1001
BODY_CHANNELS = (("x", "y", "angle"), ("vx", "vy", "omega"), ("ax", "ay", "alpha"))


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
    data = model.data() if isinstance(model, Model) else model
    chosen = settings or (data.run if isinstance(data, Scene) else RunSettings())
    chosen = changed(chosen, changes)
    grid = output_grid(chosen)
    mechanics = Mechanics(compile_model(data))
    start = initial_values(mechanics, grid.start)
    trajectory = SOLVERS[chosen.solver](mechanics, start, grid, chosen, watch or (lambda t: None))
    projected = chosen.solver == "bdf"  # the explicit solver's states are shown as they are
    rows = mechanics.report(trajectory.t, trajectory.q, trajectory.u, projected)
    notes = tuple(note for note in (start.sentence(), *_report_notes(rows, trajectory)) if note)
    statistics = {"name": chosen.solver, **trajectory.statistics}
    if projected:
        statistics["drift"] = float(rows.drift.max())
    return Solution(
        name=data.name, time=rows.t, channels=channels_of(mechanics.system, rows), outcome=trajectory.outcome,
        message=trajectory.message, notes=notes, solver=statistics, step_times=trajectory.step_times,
    )  # fmt: skip


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
    channels |= reactions(system, rows.values)
    kinetic, potential = kinetic_energy(system, rows.u), potential_energy(system, rows.values)
    channels["energy.kinetic"], channels["energy.potential"] = kinetic, potential
    channels["energy.total"] = kinetic + potential
    channels["constraint.position"], channels["constraint.velocity"] = rows.position_violation, rows.velocity_violation
    return channels


def _report_notes(rows: OutputRows, trajectory: Trajectory) -> list[str]:
    if len(rows.t) == len(trajectory.t):
        return []
    t = trajectory.t[len(rows.t)]
    return [
        f"from t = {t:.9g} s on no reactions could be computed, the constraint equations depend on each other there"
    ]
