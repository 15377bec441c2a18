"""Mode shapes of a reduced body in files for ParaView."""

from __future__ import annotations

from pathlib import Path

from ..errors import InputError, needs
from .finite_elements import FiniteElements
from .reduction import ReducedBody

SUFFIXES = (".vtu", ".vtk")


def check_shapes_file(path: Path) -> None:
    """Refuse a file of another type, and a missing package. Raises InputError."""
    if path.suffix.lower() not in SUFFIXES:
        raise InputError(f"-o {path}: found the type '{path.suffix}', expected {' or '.join(SUFFIXES)}")
    with needs("meshio", "flexible"):
        import meshio  # noqa: F401


def write_shapes(path: Path, model: FiniteElements, body: ReducedBody) -> None:
    """Write nodes, elements and the displacement of each mode as vectors at the nodes. Raises OSError."""
    import meshio
    import numpy as np

    cells = dict(model.cells) or {"vertex": np.arange(len(model.nodes))[:, None]}
    fields = {
        f"mode {k + 1}: {frequency:.6g} Hz": body.modes[:, k].reshape(-1, 3)
        for k, frequency in enumerate(body.frequencies)
    }
    meshio.Mesh(model.nodes, list(cells.items()), point_data=fields).write(path)
