"""Numbers and positions of nodes in files of finite element programs."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ..errors import InputError, needs, prefixed
from ..reading.files.quoted import first_line
from .mesh_files import data_lines


@dataclass(frozen=True, eq=False)
class Nodes:
    """Nodes in the order of their numbers.

    `numbers` of shape (n,): increasing; from 0 if the file has none. `points` of shape (n, 3): in the unit of the file.
    `groups`: named sets as places in ``numbers``.
    """

    numbers: np.ndarray
    points: np.ndarray
    groups: dict[str, np.ndarray] = field(default_factory=dict)


@contextmanager
def readable(kind: str, expected: str) -> Iterator[None]:
    """Raise an `InputError` in place of the many types that readers of other packages raise."""
    try:
        yield
    except (InputError, MemoryError):
        raise
    except Exception as error:
        raise InputError(f"found no {kind} ({first_line(error)}), expected {expected}") from None


def read_nodes(path: Path) -> Nodes:
    """Return the nodes of a file: Nastran, Abaqus or CalculiX, Ansys, or a table. Raises InputError."""
    read = READERS.get(path.suffix.lower(), _table)
    with prefixed("nodes: "):
        with readable("table", "x, y and z of each node"):
            numbers, points, groups = read(path)
        points = np.asarray(points, dtype=float)
        if points.ndim != 2 or points.shape[1] != 3 or len(points) < 3:
            raise InputError(f"found an array of shape {points.shape}, expected x, y and z of 3 or more nodes")
        order = np.argsort(numbers, kind="stable")
        numbers = np.asarray(numbers, dtype=np.int64)[order]
        twice = numbers[1:][numbers[1:] == numbers[:-1]]
        if len(twice):
            raise InputError(f"found node {twice[0]} twice, expected each number once")
        return Nodes(
            numbers, points[order],
            {name: np.searchsorted(numbers, np.intersect1d(own, numbers)) for name, own in groups.items()},
        )  # fmt: skip


Found = tuple[np.ndarray, np.ndarray, dict[str, np.ndarray]]


def _table(path: Path) -> Found:
    """Return lines of x, y and z, with or without a number before them."""
    text = path.read_text()
    if not text.strip():
        raise InputError("found an empty file, expected x, y and z of each node")
    found = np.loadtxt(text.splitlines(), delimiter="," if "," in text else None, ndmin=2)
    if found.shape[1] == 4:
        return found[:, 0].astype(np.int64), found[:, 1:], {}
    return np.arange(len(found)), found, {}


def _nastran(path: Path) -> Found:
    with np.printoptions(), needs("pyyeti", "flexible"):  # pyYeti sets that of NumPy 1.13
        from pyyeti.nastran import bulk
    found = bulk.rdgrids(str(path))
    if found is None:
        raise InputError("found no GRID entry, expected the nodes of the model")
    local = np.flatnonzero(found[:, [1, 5]].any(axis=1))
    if len(local):
        raise InputError(
            f"found node {found[local[0], 0]:.0f} in a local coordinate system, expected the basic one (CP and CD empty)"
        )
    return found[:, 0].astype(np.int64), found[:, 2:5], {}


def _abaqus(path: Path) -> Found:
    """Return the nodes and node sets of an input file of Abaqus or CalculiX."""
    numbers: list[int] = []
    points: list[list[float]] = []
    groups: dict[str, list[int]] = {}
    for keyword, options, words in data_lines(path):
        if keyword == "*NODE":
            numbers.append(int(words[0]))
            points.append([float(word or 0) for word in words[1:4]])
        named = options.get("NSET")
        if named and keyword == "*NODE":
            groups.setdefault(named, []).append(numbers[-1])
        elif named and keyword == "*NSET":
            listed = [int(word) for word in words if word.isdigit()]
            if "GENERATE" in options:
                first, last, *step = listed
                listed = list(range(first, last + 1, *step))
            groups.setdefault(named, []).extend(listed)
    return np.array(numbers), np.array(points), {name: np.array(own) for name, own in groups.items()}


def _ansys(path: Path) -> Found:
    with needs("ansys", "ansys"):
        from ansys.mapdl.reader import Archive
    found = Archive(str(path), parse_vtk=False)
    groups = {name: np.asarray(own) for name, own in found.node_components.items()}
    return np.asarray(found.nnum), np.asarray(found.nodes)[:, :3], groups


READERS: dict[str, Callable[[Path], Found]] = {
    ".bdf": _nastran, ".dat": _nastran, ".fem": _nastran, ".nas": _nastran, ".inp": _abaqus, ".cdb": _ansys,
}  # fmt: skip
