"""Environments of Gymnasium that are advanced together."""

from __future__ import annotations

from typing import Any, Unpack

import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from ...analyses.job import Runnable
from .environment import refuse_options, spaces_of
from .task import Learnt, TaskOptions


class VectorEnvironment(VectorEnv[np.ndarray, np.ndarray, np.ndarray]):
    """Environments of one scene that are advanced together (Gymnasium 1.0, `AutoresetMode.NEXT_STEP`).

    The step after the end of an episode begins another one, without regard to its action, with a reward of 0.

    Parameters
    ----------
    model : Model, Scene, str or Path
    num_envs : int
        Number of environments.
    workers : int, optional
        Number of threads that take steps.
    actions, observations, reward, limits, joints, rates, dt, steps, **settings
        As in `Environment`.

    Raises
    ------
    InputError
        If a part is invalid or unknown to the scene, or Gymnasium is not installed.
    """

    metadata: dict[str, Any] = {"render_modes": [], "autoreset_mode": AutoresetMode.NEXT_STEP}

    def __init__(self, model: Runnable, num_envs: int, *, workers: int = 1, **task: Unpack[TaskOptions]) -> None:
        self._task, settings = Learnt.of(**task)
        self._sims = self._task.simulations(model, num_envs, workers, settings)
        self.num_envs = num_envs
        self.single_action_space, self.single_observation_space = spaces_of(self._task)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self._taken, self._ended = np.zeros(num_envs, dtype=int), np.ones(num_envs, dtype=bool)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Begin an episode of each environment; return the first observations and information."""
        super().reset(seed=seed)
        refuse_options(options)
        self._ended[:] = True
        self._begin()
        self._ended[:] = False
        return self._task.observed(self._sims), {}

    def _begin(self) -> None:
        """Begin another episode where one has ended."""
        self._task.begin(self._sims, self._ended, self.np_random)
        self._taken[self._ended] = 0

    def step(self, actions: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, dict[str, Any]]:
        """Take a step of each environment; return observations, rewards, terminations, truncations and information."""
        task, sims, begun = self._task, self._sims, self._ended.copy()
        failure = task.step(sims, actions, (self.num_envs, len(task.actions)))
        self._taken += 1
        if begun.any():
            self._begin()
        rewards, terminated = np.where(begun, 0.0, task.rewards(sims)), ~begun & task.terminated(sims)
        truncated = ~begun & (self._taken >= task.steps)
        self._ended = terminated | truncated
        failed = sims.failed
        information = {"failure": np.where(failed, failure, ""), "_failure": failed} if failed.any() else {}
        return task.observed(sims), rewards, terminated, truncated, information
