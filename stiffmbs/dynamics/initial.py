"""Consistent initial values: assembled positions, corrected velocities, accelerations and multipliers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..compile.gaps import position_gap
from ..compile.machine.native.statuses import NO_BALANCE, NO_CONVERGENCE, NOT_FINITE, SINGULAR
from ..compile.written_values import values_of
from ..errors import AssemblyError
from ..notes import NoteKind, Severity
from .algebraic_states import failure
from .dynamics import Dynamics
from .moves import Move, moves, position_words, velocity_words
from .native.parameters import CONSISTENCY
from .turns import take_nearest_turns

CHANGED = "to satisfy {what} at the start, assembly changed {changes}"
ASSEMBLED = NoteKind("assembled", CHANGED, severity=Severity.REMARK)
MOVED_FAR = NoteKind(
    "moved-far",
    CHANGED + ": {bodies} by more than {part:g} of the mechanism's size ({size:.3g} m) or {turn:g} deg",
    "check points of markers, positions and angles{hint}",
)


@dataclass(frozen=True, eq=False)
class InitialValues:
    """Consistent initial values.

    - `q`, `u`, `acceleration`, `lam`: coordinates, velocities, accelerations and multipliers that satisfy the
      constraints on every level.
    - `moved`: noticeable changes of bodies by the assembly.
    - `size`: size of the mechanism as described, m.
    - `notes`: notes, one sentence each.
    """

    q: np.ndarray
    u: np.ndarray
    acceleration: np.ndarray
    lam: np.ndarray
    moved: tuple[Move, ...]
    size: float
    notes: tuple[str, ...] = ()
    hint: str = ""

    def sentence(self) -> str:
        """Return a sentence on the largest moves of bodies and changes of their velocities, or an empty string."""
        return self._changed("the joints", self._levels())

    def _levels(self) -> str:
        levels = [words(self.moved, self.size, CONSISTENCY.most_listed) for words in (position_words, velocity_words)]
        return " and ".join(filter(None, levels))

    def as_asked_by(self, names: Sequence[str]) -> InitialValues:
        """Replace the moves by a note, where joints that hold at the start only require them."""
        note = ASSEMBLED(what=", ".join(names), changes=self._levels() or "nothing")
        return replace(self, moved=(), notes=(*self.notes, note))

    def position_sentence(self, most: int) -> str:
        """Return a sentence on the bodies that were moved, the first `most` by name, or an empty string."""
        return self._changed("the joints", position_words(self.moved, self.size, most))

    def _changed(self, what: str, changes: str) -> str:
        far = self.moved_far
        if not far or not changes:
            return ASSEMBLED(what=what, changes=changes) if changes else ""
        bodies = f"{len(far)} bodies move" if len(far) > 1 else f"{far[0].body} moves"
        part, turn = CONSISTENCY.large_shift, CONSISTENCY.large_turn
        return MOVED_FAR(
            what=what, changes=changes, bodies=bodies, part=part, size=self.size, turn=turn, hint=self.hint
        )

    def far_notes(self) -> tuple[str, ...]:
        """Return a note on bodies that assembly moved far, which remains if the pose is replaced by an equilibrium."""
        return (self.position_sentence(CONSISTENCY.most_listed),) if self.moved_far else ()

    @property
    def moved_far(self) -> tuple[Move, ...]:
        """Moves too large for a correction of a drawing: an input is wrong, or the scene is not drawn closed."""
        return tuple(move for move in self.moved if move.is_large(self.size))


def initial_values(dynamics: Dynamics, t: float, first: np.ndarray | None = None) -> InitialValues:
    """Make the described start consistent.

    Positions are corrected by minimum-norm Newton moves, or by damped ones if these do not converge. Velocities get the smallest correction in the mass norm:
    those that are not given, then those numbered in `first`, then all. Accelerations and multipliers follow from [M J^T; J 0][u'; lam] = [f; gamma].
    Raises AssemblyError when no assembled position is found (names the joint with the largest gap), the equations are
    dependent, or friction and reactions have no balance.
    """
    if dynamics.system.n_counters:
        take_nearest_turns(dynamics, t)
    return consistent_values(dynamics, t, first)


def consistent_values(dynamics: Dynamics, t: float, first: np.ndarray | None = None) -> InitialValues:
    """Make the start consistent as `initial_values` does, without angle unwrapping."""
    system, state = dynamics.system, dynamics.state
    q0, u0 = system.q.copy(), system.u.copy()
    status = dynamics.assemble(t)
    if status in (NO_CONVERGENCE, SINGULAR):
        from .damped_assembly import damped_assembly

        status = 0 if damped_assembly(dynamics, t, q0) else status
    if status < 0:
        raise AssemblyError(_sentence(dynamics, NO_CONVERGENCE if status == SINGULAR else status, t))
    _fit_rates(dynamics, t, np.flatnonzero(system.open_rates))
    if first is not None:
        _fit_rates(dynamics, t, first)
    status = dynamics.correct_velocities(t)
    if status < 0:
        raise AssemblyError(_sentence(dynamics, status, t))
    if system.n_counters:
        state.restart_counters(t)
    status, acceleration = dynamics.accelerate(t)
    if status < 0 and system.forces_by_reactions:  # the magnitude of a reaction has no derivative at zero
        state.lam[: system.n_c] = np.max(system.mass)  # of the heaviest body at 1 m/s^2
        status, acceleration = dynamics.accelerate(t)
    if status < 0:
        raise AssemblyError(_sentence(dynamics, status, t))
    change = np.where(system.open_rates, 0.0, state.u - u0)
    moved = moves(system, system.move(q0, state.q), change)
    return InitialValues(
        state.q.copy(), state.u.copy(), acceleration, state.lam[: system.n_c].copy(), moved, system.size
    )


def _fit_rates(dynamics: Dynamics, t: float, rates: np.ndarray) -> None:
    """Fit some velocities to J u + C_t = 0 by the smallest change in the mass norm."""
    system, state = dynamics.system, dynamics.state
    if not len(rates):
        return
    state.evaluate("motion", t)
    rows = np.flatnonzero(system.active)
    by_energy = state.matrix("motion", "J")[np.ix_(rows, rates)] / np.sqrt(system.mass[rates])
    follow, *_ = np.linalg.lstsq(by_energy, -state.vector("motion", "V")[rows], rcond=None)
    state.u[rates] += follow / np.sqrt(system.mass[rates])


def _sentence(dynamics: Dynamics, status: int, t: float) -> str:
    if status == NO_CONVERGENCE:
        return _violation_sentence(dynamics, t)
    if status == SINGULAR:
        return _dependent_sentence(dynamics)
    if status == NO_BALANCE:
        return f"the start has no accelerations: {failure(dynamics, status, t)}"
    if status == NOT_FINITE:
        return _undefined_sentence(dynamics, t)
    return f"no consistent start was found: {failure(dynamics, status, t)}"


def _violation_sentence(dynamics: Dynamics, t: float) -> str:
    system, state = dynamics.system, dynamics.state
    state.evaluate("position", t)
    gaps = np.abs(state.vector("position", "C"))
    if not np.all(np.isfinite(gaps)):
        return _undefined_sentence(dynamics, t)
    row = int(np.argmax(gaps))
    joint, equation = system.equations[row]
    return (
        f"the scene cannot be assembled: the largest gap is in joint '{joint}' (equation {equation}, "
        f"{position_gap(state, t, row)}, expected less than {CONSISTENCY.position_tolerance:g})"
    )


def _dependent_sentence(dynamics: Dynamics) -> str:
    from scipy.linalg import qr

    state, system = dynamics.state, dynamics.system
    solved_for = np.flatnonzero(system.active)
    *_, order = qr(state.matrix("motion", "J")[solved_for].T, mode="economic", pivoting=True)
    joint, equation = system.equations[solved_for[order[-1]]]
    return (
        f"the constraint equations are dependent at the start: joint '{joint}' (equation {equation}) is "
        "redundant with other joints, so its reaction is not unique"
    )


def _undefined_sentence(dynamics: Dynamics, t: float) -> str:
    state, system = dynamics.state, dynamics.system
    for term_set in ("motion", "acceleration"):
        state.evaluate(term_set, t)
        for name in (name for group in system.groups for name in group.names):
            values = values_of(system, state.values[term_set], term_set, name)
            if not all(np.all(np.isfinite(part)) for part in values.values()):
                return f"'{name}' has no finite value at the start, expected equations that are defined there"
    return "the accelerations at the start are not finite; check the sizes of forces and masses"
