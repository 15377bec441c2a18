"""Memory of the search for events within a step, laid out for compiled code."""

from __future__ import annotations

import numpy as np

from ...compile.inputs.features import NO_FEATURES, InputFeatures
from ...compile.law_intervals import intervals_of
from ...compile.machine.layout import Table, fill
from ...compile.state import State
from ...compile.system import System
from ...compile.terms import TERM_SETS
from ...compile.written_values import writer
from ...dynamics.dynamics import Dynamics
from ...errors import SolverError
from .chattering import CHATTERING
from .departures import Departure, departures, refused_departure
from .native.layouts import ALWAYS, EVENT_SEARCH, STEP_BOUND
from .whole_steps import WHOLE

NODES = len(WHOLE)
"""Number of interpolation nodes of a step."""


class EventSearch:
    """Event functions of a system, and the memory of the search for their events within a step.

    - `table`: addresses for compiled code (`stiffmbs.solve.events.native.layouts.EVENT_SEARCH`).
    - `n`: number of event functions, including those of laws.
    - `n_event_functions`: number of event functions without those of laws.
    - `band`, `farthest` of shape (n_event_functions,): distance from zero within which an event function stays, 0 for
      one with an event at zero; and its largest value since the start.
    - `found` of shape (n,): 1 for the functions of the last event, 0 for others.
    """

    def __init__(self, state: State) -> None:
        self._system = system = state.system
        state.load("event_function")
        n, n_event_functions, n_state = (
            system.n_values("event_function"),
            system.n_event_functions,
            system.n_q + system.n_u,
        )
        self.n, self.found = n, np.zeros(n, dtype=np.int64)
        self.n_event_functions = n_event_functions
        self.band, self.farthest = np.zeros(n_event_functions), np.zeros(n_event_functions)
        self.table = Table(EVENT_SEARCH)
        self._cells = self.table.view(EVENT_SEARCH.cells)[0]
        if not n:
            return  # no search: its arrays are not read
        intervals = intervals_of(system)
        self._overlap, self._breakpoints = intervals.overlap.copy(), intervals.breakpoints.copy()
        self._first = intervals.first[:n_event_functions]
        weight = (-1.0) ** np.arange(NODES)
        weight[[0, -1]] /= 2  # barycentric weights of Chebyshev points of the second kind
        angles = system.turning
        n_lam = system.n_c if system.switches_by_reactions else 0
        work = ("value_before", "rate_before", "value_after", "rate_after", "a", "a_rate", "b", "b_rate", "m", "m2", "left_low", "left_high", "noise", "apart")  # fmt: skip
        self._within = np.zeros((2, n))
        self._extent = {name: np.empty(n) for name in ("lowest", "highest", "outside", "left")}
        self._arrays = {
            "longest": np.inf, "passage": np.inf, "first": np.inf, "n_turns": len(intervals.turns), "turn": intervals.turns, "radians": intervals.radians, "kinked": intervals.kinks, "tables": intervals.tables, "n_with_intervals": intervals.zoned,
            "n_jumping": len(intervals.jumping), "jumping": intervals.jumping,
            "n": n, "n_event_functions": n_event_functions, "band": self.band, "farthest": self.farthest,
            "first_breakpoint": intervals.first, "breakpoints": self._breakpoints, "overlap": self._overlap, "period": intervals.period, **{name: np.zeros(n) for name in work}, "interval_low": self._within[0], "interval_high": self._within[1], "found": self.found,
            "n_state": n_state, "n_lam": n_lam, "lam": np.zeros(n_lam), "by_accelerations": int(n_lam > 0 or len(system.algebraic_coordinates) > 0), "n_nodes": NODES, "node": WHOLE, "weight": weight,
            **self._extent,
            **_calls(system), "row": np.zeros((NODES + 1) * (n_state + n_lam)), "n_angles": len(angles), "angle": angles,
        }  # fmt: skip
        fill(self.table, self._arrays)

    def end_steps_at_kinks(self) -> None:
        """End steps at the kinks of tables from now on."""
        if self.n:
            intervals = intervals_of(self._system)
            self._cells["at_kinks"] = ALWAYS
            self._overlap[np.repeat(intervals.kinks, np.diff(intervals.first)) > 0] = 0.0

    def begin(self) -> None:
        """Forget the last step before a restart of the integrator."""
        self._cells["begun"] = np.inf
        self.found[:] = 0

    def follow_reactions(self, dynamics: Dynamics) -> None:
        """Let reactions in event functions follow from accelerations: those of an integrator have no error test."""
        if self.n:
            self.table.link("dynamics", dynamics.table)

    def watch_for(self, band: np.ndarray) -> None:
        """Pass events where event functions leave a band about zero; at zero for those without, of value 0."""
        if self.n_event_functions:
            self.band[:] = band
            self._breakpoints[self._first] = -band
            self._breakpoints[self._first + 1] = np.where(band > 0, band, np.inf)
            self._within[:, : self.n_event_functions] = 0.0  # unknown

    def resolve(self, duration: float) -> None:
        """Forget the last run; the periods of laws limit the steps of a run of this duration, s."""
        for cell, value in (
            ("least", duration / CHATTERING.too_many),
            ("duration", duration),
            ("longest", np.inf),
            ("unresolved", 0),
            ("under_way", 0),
            ("begins", np.inf),
            ("narrow", 0),
            ("passed", -np.inf),
            ("noted", np.inf),
        ):
            self._cells[cell] = value
        if self.n:
            for name, nothing in (("lowest", np.inf), ("highest", -np.inf), ("outside", 0.0), ("left", np.inf)):
                self._extent[name][:] = nothing

    def departures(self) -> tuple[Departure, ...]:
        """Return the tables whose points were left in the steps of the last run."""
        if not self.n or np.isinf(self._extent["left"]).all():
            return ()
        found = zip(*(values[self.n_event_functions :].tolist() for values in self._extent.values()), strict=True)
        return departures(self._system, found)

    def refuse_departures(self) -> None:
        """Raise a SolverError if the steps so far have left a table with ``beyond: error``."""
        if (left := self.departures()) and (first := refused_departure(left)):
            raise SolverError(first.refusal())

    def note(self) -> str:
        """Return a sentence on a periodic law with more periods than steps; empty if there is none."""
        cells = self._cells
        if not cells["unresolved"]:
            return ""
        name = writer(self._system, "event_function", int(cells["fastest"]))
        return (
            f"'{name}' has a force law whose period is shorter than a step, first at t = {cells['first_unresolved']:.6g} s, so the steps do "
            "not resolve it; expected a longer period, or max_step far below the period"
        )


