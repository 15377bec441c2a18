"""Derivatives of outputs: formulas of channels and of their peaks, integrals and the like."""

from __future__ import annotations

import ast
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...errors import InputError, SolverError
from ..outputs import REDUCTIONS, TIME, channel_of, evaluated, parsed, parts_of

SELECTED = {
    "peak": lambda x: _largest(np.abs(x)), "max": lambda x: _largest(x), "min": lambda x: _largest(-x),
    "final": lambda x: np.array([len(x) - 1]), "first": lambda x: np.array([0]),
}  # fmt: skip
"""Reductions that select the value at one output time, or at several with equal values up to rounding.

The rate of the channel is zero at a peak, so the shift of the peak does not contribute to the derivative.
"""
SAME, ALIKE = 1e-12, 1e-6
"""Relative differences below which values, and derivatives at output times with the same value, are equal."""
ZERO = 1e-14
"""Magnitude, SI units, below which all values of a channel are rounding of zero."""
WHOLE = ("rms", "mean", "integral")
"""Reductions over all instants."""


def _rounding(x: np.ndarray) -> float:
    """Return the magnitude below which differences of the values of a channel are rounding."""
    return max(SAME * float(np.max(np.abs(x))), ZERO)


def _largest(x: np.ndarray) -> np.ndarray:
    """Return the indices of the output times with the largest value."""
    return np.flatnonzero(x >= np.max(x) - _rounding(x))


def of_whole_time(text: str) -> bool:
    """Return True if an output needs channels at all instants."""
    return any(isinstance(node, ast.Name) and node.id in WHOLE for node in ast.walk(parsed(text)))


@dataclass(frozen=True)
class Dual:
    """Value with its derivatives, in ufuncs of `SLOPES`; a series has them only at the required instants.

    `value` of shape (n,). `slope` of shape (directions,) or (n, directions); a number for no derivatives.
    """

    value: Any
    slope: Any

    def __array_ufunc__(self, function: np.ufunc, method: str, *arguments: object) -> Dual:
        values = [np.asarray(x.value if isinstance(x, Dual) else x, dtype=float) for x in arguments]
        with np.errstate(all="ignore"):
            value = function(*values)
            by = SLOPES[function](value, *values)
        changes = [
            _times(factor, x.slope)
            for factor, x in zip(by, arguments, strict=True)
            if isinstance(x, Dual) and np.ndim(x.slope)
        ]
        return Dual(value, sum(changes, 0.0))


