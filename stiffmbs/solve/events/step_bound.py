"""The longest steps that see what the inputs do, for compiled code."""

from __future__ import annotations

import numpy as np

from ...compile.inputs.features import NO_FEATURES, InputFeatures
from ...compile.machine.layout import fill
from ..native.tables.steps import STEP_BOUND


class StepBound:
    """A table for compiled code (`stiffmbs.solve.native.step_bound`) whose content may change.

    Attributes
    ----------
    table : ndarray of int
        It stays where it is.
    """

    def __init__(self) -> None:
        self.table = np.zeros(len(STEP_BOUND), dtype=np.int64)  # no features: none of its arrays is read
        self._cells = self.table.view(STEP_BOUND.cells)[0]
        self._followed = NO_FEATURES

    def follow(self, features: InputFeatures) -> None:
        """Bound steps by these features from now on."""
        self._cells["place"] = 0
        if features is self._followed:
            return
        self._followed = features
        if not len(features.starts):
            self.table[:] = 0
            return
        self._kept = {
            "n": len(features.starts), "starts": np.ascontiguousarray(features.starts), "longest": np.ascontiguousarray(features.longest),
        }  # fmt: skip
        fill(self.table, STEP_BOUND, self._kept)
