"""Requests in space: what their formulas give over a run, from its channels."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from ..compile.table_values import curve
from ..describe.formula.field import TIME
from ..describe.formula.functions import FUNCTIONS
from ..describe.formula.text import evaluate
from ..describe.spatial.output import ACTIONS, COUNTED_ANGLES, Output, Term, ends, placeholder
from .marker_measures import MAGNITUDES, SCALARS, VECTORS
from .marker_motion import Motions

AXES = "xyz"


def outputs(
    model: Any, time: np.ndarray, channels: Mapping[str, np.ndarray], counted: Mapping[str, np.ndarray]
) -> dict[str, np.ndarray]:
    """The requests of a model in space at each instant.

    Parameters
    ----------
    model : SpatialData
    time : ndarray, shape (n,)
        s.
    channels : mapping of str to ndarray
        Of bodies, joints and forces, shape (n,).
    counted : mapping of str to ndarray
        The angles over whole turns, as `SpatialData.counted_angles` names them, rad, shape (n,).

    Returns
    -------
    dict of str to ndarray
        By channel, shape (n,).
    """
    terms = _Terms(model, time, channels, counted)
    with np.errstate(all="ignore"):
        return {name: _value(output, time, channels, terms) for name, output in model.outputs()}


def _value(output: Output, time: np.ndarray, channels: Mapping[str, np.ndarray], terms: _Terms) -> np.ndarray:
    of_terms = {placeholder(k): term for k, term in enumerate(output.terms)}

    def names(name: str) -> Any:
        if name == TIME:
            return time
        if name in output.values:
            return np.float64(output.values[name])
        if name in of_terms:
            return terms.value(of_terms[name])
        return channels[name]

    tables = {name: curve(table) for name, table in output.tables.items()}
    values = evaluate(output.tree, names, _FUNCTIONS | tables, np.float64)  # divides by zero without complaint
    return np.array(np.broadcast_to(np.asarray(values, dtype=float), time.shape))


class _Terms:
    """Measures between markers and actions of elements, each computed once."""

    def __init__(
        self, model: Any, time: np.ndarray, channels: Mapping[str, np.ndarray], counted: Mapping[str, np.ndarray]
    ) -> None:
        self._model, self._channels, self._counted = model, channels, counted
        self._motions = Motions(model, channels, len(time))
        self._known: dict[Term, np.ndarray] = {}

    def value(self, term: Term) -> np.ndarray:
        """What a term is over time."""
        if term not in self._known:
            self._known[term] = self._action(term) if term.function in ACTIONS else self._measure(term)
        return self._known[term]

    def _measure(self, term: Term) -> np.ndarray:
        if term.function in COUNTED_ANGLES:
            return self._counted[str(term)]
        i, j, *axes = (self._motions.of(marker) for marker in term.markers)
        name = term.function
        if name in MAGNITUDES:
            return np.linalg.norm(MAGNITUDES[name](i, j), axis=1)
        if name in SCALARS:
            return SCALARS[name](i, j)
        vectors = VECTORS[name[:-1]](i, j)
        return (axes[0].along(vectors) if axes else vectors)[:, AXES.index(name[-1])]

    def _action(self, term: Term) -> np.ndarray:
        force, torque = (
            np.column_stack([self._channels[f"{term.element}.{kind}{axis}"] for axis in AXES]) for kind in "ft"
        )
        if term.on_second:
            i, j = (self._motions.of(marker).point for marker in ends(term.element, self._model))
            force, torque = -force, -torque - np.cross(i - j, force)
        acting = force if term.function[0] == "f" else torque
        if term.function[1] == "m":
            return np.linalg.norm(acting, axis=1)
        axes = [self._motions.of(marker) for marker in term.markers]
        return (axes[0].along(acting) if axes else acting)[:, AXES.index(term.function[1])]


_FUNCTIONS: dict[str, Callable[..., Any]] = {name: function.array for name, function in FUNCTIONS.items()}
