"""Natural modes in motion, one at a time, on a page."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from ...analyses.linearised.modes import Modes
from ...errors import InputError, SolverError
from ...linear_analysis.modes import Motion
from ...results.files import write_text
from ...results.provenance import provenance_of
from ...results.solution import Solution
from ..drawing.deformed import true_to_scale
from ..drawing.derive import drawing_of
from ..drawing.poses import poses_of
from ..flexible_body import MOST_FREQUENCIES
from ..origin import page_with_origin
from .data import moving_page, page_data

POINTS = 31
"""Instants of one period."""
AMPLITUDE = 0.05
"""Largest displacement relative to the size of the mechanism."""


def modes_data(found: Modes, amplitude: float = AMPLITUDE) -> dict[str, str] | None:
    """Return the data of a page with the modes that can be shown with an amplitude; None if there are none.

    Flexible bodies have the deformation of the mode, without the scale and the stress colors of motions.
    """
    shapes: dict[str, Solution] = {}
    for number, mode in enumerate(found.modes, start=1):
        if len(shapes) == MOST_FREQUENCIES or mode.motion is Motion.RIGID:
            continue
        try:
            shape = found.shape(number, amplitude, POINTS)
        except SolverError:
            continue
        shapes[f"{number}: {mode.natural_frequency:.4g} Hz, damping {mode.damping_ratio:.2g}"] = shape
    if not shapes:
        return None
    data = found.about.data
    poses = {name: poses_of(data, shape.time, shape.channels) for name, shape in shapes.items()}
    drawing = true_to_scale(drawing_of(data, along=next(iter(poses.values()))))
    return page_data(replace(drawing, loads={}), poses, choose="Mode")


def write_modes(path: Path, found: Modes, amplitude: float) -> None:
    """Write the page to a file, completely or not at all. Raises InputError if no mode can be shown."""
    data = modes_data(found, amplitude)
    if data is None:
        raise InputError(f"-o {path}: found no mode that can be shown, expected a vibration and a smaller --amplitude")
    page = moving_page(f"Modes of {found.name or 'the model'}", data)
    write_text(path, page_with_origin(page, provenance_of(found.about.data)))
