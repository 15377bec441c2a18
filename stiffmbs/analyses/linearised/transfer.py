"""Linearised model with named inputs and outputs: state space and frequency response."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Unpack

import numpy as np

from ...dynamics.dynamics import Dynamics
from ...elements.requests.order import reading
from ...elements.requests.output import Term
from ...errors import InputError, SolverError, refuse_text
from ...linear_analysis.state_space import StateMatrix
from ...linear_analysis.tangent_space import Linearised
from ...linear_analysis.transfer import Input, Transfer, effect
from ...model.model_data import ModelData
from ...model.settings import RunSettings, Settings, takes_settings
from ...reading.did_you_mean import did_you_mean
from ...redundancy.messages.redundancy import derivative_notes
from ...results.channels import channels_of
from ...tuning import in_use
from ..job import Runnable, prepare
from ..start_from import StartFrom
from .at_state import AtState, at_state
from .inputs import ForceOnBody, Parameterised, force_on
from .kink import linearised_at

PLACES = ("dx", "dy", "dz", "dm", "ax", "ay", "az", "psi", "theta", "phi", "q0", "q1", "q2", "q3")
"""Measures of displacements and angles."""
NO_RATE = 1e-6
"""Change of a prescribed velocity per unit of an input below which it counts as zero, m/s or rad/s."""
STEP = float(np.cbrt(np.finfo(float).eps))
"""Perturbation for derivatives of outputs, relative to the mechanism's size, 1 rad or the largest force.

Central differences: Press et al., Numerical Recipes, 3rd ed., sec. 5.7.
"""


@dataclass(frozen=True)
class _About:
    """Model linearised about a state, with the data to differentiate outputs."""

    found: AtState
    linear: Linearised
    state: StateMatrix
    scale: np.ndarray


@takes_settings
def transfer(
    model: Runnable,
    inputs: Sequence[str] | Mapping[str, Parameterised],
    outputs: Sequence[str],
    settings: RunSettings | None = None,
    at: float | None = None,
    start_from: StartFrom | None = None,
    **changes: Unpack[Settings],
) -> Transfer:
    """Linearise a model about a state, from inputs to channels.

    Parameters
    ----------
    model : Model, Scene, str or Path
        A model, a scene, or a scene's file.
    inputs : sequence of str, or mapping of str to callable
        Forces and torques on bodies in ground axes, such as ``"chassis.fy"`` or ``"bar.end.fx"``; or a mapping of any
        names to the model as a function of the input, zero at the state: the height of a road, a steering angle.
    outputs : sequence of str
        Channels and requests.
    settings, at, start_from, **changes
        As for `stiffmbs.analyses.linearised.modes.modes`.

    Raises
    ------
    InputError
        If an input or output is unknown, there is no output, or an output depends on the rate of an input that moves a constraint.
    SolverError, AssemblyError
        As for `stiffmbs.analyses.linearised.modes.modes`.
    """
    refuse_text("inputs", inputs, "forces on bodies")
    refuse_text("outputs", outputs, "channels")
    if not outputs:
        raise InputError("outputs: found none, expected one channel or more")
    found = at_state(model, settings, at, start_from, **changes)
    with in_use(found.settings.tuning):
        return _of_state(found, inputs, outputs, changes)


def _of_state(
    found: AtState, inputs: Sequence[str] | Mapping[str, Parameterised], outputs: Sequence[str], changes: Settings
) -> Transfer:
    system = found.dynamics.system
    scale = system.per_velocity(system.size, 1.0)
    linear, state, kink = linearised_at(found, scale)
    if kink is not None:
        raise SolverError(
            f"the state at t = {found.t:g} s lies on a breakpoint of a force on {kink.where}, or within a millionth of the mechanism's "
            "size of one, where the linearised equations of both sides differ; expected a state away from it, or a smooth law "
            "(`modes` has the state matrices of both sides)"
        )
    about = _About(found, linear, state, scale)
    nothing, as_they_are = np.zeros((1, system.n_u)), np.zeros((1, len(system.states)))
    at_zero = _channels(about, found.dynamics, nothing, nothing, as_they_are, outputs)[0]
    given = inputs if isinstance(inputs, Mapping) else {name: force_on(found.data, name) for name in inputs}
    columns = [_column(about, name, of_input, outputs, changes) for name, of_input in given.items()]
    n = len(about.state.matrix)
    return Transfer(
        a=about.state.matrix,
        b=np.array([rates for rates, _ in columns]).reshape(-1, n).T,
        c=_differentiated(about, outputs),
        d=np.array([through for _, through in columns]).reshape(-1, len(outputs)).T,
        inputs=tuple(inputs),
        outputs=tuple(outputs),
        at=at_zero,
        notes=tuple(derivative_notes(found.redundancy, outputs)),
    )


def _column(
    about: _About, name: str, given: Parameterised, outputs: Sequence[str], changes: Settings
) -> tuple[np.ndarray, np.ndarray]:
    """Return the derivatives of z' and of the outputs by an input, from the models on both sides of the state."""
    system = about.found.dynamics.system
    of_force = isinstance(given, ForceOnBody)
    step = STEP * _largest_force(about) if of_force else STEP * max(1.0, system.size)
    sides = [_with_value(about, name, given, value, changes) for value in (-step, step)]
    (force, gap, rate, of_states), (more, wider, faster, other) = (_acting(about, side) for side in sides)
    if np.any(np.abs(faster - rate) > NO_RATE * 2 * step):
        raise InputError(
            f"input '{name}': found a velocity that a joint prescribes, expected a force, a displacement or a length; "
            "prescribe the displacement"
        )
    own = about.linear.own_axes
    forces, rates = about.linear.algebraic.passed_on(own.T @ (more - force), other - of_states)
    change = Input(name, forces / (2 * step), (wider - gap) / (2 * step), rates / (2 * step))
    acts = effect(about.linear, about.state, change, about.scale)
    moved = np.outer((-step, step), acts.pose), np.outer((-step, step), acts.velocity)
    same = np.zeros((1, len(system.states)))
    values = [
        _channels(about, side, x[None], v[None], same, outputs)[0] for side, x, v in zip(sides, *moved, strict=True)
    ]
    if np.any(acts.velocity_of_rate):
        _refuse_rates(about, name, outputs)
    return acts.rates, (values[1] - values[0]) / (2 * step)


