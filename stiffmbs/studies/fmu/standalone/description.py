"""The file modelDescription.xml of an FMU without Python, for model exchange and co-simulation by FMI 2.0 or 3.0."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple
from xml.etree.ElementTree import Element, SubElement, indent, tostring

import numpy as np

from ....results.requests import units_of
from ..units import unit_definitions
from .model import ExportedModel

VERSIONS = "2.0", "3.0"
"""Versions of FMI."""


class Variable(NamedTuple):
    """Continuous variable or tunable parameter of an FMU.

    `reference`: its value reference. `initial`: how its start follows; empty for inputs. `start`: value at the start, if it may be set.
    `state`: value reference of the state that it is the derivative of. `unit`: SI unit; empty if unknown.
    """

    name: str
    reference: int
    causality: str
    initial: str = ""
    start: float | None = None
    state: int | None = None
    unit: str = ""

    @property
    def of_number(self) -> dict[str, str]:
        """Return start and unit as attributes."""
        return ({} if self.start is None else {"start": repr(self.start)}) | ({"unit": self.unit} if self.unit else {})


class Variables(NamedTuple):
    """Variables of an FMU: continuous states and their derivatives, other outputs, inputs and parameters."""

    states: list[Variable]
    derivatives: list[Variable]
    outputs: list[Variable]
    inputs: list[Variable]

    @property
    def all(self) -> list[Variable]:
        """Return all of them, in the order of the file."""
        return [*self.states, *self.derivatives, *self.outputs, *self.inputs]

    @property
    def reported(self) -> list[Variable]:
        """Return all outputs, of states too."""
        return [each for each in self.all if each.causality == "output"]

    @property
    def unknown_at_start(self) -> list[Variable]:
        """Return the outputs, states and derivatives that the start computes."""
        return [each for each in self.all if each.initial in ("calculated", "approx")]


def variables_of(model: ExportedModel, outputs: Mapping[str, int]) -> Variables:
    """Return the variables of an FMU; `outputs`: places of its outputs in the row."""
    start = np.concatenate([model.job.start.q, model.job.start.u]).tolist()
    # with joints, the start is the nearest state that satisfies them
    initial = "approx" if model.dynamics.system.n_c else "exact"
    names = {k: channel or f"state[{k}]" for k, channel in model.states.items()}
    known, unit = set(names.values()), units_of(model.job.data, [*names.values(), *outputs])
    return Variables(
        [
            Variable(name, k, "output" if name in outputs else "local", initial, start[k], unit=unit.get(name, ""))
            for k, name in names.items()
        ],
        [
            Variable(f"der({name})", model.first_derivative + k, "local", "calculated", state=k)
            for k, name in names.items()
        ],
        [
            Variable(name, model.first_output + place, "output", "calculated", unit=unit.get(name, ""))
            for name, place in outputs.items()
            if name not in known
        ],
        [
            Variable(name, model.first_input + k, "parameter", "exact", value)
            if name in model.parameters
            else Variable(name, model.first_input + k, "input", start=value)
            for k, (name, value) in enumerate(model.inputs.items())
        ],
    )


def description(
    model: ExportedModel, identifier: str, token: str, outputs: Mapping[str, int], text: str, version: str
) -> bytes:
    """Return the model description.

    `identifier`: name of the library. `token`: GUID. `outputs`: places of the outputs in the row. `text`: description of the model.
    `version`: of FMI.
    """
    from .... import __version__

    settings, variables = model.job.settings, variables_of(model, outputs)
    is_new = version == "3.0"
    root = Element(
        "fmiModelDescription", {"instantiationToken" if is_new else "guid": token}, fmiVersion=version, modelName=identifier,
        description=text, version=__version__, generationTool=f"stiffmbs {__version__}", variableNamingConvention="flat",
    )  # fmt: skip
    state = "State" if is_new else "state"
    abilities = {
        "modelIdentifier": identifier, f"canGetAndSetFMU{state}": "true", f"canSerializeFMU{state}": "true",
        **({} if is_new else {"canNotUseMemoryManagementFunctions": "true"}),
    }  # fmt: skip
    SubElement(root, "ModelExchange", abilities | ({"needsCompletedIntegratorStep": "true"} if is_new else {}))
    SubElement(root, "CoSimulation", abilities | {"canHandleVariableCommunicationStepSize": "true"})
    used = {each.unit for each in variables.all} - {""}
    root.extend([unit_definitions(used)] if used else [])
    categories = SubElement(root, "LogCategories")
    for name in ("logStatusDiscard", "logStatusError"):
        SubElement(categories, "Category", name=name)
    SubElement(
        root, "DefaultExperiment", startTime=repr(settings.start), stopTime=repr(settings.start + settings.duration),
        tolerance=repr(settings.rtol), stepSize=repr(settings.output or settings.duration / 1000),
    )  # fmt: skip
    if is_new:
        _by_references(root, model, variables)
    else:
        _by_numbers(root, model, variables)
    indent(root)
    return tostring(root, encoding="utf-8", xml_declaration=True)


def _of(variable: Variable) -> dict[str, str]:
    """Return the attributes that both versions have."""
    found = {"name": variable.name, "valueReference": str(variable.reference), "causality": variable.causality}
    variability = "tunable" if variable.causality == "parameter" else "continuous"
    return found | {"variability": variability} | ({"initial": variable.initial} if variable.initial else {})


def _by_numbers(root: Element, model: ExportedModel, variables: Variables) -> None:
    """Add variables and structure of FMI 2.0, which numbers the variables from 1 on."""
    root.set("numberOfEventIndicators", str(model.dynamics.system.n_event_functions))
    number = {each.reference: k for k, each in enumerate(variables.all, 1)}
    listed = SubElement(root, "ModelVariables")
    for each in variables.all:
        real = each.of_number
        real |= {} if each.state is None else {"derivative": str(number[each.state])}
        SubElement(SubElement(listed, "ScalarVariable", _of(each)), "Real", real)
    structure = SubElement(root, "ModelStructure")
    for name, unknowns in (
        ("Outputs", variables.reported),
        ("Derivatives", variables.derivatives),
        ("InitialUnknowns", variables.unknown_at_start),
    ):
        part = SubElement(structure, name) if unknowns else None
        for each in unknowns:
            assert part is not None
            SubElement(part, "Unknown", index=str(number[each.reference]))


def _by_references(root: Element, model: ExportedModel, variables: Variables) -> None:
    """Add variables and structure of FMI 3.0, which has time and the event indicators among the variables."""
    listed = SubElement(root, "ModelVariables")
    time = {"name": "time", "valueReference": str(model.time), "causality": "independent", "variability": "continuous"}
    SubElement(listed, "Float64", time)
    indicators = [
        Variable(f"event_indicator[{k}]", model.time + 1 + k, "local", "calculated")
        for k in range(model.dynamics.system.n_event_functions)
    ]
    for each in [*variables.all, *indicators]:
        more = each.of_number
        more |= {} if each.state is None else {"derivative": str(each.state)}
        SubElement(listed, "Float64", _of(each) | more)
    structure = SubElement(root, "ModelStructure")
    for name, unknowns in (
        ("Output", variables.reported),
        ("ContinuousStateDerivative", variables.derivatives),
        ("InitialUnknown", variables.unknown_at_start),
        ("EventIndicator", indicators),
    ):
        for each in unknowns:
            SubElement(structure, name, valueReference=str(each.reference))
