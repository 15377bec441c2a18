"""Finite element models given by a NumPy archive."""

from __future__ import annotations

import io
import re
from collections.abc import Mapping
from typing import Any

import numpy as np
from scipy.sparse import csr_array

from ..errors import InputError
from ..reading.files.quoted import first_line
from .finite_elements import FiniteElements
from .node_files import readable
from .shapes import ELEMENTS

CELL_TYPES = {len(element.powers): kind for kind, element in ELEMENTS.items()}
CELL = re.compile(rf"^({'|'.join(ELEMENTS)})$|^hex(8|20|27)$|^el$")
NODES = ("nodes", "X")
PARTS = {"data": ("_data", "data"), "indices": ("_indices", "ind"), "indptr": ("_indptr", "ptr")}
"""Suffixes of the arrays of a sparse matrix by rows (CSR), such as ``K_data``."""


def from_archive(content: bytes, length: float, mass: float, time: float) -> FiniteElements:
    """Return the model of a NumPy archive (.npz).

    `content`: archive with ``nodes`` (n, 3), and ``K`` and ``M``: dense, or sparse by rows as ``K_data``, ``K_indices``
    and ``K_indptr``. One-dimensional arrays of integers are groups of nodes, two-dimensional ones elements. `length`,
    `mass`, `time`: units of the file in m, kg and s. Raises InputError.
    """
    expected = "arrays nodes, K and M (numpy.savez)"
    with readable("NumPy archive", expected), np.load(io.BytesIO(content), allow_pickle=False) as archive:
        arrays = dict(archive)
    if (imaginary := next((key for key, array in arrays.items() if np.iscomplexobj(array)), None)) is not None:
        raise InputError(f"{imaginary}: found complex numbers, expected real ones")
    name = next((name for name in NODES if name in arrays), None)
    if name is None:
        raise InputError(f"found the arrays {', '.join(arrays) or 'none'}, expected nodes, K and M")
    stiffness, of_mass = (_sparse(letter, arrays) for letter in "KM")
    nodes = _positions(arrays[name])
    used = {name, "K", "M", *(f"{letter}{end}" for letter in "KM" for ends in PARTS.values() for end in ends)}
    groups, cells = {}, {}
    for key, array in arrays.items():
        if key in used or not np.issubdtype(array.dtype, np.integer):
            continue
        if array.ndim == 1:
            groups[key] = _node_numbers(key, array, len(nodes))
        elif array.ndim == 2 and CELL.match(key) and array.shape[1] in CELL_TYPES:
            cells[CELL_TYPES[array.shape[1]]] = _node_numbers(key, array, len(nodes))
    return FiniteElements(nodes * length, stiffness * (mass / time**2), of_mass * mass, groups, cells)


def _positions(nodes: np.ndarray) -> np.ndarray:
    if nodes.ndim != 2 or nodes.shape[1] != 3 or len(nodes) < 3 or not np.issubdtype(nodes.dtype, np.number):
        raise InputError(
            f"nodes: found an array of shape {nodes.shape}, expected three numbers for each of 3 or more nodes"
        )
    return nodes.astype(float)


def _node_numbers(key: str, array: np.ndarray, count: int) -> np.ndarray:
    if array.size and not 0 <= array.min() <= array.max() < count:
        raise InputError(f"{key}: found node {array.max()} of {count} nodes, expected numbers of nodes from 0")
    return array.astype(np.int64)


def _sparse(letter: str, arrays: Mapping[str, Any]) -> csr_array:
    """Return matrix K or M of an archive."""
    try:
        if letter in arrays:
            dense = np.atleast_2d(arrays[letter].astype(float))
            if dense.ndim > 2:
                raise ValueError(f"{dense.ndim} dimensions")
            return csr_array(dense)
        parts = [
            next(arrays[f"{letter}{end}"] for end in ends if f"{letter}{end}" in arrays) for ends in PARTS.values()
        ]
        data, indices, indptr = parts
        size = len(indptr) - 1
        found = csr_array((data.astype(float), indices, indptr), shape=(size, size))
        found.check_format()
        return found
    except StopIteration:
        raise InputError(
            f"found no array {letter}, expected it dense or as {letter}_data, {letter}_indices and {letter}_indptr"
        ) from None
    except (ValueError, TypeError, IndexError) as error:
        raise InputError(
            f"{letter}: found no matrix ({first_line(error)}), expected one dense or sparse by rows"
        ) from None
