"""Entries of C_q of a system, and the coordinates on which each depends."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np

from ..compile.group import Group
from ..compile.kind import Kind
from ..compile.record import record_of
from ..compile.system import System, Term
from ..compile.terms import TERM_SETS
from .relations import NEGLIGIBLE


class Dependence(NamedTuple):
    """Entries of C_q that are not identically zero, without those of the ground.

    Attributes
    ----------
    row, column : ndarrays of int, shape (n,)
    value : ndarray, shape (n,)
        At the current pose.
    entry, on : ndarrays of int, shape (k,)
        Pairs of an entry and a coordinate on which it depends, with repetitions.
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
    row, such as the arm of a pin at the centre of mass.

    Parameters
    ----------
    term : Term
        C_q in the set ``position``.
    values : ndarray
        Of that set at a pose.
    """
    rounding = np.zeros(system.n_c)
    np.fmax.at(rounding, term.row, NEGLIGIBLE * np.abs(values[term.source]))
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

    Attributes
    ----------
    numbers : ndarray of int
        Of all distinct products, concatenated; -1 for a product without factors.
    factors, products : ndarrays of int
        Start of each factor, a sum of numbers, in `numbers`, and of each product in `factors`.
    product, entry : ndarrays of int, shape (n,)
        Of each summand.
    bounded : ndarray of bool, shape (n,)
    of, on : ndarrays of int
        Pairs of a summand and a coordinate of the element on which it depends.
    """

    numbers: np.ndarray
    factors: np.ndarray
    products: np.ndarray
    product: np.ndarray
    entry: np.ndarray
    bounded: np.ndarray
    of: np.ndarray
    on: np.ndarray


@cache
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
