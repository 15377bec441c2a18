"""Export of states and requests as Adams/Solver statements."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

from ...elements.states.state import StateValue
from ...model.spatial_model import SpatialData
from ...reading.formula.formula import Formula
from .formulas import Functions
from .statements import Refusal, number, statement

Write = Callable[[Functions], Iterator[str]]


def state_names(scene: SpatialData) -> dict[str, str]:
    """Return the Adams functions of states and their outputs by name."""
    names = {name: f"DIF({k})" for k, name in enumerate(scene.state_values(), 1)}
    return names | {name: f"VARVAL({k})" for k, name in enumerate(scene.state_outputs(), 1)}


def states(scene: SpatialData) -> Iterator[tuple[str, Write]]:
    """Yield each state by name with its writer: DIFF, implicit for algebraic states; outputs are VARIABLEs."""
    for k, (name, value) in enumerate(scene.state_values().items(), 1):
        yield name, partial(_state, k, value)
    for k, (name, formula) in enumerate(scene.state_outputs().items(), 1):
        yield name, partial(_output, k, formula)


def _state(k: int, value: StateValue, functions: Functions) -> Iterator[str]:
    if value.rate is None:
        raise Refusal("found the state of an element, expected one of the section states")
    implicit = ["IMPLICIT"] if value.algebraic else []
    law = functions.text(value.rate)
    yield statement("DIFF", k, f"IC = {number(value.start)}", *implicit, f"FUNCTION = {law}")


def _output(k: int, formula: Formula, functions: Functions) -> Iterator[str]:
    yield statement("VARIABLE", k, f"FUNCTION = {functions.text(formula)}")


def requests(scene: SpatialData, functions: Functions) -> Iterator[str]:
    """Yield the requests; those without an equivalent in Adams become a comment."""
    for k, (name, output) in enumerate(scene.outputs().items(), 1):
        try:
            law = functions.output(output)
        except Refusal:
            yield f"! the request {name} is left out"
            continue
        yield f"! adams_view_name='{name}'"
        yield statement("REQUEST", k, f"F2 = {law}\\")
