"""Redundant equations that are known to be so near the start alone, as formulas or tables are in them.

That equations depend on each other is found by numbers at a few poses.  For joints of points, lines and angles this says
the same of all poses, as their equations are analytic.  A formula may be flat over a wide range and not elsewhere.
"""

from __future__ import annotations

import numpy as np

from ..compile.group import Group
from ..compile.system import System
from ..describe.element import Element
from ..describe.formula.formula import Formula
from ..describe.table import Table
from ..presolve.dependence import curved
from .redundancy import Redundancy


def unproven(redundancy: Redundancy) -> dict[int, tuple[int, ...]]:
    """The redundant equations that hold the same as others by formulas or tables: by their rows those of the others."""
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
    """The rows in which formulas or tables of the pose or of time stand, but for linear ones of the pose."""
    rows = np.zeros(system.n_c, dtype=bool)
    for group in system.groups:
        if group.record.n_equations and _has_functions(group.elements[0]):  # those of one kind have the same formulas
            last = group.first_row + group.count * group.record.n_equations
            rows[group.first_row : last] = (curved(system, group) | _timed_or_nonsmooth(group)).ravel()
    return rows


def _has_functions(element: Element) -> bool:
    return any(True for sort in (Formula, Table) for _ in element.parts(sort))


def _timed_or_nonsmooth(group: Group) -> np.ndarray:
    """Which equations of one element know time or breakpoints, or velocities alone."""
    found = np.ones(group.record.n_equations, dtype=bool)
    found[: group.record.n_holonomic] = ~np.array(group.record.removable, dtype=bool)
    return found
