"""Natural modes of a model about a state."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Unpack

import numpy as np
from scipy.sparse import csr_array

from ...compile.machine.routines import on_drafts
from ...dynamics.algebraic_states import failure
from ...errors import InputError, SolverError
from ...linear_analysis.modes import Mode, Motion, natural_modes
from ...linear_analysis.state_space import StateMatrix, state_matrix
from ...methods import NotebookMethods
from ...model.settings import RunSettings, Settings, takes_settings
from ...notes import Note, NoteKind, Severity, note_lines
from ...reading.files.quoted import MOST_LISTED
from ...redundancy.messages.redundancy import derivative_notes
from ...results.energy_balance import energy_balance
from ...results.solution import Solution
from ...solve.sampling import held
from ...tuning import in_use
from ..equilibrium import solution_of_rows
from ..job import Runnable
from ..settled import GROWING
from ..start_from import StartFrom
from ..steady import rotation_as_one
from .at_state import AtState, at_state
from .kink import Kink, linearised_at
from .modes_table import mode_lines

ON_A_SCREEN = 20
"""Number of modes that are printed, so that they fit on a screen."""
AT_REST = 1e-6
"""Acceleration below which a state counts as an equilibrium, relative to gravity (to 1 m/s^2 without gravity)."""


@dataclass(frozen=True)
class Modes(NotebookMethods):
    """Natural modes about a state.

    Attributes
    ----------
    name : str
    t : float
        Time of the state, s.
    degrees_of_freedom : int
        Number of free velocities, which is the number of modes.
    modes : tuple of Mode
        Modes by undamped natural frequency.
    state : StateMatrix
        The state matrix.
    notes : tuple of str
        Notes on the state, one sentence each.
    about : AtState
        The model at that state.
    own_axes : sparse array, shape (n_u, n_u)
        Transformation from ground axes, used by shapes, to the axes of u.
    sides : tuple of StateMatrix
        The state matrices of both sides if the state lies on a breakpoint of a force, else empty.
    """

    name: str
    t: float
    degrees_of_freedom: int
    modes: tuple[Mode, ...]
    state: StateMatrix
    notes: tuple[str, ...]
    about: AtState
    own_axes: csr_array
    sides: tuple[StateMatrix, ...] = ()

    def __repr__(self) -> str:
        return f"<Modes {self._head}>"

    def __str__(self) -> str:
        return self.table(ON_A_SCREEN)

    @property
    def _head(self) -> str:
        count = self.degrees_of_freedom
        return f"{self.name or 'model'} at t = {self.t:g} s: {count} degree{'s' if count != 1 else ''} of freedom"

    def table(self, most: int | None = None) -> str:
        """Return frequency, damping, eigenvalues and participating bodies of each mode as lines of text, and the notes.

        Parameters
        ----------
        most : int, optional
            Number of modes; by default all.  Printed modes are the first 20.
        """
        return "\n".join([self._head, *mode_lines(self.modes, most), *note_lines(self.notes)])

    def shape(self, number: int, amplitude: float = 0.1, points: int = 61) -> Solution:
        """Return one period of a mode as results over time, which can be drawn and saved like those of a run.

        Parameters
        ----------
        number : int
            Number of the mode; 1 for the slowest.
        amplitude : float
            Largest displacement, or rotation times the mechanism's size, relative to that size.
        points : int
            Number of instants, both ends included.

        Raises
        ------
        InputError
            If there is no such mode.
        SolverError
            If the mechanism cannot move so far.
        """
        if not 1 <= number <= len(self.modes):
            raise InputError(f"mode {number}: found no such mode, expected one of 1 to {len(self.modes)}")
        return mode_shape(self.about, self.own_axes, self.modes[number - 1], number, amplitude, points)

    def as_dict(self, scene: str) -> dict[str, object]:
        """Return the content of ``stiffmbs modes --json``; `scene` is the file or name of the scene."""
        return {
            "scene": scene, "t": self.t, "degrees_of_freedom": self.degrees_of_freedom,
            "modes": [mode.as_dict() for mode in self.modes], "notes": list(self.notes),
        }  # fmt: skip


@takes_settings
@on_drafts()
def modes(
    model: Runnable,
    settings: RunSettings | None = None,
    at: float | None = None,
    start_from: StartFrom | None = None,
    **changes: Unpack[Settings],
) -> Modes:
    """Compute natural frequencies, damping and mode shapes of a model, linearised about a state on its constraints.

    Parameters
    ----------
    model : Model, Scene, str or Path
        A model, a scene, or a scene's file.
    settings : RunSettings, optional
        Settings of the run to the state; by default those of the scene.
    at : float, optional
        Time of the state, s; the start of the run by default.
    start_from : Solution, str, Path or SavedState, optional
        As for `stiffmbs.run`.
    **changes
        Fields of the settings to change.

    Returns
    -------
    Modes
        One mode per degree of freedom.

    Raises
    ------
    InputError, AssemblyError
        As for `stiffmbs.run`.
    SolverError
        If the run does not reach that time, or a free motion has no mass.
    """
    found = at_state(model, settings, at, start_from, **changes)
    with in_use(found.settings.tuning):
        return _of_state(found)


def _of_state(found: AtState) -> Modes:
    system = found.dynamics.system
    scale = system.per_velocity(system.size, 1.0)
    linear, state, kink = linearised_at(found, scale)
    shapes = tuple(natural_modes(state, linear.mass, system.bodies, scale))
    sides = () if kink is None else tuple(state_matrix(side, scale) for side in kink.sides)
    of_sides = [natural_modes(side, linear.mass, system.bodies, scale) for side in sides]
    notes = (*_notes(found, state), *([] if kink is None else [_kink_note(kink, of_sides)]))
    return Modes(
        found.data.name, found.t, state.degrees_of_freedom, shapes, state, notes, found, linear.own_axes, sides
    )


KINK = NoteKind(
    "state-on-breakpoint",
    "the state lies on a breakpoint of a force on {element}, or within a millionth of the mechanism's size of one: the modes "
    "are those of one side; eigenvalues: {one} on one side, {other} on the other",
)
NO_EQUILIBRIUM = NoteKind(
    "modes-of-a-motion",
    "the state at t = {t:g} s is not an equilibrium: {element} = {value:.3g}; the frequencies hold at this time only, and "
    "they depend on the coordinates: here displacements are relative to the size of the mechanism, {size:.3g} m, and rotations are in rad",
)
ROTATING = NoteKind(
    "modes-in-ground-axes",
    "all bodies rotate as one, and the modes are in ground axes; those in the rotating frame are the eigenvalues of "
    "stiffmbs.equilibrium(..., motion=SteadyMotion(rotation={rotation}, about={about}))",
)
ROLLING = NoteKind(
    "rolling-modes",
    "nonholonomic constraints, such as rolling, leave {ways} without a free velocity; zero eigenvalues of these are not modes",
    severity=Severity.REMARK,
)
SINGULAR = NoteKind(
    "modes-at-singular-pose", "the state is a singular pose: {extra} more degrees of freedom than elsewhere"
)


def _kink_note(kink: Kink, sides: list[list[Mode]]) -> Note:
    """Return a note with the eigenvalues of both sides of a breakpoint, those that differ most."""
    pairs = [(a.eigenvalues[0], b.eigenvalues[0]) for a, b in zip(*sides, strict=False)]
    none = GROWING * max((abs(each) for pair in pairs for each in pair), default=0.0) or 1.0
    pairs.sort(key=lambda pair: -abs(pair[0] - pair[1]) / (abs(pair[0]) + abs(pair[1]) + none))
    listed = [", ".join(f"{pair[k]:.4g}" for pair in pairs[:MOST_LISTED]) for k in (0, 1)]
    return KINK(kink.where, one=listed[0], other=listed[1])


def _notes(found: AtState, state: StateMatrix) -> Iterator[Note]:
    system = found.dynamics.system
    sizes = np.abs(found.acceleration) * system.per_velocity(1.0, system.size)
    if sizes.size and sizes.max() > AT_REST * (float(np.linalg.norm(found.data.gravity)) or 1.0):
        most = int(np.argmax(sizes))
        name = system.name_of(most, system.of_body.accelerations)
        yield NO_EQUILIBRIUM(name, t=found.t, value=found.acceleration[most], size=system.size)
        turning = rotation_as_one(found.data, found.dynamics, found.dynamics.state.u)
        if turning is not None and not system.has_coupled_inertia:
            yield ROTATING(rotation=turning[0], about=turning[1])
    rolling = state.n_poses - state.degrees_of_freedom
    if rolling:
        ways = "one pose variation" if rolling == 1 else f"{rolling} pose variations"
        yield ROLLING(ways=ways)
    extra = state.degrees_of_freedom - found.redundancy.degrees_of_freedom
    if extra > 0:
        yield SINGULAR(extra=extra)
    yield from derivative_notes(found.redundancy, ())
    yield from held(system)


UNHURRIED = 1.0
"""Period shown for a mode that does not oscillate, s."""


def mode_shape(found: AtState, own_axes: csr_array, mode: Mode, number: int, amplitude: float, points: int) -> Solution:
    """Return one period of a mode about a state, at constant amplitude; parameters and errors as for `Modes.shape`.

    `own_axes` transforms from ground axes to the axes of u.
    """
    dynamics, state = found.dynamics, found.dynamics.state
    system = dynamics.system
    oscillates = mode.motion is Motion.OSCILLATING
    rate = abs(mode.eigenvalues[0].imag) if oscillates else 2 * np.pi / UNHURRIED
    time = np.linspace(0.0, 2 * np.pi / rate, points)
    turning = np.exp(1j * rate * time)[:, None] * (mode.shape if oscillates else -1j * mode.shape.real)
    size = amplitude * system.size
    q, u = state.q.copy(), state.u.copy()
    moved = np.array([system.of_body.moved(q, own_axes @ move) for move in size * turning.real])
    rates = np.array([u + own_axes @ way for way in size * (1j * rate * turning).real])
    with state.unchanged():
        rows = dynamics.report(np.full(points, found.t), moved, rates, project=True)
    if len(rows.t) < points:
        raise SolverError(
            f"mode {number} cannot be shown with an amplitude of {amplitude:g} of the mechanism's size: "
            f"{failure(dynamics, rows.status, found.t)}; expected a smaller amplitude"
        )
    message = f"mode {number}, forward and back"
    if oscillates:
        message = f"one period of mode {number}, {mode.natural_frequency:.6g} Hz"
    solution = solution_of_rows(
        f"{found.data.name or 'model'}, mode {number}", found.data, system, rows, found.redundancy.not_unique, message, (),
        {"name": "modes", "steps": 0},
    )  # fmt: skip
    return replace(solution, time=time, balance=energy_balance(system, replace(rows, t=time)))
