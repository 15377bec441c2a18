"""Redundant equations that are proven near the start only, as they contain formulas or tables.

Dependence of equations is found numerically at a few poses. For joints of points, lines and angles it holds at all
poses, as their equations are analytic. A formula may be constant over a wide range only.
"""

from __future__ import annotations

import numpy as np

from ..compile.group import Group
from ..compile.system import System
from ..elements.element import Element
from ..presolve.dependence import curved
from ..reading.formula.formula import Formula
from ..reading.table import Table
from .redundancy import Redundancy


def unproven(redundancy: Redundancy) -> dict[int, tuple[int, ...]]:
    """Return the redundant equations that depend on others through formulas or tables: the other rows by row."""
    if not redundancy.redundant:
        return {}
    of_functions = by_functions(redundancy.system)
    found = {}
    for rank_result in redundancy.rank_results:
        rows = rank_result.rank.equations.loop.rows
        for part in rank_result.redundant:
            row, others = int(rows[part.row]), rows[list(part.others)]
            if of_functions[row] or of_functions[others].any():
                found[row] = tuple(others.tolist())
    return found


def by_functions(system: System) -> np.ndarray:
    """Return a mask of the rows with formulas or tables of pose or time, except linear ones of the pose."""
    rows = np.zeros(system.n_c, dtype=bool)
    for group in system.groups:
        if group.record.n_equations and _has_functions(group.elements[0]):  # elements of a group have the same formulas
            last = group.first_row + group.count * group.record.n_equations
            rows[group.first_row : last] = (curved(system, group) | _timed_or_nonsmooth(group)).ravel()
    return rows


def _has_functions(element: Element) -> bool:
    return any(True for sort in (Formula, Table) for _ in element.parts(sort))


def _timed_or_nonsmooth(group: Group) -> np.ndarray:
    """Return a mask of the equations of an element that depend on time, have breakpoints or are nonholonomic."""
    found = np.ones(group.record.n_equations, dtype=bool)
    found[: group.record.n_holonomic] = ~np.array(group.record.removable, dtype=bool)
    return found
