"""Stable equilibrium of a system, with notes on unstable ones found by the search."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..compile.system import System
from ..dynamics.algebraic_states import failure
from ..dynamics.dynamics import Dynamics
from ..dynamics.initial import InitialValues
from ..elements.joints.drive import Drive
from ..equilibria.equilibrium import Equilibrium, find_equilibrium
from ..equilibria.force_balance import balance_at, forces_by_velocity
from ..equilibria.steady_motion import at_rest
from ..errors import SolverError
from ..linear_analysis.eigenvalues import eigen
from ..linear_analysis.stability import lowest
from ..linear_analysis.state_space import state_matrix
from ..notes import Note, NoteKind, Severity
from ..reading.files.quoted import listed
from ..results.scales import ROUNDING
from .far_away import beyond_its_size, far_away
from .linearised.kink import MOVES, ForceJumpError, Instant, Kink, Moves, linearised_at

MOST_FOR_EIGENVALUES = 1500
"""Largest number of velocities for eigenvalues (dense matrices)."""
BRANCH = 1e-3
"""Move along an unstable direction, relative to the mechanism's size, or rad, from which a stable pose is sought."""
MOST_BRANCHES = 3
SAME_MOTION = 1e-8
"""Singular value of free motions, relative to the largest, up to which they are linearly dependent."""
LARGE_PART = 0.5
"""Size of a velocity, relative to the largest in free motions, above which the first such velocity names the motion."""
GROWING = 1e-6
"""Real part above which a motion grows, relative to the largest eigenvalue: the accuracy of double zeros."""
ROUNDED = 1e-10
"""Real part above which an eigenvalue is unstable, relative to the largest magnitude, in addition to `GROWING` of its own."""

UNCHECKED_START = NoteKind(
    "equilibrium-not-checked", "the stability of the equilibrium at the start was not checked", severity=Severity.REMARK
)
UNCHECKED = NoteKind("stability-not-checked", "{law}the dynamic stability of the equilibrium was not checked: {reason}")
UNSTABLE = NoteKind(
    "unstable-equilibrium", "the equilibrium is unstable{where}: disturbances grow at {rate:.3g} 1/s{how}"
)
NO_STABLE = NoteKind(
    "no-stable-equilibrium", "the equilibrium is unstable in {element}, and no stable one was found near it"
)
ALSO_UNSTABLE = NoteKind("no-stable-branch", "this equilibrium is also unstable; no stable one was found near it")
BRANCHED = NoteKind(
    "equilibrium-branch",
    "an equilibrium nearer to the described pose is unstable in {element}; of {branches} from it, this is the one towards "
    "{sign} {element}",
)
FREE = NoteKind(
    "free-motion", "no force determines {motions}: the equilibrium nearest to the described pose is given",
    severity=Severity.REMARK,
)  # fmt: skip
FAMILY = NoteKind(
    "not-isolated",
    "{constrain} velocities alone and can hold many poses at rest: the equilibrium given is one of them, which depends on "
    "the described pose",
)

FARTHER = replace(MOVES, wide=10 * MOVES.wide, narrow=10 * MOVES.narrow)
"""Perturbations to more distant states on both sides of a breakpoint, whose eigenvalues show the effect of the distance."""
BY_DISTANCE = (FARTHER.wide / MOVES.wide) ** 0.25
"""Ratio of the growth in more distant states above which it vanishes at the breakpoint: that of double zeros, which change
with the root of the distance, has the square of it."""


@dataclass(frozen=True)
class Settled:
    """System in an equilibrium."""

    start: InitialValues  # initial values of a run from there
    moves: int  # number of moves of the search
    imbalance: float  # largest remaining generalised force, relative to the largest acting one
    free: tuple[str, ...]  # largest velocity of each motion that nothing resists
    notes: tuple[Note, ...]
    # eigenvalues of perturbations of a steady motion, 1/s, in the frame that moves with it; empty at rest
    eigenvalues: tuple[complex, ...] = ()


