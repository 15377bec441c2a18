"""Channels of states: their values and rates, and the outputs of their equations."""

from __future__ import annotations

import numpy as np

from ..compile.system import System
from ..compile.terms import TERM_SETS


def state_channels(system: System, q: np.ndarray, values: np.ndarray) -> dict[str, np.ndarray]:
    """Return values and rates of states, and outputs, by name.

    Parameters
    ----------
    system : System
    q : ndarray, shape (n, n_q)
    values : ndarray
        Values of the set ``output``, one row per instant.
    """
    channels = {name: q[:, system.first_state + k] for k, name in enumerate(system.states)}
    algebraic = {name for name, is_algebraic in zip(system.states, system.algebraic, strict=True) if is_algebraic}
    for name, signal in _signals(system, values):
        if name not in algebraic:  # the signal of an algebraic state is always zero
            channels[f"{name}.rate" if name in channels else name] = signal
    return channels


def _signals(system: System, values: np.ndarray) -> list[tuple[str, np.ndarray]]:
    place = TERM_SETS["output"].index("signal")
    return [
        (name, values[:, system.places["output"][g, 1 + place] + k])
        for g, group in enumerate(system.groups)
        if group.entries["signal"]
        for k, name in enumerate(group.names)
    ]
