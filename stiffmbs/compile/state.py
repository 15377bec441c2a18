"""The working memory of one solver on one system."""

from __future__ import annotations

import numpy as np

from .layout import CALL, STATE, packed
from .routines import TERMS
from .system import PLANAR, System
from .terms import TERM_AXES, TERM_SETS

SETS = list(TERM_SETS)


class State:
    """Current coordinates, velocities and multipliers of a system, and the values of its terms.

    Parameters
    ----------
    system : System

    Attributes
    ----------
    q, u, a, lam, mu : ndarrays
        Shapes (n_q,), (n_u,), (n_u,), (n_c,), (n_c,): what the kernels see.
    values : dict of str to ndarray
        For each loaded term set the values that its kernels write, then the system's constants.
    table : ndarray of int
        Addresses for compiled code (`stiffmbs.compile.layout.STATE`).
    """

    def __init__(self, system: System) -> None:
        self.system = system
        self._q = np.concatenate([system.q, np.zeros(PLANAR)])
        self._u = np.concatenate([system.u, np.zeros(PLANAR)])
        self._a = np.zeros(system.n_u + PLANAR)
        self.q, self.u, self.a = self._q[: system.n_q], self._u[: system.n_u], self._a[: system.n_u]
        self.lam, self.mu = np.zeros(system.n_c), np.zeros(system.n_c)
        self.values: dict[str, np.ndarray] = {}
        self._calls: dict[str, np.ndarray] = {}
        self._n_calls, self._calls_at, self._values_at = (np.zeros(len(SETS), dtype=np.int64) for _ in range(3))
        self._relaxations = np.zeros(2 * system.n_c)
        self.table = packed(
            STATE,
            {
                "n_q": system.n_q, "n_u": system.n_u, "n_c": system.n_c,
                "q": self._q, "u": self._u, "a": self._a, "lam": self.lam, "mu": self.mu,
                "n_calls": self._n_calls, "calls": self._calls_at, "values": self._values_at,
                "n_joints": len(system.joint_start) - 1, "joint_start": system.joint_start,
            },
        )  # fmt: skip
        self._evaluate = TERMS.load()

    def load(self, term_set: str) -> None:
        """Make a term set ready for compiled code: its kernels, and room for its values."""
        if term_set in self.values:
            return
        system, k = self.system, SETS.index(term_set)
        calls = [
            (kernel.address, group.count, group.index.ctypes.data, group.numbers.ctypes.data,
             system.places[term_set][g].ctypes.data)
            for g, group in enumerate(system.groups)
            if (kernel := system.kernel(term_set, group)) is not None
        ]  # fmt: skip
        self._calls[term_set] = np.array(calls, dtype=np.int64).reshape(-1, len(CALL))
        room = np.zeros(system.n_values(term_set))
        self.values[term_set] = np.concatenate([room, system.mass, self._relaxations, [1.0]])
        self._n_calls[k] = len(calls)
        self._calls_at[k] = self._calls[term_set].ctypes.data
        self._values_at[k] = self.values[term_set].ctypes.data

    def relax(self, mu: np.ndarray, lam: np.ndarray) -> None:
        """Set the relaxation of each constraint row, used by the formulations that have one."""
        self._relaxations[:] = *mu, *lam
        for term_set, values in self.values.items():
            first = self.system.constants(term_set)["E_mu"]
            values[first : first + len(self._relaxations)] = self._relaxations

    def evaluate(self, term_set: str, t: float) -> None:
        """Compute all terms of a set at the current state."""
        self.load(term_set)
        self._evaluate(t, SETS.index(term_set), self.table.ctypes.data)

    def vector(self, term_set: str, name: str) -> np.ndarray:
        """A vector term from the last evaluation of its set, assembled."""
        term = self.system.term(term_set, name)
        result = np.zeros(self.system.n_c if TERM_AXES[name] == "c" else self.system.n_u)
        np.add.at(result, term.row, self.values[term_set][term.source])
        return result

    def matrix(self, term_set: str, name: str) -> np.ndarray:
        """A matrix term from the last evaluation of its set, dense."""
        term = self.system.term(term_set, name)
        shape = tuple(self.system.n_c if axis in "cl" else self.system.n_u for axis in TERM_AXES[name])
        result = np.zeros(shape)
        np.add.at(result, (term.row, term.column), self.values[term_set][term.source])
        return result
