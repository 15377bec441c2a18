"""Values that a run is given for the inputs of a model."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, TypeAlias

import numpy as np

from ..describe.files.quoted import written
from ..describe.model_data import ModelData
from ..describe.settings import RunSettings
from ..describe.states.amount import Amount
from ..describe.table import Table
from ..errors import InputError
from ..solve.settings import output_grid

Given: TypeAlias = float | Callable[[float], float] | tuple[Any, Any] | Table
"""A constant, a function of t, s, or times and values with straight lines between."""
SAMPLES = 1001
"""At which functions are read where a run reports its own steps."""


def with_inputs(data: ModelData, inputs: Mapping[str, Given] | None, settings: RunSettings) -> ModelData:
    """A model with other values of its inputs.

    Parameters
    ----------
    data : ModelData
    inputs : mapping of str to number, callable, (times, values) or Table
        A callable is read at the output instants, with straight lines between.
    settings : RunSettings
        Of the run.

    Raises
    ------
    InputError
        When the model has no such input, or a value is no finite number.
    """
    if not inputs:
        return data
    for name in inputs:
        if name not in data.inputs:
            raise InputError(f"inputs: found no input '{name}', expected one of {', '.join(data.inputs) or 'none'}")
    return data.model_copy(
        update={"inputs": {**data.inputs, **{name: _value(name, given, settings) for name, given in inputs.items()}}}
    )


def _value(name: str, given: Given, settings: RunSettings) -> Amount | Table:
    if isinstance(given, Table):
        return given
    if callable(given):
        grid = output_grid(settings)
        times = grid.times if grid.times is not None else np.linspace(grid.start, grid.end, SAMPLES)
        return _table(name, times, [_number(name, given(float(t))) for t in times])
    if isinstance(given, tuple | list):
        if len(given) != 2 or len(given[0]) != len(given[1]):
            raise InputError(
                f"inputs: found {written(given)} for '{name}', expected as many values as times: (times, values)"
            )
        return _table(name, given[0], [_number(name, value) for value in given[1]])
    return Amount(_number(name, given))


def _table(name: str, times: Any, values: list[float]) -> Table:
    try:
        return Table(table=[(float(t), value) for t, value in zip(times, values, strict=True)], lines=True)
    except InputError as error:
        raise InputError(f"inputs: {name}: {error}") from None


def _number(name: str, found: Any) -> float:
    try:
        value = float(found)
    except (TypeError, ValueError):
        value = np.nan
    if not np.isfinite(value):
        raise InputError(f"inputs: found {written(found)} for '{name}', expected a finite number")
    return value
