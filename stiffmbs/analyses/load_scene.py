"""Loading of scenes: YAML files, Adams/Solver datasets, robots in URDF, SDF or MJCF, and assemblies of CAD programs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import InputError
from ..reading.files.text_file import STANDARD_INPUT, file_text, source_name
from ..reading.units.units import Dimension, Quantity, in_text

if TYPE_CHECKING:
    from ..model.scene import Scene

DATASET, COMMANDS = ".adm", ".acf"
"""File suffixes of Adams/Solver datasets and command files."""
OTHERS = {
    ".cmd": "commands of Adams/View: export the model there by File > Export > Adams/Solver dataset, and read the .adm",
    ".bin": "a database of Adams/View: export the model there by File > Export > Adams/Solver dataset, and read the .adm",
    ".osim": "a model of OpenSim, which is not read: convert it to MJCF, for example by MyoConverter",
    ".mbd": "an input file of MBDyn, which is not read: write its nodes, joints and forces as a scene",
    **dict.fromkeys(
        (".step", ".stp", ".iges", ".igs"),
        "shapes without joints: export the assembly as Simscape Multibody XML, or as .asmt from FreeCAD",
    ),
}
"""Files of other programs that are recognised by their suffix, and what to do with them."""
ROBOTS = (".urdf", ".sdf", ".world", ".xml", ".mjcf")
"""File suffixes of robots."""
CAD = (".asmt", ".xml")
"""File suffixes of assemblies; the root element tells an XML file from MJCF."""


def load_scene(path: str | Path, changes: Sequence[tuple[str, str]] = ()) -> Scene:
    """Read a scene file, an Adams/Solver dataset, a robot's file, or a CAD program's.

    Parameters
    ----------
    path : str or Path
        A YAML file, or ``-`` for standard input; a dataset if its name ends in ``.adm``, a robot in URDF if it ends in
        ``.urdf``, in SDF if it ends in ``.sdf`` or ``.world``, in MJCF (needs the extra ``robots``) if it ends in
        ``.xml`` or ``.mjcf``; an assembly if it ends in ``.asmt`` (FreeCAD), or is Simscape Multibody XML.
    changes : sequence of (path, text)
        Values that replace those of the file, such as ``("bodies.cart.mass", "12 kg")``.

    Returns
    -------
    Scene
        `PlanarScene`, or `SpatialScene` if the file has ``dimensions: 3``.

    Raises
    ------
    InputError
        If the file cannot be read or is not a valid scene; the message names the file, the line and the path in it.
    """
    for change in changes:
        if not (isinstance(change, tuple | list) and len(change) == 2 and isinstance(change[0], str)):
            raise InputError(f"changes: found {change!r}, expected pairs such as ('bodies.cart.mass', '12 kg')")
    refuse_others(path)
    suffix = Path(path).suffix.lower()
    if suffix in CAD:
        from ..cad.load import is_cad, load_cad

        if is_cad(path):
            return load_cad(path, changes)
    if suffix in ROBOTS:
        from ..robots.load import load_robot

        return load_robot(path, changes)
    if suffix == DATASET:
        from ..adams.load import load_adams

        return load_adams(path, changes)
    if str(path) == STANDARD_INPUT:
        from ..model.read_scene import read_scene

        return read_scene(file_text(path), changes, source_name(path))
    from ..model.files.scenes_read_before import read_scene_file

    return read_scene_file(file_text(path), changes, source_name(path), Path(path))


def with_parameter(
    path: str | Path, parameter: str, changes: Sequence[tuple[str, str]] = (), dimension: Dimension | None = None
) -> Callable[[float], Scene]:
    """Return a scene as a function of a parameter or any other value in it, SI units; standard input is read once.

    If the dimension of the values is known, the scene rejects another dimension.
    """
    if str(path) == STANDARD_INPUT:
        from ..model.read_scene import read_scene

        text = file_text(path)
        return lambda value: read_scene(text, [*changes, (parameter, _written(value, dimension))], source_name(path))
    return lambda value: load_scene(path, [*changes, (parameter, _written(value, dimension))])


def _written(value: float, dimension: Dimension | None) -> str:
    """Return a value with its unit, if any; whole numbers without a decimal point, for counts."""
    if dimension is not None:
        return str(in_text(Quantity(value, dimension)))
    return str(int(value)) if value.is_integer() else repr(value)


def refuse_others(path: str | Path) -> None:
    """Raise an InputError for a file of another program that is not read; the message says what to do."""
    suffix = Path(path).suffix.lower()
    if suffix == COMMANDS:
        raise InputError(
            f"{source_name(path)}: found a command file, expected its dataset {Path(path).stem}{DATASET}, which is run with the "
            "command file of the same name"
        )
    words = OTHERS.get(suffix)
    if words:
        raise InputError(f"{source_name(path)}: found {words}")
