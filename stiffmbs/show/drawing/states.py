"""A model at the start of its run, or at a later instant, as poses with forces."""

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
    """What a model is, and where its bodies are at an instant, with the forces that act then.

    Parameters
    ----------
    model : Model, Scene, str or Path
    settings : RunSettings, optional
    at : float, optional
        s; the start of the run by default.
    **changes
        Fields of the settings to change.

    Raises
    ------
    InputError, AssemblyError
        As for `stiffmbs.run`.
    SolverError
        Where no motion leads to that instant.
    """
    found = at_state(model, settings, at, **changes)
    state, time = found.dynamics.state, np.array([found.t])
    rows = found.dynamics.report(time, state.q[None].copy(), state.u[None].copy(), project=False)
    channels = channels_of(found.data, found.dynamics.system, rows)
    return found.data, poses_of(found.data, time, channels)
