"""Bound of the step size by the features of inputs, for compiled code."""

from __future__ import annotations

import numpy as np

from ...compile.inputs.features import NO_FEATURES, InputFeatures
from ...compile.machine.layout import fill
from .native.layouts import STEP_BOUND


class StepBound:
    """Table of step bounds for compiled code (`stiffmbs.solve.events.native.step_bound`), which may be updated.

    Attributes
    ----------
    table : ndarray of int
        Its address does not change.
    """

    def __init__(self) -> None:
        self.table = np.zeros(len(STEP_BOUND), dtype=np.int64)  # no features: its arrays are not read
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
