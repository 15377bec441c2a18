"""Compiled model: sizes, mass, and the terms of all elements with their positions in the system.

Solvers see a `System` but no elements: the entries of each term, their positions among the kernel values, and the
equation and coordinate of each.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from ..reading.formula.formula import Formula
from .bodies import BodyKind
from .group import Group
from .machine.layout import held_once
from .machine.linking import Compiled
from .reactions import reported_terms
from .record import kernel_of, source_of
from .terms import TERM_AXES, TERM_SETS, TURNED


class Term(NamedTuple):
    """Positions of a term's entries: `source` in the values of its set, `row` and `column` in the system.

    Entries of the ground are omitted.
    """

    source: np.ndarray
    row: np.ndarray
    column: np.ndarray


@dataclass(frozen=True, eq=False)
class System:
    """Compiled model.

    - `bodies`: in the order of their coordinates.
    - `states`: user states, whose values are the last coordinates.
    - `state_scales` of shape (states,): characteristic magnitudes of the states.
    - `algebraic` of shape (states,): True for states without a rate, determined by an equation at every time.
    - `sampling` of shape (states, 2): period and offset of the samples of each state, s; a period of 0 for states that
      are not sampled.
    - `of_body`: coordinates and velocities of each body.
    - `q`, `u`: initial coordinates (m, rad; quaternions) and velocities, as described. After the bodies' coordinates
      come the turn counters (`stiffmbs.compile.symbolic.continuous_angle`) and the states.
    - `open_rates` of shape (n_u,): True for initial velocities that are not given; constraints determine them first.
    - `mass` of shape (n_u,): diagonal of the mass matrix: masses, and moments of inertia about principal axes.
    - `followed` of shape (n_u,): 0 for angular velocities that a quaternion does not follow
      (`stiffmbs.presolve.spinning_bodies`), else 1.
    - `principal_axes` of shape (bodies, 4): quaternions of the principal axes in each body's own axes, used by results;
      (bodies, 0) in the plane.
    - `groups`: elements by kind.
    - `equations`: joint and equation name of each constraint row.
    - `holonomic`, `active` of shape (n_c,): True for rows with a position form, and for rows that are not redundant and
      therefore solved for.
    - `size`: size of the mechanism at the start, m.
    - `start_angles`: continuous angles of joints at a start from a saved state or with joints that hold at the start
      alone, rad, by channel; may be changed in place.
    - `described_angles`: angles of joints with described full turns, rad, by channel, unless drives select the turns.
    - `turns_set_up`: full turns by which elements were reduced that were set up during a motion, by name.
    - `outputs`: formulas for which names in other formulas stand, such as the values of inputs; may be changed in
      place.
    - `n_q`, `n_u`, `n_c`: numbers of coordinates, velocities and constraint equations.
    - `n_pose`, `n_counters`: numbers of body coordinates, which come first, and of turn counters.
    - `first_state`: index of the first state among the coordinates.
    - `has_inputs`, `has_functions`, `has_tables`: True if an element has a formula or a table, calls a Python function, or
      has or calls a table.
    - `has_coupled_inertia`: True if the mass matrix is not diagonal, as that of flexible bodies.
    - `has_laws`: True if forces or joints have breakpoints or laws (formulas, tables), which may change within one
      step.
    - `forces_by_reactions`: elements whose forces depend on reactions, such as friction.
    """

    bodies: tuple[str, ...]
    states: tuple[str, ...]
    state_scales: np.ndarray
    algebraic: np.ndarray
    sampling: np.ndarray
    of_body: BodyKind
    q: np.ndarray
    u: np.ndarray
    open_rates: np.ndarray
    mass: np.ndarray
    followed: np.ndarray
    principal_axes: np.ndarray
    groups: tuple[Group, ...]
    equations: tuple[tuple[str, str], ...]
    holonomic: np.ndarray
    active: np.ndarray
    size: float
    start_angles: dict[str, float] = field(default_factory=dict)
    described_angles: Mapping[str, float] = field(default_factory=dict)
    turns_set_up: Mapping[str, tuple[int, ...]] = field(default_factory=dict)
    outputs: dict[str, Formula] = field(default_factory=dict)
    n_q: int = field(init=False)
    n_u: int = field(init=False)
    n_c: int = field(init=False)
    n_pose: int = field(init=False)
    first_state: int = field(init=False)
    n_counters: int = field(init=False)
    has_inputs: bool = field(init=False)
    has_laws: bool = field(init=False)
    has_functions: bool = field(init=False)
    has_tables: bool = field(init=False)
    has_coupled_inertia: bool = field(init=False)
    forces_by_reactions: tuple[str, ...] = field(init=False)

    def __post_init__(self) -> None:
        n_q, n_pose = len(self.q), self.of_body.n_q * len(self.bodies)
        first_state = n_q - len(self.states)
        vars(self).update(
            n_q=n_q, n_u=len(self.u), n_c=len(self.equations), n_pose=n_pose, first_state=first_state,
            n_counters=first_state - n_pose, has_inputs=any(group.has_inputs for group in self.groups),
            has_functions=any(group.has_functions for group in self.groups),
            has_tables=any(group.kind.has_tables for group in self.groups),
            has_coupled_inertia=any(group.entries["inertia"] for group in self.groups),
            has_laws=any(group.has_law for group in self.groups if group.entries["f"] or group.record.n_equations),
            forces_by_reactions=tuple(name for group in self.groups if group.record.patterns.get("f_lam") for name in group.names),
        )  # fmt: skip

    def per_coordinate(self, linear: float, angular: float) -> np.ndarray:
        """Return one number for centre-of-mass coordinates, and another for all other coordinates, shape (n_q,)."""
        trailing = np.full(self.n_q - self.n_pose, angular)
        return np.append(self._per_body(self.of_body.n_q, linear, angular), trailing)

    @cached_property
    def straight(self) -> tuple[np.ndarray, np.ndarray]:
        """Indices of coordinates whose rate is a velocity, and of these velocities."""
        return self.of_body.straight(len(self.bodies))

    @cached_property
    def algebraic_coordinates(self) -> np.ndarray:
        """Indices of the coordinates that are algebraic states."""
        return self.first_state + np.flatnonzero(self.algebraic)

    @cached_property
    def sampled(self) -> np.ndarray:
        """Mask of the states that are constant between samples, shape (states,)."""
        return np.asarray(self.sampling[:, 0] > 0)

    @property
    def without_rate(self) -> np.ndarray:
        """Mask of the states that are algebraic or sampled, shape (states,)."""
        return self.algebraic | self.sampled

    @cached_property
    def with_rates(self) -> np.ndarray:
        """Indices of the coordinates after those of the bodies that have a rate: counters, differential states."""
        with_rate = np.append(np.ones(self.n_counters, dtype=bool), ~self.without_rate)
        return self.n_pose + np.flatnonzero(with_rate)

    @cached_property
    def following_reactions(self) -> np.ndarray:
        """Indices of the algebraic states that depend on multipliers, directly or through others."""
        algebraic, among = self.algebraic_coordinates, self.term("tangent", "rate_q")
        found = algebraic[np.isin(algebraic, self.term("tangent", "rate_lam").row)]
        while True:
            following = among.row[np.isin(among.column, found)]
            more = algebraic[np.isin(algebraic, np.concatenate([found, following]))]
            if len(more) == len(found):
                return found
            found = more

    @cached_property
    def quaternions(self) -> np.ndarray:
        """Indices of the coordinates that are quaternion components; empty in the plane."""
        return np.flatnonzero(~np.isin(np.arange(self.n_pose), self.straight[0]))

    @cached_property
    def mass_by_coordinate(self) -> np.ndarray:
        """Smallest inertia of each coordinate in the kinetic energy, shape (n_q,); 0 for coordinates not of bodies."""
        of_bodies = self.mass.reshape(len(self.bodies), self.of_body.n_u)
        linear, angular = np.split(of_bodies, [self.of_body.linear], axis=1)
        flat = self.of_body.n_q == self.of_body.n_u
        turning = angular if flat else 4 * angular.min(axis=1, keepdims=True) * np.ones(4)
        return np.append(np.hstack([linear, turning]), np.zeros(self.n_q - self.n_pose))

    @cached_property
    def velocity_groups(self) -> np.ndarray:
        """Group of each velocity, shape (n_u,): velocities connected by constraint equations.

        The velocity of a body without constraints is one group, and its angular velocity another one.
        """
        group = (self.per_velocity(0, 1) + 2 * np.repeat(np.arange(len(self.bodies)), self.of_body.n_u)).astype(int)
        least, of = np.arange(2 * len(self.bodies)), self.term("motion", "J")
        while True:
            of_equation, before = np.full(self.n_c, len(least)), least.copy()
            np.minimum.at(of_equation, of.row, least[group[of.column]])
            np.minimum.at(least, group[of.column], of_equation[of.row])
            least = least[least]
            if np.array_equal(least, before):
                return np.asarray(least[group])

    def per_velocity(self, linear: float, angular: float) -> np.ndarray:
        """Return one number for centre-of-mass velocities, and another for angular velocities, shape (n_u,)."""
        return self._per_body(self.of_body.n_u, linear, angular)

    def _per_body(self, width: int, linear: float, angular: float) -> np.ndarray:
        numbers = np.full((len(self.bodies), width), float(angular))
        numbers[:, : self.of_body.linear] = linear
        return numbers.reshape(-1)

    def move(self, q: np.ndarray, there: np.ndarray) -> np.ndarray:
        """Return the displacement of the bodies between two poses as velocities times time, shape (n_u,)."""
        of_bodies = slice(self.n_pose)
        return self.of_body.move(q[of_bodies], there[of_bodies])

    def names_of(self, places: Iterable[int], labels: tuple[str, ...]) -> list[str]:
        """Return the names of coordinates or velocities; see `name_of`."""
        return [self.name_of(k, labels) for k in places]

    def name_of(self, k: int, labels: tuple[str, ...]) -> str:
        """Return the name of a coordinate or velocity, such as ``cart.x``, from the labels of a body."""
        if k >= self.first_state:
            return self.states[k - self.first_state]
        if k >= len(labels) * len(self.bodies):
            return "a count of turns"
        return f"{self.bodies[k // len(labels)]}.{labels[k % len(labels)]}"

    @property
    def keeps_energy(self) -> bool:
        """True if kinetic + potential energy is constant: no drive, damper, friction or force without a potential."""
        return all(group.keeps_energy for group in self.groups)

    @cached_property
    def joint_start(self) -> np.ndarray:
        """First row of each joint's equations, and the end of the last."""
        starts = [
            row for row, (joint, _) in enumerate(self.equations) if row == 0 or joint != self.equations[row - 1][0]
        ]
        return np.array([*starts, self.n_c], dtype=np.int64)

    @cached_property
    def places(self) -> dict[str, np.ndarray]:
        """First equation, then first value of each term, for each term set and group."""
        return {term_set: self._places(term_set) for term_set in TERM_SETS}

    def _places(self, term_set: str) -> np.ndarray:
        terms = TERM_SETS[term_set]
        places = np.zeros((len(self.groups), 1 + len(terms)), dtype=np.int64)
        end = 0
        for k, term in enumerate(terms):
            for g, group in enumerate(self.groups):
                places[g, 0] = group.first_row
                places[g, 1 + k] = end
                end += group.count * group.entries[term]
        return places

    def n_values(self, term_set: str) -> int:
        """Return the number of kernel values of a set; constants follow them."""
        if term_set not in self._n_values:
            of_groups = (group.count * group.entries[term] for group in self.groups for term in TERM_SETS[term_set])
            self._n_values[term_set] = sum(of_groups)
        return self._n_values[term_set]

    @cached_property
    def _n_values(self) -> dict[str, int]:
        return {}

    def n_operations(self, term_set: str) -> int:
        """Return the number of arithmetic operations in the kernels of a set, for cost estimates."""
        return sum(group.count * group.record.n_operations(term_set) for group in self.groups)

    @cached_property
    def reported(self) -> dict[str, int]:
        """Channels of joints and forces with their index in the values of the output terms; -1 for zero."""
        return dict(reported_terms(self))

    @cached_property
    def signals(self) -> dict[str, int]:
        """Positions among the values of the set ``output`` of rates and next values of states, and of reported formulas."""
        place = 1 + TERM_SETS["output"].index("signal")
        return {
            name: int(self.places["output"][g, place]) + k
            for g, group in enumerate(self.groups)
            for k, name in enumerate(group.names if group.entries["signal"] else ())
        }

    @cached_property
    def timed(self) -> np.ndarray:
        """Mask of the equations that depend on time or states, shape (n_c,)."""
        rows = np.zeros(self.n_c, dtype=bool)
        for group in self.groups:
            last = group.first_row + group.count * group.record.n_equations
            rows[group.first_row : last] = np.tile(np.array(group.record.timed, dtype=bool), group.count)
        return rows

    @cached_property
    def first_limit(self) -> int:
        """Index of the first force limit among the values of the set ``event_function``."""
        return sum(group.count * group.entries["event_function"] for group in self.groups)

    @cached_property
    def n_event_functions(self) -> int:
        """Number of event functions and limits, the first values of the set ``event_function`` before law arguments."""
        return self.first_limit + sum(group.count * group.entries["limit"] for group in self.groups)

    @cached_property
    def switches_by_reactions(self) -> bool:
        """True if event functions or law arguments may depend on the multipliers of joints."""
        terms = TERM_SETS["event_function"]
        return any(group.kind.n_joints and any(group.entries[term] for term in terms) for group in self.groups)

    @cached_property
    def turning(self) -> np.ndarray:
        """Indices of the coordinates that are angles; empty in space."""
        flat = self.of_body.n_q == self.of_body.n_u
        return np.arange(self.of_body.linear, self.of_body.n_q * len(self.bodies) if flat else 0, self.of_body.n_q)

    @cached_property
    def known_terms(self) -> dict[tuple[str, str], Term]:
        """Cache of requested terms."""
        return {}

    @cached_property
    def known_intervals(self) -> dict[str, Any]:
        """Cache of the intervals of laws (`stiffmbs.compile.law_intervals`), and the numbers of their tables."""
        return {}

    def term(self, term_set: str, name: str) -> Term:
        """Return the entries of a term in a set, without those of the ground."""
        if (term_set, name) not in self.known_terms:
            self.known_terms[term_set, name] = self._term(term_set, name)
        return self.known_terms[term_set, name]

    def _term(self, term_set: str, name: str) -> Term:
        k = TERM_SETS[term_set].index(name)
        axes = TERM_AXES[name]
        first = self.places[term_set][:, 1 + k].tolist()
        parts = [group.placed(name, first[g]) for g, group in enumerate(self.groups) if group.entries[name]]
        nothing = np.empty(0, dtype=np.int64)  # for a scene without joints, forces and weight
        source, row, column = (np.concatenate([nothing, *(part[i] for part in parts)]) for i in range(3))
        inside = (row < self.extent(axes[0])) & (column < (self.extent(axes[1]) if len(axes) > 1 else 1))
        return Term(*(held_once(part[inside]) for part in (source, row, column)))

    def extent(self, axis: str) -> int:
        """Return the size of an axis of a term (`stiffmbs.compile.terms.TERM_AXES`)."""
        return {"q": self.n_q, "u": self.n_u, "c": self.n_c, "l": self.n_c}.get(axis, np.iinfo(np.int64).max)

    def kernel(self, term_set: str, group: Group, place: str = "") -> Compiled | None:
        """Return the compiled kernel of a group for a set, or None; `place` as for `kernel_of`."""
        return kernel_of(group.kind, term_set, place)

    def turned(self, term_set: str) -> np.ndarray:
        """Return the first coordinate of each body whose shared orientation values the kernels of a set read."""
        read = [
            group.index[:, : 2 * group.kind.n_bodies : 2].ravel()
            for group in self.groups
            if TURNED in (source_of(group.kind, term_set) or "")
        ]
        bodies = np.concatenate([np.empty(0, dtype=np.int64), *read])
        return np.flatnonzero(np.bincount(bodies)[: self.of_body.n_q * len(self.bodies)])

    def constants(self, term_set: str) -> dict[str, int]:
        """Return the indices of the constants after the values of a set: mass entries, relaxations, a one."""
        return self._constants[term_set]

    @cached_property
    def _constants(self) -> dict[str, dict[str, int]]:
        sizes = (self.n_u, self.n_c, self.n_c)
        return {
            term_set: dict(
                zip(("M", "E_mu", "E_lam", "I"), np.cumsum([self.n_values(term_set), *sizes]).tolist(), strict=True)
            )
            for term_set in TERM_SETS
        }
