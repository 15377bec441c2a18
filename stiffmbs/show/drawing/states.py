"""Poses and forces of a model at the start of its run, or at a later instant."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...analyses.linearised.at_state import at_state
from ...describe.model_data import ModelData
from ...describe.settings import RunSettings
from ...results.channels import channels_of
from .poses import Poses, poses_of


def poses_at(
    model: Any, settings: RunSettings | None = None, at: float | None = None, **changes: Any
) -> tuple[ModelData, Poses]:
    """Return the data of a model, and its poses at an instant with the acting forces.

    Parameters
    ----------
    model : Model, Scene, str or Path
    settings : RunSettings, optional
    at : float, optional
        Time, s; the start of the run by default.
    **changes
        Fields of the settings to change.

    Raises
    ------
    InputError, AssemblyError
        As for `stiffmbs.run`.
    SolverError
        If the run does not reach that instant.
    """
    found = at_state(model, settings, at, **changes)
    state, time = found.dynamics.state, np.array([found.t])
    rows = found.dynamics.report(time, state.q[None].copy(), state.u[None].copy(), project=False)
    channels = channels_of(found.data, found.dynamics.system, rows)
    return found.data, poses_of(found.data, time, channels)
