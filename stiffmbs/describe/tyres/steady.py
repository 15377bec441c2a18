"""Numerical evaluation of the Magic Formula at given loads and slips, without a model."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import lru_cache
from types import SimpleNamespace
from typing import Any

import numpy as np

CHOICES = ("is_combined", "mode", "is_mirrored", "side", "deflection_load", "bottoming")
"""Properties that are not numbers; `is_combined` is the only one with an effect here."""
OUTPUTS = ("longitudinal", "lateral", "overturning", "rolling", "aligning")


def steady_wrench(
    numbers: Mapping[str, Any], load: Any, slip: Any, slip_angle: Any, camber: Any, speed: Any, friction: Any
) -> dict[str, np.ndarray]:
    """Return forces and torques by the names of a tyre's channels; arguments may be arrays that broadcast."""
    values = {name: value for name, value in numbers.items() if name not in CHOICES}
    states = [np.asarray(x, dtype=float) for x in (np.minimum(load, values["FZMAX"]), slip, slip_angle, camber)]
    function = _function(tuple(values), bool(numbers["is_combined"]))
    found = function(*values.values(), *states, np.asarray(speed) / values["LONGVL"], friction)
    shape = np.broadcast_shapes(*(np.shape(x) for x in (*states, speed, friction)))
    return {name: np.broadcast_to(x, shape).copy() for name, x in zip(OUTPUTS, found, strict=True)}


@lru_cache(maxsize=4)
def _function(names: tuple[str, ...], is_combined: bool) -> Callable[..., Any]:
    import sympy as sp

    from .magic_formula import Slip, wrench

    numbers = sp.symbols(names, real=True)
    load, slip, slip_angle, camber, speed, friction = of = sp.symbols("N kappa alpha gamma v mu", real=True)
    state = Slip(load, slip, slip_angle, camber, speed, sp.Integer(1), friction)
    coefficients = SimpleNamespace(**dict(zip(names, numbers, strict=True)))
    expressions = wrench(coefficients, state, lambda x: x, is_combined)
    function: Callable[..., Any] = sp.lambdify([*numbers, *of], expressions, "numpy", cse=True)
    return function
