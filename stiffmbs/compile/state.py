"""Working memory of one solver on one system."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager

import numpy as np

from .machine.layout import FLOATS, INTS, Layout, Table, address, packed
from .machine.native.tables import CALL, STATE
from .machine.routines import TERMS
from .system import System
from .terms import TERM_AXES, TERM_SETS

SETS = list(TERM_SETS)
LISTS_BY_SET, VALUES_BY_SET = (Layout(dict.fromkeys(SETS, kind)) for kind in (INTS, FLOATS))
"""Addresses by term set: of lists and tables, and of values."""
LEFT_OPEN = 1e-5
"""Tolerance of redundant equations, which are left out: input data have a limited number of digits. In rad and m;
relative to the size of mechanisms smaller than 1 m."""


class State:
    """Current coordinates, velocities and multipliers of a system, and the values of its terms.

    - `q`, `u`, `a`, `lam`, `mu`: kernel inputs, shapes (n_q,), (n_u,), (n_u,), (n_c,), (n_c,).
    - `relaxations` of shape (2 * n_c,): relaxations of each constraint row, for mu and then lam, set by `relax`.
    - `values`: kernel values of each loaded term set, followed by the system's constants.
    - `table`: addresses for compiled code (`stiffmbs.compile.machine.native.tables.STATE`).
    """

    def __init__(self, system: System) -> None:
        self.system = system
        of_body = system.of_body
        self._q = np.concatenate([system.q, of_body.ground])
        self._u = np.concatenate([system.u, np.zeros(of_body.n_u)])
        self._a = np.zeros(system.n_u + of_body.n_u)
        self._turn = np.concatenate([np.zeros(of_body.turn_stride * system.n_q), of_body.ground_turn])
        self.q, self.u, self.a = self._q[: system.n_q], self._u[: system.n_u], self._a[: system.n_u]
        self.lam, self.mu = np.zeros(system.n_c), np.zeros(system.n_c)
        self.values: dict[str, np.ndarray] = {}
        self._calls: dict[str, Table] = {}
        self._turned: dict[str, np.ndarray] = {}
        self._n_calls, self._n_turned = (np.zeros(len(SETS), dtype=np.int64) for _ in range(2))
        self._calls_at, self._turned_at, self._values_at = (
            Table(LISTS_BY_SET),
            Table(LISTS_BY_SET),
            Table(VALUES_BY_SET),
        )
        self.relaxations = np.zeros(2 * system.n_c)
        self._followed = np.ascontiguousarray(system.followed)
        self._left_open = np.where(system.active, 0.0, LEFT_OPEN * min(1.0, system.size))
        self._evaluated = np.zeros(1, dtype=np.int64)
        self.table = self._packed(self._n_calls, self._calls_at)
        self._evaluate, self._at = TERMS.short_call, address(self.table)

    def _packed(self, n_calls: np.ndarray, calls_at: Table) -> Table:
        system = self.system
        return packed(
            STATE,
            {
                "n_q": system.n_q, "n_pose": system.n_pose, "n_u": system.n_u, "n_c": system.n_c, "spatial": system.of_body.dimensions == 3,
                "q": self._q, "turn": self._turn, "n_turned": self._n_turned, "turned": self._turned_at, "u": self._u, "a": self._a, "lam": self.lam, "mu": self.mu,
                "n_calls": n_calls, "calls": calls_at, "values": self._values_at,
                "n_joints": len(system.joint_start) - 1, "joint_start": system.joint_start, "left_open": self._left_open,
                "followed": self._followed, "evaluated": self._evaluated,
            },
        )  # fmt: skip

    @property
    def evaluations(self) -> int:
        """Number of evaluated term sets, including those by compiled code: a machine-independent measure of work."""
        return int(self._evaluated[0])

    def restricted(self, used: Mapping[str, np.ndarray]) -> Table:
        """Return a table of the same state in which term sets omit groups whose values are unused.

        `used`: masks of the groups to keep for each of these term sets, which must be loaded.
        """
        n_calls, calls_at = self._n_calls.copy(), self._calls_at.same()
        for term_set, groups in used.items():
            called = [self.system.kernel(term_set, group) is not None for group in self.system.groups]
            chosen = np.flatnonzero(groups[called])
            n_calls[SETS.index(term_set)] = len(chosen)
            calls_at.link(term_set, self._calls[term_set].rows(chosen))
        return self._packed(n_calls, calls_at)

    def load(self, term_set: str) -> None:
        """Load a term set for compiled code: its kernels, and memory for its values."""
        if term_set in self.values:
            return
        system, k = self.system, SETS.index(term_set)
        called = [
            (kernel, g)
            for g, group in enumerate(system.groups)
            if (kernel := system.kernel(term_set, group, f"{g + 1} of {len(system.groups)} kinds, {term_set}"))
            is not None
        ]
        calls = Table(CALL, len(called))
        for row, (kernel, g) in enumerate(called):
            group = system.groups[g]
            calls.put_row(
                row,
                {"kernel": kernel, "count": group.count, "index": group.index, "number": group.numbers, "place": system.places[term_set][g]},
            )  # fmt: skip
        turned = system.turned(term_set)
        self._n_turned[k] = len(turned)
        self._turned_at.link(term_set, turned)
        self._calls[term_set] = calls
        empty = np.zeros(system.n_values(term_set))
        self.values[term_set] = np.concatenate([empty, system.mass, self.relaxations, [1.0]])
        self._n_calls[k] = len(called)
        self._calls_at.link(term_set, calls)
        self._values_at.link(term_set, self.values[term_set])

    def relax(self, mu: np.ndarray, lam: np.ndarray) -> None:
        """Set the relaxation of each constraint row, for formulations that use it."""
        self.relaxations[: len(mu)], self.relaxations[len(mu) :] = mu, lam
        for term_set, values in self.values.items():
            first = self.system.constants(term_set)["E_mu"]
            values[first : first + len(self.relaxations)] = self.relaxations

    @contextmanager
    def unchanged(self) -> Iterator[None]:
        """Restore coordinates, velocities and multipliers on exit: integrators continue from these values."""
        vectors = (self.q, self.u, self.a, self.lam, self.mu)
        kept = [vector.copy() for vector in vectors]
        try:
            yield
        finally:
            for vector, values in zip(vectors, kept, strict=True):
                vector[:] = values

    def evaluate(self, term_set: str, t: float) -> None:
        """Compute all terms of a set at the current state."""
        self.load(term_set)
        self._evaluate(t, SETS.index(term_set), self._at)

    def values_at(
        self, term_set: str, places: slice | np.ndarray, t: np.ndarray, q: np.ndarray, u: np.ndarray
    ) -> np.ndarray:
        """Return some values of a set at many states, one row for each; the last one becomes the current state."""
        self.load(term_set)
        found = np.empty((len(t), len(self.values[term_set][places])))
        for k, at in enumerate(t.tolist()):
            self.q[:], self.u[:] = q[k], u[k]
            self.evaluate(term_set, at)
            found[k] = self.values[term_set][places]
        return found

    def restart_counters(self, t: float) -> None:
        """Reset the turn counters to their current angles."""
        term = self.system.term("position", "continuous_angle")
        if len(term.row):
            self.evaluate("position", t)
            self.q[term.row] = self.values["position"][term.source]

    def vector(self, term_set: str, name: str) -> np.ndarray:
        """Return a vector term from the last evaluation of its set, assembled."""
        term = self.system.term(term_set, name)
        result = np.zeros(self.system.extent(TERM_AXES[name]))
        np.add.at(result, term.row, self.values[term_set][term.source])
        return result

    def matrix(self, term_set: str, name: str) -> np.ndarray:
        """Return a matrix term from the last evaluation of its set, dense."""
        term = self.system.term(term_set, name)
        result = np.zeros([self.system.extent(axis) for axis in TERM_AXES[name]])
        np.add.at(result, (term.row, term.column), self.values[term_set][term.source])
        return result
