"""The compiled model: sizes, mass, and the terms of all elements with their places in the whole.

Solvers see a `System` and no element: the entries of each term, where they stand among the values that kernels
write, and which equation and coordinate each belongs to.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..describe.element import Element
from ..describe.formula import FormulaError
from ..describe.marker import GROUND
from ..describe.model import ModelData
from ..errors import InputError
from .kind import ElementData, Kind, sorted_out
from .machine import Compiled, compiled_source
from .record import KindRecord, record_of
from .terms import KERNEL_SIGNATURE, TERM_AXES, TERM_SETS

PLANAR = 3
"""Coordinates, and velocities, of a planar body."""


@dataclass(frozen=True)
class Group:
    """The elements of one kind.

    Attributes
    ----------
    names : tuple of str
        Element by element.
    index : ndarray of int, shape (count, 2 * bodies + 1 + joints)
        Offsets of each body in q and u (the ground's are past the end), of the element's first number, and of the
        first row of each joint that it refers to.
    numbers : ndarray
        Kernel parameters and tables, element after element; may be changed in place.
    first_row : int
        Of the first element's equations.
    """

    kind: Kind
    record: KindRecord
    names: tuple[str, ...]
    elements: tuple[Element, ...]
    index: np.ndarray
    numbers: np.ndarray
    first_row: int

    @property
    def count(self) -> int:
        """Number of elements."""
        return len(self.names)


@dataclass(frozen=True)
class Term:
    """Where the entries of a term stand: `source` in the values of its set, `row` and `column` in the whole.

    Entries that belong to the ground are left out.
    """

    source: np.ndarray
    row: np.ndarray
    column: np.ndarray


@dataclass(frozen=True)
class System:
    """A compiled model.

    Attributes
    ----------
    bodies : tuple of str
        In the order of their coordinates.
    q, u : ndarrays
        Coordinates (x, y, phi of each body; m, rad) and velocities at the start, as described.
    mass : ndarray, shape (n_u,)
        The diagonal of the mass matrix: m, m, I of each body.
    groups : tuple of Group
        Elements by kind.
    equations : tuple of (str, str)
        Joint and equation name of each constraint row.
    holonomic, active : ndarrays of bool, shape (n_c,)
        Which rows have a position form, and which are not redundant and so are solved for.
    size : float
        Of the mechanism at the start, m.
    """

    bodies: tuple[str, ...]
    q: np.ndarray
    u: np.ndarray
    mass: np.ndarray
    groups: tuple[Group, ...]
    equations: tuple[tuple[str, str], ...]
    holonomic: np.ndarray
    active: np.ndarray
    size: float

    @property
    def n_q(self) -> int:
        return len(self.q)

    @property
    def n_u(self) -> int:
        return len(self.u)

    @property
    def n_c(self) -> int:
        return len(self.equations)

    @cached_property
    def joint_start(self) -> np.ndarray:
        """The first row of each joint's equations, and the end of the last."""
        starts = [
            row for row, (joint, _) in enumerate(self.equations) if row == 0 or joint != self.equations[row - 1][0]
        ]
        return np.array([*starts, self.n_c], dtype=np.int64)

    @cached_property
    def places(self) -> dict[str, np.ndarray]:
        """For each term set and group: the first equation, then each term's first value."""
        return {term_set: self._places(term_set) for term_set in TERM_SETS}

    def _places(self, term_set: str) -> np.ndarray:
        terms = TERM_SETS[term_set]
        places = np.zeros((len(self.groups), 1 + len(terms)), dtype=np.int64)
        end = 0
        for k, term in enumerate(terms):
            for g, group in enumerate(self.groups):
                places[g, 0] = group.first_row
                places[g, 1 + k] = end
                end += group.count * len(group.record.patterns.get(term, ()))
        return places

    def n_values(self, term_set: str) -> int:
        """Number of values that the kernels of a set write; the constants stand behind them."""
        return sum(
            group.count * len(group.record.patterns.get(term, ()))
            for group in self.groups
            for term in TERM_SETS[term_set]
        )

    def values_of(self, values: np.ndarray, term_set: str, element: str) -> dict[str, np.ndarray]:
        """The values that one element wrote for each term of a set."""
        found = {}
        for g, group in enumerate(self.groups):
            if element in group.names:
                e = group.names.index(element)
                for k, term in enumerate(TERM_SETS[term_set]):
                    width = len(group.record.patterns.get(term, ()))
                    first = self.places[term_set][g, 1 + k] + e * width
                    found[term] = values[first : first + width]
        return found

    def term(self, term_set: str, name: str) -> Term:
        """The entries of a term in a set, those of the ground left out."""
        k = TERM_SETS[term_set].index(name)
        axes = TERM_AXES[name]
        parts = [
            self._group_entries(g, group, int(self.places[term_set][g, 1 + k]), name, axes)
            for g, group in enumerate(self.groups)
        ]
        nothing = np.empty(0, dtype=np.int64)  # of a scene without joints, forces and weight
        source, row, column = (np.concatenate([nothing, *(part[i] for part in parts)]) for i in range(3))
        inside = (row < self._extent(axes[0])) & (column < (self._extent(axes[1]) if len(axes) > 1 else 1))
        return Term(source[inside], row[inside], column[inside])

    def _extent(self, axis: str) -> int:
        return {"q": self.n_q, "u": self.n_u, "c": self.n_c, "l": self.n_c}.get(axis, np.iinfo(np.int64).max)

    def _group_entries(self, g: int, group: Group, first: int, name: str, axes: str) -> tuple[np.ndarray, ...]:
        pattern = np.array(group.record.patterns.get(name, ()), dtype=np.int64).reshape(-1, 2)
        elements = np.arange(group.count)[:, None]
        source = first + elements * len(pattern) + np.arange(len(pattern))[None, :]
        row = self._whole(group, axes[0], pattern[:, 0])
        column = self._whole(group, axes[1], pattern[:, 1]) if len(axes) > 1 else np.zeros_like(source)
        return source.ravel(), row.ravel(), column.ravel()

    def _whole(self, group: Group, axis: str, own: np.ndarray) -> np.ndarray:
        """Numbers in the whole for the elements' own numbers, shape (count, entries)."""
        elements = np.arange(group.count)[:, None]
        match axis:
            case "c":
                return group.first_row + elements * group.record.n_equations + own[None, :]
            case "q" | "u":
                body, offset = own // PLANAR, own % PLANAR
                return group.index[:, 2 * body + (axis == "u")] + offset[None, :]
            case "l":
                joint, offset = self._joint_of_column(group, own)
                return group.index[:, 2 * group.kind.n_bodies + 1 + joint] + offset[None, :]
            case _:
                return np.broadcast_to(own[None, :], (group.count, len(own)))

    @staticmethod
    def _joint_of_column(group: Group, own: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """For columns that count the equations of all joints referred to: which joint, and which of its equations."""
        starts = np.cumsum([0, *group.record.joint_equations])
        joint = np.searchsorted(starts, own, side="right") - 1
        return joint, own - starts[joint]

    def kernel(self, term_set: str, group: Group) -> Compiled | None:
        """The compiled kernel with which a group contributes to a set, if it does."""
        source = group.record.sources.get(term_set)
        return compiled_source(source, "kernel", KERNEL_SIGNATURE) if source else None

    def constants(self, term_set: str) -> dict[str, int]:
        """Where the constants stand that follow the values of a set: mass entries, relaxations, a one."""
        starts = np.cumsum([self.n_values(term_set), self.n_u, self.n_c, self.n_c])
        return {name: int(start) for name, start in zip(("M", "E_mu", "E_lam", "I"), starts, strict=True)}


def compile_model(model: ModelData) -> System:
    """Compile a model: kernels from the cache or newly made, and every term's place.

    Raises
    ------
    InputError
        When an element's equations cannot be compiled; names the element.
    """
    bodies = tuple(model.bodies)
    offset = {name: PLANAR * k for k, name in enumerate(bodies)} | {GROUND: PLANAR * len(bodies)}
    sorted_elements: dict[Kind, list[_Member]] = {}
    for name, element in model.elements():
        try:
            kind, data = sorted_out(element, model)
        except FormulaError as error:
            raise InputError(f"{name}: {error}") from None
        sorted_elements.setdefault(kind, []).append(_Member(name, element, data))
    records = {kind: _record(kind, members[0].name) for kind, members in sorted_elements.items()}
    rows, equations, holonomic = _rows(sorted_elements, records)
    groups = [
        _group(kind, records[kind], members, offset, rows, rows[members[0].name] if records[kind].n_equations else 0)
        for kind, members in sorted_elements.items()
    ]
    return System(
        bodies=bodies,
        q=np.array([c for body in model.bodies.values() for c in (*body.position, body.angle)]),
        u=np.array([c for body in model.bodies.values() for c in (*body.velocity, body.omega)]),
        mass=np.array([m for body in model.bodies.values() for m in (body.mass, body.mass, body.inertia)]),
        groups=tuple(groups),
        equations=tuple(equations),
        holonomic=np.array(holonomic, dtype=bool),
        active=np.ones(len(equations), dtype=bool),
        size=model.size(),
    )


@dataclass(frozen=True)
class _Member:
    name: str
    element: Element
    data: ElementData


def _record(kind: Kind, name: str) -> KindRecord:
    try:
        return record_of(kind)
    except InputError as error:
        raise InputError(f"{name}: {error}") from None


def _rows(
    sorted_elements: Mapping[Kind, list[_Member]], records: Mapping[Kind, KindRecord]
) -> tuple[dict[str, int], list[tuple[str, str]], list[bool]]:
    """The first row of each joint, and for each row its joint and equation and whether it has a position form."""
    first: dict[str, int] = {}
    equations: list[tuple[str, str]] = []
    holonomic: list[bool] = []
    for kind, members in sorted_elements.items():
        record = records[kind]
        for member in members if record.n_equations else ():
            first[member.name] = len(equations)
            equations += [(member.name, label) for label in member.element.equation_names()]
            holonomic += [k < record.n_holonomic for k in range(record.n_equations)]
    return first, equations, holonomic


def _group(
    kind: Kind, record: KindRecord, members: list[_Member], offset: dict[str, int], rows: dict[str, int], first_row: int
) -> Group:
    numbers = [member.data.flat() for member in members]
    starts = np.cumsum([0, *(len(own) for own in numbers)])
    index = [
        [
            *(offset[body] for body in member.data.bodies for _ in ("q", "u")),
            start,
            *(rows[j] for j in member.data.joints),
        ]
        for member, start in zip(members, starts, strict=False)
    ]
    return Group(
        kind, record, tuple(m.name for m in members), tuple(m.element for m in members),
        np.array(index, dtype=np.int64), np.concatenate([*numbers, [0.0]]), first_row,
    )  # fmt: skip