def settled(dynamics: Dynamics, start: InitialValues, t: float) -> Settled:
    """Find a stable equilibrium from the pose of `start`, with notes on unstable ones and on free motions."""
    system, state = dynamics.system, dynamics.state
    state.q[:] = start.q
    found = find_equilibrium(dynamics, t)
    notes = list(_family(system))
    if system.states:
        return _settled(dynamics, found, start, [*notes, *_growth(dynamics, t)])
    for _ in range(MOST_BRANCHES):
        unstable, free = _directions(dynamics, t)
        if unstable is None:
            held = [FREE(free[0], motions=", ".join(free))] if free else []
            return _settled(dynamics, found, start, [*notes, *held, *_growth(dynamics, t)], free)
        poses = [_branch(dynamics, found, sign * unstable, t) for sign in (1.0, -1.0)]
        notes.append(_branch_note(dynamics, unstable, poses))
        if not any(poses):
            return _settled(dynamics, found, start, notes)
        found = next(pose for pose in poses if pose is not None)
        state.q[:] = found.q
    return _settled(dynamics, found, start, [*notes, ALSO_UNSTABLE()])


def driven_in_equilibrium(dynamics: Dynamics, start: InitialValues, t: float) -> InitialValues:
    """Find a stable equilibrium, and move from there as drives prescribe, with the smallest velocities in the mass matrix.

    Raise a SolverError if no equilibrium is found, or the velocities have no accelerations there.
    """
    system, state = dynamics.system, dynamics.state
    found = settled(dynamics, start, t).start
    state.q[:], state.u[:] = found.q, found.u
    state.evaluate("motion", t)
    if not np.any(state.vector("motion", "V")[system.active]):
        return found
    return _moving(dynamics, found, "the velocities of drives", t)


def moving_in_equilibrium(dynamics: Dynamics, start: InitialValues, t: float) -> InitialValues:
    """Find the equilibrium pose at rest and make the described velocities consistent there: a car that begins to roll.

    Raise a SolverError if no equilibrium is found, or the velocities have no accelerations there.
    """
    state = dynamics.state
    state.q[:] = start.q
    found = find_equilibrium(dynamics, t)
    state.q[:], state.u[:] = found.q, start.u
    notes = (*start.far_notes(), UNCHECKED_START(), *far_away(dynamics, start, found))
    return _moving(dynamics, replace(start, q=found.q, moved=(), notes=notes), "the described velocities", t)


def _moving(dynamics: Dynamics, start: InitialValues, velocities: str, t: float) -> InitialValues:
    """Return a start with the current velocities made consistent in its pose; `velocities` names them in the error."""
    state = dynamics.state
    status = min(dynamics.correct_velocities(t), 0)
    state.restart_counters(t)
    acceleration = start.acceleration
    if status == 0:
        status, acceleration = dynamics.accelerate(t)
    if status < 0:
        raise SolverError(f"{velocities} are not possible in the equilibrium: {failure(dynamics, status, t)}")
    lam = state.lam[: dynamics.system.n_c].copy()
    return replace(start, u=state.u.copy(), acceleration=acceleration, lam=lam)


def _settled(
    dynamics: Dynamics, found: Equilibrium, start: InitialValues, notes: Sequence[Note], free: Sequence[str] = ()
) -> Settled:
    notes = (*notes, *beyond_its_size(dynamics, start, found))
    resting = replace(
        start, q=found.q, u=found.u, acceleration=found.acceleration, lam=found.lam, moved=(),
        notes=(*start.far_notes(), *notes),
    )  # fmt: skip
    return Settled(resting, found.moves, found.imbalance, tuple(free), notes)


def _family(system: System) -> Iterator[Note]:
    """Yield a note if constraints of velocities alone carry forces, so that equilibria are not isolated.

    A drive that prescribes a velocity keeps its coordinate at the described value.
    """
    drives = {name for group in system.groups if issubclass(group.kind.element, Drive) for name in group.names}
    rows = np.flatnonzero(system.active & ~system.holonomic)
    names = [name for name in dict.fromkeys(system.equations[row][0] for row in rows) if name not in drives]
    if names:
        yield FAMILY(names[0], constrain=f"{listed(names)} constrain{'s' * (len(names) == 1)}")


def _growth(dynamics: Dynamics, t: float) -> Iterator[Note]:
    """Yield a note if an equilibrium is dynamically unstable, or if this was not assessed."""
    system = dynamics.system
    if not (system.states or system.n_event_functions) and _is_conservative(dynamics, t):
        return  # static stability is sufficient away from breakpoints
    if system.n_u > MOST_FOR_EIGENVALUES:
        reason = f"the model has {system.n_u} velocities, more than {MOST_FOR_EIGENVALUES}"
        yield UNCHECKED(law="", reason=reason)
        return
    _, acceleration = dynamics.accelerate(t)
    instant = Instant(dynamics, t, acceleration)
    try:
        growing, kink = _growing(instant, MOVES)
        if kink is not None and len(growing):
            farther, _ = _growing(instant, FARTHER)
            if np.max(farther.real, initial=0.0) > BY_DISTANCE * np.max(growing.real):
                return
    except SolverError as error:
        jumps = isinstance(error, ForceJumpError)
        law = "a law has its value at exactly this state, while sign(v) at rest can hold many poses; " if jumps else ""
        yield UNCHECKED(law=law, reason=error)
        return
    if len(growing):
        fastest = growing[np.argmax(growing.real)]
        how = f" and oscillate at {abs(fastest.imag) / (2 * np.pi):.3g} Hz" if fastest.imag else ""
        where = "" if kink is None else f" on one side of a breakpoint of a force on {kink.where}"
        yield UNSTABLE(where=where, rate=fastest.real, how=how)


