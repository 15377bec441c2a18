"""Efforts of stiff forces as unknowns, condensed element by element."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...compile.equations import ABSENT, Equations
from ...compile.terms import TERM_SETS


def condensed_efforts(equations: Equations) -> dict[str, Any]:
    """Return the lists of efforts and of their derivatives for `stiffmbs.solve.radau.native.layouts.RADAU`.

    The result: number of efforts and the sources of their values; for levers and for derivatives of efforts: sources,
    efforts, unknowns, and factors of dependent coordinates.
    """
    levers = _entries(equations, "effort", "lever", "u")
    parts = [_entries(equations, "effort_tangent", name, axis) for name, axis in (("effort_q", "q"), ("effort_u", "u"))]
    slopes = [np.concatenate(columns) for columns in zip(*parts, strict=True)]
    source = _sources(equations)
    return {
        "n_efforts": len(source), "effort_source": indices(source),
        **_listed("lever", levers), **_listed("slope", slopes),
    }  # fmt: skip


def _listed(name: str, entries: Any) -> dict[str, Any]:
    source, row, unknown, factor = entries
    return {
        f"n_{name}s": len(source), f"{name}_source": indices(source), f"{name}_effort": indices(row),
        f"{name}_unknown": indices(unknown), f"{name}_factor": np.ascontiguousarray(factor, dtype=float),
    }  # fmt: skip


def indices(numbers: np.ndarray) -> np.ndarray:
    """Return indices for compiled code."""
    return np.ascontiguousarray(numbers, dtype=np.int32)


def _sources(equations: Equations) -> np.ndarray:
    """Return the positions of all efforts among the values of their set."""
    system = equations.system
    first = system.places["effort"][:, 1 + TERM_SETS["effort"].index("effort")]
    parts = [
        first[g] + np.arange(group.count * group.entries["effort"], dtype=np.int64)
        for g, group in enumerate(system.groups)
    ]
    return np.concatenate([np.empty(0, dtype=np.int64), *parts])


def _entries(equations: Equations, term_set: str, name: str, axis: str) -> tuple[np.ndarray, ...]:
    """Return source, effort, unknown and factor of the entries of a term, without those of constant coordinates."""
    system = equations.system
    first = system.places[term_set][:, 1 + TERM_SETS[term_set].index(name)]
    found: list[tuple[np.ndarray, ...]] = []
    before = 0
    for g, group in enumerate(system.groups):
        n_efforts, n_entries = group.entries["effort"], group.entries[name]
        if n_entries:
            source, row, column = group.placed(name, int(first[g]))
            effort = before + np.repeat(np.arange(group.count) * n_efforts, n_entries) + row
            inside = column < system.extent(axis)
            source, effort, column = source[inside], effort[inside], column[inside]
            unknown, factor = equations.carried(axis, column)
            kept = unknown != ABSENT
            found.append((source[kept], effort[kept], unknown[kept], factor[kept]))
        before += group.count * n_efforts
    nothing = (*(np.empty(0, dtype=np.int64) for _ in range(3)), np.empty(0))
    return tuple(np.concatenate(columns) for columns in zip(nothing, *found, strict=True))
