"""Reading of mesh files: STL, text or binary, and the vertices and faces of OBJ."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ...errors import InputError
from ...reading.files.files_read import content_of
from .scene_graph import Solid

HEAD = np.dtype([("text", "S80"), ("facets", "<u4")])
FACET = np.dtype([("floats", "<f4", 12), ("rest", "<u2")])
"""Layout of a binary STL."""


def read_mesh(path: Path, where: str) -> Solid:
    """Read the mesh of a file, in the file's units.

    `path`: name in .stl or .obj. `where`: name of the shape in messages. Raises InputError if the file cannot be read.
    """
    try:
        data = content_of(path)
    except OSError as error:
        raise InputError(f"{where}: {path}: {error.strerror}, expected a mesh") from None
    try:
        mesh = _obj(data) if path.suffix.lower() == ".obj" else _stl(data)
    except (ValueError, IndexError, UnicodeDecodeError):
        mesh = None
    if mesh is None or not mesh.faces or not np.isfinite(mesh.vertices).all():
        raise InputError(f"{where}: {path}: found no triangles, expected a mesh in the format of its ending")
    return mesh


def _stl(data: bytes) -> Solid:
    count = int(np.frombuffer(data, HEAD, 1)["facets"][0]) if len(data) >= HEAD.itemsize else -1
    if len(data) == HEAD.itemsize + FACET.itemsize * count:
        facets = np.frombuffer(data, FACET, offset=HEAD.itemsize)
        corners = facets["floats"][:, 3:].reshape(-1, 3).astype(float)
    else:
        words = [line.split() for line in data.decode("utf-8").splitlines()]
        corners = np.array([[float(x) for x in line[1:4]] for line in words if line[:1] == ["vertex"]])
    vertices, of_corner = np.unique(corners, axis=0, return_inverse=True)
    return Solid(vertices, tuple(of_corner.reshape(-1, 3)))


def _obj(data: bytes) -> Solid:
    vertices, faces = [], []
    for line in data.decode("utf-8", errors="replace").splitlines():
        match line.split():
            case ["v", x, y, z, *_]:
                vertices.append([float(x), float(y), float(z)])
            case ["f", *corners] if len(corners) >= 3:
                numbers = [int(corner.split("/")[0]) for corner in corners]
                faces.append(np.array([k - 1 if k > 0 else len(vertices) + k for k in numbers]))
    if any(face.min() < 0 or face.max() >= len(vertices) for face in faces):
        raise ValueError("a face of vertices that are not there")
    return Solid(np.array(vertices).reshape(-1, 3), tuple(faces))
