"""Sets of nodes and elements of an Abaqus file, by name: meshio loses parts of sets that are stated in several places."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..errors import InputError
from .mesh_files import sections

if TYPE_CHECKING:
    import meshio


def with_own_sets(mesh: meshio.Mesh, path: Path) -> meshio.Mesh:
    """Return a mesh that was read from an Abaqus file, with all its sets. Raises InputError."""
    nodes: list[str] = []
    elements: list[list[str]] = []
    sets: dict[str, dict[str, list[str]]] = {"NSET": {}, "ELSET": {}}
    for keyword, options, lines in sections(path):
        words = [word for line in lines for word in line if word]
        if keyword == "*NODE":
            found, kind = [line[0] for line in lines if line[0]], "NSET"
            nodes += found
        elif keyword == "*ELEMENT":
            found, kind = words[:: 1 + mesh.cells[len(elements)].data.shape[1]], "ELSET"
            elements.append(found)
        elif keyword in ("*NSET", "*ELSET"):
            found, kind = list(_members(lines, "GENERATE" in options)), keyword[1:]
        else:
            continue
        if name := options.get(kind, "").strip('"'):
            sets[kind].setdefault(name, []).extend(found)
    places = {name: k for k, name in enumerate(nodes)}
    mesh.point_sets = {name: _places(name, sets["NSET"], [places])[0] for name in sets["NSET"]}
    blocks = [{name: k for k, name in enumerate(block)} for block in elements]
    mesh.cell_sets = {name: _places(name, sets["ELSET"], blocks) for name in sets["ELSET"]}
    return mesh


def _members(lines: list[list[str]], generate: bool) -> Iterator[str]:
    """Yield the numbers and names of a set."""
    for line in lines:
        words = [word.strip('"') for word in line if word]
        if generate and words:
            first, last, step = (int(word) for word in [*words, "1"][:3])
            yield from map(str, range(first, last + 1, step))
        else:
            yield from words


def _places(
    name: str, sets: Mapping[str, list[str]], blocks: list[dict[str, int]], within: tuple[str, ...] = ()
) -> list[np.ndarray]:
    """Return the places of the members of a set in each block; a member may be another set."""
    if name in within:
        raise InputError(f"found the set '{name}' within itself, expected sets of nodes, elements or other sets")
    found: list[list[np.ndarray]] = [[np.empty(0, dtype=np.int64)] for _ in blocks]
    numbers = []
    for member in sets[name]:
        if member in sets:
            for parts, inner in zip(found, _places(member, sets, blocks, (*within, name)), strict=True):
                parts.append(inner)
        else:
            numbers.append(member)
    known = set(chain.from_iterable(blocks))
    if unknown := [member for member in numbers if member not in known]:
        raise InputError(f"set {name}: found {unknown[0]}, expected numbers or sets of the file")
    for parts, block in zip(found, blocks, strict=True):
        parts.append(np.array([block[member] for member in numbers if member in block], dtype=np.int64))
    return [np.unique(np.concatenate(parts)) for parts in found]
