"""Elements of one kind in a compiled model, and the positions of their term entries in the system."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field

import numpy as np

from ..elements.element import Element
from .bodies import BodyKind
from .kind import Kind
from .record import KindRecord
from .terms import TERM_AXES


@dataclass(frozen=True, eq=False)
class Group:
    """Elements of one kind.

    - `names`: names of the elements.
    - `elements`: elements in that order; may be replaced together with their numbers, as inputs are found through
      their formulas.
    - `of_body`: coordinates and velocities of the bodies.
    - `index` of shape (count, 2 * bodies + 1 + joints + states + counters): offsets of each body in q and u (past the
      end for the ground) and of the element's first number. First row of each joint that it refers to. Offsets of its
      states and turn counters in q.
    - `numbers`: kernel parameters and tables by element; may be changed in place.
    - `first_row`: first row of the first element's equations.
    - `count`: number of elements.
    - `entries`: number of entries of one element in each term.
    - `bodies` of shape (count, bodies): indices of the bodies that each element acts on; the ground's follows the last
      body's.
    - `states`, `counters` of shapes (count, states), (count, counters): indices in q of each element's states and turn
      counters.
    - `has_inputs`, `has_functions`: true if the elements have formulas or tables, or Python functions.
    - `has_law`: true if they have breakpoints, formulas, tables or Python functions.
    """

    kind: Kind
    record: KindRecord
    of_body: BodyKind
    names: tuple[str, ...]
    elements: list[Element]
    index: np.ndarray
    numbers: np.ndarray
    first_row: int
    count: int = field(init=False)
    entries: defaultdict[str, int] = field(init=False)
    bodies: np.ndarray = field(init=False)
    states: np.ndarray = field(init=False)
    counters: np.ndarray = field(init=False)
    has_inputs: bool = field(init=False)
    has_functions: bool = field(init=False)
    has_law: bool = field(init=False)

    def __post_init__(self) -> None:
        behind, end = self.first_trailing, self.index.shape[1]
        has_inputs = self.kind.holds("formula", "table")
        vars(self).update(
            count=len(self.names),
            entries=self.record.entries,
            bodies=self.index[:, 1 : 2 * self.kind.n_bodies : 2] // self.of_body.n_u,
            states=self.index[:, behind : behind + self.kind.n_states],
            counters=self.index[:, end - self.record.n_counters :],
            has_inputs=has_inputs,
            has_functions=self.kind.holds("python"),
            has_law=bool(self.record.entries["event_function"]) or self.kind.holds("formula", "table", "python"),
        )

    @property
    def first_trailing(self) -> int:
        """First column of `index` for coordinates after those of the bodies."""
        return 2 * self.kind.n_bodies + 1 + self.kind.n_joints

    @property
    def keeps_energy(self) -> bool:
        """True if no element changes kinetic + potential energy."""
        if self.record.losses is None:
            return False
        first = self.index[:, 2 * self.kind.n_bodies]
        return not self.numbers[first[:, None] + np.array(self.record.losses, dtype=np.int64)[None, :]].any()

    def placed(self, term: str, first: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return source, row and column of a term's entries by element.

        `term`: one of `stiffmbs.compile.terms.TERM_AXES`. `first`: position of its first value among those of its set.
        The result of shape (count * entries,): positions among the values, and system rows and columns; those of the
        ground are past the end.
        """
        axes = TERM_AXES[term]
        pattern = np.array(self.record.patterns.get(term, ()), dtype=np.int64).reshape(-1, 2)
        elements = np.arange(self.count)[:, None]
        source = first + elements * len(pattern) + np.arange(len(pattern))[None, :]
        row = self._in_whole(axes[0], pattern[:, 0])
        column = self._in_whole(axes[1], pattern[:, 1]) if len(axes) > 1 else np.zeros_like(source)
        return source.ravel(), row.ravel(), column.ravel()

    def coordinates(self, own: np.ndarray) -> np.ndarray:
        """Return the system indices of the elements' coordinates, shape (count, len(own)); ground indices are past the
        end."""
        return self._of_bodies("q", own)

    def _in_whole(self, axis: str, own: np.ndarray) -> np.ndarray:
        """Return the system indices for the elements' own indices, shape (count, entries)."""
        elements = np.arange(self.count)[:, None]
        match axis:
            case "c":
                return self.first_row + elements * self.record.n_equations + own[None, :]
            case "q" | "u":
                return self._of_bodies(axis, own)
            case "l":
                starts = np.cumsum([0, *self.record.joint_equations])
                joint = np.searchsorted(starts, own, side="right") - 1
                return self.index[:, 2 * self.kind.n_bodies + 1 + joint] + (own - starts[joint])[None, :]
            case _:
                return np.broadcast_to(own[None, :], (self.count, len(own)))

    def _of_bodies(self, axis: str, own: np.ndarray) -> np.ndarray:
        """Return the system indices of body coordinates or velocities, followed by states and turn counters."""
        width = self.of_body.n_q if axis == "q" else self.of_body.n_u
        body, offset = own // width, own % width
        behind = own - width * self.kind.n_bodies
        first = self.index[:, np.where(behind < 0, 2 * body + (axis == "u"), self.first_trailing + behind)]
        return first + np.where(behind < 0, offset, 0)
