"""Sensors as conditions that end a stage of a scene."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from ...describe.spatial.number_format import plain
from ..statements.dataset import Dataset
from ..statements.sensor import Sensor


def conditions(dataset: Dataset) -> dict[str, Any]:
    """What ends a simulation, by name; each watches a request of its own name."""
    return {sensor.name: _condition(sensor) for sensor in dataset.sensors}


def _condition(sensor: Sensor) -> dict[str, Any]:
    within = {"within": plain(sensor.error)} if sensor.relation == "equals" and sensor.error else {}
    then = {} if sensor.then == "next" else {"then": sensor.then}
    return {"request": sensor.name, sensor.relation: plain(sensor.value), **within, **then}


def notes(dataset: Dataset) -> Iterator[str]:
    """What sensors say that has no effect, a sentence each."""
    for sensor in dataset.statements.get("SENSOR", {}).values():
        listed = ", ".join(sensor.left_out)
        if sensor.then and listed:
            yield f"{sensor.label}: {listed} left out: no effect on the motion"
        elif not sensor.then:
            yield f"{sensor.label} is left out: it neither returns nor halts" + (
                listed and f", and {listed} change no motion"
            )
