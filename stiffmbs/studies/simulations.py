"""Many simulations of one model that are advanced together, each with its own state and inputs."""

from __future__ import annotations

import itertools
import warnings
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import TypeAlias, Unpack

import numpy as np

from ..analyses.job import Runnable
from ..analyses.start_from import StartFrom
from ..errors import InputError, SolverError, prefixed
from ..model.settings import RunSettings, Settings, takes_settings
from ..reading.did_you_mean import instead_of
from ..reading.files.quoted import written
from ..solve.explicit.fixed import failed
from .executors import refuse_workers
from .input_numbers import Inputs
from .simulation import Simulation, simulation_of
from .stepping import FixedSteps, Moment

EachInputs: TypeAlias = Mapping[str, float | np.ndarray] | np.ndarray | Sequence[float]
"""Inputs by name, each a number or one number for each simulation; or an array of shape (inputs,) or (n, inputs)."""


@takes_settings
def simulations(
    model: Runnable,
    n: int,
    inputs: Mapping[str, float] | None = None,
    settings: RunSettings | None = None,
    workers: int = 1,
    **changes: Unpack[Settings],
) -> Simulations:
    """Return n simulations of one model that are advanced together.

    Schemes of fixed steps take a step of all simulations in one compiled call for each worker. The states are those of
    n single simulations, and do not depend on the number of workers.

    Parameters
    ----------
    model : Model, Scene, str or Path
    n : int
        Number of simulations.
    inputs : mapping of str to float, optional
        Inputs to change between steps, with their initial values, SI units, as in `stiffmbs.simulation`.
    settings : RunSettings, optional
        Settings of the run; by default those of the scene.
    workers : int, optional
        Number of threads that take steps.
    **changes
        Fields of the settings to change.

    Raises
    ------
    InputError
        If the model, a setting, a number or an input is invalid.
    AssemblyError
        If no consistent start is found.

    Examples
    --------
    >>> sims = stiffmbs.simulations("examples/cart_pendulum.yaml", 100, solver="projected", scheme="rk4", step=1e-3)
    >>> sims.reset(joints={"hinge": np.linspace(0.0, 1.0, 100)})
    >>> sims.step(0.01)
    >>> sims["cart.x"].shape
    (100,)
    """
    if isinstance(n, bool) or not isinstance(n, int | np.integer) or n < 1:
        raise InputError(f"simulations: found n = {n!r}, expected a whole number, 1 or more")
    refuse_workers(workers)
    return Simulations(
        [simulation_of(Worker, model, inputs, settings, changes) for _ in range(min(workers, n))], int(n)
    )


