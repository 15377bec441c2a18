"""Matrices of finite element programs: Matrix Market, Nastran .op2, .op4 and .pch, Ansys .full, CalculiX .sti and .mas."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from scipy.io import mmread
from scipy.sparse import csr_array, triu

from ..errors import InputError, needs, prefixed
from .finite_elements import FiniteElements
from .node_files import Nodes, read_nodes, readable

NO_ROTATION = 1e-9
"""Largest entry of the rows of rotations, relative to the largest entry, that is taken as none."""
Found = tuple[csr_array, np.ndarray | None]
"""Matrix, and the number of the node and the component (1 to 6) of each row, shape (rows, 2), if the file has them."""


def from_files(
    stiffness: Path, mass: Path, nodes: Path, rows: Path | None, names: tuple[str | None, str | None],
    length: float, unit_mass: float, time: float,
) -> FiniteElements:  # fmt: skip
    """Return the model of a stiffness matrix, a mass matrix and a list of nodes.

    `rows`: file of CalculiX (.dof) with the node and component of each row. `names`: names of K and M in files with
    several matrices. `length`, `unit_mass`, `time`: units of the files in m, kg and s. Raises InputError.
    """
    found = read_nodes(nodes)
    labels = None if rows is None else _labels_of_calculix(rows)
    placed = []
    for key, path, letter, name in zip(("stiffness", "mass"), (stiffness, mass), "KM", names, strict=True):
        with prefixed(f"{key}: "):
            matrix, own = _read(path, letter, name)
            placed.append(_placed(matrix, labels if own is None else own, found))
    used = np.unique(placed[0].nonzero()[0] // 3)
    if len(used) in (0, len(found.numbers)):
        used = np.arange(len(found.numbers))
    rows_used = (3 * used[:, None] + np.arange(3)).ravel()
    K, M = (csr_array(matrix[rows_used][:, rows_used]) for matrix in placed)
    place = {int(node): k for k, node in enumerate(used)}
    groups = {name: np.array([place[k] for k in of.tolist() if k in place]) for name, of in found.groups.items()}
    return FiniteElements(
        found.points[used] * length, K * (unit_mass / time**2), M * unit_mass, groups, numbers=found.numbers[used]
    )


def _read(path: Path, letter: str, name: str | None) -> Found:
    """Return matrix K or M of a file, with both triangles."""
    suffix = path.suffix.lower()
    if suffix not in READERS:
        raise InputError(f"found the type '{path.suffix}', expected one of {', '.join(READERS)}")
    kind, read = READERS[suffix]
    with readable(kind, "one that is complete"):
        named, labels = read(path)
    key = _chosen(list(named), letter, name)
    matrix = csr_array(named[key])
    if np.iscomplexobj(matrix):
        raise InputError("found complex numbers, expected real ones")
    if matrix.shape[0] != matrix.shape[1]:
        raise InputError(f"found {matrix.shape[0]} x {matrix.shape[1]} entries, expected a square matrix")
    above, below = triu(matrix, 1), triu(matrix.T, 1)
    if (above.nnz == 0) != (below.nnz == 0):  # one triangle is stored
        matrix = csr_array(matrix + above.T + below)
    return matrix, labels.get(key)


def _chosen(names: list[str], letter: str, name: str | None) -> str:
    """Return the name of matrix K or M in a file."""
    if name is not None:
        own = [key for key in names if key.lower() == name.lower()]
    else:
        own = names if len(names) == 1 else [key for key in names if key.upper().startswith(letter)]
    if len(own) != 1:
        by_letter = f"exactly one with a name that begins with {letter}, or its name in the field names"
        wanted = f"'{name}'" if name else by_letter
        raise InputError(f"found the matrices {', '.join(names) or 'none'}, expected {wanted}")
    return own[0]


def _placed(matrix: csr_array, labels: np.ndarray | None, nodes: Nodes) -> csr_array:
    """Return a matrix with three rows for each node; the rows of rotations are empty in the file."""
    count = len(nodes.numbers)
    if labels is None:
        per_node = 6 if matrix.shape[0] == 6 * count else 3
        if matrix.shape[0] != per_node * count:
            raise InputError(
                f"found {matrix.shape[0]} rows for {count} nodes, expected {3 * count}: three displacements per node "
                f"(or {6 * count} with empty rows of rotations)"
            )
        labels = np.column_stack([np.repeat(nodes.numbers, per_node), np.tile(np.arange(1, per_node + 1), count)])
    if matrix.shape[0] > len(labels):
        raise InputError(f"found {matrix.shape[0]} rows, expected the {len(labels)} of the file of rows")
    node = np.searchsorted(nodes.numbers, labels[:, 0]).clip(max=count - 1)
    unknown = np.flatnonzero((nodes.numbers[node] != labels[:, 0]) | (labels[:, 1] == 0))
    if len(unknown):
        number, component = labels[unknown[0]].tolist()
        what = f"scalar point {number}, a modal coordinate" if component == 0 else f"a row of node {number}"
        raise InputError(f"found {what}, expected only rows of the {count} nodes")
    entries = matrix.tocoo()
    turns = labels[:, 1] > 3
    of_turns = turns[entries.row] | turns[entries.col]
    sizes = np.abs(entries.data)
    solid = sizes <= NO_ROTATION * sizes.max(initial=0.0)
    if not solid[of_turns].all():
        row, column = (index[of_turns & ~solid][0] for index in (entries.row, entries.col))
        number = labels[row if turns[row] else column, 0]
        raise InputError(
            f"found entries for the rotations of node {number}, expected solid elements: three displacements per node"
        )
    place, kept = 3 * node + np.minimum(labels[:, 1], 3) - 1, ~of_turns
    return csr_array(
        (entries.data[kept], (place[entries.row[kept]], place[entries.col[kept]])), shape=(3 * count, 3 * count)
    )


def _matrix_market(path: Path) -> tuple[Mapping[str, object], dict[str, np.ndarray]]:
    return {"matrix": mmread(path)}, {}


def _op4(path: Path) -> tuple[Mapping[str, object], dict[str, np.ndarray]]:
    with np.printoptions(), needs("pyyeti", "flexible"):  # pyYeti sets that of NumPy 1.13
        from pyyeti.nastran import op4
    return op4.read(str(path), sparse=True), {}


def _op2(path: Path) -> tuple[Mapping[str, object], dict[str, np.ndarray]]:
    """Return the matrices of an OUTPUT2 file, and those of its DMIG tables."""
    with np.printoptions(), needs("pyyeti", "flexible"):  # pyYeti sets that of NumPy 1.13
        from pyyeti.nastran import bulk, op2
    with op2.OP2(str(path)) as file:
        matrices = file.rdop2mats()
    if matrices:
        return matrices, {}
    tables = bulk.rddmig(str(path), square=True)
    return tables, {name: np.array(table.index.tolist()) for name, table in tables.items()}


def _punch(path: Path) -> tuple[Mapping[str, object], dict[str, np.ndarray]]:
    """Return the DMIG matrices of a punch file; entries of a symmetric matrix are given once."""
    with np.printoptions(), needs("pyyeti", "flexible"):  # pyYeti sets that of NumPy 1.13
        from pyyeti.nastran import bulk
    entries: dict[str, list[tuple[int, int, int, int, float]]] = {}
    for name, *card in bulk.rdcards(str(path), "dmig", return_var="list", blank="") or ():
        if card[0] == 0:
            if card[2] > 2:
                raise InputError(f"found complex numbers in {name}, expected real ones")
            entries[name] = []
            continue
        column = int(card[0]), int(card[1] or 0)
        for k in range(3, len(card) - 2, 4):
            entries[name].append((*column, int(card[k]), int(card[k + 1] or 0), float(card[k + 2])))
    matrices, labels = {}, {}
    for name, found in entries.items():
        columns, rows = (np.array([entry[k : k + 2] for entry in found]).reshape(-1, 2) for k in (0, 2))
        labels[name], index = np.unique(np.vstack([rows, columns]), axis=0, return_inverse=True)
        place = index.reshape(2, -1)
        size = len(labels[name])
        matrices[name] = csr_array(([entry[4] for entry in found], (place[0], place[1])), shape=(size, size))
    return matrices, labels


def _full(path: Path) -> tuple[Mapping[str, object], dict[str, np.ndarray]]:
    with needs("ansys", "ansys"):
        from ansys.mapdl.reader import read_binary
    file = read_binary(str(path))
    labels, K, M = file.load_km(sort=True)
    if len(file.const):
        raise InputError(f"found {len(file.const)} supported displacements, expected a solution of the free body")
    labels = np.asarray(labels, dtype=np.int64) + np.array([0, 1])
    return {"K": K, "M": M}, {"K": labels, "M": labels}


def _calculix(path: Path) -> tuple[Mapping[str, object], dict[str, np.ndarray]]:
    row, column, value = np.loadtxt(path, ndmin=2).T
    rows, columns = row.astype(np.int64) - 1, column.astype(np.int64) - 1
    size = max(rows.max(), columns.max()) + 1
    return {"matrix": csr_array((value, (rows, columns)), shape=(size, size))}, {}


def _labels_of_calculix(path: Path) -> np.ndarray:
    """Return the nodes and components of a .dof file, such as ``12.3`` for z of node 12."""

    def rows() -> Iterator[tuple[int, int]]:
        for line in path.read_text().split():
            node, _, component = line.partition(".")
            yield int(node), int(component[:1])

    try:
        return np.array(list(rows()), dtype=np.int64).reshape(-1, 2)
    except (ValueError, OSError) as error:
        raise InputError(f"rows: found no list of node.component ({error}), expected a .dof file") from None


READERS: dict[str, tuple[str, Any]] = {
    ".mtx": ("Matrix Market file", _matrix_market), ".op4": ("OUTPUT4 file", _op4), ".op2": ("OUTPUT2 file", _op2),
    ".pch": ("punch file", _punch), ".full": ("Ansys file", _full), ".sti": ("CalculiX file", _calculix),
    ".mas": ("CalculiX file", _calculix),
}  # fmt: skip
"""Name of the format and reader by suffix of a file."""
