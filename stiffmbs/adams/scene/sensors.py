"""Conversion of sensors to stage end conditions."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from ...elements.spatial.number_format import plain
from ..statements.dataset import Dataset
from ..statements.sensor import Sensor
from ..statements.units import Units

EVALUATED = "_evaluate"
"""Name suffix for the request of a sensor's EVALUATE expression."""


def conditions(dataset: Dataset, inputs: Mapping[str, float]) -> dict[str, Any]:
    """Return the end conditions by name; each watches the request of its name and may set inputs of the scene."""
    return {sensor.name: _condition(sensor, inputs, dataset.units) for sensor in dataset.active_sensors}


def _condition(sensor: Sensor, inputs: Mapping[str, float], units: Units) -> dict[str, Any]:
    made: dict[str, Any] = {"request": sensor.name, sensor.relation: plain(sensor.value)}
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
                listed and f", and {listed} change no results"
            )
