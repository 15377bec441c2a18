"""Inputs and outputs of a model: VARIABLEs listed by PINPUT and POUTPUT.

An input whose VARIABLE is a number becomes an input of the scene with that number as its default value. One whose
VARIABLE is an expression keeps it.
"""

from __future__ import annotations

from itertools import chain
from typing import TYPE_CHECKING

from .expression import constant

if TYPE_CHECKING:
    from ..scene.mechanism import Mechanism
    from ..statements.dataset import Dataset
    from .function import Function

PLANTS = {"PINVAL": "PINPUT", "POUVAL": "POUTPUT"}
"""Functions of inputs and outputs, and the statements they refer to."""


def input_values(dataset: Dataset) -> dict[str, float]:
    """Return the scene's inputs by name, in the dataset's units.

    Raises DatasetFault if an input or output is not a VARIABLE.
    """
    found = {}
    plants = (dataset.statements.get(keyword, {}).values() for keyword in PLANTS.values())
    for plant in chain.from_iterable(plants):
        for ident in plant.variables:
            variable = dataset.variables.get(ident)
            if variable is None:
                raise plant.fault(f"found VARIABLES = {ident}, expected the number of a VARIABLE")
            value = constant(variable.function.tree)
            if plant.keyword == "PINPUT" and value is not None:
                found[variable.name] = value
    return found


def variable_of_plant(dataset: Dataset, name: str, ident: int, at: int, function: Function) -> int:
    """Return the number of the VARIABLE that PINVAL or POUVAL refers to."""
    plant = dataset.statements.get(PLANTS[name], {}).get(ident)
    if plant is None or not 1 <= at <= len(plant.variables):
        raise function.fault(
            f"found {name}({ident}, {at}), expected a {PLANTS[name]} and the position of one of its variables"
        )
    number: int = plant.variables[at - 1]
    return number


def evaluated_name(mechanism: Mechanism, ident: int, function: Function) -> str:
    """Return the name of SENVAL, the last value of a sensor: an input, zero until an active sensor sets it."""
    dataset = mechanism.dataset
    sensor = dataset.sensors.get(ident)
    if ("SENSOR", ident) not in dataset.inactive and (sensor is None or sensor.evaluated is None):
        raise function.fault(f"found SENVAL({ident}), expected the number of a SENSOR with EVALUATE")
    name = f"SENVAL_{ident}"
    mechanism.inputs.setdefault(name, 0.0)
    return name
