"""What compiling asks of a model, and what distinguishes an element from others of its kind."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np

from ..describe.element import Element
from ..describe.formula.formula import Formula
from ..describe.marker import MarkerReference, PlacedMarkers
from ..describe.states.state import StateValue

Shape = tuple[Any, ...]
"""Which equations a field makes, without its numbers."""


class Compilable(Protocol):
    """What compiling asks of a model."""

    @property
    def bodies(self) -> Mapping[str, Any]: ...

    @property
    def dimensions(self) -> int:
        """2 for a planar model, 3 for one in space."""

    @property
    def joints(self) -> Mapping[str, Any]: ...

    def elements(self) -> Iterator[tuple[str, Element]]:
        """Every joint, force, counter of turns and weight with its name."""

    def state_outputs(self) -> Mapping[str, Formula]:
        """Formulas that others use by a name."""

    def state_values(self) -> Mapping[str, StateValue]:
        """The states of the user's own."""

    def carried(self, marker: Any) -> tuple[str, Any]:
        """The body that carries a marker, and where it sits on it."""

    def size(self) -> float:
        """Of the mechanism at the start, m."""

    def spin_axes(self) -> Mapping[str, str]:
        """The bodies whose quaternions don't follow their spin, and the principal axis of each, ``x``, ``y`` or ``z``."""


@dataclass
class ElementData:
    """What distinguishes an element from others of its kind.

    Attributes
    ----------
    places : PlacedMarkers
        Where markers sit.
    bodies : list of str
        By slot; the first is the one on which the reaction is reported.
    numbers : list of float
        Kernel parameters, in the order in which the kind's equations meet them.
    tables : list of (int, ndarray)
        Which of the numbers stands for a table, by its offset in `flat`, and the table's spline data.
    joints : list of str
        Joints whose multipliers the equations use.
    states : list of str
        By slot.
    """

    places: PlacedMarkers
    bodies: list[str] = field(default_factory=list)
    numbers: list[float] = field(default_factory=list)
    tables: list[tuple[int, np.ndarray]] = field(default_factory=list)
    joints: list[str] = field(default_factory=list)
    states: list[str] = field(default_factory=list)

    def slot(self, body: str) -> int:
        """The slot of a body, a new one where it is new."""
        if body not in self.bodies:
            self.bodies.append(body)
        return self.bodies.index(body)

    def state_slot(self, state: str) -> int:
        """The slot of a state, a new one where it is new."""
        if state not in self.states:
            self.states.append(state)
        return self.states.index(state)

    def flat(self) -> np.ndarray:
        """Numbers and tables in one row, each table's number being its offset from the start of the row."""
        numbers = np.array(self.numbers, dtype=float)
        end = len(numbers)
        parts = [numbers]
        for at, table in self.tables:
            numbers[at] = end
            parts.append(table)
            end += len(table)
        return np.concatenate(parts)

    def marker_shape(self, marker: MarkerReference) -> Shape:
        """The shape of a marker, whose place is appended to the numbers."""
        body, numbers = self.places[marker]
        self.numbers += numbers
        return ("marker", self.slot(body))
