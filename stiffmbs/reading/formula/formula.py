"""Checked formulas and the quantities that they use."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from ..marker import MarkerReference
from ..table import Table
from ..units.units import Quantity
from .dimension import UNKNOWN, Known
from .nodes import TIME, is_measure, is_reaction, joint_of, measured_markers, reading_order
from .text import UNIT, as_written

USED = "used"
"""Key of the used quantities in `Formula.kept`."""


@dataclass(frozen=True)
class Used:
    """Model quantities used by a tree in reading order: (body, coordinate), (function, markers), (component, joint), and time."""

    coordinates: tuple[tuple[str, str], ...]
    measures: tuple[tuple[str, tuple[MarkerReference, ...]], ...]
    reactions: tuple[tuple[str, str], ...]
    time: bool


def used_by(tree: ast.expr) -> Used:
    """Return the model quantities used by a tree.

    Raise a FormulaError if the arguments of a measure are not markers, or the argument of a reaction is not one joint.
    """
    nodes = list(reading_order(tree))
    attributes = [node for node in nodes if isinstance(node, ast.Attribute)]
    return Used(
        tuple((x.value.id, x.attr) for x in attributes if isinstance(x.value, ast.Name) and x.value.id != UNIT),
        tuple((x.func.id, measured_markers(x)) for x in nodes if is_measure(x)),  # type: ignore[attr-defined]
        tuple((x.func.id, joint_of(x)) for x in nodes if is_reaction(x)),  # type: ignore[attr-defined]
        any(isinstance(x, ast.Name) and x.id == TIME for x in nodes),
    )


@dataclass(frozen=True, eq=False)
class Formula:
    """Checked formula."""

    text: str  # formula in the scene
    tree: ast.expr  # its syntax tree (`stiffmbs.reading.formula.text.parse`)
    variables: tuple[str, ...]  # names defined by the field (``s`` and ``v`` of a spring's law)
    values: dict[str, float]  # values of its parameters, units and constants, in SI units
    velocities: bool = False  # whether velocities are permitted
    tables: Mapping[str, Table] = field(default_factory=dict)  # tables of the scene that it calls as functions
    dimension: Known = UNKNOWN  # dimension of its value
    # parameters of the scene among `values`, with their dimensions
    parameters: Mapping[str, Quantity] = field(default_factory=dict)
    among_variables: bool = False  # whether the scene has variables, which are substituted in the tree
    states: tuple[str, ...] = ()  # full names of the states that it uses
    # cached results derived from the tree; shared with formulas that differ only in values
    kept: dict[Any, Any] = field(default_factory=dict)

    def coordinates(self) -> Iterator[tuple[str, str]]:
        """Yield the (body, coordinate) pairs that it uses, in reading order."""
        yield from self._used.coordinates

    def measures(self) -> Iterator[tuple[str, tuple[MarkerReference, ...]]]:
        """Yield the measures that it uses with their markers, in reading order."""
        yield from self._used.measures

    def reactions(self) -> Iterator[tuple[str, str]]:
        """Yield the components of reactions that it uses with their joints, in reading order."""
        yield from self._used.reactions

    @property
    def expanded(self) -> str:
        """Text with the scene's variables substituted; empty if the scene has none."""
        return as_written(self.tree) if self.among_variables else ""

    @property
    def uses_time(self) -> bool:
        """True if it uses time directly, not only in tables."""
        return self._used.time

    @property
    def _used(self) -> Used:
        if USED not in self.kept:
            self.kept[USED] = used_by(self.tree)
        used: Used = self.kept[USED]
        return used

    def bodies(self) -> Iterator[str]:
        """Yield the bodies that it names, possibly repeated."""
        for body, _ in self.coordinates():
            yield body
        for _, markers in self.measures():
            yield from (marker.body for marker in markers)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Formula) and all(
            getattr(self, part) == getattr(other, part) for part in ("text", "values", "tables", "_identity")
        )

    @property
    def _identity(self) -> str:
        return ast.unparse(self.tree)

    def __hash__(self) -> int:
        return hash(self.text)

    def __repr__(self) -> str:
        return f"Formula({self.text!r})"


def called_tables(tree: ast.expr, tables: Mapping[str, Table]) -> dict[str, Table]:
    """Return the tables that a formula calls, by name."""
    called = (node.func.id for node in reading_order(tree) if isinstance(node, ast.Call))  # type: ignore[attr-defined]
    return {name: tables[name] for name in called if name in tables}
