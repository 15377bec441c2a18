"""Random laws s -> L(s) for constraints, many of them flat in floating point where the motion starts."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline


@dataclass(frozen=True)
class RandomLaw:
    """A law as a formula with WAY for its argument, its values, and the tables that it calls."""

    text: str
    value: Callable[[float], float]
    tables: dict[str, Any] = field(default_factory=dict)


def random_law(rng: np.random.Generator, start: float, name: str) -> RandomLaw:
    """A law with a feature some way off the start.

    Parameters
    ----------
    rng : Generator
    start : float
        The argument at the start.
    name : str
        Of its table, if it calls one.
    """
    a, k = rng.uniform(-0.6, 0.6), rng.uniform(4, 25)
    at = float(start + rng.choice([-1, 1]) * rng.uniform(0.1, 2.5))
    match rng.integers(10):
        case 0:
            return RandomLaw(f"{a!r}*tanh({k!r}*(WAY - ({at!r})))", lambda s: a * math.tanh(k * (s - at)))
        case 1:
            return RandomLaw(f"{a!r}*exp(-({k!r}*(WAY - ({at!r})))^2)", lambda s: a * math.exp(-((k * (s - at)) ** 2)))
        case 2:
            return RandomLaw(
                f"log(2*cosh({k!r}*(WAY - ({at!r}))))/{k!r}", lambda s: np.logaddexp(k * (s - at), k * (at - s)) / k
            )
        case 3:
            return RandomLaw(f"{a!r}/(1 + exp({k!r}*(WAY - ({at!r}))))", lambda s: a / (1 + math.exp(k * (s - at))))
        case 4:
            return RandomLaw(f"{a!r}*WAY + {a / 3!r}*WAY^2", lambda s: a * s + a / 3 * s**2)
        case 5:
            return RandomLaw(f"{a / 2!r}*sin({k / 4!r}*WAY)", lambda s: a / 2 * math.sin(k / 4 * s))
        case 6:
            return RandomLaw("0*WAY + 0*sin(WAY)*WAY", lambda s: 0.0)
        case 7:
            return RandomLaw(f"{a!r}*WAY", lambda s: a * s)
        case 8:
            return RandomLaw(f"step5(WAY, {at!r}, 0, {at + 0.5!r}, {a!r})", lambda s: a * _step5((s - at) / 0.5))
        case _:
            points = [(start + x, a * _step5(x - d)) for d in (at - start,) for x in np.linspace(-5, 5, 41).tolist()]
            spline = CubicSpline(*zip(*points, strict=True), bc_type="natural")
            return RandomLaw(
                f"{name}(WAY)",
                lambda s: float(spline(s)),
                {name: {"table": [list(point) for point in points], "spline": True}},
            )


def _step5(z: float) -> float:
    z = min(max(z, 0.0), 1.0)
    return z**3 * (10 - 15 * z + 6 * z * z)
