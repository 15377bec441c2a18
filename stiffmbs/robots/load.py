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
from .robot import Robot
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

    Raises
    ------
    InputError
        If the file cannot be read, or its robot is not a valid scene.
    """
    return made_scene(_found(path, coordinates, rates, limits), changes, source_name(path), lambda _: None)


def convert_robot(
    path: str | Path,
    *,
    coordinates: Mapping[str, float] = AS_DRAWN,
    rates: Mapping[str, float] = AS_DRAWN,
    limits: bool = False,
) -> str:
    """Return the scene of a robot file as the text of a scene file; parameters and errors as `load_robot`."""
    load_robot(path, coordinates=coordinates, rates=rates, limits=limits)  # raises errors of the scene
    return scene_text(_found(path, coordinates, rates, limits))


def _found(
    path: str | Path, coordinates: Mapping[str, float], rates: Mapping[str, float], limits: bool
) -> dict[str, object]:
    try:
        return scene(_read(path), coordinates, rates, limits)
    except FileFault as fault:
        raise InputError(f"{source_name(path)}: {fault}") from None
    except RecursionError:
        raise InputError(f"{source_name(path)}: the file cannot be read (its elements are nested too deeply)") from None
    except np.linalg.LinAlgError:
        raise InputError(f"{source_name(path)}: {BEYOND}") from None


def _read(path: str | Path) -> Robot:
    if Path(path).suffix.lower() == URDF:
        from .urdf import read_urdf

        return read_urdf(file_text(path))
    if Path(path).suffix.lower() in SDF:
        from .sdf.read import read_sdf

        return read_sdf(Path(path))
    from .mjcf.model import read_mjcf

    return read_mjcf(path)
