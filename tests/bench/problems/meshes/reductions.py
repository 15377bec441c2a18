"""Reductions of a bar with up to 100 000 nodes to 20 normal modes; errors of its free frequencies."""

from __future__ import annotations

from ...reductions import Mesh, Reductions

BENCHMARKS = (
    Reductions("reductions", (Mesh("tetra10", 20, 2), Mesh("tetra10", 48, 14), Mesh("tetra", 147, 25))),
)  # fmt: skip
