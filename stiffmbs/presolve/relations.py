"""Linear relations between coordinates, accumulated from equations with constant coefficients."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from ..compile.coordinates import FIXED, Coordinates
from ..compile.group import Group
from ..compile.kind import Kind
from ..compile.record import RECORDS, record_of
from ..compile.state import State
from ..compile.system import System, Term
from ..compile.terms import TERM_SETS
from ..tuning import tuned


@dataclass(frozen=True)
class PresolveParameters:
    """Parameters of dependent coordinates, of bodies that spin, and of separate mechanisms.

    Source: tests/presolve.
    """

    negligible: float = 1e-13
    """Coefficient that counts as zero, relative to the largest of its row."""
    independent: float = 1e-6
    """Smallest singular value of independent rows, relative to the largest."""
    alike: float = 1e-12
    """Largest relative difference of the moments across an axis, offset of a marker from it in sizes, and tilt, of a body
    that may spin about the axis."""
    most_apart: int = 8
    """Largest number of mechanisms solved separately, as each has the cost of its own start and steps."""


PRESOLVE = tuned("presolve", PresolveParameters())


@dataclass
class Relations:
    """Relations found so far: leaders and ratios as in `Coordinates`, and the equations used."""

    independent_of: np.ndarray
    ratio: np.ndarray
    satisfied: np.ndarray
    held: list[int] = field(default_factory=list)
    """Bodies with constant orientation."""

    @classmethod
    def none(cls, system: System) -> Relations:
        """Return no relations: all coordinates are independent."""
        return cls(np.arange(system.n_q), np.ones(system.n_q), np.zeros(system.n_c, dtype=bool))

    def coordinates(self, system: System) -> Coordinates:
        """Return the coordinates, with velocities related as the coordinates of which they are the rates."""
        q, u = system.straight
        of_q = np.full(system.n_q, FIXED)
        of_q[q] = u
        independent_of, ratio = np.arange(system.n_u), np.ones(system.n_u)
        led = self.independent_of[q]
        independent_of[u], ratio[u] = np.where(led == FIXED, FIXED, of_q[led]), self.ratio[q]
        for body in self.held:
            turning = slice(system.of_body.n_u * body + system.of_body.linear, system.of_body.n_u * (body + 1))
            independent_of[turning], ratio[turning] = FIXED, 0.0
        return Coordinates(self.independent_of, self.ratio, independent_of, ratio, self.satisfied)

    def extended(self, rows: dict[int, list[tuple[int, float]]]) -> bool:
        """Use rows with one or two leaders, else a set with common leaders; return True if there was any."""
        used = False
        for row, entries in rows.items():
            coefficients = self._by_independent(entries)
            match sorted(coefficients, key=lambda independent_of: abs(coefficients[independent_of])):
                case [only]:
                    self._follow(only, FIXED, 0.0)
                case [other, larger]:
                    self._follow(larger, other, -coefficients[other] / coefficients[larger])
                case _:
                    continue
            self.satisfied[row] = used = True
        return used or self._tied(rows)

    def _tied(self, rows: dict[int, list[tuple[int, float]]]) -> bool:
        """Use rows with common leaders, as many as leaders or one less; return True if there was any."""
        alike: dict[frozenset[int], dict[int, dict[int, float]]] = {}
        for row, entries in rows.items():
            coefficients = self._by_independent(entries)
            alike.setdefault(frozenset(coefficients), {})[row] = coefficients
        for independents, same in alike.items():
            order, free = sorted(independents), len(independents) - len(same)
            if not order or free not in (0, 1):
                continue
            _, values, axes = np.linalg.svd(
                np.array([[part[independent_of] for independent_of in order] for part in same.values()])
            )
            if values[-1] > PRESOLVE.independent * values[0]:
                self._move_along(order, free * axes[-1])
                self.satisfied[list(same)] = True
                return True
        return False

    def _move_along(self, independents: list[int], direction: np.ndarray) -> None:
        """Let leaders follow the one with the largest component of a direction; fix those with a zero component."""
        chief = int(np.argmax(np.abs(direction)))
        for independent_of, part in zip(independents, direction.tolist(), strict=True):
            if abs(part) <= PRESOLVE.negligible:
                self._follow(independent_of, FIXED, 0.0)
            elif independent_of != independents[chief]:
                self._follow(independent_of, independents[chief], part / direction[chief])

    def turned(self, bodies: Iterable[tuple[int, list[int]]], system: System) -> bool:
        """Fix orientations that some rows determine; return True if there was any."""
        used = False
        for body, rows in bodies:
            orientation = slice(system.of_body.n_q * body + system.of_body.linear, system.of_body.n_q * (body + 1))
            self.independent_of[orientation], self.ratio[orientation] = FIXED, 0.0
            self.satisfied[rows] = used = True
            self.held.append(body)
        return used

    def _by_independent(self, entries: list[tuple[int, float]]) -> dict[int, float]:
        """Return the coefficients of a row by the leaders of its coordinates."""
        coefficients: dict[int, float] = {}
        for column, value in entries:
            independent_of = int(self.independent_of[column])
            if independent_of != FIXED:
                coefficients[independent_of] = coefficients.get(independent_of, 0.0) + value * self.ratio[column]
        negligible = PRESOLVE.negligible * max(abs(value) for _, value in entries)
        return {independent_of: value for independent_of, value in coefficients.items() if abs(value) > negligible}

    def _follow(self, follower: int, independent_of: int, ratio: float) -> None:
        """Let a leader and its followers follow another leader, or fix them."""
        followers = self.independent_of == follower
        self.independent_of[followers] = independent_of
        self.ratio[followers] *= ratio


class Dependence(NamedTuple):
    """Entries of C_q that are not identically zero, without those of the ground.

    `row`, `column` of shape (n,). `value` of shape (n,): at the current pose. `entry`, `on` of shape (k,): pairs of an
    entry and a coordinate on which it depends, with repetitions.
    """

    row: np.ndarray
    column: np.ndarray
    value: np.ndarray
    entry: np.ndarray
    on: np.ndarray

    def varies(self, moves: np.ndarray) -> np.ndarray:
        """Return a mask of the entries that change when some coordinates (shape (n_q,)) move."""
        changing = np.zeros(len(self.row), dtype=bool)
        changing[self.entry[moves[self.on]]] = True
        return changing


def dependence(system: System, term: Term, values: np.ndarray) -> Dependence:
    """Return the symbolic dependence of the entries of C_q on coordinates.

    Summands with zero numbers are omitted. So are bounded ones that are rounding relative to the largest entry of the
    row, such as the arm of a pin at the centre of mass. `term`: C_q in the set ``position``. `values`: of that set at
    a pose.
    """
    rounding = np.zeros(system.n_c)
    np.fmax.at(rounding, term.row, PRESOLVE.negligible * np.abs(values[term.source]))
    joints = [(g, group) for g, group in enumerate(system.groups) if group.record.variation]
    found = [_of_group(system, g, group, values, rounding) for g, group in joints]
    first = np.cumsum([0, *(len(part.row) for part in found)])
    nothing = np.empty(0, dtype=np.int64)
    row, column, value, on = (
        np.concatenate([nothing, *(getattr(part, name) for part in found)]) for name in ("row", "column", "value", "on")
    )
    entry = np.concatenate([nothing, *(before + part.entry for before, part in zip(first[:-1], found, strict=True))])
    return Dependence(row, column, value, entry, on)


def curved(system: System, group: Group) -> np.ndarray:
    """Return a mask of equations with unbounded derivatives, shape (elements, equations)."""
    of_kind = _summands(group.kind)
    row, column = np.array(group.record.patterns["C_q"], dtype=np.int64).reshape(-1, 2).T
    entry = of_kind.entry[of_kind.of]
    changes = (_sizes(group, of_kind)[:, of_kind.product] > 0.0)[:, of_kind.of] & ~of_kind.bounded[of_kind.of]
    changes &= (group.coordinates(column[entry]) < system.n_q) & (group.coordinates(of_kind.on) < system.n_q)
    element, pair = np.nonzero(changes)
    found = np.zeros((group.count, group.record.n_equations), dtype=bool)
    found[element, row[entry[pair]]] = True
    return found


class _Summands(NamedTuple):
    """Summands of all entries of a kind, concatenated.

    - `numbers`: of all distinct products, concatenated; -1 for a product without factors.
    - `factors`, `products`: start of each factor, a sum of numbers, in `numbers`, and of each product in `factors`.
    - `product`, `entry` of shape (n,): of each summand.
    - `bounded` of shape (n,).
    - `of`, `on`: pairs of a summand and a coordinate of the element on which it depends.
    """

    numbers: np.ndarray
    factors: np.ndarray
    products: np.ndarray
    product: np.ndarray
    entry: np.ndarray
    bounded: np.ndarray
    of: np.ndarray
    on: np.ndarray


@lru_cache(RECORDS)
def _summands(kind: Kind) -> _Summands:
    listed = [(k, *summand) for k, summands in enumerate(record_of(kind).variation) for summand in summands]
    products = list(dict.fromkeys(tuple(map(tuple, factors)) or ((-1,),) for _, factors, _, _ in listed))
    place = {product: k for k, product in enumerate(products)}
    pairs = [(s, column) for s, (_, _, columns, _) in enumerate(listed) for column in columns]
    of, on = np.array(pairs, dtype=np.int64).reshape(-1, 2).T
    return _Summands(
        np.array([number for product in products for factor in product for number in factor], dtype=np.int64),
        _starts([len(factor) for product in products for factor in product]), _starts([len(product) for product in products]),
        np.array([place[tuple(map(tuple, factors)) or ((-1,),)] for _, factors, _, _ in listed], dtype=np.int64),
        np.array([k for k, _, _, _ in listed], dtype=np.int64),
        np.array([bounded for _, _, _, bounded in listed], dtype=bool), of, on,
    )  # fmt: skip


def _starts(lengths: list[int]) -> np.ndarray:
    return np.cumsum([0, *lengths[:-1]]) if lengths else np.empty(0, dtype=np.int64)


def _of_group(system: System, g: int, group: Group, values: np.ndarray, rounding: np.ndarray) -> Dependence:
    width, of_kind = group.entries["C_q"], _summands(group.kind)
    first = int(system.places["position"][g, 1 + TERM_SETS["position"].index("C_q")])
    placed, coordinates = group.placed("C_q", first), group.coordinates(of_kind.on)
    source, row, column = (part.reshape(group.count, width) for part in placed)
    least = np.where(of_kind.bounded, rounding[row[:, of_kind.entry]], 0.0)
    counts = (_sizes(group, of_kind)[:, of_kind.product] > least) & (column < system.n_q)[:, of_kind.entry]
    present = np.zeros((group.count, width), dtype=bool)
    element, summand = np.nonzero(counts)
    present[element, of_kind.entry[summand]] = True
    number = np.cumsum(present.ravel()).reshape(present.shape) - 1
    element, pair = np.nonzero(counts[:, of_kind.of])
    entry = number[element, of_kind.entry[of_kind.of[pair]]]
    on = coordinates[element, pair]
    inside = on < system.n_q
    return Dependence(row[present], column[present], values[source[present]], entry[inside], on[inside])


def _sizes(group: Group, of_kind: _Summands) -> np.ndarray:
    """Return the magnitudes of the products, shape (elements, products), with sums of magnitudes as factors."""
    if not len(of_kind.products):
        return np.empty((group.count, 0))
    first = group.index[:, 2 * group.kind.n_bodies, None]
    sizes = np.where(of_kind.numbers < 0, 1.0, np.abs(group.numbers[first + np.maximum(of_kind.numbers, 0)]))
    factors = np.add.reduceat(sizes, of_kind.factors, axis=1)
    products: np.ndarray = np.multiply.reduceat(factors, of_kind.products, axis=1)
    return products


def independent_coordinates(system: System, state: State, t: float) -> Coordinates:
    """Return the coordinates that remain after elimination by equations with constant coefficients.

    `state`: at a pose that satisfies the constraints; it is not changed. `t`: s.
    """
    found = Relations.none(system)
    candidates = _candidates(system)
    if not candidates.any():
        return found.coordinates(system)
    state.evaluate("position", t)
    C_q = dependence(system, system.term("position", "C_q"), state.values["position"])
    while True:
        moves = found.independent_of != FIXED
        open_rows = candidates & ~found.satisfied
        straight = found.extended(_constant_rows(C_q, moves, open_rows, system))
        if not (found.turned(_held_orientations(C_q, moves, open_rows, system), system) or straight):
            return found.coordinates(system)


def _candidates(system: System) -> np.ndarray:
    """Return a mask of removable rows: active, holonomic, without time or breakpoints, and not needed by friction.

    Multipliers on which forces or states depend are needed.
    """
    rows = system.active & system.holonomic
    for group in system.groups:
        of_group = np.zeros(group.record.n_equations, dtype=bool)
        of_group[: group.record.n_holonomic] = group.record.removable
        last = group.first_row + group.count * len(of_group)
        rows[group.first_row : last] &= np.tile(of_group, group.count)
    if system.forces_by_reactions:
        rows[system.term("tangent", "f_lam").column] = False
    if system.states:
        rows[system.term("tangent", "rate_lam").column] = False
    return rows


def _constant_rows(
    C_q: Dependence, moves: np.ndarray, open_rows: np.ndarray, system: System
) -> dict[int, list[tuple[int, float]]]:
    """Return the rows with constant derivatives by all moving coordinates, as columns and constants by row.

    They contain no quaternions.
    """
    straight, _ = system.straight
    counts = moves[C_q.column]
    included = open_rows.copy()
    included[C_q.row[counts & (C_q.varies(moves) | ~np.isin(C_q.column, straight))]] = False
    largest = np.zeros(system.n_c)
    np.fmax.at(largest, C_q.row, np.abs(C_q.value))
    kept = counts & included[C_q.row] & (np.abs(C_q.value) > PRESOLVE.negligible * largest[C_q.row])
    rows: dict[int, list[tuple[int, float]]] = {}
    for row, column, value in zip(
        C_q.row[kept].tolist(), C_q.column[kept].tolist(), C_q.value[kept].tolist(), strict=True
    ):
        rows.setdefault(row, []).append((column, value))
    return rows


def _held_orientations(
    C_q: Dependence, moves: np.ndarray, open_rows: np.ndarray, system: System
) -> Iterator[tuple[int, list[int]]]:
    """Yield bodies whose orientation three rows fix, with these rows, which depend on no other moving coordinate.

    If such rows are independent, the orientation that satisfies them is isolated.
    """
    of_body = system.of_body
    if of_body.n_q == of_body.n_u:
        return
    counts = moves[C_q.column] & open_rows[C_q.row]
    row, column, derivative = C_q.row[counts], C_q.column[counts], C_q.value[counts]
    body, place = column // of_body.n_q, column % of_body.n_q
    least, most = np.full(system.n_c, len(system.bodies)), np.full(system.n_c, -1)
    np.minimum.at(least, row, np.where(place < of_body.linear, -1, body))
    np.maximum.at(most, row, body)
    for held in sorted({*most[least == most].tolist()}):
        rows = np.flatnonzero((most == held) & (least == held))
        inside = np.isin(row, rows)
        C_q_held = np.zeros((len(rows), of_body.n_q))
        np.add.at(C_q_held, (np.searchsorted(rows, row[inside]), place[inside]), derivative[inside])
        if (
            len(rows) == 3
            and np.linalg.svd(C_q_held, compute_uv=False)[-1] > PRESOLVE.independent * np.abs(C_q_held).max()
        ):
            yield held, rows.tolist()
