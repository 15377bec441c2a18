"""Shells of second order, divided into those of first order between their nodes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    import meshio

PARTS: Final[dict[str, dict[str, tuple[tuple[int, ...], ...]]]] = {
    "triangle6": {"triangle": ((0, 3, 5), (1, 4, 3), (2, 5, 4), (3, 4, 5))},
    "quad8": {"triangle": ((0, 4, 7), (1, 5, 4), (2, 6, 5), (3, 7, 6)), "quad": ((4, 5, 6, 7),)},
    "quad9": {"quad": ((0, 4, 8, 7), (4, 1, 5, 8), (8, 5, 2, 6), (7, 8, 6, 3))},
}
"""Elements between the nodes of each kind of second order, by kinds of first order, in the words and the order of meshio."""


def with_divided_shells(mesh: meshio.Mesh) -> meshio.Mesh:
    """Return a mesh whose surface elements of second order are divided; the parts belong to all groups of the element.

    All nodes on edges remain nodes of the mesh. Flat elements between them follow a curved surface as those of a mesh with half of the size.
    """
    import meshio as io

    if not any(block.type in PARTS for block in mesh.cells):
        return mesh
    cells: list[tuple[str, np.ndarray]] = []
    data: dict[str, list[np.ndarray]] = {name: [] for name in mesh.cell_data}
    sets: dict[str, list[np.ndarray]] = {name: [] for name in mesh.cell_sets}
    for k, block in enumerate(mesh.cells):
        count = len(block.data)
        for kind, parts in PARTS.get(block.type, {block.type: (tuple(range(block.data.shape[1])),)}).items():
            cells.append((kind, np.concatenate([block.data[:, list(part)] for part in parts])))
            for name, of_blocks in mesh.cell_data.items():
                data[name].append(np.concatenate([np.asarray(of_blocks[k])] * len(parts)))
            for name, members in mesh.cell_sets.items():
                own = np.asarray(members[k] if members[k] is not None else [], dtype=np.int64)
                sets[name].append(np.concatenate([own + count * part for part in range(len(parts))]))
    found = io.Mesh(mesh.points, cells, cell_data=data, field_data=mesh.field_data, point_sets=mesh.point_sets)
    found.cell_sets = sets
    return found
