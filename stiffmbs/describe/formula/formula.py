"""Checked formulas: what they use, and in which order."""

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
"""Under which a formula keeps what its tree uses."""


@dataclass(frozen=True)
class Used:
    """What a tree uses of a model, in reading order.

    Attributes
    ----------
    coordinates : tuple of (body, coordinate)
    measures : tuple of (function, markers)
    reactions : tuple of (component, joint)
    time : bool
        Whether it uses time.
    """

    coordinates: tuple[tuple[str, str], ...]
    measures: tuple[tuple[str, tuple[MarkerReference, ...]], ...]
    reactions: tuple[tuple[str, str], ...]
    time: bool


def used_by(tree: ast.expr) -> Used:
    """What a tree uses of a model.

    Raises
    ------
    FormulaError
        When a measure or a reaction has other arguments than markers, or a joint.
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
    """A checked formula.

    Attributes
    ----------
    text : str
        As written.
    tree : ast.expr
        Its syntax tree (`stiffmbs.describe.formula.text.parse`).
    variables : tuple of str
        Names that the field gives a meaning to (``s`` and ``v`` of a spring's law).
    values : dict of str to float
        The scene's parameters, units and constants that it uses, in SI units.
    velocities : bool
        Whether it may hold velocities.
    tables : mapping of str to Table
        The scene's tables that it calls as functions.
    dimension : Known
        Of its value.
    parameters : mapping of str to Quantity
        The scene's parameters among `values`, with their dimensions.
    among_variables : bool
        Whether the scene has variables, which stand in the tree in the places of their names.
    states : tuple of str
        The states of the model that it uses, by their full names.
    kept : dict
        What is worked out of the tree once, by what it is; shared with formulas that differ by values alone.
    """

    text: str
    tree: ast.expr
    variables: tuple[str, ...]
    values: dict[str, float]
    velocities: bool = False
    tables: Mapping[str, Table] = field(default_factory=dict)
    dimension: Known = UNKNOWN
    parameters: Mapping[str, Quantity] = field(default_factory=dict)
    among_variables: bool = False
    states: tuple[str, ...] = ()
    kept: dict[Any, Any] = field(default_factory=dict)

    def coordinates(self) -> Iterator[tuple[str, str]]:
        """The (body, coordinate) pairs that it uses, in reading order."""
        yield from self._used.coordinates

    def measures(self) -> Iterator[tuple[str, tuple[MarkerReference, ...]]]:
        """The measures that it uses with their markers, in reading order."""
        yield from self._used.measures

    def reactions(self) -> Iterator[tuple[str, str]]:
        """The components of reactions that it uses, with their joints, in reading order."""
        yield from self._used.reactions

    @property
    def expanded(self) -> str:
        """The text with the scene's variables in their places; empty where the scene has none."""
        return as_written(self.tree) if self.among_variables else ""

    @property
    def uses_time(self) -> bool:
        """Whether it uses time itself; the tables that it calls aside."""
        return self._used.time

    @property
    def _used(self) -> Used:
        if USED not in self.kept:
            self.kept[USED] = used_by(self.tree)
        used: Used = self.kept[USED]
        return used

    def bodies(self) -> Iterator[str]:
        """The bodies that it names, some more than once."""
        for body, _ in self.coordinates():
            yield body
        for _, markers in self.measures():
            yield from (marker.body for marker in markers)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Formula) and all(
            getattr(self, part) == getattr(other, part) for part in ("text", "values", "tables", "_told")
        )

    @property
    def _told(self) -> str:
        """What the tree says, with variables in their places."""
        return ast.unparse(self.tree)

    def __hash__(self) -> int:
        return hash(self.text)

    def __repr__(self) -> str:
        return f"Formula({self.text!r})"


def called_tables(tree: ast.expr, tables: Mapping[str, Table]) -> dict[str, Table]:
    """The tables that a formula calls, by name."""
    called = (node.func.id for node in reading_order(tree) if isinstance(node, ast.Call))  # type: ignore[attr-defined]
    return {name: tables[name] for name in called if name in tables}
