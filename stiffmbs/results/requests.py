"""Evaluation of requests over a run, from its channels."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from functools import cache

import numpy as np

from ..compile.table_values import curve
from ..dynamics.storage import allocated, blocks, release
from ..elements.requests.order import in_order, units
from ..elements.requests.output import Output, Term, placeholder
from ..model.model_data import ModelData
from ..reading.formula.functions import FUNCTIONS
from ..reading.formula.nodes import TIME
from ..reading.formula.text import evaluate
from .marker_motion import Measures
from .scales import UNITS, kind_of

Channels = Mapping[str, np.ndarray]
"""Channels by name, shape (n,)."""
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
        counted = {name: values[block] for name, values in counters.items()}
        measured = _measured(model, known, counted)
        with np.errstate(all="ignore"):
            for name in order:
                known[name] = _value(outputs[name], time[block], known, measured, functions[name])
        for name, values in found.items():
            values[block] = known[name]
        release(*channels.values(), *found.values())
    return found


def value_over_time(
    model: ModelData, output: Output, time: np.ndarray, channels: Channels, counters: Channels
) -> np.ndarray:
    """Return a request at each instant, given the channels that it reads; parameters as for `requested`."""
    with np.errstate(all="ignore"):
        return _value(output, time, channels, _measured(model, channels, counters), _functions_of(output))


def _measured(model: ModelData, channels: Channels, counters: Channels) -> Callable[[Term], object]:
    """Return a function for the terms of requests over time, each of which is computed once."""
    return cache(Measures(model, channels.__getitem__, counters.__getitem__, np).value)


def _functions_of(output: Output) -> Functions:
    return {**_FUNCTIONS, **{called: curve(table) for called, table in output.tables.items()}}


def _value(
    output: Output, time: np.ndarray, channels: Channels, measured: Callable[[Term], object], functions: Functions
) -> np.ndarray:
    of_terms = {placeholder(k): term for k, term in enumerate(output.terms)}

    def names(name: str) -> object:
        """Return what a name of the formula stands for."""
        if name == TIME:
            return time
        if name in output.quantities:
            return np.float64(output.quantities[name].value)
        if name in of_terms:
            return measured(of_terms[name])
        return channels[name]

    values = evaluate(output.tree, names, functions, np.float64)  # divides by zero without an error
    return np.array(np.broadcast_to(np.asarray(values, dtype=float), time.shape))


def units_of(data: ModelData, names: Collection[str]) -> Mapping[str, str]:
    """Return the SI units of channels and requests by name, without those of plain numbers and unknown ones."""
    requested = units(data.outputs())
    found = {name: requested[name] if name in requested else UNITS.get(kind_of(name), "") for name in names}
    return {name: unit for name, unit in found.items() if unit}
