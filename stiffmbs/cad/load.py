"""Loading of scenes from the files of CAD programs."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from ..elements.spatial.massless import BEYOND
from ..errors import InputError
from ..model.read_scene import made_scene
from ..model.scene import Scene
from ..reading.files.text_file import file_text, source_name
from ..reading.files.xml_nodes import FileFault
from ..reading.files.yaml_text import Content, scene_text
from .assembly import Assembly
from .scene import scene

XML, ASMT = ".xml", ".asmt"
_SIMSCAPE = re.compile(
    r"(?:\s|<\?.*?\?>|<!--.*?-->|<!DOCTYPE[^>]*>)*<(?:SimscapeMultibodyImportXML|PhysicalModelingXMLFile)\b", re.DOTALL
)
"""Start of an XML file up to its root element."""


def is_cad(path: str | Path) -> bool:
    """Return True for an .asmt file, and for an XML file whose root is one of Simscape Multibody."""
    suffix = Path(path).suffix.lower()
    return suffix == ASMT or (suffix == XML and _SIMSCAPE.match(file_text(path)) is not None)


def load_cad(path: str | Path, changes: Sequence[tuple[str, str]] = ()) -> Scene:
    """Read a scene from a CAD program's file.

    Parameters
    ----------
    path : str or Path
        FreeCAD's ``.asmt``, or Simscape Multibody XML.
    changes : sequence of (path, text)
        Values that replace those of the file, such as ``("gravity", "[0, -9.81, 0]")``.

    Raises
    ------
    InputError
        If the file cannot be read, or its assembly is not a valid scene.
    """
    return made_scene(_found(path), changes, source_name(path), lambda _: None)


def convert_cad(path: str | Path) -> str:
    """Return the scene of a CAD program's file as the text of a scene file; errors as `load_cad`."""
    load_cad(path)  # raises errors of the scene
    return scene_text(_found(path))


def _found(path: str | Path) -> Content:
    try:
        return scene(_reader(path)(file_text(path)))
    except FileFault as fault:
        raise InputError(f"{source_name(path)}: {fault}") from None
    except RecursionError:
        raise InputError(f"{source_name(path)}: the file cannot be read (its elements are nested too deeply)") from None
    except np.linalg.LinAlgError:
        raise InputError(f"{source_name(path)}: {BEYOND}") from None


def _reader(path: str | Path) -> Callable[[str], Assembly]:
    if Path(path).suffix.lower() == ASMT:
        from .ondsel.read import read_asmt

        return read_asmt
    from .simscape.read import read_simscape

    return read_simscape
