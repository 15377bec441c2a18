"""The file modelDescription.xml of an FMU without Python (FMI 2.0, model exchange and co-simulation)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from xml.etree.ElementTree import Element, SubElement, indent, tostring

import numpy as np

from .header import FIRST_DERIVATIVE, FIRST_INPUT, FIRST_OUTPUT
from .model import ExportedModel


def description(model: ExportedModel, identifier: str, token: str, outputs: Mapping[str, int], text: str) -> bytes:
    """Return the model description.

    `identifier`: name of the library. `token`: GUID. `outputs`: places of the outputs in the row. `text`: description of the model.
    """
    from .... import __version__

    system, settings, grid = model.dynamics.system, model.job.settings, model.job.grid
    root = Element(
        "fmiModelDescription", fmiVersion="2.0", modelName=identifier, guid=token, description=text, version=__version__,
        generationTool=f"stiffmbs {__version__}", variableNamingConvention="flat", numberOfEventIndicators=str(system.n_event_functions),
    )  # fmt: skip
    abilities = {
        "modelIdentifier": identifier, "canNotUseMemoryManagementFunctions": "true", "canGetAndSetFMUstate": "true",
        "canSerializeFMUstate": "true",
    }  # fmt: skip
    SubElement(root, "ModelExchange", abilities)
    SubElement(root, "CoSimulation", abilities | {"canHandleVariableCommunicationStepSize": "true"})
    categories = SubElement(root, "LogCategories")
    for name in ("logStatusDiscard", "logStatusError"):
        SubElement(categories, "Category", name=name)
    step = settings.output or settings.duration / 1000
    SubElement(
        root, "DefaultExperiment", startTime=repr(grid.start), stopTime=repr(settings.start + settings.duration),
        tolerance=repr(settings.rtol), stepSize=repr(step),
    )  # fmt: skip
    variables = _Variables(SubElement(root, "ModelVariables"))
    start = np.concatenate([model.job.start.q, model.job.start.u]).tolist()
    depends = system.n_c > 0  # on the other states: the start is projected onto the constraints
    initial = "approx" if depends else "exact"
    states = {}
    for k, channel in model.states.items():
        causality, value = "output" if channel in outputs else "local", {"start": repr(start[k])}
        states[k] = variables.add(channel or f"state[{k}]", k, causality, {"initial": initial}, value)
    rates = []
    for k, channel in model.states.items():
        of = {"derivative": str(states[k])}
        rates.append(
            variables.add(
                f"der({channel or f'state[{k}]'})", FIRST_DERIVATIVE + k, "local", {"initial": "calculated"}, of
            )
        )
    of_states = {channel: states[k] for k, channel in model.states.items() if channel}
    chosen = [
        of_states[name] if name in of_states else variables.add(name, FIRST_OUTPUT + place, "output", {"initial": "calculated"}, {})
        for name, place in outputs.items()
    ]  # fmt: skip
    for k, (name, value) in enumerate(model.inputs.items()):
        variables.add(name, FIRST_INPUT + k, "input", {}, {"start": repr(value)})
    structure = SubElement(root, "ModelStructure")
    calculated = {*rates, *chosen} - {*states.values()} | ({*states.values()} if depends else set())
    for name, places in (("Outputs", sorted(chosen)), ("Derivatives", rates), ("InitialUnknowns", sorted(calculated))):
        _unknowns(structure, name, places)
    indent(root)
    return tostring(root, encoding="utf-8", xml_declaration=True)


def _unknowns(structure: Element, name: str, places: Iterable[int]) -> None:
    """Add a list of variables, if there are any; without dependencies, each may depend on all others."""
    if places := list(places):
        found = SubElement(structure, name)
        for place in places:
            SubElement(found, "Unknown", index=str(place))


class _Variables:
    """Variables of a model description, numbered from 1 on."""

    def __init__(self, parent: Element) -> None:
        self._parent, self._count = parent, 0

    def add(
        self, name: str, reference: int, causality: str, attributes: dict[str, str], of_real: dict[str, str]
    ) -> int:
        """Add a continuous variable, and return its number."""
        self._count += 1
        given = {
            "name": name,
            "valueReference": str(reference),
            "causality": causality,
            "variability": "continuous",
            **attributes,
        }
        SubElement(SubElement(self._parent, "ScalarVariable", given), "Real", of_real)
        return self._count
