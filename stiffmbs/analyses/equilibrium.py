"""Static equilibrium of a model, and its equilibria over time."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Unpack

import numpy as np

from ..compile.machine.routines import on_drafts
from ..compile.system import System
from ..dynamics.algebraic_states import failure
from ..dynamics.dynamics import Dynamics, OutputRows
from ..elements.requests.order import units
from ..equilibria.equilibrium import Equilibrium, find_equilibrium
from ..errors import AssemblyError, SolverError, prefixed
from ..model.model_data import ModelData
from ..model.scene import Scene, notes_of
from ..model.settings import RunSettings, Settings, SteadyMotion, takes_settings
from ..notes import Note, NoteKind
from ..reading.files.quoted import listed
from ..results.channels import channels_of, turns_of
from ..results.energy_balance import energy_balance
from ..results.provenance import provenance_of
from ..results.solution import Solution
from ..solve.sampling import held
from ..solve.trajectory import History, Outcome
from ..tuning import in_use
from .checks import flexible_body_notes
from .job import Job, Runnable, data_of, prepare, with_elements
from .settled import Settled, settled
from .start_from import StartFrom
from .steady import settled_in_motion


def solution_at_rest(
    job: Job, t: np.ndarray, q: np.ndarray, u: np.ndarray, message: str, notes: Sequence[str], solver: dict[str, object]
) -> Solution:
    """Return the channels of equilibria with these instants, s, poses and velocities.

    Raise a SolverError if one has no reactions.
    """
    rows = job.dynamics.report(t, q, u, project=False)
    if len(rows.t) < len(t):
        first = t[len(rows.t)]
        raise SolverError(
            f"no reactions were found in the equilibrium at t = {first:g} s: {failure(job.dynamics, rows.status, first)}"
        )
    system = job.dynamics.system
    notes = (*notes, *flexible_body_notes(system, rows))
    not_unique = job.redundancy.not_unique
    found = solution_of_rows(job.data.name, job.data, system, rows, not_unique, message, notes, solver)
    return replace(found, provenance=provenance_of(job.data, job.settings, state=job.start_from))


def solution_of_rows(
    name: str, data: ModelData, system: System, rows: OutputRows, not_unique: tuple[str, ...], message: str,
    notes: Sequence[str], solver: dict[str, object],
) -> Solution:  # fmt: skip
    """Return the channels of rows that no integrator has computed."""
    nothing = np.empty(0)
    return Solution(
        name=name, time=rows.t, channels=channels_of(data, system, rows), outcome=Outcome.DONE, message=message, notes=tuple(map(Note.of, notes)),
        solver=solver, history=History(nothing, np.empty(0, dtype=int)), balance=energy_balance(system, rows),
        not_unique=not_unique, requested=units(data.outputs()), turns=turns_of(system, rows.q), provenance=provenance_of(data),
    )  # fmt: skip


@dataclass(frozen=True)
class EquilibriumFound:
    """Static equilibrium, or state of steady motion.

    Attributes
    ----------
    name : str
    t : float
        Time at which forces and drives are evaluated, s.
    channels : dict of str to float
        Poses of bodies, forces and torques of elements, energies, requests.
    moves : int
        Number of moves of the search.
    imbalance : float
        Largest remaining generalised force, relative to the largest acting one.
    moved : dict of str to (float, float)
        Distance of each body from its described pose: displacement of its centre of mass, m, and rotation, rad.
    free : tuple of str
        First body and its coordinate of each motion that nothing resists.
    notes : tuple of Note
    eigenvalues : tuple of complex
        Eigenvalues of perturbations of a steady motion, 1/s, in the frame that moves with it; empty at rest.
    solution : Solution
        Results of one instant: ``stiffmbs.run(model, start_from=found.solution)`` starts there.
    """

    name: str
    t: float
    channels: dict[str, float]
    moves: int
    imbalance: float
    moved: dict[str, tuple[float, float]]
    free: tuple[str, ...]
    notes: tuple[Note, ...]
    eigenvalues: tuple[complex, ...]
    solution: Solution

    def __repr__(self) -> str:
        return f"<EquilibriumFound '{self.name}': {len(self.channels)} channels, imbalance {self.imbalance:.1e}>"

    def as_dict(self, scene: str) -> dict[str, object]:
        """Return the content of ``stiffmbs equilibrium --json``; `scene` is the file or name of the scene."""
        return {
            "scene": scene, "status": "done", "message": self.solution.message,
            "imbalance": self.imbalance, "moved": self.moved, "channels": self.channels,
            "t": self.t, "free": list(self.free), "notes": list(self.notes),
            "eigenvalues": [[value.real, value.imag] for value in self.eigenvalues],
        }  # fmt: skip


@takes_settings
@on_drafts()
def equilibrium(
    model: Runnable,
    settings: RunSettings | None = None,
    start_from: StartFrom | None = None,
    motion: SteadyMotion | None = None,
    **changes: Unpack[Settings],
) -> EquilibriumFound:
    """Find the pose at rest, or in steady motion, in which all forces balance.

    Parameters
    ----------
    model : Model, Scene, str or Path
        A model, a scene, or a scene's file.
    settings : RunSettings, optional
        Forces and drives are evaluated at its start.
    start_from : Solution, str, Path or SavedState, optional
        State from whose pose the search starts, instead of the described one; as for `stiffmbs.run`.
    motion : SteadyMotion, optional
        Motion at constant speed or on a circle; by default that of a scene that starts in one.
    **changes
        Fields of the settings to change.

    Returns
    -------
    EquilibriumFound

    Raises
    ------
    InputError, AssemblyError
        As for `stiffmbs.run`.
    SolverError
        If there is no equilibrium or none is found; the message names the body with the largest imbalance.
    """
    data = data_of(model)
    data = with_elements(data, lambda scene: equilibrium(scene, settings, start_from, motion, **changes).solution)
    if isinstance(data, Scene):
        motion = motion or (data.start if isinstance(data.start, SteadyMotion) else None)
        data = data.model_copy(update={"start": "described"})
    job = prepare(data, settings, start_from, **changes)
    found = _settled(job, motion)
    system, start = job.dynamics.system, found.start
    how = {"name": "equilibrium", "moves": found.moves, "imbalance": found.imbalance}
    times = np.array([job.grid.start])
    assembly = [job.start.position_sentence(3)] if job.start.moved_far else []
    notes = (*notes_of(job.data), *assembly, *found.notes)
    if motion is None:
        notes = (*notes, *_resting_drives(job.dynamics, times))
    solution = solution_at_rest(job, times, start.q[None], start.u[None], _message(found), notes, how)
    moves = system.move(job.start.q, found.start.q).reshape(len(system.bodies), -1)
    straight, turned = (np.linalg.norm(part, axis=1) for part in np.split(moves, [system.of_body.linear], axis=1))
    moved = dict(zip(system.bodies, zip(straight.tolist(), turned.tolist(), strict=True), strict=True))
    kept = {name: float(values[0]) for name, values in solution.items()}
    return EquilibriumFound(
        job.data.name,
        job.grid.start,
        kept,
        found.moves,
        found.imbalance,
        moved,
        found.free,
        solution.notes,
        found.eigenvalues,
        solution,
    )


def _settled(job: Job, motion: SteadyMotion | None) -> Settled:
    with in_use(job.settings.tuning):
        if motion is None:
            found = settled(job.dynamics, job.start, job.grid.start)
        else:
            found = settled_in_motion(job.data, job.dynamics, job.start, job.grid.start, motion)
    return replace(found, notes=(*found.notes, *held(job.dynamics.system)))


def _message(found: Settled) -> str:
    how = "in steady motion" if np.any(found.start.u) else "at rest in equilibrium"
    return f"{how} after {found.moves} moves"


@takes_settings
def quasi_static(model: Runnable, settings: RunSettings | None = None, **changes: Unpack[Settings]) -> Solution:
    """Compute static equilibria at all output instants, each from the pose of the previous one.

    Forces, drives and tables of time are assumed to change slowly: forces that depend on velocities have no effect.

    Parameters
    ----------
    model : Model, Scene, str or Path
    settings : RunSettings, optional
        Settings with the output instants; by default those of the scene.
    **changes
        Fields of the settings to change.

    Returns
    -------
    Solution
        All channels over the output instants.

    Raises
    ------
    InputError, AssemblyError
        As for `stiffmbs.run`.
    SolverError
        If no equilibrium is found; the message names the instant.
    """
    data = with_elements(data_of(model), lambda scene: quasi_static(scene, settings, **changes))
    if isinstance(data, Scene):
        data = data.model_copy(update={"start": "described"})
    job = prepare(data, settings, **changes)
    times = job.grid.times if job.grid.times is not None else np.linspace(job.grid.start, job.grid.end, 101)
    found = [*equilibria_over_time(job, times)]
    q, u = (np.array([getattr(each, name) for each in found]) for name in ("q", "u"))
    moves = sum(each.moves for each in found)
    solver = {"name": "quasi_static", "moves": moves, "imbalance": max(each.imbalance for each in found)}
    notes = tuple(_resting_drives(job.dynamics, times))
    return solution_at_rest(job, times, q, u, f"{len(times)} equilibria after {moves} moves", notes, solver)


RESTING_DRIVES = NoteKind(
    "resting-drives",
    "equilibria are at rest: the velocities of {drives} have no effect, and move nothing from one time to another",
)


def _resting_drives(dynamics: Dynamics, times: np.ndarray) -> Iterator[Note]:
    """Yield a note if constraints prescribe velocities, which have no effect on equilibria."""
    system, state = dynamics.system, dynamics.state
    state.u[:], moving = 0.0, np.zeros(system.n_c, dtype=bool)
    for t in times:
        state.evaluate("motion", float(t))
        moving |= state.vector("motion", "V") != 0.0
    rows = np.flatnonzero(moving & system.active & ~system.holonomic)
    if names := [*dict.fromkeys(system.equations[row][0] for row in rows)]:
        yield RESTING_DRIVES(names[0], drives=listed(names))


def equilibria_over_time(job: Job, times: np.ndarray) -> Iterator[Equilibrium]:
    """Yield the equilibria at given times, s, each from the pose of the previous one; the state is set to it.

    Raises AssemblyError, SolverError as for `quasi_static`.
    """
    job.dynamics.state.q[:] = job.start.q
    for t in times:
        with in_use(job.settings.tuning):
            found = _next(job.dynamics, float(t))
        yield found


def _next(dynamics: Dynamics, t: float) -> Equilibrium:
    """Find the equilibrium at a given time from the current pose, and move the state to it."""
    before = dynamics.state.q.copy()
    status = dynamics.assemble(t)
    if status < 0:
        raise AssemblyError(f"t = {t:g} s: the constraints do not meet: {failure(dynamics, status, t)}")
    with prefixed(f"t = {t:g} s: ", SolverError, SolverError):
        return find_equilibrium(dynamics, t, since=before)
