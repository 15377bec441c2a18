"""Conversion of requests, variables and sensors to requests of a scene."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Mapping

from ...elements.spatial.number_format import plain
from ..functions.function import Function
from ..functions.measures import COMPONENTS
from ..functions.translate_output import ANGLES, OutputTranslation
from ..functions.trees import measured
from ..statements.dataset import Dataset
from ..statements.outputs import Request
from ..statements.sensor import Sensor
from ..statements.text import DatasetFault
from ..statements.units import Units
from .mechanism import Mechanism

EVALUATED = "_evaluate"
"""Name suffix for the request of a sensor's EVALUATE expression."""


def conditions(dataset: Dataset, inputs: Mapping[str, float]) -> dict[str, object]:
    """Return the end conditions by name; each watches the request of its name and may set inputs of the scene."""
    return {sensor.name: _condition(sensor, inputs, dataset.units) for sensor in dataset.active_sensors}


def _condition(sensor: Sensor, inputs: Mapping[str, float], units: Units) -> dict[str, object]:
    made: dict[str, object] = {"request": sensor.name, sensor.relation: plain(sensor.value)}
    if sensor.error and (sensor.relation == "equals" or sensor.then == "on"):
        made["within"] = plain(sensor.error)
    if sensor.then != "next":
        made["then"] = sensor.then
    if sensor.interval and sensor.then == "on":
        made["output"] = plain(sensor.interval * units.time)
    name = f"SENVAL_{sensor.ident}"
    return made | ({"sets": {name: sensor.name + EVALUATED}} if sensor.evaluated and name in inputs else {})


def notes(dataset: Dataset) -> Iterator[str]:
    """Yield one sentence for each sensor or argument without effect."""
    for sensor in dataset.sensors.values():
        listed = ", ".join(sensor.left_out)
        if sensor.then and listed:
            yield f"{sensor.label}: {listed} left out: no effect on results"
        elif not sensor.then:
            yield f"{sensor.label} is left out: it does not end the run" + (
                listed and f", and {listed} do not affect results"
            )


MARKED = {
    "DISPLACEMENT": ("DX", "DY", "DZ", "PSI", "THETA", "PHI"),
    "VELOCITY": ("VX", "VY", "VZ", "WX", "WY", "WZ"),
    "ACCELERATION": ("ACCX", "ACCY", "ACCZ", "WDTX", "WDTY", "WDTZ"),
}
"""Components of a request between two markers."""
CALLED = {"DX": "x", "DY": "y", "DZ": "z"}
"""Component names that differ from the measuring function."""


class Requests:
    """Builder of the scene's requests.

    `notes`: one sentence for each component that cannot be reported.
    """

    def __init__(self, mechanism: Mechanism) -> None:
        self._mechanism, self._translation = mechanism, OutputTranslation(mechanism)
        self.notes: list[str] = []

    def all(self) -> dict[str, object]:
        """Return the requests by name: components of requests, variables, and functions of sensors."""
        found: dict[str, object] = {}
        for request in self._mechanism.dataset.requests.values():
            components = self._between_markers(request) if request.sort else self._functions(request)
            if components:
                found[request.name] = components
        for variable in self._mechanism.dataset.variables.values():
            if variable.name in self._mechanism.inputs:
                continue
            formula = self._formula(variable.function, variable.label)
            if formula is not None:
                found[variable.name] = formula
        for sensor in self._mechanism.dataset.active_sensors:
            found[sensor.name] = self._translation.formula(sensor.function)
            if sensor.evaluated is not None:
                found[sensor.name + EVALUATED] = self._translation.formula(sensor.evaluated)
        named = self._mechanism.variables
        return {name: name if name in named else formula for name, formula in found.items()}

    def _between_markers(self, request: Request) -> dict[str, str]:
        """Return displacement, velocity, acceleration or force of marker I relative to J in the axes of RM, in SI."""
        assert request.sort is not None and request.i is not None
        idents = request.i, request.j or 0, request.axes or 0
        function, translation = Function(request.sort, ast.Constant(0), request.line, request.label), self._translation
        try:
            if request.sort == "FORCE":
                trees = {name.lower(): translation.between(name, *idents, function) for name in COMPONENTS}
            else:
                i, j, axes = (translation.reference(ident, function) if ident else "" for ident in idents)
                trees = {
                    CALLED.get(name, name.lower()): measured(name.lower(), i, j, "" if name in ANGLES else axes)
                    for name in MARKED[request.sort]
                }
        except DatasetFault as fault:
            self.notes.append(f"{fault}; the request is left out")
            return {}
        return {name: ast.unparse(tree) for name, tree in trees.items()}

    def _functions(self, request: Request) -> dict[str, str]:
        """Return the functions of a request, in the dataset's units."""
        if request.computed:
            self.notes.append(
                f"line {request.line}, {request.label}: {', '.join(request.computed)}, computed by a user subroutine, is left out "
                "of the results"
            )
        found = {}
        for k, (column, function) in enumerate(request.functions):
            formula = self._formula(function, f"{request.label}, {column}")
            if formula is not None:
                found[self._name(request, column, k)] = formula
        return found

    @staticmethod
    def _name(request: Request, column: str, k: int) -> str:
        """Return the name of a column: the one in the request if it is a valid channel name."""
        given = request.names[k] if k < len(request.names) else ""
        return given if re.fullmatch(r"[A-Za-z_]\w*", given) else column.lower()

    def _formula(self, function: Function, label: str) -> str | None:
        try:
            return self._translation.formula(function)
        except DatasetFault as fault:
            self.notes.append(f"{fault}; {label} is left out of the results")
            return None
