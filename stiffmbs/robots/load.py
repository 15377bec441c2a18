"""Loading of scenes from robot files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from types import MappingProxyType

import numpy as np

from ..elements.spatial.massless import BEYOND
from ..errors import InputError
from ..model.read_scene import made_scene
from ..model.scene import Scene
from ..reading.files.text_file import file_text, source_name
from ..reading.files.xml_nodes import FileFault
from ..reading.files.yaml_text import scene_text
from .robot import Robot, RobotFault
from .scene.scene import scene

URDF, SDF = ".urdf", (".sdf", ".world")
"""Extensions of URDF and SDF files; others are MJCF."""
AS_DRAWN: Mapping[str, float] = MappingProxyType({})


def load_robot(
    path: str | Path,
    changes: Sequence[tuple[str, str]] = (),
    *,
    coordinates: Mapping[str, float] = AS_DRAWN,
    rates: Mapping[str, float] = AS_DRAWN,
    limits: bool = False,
    contacts: bool = False,
    ground: float | None = None,
    free_root: bool = False,
) -> Scene:
    """Read a scene from a robot file.

    Parameters
    ----------
    path : str or Path
        URDF if its name ends in ``.urdf``, SDF if it ends in ``.sdf`` or ``.world``; otherwise MJCF (``.xml``, ``.mjcf``), which needs the package mujoco.
    changes : sequence of (path, text)
        Values that replace those of the file, such as ``("bodies.hand.mass", "2 kg")``.
    coordinates, rates : mappings of str to float
        Initial coordinates of hinges and slides, rad or m, and their rates, by joint; others are as drawn, and at rest.
    limits : bool, optional
        True to hold joints within their limits by stops (`stiffmbs.robots.scene.limits`). By default a note lists the limits.
    contacts : bool, optional
        True for contacts of the shapes that may touch according to the file (`stiffmbs.robots.scene.contacts`). By default there are none.
    ground : float, optional
        Height of an added ground plane, m, which all shapes touch; `contacts` is then True.
    free_root : bool, optional
        True if the root link of a URDF file moves freely. By default it is fixed to ground.

    Raises
    ------
    InputError
        If the file cannot be read, or its robot is not a valid scene.
    """
    found = _found(path, coordinates, rates, limits, contacts, ground, free_root)
    return made_scene(found, changes, source_name(path), lambda _: None)


def convert_robot(
    path: str | Path,
    *,
    coordinates: Mapping[str, float] = AS_DRAWN,
    rates: Mapping[str, float] = AS_DRAWN,
    limits: bool = False,
    contacts: bool = False,
    ground: float | None = None,
    free_root: bool = False,
) -> str:
    """Return the scene of a robot file as the text of a scene file; parameters and errors as `load_robot`."""
    how = (coordinates, rates, limits, contacts, ground, free_root)
    made_scene(_found(path, *how), (), source_name(path), lambda _: None)  # raises errors of the scene
    return scene_text(_found(path, *how))


def _found(
    path: str | Path,
    coordinates: Mapping[str, float],
    rates: Mapping[str, float],
    limits: bool,
    contacts: bool,
    ground: float | None,
    free_root: bool,
) -> dict[str, object]:
    try:
        return scene(_read(path, contacts or ground is not None, ground, free_root), coordinates, rates, limits)
    except FileFault as fault:
        raise InputError(f"{source_name(path)}: {fault}") from None
    except RecursionError:
        raise InputError(f"{source_name(path)}: the file cannot be read (its elements are nested too deeply)") from None
    except np.linalg.LinAlgError:
        raise InputError(f"{source_name(path)}: {BEYOND}") from None


def _read(path: str | Path, contacts: bool, ground: float | None, free_root: bool) -> Robot:
    if Path(path).suffix.lower() == URDF:
        from .urdf import read_urdf

        return read_urdf(file_text(path), contacts, ground, free_root)
    if free_root:
        raise RobotFault(
            "found that the root is free, expected it with a URDF file: other formats state which links move"
        )
    if Path(path).suffix.lower() in SDF:
        from .sdf.read import read_sdf

        return read_sdf(Path(path), contacts, ground)
    from .mjcf.model import read_mjcf

    return read_mjcf(path, contacts, ground)
