"""Run every case with another implicit solver than bdf."""

from __future__ import annotations

from stiffmbs import solve

REPLACEMENT = "STIFFMBS_STRESS_SOLVER"
"""Environment variable with the name of the solver, so that child processes see it."""


def replace_bdf(name: str) -> None:
    """Integrate by another solver wherever a case asks for bdf, the default."""
    solve.SOLVERS["bdf"] = solve.SOLVERS[name]