def _calls(system: System) -> dict[str, np.ndarray | int]:
    """Return the kernel call that computes each function, and flags of the calls to evaluate: all, at first."""
    places, terms = system.places["event_function"], TERM_SETS["event_function"]
    call = np.zeros(system.n_values("event_function"), dtype=np.int64)
    writing = [g for g, group in enumerate(system.groups) if system.kernel("event_function", group) is not None]
    for number, g in enumerate(writing):
        group = system.groups[g]
        for k, term in enumerate(terms):
            first = int(places[g, 1 + k])
            call[first : first + group.count * group.entries[term]] = number
    return {"n_calls": len(writing), "call": call, "near": np.ones(len(writing), dtype=np.int64)}


class StepBound:
    """Table of step bounds for compiled code (`stiffmbs.solve.events.native.step_bound`), which may be updated.

    `table`: its address does not change. `at_bends`: True if steps end at jumps of the curvature of inputs.
    """

    def __init__(self, at_bends: bool = False) -> None:
        self._at_bends = at_bends
        self.table = Table(STEP_BOUND)  # no features: its arrays are not read
        self._cells = self.table.view(STEP_BOUND.cells)[0]
        self._followed = NO_FEATURES

    def follow(self, features: InputFeatures) -> None:
        """Bound steps by these features from now on."""
        self._cells["place"] = self._cells["bend"] = 0
        if features is self._followed:
            return
        self._followed = features
        bends = features.bends if self._at_bends else np.empty(0)
        if not len(features.starts) and not len(bends):
            self.table[:] = 0
            return
        self._kept = {
            "n": len(features.starts), "starts": np.ascontiguousarray(features.starts), "longest": np.ascontiguousarray(features.longest),
            "n_bends": len(bends), "bends": np.ascontiguousarray(bends),
        }  # fmt: skip
        fill(self.table, self._kept)
