"""Simulation that takes steps from many states of one model, for `stiffmbs.simulations`."""

from __future__ import annotations

import numpy as np

from ..errors import prefixed
from .input_numbers import Inputs
from .simulation import Simulation
from .stepping import FixedSteps, Moment


class Worker(Simulation):
    """Simulation whose state is replaced by those of others."""

    def moment(self) -> Moment:
        """Return all that the next steps depend on, but for the history of `bdf` and `radau`."""
        joints = self._current_joints()
        state, inputs = np.concatenate([self.q, self.u]), self._inputs.held.values.copy()
        return Moment(np.array(self.t), state, inputs, joints.coordinates.copy(), joints.rates.copy())

    def continue_from(self, at: Moment) -> None:
        """Take a state as it is."""
        n_q, self.t = len(self._stepper.q), float(at.t)
        self._inputs.set(at.inputs)
        self._stepper.restart(self.t, at.state[:n_q], at.state[n_q:])
        self._joints.continue_from(self.t, at.coordinates, at.rates)
        self._followed = True
        self._forget()

    def may_take_each(self, dt: float, of: Moment) -> bool:
        """Return True if `take_each` can take a step of dt from each of many moments; raise an InputError if an input is refused."""
        inputs, stepper = self._inputs, self._stepper
        if not (isinstance(stepper, FixedSteps) and inputs.affine) or inputs.of_time or self._bounded or self._relaxed:
            return False
        valid = inputs.valid_rows(of.inputs)
        if valid < len(of.inputs):
            with prefixed(f"simulation {valid}: "):
                self.set_inputs(of.inputs[valid])
        return stepper.may_take_each(float(of.t.min()), float(of.t.max()) + dt)

    def take_each(self, dt: float, of: Moment, statuses: np.ndarray) -> str:
        """Take one step of dt from each of many moments, as `FixedSteps.take_each`."""
        assert isinstance(self._stepper, FixedSteps)
        return self._stepper.take_each(dt, of, statuses, self._inputs.held, self._joints)

    def column_of(self, channel: str) -> int | None:
        """Return the place of a channel in (q, u), or None if it is none of these."""
        values, number = self._places.get(channel, (None, 0))
        return None if values is None else number + (len(self._stepper.q) if values is self._stepper.u else 0)

    def checked_inputs(self, values: Inputs, n: int) -> np.ndarray:
        """Return the inputs of n simulations, one row for each; raise an InputError if there is no such input or a value is invalid."""
        return self._inputs.rows(values, n)