def _largest_force(about: _About) -> float:
    """Return the largest applied force or reaction on a body at the state, at least 1 N or N m."""
    state = about.found.dynamics.state
    state.evaluate("motion", about.found.t)
    reactions = np.abs(state.matrix("motion", "J").T) @ np.abs(state.lam[: about.found.dynamics.system.n_c])
    return float(max(1.0, np.max(reactions, initial=0.0), np.max(np.abs(state.vector("motion", "f")), initial=0.0)))


def _with_value(about: _About, name: str, given: Parameterised, value: float, changes: Settings) -> Dynamics:
    """Return the model for a value of an input, at the state of the linearisation."""
    job = prepare(given(value), **changes)
    system, state = job.dynamics.system, about.found.dynamics.state
    own = about.found.dynamics.system
    if (system.bodies, system.states, system.equations) != (own.bodies, own.states, own.equations):
        raise InputError(
            f"input '{name}': found that its value changes the mechanism, expected the same bodies and joints for all values"
        )
    job.dynamics.state.q[:], job.dynamics.state.u[:] = state.q, state.u
    job.dynamics.state.lam[:] = state.lam
    if not np.array_equal(system.principal_axes, own.principal_axes):
        raise InputError(
            f"input '{name}': found that it rotates the principal axes of a body, expected fixed principal axes"
        )
    return job.dynamics


def _acting(about: _About, dynamics: Dynamics) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return the residuals f - J^T lam - M u', those of position and velocity constraints, and the rates of states."""
    state, system = dynamics.state, dynamics.system
    active = about.found.dynamics.system.active
    state.evaluate("motion", about.found.t)
    reactions = state.matrix("motion", "J").T @ about.found.dynamics.state.lam[: system.n_c]
    inertia = system.mass * about.found.acceleration + state.matrix("motion", "inertia") @ about.found.acceleration
    left = state.vector("motion", "f") - reactions - inertia
    rates = state.vector("motion", "rate")[system.first_state :]
    return left, state.vector("motion", "C")[active & system.holonomic], state.vector("motion", "V")[active], rates


def _channels(
    about: _About, dynamics: Dynamics, x: np.ndarray, v: np.ndarray, s: np.ndarray, outputs: Sequence[str]
) -> np.ndarray:
    """Return the outputs at perturbed states, projected onto the constraints, one row each."""
    system, at = about.found.dynamics.system, about.found.dynamics.state
    own = about.linear.own_axes
    q = np.array([system.of_body.moved(at.q, own @ row) for row in x])
    q[:, system.first_state :] += s
    u = np.array([at.u + own @ row for row in v])
    with dynamics.state.unchanged():
        rows = dynamics.report(np.full(len(x), about.found.t), q, u, project=True)
    if len(rows.t) < len(x):
        raise SolverError("no accelerations were found near the state, expected one about which motions exist")
    channels = channels_of(about.found.data, dynamics.system, rows)
    for name in outputs:
        if name not in channels:
            raise InputError(
                f"output '{name}': found no such channel{did_you_mean(name, channels)}, expected one such as "
                f"{', '.join(list(channels)[:6])}"
            )
    return np.column_stack([channels[name] for name in outputs]).reshape(len(x), len(outputs))


def _differentiated(about: _About, outputs: Sequence[str]) -> np.ndarray:
    """Return C, the derivatives of the outputs by the state, as central differences of reported channels."""
    state = about.state
    of_states = about.linear.algebraic.among_all(np.eye(len(state.matrix))[len(state.matrix) - state.n_states :])
    parts = state.poses, state.velocities, of_states
    scales = np.concatenate([about.scale, about.scale, about.found.dynamics.system.state_scales])
    sizes = np.abs(np.vstack(parts) / scales[:, None]).max(axis=0)
    steps = STEP / np.maximum(sizes, np.finfo(float).tiny)
    x, v, own = (np.hstack([-part * steps, part * steps]).T for part in parts)
    values = _channels(about, about.found.dynamics, x, v, own, outputs)
    found: np.ndarray = ((values[len(steps) :] - values[: len(steps)]) / (2 * steps[:, None])).T
    return found


def _refuse_rates(about: _About, name: str, outputs: Sequence[str]) -> None:
    """Reject outputs that depend on the rate of an input that moves a constraint: their responses are improper.

    Displacements do not; velocities are i w times these, and accelerations and reactions depend on the input's
    acceleration.
    """
    system, data = about.found.dynamics.system, about.found.data
    rates = (*system.of_body.velocities, *system.of_body.accelerations)
    felt = {f"{body}.{label}" for body in system.bodies for label in rates}
    felt |= {f"{joint}.{label}" for joint in data.joints for label in system.of_body.reactions}
    felt |= reading(data.outputs(), felt, lambda term: _felt(term, data))
    for output in felt & set(outputs):
        raise InputError(
            f"output '{output}': found a velocity, acceleration or reaction, expected a displacement for the input '{name}', "
            "which moves a constraint; ask for the response of the displacement"
        )


def _felt(term: Term, data: ModelData) -> bool:
    """Return True if a term of a request is a velocity, an acceleration or a joint reaction."""
    return term.element in data.joints if term.element else term.function not in PLACES
