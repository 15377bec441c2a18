"""The elements of one kind in a compiled model, and where the entries of their terms stand in the whole."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field

import numpy as np

from ..describe.element import Element
from .bodies import BodyKind
from .kind import Kind
from .record import KindRecord
from .terms import TERM_AXES


@dataclass(frozen=True)
class Group:
    """The elements of one kind.

    Attributes
    ----------
    names : tuple of str
        Element by element.
    elements : list of Element
        Those of these names; may be changed together with their numbers, as inputs are looked through by their formulas.
    of_body : BodyKind
        Coordinates and velocities of the bodies.
    index : ndarray of int, shape (count, 2 * bodies + 1 + joints + states + counters)
        Offsets of each body in q and u (the ground's are past the end), of the element's first number, of the
        first row of each joint that it refers to, and of its states and its counters of turns in q.
    numbers : ndarray
        Kernel parameters and tables, element after element; may be changed in place.
    first_row : int
        Of the first element's equations.
    count : int
        Number of elements.
    entries : mapping of str to int
        Number of entries that one element has in each term.
    bodies : ndarray of int, shape (count, bodies)
        Numbers of the bodies that each element acts on; the ground's is behind the last body's.
    states, counters : ndarrays of int, shapes (count, states), (count, counters)
        Numbers of the coordinates that are states of each element, and of those that count turns for it.
    has_inputs, has_functions : bool
        Whether the elements have formulas or tables, and whether they have Python functions.
    has_law : bool
        Whether they have breakpoints, formulas or tables.
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
        behind, end = self.first_behind, self.index.shape[1]
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
    def first_behind(self) -> int:
        """The first column of `index` that leads to coordinates behind those of the bodies."""
        return 2 * self.kind.n_bodies + 1 + self.kind.n_joints

    @property
    def keeps_energy(self) -> bool:
        """Whether none of the elements brings anything into kinetic + potential energy, wherever it moves."""
        if self.record.losses is None:
            return False
        first = self.index[:, 2 * self.kind.n_bodies]
        return not self.numbers[first[:, None] + np.array(self.record.losses, dtype=np.int64)[None, :]].any()

    def placed(self, term: str, first: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Source, row and column of a term's entries, element after element.

        Parameters
        ----------
        term : str
            One of `stiffmbs.compile.terms.TERM_AXES`.
        first : int
            Where the first of its values stands among those of its set.

        Returns
        -------
        ndarrays of int, shape (count * entries,)
            Places among the values, and rows and columns in the whole; those of the ground are past the end.
        """
        axes = TERM_AXES[term]
        pattern = np.array(self.record.patterns.get(term, ()), dtype=np.int64).reshape(-1, 2)
        elements = np.arange(self.count)[:, None]
        source = first + elements * len(pattern) + np.arange(len(pattern))[None, :]
        row = self._in_whole(axes[0], pattern[:, 0])
        column = self._in_whole(axes[1], pattern[:, 1]) if len(axes) > 1 else np.zeros_like(source)
        return source.ravel(), row.ravel(), column.ravel()

    def coordinates(self, own: np.ndarray) -> np.ndarray:
        """Numbers in the whole of the elements' own coordinates, shape (count, len(own)); those of the ground are past the end."""
        return self._of_bodies("q", own)

    def _in_whole(self, axis: str, own: np.ndarray) -> np.ndarray:
        """Numbers in the whole for the elements' own numbers, shape (count, entries)."""
        elements = np.arange(self.count)[:, None]
        match axis:
            case "c":
                return self.first_row + elements * self.record.n_equations + own[None, :]
            case "q" | "u":
                return self._of_bodies(axis, own)
            case "l":
                joint, offset = self._joint_of_column(own)
                return self.index[:, 2 * self.kind.n_bodies + 1 + joint] + offset[None, :]
            case _:
                return np.broadcast_to(own[None, :], (self.count, len(own)))

    def _of_bodies(self, axis: str, own: np.ndarray) -> np.ndarray:
        """For coordinates or velocities of the elements' bodies, behind which stand their states and counters of turns."""
        width = self.of_body.n_q if axis == "q" else self.of_body.n_u
        body, offset = own // width, own % width
        behind = own - width * self.kind.n_bodies
        first = self.index[:, np.where(behind < 0, 2 * body + (axis == "u"), self.first_behind + behind)]
        return first + np.where(behind < 0, offset, 0)

    def _joint_of_column(self, own: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """For columns that count the equations of all joints referred to: which joint, and which of its equations."""
        starts = np.cumsum([0, *self.record.joint_equations])
        joint = np.searchsorted(starts, own, side="right") - 1
        return joint, own - starts[joint]