def _growing(instant: Instant, moves: Moves) -> tuple[np.ndarray, Kink | None]:
    """Return the eigenvalues of growing motions, 1/s, and the breakpoint at the state; of both sides on a breakpoint."""
    system = instant.dynamics.system
    scale = system.per_velocity(system.size, 1.0)
    _, state, kink = linearised_at(instant, scale, moves)
    found = []
    for side in [state] if kink is None else [state_matrix(side, scale) for side in kink.sides]:
        values, _, _ = eigen(side.matrix, side.n_poses, side.n_states)
        sizes = np.abs(values)
        found.append(values[values.real > growth_by_rounding(sizes, np.max(sizes, initial=0.0))])
    return np.concatenate(found), kink


def growth_by_rounding(sizes: np.ndarray | float, largest: float) -> np.ndarray | float:
    """Return the real parts, 1/s, that rounding may give eigenvalues of some magnitudes, the largest of all given too."""
    return GROWING * sizes + ROUNDED * largest


def _is_conservative(dynamics: Dynamics, t: float) -> bool:
    """Return True if no force depends on velocities and the stiffness is symmetric."""
    stiffness = balance_at(dynamics, t, at_rest(dynamics.system.of_body.dimensions)).stiffness
    if abs(forces_by_velocity(dynamics)).max():
        return False
    return bool(abs(stiffness - stiffness.T).max() <= ROUNDING * abs(stiffness).max())


def _directions(dynamics: Dynamics, t: float) -> tuple[np.ndarray | None, list[str]]:
    """Return the most unstable direction (as velocities) or None, and the names of free velocities."""
    system = dynamics.system
    known = balance_at(dynamics, t, at_rest(system.of_body.dimensions))
    scale = system.per_velocity(system.size, 1.0)
    found = lowest(known.stiffness, known.jacobian, system.mass, scale, known.left)
    for shape in found.unstable.T:
        return shape / np.max(np.abs(shape / scale)), []
    return None, system.names_of(_independent(found.free / scale[:, None]), system.of_body.velocities)


def _independent(shapes: np.ndarray) -> Iterator[int]:
    """Yield the index of a velocity for each independent motion; it does not depend on how the motions are combined."""
    basis, sizes, _ = np.linalg.svd(
        shapes / np.maximum(np.linalg.norm(shapes, axis=0), np.finfo(float).tiny), full_matrices=False
    )
    rest = basis[:, sizes > SAME_MOTION * np.max(sizes, initial=0.0)]
    for _ in range(rest.shape[1]):
        size = np.linalg.norm(rest, axis=1)
        k = int(np.argmax(size >= LARGE_PART * np.max(size)))
        yield k
        along = rest[k] / size[k]
        rest = rest - np.outer(rest @ along, along)


def _branch(dynamics: Dynamics, found: Equilibrium, direction: np.ndarray, t: float) -> Equilibrium | None:
    """Return the equilibrium reached after a small move along a direction, or None."""
    dynamics.state.q[:] = dynamics.system.of_body.moved(found.q, BRANCH * direction)
    dynamics.assemble(t)
    try:
        return find_equilibrium(dynamics, t, since=found.q)
    except SolverError:
        return None


def _branch_note(dynamics: Dynamics, direction: np.ndarray, poses: list[Equilibrium | None]) -> Note:
    scale = dynamics.system.per_velocity(dynamics.system.size, 1.0)
    label = dynamics.system.name_of(int(np.argmax(np.abs(direction / scale))), dynamics.system.of_body.velocities)
    count = sum(pose is not None for pose in poses)
    if not count:
        return NO_STABLE(label)
    sign = "positive" if poses[0] is not None else "negative"
    return BRANCHED(label, branches=f"{count} branch{'es' if count > 1 else ''}", sign=sign)
