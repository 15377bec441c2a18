"""Compilation of a formulation to flat lists for `stiffmbs.compile.machine.native.evaluate`."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from .condensed_positions import NOTHING_CONDENSED, CondensedPositions
from .coordinates import FIXED, Coordinates, all_independent
from .formulation import Block, Formulation
from .machine.layout import held_once, packed
from .machine.native.tables import EQUATIONS
from .system import System, Term
from .terms import TERM_AXES, TERM_SETS

ABSENT = FIXED
"""Position of a coordinate or multiplier that is not among the unknowns."""


class Equations:
    """Compiled formulation of one system: positions of the unknowns, and lists for residual and matrix.

    `coordinates`: independent coordinates; all by default. The equations of dependent coordinates are added to those
    of their leaders (virtual work: N^T r(N z) with q = offset + N z). `n`: number of unknowns. `at`: position of each
    kind of unknown in the vector of unknowns. `ABSENT` are dependent coordinates, multipliers of redundant and
    satisfied equations, and mu of nonholonomic equations. `pattern`: row and column of each slot of the matrix, by
    columns.
    """

    def __init__(self, formulation: Formulation, system: System, coordinates: Coordinates | None = None) -> None:
        self.formulation, self.system = formulation, system
        self.coordinates = coordinates or all_independent(system)
        independent, solved_for = self.coordinates.independent, system.active & ~self.coordinates.satisfied
        present = {
            "q": independent, "u": self.coordinates.independent_u,
            "mu": system.holonomic & solved_for, "lam": solved_for,
            "x": np.isin(np.arange(system.n_q), system.algebraic_coordinates),
            "s": np.arange(system.n_q) >= system.n_pose,
        }  # fmt: skip
        self.at: dict[str, np.ndarray] = {}
        self.n = 0
        for name in formulation.unknowns:
            self.at[name] = np.where(present[name], self.n + np.cumsum(present[name]) - 1, ABSENT)
            self.n += int(present[name].sum())
        self._offset = np.zeros(system.n_q)
        self._compile_residual()
        self._compile_matrix()

    def start_from(self, q: np.ndarray) -> None:
        """Set the offsets of dependent coordinates from a pose that satisfies the constraints."""
        self._offset[:] = self.coordinates.offset(q)

    @cached_property
    def independent(self) -> np.ndarray:
        """Positions of the independent coordinates, then of their velocities, among the unknowns."""
        carried = self.coordinates
        return np.concatenate([self.at["q"][carried.independent], self.at["u"][carried.independent_u]])

    def states(self, rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return all coordinates and velocities from those of `independent`, one state per row."""
        count = self.coordinates.count
        q, u = rows[:, :count], rows[:, count:]
        if count == self.system.n_q:
            return q, u
        return self._offset + self._led("q", q), self._led("u", u)

    def rates(self, rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the rates of all coordinates and velocities from those of `independent`, one row for each state."""
        count = self.coordinates.count
        if count == self.system.n_q:
            return rows[:, :count], rows[:, count:]
        return self._led("q", rows[:, :count]), self._led("u", rows[:, count:])

    def _led(self, name: str, rows: np.ndarray) -> np.ndarray:
        """Return all coordinates or velocities, without offsets, from the independent ones."""
        place, ratio = self._leads[name]
        if not rows.shape[1]:  # no independent coordinates
            return np.zeros((len(rows), len(place)))
        return ratio * rows[:, place]

    @cached_property
    def _leads(self) -> dict[str, tuple[np.ndarray, np.ndarray]]:
        """Index of the leader of each coordinate and velocity among the independent ones, and the ratio."""
        found = {}
        for name in ("q", "u"):
            independent_of, ratio = self.coordinates.relation(name)
            place = np.cumsum(independent_of == np.arange(len(independent_of))) - 1
            found[name] = np.where(independent_of == FIXED, 0, place[independent_of]), ratio
        return found

    def carried(self, name: str, own: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the positions of a kind's entries among the unknowns, and their factors."""
        if name not in ("q", "u"):
            return self.at[name][own], np.ones(len(own))
        independent_of, ratio = self.coordinates.relation(name)
        return np.where(independent_of[own] == FIXED, ABSENT, self.at[name][independent_of[own]]), ratio[own]

    def _block(self, term_set: str, name: str, rows: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return source, row and column of a block's entries."""
        system = self.system
        base, _, part = name.removesuffix(".T").partition(":")
        constants = system.constants(term_set)
        if base == "E":
            diagonal = np.flatnonzero(~np.isin(np.arange(system.n_q), system.algebraic_coordinates))
            return np.full(len(diagonal), constants["I"]), diagonal, diagonal
        if base == "I":
            diagonal = system.quaternions if part == "turning" else np.arange(system.extent(rows))
            return np.full(len(diagonal), constants["I"]), diagonal, diagonal
        if base in constants:
            diagonal = np.arange(system.n_u if base == "M" else system.n_c)
            return constants[base] + diagonal, diagonal, diagonal
        term = system.term(term_set, base)
        if base == "Z":
            q, u = system.straight
            straight = np.full(len(q), constants["I"])
            parts = ((term.source, straight), (term.row, q), (term.column, u))
            source, row, column = (np.concatenate(part) for part in parts)
            return source, row, column
        if part == "rates":
            kept = ~system.holonomic[term.row]
            term = Term(term.source[kept], term.row[kept], term.column[kept])
        return (term.source, term.column, term.row) if name.endswith(".T") else (term.source, term.row, term.column)

    def _compile_residual(self) -> None:
        parts: dict[str, list[tuple[np.ndarray, ...]]] = {"plain": [], "y": [], "yp": []}
        for line in self.formulation.residual:
            source, row, column = self._block(self.formulation.residual_set, line.block, line.rows)
            line_row, factor = self.carried(line.rows, row)
            factor = line.factor * factor
            if line.operand is None:
                part, operand = "plain", np.zeros_like(source)
            else:
                part = "yp" if line.operand.endswith("'") else "y"
                operand, ratio = self.carried(line.operand.rstrip("'"), column)
                factor = factor * ratio
            kept = (line_row != ABSENT) & (operand != ABSENT)
            parts[part].append(tuple(column[kept] for column in (line_row, source, operand, factor)))
        ends = np.cumsum([sum(len(lines[0]) for lines in part) for part in parts.values()])
        self._n_plain, self._n_with_y, self._n_with_yp = (int(end) for end in ends)
        columns = [
            np.concatenate([lines[k] for part in parts.values() for lines in part] or [np.empty(0)]) for k in range(4)
        ]
        self._r_row, self._r_source, self._r_operand = (held_once(c.astype(np.int32)) for c in columns[:3])
        self._r_factor = held_once(columns[3].astype(float))

    def _compile_matrix(self) -> None:
        lines = []
        for line in (each for each in self.formulation.matrix if not _is_condensed(each)):
            source, row, column = self._block(self.formulation.matrix_set, line.block, line.rows)
            (at_row, of_row), (at_column, of_column) = (
                self.carried(line.rows, row),
                self.carried(line.columns, column),
            )
            kept, factor = (at_row != ABSENT) & (at_column != ABSENT), of_row * of_column
            parts = (at_row, at_column, source, line.constant * factor, line.cj * factor)
            lines.append(tuple(part[kept] for part in parts))
        row, column, source, constant, cj = (np.concatenate([line[k] for line in lines]) for k in range(5))
        place = column * self.n + row
        condensed = self._condensed() if any(map(_is_condensed, self.formulation.matrix)) else None
        if condensed:
            by_row, by_velocity = condensed.place
            place = np.concatenate([place, self.at["u"][by_velocity] * self.n + by_row])
        order = np.argsort(place, kind="stable")
        new = np.diff(place[order], prepend=-1) > 0
        self.pattern = held_once(place[order][new] % self.n), held_once(place[order][new] // self.n)
        slot = np.empty(len(place), dtype=np.int32)
        slot[order] = np.cumsum(new) - 1
        self._condensed_lists = condensed.lists(slot[len(row) :]) if condensed else NOTHING_CONDENSED
        self._slot, self._source = held_once(slot[: len(row)]), held_once(source.astype(np.int32))
        self._constant, self._cj = held_once(constant.astype(float)), held_once(cj.astype(float))

    def _condensed(self) -> CondensedPositions:
        """Return the condensed entries of all blocks."""
        lines = []
        for line in filter(_is_condensed, self.formulation.matrix):
            source, row, column = self._block(self.formulation.matrix_set, line.block, line.rows)
            at = self.at[line.rows][row]
            lines.append(np.stack([at, column, source, np.full(len(at), line.constant)])[:, at != ABSENT])
        *places, factor = np.concatenate(lines, axis=1)
        row, column, source = (part.astype(np.int64) for part in places)
        return CondensedPositions.of(self.system, row, column, source, factor)

    @property
    def slots_with_rates(self) -> np.ndarray:
        """Slots of the matrix with an entry of dr/dy', in the order of the pattern."""
        return np.flatnonzero(np.bincount(self._slot[self._cj != 0.0]))

    def used(self) -> dict[str, np.ndarray]:
        """Return the groups whose values are used, for the term sets of the residual and of the matrix."""
        residual_set, matrix_set = self.formulation.residual_set, self.formulation.matrix_set
        groups = {residual_set: self._writing(residual_set, self._r_source)}
        sources = self._source, *(self._condensed_lists[f"{name}_source"] for name in ("straight", "turned"))
        of_matrix = self._writing(matrix_set, np.concatenate(sources))
        return groups | {matrix_set: groups.get(matrix_set, False) | of_matrix}

    def _writing(self, term_set: str, sources: np.ndarray) -> np.ndarray:
        read = np.zeros(self.system.n_values(term_set) + 1, dtype=np.int64)
        read[1 + sources[sources < len(read) - 1]] = 1
        before, terms = np.cumsum(read), TERM_SETS[term_set]
        writes = np.zeros(len(self.system.groups), dtype=bool)
        for g, group in enumerate(self.system.groups):
            first = self.system.places[term_set][g, 1:]
            width = np.array([group.count * group.entries[term] for term in terms])
            writes[g] = np.any(before[first + width] > before[first])
        return writes

    @cached_property
    def _index(self) -> dict[str, np.ndarray]:
        """Positions of coordinates and multipliers among the unknowns, for compiled code."""
        empty = np.zeros(1, dtype=np.int64)
        lists: dict[str, np.ndarray] = {}
        for name in ("q", "u"):
            independent_of, _ = self.coordinates.relation(name)
            moving = np.flatnonzero(independent_of != FIXED) if name in self.at else empty[:0]
            lists |= {f"moving_{name}": moving, f"{name}_from": self.carried(name, moving)[0] if len(moving) else empty}
        lists |= {f"at_{name}": self.at.get(name, empty) for name in ("mu", "lam", "x")}
        return {name: np.ascontiguousarray(part, dtype=np.int64) for name, part in lists.items()}

    def table(self) -> tuple[np.ndarray, list[np.ndarray]]:
        """Return the table for compiled code, and the arrays that must live as long as it."""
        sets = list(TERM_SETS)
        lists = entry_lists(self._slot, self._source, self._constant, self._cj)
        values = {
            "n": self.n, "residual_set": sets.index(self.formulation.residual_set),
            "matrix_set": sets.index(self.formulation.matrix_set),
            "n_plain": self._n_plain, "n_with_y": self._n_with_y, "n_with_yp": self._n_with_yp,
            "r_row": self._r_row, "r_source": self._r_source, "r_operand": self._r_operand, "r_factor": self._r_factor,
            "integrated": self.formulation.integrated, "n_slots": len(self.pattern[0]), "n_entries": len(self._slot), **lists,
            **self._condensed_lists,
            "has_mu": "mu" in self.at, "has_lam": "lam" in self.at,
            "n_moving_q": len(self._index["moving_q"]), "n_moving_u": len(self._index["moving_u"]), "offset": self._offset,
            "q_ratio": self.coordinates.ratio, "u_ratio": self.coordinates.u_ratio, **self._index,
        }  # fmt: skip
        return packed(EQUATIONS, values), [part for part in lists.values() if isinstance(part, np.ndarray)]


def _is_condensed(line: Block) -> bool:
    """Return True for a block of derivatives by q in columns of velocities."""
    return line.columns == "u" and TERM_AXES.get(line.block, "")[1:] == "q"


def entry_lists(
    slot: np.ndarray, source: np.ndarray, constant: np.ndarray, cj: np.ndarray
) -> dict[str, np.ndarray | int]:
    """Return the matrix entries in their order of addition: those of slots independent of cj, then all others."""
    late = np.isin(slot, slot[cj != 0])
    order = np.argsort(late, kind="stable")
    columns = {"slot": slot, "source": source, "constant": constant, "cj": cj}
    return {
        "n_constant": int(np.count_nonzero(~late)),
        **{f"m_{name}": held_once(part[order]) for name, part in columns.items()},
    }
