"""Which scenes have laws whose features may begin and end within one step."""

from __future__ import annotations

from .system import System


def has_laws(system: System) -> bool:
    """Whether forces or joints have breakpoints or laws (formulas, tables, Python functions), which may change within one step."""
    return any(group.has_law for group in system.groups if group.entries("f") or group.record.n_equations)
