"""Derivatives of outputs by parameters within ranges, at points of the unit cube."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...analyses.job import Job, prepare
from ...analyses.renumber import renumbered
from ...model.files.written_scene import WrittenScene
from ...model.settings import RunSettings
from ..parameters import Sought
from .parameters import Scenes
from .sensitivities import DifferentiatedRun, differentiable


class Gradients:
    """Derivatives of outputs; data common to all points is read and compiled once.

    Parameters
    ----------
    texts : sequence of str
        Outputs, formulas of channels.
    times : ndarray, optional
        Output instants that replace those of the settings.
    """

    def __init__(
        self, written: WrittenScene, ranges: Sought, texts: Sequence[str], settings: RunSettings,
        times: np.ndarray | None = None,
    ) -> None:  # fmt: skip
        self._scenes, self._ranges, self._texts = Scenes(written), ranges, texts
        self._settings, self._times = differentiable(settings), times
        self._job: Job | None = None

    def at(self, point: np.ndarray) -> list[np.ndarray]:
        """Return the derivatives of each output by the coordinates of a point, shape (..., parameters).

        Raises StiffmbsError as for `stiffmbs.sensitivities`.
        """
        names, values = self._ranges.names, self._ranges.values(point)
        scenes = self._scenes.at(list(zip(names, values, strict=True)))
        known = self._job and renumbered(self._job, scenes.known)
        self._job = known or prepare(scenes.known, self._settings)
        run = DifferentiatedRun(scenes, names, self._job, self._times)
        spans = self._ranges.slopes(point)
        return [
            np.stack([found.to[name] for name in names], axis=-1) * spans for found in run.sensitivities(self._texts)
        ]
