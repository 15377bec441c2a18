"""Materials of the elements of a mesh, by their groups in its file."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..errors import InputError
from ..reading.did_you_mean import did_you_mean
from .mesh_files import materials_of_sections

if TYPE_CHECKING:
    import meshio

    from .description import Material

PHYSICAL, PROPERTY = "gmsh:physical", "nastran:ref"
"""Cell data of meshio with the physical groups of Gmsh, and with the properties of Nastran's elements."""
SOLIDS, SHELLS = "solid", "shell"
UNNAMED = {SOLIDS: {PHYSICAL: "physical ", PROPERTY: "PSOLID "}, SHELLS: {PHYSICAL: "physical ", PROPERTY: "PSHELL "}}
"""Names of groups of elements that have a number alone."""


class ElementMaterials(NamedTuple):
    """Young's modulus, N/m^2, Poisson's ratio and density, kg/m^3, of each element, of shape (elements,)."""

    modulus: np.ndarray
    poisson: np.ndarray
    density: np.ndarray


def of_elements(
    materials: Material | Mapping[str, Material], groups: Mapping[str, np.ndarray], cells: np.ndarray
) -> ElementMaterials:
    """Return the materials of elements.

    `materials`: one of all elements, or by groups of elements. `groups`: numbers of the elements of each group. `cells` of
    shape (elements, nodes): nodes of the elements. Raises InputError if an element is in none or in several of the groups.
    """
    if not isinstance(materials, Mapping):
        return ElementMaterials(*(np.full(len(cells), x) for x in (materials.E, materials.nu, materials.density)))
    by_groups = {name: (material.E, material.nu, material.density) for name, material in materials.items()}
    return ElementMaterials(*_by_groups("materials", by_groups, groups, cells))


def thickness_of_elements(
    thickness: float | Mapping[str, float], groups: Mapping[str, np.ndarray], cells: np.ndarray
) -> np.ndarray:
    """Return the thickness of each shell, m; parameters as `of_elements`."""
    if not isinstance(thickness, Mapping):
        return np.full(len(cells), thickness)
    return _by_groups("thicknesses", {name: (each,) for name, each in thickness.items()}, groups, cells)[0]


def _by_groups(
    key: str, given: Mapping[str, Sequence[float]], groups: Mapping[str, np.ndarray], cells: np.ndarray
) -> np.ndarray:
    """Return the numbers of each element, by rows, from those of its group. `key`: that of the groups in the description."""
    found = np.full((len(next(iter(given.values()))), len(cells)), np.nan)
    for name, numbers in given.items():
        own = groups.get(name, np.empty(0, dtype=np.int64))
        _refuse(key, own[~np.isnan(found[0, own])], f"of the group {name} in another group as well", cells)
        found[:, own] = np.array(numbers)[:, None]
    _refuse(key, np.flatnonzero(np.isnan(found[0])), f"in none of the groups {', '.join(given)}", cells)
    return found


def refuse_unknown(key: str, given: object, groups: Collection[str], what: str) -> None:
    """Raise an InputError if there is no group of elements for a material or a thickness.

    `given`: one of all elements, or by groups. `what`: `SOLIDS` or `SHELLS`.
    """
    for name in given if isinstance(given, Mapping) else ():
        if name not in groups:
            raise InputError(
                f"{key}.{name}: found no group of {what} elements '{name}'{did_you_mean(name, groups)}, expected one of the file "
                f"({', '.join(groups) or 'none'})"
            )


def _refuse(key: str, elements: np.ndarray, where: str, cells: np.ndarray) -> None:
    if len(elements):
        nodes = ", ".join(map(str, cells[elements[0]]))
        raise InputError(
            f"{key}: found {len(elements)} elements {where}, the first with nodes {nodes}, expected each element in one group"
        )


def element_groups(mesh: meshio.Mesh, kind: str, what: str) -> dict[str, np.ndarray]:
    """Return the numbers of the elements of one kind in each group: sets, physical groups of Gmsh, properties of Nastran.

    Elements are numbered in the order of the blocks of their kind. Groups without a name are called
    ``physical 2``, ``PSOLID 2`` or ``PSHELL 2``, by their number. `what`: `SOLIDS` or `SHELLS`.
    """
    names = {(tag, dimension): name for name, (tag, dimension) in mesh.field_data.items()}
    found: dict[str, list[np.ndarray]] = {}
    first = 0
    for k, block in enumerate(mesh.cells):
        if block.type != kind:
            continue
        for name, of_blocks in mesh.cell_sets.items():
            if len(of_blocks[k]):
                found.setdefault(name, []).append(first + np.asarray(of_blocks[k], dtype=np.int64))
        for data, unnamed in UNNAMED[what].items():
            tags = np.asarray(mesh.cell_data[data][k]) if data in mesh.cell_data else np.empty(0, dtype=np.int64)
            for tag in np.unique(tags).tolist():
                name = names.get((tag, block.dim), f"{unnamed}{tag}")
                found.setdefault(name, []).append(first + np.flatnonzero(tags == tag))
        first += len(block.data)
    return {name: np.concatenate(parts) for name, parts in found.items()}


def parts_of(path: Path, mesh: meshio.Mesh, groups: Sequence[Mapping[str, np.ndarray]], whats: Sequence[str]) -> str:
    """Return the names of parts that may have materials of their own; empty if there are fewer than two.

    These are the materials of the sections of an Abaqus or Nastran file, or physical groups of Gmsh that share no element.
    `groups`: elements of each group, by kinds of elements. `whats`: of `SOLIDS` and `SHELLS`.
    """
    parts = list(dict.fromkeys(part for what in whats for part in materials_of_sections(path, what)))
    if PHYSICAL in mesh.cell_data:
        names = dict.fromkeys(name for of_kind in groups for name in of_kind)
        parts = [name for name in names if name in mesh.field_data or name.startswith(UNNAMED[SOLIDS][PHYSICAL])]
        for of_kind in groups:
            elements = np.concatenate([of_kind.get(name, np.empty(0, dtype=np.int64)) for name in parts])
            if len(np.unique(elements)) < len(elements):
                return ""
    return " and ".join(parts) if len(parts) > 1 else ""
