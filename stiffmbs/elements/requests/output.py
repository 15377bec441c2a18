"""Requests: formulas that are only reported (Adams: REQUEST).

They are evaluated after the run, from its channels, so they are not compiled. `stiffmbs.elements.requests.output_field`
reads them; `stiffmbs.elements.requests.names` contains the available names.
"""

from __future__ import annotations

import ast
import copy
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from ...reading.formula.nodes import TIME
from ...reading.formula.text import UNIT
from ...reading.marker import MarkerReference
from ...reading.table import Table
from ...reading.units.units import Quantity

CONTINUOUS_ANGLES = ("ax", "ay", "az")
"""Angles with full revolutions."""


@dataclass(frozen=True)
class Term:
    """Measure or action in a formula."""

    function: str  # measure or action of `stiffmbs.elements.requests.names.OutputNames`
    element: str  # joint or force of an action
    on_second: bool  # True for the action on the second body
    # for a measure i and j, and optionally the marker of the axes; for an action at most the latter
    markers: tuple[MarkerReference, ...]

    def __str__(self) -> str:
        """Return the term as in a formula: ``az(bar.end, ground)``."""
        element = [f"{self.element}.j" if self.on_second else self.element] if self.element else []
        return f"{self.function}({', '.join([*element, *(marker.label for marker in self.markers)])})"


def placeholder(k: int) -> str:
    """Return the name of the k-th term in a formula's tree; its space prevents conflicts with names in scenes."""
    return f"term {k}"


@dataclass(frozen=True, eq=False)
class Output:
    """Checked formula of a request."""

    text: str  # formula in the scene
    tree: ast.expr  # its tree, with the names of `placeholder` in place of `terms`
    terms: tuple[Term, ...]
    quantities: Mapping[str, Quantity] = field(default_factory=dict)  # parameters, units and constants that it uses
    tables: Mapping[str, Table] = field(default_factory=dict)  # tables of the scene that it calls
    parameters: Mapping[str, Quantity] = field(default_factory=dict)  # parameters of the scene among `quantities`
    expanded: str = ""  # text with the scene's variables substituted; empty if the scene has none

    def written_tree(self) -> ast.expr:
        """Return its tree with the placeholders replaced by the terms."""
        terms = {placeholder(k): str(term) for k, term in enumerate(self.terms)}
        return _InPlace(terms).visit(copy.deepcopy(self.tree))  # type: ignore[no-any-return]

    def channels(self) -> Iterator[tuple[str, str]]:
        """Yield the channels that it reads, as (owner, component); requests without components as (owner, "")."""
        known = {TIME, *self.quantities, *(placeholder(k) for k in range(len(self.terms)))}
        nodes = list(ast.walk(self.tree))
        passed = {id(node.value) for node in nodes if isinstance(node, ast.Attribute)}
        passed |= {id(node.func) for node in nodes if isinstance(node, ast.Call)}
        for node in nodes:
            match node:
                case ast.Attribute(ast.Name(owner), name) if owner != UNIT:
                    yield owner, name
                case ast.Name(name) if id(node) not in passed and name not in known:
                    yield name, ""

    def __eq__(self, other: object) -> bool:
        parts = ("text", "quantities", "tables")
        return isinstance(other, Output) and all(getattr(self, part) == getattr(other, part) for part in parts)

    def __hash__(self) -> int:
        return hash(self.text)

    def __repr__(self) -> str:
        return f"Output({self.text!r})"


class _InPlace(ast.NodeTransformer):
    def __init__(self, terms: Mapping[str, str]) -> None:
        self._terms = terms

    def visit_Name(self, node: ast.Name) -> ast.expr:
        return ast.parse(self._terms[node.id], mode="eval").body if node.id in self._terms else node


def channel(owner: str, component: str) -> str:
    """Return the name of a channel."""
    return f"{owner}.{component}" if component else owner
