"""Evaluation of requests over a run, from its channels."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial

import numpy as np

from ..compile.table_values import curve
from ..dynamics.storage import allocated, blocks, release
from ..elements.requests.check import ends
from ..elements.requests.order import in_order
from ..elements.requests.output import CONTINUOUS_ANGLES, Output, Term, placeholder
from ..model.model_data import ModelData
from ..reading.formula.functions import FUNCTIONS
from ..reading.formula.nodes import TIME
from ..reading.formula.text import evaluate
from .marker_motion import Channels, MarkerMotion, Motions

Between = Callable[[MarkerMotion, MarkerMotion], np.ndarray]
ALIGNED = 1e-12
"""Sine of the angle between two z axes below which they count as parallel."""

VECTORS: dict[str, Between] = {
    "d": lambda i, j: i.point - j.point,
    "v": lambda i, j: i.velocity - j.velocity,
    "w": lambda i, j: i.omega - j.omega,
    "acc": lambda i, j: i.acceleration - j.acceleration,
    "wdt": lambda i, j: i.alpha - j.alpha,
}
"""Vectors in ground axes, shape (n, 3), by the name of their components without the last letter."""
MAGNITUDES = {f"{kind}m": between for kind, between in VECTORS.items()}


def _distance_rate(i: MarkerMotion, j: MarkerMotion) -> np.ndarray:
    offset = i.point - j.point
    return np.einsum("nk,nk->n", offset, i.velocity - j.velocity) / np.linalg.norm(offset, axis=1)


def _az(i: MarkerMotion, j: MarkerMotion) -> np.ndarray:
    x = i.axis(0, j)
    return np.arctan2(x[:, 1], x[:, 0])


def _psi(i: MarkerMotion, j: MarkerMotion) -> np.ndarray:
    """Return the first Euler angle of the sequence z, x, z; if the z axes are parallel, it is the whole rotation."""
    z = i.axis(2, j)
    return np.where(np.hypot(z[:, 0], z[:, 1]) > ALIGNED, np.arctan2(z[:, 0], -z[:, 1]), _az(i, j))


def _theta(i: MarkerMotion, j: MarkerMotion) -> np.ndarray:
    z = i.axis(2, j)
    return np.arctan2(np.hypot(z[:, 0], z[:, 1]), z[:, 2])


def _phi(i: MarkerMotion, j: MarkerMotion) -> np.ndarray:
    z = j.axis(2, i)
    return np.where(np.hypot(z[:, 0], z[:, 1]) > ALIGNED, np.arctan2(z[:, 0], z[:, 1]), 0.0)


def _quaternion(k: int, i: MarkerMotion, j: MarkerMotion) -> np.ndarray:
    return i.relative(j)[:, k]


SCALARS: dict[str, Between] = {
    "vr": _distance_rate,
    "psi": _psi, "theta": _theta, "phi": _phi,
    **{f"q{k}": partial(_quaternion, k) for k in range(4)},
}  # fmt: skip
"""Scalar measures, shape (n,)."""


AXES = "xyz"
Functions = Mapping[str, Callable[..., object]]
_FUNCTIONS: Functions = {name: function.array for name, function in FUNCTIONS.items()}


def requested(model: ModelData, time: np.ndarray, channels: Channels, counters: Channels) -> dict[str, np.ndarray]:
    """Return the requests of a model at each instant.

    `time` of shape (n,): times, s. `channels`: channels of bodies, joints, forces and the whole model, shape (n,).
    `counters`: revolution counters of angles, as `ModelData.angle_counters` names them, rad, shape (n,). The result:
    values by channel, shape (n,), in the order of the model.
    """
    outputs = model.outputs()
    functions = {name: _functions_of(output) for name, output in outputs.items()}
    order = in_order(outputs)
    found = {name: allocated(len(time)) for name in outputs}
    for block in blocks(len(time)):
        known: dict[str, np.ndarray] = {name: values[block] for name, values in channels.items()}
        terms = _Terms(model, known, {name: values[block] for name, values in counters.items()}, len(time[block]))
        with np.errstate(all="ignore"):
            for name in order:
                known[name] = _value(outputs[name], time[block], known, terms, functions[name])
        for name, values in found.items():
            values[block] = known[name]
        release(*channels.values(), *found.values())
    return found


def value_over_time(
    model: ModelData, output: Output, time: np.ndarray, channels: Channels, counters: Channels
) -> np.ndarray:
    """Return a request at each instant, given the channels that it reads; parameters as for `requested`."""
    with np.errstate(all="ignore"):
        return _value(output, time, channels, _Terms(model, channels, counters, len(time)), _functions_of(output))


def _functions_of(output: Output) -> Functions:
    """Return the functions that a request may call."""
    return {**_FUNCTIONS, **{called: curve(table) for called, table in output.tables.items()}}


def _value(output: Output, time: np.ndarray, channels: Channels, terms: _Terms, functions: Functions) -> np.ndarray:
    of_terms = {placeholder(k): term for k, term in enumerate(output.terms)}

    def names(name: str) -> object:
        """Return the values over time of a name."""
        if name == TIME:
            return time
        if name in output.quantities:
            return np.float64(output.quantities[name].value)
        if name in of_terms:
            return terms.value(of_terms[name])
        return channels[name]

    values = evaluate(output.tree, names, functions, np.float64)  # divides by zero without an error
    return np.array(np.broadcast_to(np.asarray(values, dtype=float), time.shape))


class _Terms:
    """Measures between markers and actions of elements, each computed once."""

    def __init__(self, model: ModelData, channels: Channels, counters: Channels, count: int) -> None:
        self._model, self._channels, self._counters = model, channels, counters
        self._motions = Motions(model, channels, count)
        self._known: dict[Term, np.ndarray] = {}

    def value(self, term: Term) -> np.ndarray:
        """Return the values of a term over time."""
        if term not in self._known:
            self._known[term] = self._action(term) if term.element else self._measure(term)
        return self._known[term]

    def _measure(self, term: Term) -> np.ndarray:
        if term.function in CONTINUOUS_ANGLES:
            return self._motions.continuous_angle(term, self._counters)
        i, j, *axes = (self._motions.of(marker) for marker in term.markers)
        name = term.function
        if name in MAGNITUDES:
            return np.linalg.norm(MAGNITUDES[name](i, j), axis=1)
        if name in SCALARS:
            return SCALARS[name](i, j)
        vectors = VECTORS[name[:-1]](i, j)
        return (axes[0].along(vectors) if axes else vectors)[:, AXES.index(name[-1])]

    def _action(self, term: Term) -> np.ndarray:
        force, torque = self._motions.action(term.element)
        if term.on_second:
            i, j = (self._motions.of(marker).point for marker in ends(term.element, self._model))
            force, torque = -force, -torque - np.cross(i - j, force)
        acting = force if term.function[0] == "f" else torque
        if term.function[1] == "m":
            return np.linalg.norm(acting, axis=1)
        axes = [self._motions.of(marker) for marker in term.markers]
        return (axes[0].along(acting) if axes else acting)[:, AXES.index(term.function[1])]