class Formula:
    """Output of a run with its value and derivatives.

    `text`: formula, as in `stiffmbs.sweep`. `time` of shape (n,).
    """

    def __init__(self, text: str, time: np.ndarray, channels: Mapping[str, np.ndarray]) -> None:
        self.text, self._time, self._channels = text, time, channels
        self._tree = parsed(text).body

    def instants(self) -> np.ndarray:
        """Return the indices of the instants at which derivatives of channels are needed."""
        wanted = np.zeros(len(self._time), dtype=bool)
        self._mark(self._tree, np.ones(len(self._time), dtype=bool), wanted)
        return np.flatnonzero(wanted)

    def _mark(self, node: ast.AST, here: np.ndarray, wanted: np.ndarray) -> None:
        match node:
            case ast.Call(ast.Name(name), [argument], []) if name in REDUCTIONS:
                if name not in (*SELECTED, *WHOLE):
                    raise InputError(
                        f"of: found {name} in '{self.text}', expected a channel, {', '.join((*SELECTED, *WHOLE))}"
                    )
                here = np.full_like(here, name in WHOLE)
                if name in SELECTED:
                    here[SELECTED[name](self._series(argument))] = True
                self._mark(argument, here, wanted)
            case _ if channel_of(node) not in (None, TIME):
                wanted |= here
            case _:
                for part in parts_of(node):
                    self._mark(part, here, wanted)

    def _series(self, node: ast.AST) -> np.ndarray:
        value = self._dual(node, dict.fromkeys(self._channels, 0.0)).value
        return np.broadcast_to(np.asarray(value, dtype=float), self._time.shape)

    def dual(self, slopes: Mapping[str, object]) -> Dual:
        """Return the value with its derivatives, from those of the channels, shape (n, directions)."""
        with np.errstate(all="ignore"):
            return self._dual(self._tree, slopes)

    def _dual(self, node: ast.AST, slopes: Mapping[str, object]) -> Dual:
        def channel(name: str) -> Dual:
            """Return a channel with its derivatives."""
            if name == TIME:
                return Dual(self._time, 0.0)
            if name not in slopes:
                raise InputError(
                    f"of: found '{name}' in '{self.text}', which has no derivatives, expected another channel"
                )
            return Dual(self._channels[name], slopes[name])

        found = evaluated(node, channel, self._reduced)
        return found if isinstance(found, Dual) else Dual(found, 0.0)

    def _reduced(self, name: str, x: Dual) -> Dual:
        series, value = np.asarray(x.value, dtype=float), REDUCTIONS[name](self._time, x.value)
        if np.ndim(x.slope) == 0:
            return Dual(value, 0.0)
        if name in SELECTED:
            return Dual(value, self._at_extreme(name, series, x.slope))
        span = 1.0 if name == "integral" else self._time[-1] - self._time[0]
        if name == "rms":
            mean = np.trapezoid(series[:, None] * x.slope, self._time, axis=0) / span
            return Dual(value, mean / value if value > ZERO else 0.0 * mean)  # at zero the mean of both slopes
        return Dual(value, np.trapezoid(x.slope, self._time, axis=0) / span)

    def _at_extreme(self, name: str, series: np.ndarray, slope: np.ndarray) -> np.ndarray:
        """Return the derivative of the selected value.

        Raises SolverError if several output times have this value with different derivatives.
        """
        k = SELECTED[name](series)
        slopes = slope[k] * (np.sign(series[k])[:, None] if name == "peak" else 1.0)
        if np.any(np.ptp(slopes, axis=0) > ALIKE * np.abs(slope).max()):
            raise SolverError(
                f"sensitivities: found that '{self.text}' has its {name} at {len(k)} output times, first at t = {self._time[k[0]]:.9g} s, "
                "with different derivatives; expected a single output time"
            )
        return np.asarray(slopes[0])


def _times(factor: Any, slope: np.ndarray) -> np.ndarray:
    """Multiply a slope by a number, or by a series instant by instant."""
    return factor[:, None] * slope if np.ndim(factor) == 1 else factor * slope


SLOPES: dict[np.ufunc, Callable[..., tuple[object, ...]]] = {
    np.add: lambda y, a, b: (1.0, 1.0), np.subtract: lambda y, a, b: (1.0, -1.0), np.multiply: lambda y, a, b: (b, a),
    np.divide: lambda y, a, b: (1 / b, -y / b), np.power: lambda y, a, b: (b * a ** (b - 1), y * np.log(a)),
    np.negative: lambda y, x: (-1.0,), np.positive: lambda y, x: (1.0,),
    np.absolute: lambda y, x: (np.where(y > _rounding(x), np.sign(x), 0.0),), np.sqrt: lambda y, x: (0.5 / y,),
    np.exp: lambda y, x: (y,), np.log: lambda y, x: (1 / x,), np.sin: lambda y, x: (np.cos(x),),
    np.cos: lambda y, x: (-np.sin(x),), np.tan: lambda y, x: (1 / np.cos(x) ** 2,),
    np.arctan2: lambda y, a, b: (b / (a * a + b * b), -a / (a * a + b * b)), np.hypot: lambda y, a, b: (a / y, b / y),
}  # fmt: skip
"""Derivatives by the arguments, from value and arguments; for ``abs`` near zero, the mean of both sides."""
