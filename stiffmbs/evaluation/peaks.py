"""Least and greatest values of channels over a run, between its output times too."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Unpack

import numpy as np

from ..analyses.job import Job, Runnable, data_of, prepare, with_elements
from ..analyses.run import run, solved
from ..analyses.start_from import StartFrom
from ..errors import InputError, SolverError
from ..model.scene import Scene
from ..model.settings import RunSettings, Settings, takes_settings
from ..results.channels import named
from ..results.solution import Solution
from ..solve.trajectory import Outcome
from ..verification.missed_events import apart, more_instants
from .parameters import EVALUATION


@dataclass(frozen=True)
class Peak:
    """Least and greatest value of a channel.

    Attributes
    ----------
    least, greatest : float
        In the unit of the channel; NaN if no value is known.
    t_least, t_greatest : float
        When they occur, s.
    """

    least: float
    t_least: float
    greatest: float
    t_greatest: float


@takes_settings
def peaks(
    model: Runnable,
    channels: str | Sequence[str] = (),
    settings: RunSettings | None = None,
    start_from: StartFrom | None = None,
    **changes: Unpack[Settings],
) -> dict[str, Peak]:
    """Return the least and the greatest value of channels over a run, between its output times too.

    The run is repeated with output times within the solver's steps, and twice with more of them around the extreme
    values. These are those of the solution that the solver interpolates, so that their errors are those of the run.

    Parameters
    ----------
    model : Model, Scene, str or Path
        A model, a scene, or the file of a scene.
    channels : str or sequence of str, optional
        Names of channels; by default the requests of the model.
    settings : RunSettings, optional
        Settings of the run; by default those of the scene.
    start_from : Solution, str, Path or SavedState, optional
        State to start from, as for `run`.
    **changes
        Fields of the settings to change: ``rtol=1e-8``.

    Returns
    -------
    dict of str to Peak

    Raises
    ------
    InputError
        If a channel is unknown, or the scene has stages.
    SolverError
        If the run does not come to its end.

    Examples
    --------
    >>> import stiffmbs
    >>> found = stiffmbs.peaks("examples/bar_pendulum.yaml", ["hinge.fy"], points=20, rtol=1e-9)["hinge.fy"]
    >>> print(f"{found.greatest:.4f} N, 2.5 m g = {2.5*1.2*9.81:.4f} N")
    29.4300 N, 2.5 m g = 29.4300 N
    """
    data = data_of(model)
    if isinstance(data, Scene) and data.stages:
        raise InputError("peaks: found a scene with stages, expected one without: evaluate each stage by itself")
    data = with_elements(data, lambda scene: run(scene, settings, None, start_from, **changes))
    job = prepare(data, settings, start_from, **changes)
    first = _solved(job)
    names = [channels] if isinstance(channels, str) else list(channels or data.requests)
    if not names:
        raise InputError("peaks: found no channels and no requests, expected names of channels such as 'hinge.fy'")
    for name in names:
        named(first.channels, name)
    features = job.dynamics.input_features(float(first.time[0]), float(first.time[-1]))
    runs = [first, _solved(job.varied(times=more_instants(first, features)))]
    for _ in range(EVALUATION.rounds):
        runs.append(_solved(job.varied(times=_around_extremes(first.time, runs[-1], names))))
    return {name: _peak(runs, name) for name in names}


def _solved(job: Job) -> Solution:
    found = solved(job)
    if found.outcome is not Outcome.DONE:
        raise SolverError(f"peaks: the run does not come to its end: {found.message}")
    return found


def _around_extremes(reported: np.ndarray, run: Solution, names: Sequence[str]) -> np.ndarray:
    """Return output times, and times around the extreme values of channels in a run."""
    t, last = run.time, len(run.time) - 1
    found = reported
    for k in sorted({row for name in names for row in _extremes(run[name])}):
        begin, end = t[max(k - 1, 0)], t[min(k + 1, last)]
        within = np.linspace(begin, end, 2 * EVALUATION.parts + 1)
        found = np.union1d(found, apart(np.append(within, t[k]), found))
    return found


def _peak(runs: Sequence[Solution], name: str) -> Peak:
    t = np.concatenate([run.time for run in runs])
    values = np.concatenate([run[name] for run in runs])
    low, high = _extremes(values)
    return Peak(float(values[low]), float(t[low]), float(values[high]), float(t[high]))


def _extremes(values: np.ndarray) -> tuple[int, int]:
    """Return where the least and the greatest value are; the first place if no value is known."""
    if np.isnan(values).all():
        return 0, 0
    return int(np.nanargmin(values)), int(np.nanargmax(values))
