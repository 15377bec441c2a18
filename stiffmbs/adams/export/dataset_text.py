"""Export of a spatial scene as an Adams/Solver dataset."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from functools import partial
from typing import Any

from ...elements.states.state import StateValue
from ...errors import InputError
from ...model.scene import Scene
from ...model.spatial_model import SpatialData
from ...reading.formula.formula import Formula
from .curves import touching
from .forces import Forces
from .formulas import Functions
from .joints import Joints, reactions
from .numbering import Numbering, Refusal, number, statement

UNITS = ("FORCE = NEWTON", "MASS = KILOGRAM", "LENGTH = METER", "TIME = SECOND")


def dataset_text(scene: SpatialData, source: str = "scene") -> str:
    """Return a spatial scene as an Adams/Solver dataset in SI units.

    `source`: name of the scene in messages. Raises InputError if elements of the scene have no equivalent in
    Adams/Solver; names all of them.
    """
    numbering, names = Numbering(scene, touching(scene)), state_names(scene)
    functions = Functions(numbering, names, reactions(scene))
    joints, forces = Joints(scene, numbering, functions), Forces(scene, numbering, functions)
    refused: list[str] = []
    made = [
        *_each("joints", scene.joints.items(), lambda name, joint: joints.statements(joint, name), refused),
        *_each("forces", scene.forces.items(), lambda _, force: forces.statements(force), refused),
        *_each("states", states(scene), lambda _, write: write(functions), refused),
        *requests(scene, functions),
    ]
    if refused:
        raise InputError(f"{source}: a dataset has no statement for " + "; ".join(refused))
    gravity = (f"{axis}GRAV = {number(g)}" for axis, g in zip("IJK", scene.gravity, strict=True))
    lines = [
        scene.name or "scene",
        statement("UNITS", None, *UNITS),
        statement("ACCGRAV", None, *gravity),
        *numbering.statements(),
        *made,
        "END",
    ]
    return "\n".join(lines) + "\n"


def command_text(scene: Scene) -> str:
    """Return the command file that runs the dataset with the scene's section `run`."""
    run = scene.run
    end = run.start + run.duration
    spacing = run.output or run.duration / 1000
    steps = run.points - 1 if isinstance(run.points, int) else round(run.duration / spacing)
    lines = [
        f"! {scene.name}",
        f"INTEGRATOR/ERROR = {number(run.rtol)}",
        f"SIMULATE/DYNAMIC, END = {number(end)}, STEPS = {max(steps, 1)}",
        "STOP",
    ]
    return "\n".join(lines) + "\n"


def _each(
    section: str, entries: Iterable[tuple[str, object]], write: Callable[[str, Any], Iterable[str]], refused: list[str]
) -> Iterator[str]:
    """Yield the statements of each entry under its name; add unsupported entries to `refused`."""
    for name, entry in entries:
        try:
            text = list(write(name, entry))
        except Refusal as refusal:
            refused.append(f"{section}.{name}: {refusal}")
            continue
        if text:
            yield f"! adams_view_name='{name}'"
        yield from text


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
    if value.period:
        raise Refusal("found a sampled state, expected one with a rate: discrete states of a GSE need a subroutine")
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
