"""Files of saved simulations: channels of the state, the state itself, and the inputs."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ..analyses.start_from import StartFrom
from ..errors import InputError
from ..results.files import written_whole
from ..results.provenance import PROVENANCE, Provenance
from ..results.saved_state import TURNS, SavedState

INPUT = "simulation/input/"
"""Prefix of the names of inputs."""
EXACT = "simulation/state"
"""Name of the coordinates and velocities."""


def write_simulation(
    path: str | Path, t: float, state: SavedState, inputs: Mapping[str, float], provenance: Provenance
) -> None:
    """Write a state at a time, s, and inputs to a file; raise an InputError if its suffix is not .npz."""
    file = Path(path)
    if file.suffix != ".npz":
        raise InputError(f"save {file}: found the ending '{file.suffix}', expected .npz")
    content: dict[str, Any] = {name: np.array([value]) for name, value in state.channels.items()}
    content |= {TURNS + name: np.array([value]) for name, value in state.turns.items()}
    content |= {INPUT + name: np.array(value) for name, value in inputs.items()}
    content[EXACT], content[PROVENANCE] = state.exact, np.array(provenance.as_json())
    written_whole(file, lambda part: np.savez(part, time=np.array([t]), **content))


def inputs_and_state(path: StartFrom, exact: np.ndarray | None) -> tuple[dict[str, float], np.ndarray | None]:
    """Return the inputs of a file, and its coordinates and velocities; of others no inputs, and the given ones."""
    if not isinstance(path, str | Path) or Path(path).suffix != ".npz":
        return {}, exact
    with np.load(path) as archive:
        inputs = {k.removeprefix(INPUT): float(archive[k]) for k in archive.files if k.startswith(INPUT)}
        return inputs, archive.get(EXACT)


def exactly_saved(q: np.ndarray, u: np.ndarray, exact: np.ndarray | None) -> tuple[np.ndarray, np.ndarray]:
    """Return saved coordinates and velocities if they are those of the channels, which rounding has changed, else these."""
    by_channels = np.concatenate([q, u])
    if exact is None or exact.shape != by_channels.shape or not np.allclose(exact, by_channels, rtol=1e-9, atol=1e-9):
        return q, u
    return exact[: len(q)], exact[len(q) :]
