"""Inputs of a simulation that are constant over each of its steps."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..compile.machine.layout import address, packed
from ..compile.machine.object_code import SHORT
from ..compile.machine.routines import Routine
from .native.layouts import HELD_INPUTS

HOLD = Routine("stiffmbs.dynamics.native.held_inputs", "hold", "int64(float64*, int64*)", level=SHORT)


class AffineNumber(NamedTuple):
    """Number of a force, numbers[place] = offset + slope * value of the input with index `input`."""

    numbers: np.ndarray
    place: int
    input: int
    offset: float
    slope: float


class HeldInputs:
    """Values of inputs, and the numbers of forces that are affine functions of one of them.

    `values`: current values, read only. `least`, `largest`: bounds of the values that may be taken, initially the current
    ones. `wanted`: next values, for the caller to fill. `numbers`: of forces. `table`: addresses (`stiffmbs.dynamics.native.layouts.HELD_INPUTS`).
    """

    def __init__(self, values: Sequence[float], numbers: Sequence[AffineNumber]) -> None:
        self.values = np.array(values, dtype=float)
        self.least, self.largest = self.values.copy(), self.values.copy()
        self.wanted = self.values.copy()
        self.numbers = tuple(numbers)
        self._arrays = {
            "value": self.values, "least": self.least, "largest": self.largest,
            "number": np.array([address(each.numbers) + 8 * each.place for each in numbers], dtype=np.int64),
            "input": np.array([each.input for each in numbers], dtype=np.int64),
            "offset": np.array([each.offset for each in numbers], dtype=float),
            "slope": np.array([each.slope for each in numbers], dtype=float),
        }  # fmt: skip
        self.table = packed(HELD_INPUTS, {"n": len(self.values), "n_numbers": len(numbers), **self._arrays})
        self._hold, self._at = HOLD.short_call, (address(self.wanted), address(self.table))

    def write(self) -> None:
        """Write the numbers of the current values."""
        for each in self.numbers:
            each.numbers[each.place] = each.offset + each.slope * self.values[each.input]

    def hold(self) -> int:
        """Take the wanted values; return 1 if any has changed, 0 if none, or a failure, with nothing changed, if one is out of its bounds."""
        return self._hold(*self._at)  # type: ignore[no-any-return]
