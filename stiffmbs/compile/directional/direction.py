"""Directions of change of state, time and parameters, and the directional derivatives of terms."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from ...errors import InputError
from ..kind import Kind, with_place
from ..machine.compiler import SOURCES, Description, compiled_source
from ..machine.layout import packed
from ..machine.linking import Compiled
from ..machine.native.tables import DIRECTION
from ..machine.routines import Routine
from ..record import source_of
from ..state import State
from ..system import System
from ..terms import TERM_AXES
from .source import NUMBER, SIGNATURE, STATE, directional_source

ALONG = Routine("stiffmbs.compile.machine.native.along", "along", "void(float64, float64, int64*, int64*)")
EVERYTHING = (NUMBER, *STATE)


@dataclass(frozen=True)
class Numbers:
    """Derivatives of a system's numbers with respect to a parameter.

    `of_groups`: for each group of elements the derivatives of its numbers. `moved`: groups with numbers that change.
    `mass` of shape (n_u,).
    """

    of_groups: tuple[np.ndarray, ...]
    moved: frozenset[int]
    mass: np.ndarray


def unchanged(system: System) -> Numbers:
    """Return a direction for derivatives with respect to state and time; no numbers are differentiated."""
    return Numbers(tuple(np.zeros_like(group.numbers) for group in system.groups), frozenset(), np.zeros(system.n_u))


@lru_cache(SOURCES)
def directional_kernel(kind: Kind, term_set: str, along: tuple[str, ...]) -> Compiled | None:
    """Return the kernel of a kind's directional derivatives in a set of terms; None if it has none.

    Raises InputError if an equation cannot be differentiated; names the kind.
    """
    source = source_of(kind, term_set)
    found = directional_source(source, along) if source else ""
    name = with_place(kind, "")
    try:
        return compiled_source(found, "kernel", SIGNATURE, Description(f"{name}, derivatives")) if found else None
    except InputError as error:
        raise InputError(f"{name}: {error}") from None


@dataclass
class Direction:
    """Direction for one set of terms.

    `state`: state at which the derivatives are taken. `numbers`: changes of the system's numbers. `along`: quantities
    that change: numbers alone, or the state and time too.

    - `q`, `u`, `a`, `lam`, `mu`: changes of the state.
    - `values`: derivatives of the terms' values, followed by those of the system's constants.
    - `table`: pointer table for compiled code (`stiffmbs.compile.machine.native.tables.DIRECTION`).
    - `writes`: groups whose values change.
    """

    state: State
    term_set: str
    numbers: Numbers
    along: Collection[str] = EVERYTHING
    writes: set[int] = field(init=False, default_factory=set)

    def __post_init__(self) -> None:
        self.state.load(self.term_set)
        system = self.state.system
        n_q, n_u = system.n_q + len(system.of_body.ground), system.n_u + system.of_body.n_u
        self._q, self._u, self._a = np.zeros(n_q), np.zeros(n_u), np.zeros(n_u)
        self._turn = np.zeros(system.of_body.turn_stride * n_q)
        self.q, self.u, self.a = self._q[: system.n_q], self._u[: system.n_u], self._a[: system.n_u]
        self.lam, self.mu = np.zeros(system.n_c), np.zeros(system.n_c)
        self.values = np.zeros(len(self.state.values[self.term_set]))
        self._terms = np.zeros_like(self.values)
        first = system.constants(self.term_set)["M"]
        self.values[first : first + system.n_u] = self.numbers.mass
        self._calls = self._made_calls(system)
        self._turned = system.turned(self.term_set) if self._whole else np.empty(0, dtype=np.int64)
        self.table = packed(
            DIRECTION,
            {
                "q": self._q, "turn": self._turn, "u": self._u, "a": self._a, "lam": self.lam, "mu": self.mu,
                "n_turned": len(self._turned), "turned": self._turned, "n_calls": len(self._calls), "calls": self._calls,
                "values": self.values, "terms": self._terms,
            },
        )  # fmt: skip

    @property
    def _whole(self) -> bool:
        """True if more than numbers change."""
        return set(self.along) != {NUMBER}

    def _made_calls(self, system: System) -> np.ndarray:
        calls = []
        for g, (group, numbers) in enumerate(zip(system.groups, self.numbers.of_groups, strict=True)):
            if g not in self.numbers.moved and not self._whole:
                continue
            kernel = directional_kernel(group.kind, self.term_set, tuple(self.along))
            if kernel is None:
                continue
            self.writes.add(g)
            place = system.places[self.term_set][g]
            calls.append((
                kernel.address, group.count, group.index.ctypes.data, group.numbers.ctypes.data, place.ctypes.data, numbers.ctypes.data,
            ))  # fmt: skip
        return np.array(calls, dtype=np.int64).reshape(-1, 6)

    def evaluate(self, t: float, t_d: float = 0.0) -> None:
        """Compute the terms and their derivatives at the current state."""
        self.state.evaluate(self.term_set, t)
        ALONG.call(t, t_d, self.state.table.ctypes.data, self.table.ctypes.data)

    def vector(self, name: str) -> np.ndarray:
        """Return the assembled derivative of a vector term."""
        term = self.state.system.term(self.term_set, name)
        result = np.zeros(self.state.system.extent(TERM_AXES[name]))
        np.add.at(result, term.row, self.values[term.source])
        return result

    def product(self, name: str, x: np.ndarray, transposed: bool = False) -> np.ndarray:
        """Return the derivative of a matrix term times a vector."""
        system = self.state.system
        term = system.term(self.term_set, name)
        row, column = (term.column, term.row) if transposed else (term.row, term.column)
        result = np.zeros(system.extent(TERM_AXES[name][1 if transposed else 0]))
        np.add.at(result, row, self.values[term.source] * x[column])
        return result
