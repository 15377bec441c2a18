"""Requests: formulas that are only reported, of everything that a run knows (Adams: REQUEST).

They are evaluated after the run, from its channels, so that none of them is compiled.  How they are read is in
`stiffmbs.describe.requests.output_field`, what they may name in `stiffmbs.describe.requests.names`.
"""

from __future__ import annotations

import ast
import copy
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from ..formula.nodes import TIME
from ..formula.text import UNIT
from ..marker import MarkerReference
from ..table import Table
from ..units.units import Quantity

CONTINUOUS_ANGLES = ("ax", "ay", "az")
"""The angles that count whole turns."""


@dataclass(frozen=True)
class Term:
    """A measure or an action in a formula.

    Attributes
    ----------
    function : str
        One of the measures or actions of `stiffmbs.describe.requests.names.OutputNames`.
    element : str
        Of an action: the joint or force.
    on_second : bool
        Whether what it does to its second body is meant.
    markers : tuple of MarkerReference
        Of a measure i and j, and the marker whose axes it is along, if any; of an action that marker alone, if any.
    """

    function: str
    element: str
    on_second: bool
    markers: tuple[MarkerReference, ...]

    def __str__(self) -> str:
        """As in a formula: ``az(bar.end, ground)``."""
        element = [f"{self.element}.j" if self.on_second else self.element] if self.element else []
        return f"{self.function}({', '.join([*element, *(marker.label for marker in self.markers)])})"


def placeholder(k: int) -> str:
    """The name in a formula's tree that stands for its k-th term: none that could be written, as it has a space in it."""
    return f"term {k}"


@dataclass(frozen=True, eq=False)
class Output:
    """A checked formula of a request.

    Attributes
    ----------
    text : str
        As written.
    tree : ast.expr
        Its tree with the names of `placeholder` in place of `terms`.
    terms : tuple of Term
    quantities : mapping of str to Quantity
        The scene's parameters, units and constants that it uses.
    tables : mapping of str to Table
        The scene's tables that it calls.
    parameters : mapping of str to Quantity
        The scene's parameters among `quantities`.
    expanded : str
        The text with the scene's variables in their places; empty where the scene has none.
    """

    text: str
    tree: ast.expr
    terms: tuple[Term, ...]
    quantities: Mapping[str, Quantity] = field(default_factory=dict)
    tables: Mapping[str, Table] = field(default_factory=dict)
    parameters: Mapping[str, Quantity] = field(default_factory=dict)
    expanded: str = ""

    def written_tree(self) -> ast.expr:
        """Its tree with the terms in their places."""
        terms = {placeholder(k): str(term) for k, term in enumerate(self.terms)}
        return _InPlace(terms).visit(copy.deepcopy(self.tree))  # type: ignore[no-any-return]

    def channels(self) -> Iterator[tuple[str, str]]:
        """The channels that it reads, as (owner, component); other requests without components as (owner, "")."""
        places = {placeholder(k) for k in range(len(self.terms))}
        owners = {id(node.value) for node in ast.walk(self.tree) if isinstance(node, ast.Attribute)}
        called = {id(node.func) for node in ast.walk(self.tree) if isinstance(node, ast.Call)}
        for node in ast.walk(self.tree):
            match node:
                case ast.Attribute(ast.Name(owner), name) if owner != UNIT:
                    yield owner, name
                case ast.Name(name) if id(node) not in owners | called and name not in (
                    TIME,
                    *self.quantities,
                    *places,
                ):
                    yield name, ""

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Output) and all(
            getattr(self, part) == getattr(other, part) for part in ("text", "quantities", "tables")
        )

    def __hash__(self) -> int:
        return hash(self.text)

    def __repr__(self) -> str:
        return f"Output({self.text!r})"


class _InPlace(ast.NodeTransformer):
    """Puts terms in the places of their names."""

    def __init__(self, terms: Mapping[str, str]) -> None:
        self._terms = terms

    def visit_Name(self, node: ast.Name) -> ast.expr:
        return ast.parse(self._terms[node.id], mode="eval").body if node.id in self._terms else node


def channel(owner: str, component: str) -> str:
    """The name of a channel."""
    return f"{owner}.{component}" if component else owner
