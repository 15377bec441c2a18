"""Inputs and outputs about a state: z' = A z + B p, y = C z + D p, and the frequency response.

An input p that moves a constraint, such as the displacement of a drive, shifts the poses by X p with G X + C_p = 0.
With L^T M X = 0 and b the variation of v - X p' - N B_1 p, the equations contain neither p' nor p''.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.linalg import matrix_balance, schur

from ..errors import InputError
from .eigenvalues import is_singular
from .parameters import LINEAR_ANALYSIS
from .state_space import StateMatrix
from .tangent_space import Linearised

if TYPE_CHECKING:
    from scipy.signal import StateSpace


@dataclass(frozen=True)
class Input:
    """Input of the linearised equations, per unit.

    `force` of shape (n_u,): generalised forces, ground axes. `position` of shape (holonomic,): C_p, the change of the
    position constraints. `rates` of shape (states,): rates of the user-defined states.
    """

    name: str
    force: np.ndarray
    position: np.ndarray
    rates: np.ndarray


@dataclass(frozen=True)
class Effect:
    """Effect of an input on the free variations.

    `rates` of shape (n,): B: z' per unit of the input. `pose`, `velocity` of shape (n_u,): x and v per unit of the
    input, at z = 0. `velocity_of_rate` of shape (n_u,): v per unit of the input's rate.
    """

    rates: np.ndarray
    pose: np.ndarray
    velocity: np.ndarray
    velocity_of_rate: np.ndarray


def effect(linear: Linearised, state: StateMatrix, given: Input, scale: np.ndarray) -> Effect:
    """Return the effect of an input on the free variations, poses and velocities.

    Raises InputError when a state depends on the rate or reaction of an input that moves a constraint.
    It is raised, too, when constraints depend on states and the input is not a force.
    """
    if np.any(linear.position_by_states) and (np.any(given.rates) or np.any(given.position)):
        raise InputError(
            f"input '{given.name}': found an input of rates of states or of a constraint in a scene whose constraints depend on states, "
            "expected a force"
        )
    n_a, end = state.n_poses, state.n_poses + state.degrees_of_freedom
    of_velocities = slice(n_a, end)
    free, forced = state.velocities[:, of_velocities], state.forced[of_velocities]
    poses = state.poses[:, :n_a]
    nothing = np.zeros(len(scale))
    if not np.any(given.position):
        own = np.concatenate([np.zeros(end), given.rates])
        return Effect(state.forced @ given.force + own, nothing, nothing, nothing)
    shift = scale * np.linalg.lstsq(linear.position * scale, -given.position, rcond=1e-9)[0]
    shift = shift - free @ (forced @ (linear.mass @ shift))
    if np.any(linear.rate_by_velocity @ shift) or np.any(linear.rate_by_reactions):
        raise InputError(
            f"input '{given.name}': found a state whose rate depends on velocities or reactions that the input prescribes, expected "
            "rates of positions"
        )
    damped = forced @ (linear.damping @ shift)
    acting = forced @ (given.force + linear.stiffness @ shift)
    carried = np.linalg.lstsq(poses / scale[:, None], free @ damped / scale, rcond=None)[0]
    moved = state.matrix[of_velocities, of_velocities] @ damped
    of_states = given.rates + linear.rate_by_pose @ shift + state.matrix[end:, of_velocities] @ damped
    return Effect(np.concatenate([carried, acting + moved, of_states]), shift, free @ damped, shift)


@dataclass(frozen=True)
class Transfer:
    """Matrices A, B, C, D about a state, with names.

    Attributes
    ----------
    at : ndarray, shape (outputs,)
        Outputs at the state itself.
    notes : tuple of str
        Notes on the outputs, one sentence each.
    """

    a: np.ndarray
    b: np.ndarray
    c: np.ndarray
    d: np.ndarray
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    at: np.ndarray
    notes: tuple[str, ...] = ()

    def __repr__(self) -> str:
        return f"<Transfer: {len(self.a)} states, from {', '.join(self.inputs)} to {', '.join(self.outputs)}>"

    def state_space(self) -> StateSpace:
        """Return the system as `scipy.signal.StateSpace`."""
        from scipy.signal import StateSpace

        return StateSpace(self.a, self.b, self.c, self.d)

    def response(self, frequencies: np.ndarray) -> np.ndarray:
        """Return H = C (i w - A)^-1 B + D, shape (frequencies, outputs, inputs).

        Parameters
        ----------
        frequencies : ndarray
            Hz.

        Raises
        ------
        InputError
            At the frequency of an undamped motion, such as 0 Hz of a free body, and for a frequency that is not finite.
        """
        if not np.isfinite(frequencies).all():
            raise InputError("frequencies: found one that is not finite, expected numbers in Hz")
        if not len(self.a):
            return np.broadcast_to(self.d, (len(frequencies), *self.d.shape)).astype(complex)
        balanced, (scale, _) = matrix_balance(self.a, permute=False, separate=True)
        # eigenvectors of multiple eigenvalues, such as those of rigid body motions, lose half of the digits
        triangular, basis = schur(balanced, output="complex")
        rates = 2j * np.pi * np.asarray(frequencies)
        self._refuse_poles(rates, np.diagonal(triangular))
        driven = basis.conj().T @ (self.b / scale[:, None])
        solved = np.zeros((len(driven), len(rates), driven.shape[1]), dtype=complex)
        for row in reversed(range(len(driven))):
            later = np.tensordot(triangular[row, row + 1 :], solved[row + 1 :], 1)
            solved[row] = (driven[row] + later) / (rates - triangular[row, row])[:, None]
        return np.asarray(np.einsum("ok,kfi->foi", (self.c * scale) @ basis, solved) + self.d)

    def _refuse_poles(self, rates: np.ndarray, values: np.ndarray) -> None:
        """Refuse frequencies at which i w - A is numerically singular."""
        near = np.min(np.abs(rates[:, None] - values), axis=1) < LINEAR_ANALYSIS.close * (np.max(np.abs(values)) + 1.0)
        for rate in rates[near]:
            if is_singular(rate * np.eye(len(values)) - self.a):
                held = "an unconstrained motion" if rate == 0 else "an undamped mode"
                raise InputError(
                    f"frequencies: found {abs(rate) / (2 * np.pi):g} Hz, the frequency of {held}, at which the response is unbounded; "
                    "expected another frequency"
                )