class Simulations:
    """Simulations of one model that are advanced together; made by `stiffmbs.simulations`.

    All arrays have one row for each simulation.
    """

    def __init__(self, workers: Sequence[Worker], n: int) -> None:
        self._workers, self._first = workers, workers[0]
        self._start = workers[0].moment()
        self._names = tuple(workers[0].inputs)
        self._now = Moment(*(np.repeat(each[None], n, axis=0) for each in self._start))
        self._reasons: dict[int, str] = {}
        self._has_warned = False
        self._rate_names = tuple(f"{name}_rate" for name in workers[0].joints)
        self._map = ThreadPoolExecutor(len(workers)).map if len(workers) > 1 else map
        bounds = np.linspace(0, n, len(workers) + 1).astype(int)
        self._parts = [slice(first, last) for first, last in itertools.pairwise(bounds.tolist())]

    def __len__(self) -> int:
        return len(self._now.t)

    @property
    def t(self) -> np.ndarray:
        """Return the current times, s, shape (n,)."""
        return self._now.t.copy()

    @property
    def q(self) -> np.ndarray:
        """Return the current coordinates, shape (n, n_q), in the order of `Simulation.q`."""
        return self._now.state[:, : len(self._first.q)].copy()

    @property
    def u(self) -> np.ndarray:
        """Return the current velocities, shape (n, n_u), in the order of `Simulation.u`."""
        return self._now.state[:, len(self._first.q) :].copy()

    @property
    def joints(self) -> tuple[str, ...]:
        """Return the channels of all coordinates of joints, in the order of the scene."""
        return self._first.joints

    @property
    def joint_coordinates(self) -> np.ndarray:
        """Return the current coordinates of joints, m or rad, shape (n, joints); angles count their turns."""
        return self._now.coordinates.copy()

    @property
    def joint_rates(self) -> np.ndarray:
        """Return the current rates of the coordinates of joints, m/s or rad/s, shape (n, joints)."""
        return self._now.rates.copy()

    @property
    def inputs(self) -> dict[str, np.ndarray]:
        """Return the current inputs by name, shape (n,) each."""
        return {name: self._now.inputs[:, k].copy() for k, name in enumerate(self._names)}

    @property
    def failed(self) -> np.ndarray:
        """Return a mask of the simulations whose last step has failed, shape (n,)."""
        found = np.zeros(len(self), dtype=bool)
        found[list(self._reasons)] = True
        return found

    def step(self, dt: float, inputs: EachInputs | None = None) -> None:
        """Advance all simulations by a time step, with inputs that are constant from now on.

        Parameters
        ----------
        dt : float
            Time step, s, greater than 0.
        inputs : mapping of str to float or array, or array of shape (inputs,) or (n, inputs), optional
            New values by name, where other inputs keep theirs, or of all inputs in the order of `inputs`.

        Raises
        ------
        InputError
            If dt is not positive, or an input is unknown, not finite or refused by the scene; nothing is changed.
        SolverError
            If steps fail; these simulations keep the state before, and `failed` is true for them. All others are advanced.
        """
        if not isinstance(dt, int | float | np.number) or not 0.0 < dt < np.inf:
            raise InputError(f"step: found dt = {dt!r}, expected a time greater than 0 s")
        wanted = self._now._replace(inputs=self._rows(inputs))
        self._reasons.clear()
        if all(worker.may_take_each(float(dt), wanted) for worker in self._workers):
            self._take_together(float(dt), wanted)
        else:
            wanted = self._one_by_one(float(dt), wanted)
        kept = list(self._reasons)
        wanted.inputs[kept] = self._now.inputs[kept]
        self._now = wanted
        if kept:
            others = f", and {len(kept) - 1} more have failed" if len(kept) > 1 else ""
            raise SolverError(f"simulation {kept[0]} {self._reasons[kept[0]]}{others}")

    def _rows(self, inputs: EachInputs | None) -> np.ndarray:
        """Return the inputs of all simulations, shape (n, inputs); those that are not given keep their values."""
        found, n = self._now.inputs.copy(), len(self)
        if not isinstance(inputs, Mapping):
            return found if inputs is None else self._first.checked_inputs(inputs, n).copy()
        for name, values in inputs.items():
            if name not in self._names:
                raise InputError(f"input '{name}': found no such input{instead_of(name, self._names)}")
            found[:, self._names.index(name)] = _each(f"input '{name}'", values, n)
        return self._first.checked_inputs(found, n)

    def _take_together(self, dt: float, of: Moment) -> None:
        """Take a step of all simulations, in one compiled call for each worker."""
        statuses = np.zeros(len(self), dtype=np.int64)

        def take(worker: Worker, part: slice) -> str:
            return worker.take_each(dt, Moment(*(each[part] for each in of)), statuses[part])

        sentence = "; ".join(filter(None, self._map(take, self._workers, self._parts)))
        for k in np.flatnonzero(statuses < 0).tolist():
            self._reasons[k] = str(failed(float(of.t[k]), int(statuses[k])))
        if sentence and not self._has_warned:
            self._has_warned = True
            warnings.warn(sentence, RuntimeWarning, stacklevel=3)

    def _one_by_one(self, dt: float, of: Moment) -> Moment:
        """Return the moments a step later, where steps do not fail."""
        found = Moment(*(each.copy() for each in of))
        for k in range(len(self)):
            self._first.continue_from(Moment(*(each[k] for each in of)))
            try:
                self._first.step(dt)
            except SolverError as error:
                self._reasons[k] = str(error)
            else:
                self._put(found, k, self._first.moment())
        return found

    @staticmethod
    def _put(into: Moment, k: int, moment: Moment) -> None:
        for rows, values in zip(into, moment, strict=True):
            rows[k] = values

    def reset(
        self,
        which: np.ndarray | Sequence[int] | Sequence[bool] | None = None,
        state: StartFrom | None = None,
        joints: Mapping[str, float | np.ndarray] | None = None,
        rates: Mapping[str, float | np.ndarray] | None = None,
    ) -> None:
        """Return simulations to the start, with the initial values of the inputs, or to another state.

        Parameters
        ----------
        which : array of int or bool, optional
            Numbers of the simulations, or a mask of shape (n,); all by default.
        state : SavedState, Solution, str or Path, optional
            State of all of these, as in `Simulation.reset`.
        joints, rates : mapping of str to float or array, optional
            Coordinates of joints, m or rad, and their rates, as in `Simulation.reset`, each a number or one number for each
            of these simulations.

        Raises
        ------
        InputError
            If there is no such simulation, or the state, coordinates or rates are refused; nothing is changed.
        """
        rows = self._numbers(which)
        found = [self._start] * len(rows)
        if state is not None and joints is None and rates is None:
            self._first.reset(state)
            found = [self._first.moment()] * len(rows)
        elif joints is not None or rates is not None:
            of_joints, of_rates = (_in_rows(values, len(rows)) for values in (joints, rates))
            for k, number in enumerate(rows.tolist()):
                with prefixed(f"simulation {number}: "):
                    self._first.reset(state, of_joints[k], of_rates[k])
                found[k] = self._first.moment()
        for number, moment in zip(rows.tolist(), found, strict=True):
            self._put(self._now, number, moment)
            self._reasons.pop(number, None)

    def _numbers(self, which: np.ndarray | Sequence[int] | Sequence[bool] | None) -> np.ndarray:
        """Return the numbers of some simulations."""
        every, n = np.arange(len(self)), len(self)
        if which is None:
            return every
        try:
            return every[np.atleast_1d(np.asarray(which))]
        except IndexError:
            raise InputError(
                f"reset: found which = {which!r}, expected numbers from 0 to {n - 1}, or a mask of {n}"
            ) from None

    def __getitem__(self, channel: str) -> np.ndarray:
        """Return the current values of a channel, shape (n,).

        Coordinates of joints and bodies, and their rates, are read from arrays; others are computed one by one.
        """
        for names, values in ((self.joints, self._now.coordinates), (self._rate_names, self._now.rates)):
            if channel in names:
                return values[:, names.index(channel)].copy()
        column = self._first.column_of(channel)
        return self._now.state[:, column].copy() if column is not None else self._read(channel)

    def _read(self, channel: str) -> np.ndarray:
        found = np.empty(len(self))
        for k in range(len(self)):
            self._first.continue_from(Moment(*(each[k] for each in self._now)))
            found[k] = self._first[channel]
        return found


def _each(what: str, values: float | np.ndarray, n: int) -> np.ndarray:
    """Return one number for each of n simulations; raise an InputError if there are not as many."""
    try:
        return np.broadcast_to(np.asarray(values, dtype=float), (n,))
    except (TypeError, ValueError):
        raise InputError(f"{what}: found {written(values)}, expected a number, or {n} numbers") from None


def _in_rows(values: Mapping[str, float | np.ndarray] | None, n: int) -> Sequence[dict[str, float] | None]:
    """Return coordinates by name for each of n simulations."""
    if values is None:
        return [None] * n
    columns = {name: _each(f"reset: '{name}'", each, n).tolist() for name, each in values.items()}
    return [{name: each[k] for name, each in columns.items()} for k in range(n)]


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
