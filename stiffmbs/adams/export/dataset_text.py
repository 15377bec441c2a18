"""Export of a spatial scene as an Adams/Solver dataset."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import Any

from ...errors import InputError
from ...model.scene import Scene
from ...model.spatial_model import SpatialData
from .curves import touching
from .forces import Forces
from .formulas import Functions
from .joints import Joints, reactions
from .numbering import Numbering
from .outputs import requests, state_names, states
from .statements import Refusal, number, statement

UNITS = ("FORCE = NEWTON", "MASS = KILOGRAM", "LENGTH = METER", "TIME = SECOND")


def dataset_text(scene: SpatialData, source: str = "scene") -> str:
    """Return a spatial scene as an Adams/Solver dataset in SI units.

    Parameters
    ----------
    source : str
        Name of the scene in messages.

    Raises
    ------
    InputError
        If elements of the scene have no equivalent in Adams/Solver; names all of them.
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
    section: str, entries: Iterable[tuple[str, Any]], write: Callable[[str, Any], Iterable[str]], refused: list[str]
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
