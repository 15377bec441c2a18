"""A scene in space as the text of a dataset of Adams/Solver."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import Any

from ...describe.scene import Scene
from ...describe.spatial.model import SpatialData
from ...errors import InputError
from .curves import touching
from .forces import Forces
from .formulas import Functions
from .joints import Joints, reactions
from .numbering import Numbering
from .outputs import requests, state_names, states
from .refusal import Refusal
from .statements import number, statement

UNITS = ("FORCE = NEWTON", "MASS = KILOGRAM", "LENGTH = METER", "TIME = SECOND")


def dataset_text(scene: SpatialData, source: str = "scene") -> str:
    """The dataset of a scene in space: parts, markers, joints, forces, states and requests, in SI units.

    Parameters
    ----------
    scene : SpatialData
    source : str
        What messages call it.

    Raises
    ------
    InputError
        Where the scene holds what Adams/Solver has no statement for; names all such elements.
    """
    numbering, names = Numbering(scene, touching(scene)), state_names(scene)
    functions = Functions(numbering, names, reactions(scene))
    joints, forces = Joints(scene, numbering, functions), Forces(scene, numbering, functions)
    refused: list[str] = []
    made = [
        *_each("joints", scene.joints.items(), lambda name, joint: joints.statements(name, joint), refused),
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
    """The command file that runs the dataset as the scene's section `run` says."""
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
    section: str, entries: Iterable[tuple[str, Any]], write: Callable[[str, Any], Iterable[str]], refused: list[str]
) -> Iterator[str]:
    """The statements of each entry under its name; what Adams does not have is added to `refused`."""
    for name, entry in entries:
        try:
            text = list(write(name, entry))
        except Refusal as refusal:
            refused.append(f"{section}.{name}: {refusal}")
            continue
        if text:
            yield f"! adams_view_name='{name}'"
        yield from text
