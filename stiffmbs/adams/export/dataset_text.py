"""Export of a spatial scene as an Adams/Solver dataset."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any

from ...elements.states.entry import StateValue
from ...errors import InputError
from ...model.scene import Scene
from ...model.settings import DEFAULT_POINTS
from ...model.spatial_model import SpatialData
from ...reading.ascii import in_ascii
from ...reading.files.quoted import listed
from ...reading.files.written_fields import Recording, written
from ...reading.formula.formula import Formula
from .curves import touching
from .forces import Forces
from .formulas import Functions
from .joints import Joints, reactions
from .numbering import Numbering, Refusal, number, statement

UNITS = ("FORCE = NEWTON", "MASS = KILOGRAM", "LENGTH = METER", "TIME = SECOND")


EQUILIBRIUM = "equilibrium"
"""Start of a scene that Adams finds by a static simulation."""
IN_FORMULAS = ("parameters", "tables", "variables", "roads")
"""Sections of a scene whose content is written where formulas and elements use it."""
_IN_VIEW, _SOLVER = "a dataset has nothing of this kind; the motion is the same", "settings of this package"
LEFT_OUT = {
    "": dict.fromkeys(("figure", "units", "notes", "vehicle", "path"), _IN_VIEW),
    "body": {"geometry": _IN_VIEW, "any_moments": _IN_VIEW, "markers": "nothing refers to them"},
    "state": {"scale": _SOLVER},
    "run": {"*": _SOLVER},
}
"""Reasons why fields are left out of a dataset with a note, by kind of their owner; all others are refused."""
REMEDIES = {
    "at_start": "describe bodies in the pose and with the velocities that it gives, and remove it",
    "stages": "write each stage as a scene of its own",
    "start": "describe the bodies in the pose of the start, and use start: described or start: equilibrium",
}
LATER = "run.start: a simulation of Adams starts at time 0; shift the time in the formulas, and set run.start=0"


@dataclass(frozen=True)
class WrittenDataset:
    """Texts of a dataset and of its command file, and notes on what they do not contain."""

    text: str
    commands: str
    notes: tuple[str, ...]


def dataset_text(scene: SpatialData, source: str = "scene") -> str:
    """Return a spatial scene as an Adams/Solver dataset in SI units; parameters and errors as for `written_dataset`."""
    return written_dataset(scene, source).text


def written_dataset(scene: SpatialData, source: str = "scene") -> WrittenDataset:
    """Return a spatial scene as an Adams/Solver dataset in SI units, and the command file that runs it.

    `source`: name of the scene in messages. Raises InputError if something in the scene has no equivalent in
    Adams/Solver; names all of it.
    """
    recording = Recording(LEFT_OUT)
    sections = {name: recording.section(getattr(scene, f"{name}s"), name) for name in ("joint", "force", "state")}
    sections["bodie"] = recording.section(scene.bodies, "body")
    model = recording.of(scene.model_copy(update={f"{name}s": entries for name, entries in sections.items()}), "")
    written(model, "dimensions", "markers", "states", "inputs", "requests", "run", *IN_FORMULAS)
    for state in model.states.values():
        written(state, *(name for name in type(state._entry).model_fields if name != "scale"))
    refused: list[str] = []
    lines, lost = _statements(model, refused)
    commands: list[str] = []
    if isinstance(scene, Scene):
        commands = _commands(scene, model, recording.of(scene.run, "run"), refused)
    refused += recording.refusals(REMEDIES)
    if refused:
        raise InputError(f"{source}: a dataset has no statement for " + "; ".join(refused))
    requests = [f"not written (a dataset has no function for them): requests {listed(lost)}"] if lost else []
    inputs = (
        [f"a dataset has no inputs; their values in the scene are numbers: {listed(tuple(scene.inputs))}"]
        if scene.inputs
        else []
    )
    letters = (
        [] if "".join(lines).isascii() else ["names and texts of the dataset are in ASCII letters (ä is a, Θ is Theta)"]
    )
    notes = (*recording.notes(), *requests, *inputs, *letters)
    remarks = [f"! {note}" for note in notes]
    return WrittenDataset(_text(lines), _text([f"! {scene.name}", *remarks, *commands]), notes)


def _text(lines: list[str]) -> str:
    return in_ascii("\n".join(lines)) + "\n"


def _statements(scene: Any, refused: list[str]) -> tuple[list[str], list[str]]:
    """Return the statements of a scene, and the requests that they leave out; add unsupported entries to `refused`."""
    numbering, names = Numbering(scene, touching(scene)), state_names(scene)
    functions = Functions(numbering, names, reactions(scene))
    joints, forces = Joints(scene, numbering, functions), Forces(scene, numbering, functions)
    lost: list[str] = []
    made = [
        *_each("joints", scene.joints.items(), lambda name, joint: joints.statements(joint, name), refused),
        *_each("forces", scene.forces.items(), lambda _, force: forces.statements(force), refused),
        *_each("states", states(scene), lambda _, write: write(functions), refused),
        *requests(scene, functions, lost),
    ]
    # a run from the equilibrium starts at rest, and Adams' statics take no velocities
    moving = getattr(scene._entry, "start", "") != EQUILIBRIUM
    gravity = (f"{axis}GRAV = {number(g)}" for axis, g in zip("IJK", scene.gravity, strict=True))
    lines = [
        scene.name or "scene",
        statement("UNITS", None, *UNITS),
        statement("ACCGRAV", None, *gravity),
        *numbering.statements(moving),
        *made,
        "END",
    ]
    return lines, lost


def _commands(scene: Scene, recorded: Any, run: Any, refused: list[str]) -> list[str]:
    """Return the commands that run the dataset with the scene's sections `start` and `run`."""
    if run.start:
        refused.append(LATER)
    if scene.start == EQUILIBRIUM:
        written(recorded, "start")
    spacing = run.output or run.duration / (DEFAULT_POINTS - 1)
    steps = run.points - 1 if isinstance(scene.run.points, int) else round(run.duration / spacing)
    longest = [f"HMAX = {number(run.max_step)}"] if run.max_step else []
    return [
        f"INTEGRATOR/{', '.join([f'ERROR = {number(run.rtol)}', *longest])}",
        *(["SIMULATE/STATICS"] if scene.start == EQUILIBRIUM else []),
        f"SIMULATE/DYNAMIC, END = {number(run.duration)}, STEPS = {max(steps, 1)}",
        "STOP",
    ]


def _each(
    section: str, entries: Iterable[tuple[str, object]], write: Callable[[str, Any], Iterable[str]], refused: list[str]
) -> Iterator[str]:
    """Yield the statements of each entry under its name; add unsupported entries to `refused`."""
    for name, entry in entries:
        try:
            text = list(write(name, entry))
        except Refusal as refusal:
            refused.append(f"{section}.{name}: {refusal}")
            written(entry)
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


def requests(scene: SpatialData, functions: Functions, lost: list[str]) -> Iterator[str]:
    """Yield the requests; those without an equivalent in Adams become a comment, and are added to `lost`."""
    for k, (name, output) in enumerate(scene.outputs().items(), 1):
        try:
            law = functions.output(output)
        except Refusal:
            lost.append(name)
            yield f"! the request {name} is left out"
            continue
        yield f"! adams_view_name='{name}'"
        yield statement("REQUEST", k, f"F2 = {law}\\")
