"""Validation of requests against a model."""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from ...reading.did_you_mean import did_you_mean
from ...reading.files.quoted import quoted
from ...reading.formula.text import UNIT
from ...reading.joint_name import JointName
from ...reading.marker import check_marker
from ...reading.units.units import CONSTANTS, UNITS
from .names import OF_RUN, OutputNames
from .output import Output, channel

if TYPE_CHECKING:
    from ...model.model_data import ModelData


def by_channel(requests: Mapping[str, Output | Mapping[str, Output]]) -> Iterator[tuple[str, Output]]:
    """Yield requests by channel: a name, or ``name.component``."""
    for name, found in requests.items():
        if isinstance(found, Output):
            yield name, found
        else:
            yield from ((channel(name, component), output) for component, output in found.items())


class ByChannel(Mapping[str, Output]):
    """Mapping of requests by channel, evaluated on access."""

    def __init__(self, requests: Mapping[str, Output | Mapping[str, Output]]) -> None:
        self._requests = requests

    def __getitem__(self, name: str) -> Output:
        owner, _, component = name.partition(".")
        found = self._requests[owner]
        if isinstance(found, Output) and not component:
            return found
        if isinstance(found, Output):
            raise KeyError(name)
        return found[component]

    def __iter__(self) -> Iterator[str]:
        return (name for name, _ in by_channel(self._requests))

    def __len__(self) -> int:
        return sum(1 for _ in self)


def ends(element: str, model: ModelData) -> tuple[Any, Any]:
    """Return the markers i and j of a joint or force, or None; for a drive those of its joint."""
    acting: Any = ChainMap(model.joints, model.forces)[element]
    _, joint = next(acting.parts(JointName), ("", None))
    acting = acting if joint is None else model.joints[joint.joint]
    return getattr(acting, "i", None), getattr(acting, "j", None)


def check_output(where: str, output: Output, model: Any, names: OutputNames, others: Mapping[str, Output]) -> None:
    """Refuse a formula that names an unknown body, marker, joint, force, channel or request.

    `where`: path in the scene, for messages. `names`: names of the model's family. `others`: all requests, by channel.
    """
    acting = ChainMap(model.joints, model.forces)
    for term in output.terms:
        for marker in term.markers:
            check_marker(where, marker, model.bodies, model.markers)
        if term.element and term.element not in acting:
            near = did_you_mean(term.element, acting)
            raise ValueError(f"{where}: found '{term.element}'{near} in '{output.text}', expected a joint or a force")
        if term.on_second and None in ends(term.element, model):
            raise ValueError(f"{where}: found '{term.element}.j' in '{output.text}', which has no marker j")
        if term.on_second and len(list(acting[term.element].parts(JointName))) > 1:
            raise ValueError(
                f"{where}: found '{term.element}.j' in '{output.text}', which acts on more than two bodies, "
                f"expected {term.element}, whose first body is known"
            )
    for owner, name in output.channels():
        if channel(owner, name) in channels_of_states(model):
            continue
        if not name:
            _check_request(where, owner, output, others)
        elif channel(owner, name) not in others and name not in _of(owner, model, names):
            owners = {*acting, *model.bodies, *OF_RUN, *(other.partition(".")[0] for other in others)}
            if owner not in owners:
                raise ValueError(
                    f"{where}: found the unknown body '{owner}'{did_you_mean(owner, owners)} in '{quoted(output.text)}', expected the "
                    "name of a body, a joint, a force or a request"
                )
            of_owner = _of(owner, model, names)
            raise ValueError(
                f"{where}: found '{owner}.{name}'{did_you_mean(name, of_owner)} in '{quoted(output.text)}', expected one of "
                f"{', '.join(f'{owner}.{known}' for known in of_owner) or 'the requests by name'}"
            )
    _check_meanings(where, output, others)


def channels_of_states(model: ModelData) -> set[str]:
    """Return the channels of the model's states: values, outputs and rates."""
    values = {full: value for name, state in model.states.items() for full, value in state.values(name)}
    outputs = {full for name, state in model.states.items() for full, _ in state.outputs(name)} | set(model.inputs)
    rates = {f"{name}.rate" for name, value in values.items() if not (value.algebraic or value.period)}
    return set(values) | outputs | rates


def _of(owner: str, model: ModelData, names: OutputNames) -> tuple[str, ...]:
    """Return the channels of a body, of a joint or force, or of the whole model."""
    if owner in model.bodies:
        return names.of_bodies
    if owner in model.forces:
        force = model.forces[owner]
        return (*(names.of_elements if force.has_reaction else ()), *force.channels, *force.own_states())
    if owner in model.joints:
        return (*names.of_elements, *model.joints[owner].channels)
    return OF_RUN.get(owner, ())


def _check_request(where: str, name: str, output: Output, others: Mapping[str, Output]) -> None:
    if name in others:
        return
    components = [other for other in others if other.startswith(f"{name}.")]
    if components:
        raise ValueError(
            f"{where}: found '{name}' in '{quoted(output.text)}', which has components, expected one of {', '.join(components)}"
        )
    raise ValueError(
        f"{where}: found the unknown name '{name}'{did_you_mean(name, others)} in '{quoted(output.text)}', expected t, a body's "
        "coordinate such as cart.x, another channel or request, a parameter or a variable of the scene"
    )


def _check_meanings(where: str, output: Output, others: Mapping[str, Output]) -> None:
    """Refuse the name of a request that is also a parameter, unit or constant."""
    for used in output.quantities:
        name = used.removeprefix(f"{UNIT}.")
        if name in others:
            what = "unit" if name in UNITS else "constant" if name in CONSTANTS else "parameter"
            raise ValueError(
                f"{where}: found '{name}' in '{quoted(output.text)}', which is a {what} and a request, expected one or the other: "
                "rename the request"
            )
