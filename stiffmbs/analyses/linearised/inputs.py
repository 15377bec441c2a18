"""Inputs of a linearised model: a force on a body, or a parameter of its scene."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ...compile.bodies import BODY_KINDS
from ...elements.element import Force
from ...elements.states.amount import Amount
from ...errors import InputError
from ...model.model_builder import ModelBuilder
from ...model.model_data import ModelData
from ...reading.did_you_mean import did_you_mean
from ...reading.names import Names
from ...reading.table import Table
from ..load_scene import load_scene

Parameterised = Callable[[float], ModelBuilder | ModelData]
"""Model as a function of an input, which is zero at the state."""
FORCE = "input_"
"""Name of the force that represents an input."""


def force_on(model: ModelBuilder | ModelData, name: str) -> Parameterised:
    """Return a model as a function of an added force or torque.

    The name is an input of the model, or ``BODY.COMPONENT`` at the centre of mass, or ``BODY.MARKER.COMPONENT`` at a marker:
    ``chassis.fy``, ``bar.end.fx``; in ground axes, N or N m.  Raise an InputError if there is no such body or component.
    """
    data: ModelData = model.data() if isinstance(model, ModelBuilder) else model
    if name in data.inputs:
        return _input_of(data, name)
    at, _, component = name.rpartition(".")
    body, marker = Names(frozenset(data.bodies)).body_and_marker(at)
    components = BODY_KINDS[data.dimensions].reactions
    if body not in data.bodies or component not in components:
        known = (*data.inputs, *(f"{each}.{part}" for each in data.bodies for part in components))
        raise InputError(
            f"input '{name}': found no such force{did_you_mean(name, known)}, expected BODY.COMPONENT or BODY.MARKER.COMPONENT with one of "
            f"{', '.join(components)}, or a parameter of the scene"
        )

    return ForceOnBody(data, _place(data, body, marker), components.index(component))


@dataclass(frozen=True)
class ForceOnBody:
    """Model as a function of a force or torque on a marker: a component, by its index, of a reaction."""

    data: ModelData
    place: dict[str, Any]
    component: int

    def __call__(self, value: float) -> ModelData:
        """Return the model with the force, N or N m."""
        loads = [0.0] * len(BODY_KINDS[self.data.dimensions].reactions)
        loads[self.component] = value
        added = _applied(self.data.dimensions, self.place, loads)
        return self.data.model_copy(update={"forces": {**self.data.forces, FORCE: added}})


def _input_of(data: ModelData, name: str) -> Parameterised:
    """Return a model as a function of the change of one of its inputs."""
    value = data.inputs[name]
    if isinstance(value, Table):
        raise InputError(f"input '{name}': found a table, expected a number to vary")
    return lambda shift: data.model_copy(update={"inputs": {**data.inputs, name: Amount(value + shift)}})


def _place(data: ModelData, body: str, marker: str) -> dict[str, object]:
    """Return a named marker of a body, or its centre of mass, which may differ from its origin in space."""
    if marker:
        return {"body": body, "marker": marker}
    centre = getattr(data.bodies[body], "center_of_mass", None)
    return {"body": body} if centre is None else {"body": body, "point": centre}


def _applied(dimensions: int, at: dict[str, object], loads: list[float]) -> Force:
    """Return the applied force or torque with the given components, of which at most one is nonzero."""
    force, torque = tuple(loads[:dimensions]), tuple(loads[dimensions:])
    if dimensions == 2:
        from ...elements.forces.applied import AppliedForce, AppliedTorque

        return AppliedTorque(i=at, torque=torque[0]) if any(torque) else AppliedForce(i=at, force=force)  # type: ignore[arg-type]
    from ...elements.spatial.forces import applied as in_space

    if any(torque):
        return in_space.AppliedTorque(i=at, torque=torque)  # type: ignore[arg-type]
    return in_space.AppliedForce(i=at, force=force)  # type: ignore[arg-type]


def parameter_of(path: str | Path, name: str, changes: list[tuple[str, str]]) -> Parameterised:
    """Return a scene as a function of the change of one of its parameters; raise an InputError if it has no such parameter."""
    found = load_scene(path, changes).parameters
    if name not in found:
        known = ", ".join(found) or "none"
        near = did_you_mean(name, found)
        raise InputError(f"input '{name}': found no such parameter{near}, expected one of {known}, or BODY.COMPONENT")
    value = float(found[name])
    return lambda shift: load_scene(path, [*changes, (f"parameters.{name}", repr(value + shift))])
