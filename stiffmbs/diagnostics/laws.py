"""Which scenes have laws whose features may begin and end within one step."""

from __future__ import annotations

from ..compile.group import Group
from ..compile.kind import Shape
from ..compile.system import System


def has_laws(system: System) -> bool:
    """Whether forces or joints have breakpoints or laws (formulas, tables), which may change within one step."""
    return any(has_law(group) for group in system.groups if group.entries("f") or group.record.n_equations)


def has_law(group: Group) -> bool:
    """Whether the elements of a group have breakpoints, formulas or tables."""
    return bool(group.entries("event_function")) or any(_is_law(shape) for _, shape in group.kind.fields)


def _is_law(shape: Shape) -> bool:
    return shape[0] in ("formula", "table") or (shape[0] == "several" and any(map(_is_law, shape[1])))
