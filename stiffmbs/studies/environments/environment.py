"""One environment of Gymnasium."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Unpack

import gymnasium
import numpy as np
from gymnasium.spaces import Box

from ...analyses.job import Runnable
from ...errors import InputError
from .task import Learnt, TaskOptions


class Environment(gymnasium.Env[np.ndarray, np.ndarray]):
    """Environment of a scene whose inputs are actions (Gymnasium 1.0).

    Parameters
    ----------
    model : Model, Scene, str or Path
    actions : mapping of str to (float, float)
        Least and largest value of each input, SI units: parameters or paths as in `stiffmbs.simulation`.
    observations : sequence of str
        Channels, or formulas of channels and inputs: ``"sin(hinge.angle)"``.
    reward : str
        Formula of the reward after a step.
    limits : mapping of str to (float, float), optional
        Least and largest value of formulas, beyond which an episode is terminated. One whose step fails is terminated too, at the
        state before.
    joints, rates : mapping of str to (float, float), optional
        Ranges of coordinates of joints, m or rad, and of their rates at the start of an episode, which are drawn uniformly; the
        others as in `Simulation.reset`.
    dt : float, optional
        Time of a step, s, in which actions are constant.
    steps : int, optional
        Number of steps after which an episode is truncated.
    **settings
        Settings of the run. With fixed steps, such as ``solver="projected", scheme="rk4", step=1e-3``, a step is one compiled
        call.

    Raises
    ------
    InputError
        If a part is invalid or unknown to the scene, or Gymnasium is not installed.

    Examples
    --------
    >>> environment = stiffmbs.gym.Environment(
    ...     "cart.yaml", actions={"F": (-10, 10)}, observations=["cart.x", "hinge.angle"], reward="1 - cart.x^2",
    ...     limits={"cart.x": (-1, 1)}, joints={"hinge": (-0.1, 0.1)})
    """

    metadata: dict[str, Any] = {"render_modes": []}  # as Gymnasium declares it

    def __init__(self, model: Runnable, **task: Unpack[TaskOptions]) -> None:
        self._task, settings = Learnt.of(**task)
        self._sims = self._task.simulations(model, 1, 1, settings)
        self.action_space, self.observation_space = spaces_of(self._task)
        self._taken = -1

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Begin an episode; return its first observation and information."""
        super().reset(seed=seed)
        refuse_options(options)
        self._task.begin(self._sims, np.ones(1, dtype=bool), self.np_random)
        self._taken = 0
        return self._task.observed(self._sims)[0], {}

    def step(self, action: np.ndarray) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        """Take a step; return the observation, reward, termination, truncation and information."""
        if self._taken < 0:
            raise InputError("step: found no episode, expected a call of reset before")
        task, sims = self._task, self._sims
        failure = task.step(sims, action, (len(task.actions),))
        self._taken += 1
        found = task.observed(sims)[0], float(task.rewards(sims)[0]), bool(task.terminated(sims)[0])
        return *found, self._taken >= task.steps, {"failure": failure} if failure else {}


def spaces_of(task: Learnt) -> tuple[Box, Box]:
    """Return the spaces of actions and observations."""
    least, largest = (np.array(each, dtype=float) for each in zip(*task.actions.values(), strict=True))
    return Box(least, largest, dtype=np.float64), Box(-np.inf, np.inf, (len(task.observations),), dtype=np.float64)


def refuse_options(options: Mapping[str, Any] | None) -> None:
    """Raise an InputError if options of a reset are given, as there are none."""
    if options:
        raise InputError(f"reset: found the option '{next(iter(options))}', expected none")
